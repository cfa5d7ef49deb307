//! Quality of the cells of a volume mesh: volumes, dihedral angles, scaled Jacobians, folds.

use std::ops::Range;

use rayon::prelude::*;

use super::jacobian::{jacobian_sign, scaled_jacobian, signed_volume, smallest_jacobian};
use super::{CellShape, Vector, VolumeMesh, Warning};
use crate::progress::StopQuery;

/// Cells that a thread measures at a time.
const CHUNK: usize = 4096;

/// How many cells a report names of each kind.
const NAMED_CELLS: usize = 10;

/// Quality of all cells of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct QualityReport {
    pub cells: usize,
    /// Of one cell, in mm³; negative where it is inverted as a whole.
    pub smallest_volume: f64,
    pub largest_volume: f64,
    pub total_volume: f64,
    /// Of one cell: the determinant of the unit edge vectors at its worst corner, 1 for a regular cell.
    pub smallest_scaled_jacobian: f64,
    /// Cells by scaled Jacobian in steps of 0.1 from 0 to 1; what is below 0 is in the first.
    pub scaled_jacobian_histogram: [usize; 10],
    /// Hexahedra with positive corners that had to be divided before their sign was known.
    pub subdivided: usize,
    /// Cells whose Jacobian is zero or negative somewhere.
    pub inverted: usize,
    /// The first ten of them.
    pub inverted_cells: Vec<InvertedCell>,
    /// Cells whose Jacobian is so close to zero that its sign stayed unknown.
    pub undecided: usize,
    /// The first ten of them.
    pub undecided_cells: Vec<u32>,
}

/// A cell that is folded or flat somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvertedCell {
    pub cell: u32,
    /// The smallest Jacobian inside it, in mm³.
    pub jacobian: f64,
}

/// Angles between the faces of tetrahedra, in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct DihedralAngles {
    pub smallest: f64,
    pub largest: f64,
    /// Angles in steps of 10 degrees from 0 to 180.
    pub histogram: [usize; 18],
}

impl QualityReport {
    /// Warnings about a usable mesh.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.inverted > 0 {
            let detail = format!("{} of {} cells are inverted or flat", self.inverted, self.cells);
            let worst = self.inverted_cells.iter().map(|c| c.jacobian).fold(0.0, f64::min);
            warnings.push(
                Warning::new("mesh-inverted-elements", detail)
                    .with("count", self.inverted as f64)
                    .with("smallest_jacobian_mm3", worst),
            );
        }
        if self.undecided > 0 {
            let detail = format!(
                "the Jacobian of {} of {} cells is too close to zero to know its sign",
                self.undecided, self.cells
            );
            warnings.push(
                Warning::new("mesh-jacobian-undecided", detail)
                    .with("count", self.undecided as f64),
            );
        }
        warnings
    }
}

/// Measures every cell. A mesh without cells has volumes and Jacobians of zero.
pub fn quality(mesh: &VolumeMesh) -> QualityReport {
    quality_unless_stopped(mesh, &StopQuery::never())
}

/// The same; after a stop cells are left out, and the report is to be dropped.
pub fn quality_unless_stopped(mesh: &VolumeMesh, stop: &StopQuery) -> QualityReport {
    let measured = |cells: Range<usize>| match stop.is_asked() {
        true => (empty_report(0), Vec::new()),
        false => quality_of(mesh, cells),
    };
    let parts: Vec<(QualityReport, Vec<f64>)> = chunks(mesh).map(measured).collect();
    let mut report = empty_report(mesh.cells.len());
    for (part, volumes) in &parts {
        add_part(&mut report, part);
        // One cell after the other: a sum of sums has other last digits.
        report.total_volume = volumes.iter().fold(report.total_volume, |sum, volume| sum + volume);
    }
    if mesh.cells.is_empty() {
        [report.smallest_volume, report.largest_volume, report.smallest_scaled_jacobian] = [0.0; 3];
    }
    report
}

/// The cells in pieces that threads take.
fn chunks(mesh: &VolumeMesh) -> impl IndexedParallelIterator<Item = Range<usize>> {
    let cells = mesh.cells.len();
    (0..cells.div_ceil(CHUNK))
        .into_par_iter()
        .map(move |chunk| chunk * CHUNK..cells.min((chunk + 1) * CHUNK))
}

/// Everything of some cells but the sum of their volumes, and the volumes.
fn quality_of(mesh: &VolumeMesh, cells: Range<usize>) -> (QualityReport, Vec<f64>) {
    let mut report = empty_report(cells.len());
    let mut volumes = Vec::with_capacity(cells.len());
    let mut corners = Vec::with_capacity(8);
    for cell in cells {
        corners.clear();
        corners.extend(mesh.corners(cell));
        let shape = mesh.cells.shape(cell);
        volumes.push(add_size_and_shape(&mut report, shape, &corners));
        add_sign(&mut report, cell as u32, shape, &corners);
    }
    (report, volumes)
}

