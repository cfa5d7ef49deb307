//! Cuts of a saw: oriented planes through bone, with an extent and a width where they are given.

use crate::mesh::Vector;

/// Beyond this, in mm, no head reaches.
const FARTHEST: f64 = 1e9;
/// An extent, in mm², that is not a line.
const SMALLEST_AREA: f64 = 1e-6;

/// Why figures are no cut.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CutError {
    #[error("a point of the cut is farther than 1e9 mm away or no number")]
    Point,
    #[error("the normal is shorter than 1e-9, longer than 1e9 or no number")]
    Normal,
    #[error("the saw is {kerf} mm wide; 0 to 10 mm are possible")]
    Kerf { kerf: f64 },
    #[error("a disc of radius {radius} mm cuts nothing")]
    Radius { radius: f64 },
    #[error("a polygon of {corners} corners that spans {area} mm² on the plane cuts nothing")]
    Polygon { corners: usize, area: f64 },
}

/// An oriented plane: what its normal points at is above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: Vector,
    normal: Vector,
    axes: [Vector; 2],
}

impl Plane {
    /// The plane through `point`, in mm, across a normal of any length.
    pub fn new(point: Vector, normal: Vector) -> Result<Plane, CutError> {
        if !point.iter().all(|x| x.abs() <= FARTHEST) {
            return Err(CutError::Point);
        }
        let length = normal.norm();
        if !(1e-9..=1e9).contains(&length) {
            return Err(CutError::Normal);
        }
        let normal = normal / length;
        Ok(Plane { point, normal, axes: axes(&normal) })
    }

    pub fn point(&self) -> Vector {
        self.point
    }

    /// Of length 1, from below to above.
    pub fn normal(&self) -> Vector {
        self.normal
    }

    /// How far a point is above the plane, in mm; negative below.
    pub fn height(&self, point: &Vector) -> f64 {
        (point - self.point).dot(&self.normal)
    }

    /// The same plane moved along its normal, by mm.
    pub fn raised(&self, by: f64) -> Plane {
        Plane { point: self.point + self.normal * by, ..*self }
    }

    /// Two directions of length 1 in the plane, which are a right-handed frame with the normal.
    pub fn axes(&self) -> [Vector; 2] {
        self.axes
    }
}

fn axes(normal: &Vector) -> [Vector; 2] {
    let u = normal.cross(&Vector::ith(normal.iamin(), 1.0)).normalize();
    [u, normal.cross(&u)]
}

/// The part of a plane that the saw reaches.
#[derive(Clone, Debug, PartialEq)]
pub enum Extent {
    /// Around the point of the plane; the radius in mm.
    Disc { radius: f64 },
    /// Corners in their order; what lies off the plane counts where its perpendicular meets it.
    Polygon { corners: Vec<Vector> },
}

/// One of the two sides of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Below,
    Above,
}

/// A plane that is sawn, all of it or as far as its extent.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    pub name: String,
    plane: Plane,
    reach: Reach,
    kerf: f64,
    link: Option<Link>,
}

/// The place of a cut in a line of such.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Link {
    /// The number of the line.
    line: usize,
    piece: usize,
    pieces: usize,
}

/// Lines are walked this far, in mm, from where they are stated: along no axis and no diagonal, so that no centre of a voxel lies on
/// a corner of a line, where each of the pieces that meet there would leave it to the other.
const OFF_GRID: [f64; 3] = [1.0e-6, 0.618e-6, 0.414e-6];

/// An extent in the axes of its plane.
#[derive(Clone, Debug, PartialEq)]
enum Reach {
    Everywhere,
    Disc { radius: f64 },
    Polygon(Vec<[f64; 2]>),
}

impl Cut {
    /// All of a plane, by a saw without width.
    pub fn unbounded(name: &str, plane: Plane) -> Cut {
        Cut { name: name.to_owned(), plane, reach: Reach::Everywhere, kerf: 0.0, link: None }
    }

