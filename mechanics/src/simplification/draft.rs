//! A surface while its edges collapse: points, triangles, and who meets whom.

use crate::mesh::surface_edges::edges;
use crate::mesh::{TriangleSurface, Vector};

/// What an edge may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Inner,
    /// Of one triangle.
    Border,
    /// Of three triangles or more, or of two that disagree about the outside.
    Fixed,
}

pub(super) struct Draft {
    pub points: Vec<Vector>,
    pub triangles: Vec<[u32; 3]>,
    /// Whether a triangle is still there.
    pub stands: Vec<bool>,
    /// The triangles at each point that still stand.
    pub around: Vec<Vec<u32>>,
    /// Points on an open border.
    pub on_border: Vec<bool>,
    /// Points that stay because the surface is not manifold there.
    pub is_fixed: Vec<bool>,
    pub left: usize,
    /// Of each triangle of the surface its number here; `None` of one with a point twice.
    pub number_of_given: Vec<Option<u32>>,
}

impl Draft {
    /// Triangles with a point twice are left out.
    pub fn new(surface: &TriangleSurface) -> Draft {
        let count = surface.points.len();
        let is_whole = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        let triangles: Vec<[u32; 3]> = surface.triangles.iter().copied().filter(is_whole).collect();
        let mut numbers = 0..;
        let number = |corners: &[u32; 3]| if is_whole(corners) { numbers.next() } else { None };
        let number_of_given = surface.triangles.iter().map(number).collect();
        let mut around = vec![Vec::new(); count];
        for (number, corners) in (0..).zip(&triangles) {
            corners.iter().for_each(|&corner| around[corner as usize].push(number));
        }
        let (mut on_border, mut is_fixed) = (vec![false; count], vec![false; count]);
        let sides =
            TriangleSurface { triangles: triangles.clone(), ..surface.clone() }.sorted_sides();
        for edge in edges(&sides) {
            let kind = match edge {
                [_] => Kind::Border,
                [one, other] if one.ascending != other.ascending => Kind::Inner,
                _ => Kind::Fixed,
            };
            for point in edge[0].points {
                on_border[point as usize] |= kind == Kind::Border;
                is_fixed[point as usize] |= kind == Kind::Fixed;
            }
        }
        let (stands, left) = (vec![true; triangles.len()], triangles.len());
        let points = surface.points.clone();
        Draft { points, triangles, stands, around, on_border, is_fixed, left, number_of_given }
    }

    pub fn corners(&self, triangle: u32) -> [Vector; 3] {
        self.triangles[triangle as usize].map(|corner| self.points[corner as usize])
    }

    /// Points that share a triangle with one, ascending.
    pub fn neighbours(&self, point: u32) -> Vec<u32> {
        let corners = self.around[point as usize].iter();
        let mut all: Vec<u32> = corners
            .flat_map(|&triangle| self.triangles[triangle as usize])
            .filter(|&corner| corner != point)
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    pub fn shared(&self, [a, b]: [u32; 2]) -> Vec<u32> {
        let has_b = |triangle: &u32| self.triangles[*triangle as usize].contains(&b);
        self.around[a as usize].iter().copied().filter(has_b).collect()
    }

    /// Whether the surface has the same shape after the edge has become a point: what both ends have around them is what the
    /// edge has (the link condition of Dey et al. 1999), and no border is closed.
    pub fn may_collapse(&self, [a, b]: [u32; 2]) -> bool {
        if self.is_fixed[a as usize] || self.is_fixed[b as usize] || self.left <= 4 {
            return false;
        }
        let shared = self.shared([a, b]);
        let borders = self.on_border[a as usize] && self.on_border[b as usize];
        if shared.len() != if borders { 1 } else { 2 } {
            return false;
        }
        let (of_a, of_b) = (self.neighbours(a), self.neighbours(b));
        let common: Vec<u32> =
            of_a.into_iter().filter(|point| of_b.binary_search(point).is_ok()).collect();
        if common.len() != shared.len() {
            return false;
        }
        // A triangle over both common points at each end would be folded onto the other.
        let bridges = |end: u32| {
            let mut own = self.around[end as usize].iter();
            own.any(|&triangle| {
                let corners = self.triangles[triangle as usize];
                common.len() == 2 && common.iter().all(|point| corners.contains(point))
            })
        };
        !(bridges(a) && bridges(b))
    }

    /// The triangles at either end that stay, with their corners when both are one point at `place`.
    pub fn moved(&self, [a, b]: [u32; 2], place: &Vector) -> Vec<(u32, [Vector; 3])> {
        let mut all: Vec<u32> =
            self.around[a as usize].iter().chain(&self.around[b as usize]).copied().collect();
        all.sort_unstable();
        all.dedup();
        all.retain(|&triangle| {
            let corners = self.triangles[triangle as usize];
            !(corners.contains(&a) && corners.contains(&b))
        });
        let corner = |point: u32| match point == a || point == b {
            true => *place,
            false => self.points[point as usize],
        };
        let corners = |triangle: u32| self.triangles[triangle as usize].map(corner);
        all.into_iter().map(|triangle| (triangle, corners(triangle))).collect()
    }

    /// Makes one point, `a`, of an edge; tells the triangles that fell.
    pub fn collapse(&mut self, [a, b]: [u32; 2], place: Vector) -> Vec<u32> {
        let fallen = self.shared([a, b]);
        for &triangle in &fallen {
            self.stands[triangle as usize] = false;
            for corner in self.triangles[triangle as usize] {
                self.around[corner as usize].retain(|&other| other != triangle);
            }
        }
        let moved = std::mem::take(&mut self.around[b as usize]);
        for &triangle in &moved {
            for corner in &mut self.triangles[triangle as usize] {
                if *corner == b {
                    *corner = a;
                }
            }
        }
        self.around[a as usize].extend(moved);
        self.around[a as usize].sort_unstable();
        self.points[a as usize] = place;
        self.on_border[a as usize] |= self.on_border[b as usize];
        self.left -= fallen.len();
        fallen
    }

    /// What stands, without points that nothing uses.
    pub fn into_surface(self) -> TriangleSurface {
        let mut number = vec![u32::MAX; self.points.len()];
        let mut surface = TriangleSurface::default();
        let standing = self.triangles.iter().zip(&self.stands).filter(|(_, stands)| **stands);
        for (corners, _) in standing {
            surface.triangles.push(corners.map(|corner| {
                let own = &mut number[corner as usize];
                if *own == u32::MAX {
                    *own = surface.points.len() as u32;
                    surface.points.push(self.points[corner as usize]);
                }
                *own
            }));
        }
        surface
    }
}
