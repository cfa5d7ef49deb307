//! Cells near the polylines of muscles: each takes the tangent of the nearest segment as its axis.

use rayon::prelude::*;

use crate::mesh::{Vector, VolumeMesh};

/// A muscle with fewer cells is of few cells, which is reported.
pub const FEW_CELLS: usize = 20;

/// The polylines of a muscle, in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleLines {
    pub name: String,
    pub lines: Vec<Vec<Vector>>,
}

/// A cell whose centroid lies near a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellFibre {
    pub cell: u32,
    /// The muscle of the nearest line, by its place in the list.
    pub muscle: usize,
    /// From the centroid to the line, in mm.
    pub distance: f64,
    /// The tangent of the line, of length 1; its sign is that of the line.
    pub axis: Vector,
    /// Muscles within the same distance of the centroid.
    pub muscles: usize,
}

/// The cells whose centroid lies within a distance of a muscle's lines, ascending; `within` has that of each muscle in mm.
pub fn fibre_cells(mesh: &VolumeMesh, muscles: &[MuscleLines], within: &[f64]) -> Vec<CellFibre> {
    taken(&near(mesh, muscles), within)
}

/// For each cell the distance to each muscle and its tangent there; nothing of one without a line that has a length.
type MuscleDistances = Vec<Vec<Option<(f64, Vector)>>>;

fn near(mesh: &VolumeMesh, muscles: &[MuscleLines]) -> MuscleDistances {
    let of_cell = |cell: usize| {
        let place = mesh.centroid(cell);
        muscles.iter().map(|muscle| nearest(&place, &muscle.lines)).collect()
    };
    (0..mesh.cells.len()).into_par_iter().map(of_cell).collect()
}

/// The distance in mm from a place to the nearest segment of some lines, and its unit tangent.
pub fn nearest(place: &Vector, lines: &[Vec<Vector>]) -> Option<(f64, Vector)> {
    let pieces = lines.iter().flat_map(|line| line.windows(2));
    let of = |pair: &[Vector]| {
        let along = pair[1] - pair[0];
        let length = along.norm();
        if length <= 0.0 || !length.is_finite() {
            return None;
        }
        let share = ((place - pair[0]).dot(&along) / (length * length)).clamp(0.0, 1.0);
        Some(((place - pair[0] - along * share).norm(), along / length))
    };
    pieces.filter_map(of).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn taken(near: &[Vec<Option<(f64, Vector)>>], reach: &[f64]) -> Vec<CellFibre> {
    let of_cell = |(cell, own): (usize, &Vec<Option<(f64, Vector)>>)| {
        let within = own.iter().zip(reach).enumerate();
        let within = within.filter_map(|(muscle, (found, reach))| {
            found.filter(|(distance, _)| distance <= reach).map(|found| (muscle, found))
        });
        let within: Vec<(usize, (f64, Vector))> = within.collect();
        let nearest = within.iter().min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        let (muscle, (distance, axis)) = *nearest;
        Some(CellFibre { cell: cell as u32, muscle, distance, axis, muscles: within.len() })
    };
    near.iter().enumerate().filter_map(of_cell).collect()
}
