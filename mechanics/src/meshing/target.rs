//! The scale of a size field at which a body has about so many tetrahedra.

use super::error::MeshingError;
use super::refine::PER_CUBE;
use super::settings::MeshingSettings;
use super::size::SizeField;
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::Vector;

/// Cubes along the longest axis of the body that are looked at.
const CUBES: f64 = 40.0;
/// Half the diagonal of a cube of edge 1.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;
/// Halvings of the interval in which the scale lies.
const HALVINGS: usize = 40;
/// Tetrahedra for each square of the lattice's edge on the boundary, beyond those of the volume: 1.63 to 1.9 on balls.
const PER_SQUARE: f64 = 1.7;

/// A cube with tissue in its centre.
struct Sample {
    centre: Vector,
    /// Its faces against cubes without.
    bare: usize,
    thickness: f64,
}

/// The size field of the settings, scaled to their target if there is one.
pub(super) fn size_field(
    domain: &dyn Domain,
    settings: &MeshingSettings,
    watch: &Watch,
) -> Result<SizeField, MeshingError> {
    let Some(target) = settings.target else { return Ok(settings.size.clone()) };
    let (low, high) = domain.bounds();
    let edge = (high - low).max() / CUBES;
    let samples = samples(domain, settings, edge, watch)?;
    if samples.is_empty() {
        return Err(MeshingError::Empty { low, high, size: edge });
    }
    let count = |scale: f64| -> f64 {
        let size = settings.size.scaled(scale);
        samples.iter().map(|sample| tetrahedra(&size, sample, edge)).sum()
    };
    let [mut few, mut many] = [1e6, 1e-6];
    for _ in 0..HALVINGS {
        let middle = f64::sqrt(few * many);
        if count(middle) > target as f64 { many = middle } else { few = middle }
    }
    Ok(settings.size.scaled(few))
}

fn samples(
    domain: &dyn Domain,
    settings: &MeshingSettings,
    edge: f64,
    watch: &Watch,
) -> Result<Vec<Sample>, MeshingError> {
    let (low, high) = domain.bounds();
    let counts =
        <[usize; 3]>::from((high - low).map(|extent| (extent / edge).ceil().max(1.0) as usize));
    let [nx, ny, nz] = counts;
    let centre = |number: usize| {
        let at = [number % nx, number / nx % ny, number / (nx * ny)];
        low + Vector::from(at.map(|x| x as f64 + 0.5)) * edge
    };
    let numbers: Vec<usize> = (0..nx * ny * nz).collect();
    let tissue = watch.map(&numbers, |&number| holds(domain, &centre(number), edge))?;
    let steps = [1, nx, nx * ny];
    let bare = |number: usize| -> usize {
        let at = [number % nx, number / nx % ny, number / (nx * ny)];
        let low_sides = (0..3).filter(|&axis| at[axis] == 0 || !tissue[number - steps[axis]]);
        let high_sides =
            (0..3).filter(|&axis| at[axis] + 1 == counts[axis] || !tissue[number + steps[axis]]);
        low_sides.count() + high_sides.count()
    };
    let held: Vec<usize> = numbers.into_iter().filter(|&number| tissue[number]).collect();
    watch.map(&held, |&number| {
        let centre = centre(number);
        let bound = settings.size.thickness.is_some();
        let thickness = if bound { domain.thickness(&centre) } else { f64::INFINITY };
        Sample { centre, bare: bare(number), thickness }
    })
}

fn holds(domain: &dyn Domain, centre: &Vector, edge: f64) -> bool {
    match domain.coverage(centre, edge * HALF_DIAGONAL) {
        Coverage::Inside => true,
        Coverage::Outside => false,
        Coverage::Mixed => domain.value(centre) > 0.0,
    }
}

/// What a cube of tissue gives, with cells of a power of two times the finest.
fn tetrahedra(size: &SizeField, sample: &Sample, edge: f64) -> f64 {
    let mut cell = size.finest * (size.coarsest / size.finest).log2().floor().exp2();
    while cell > size.finest * 1.5 && cell > wanted(size, sample, cell) {
        cell /= 2.0;
    }
    let cells = edge / cell;
    // A plane at any angle shows 3 / 2 of its area along the three axes.
    let squares = sample.bare as f64 / 1.5 * cells.powi(2);
    PER_CUBE * cells.powi(3) + PER_SQUARE * squares
}

/// The size asked for at a cell, as the octree does.
fn wanted(size: &SizeField, sample: &Sample, cell: f64) -> f64 {
    let mut wanted = size.at(&sample.centre, cell * HALF_DIAGONAL);
    if let Some(rule) = size.thickness {
        wanted = wanted.min(rule.size(sample.thickness));
    }
    if let (Some(at_boundary), true) = (size.at_boundary, sample.bare > 0) {
        wanted = wanted.min(at_boundary);
    }
    wanted
}
