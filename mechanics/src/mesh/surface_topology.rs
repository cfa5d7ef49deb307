//! Topology of a triangle surface around its edges and corners: normals there, and open borders.
//!
//! Points at exactly the same place count as one, so that a triangle soup (STL) has neighbours too.

use super::{TriangleSurface, Vector};
use crate::rows::Sorting;
use std::collections::HashMap;

/// Normals of faces, edges and vertices, and which edges and vertices lie on an open border.
pub(super) struct SurfaceTopology {
    faces: Vec<Vector>,
    /// For each triangle the numbers of its edges and of its welded corners.
    edges_of: Vec<[u32; 3]>,
    vertices_of: Vec<[u32; 3]>,
    edges: Vec<SurfaceFeature>,
    vertices: Vec<SurfaceFeature>,
}

/// An edge or a vertex: the weighted sum of the normals around it.
#[derive(Clone, Copy)]
struct SurfaceFeature {
    normal: Vector,
    is_open: bool,
}

impl SurfaceFeature {
    const BARE: SurfaceFeature =
        SurfaceFeature { normal: Vector::new(0.0, 0.0, 0.0), is_open: false };
}

impl SurfaceTopology {
    /// Only triangles for which `counts` holds give normals; all of them close borders.
    pub(super) fn new(
        surface: &TriangleSurface,
        counts: impl Fn(&Vector, &Vector, &Vector) -> bool,
    ) -> Self {
        let (vertex_of, vertex_count) = weld(&surface.points);
        let vertices_of: Vec<[u32; 3]> = surface
            .triangles
            .iter()
            .map(|corners| corners.map(|corner| vertex_of[corner as usize]))
            .collect();
        let (edges_of, edge_ends, edge_uses) = number_edges(&vertices_of, vertex_count);
        let mut topology = SurfaceTopology {
            faces: vec![Vector::zeros(); vertices_of.len()],
            edges: vec![SurfaceFeature::BARE; edge_ends.len()],
            vertices: vec![SurfaceFeature::BARE; vertex_count],
            edges_of,
            vertices_of,
        };
        for triangle in 0..surface.triangles.len() {
            let corners = surface.corners(triangle);
            let [a, b, c] = &corners;
            if counts(a, b, c) {
                topology.add_normals(triangle, &corners);
            }
        }
        for (edge, ends) in edge_ends.iter().enumerate() {
            if edge_uses[edge] == 1 {
                topology.edges[edge].is_open = true;
                for &vertex in ends {
                    topology.vertices[vertex as usize].is_open = true;
                }
            }
        }
        topology
    }

    /// A unit normal, or that of the face where the normals around an edge or vertex cancel.
    pub(super) fn normal(&self, triangle: usize, feature: Feature) -> Vector {
        let face = self.faces[triangle];
        let normal = self.place(triangle, feature).map_or(face, |p| p.normal);
        // Sums of unit vectors shorter than this are rounding.
        normal.try_normalize(1e-9).unwrap_or(face)
    }

    pub(super) fn is_open(&self, triangle: usize, feature: Feature) -> bool {
        self.place(triangle, feature).is_some_and(|p| p.is_open)
    }

    fn place(&self, triangle: usize, feature: Feature) -> Option<&SurfaceFeature> {
        match feature {
            Feature::Face => None,
            Feature::Edge(local) => Some(&self.edges[self.edges_of[triangle][local] as usize]),
            Feature::Vertex(local) => {
                Some(&self.vertices[self.vertices_of[triangle][local] as usize])
            }
        }
    }

    fn add_normals(&mut self, triangle: usize, corners: &[Vector; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a)).normalize();
        self.faces[triangle] = normal;
        for local in 0..3 {
            self.edges[self.edges_of[triangle][local] as usize].normal += normal;
            let [to_next, to_last] =
                [1, 2].map(|step| corners[(local + step) % 3] - corners[local]);
            let angle = to_next.angle(&to_last);
            self.vertices[self.vertices_of[triangle][local] as usize].normal += normal * angle;
        }
    }
}

/// For each point the number of its place, and how many places there are.
fn weld(points: &[Vector]) -> (Vec<u32>, usize) {
    let mut places: HashMap<[u64; 3], u32> = HashMap::with_capacity(points.len());
    let numbers = points
        .iter()
        .map(|point| {
            let next = places.len() as u32;
            // Adding zero makes one place of 0 and -0.
            let key = [point.x, point.y, point.z].map(|x| (x + 0.0).to_bits());
            *places.entry(key).or_insert(next)
        })
        .collect();
    (numbers, places.len())
}

/// For each triangle its three edges, for each edge its two ends, and how many triangles use it. Of `vertices` places.
fn number_edges(
    vertices_of: &[[u32; 3]],
    vertices: usize,
) -> (Vec<[u32; 3]>, Vec<[u32; 2]>, Vec<u32>) {
    let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let all = || vertices_of.iter().copied().flat_map(sides);
    // The sides of triangles by their lower end, then by the other, and which side of which triangle each is.
    let mut lengths = vec![0; vertices];
    all().for_each(|[from, to]| lengths[from.min(to) as usize] += 1);
    let mut sorting = Sorting::new(&lengths, (0, 0));
    for (side, [from, to]) in (0_u32..).zip(all()) {
        sorting.put(from.min(to) as usize, (from.max(to), side));
    }
    let mut by_lower = sorting.finish();
    let (mut edges_of, mut ends, mut uses) =
        (vec![[0; 3]; vertices_of.len()], Vec::new(), Vec::new());
    for lower in 0..vertices {
        let own = by_lower.row_mut(lower);
        own.sort_unstable();
        for same in own.chunk_by(|one, other| one.0 == other.0) {
            let mut used = 0;
            for &(_, side) in same {
                let (triangle, local) = (side as usize / 3, side as usize % 3);
                edges_of[triangle][local] = ends.len() as u32;
                // A triangle folded onto one edge would close a border that is open.
                let [a, b, c] = vertices_of[triangle];
                used += u32::from(a != b && b != c && c != a);
            }
            ends.push([lower as u32, same[0].0]);
            uses.push(used);
        }
    }
    (edges_of, ends, uses)
}

/// Where on its triangle a closest point lies, by local numbers; edge i joins corners i and i + 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    Face,
    Edge(usize),
    Vertex(usize),
}