    /// As much of a plane as is given, by a saw of that width in mm.
    pub fn new(
        name: &str,
        plane: Plane,
        extent: Option<Extent>,
        kerf: f64,
    ) -> Result<Cut, CutError> {
        if !(0.0..=10.0).contains(&kerf) {
            return Err(CutError::Kerf { kerf });
        }
        let reach = match extent {
            None => Reach::Everywhere,
            Some(extent) => extent.on(&plane)?,
        };
        Ok(Cut { name: name.to_owned(), plane, reach, kerf, link: None })
    }

    /// What a line of points saws that goes into the bone by `depth`, a way in mm: a parallelogram for each piece of the line, which
    /// meet without a gap. Above each is where (its way along the line) x `depth` points. `number` is that of the line.
    pub fn chained(
        name: &str,
        line: &[Vector],
        depth: Vector,
        kerf: f64,
        number: usize,
    ) -> Result<Vec<Cut>, CutError> {
        let pieces = line.len().saturating_sub(1);
        let piece = |(piece, ends): (usize, &[Vector])| {
            let (from, to) = (ends[0], ends[1]);
            let plane = Plane::new(from, (to - from).cross(&depth))?;
            let corners = vec![from, to, to + depth, from + depth];
            let name = format!("{name}{}", numbered(piece));
            let cut = Cut::new(&name, plane, Some(Extent::Polygon { corners }), kerf)?;
            Ok(Cut { link: Some(Link { line: number, piece, pieces }), ..cut })
        };
        line.windows(2).enumerate().map(piece).collect()
    }

    /// The number of the line that it is a piece of. Such a piece has no sides far from itself: bone of a step lies on both
    /// sides of the plane of each of its pieces.
    pub fn chain(&self) -> Option<usize> {
        self.link.map(|link| link.line)
    }

    /// The name of the cut, or of the line that it is a piece of.
    pub fn line_name(&self) -> &str {
        let own = self.link.and_then(|link| self.name.strip_suffix(&numbered(link.piece)));
        own.unwrap_or(&self.name)
    }

    /// Whether a point is above the plane; of a piece of a line never undecided, as no centre of a voxel is taken to lie on it.
    pub fn is_above(&self, point: &Vector) -> bool {
        self.plane.height(&self.off_grid(point)) > 0.0
    }

    fn off_grid(&self, point: &Vector) -> Vector {
        match self.link {
            Some(_) => point + Vector::from(OFF_GRID),
            None => *point,
        }
    }

    /// Whether bone that is crossed beside the extent, on the way between two points, holds together what this cut should part. Of a
    /// piece of a line only where the piece goes on: deeper or nearer than it is sawn, and beyond the ends of the line; what lies on its
    /// plane beside it is parted by the next piece.
    pub fn is_beside(&self, one: &Vector, other: &Vector) -> bool {
        if self.is_above(one) == self.is_above(other) || self.parts(one, other) {
            return false;
        }
        let (Some(link), Reach::Polygon(corners)) = (self.link, &self.reach) else { return true };
        let [from, to, .., back] = corners.as_slice() else { return true };
        let at = flat(&self.plane, &self.crossing(one, other));
        let along = side_of(*from, *back, at) / side_of(*from, *back, *to);
        (link.piece == 0 || along >= 0.0) && (link.piece + 1 == link.pieces || along <= 1.0)
    }

    /// Where the straight way between two points on both sides of the plane meets it.
    fn crossing(&self, one: &Vector, other: &Vector) -> Vector {
        let [one, other] = [one, other].map(|point| self.off_grid(point));
        let [below, above] = [one, other].map(|point| self.plane.height(&point));
        one + (other - one) * (below / (below - above))
    }

    /// As much of a closed path on the plane as the saw reaches; `None` where its extent is no convex polygon. Where the path falls
    /// apart the pieces hang together along the outline of the extent, which adds no area.
    pub fn clipped(&self, path: &[Vector]) -> Option<Vec<Vector>> {
        let Reach::Polygon(corners) = &self.reach else { return None };
        let turn = area(corners).signum();
        let is_convex = (0..corners.len()).all(|at| {
            let [a, b, c] = [0, 1, 2].map(|next| corners[(at + next) % corners.len()]);
            turn * side_of(a, b, c) >= 0.0
        });
        if !is_convex {
            return None;
        }
        let clip = |path: Vec<Vector>, (a, b): ([f64; 2], [f64; 2])| {
            let depths: Vec<f64> =
                path.iter().map(|p| turn * side_of(a, b, flat(&self.plane, p))).collect();
            let mut kept = Vec::new();
            for (at, point) in path.iter().enumerate() {
                let next = (at + 1) % path.len();
                if depths[at] >= 0.0 {
                    kept.push(*point);
                }
                if (depths[at] >= 0.0) != (depths[next] >= 0.0) {
                    let share = depths[at] / (depths[at] - depths[next]);
                    kept.push(point + (path[next] - point) * share);
                }
            }
            kept
        };
        // Source: Sutherland and Hodgman, Reentrant polygon clipping, Communications of the ACM 17 (1974).
        Some(sides(corners).fold(path.to_vec(), clip))
    }