/// Adds what was found of the cells that follow, but for the sum of their volumes.
fn add_part(report: &mut QualityReport, part: &QualityReport) {
    report.smallest_volume = report.smallest_volume.min(part.smallest_volume);
    report.largest_volume = report.largest_volume.max(part.largest_volume);
    report.smallest_scaled_jacobian =
        report.smallest_scaled_jacobian.min(part.smallest_scaled_jacobian);
    add_counts(&mut report.scaled_jacobian_histogram, &part.scaled_jacobian_histogram);
    report.subdivided += part.subdivided;
    report.inverted += part.inverted;
    report.undecided += part.undecided;
    add_named(&mut report.inverted_cells, &part.inverted_cells);
    add_named(&mut report.undecided_cells, &part.undecided_cells);
}

fn add_counts(counts: &mut [usize], others: &[usize]) {
    counts.iter_mut().zip(others).for_each(|(count, other)| *count += other);
}

fn add_named<T: Copy>(named: &mut Vec<T>, others: &[T]) {
    let free = NAMED_CELLS - named.len();
    named.extend(others.iter().take(free));
}

fn empty_report(cells: usize) -> QualityReport {
    QualityReport {
        cells,
        smallest_volume: f64::INFINITY,
        largest_volume: f64::NEG_INFINITY,
        total_volume: 0.0,
        smallest_scaled_jacobian: f64::INFINITY,
        scaled_jacobian_histogram: [0; 10],
        subdivided: 0,
        inverted: 0,
        inverted_cells: Vec::new(),
        undecided: 0,
        undecided_cells: Vec::new(),
    }
}

/// Returns the volume, which is in no sum yet.
fn add_size_and_shape(report: &mut QualityReport, shape: CellShape, corners: &[Vector]) -> f64 {
    let volume = signed_volume(shape, corners);
    report.smallest_volume = report.smallest_volume.min(volume);
    report.largest_volume = report.largest_volume.max(volume);
    let scaled = scaled_jacobian(shape, corners);
    report.smallest_scaled_jacobian = report.smallest_scaled_jacobian.min(scaled);
    report.scaled_jacobian_histogram[((scaled * 10.0) as usize).min(9)] += 1;
    volume
}

fn add_sign(report: &mut QualityReport, cell: u32, shape: CellShape, corners: &[Vector]) {
    let sign = jacobian_sign(shape, corners);
    report.subdivided += usize::from(sign.halvings > 0);
    if sign.is_inverted() {
        report.inverted += 1;
        if report.inverted_cells.len() < NAMED_CELLS {
            let jacobian = smallest_jacobian(shape, corners).upper;
            report.inverted_cells.push(InvertedCell { cell, jacobian });
        }
    } else if !sign.is_valid() {
        report.undecided += 1;
        if report.undecided_cells.len() < NAMED_CELLS {
            report.undecided_cells.push(cell);
        }
    }
}

impl DihedralAngles {
    /// Those of all tetrahedra of a mesh, if there are any.
    pub fn of(mesh: &VolumeMesh) -> Option<DihedralAngles> {
        let none = DihedralAngles { smallest: f64::INFINITY, largest: 0.0, histogram: [0; 18] };
        let mut corners = Vec::with_capacity(4);
        let cells = 0..mesh.cells.len();
        let tetrahedra = cells.filter(|&cell| mesh.cells.shape(cell) == CellShape::Tet4);
        tetrahedra.fold(None, |angles, cell| {
            corners.clear();
            corners.extend(mesh.corners(cell));
            let angles = angles.unwrap_or_else(|| none.clone());
            Some(dihedral_angles(&corners).into_iter().fold(angles, DihedralAngles::with))
        })
    }

    fn with(mut self, angle: f64) -> DihedralAngles {
        self.smallest = self.smallest.min(angle);
        self.largest = self.largest.max(angle);
        self.histogram[((angle.to_degrees() / 10.0) as usize).min(17)] += 1;
        self
    }
}

/// The six angles between the faces of a tetrahedron, in radians; 0 at an edge of a face without area.
pub fn dihedral_angles(corners: &[Vector]) -> [f64; 6] {
    // An edge, and the two corners that are not on it.
    const EDGES: [[usize; 4]; 6] =
        [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];
    EDGES.map(|[from, to, one, other]| {
        let edge = corners[to] - corners[from];
        let normals = [one, other].map(|corner| edge.cross(&(corners[corner] - corners[from])));
        // The arc tangent keeps its digits for slivers, where the arc cosine loses half of them.
        normals[0].cross(&normals[1]).norm().atan2(normals[0].dot(&normals[1]))
    })
}
