//! Fibres of a template on a patient: the axes of cells, and muscles as polylines or closed surfaces.
//!
//! A fibre is a line of the tissue: its points go where the map f takes them, and its direction a becomes F a with F = ∂f/∂x.

use rayon::prelude::*;

use super::warp::Warp;
use crate::mesh::{TriangleSurface, Vector, VolumeMesh};

/// Pieces of a line and sides of triangles that are longer are divided before they are mapped, so that they bend with
/// the tissue; in mm.
const LONGEST_PIECE: f64 = 3.0;

/// The lines of a muscle where a map takes them.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedLines {
    /// In mm.
    pub lines: Vec<Vec<Vector>>,
    /// Of all lines together, before and after, in mm.
    pub lengths: [f64; 2],
    /// How many times as wide the tissue across the lines is: the mean of sqrt(|det F| / |F t|) along them, t their
    /// tangent.
    pub widening: f64,
}

/// By how much two maps differ along the lines of a muscle; means by length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreDifference {
    /// Between directions, their sign left out.
    pub mean_degrees: f64,
    pub largest_degrees: f64,
    /// Between places in mm.
    pub mean_mm: f64,
    pub largest_mm: f64,
}

/// The polylines of a template after a map; `most_points` is what a line may have after pieces are divided.
pub fn mapped_lines(map: &dyn Warp, lines: &[Vec<Vector>], most_points: usize) -> MappedLines {
    let divided: Vec<Vec<Vector>> = lines.iter().map(|line| divided(line, most_points)).collect();
    let mapped = |line: &Vec<Vector>| line.iter().map(|x| map.apply(x)).collect();
    let lines: Vec<Vec<Vector>> = divided.iter().map(mapped).collect();
    let (mut sum, mut weight) = (0.0, 0.0);
    for [from, to] in pieces(&divided) {
        let along = to - from;
        let gradient = map.gradient(&((from + to) * 0.5));
        let stretch = (gradient * along).norm() / along.norm();
        let width = (gradient.determinant().abs() / stretch).sqrt();
        if width.is_finite() {
            sum += width * along.norm();
            weight += along.norm();
        }
    }
    let lengths = [length(&divided), length(&lines)];
    MappedLines { lines, lengths, widening: if weight > 0.0 { sum / weight } else { 1.0 } }
}

/// The surface of a muscle where a map takes it. Triangles are cut into four until no side is longer than 3 mm, or until there
/// would be more than 100 000 of them.
pub fn mapped_surface(map: &dyn Warp, surface: &TriangleSurface) -> TriangleSurface {
    let mut divided = surface.clone();
    while longest_side(&divided) > LONGEST_PIECE && divided.triangles.len() * 4 <= MOST_TRIANGLES {
        divided = divided.with_sides_halved();
    }
    TriangleSurface {
        points: divided.points.par_iter().map(|x| map.apply(x)).collect(),
        triangles: divided.triangles,
        ..TriangleSurface::default()
    }
}

/// How far two maps take the lines of a muscle from each other; nothing where no line has a length.
pub fn fibre_difference(
    one: &dyn Warp,
    other: &dyn Warp,
    lines: &[Vec<Vector>],
) -> Option<FibreDifference> {
    let divided: Vec<Vec<Vector>> = lines.iter().map(|line| divided(line, usize::MAX)).collect();
    let (mut weight, mut degrees, mut apart) = (0.0, (0.0, 0.0_f64), (0.0, 0.0_f64));
    for [from, to] in pieces(&divided) {
        let (middle, along) = ((from + to) * 0.5, to - from);
        let both = one.along(&middle, &along).zip(other.along(&middle, &along));
        let Some((first, second)) = both else { continue };
        let angle = angle_between(&first, &second);
        let distance = (one.apply(&middle) - other.apply(&middle)).norm();
        weight += along.norm();
        degrees = (degrees.0 + angle * along.norm(), degrees.1.max(angle));
        apart = (apart.0 + distance * along.norm(), apart.1.max(distance));
    }
    (weight > 0.0).then(|| FibreDifference {
        mean_degrees: degrees.0 / weight,
        largest_degrees: degrees.1,
        mean_mm: apart.0 / weight,
        largest_mm: apart.1,
    })
}

/// Between two directions, whose sign does not matter, in degrees: 0 to 90.
pub fn angle_between(one: &Vector, other: &Vector) -> f64 {
    one.cross(other).norm().atan2(one.dot(other).abs()).to_degrees()
}

/// The direction of a region's fibres after a map, in each cell of the template.
pub fn cell_axes(map: &dyn Warp, template: &VolumeMesh, direction: &Vector) -> Vec<Vector> {
    let of_cell =
        |cell: usize| map.along(&template.centroid(cell), direction).unwrap_or(*direction);
    (0..template.cells.len()).into_par_iter().map(of_cell).collect()
}

/// The pieces that have a length.
fn pieces(lines: &[Vec<Vector>]) -> impl Iterator<Item = [Vector; 2]> {
    let pieces = lines.iter().flat_map(|line| line.windows(2).map(|pair| [pair[0], pair[1]]));
    pieces.filter(|[from, to]| (to - from).norm() > 0.0)
}

fn length(lines: &[Vec<Vector>]) -> f64 {
    pieces(lines).map(|[from, to]| (to - from).norm()).sum()
}

/// The same line with its long pieces divided, or as it is where it would have too many points.
fn divided(line: &[Vector], most_points: usize) -> Vec<Vector> {
    let parts = |pair: &[Vector]| ((pair[1] - pair[0]).norm() / LONGEST_PIECE).ceil().max(1.0);
    let points = 1.0 + line.windows(2).map(parts).sum::<f64>();
    if points > most_points.min(MOST_POINTS) as f64 {
        return line.to_vec();
    }
    let mut divided = Vec::with_capacity(points as usize);
    for pair in line.windows(2) {
        let count = parts(pair);
        let at = |part: usize| pair[0] + (pair[1] - pair[0]) * (part as f64 / count);
        divided.extend((0..count as usize).map(at));
    }
    divided.extend(line.last());
    divided
}

fn longest_side(surface: &TriangleSurface) -> f64 {
    let of = |triangle: usize| {
        let [a, b, c] = surface.corners(triangle);
        (b - a).norm().max((c - b).norm()).max((a - c).norm())
    };
    (0..surface.triangles.len()).map(of).fold(0.0, f64::max)
}

/// A surface of more triangles is not divided further.
const MOST_TRIANGLES: usize = 100_000;

/// A line of more points is mapped as it is.
const MOST_POINTS: usize = 100_000;