    pub fn plane(&self) -> &Plane {
        &self.plane
    }

    pub fn is_bounded(&self) -> bool {
        self.reach != Reach::Everywhere
    }

    /// The width of the saw in mm.
    pub fn kerf(&self) -> f64 {
        self.kerf
    }

    /// Whether the perpendicular of a point meets the plane within the extent.
    pub fn reaches(&self, point: &Vector) -> bool {
        match &self.reach {
            Reach::Everywhere => true,
            Reach::Disc { radius } => {
                let [u, v] = flat(&self.plane, point);
                u * u + v * v <= radius * radius
            }
            Reach::Polygon(corners) => holds(corners, &flat(&self.plane, point)),
        }
    }

    /// Whether a point is turned to sawdust: nearer to the plane than half the width of the saw, within its extent.
    pub fn saws(&self, point: &Vector) -> bool {
        self.kerf > 0.0
            && self.plane.height(point).abs() <= self.kerf / 2.0
            && self.reaches(&self.off_grid(point))
    }

    /// Whether the saw parts two points: the straight way between them meets the plane within the extent.
    pub fn parts(&self, one: &Vector, other: &Vector) -> bool {
        self.is_above(one) != self.is_above(other) && self.reaches(&self.crossing(one, other))
    }

    /// Whether a point is on that side, beyond the width of the saw.
    pub fn leaves(&self, point: &Vector, side: Side) -> bool {
        let height = self.plane.height(point);
        match side {
            Side::Below => height <= -self.kerf / 2.0,
            Side::Above => height > self.kerf / 2.0,
        }
    }
}

impl Extent {
    fn on(self, plane: &Plane) -> Result<Reach, CutError> {
        match self {
            Extent::Disc { radius } if radius.is_finite() && radius > 0.0 => {
                Ok(Reach::Disc { radius })
            }
            Extent::Disc { radius } => Err(CutError::Radius { radius }),
            Extent::Polygon { corners } => {
                if !corners.iter().flatten().all(|x| x.abs() <= FARTHEST) {
                    return Err(CutError::Point);
                }
                let corners: Vec<_> = corners.iter().map(|corner| flat(plane, corner)).collect();
                let area = area(&corners);
                match corners.len() >= 3 && area.abs() > SMALLEST_AREA {
                    true => Ok(Reach::Polygon(corners)),
                    false => Err(CutError::Polygon { corners: corners.len(), area }),
                }
            }
        }
    }
}

/// What tells the name of a piece from that of its line.
fn numbered(piece: usize) -> String {
    format!(", piece {}", piece + 1)
}

/// A point in the axes of a plane.
fn flat(plane: &Plane, point: &Vector) -> [f64; 2] {
    plane.axes.map(|axis| (point - plane.point).dot(&axis))
}

fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn area(corners: &[[f64; 2]]) -> f64 {
    sides(corners).map(|(a, b)| (a[0] * b[1] - a[1] * b[0]) / 2.0).sum()
}

/// Twice the area of a triangle, negative where it turns the other way.
fn side_of(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether a polygon holds a point, by the parity of the sides to its right.
fn holds(corners: &[[f64; 2]], [x, y]: &[f64; 2]) -> bool {
    let to_the_right = |(a, b): &([f64; 2], [f64; 2])| {
        (a[1] > *y) != (b[1] > *y) && *x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
    };
    sides(corners).filter(to_the_right).count() % 2 == 1
}

#[cfg(test)]
#[path = "cut_tests.rs"]
mod tests;
