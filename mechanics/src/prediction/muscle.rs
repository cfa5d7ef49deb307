//! Muscles of a case: the cells that pull along their fibres, from a region or from polylines.
//!
//! A muscle that pulls with T adds T w f (x) f to the stress of a cell: w = 1 in a region, and around polylines
//! w = (1 - (d / r)²)² at the distance d < r of the nearest line, whose direction f is, as the mean over the quadrature points
//! of the cell. A single line pulls with the force int T w dA = pi r² T / 3, spread smoothly over its width, so that the skin
//! converges as the mesh is refined, which it would not under forces at single nodes.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::case::{Activation, FibreDirection, Muscle, MuscleCourse, Plan};
use super::check::Check;
use super::error_code::SceneErrorCode;
use super::fibres::unit;
use super::muscle_field::MuscleField;
use super::scene::Scene;
use crate::mesh::ignored::listed;
use crate::mesh::jacobian::signed_volume;
use crate::mesh::refinement::refine;
use crate::mesh::{ArrayUse, Vector, VolumeMesh, Warning};
use crate::model::fem::inner_stress::{CellStress, InnerStress};
use crate::model::reference_cell;

/// Stresses in kPa with which a muscle may pull.
pub const PULL: RangeInclusive<f64> = 0.0..=10_000.0;

/// A muscle of so few cells around lines is told.
const FEW_CELLS: usize = 20;

/// And one that pulls by more than this share otherwise than its lines say.
const PULL_OFF: f64 = 0.1;

impl Check<'_> {
    /// The muscles of the case.
    pub(super) fn muscles(&mut self, scene: &mut Scene) {
        let mut names = BTreeSet::new();
        for (index, muscle) in self.case.muscles.iter().enumerate() {
            let pointer = format!("/case/muscles/{index}");
            if !names.insert(&muscle.name) {
                let detail = format!("muscle {:?} is defined twice", muscle.name);
                let at = format!("{pointer}/name");
                self.problems.add(at, SceneErrorCode::PlanConflict, detail);
            }
            let cells = self.cells_of(muscle, &pointer, scene);
            scene.muscles.push(MuscleField { name: muscle.name.clone(), cells });
        }
    }

    fn cells_of(&mut self, muscle: &Muscle, pointer: &str, scene: &Scene) -> Vec<CellStress> {
        match &muscle.course {
            MuscleCourse::Region { region, fibres } => {
                let case = self.case;
                let own = fibres.as_ref().or_else(|| case.fibres.get(region));
                match own.or_else(|| case.fibres.get("*")) {
                    Some(course) => self.in_region(region, course, pointer, scene),
                    None => {
                        let detail = format!(
                            "region {region:?} has no fibres along which the muscle could pull: state `direction` or `array`"
                        );
                        self.problems.add(pointer, SceneErrorCode::MissingField, detail);
                        Vec::new()
                    }
                }
            }
            MuscleCourse::Lines { lines, within } => {
                let Some(course) = Lines::new(lines, *within) else {
                    self.no_tissue_near(&muscle.name, pointer);
                    return Vec::new();
                };
                let cells = course.cells(&scene.mesh);
                match cells.is_empty() {
                    true => self.no_tissue_near(&muscle.name, pointer),
                    false => {
                        let pull = PullShare::new(&course, &scene.mesh, &cells);
                        self.warnings.extend(pull.warning(&muscle.name));
                    }
                }
                cells
            }
        }
    }

    fn in_region(
        &mut self,
        region: &str,
        course: &FibreDirection,
        pointer: &str,
        scene: &Scene,
    ) -> Vec<CellStress> {
        let Some(number) = scene.regions.iter().position(|name| name == region) else {
            let known = listed(scene.regions.iter());
            let detail = format!("no region is called {region:?}; there are: {known}");
            let at = format!("{pointer}/region");
            self.problems.add(at, SceneErrorCode::UnknownRegion, detail);
            return Vec::new();
        };
        let vectors = match course {
            FibreDirection::Uniform(_) => None,
            FibreDirection::Array(array) => {
                let vectors = scene.mesh.cell_vectors.get(array);
                if vectors.is_none() {
                    let detail = scene.mesh.missing_array(ArrayUse::CellVectors, array);
                    let at = format!("{pointer}/array");
                    self.problems.add(at, SceneErrorCode::UnknownArray, detail);
                    return Vec::new();
                }
                vectors
            }
        };
        let of_region = scene.region_of_cell.iter().enumerate();
        let of_region = of_region.filter(|(_, own)| usize::from(**own) == number);
        let mut cells = Vec::new();
        let mut without = 0;
        for (cell, _) in of_region {
            let along = match (course, vectors) {
                (_, Some(vectors)) => vectors[cell],
                (FibreDirection::Uniform(direction), None) => *direction,
                (FibreDirection::Array(_), None) => Vector::zeros(),
            };
            match unit(&along) {
                Some(f) => {
                    cells.push(CellStress { cell: cell as u32, stress: f * f.transpose() });
                }
                None => without += 1,
            }
        }
        if without > 0 {
            let detail = format!(
                "{without} cells of region {region:?} have a fibre direction without length: the muscle pulls along none there"
            );
            self.problems.add(pointer, SceneErrorCode::FibreDirectionZero, detail);
        }
        cells
    }

    fn no_tissue_near(&mut self, name: &str, pointer: &str) {
        let detail = format!(
            "no cell has a point of its tissue near the lines of muscle {name:?}: are they in mm, in the frame of the case?"
        );
        let at = format!("{pointer}/lines_mm");
        self.problems.add(at, SceneErrorCode::EmptySelection, detail);
    }

    pub(super) fn activate(&mut self, plan: &Plan, scene: &Scene, inner: &mut InnerStress) {
        let mut seen = BTreeSet::new();
        for (index, Activation { muscle, stress }) in plan.activations.iter().enumerate() {
            let pointer = format!("/plan/activations/{index}");
            if !seen.insert(muscle) {
                let detail = format!("muscle {muscle:?} is activated twice");
                let at = format!("{pointer}/muscle");
                self.problems.add(at, SceneErrorCode::PlanConflict, detail);
            }
            if !PULL.contains(stress) {
                let (least, most) = (PULL.start(), PULL.end());
                let detail = format!("{stress} kPa is outside {least} to {most} kPa");
                let at = format!("{pointer}/stress_kpa");
                self.problems.add(at, SceneErrorCode::PlanOutOfRange, detail);
            }
            match scene.muscles.iter().find(|own| own.name == *muscle) {
                Some(field) => inner.pull(scene.mesh.cells.len(), &field.cells, *stress),
                None => {
                    let known = listed(scene.muscles.iter().map(|own| &own.name));
                    let detail = format!("the case has no muscle {muscle:?}; its muscles: {known}");
                    let at = format!("{pointer}/muscle");
                    self.problems.add(at, SceneErrorCode::UnknownMuscle, detail);
                }
            }
        }
    }
}

/// How much of the pull of lines the cells of a mesh carry: int w dV by their quadrature points over what it is in the same tissue
/// with every edge halved twice.
struct PullShare {
    cells: usize,
    share: f64,
}

impl PullShare {
    fn new(lines: &Lines, mesh: &VolumeMesh, cells: &[CellStress]) -> Self {
        let near = lines.tissue_near(mesh);
        let finer = refine(&refine(&near));
        let exact = pull_of(&finer, &lines.cells(&finer));
        PullShare { cells: cells.len(), share: pull_of(mesh, cells) / exact }
    }

    /// Where cells are so few or so coarse that the muscle pulls otherwise than its lines say.
    fn warning(&self, name: &str) -> Option<Warning> {
        let PullShare { cells, share } = *self;
        if cells >= FEW_CELLS && (share - 1.0).abs() <= PULL_OFF {
            return None;
        }
        let detail = format!(
            "{cells} cells have tissue near the lines of muscle {name:?}, and it pulls with {:.0} % of what lines of its width exert: \
             its pull is as coarse as they are; finer cells or a larger `within_mm` carry it",
            100.0 * share
        );
        let warning = Warning::new("muscle-few-cells", detail).with("cells", cells as f64);
        Some(warning.with("pull_share", share))
    }
}

/// int w dV in mm^3 of stresses w f (x) f.
fn pull_of(mesh: &VolumeMesh, cells: &[CellStress]) -> f64 {
    let of = |own: &CellStress| {
        let corners: Vec<Vector> = mesh.corners(own.cell as usize).collect();
        own.stress.trace() * signed_volume(mesh.cells.shape(own.cell as usize), &corners)
    };
    cells.iter().map(of).sum()
}

/// Squared distances that differ by less than this share of the squared reach are equal.
const EQUAL: f64 = 1e-9;

/// A straight piece of a line: its start, and the way to its end.
struct Piece {
    from: Vector,
    along: Vector,
}

/// The lines of a muscle.
struct Lines {
    pieces: Vec<Piece>,
    within: f64,
    /// The box around all that is within reach.
    low: Vector,
    high: Vector,
}

impl Lines {
    /// None where no line has a length.
    fn new(lines: &[Vec<Vector>], within: f64) -> Option<Self> {
        let pairs = lines.iter().flat_map(|line| line.windows(2));
        let pieces = pairs.map(|pair| Piece { from: pair[0], along: pair[1] - pair[0] });
        let pieces: Vec<Piece> = pieces.filter(|piece| unit(&piece.along).is_some()).collect();
        let first = pieces.first()?.from;
        let ends = pieces.iter().flat_map(|piece| [piece.from, piece.from + piece.along]);
        let (low, high) = ends.fold((first, first), |(l, h), x| (l.inf(&x), h.sup(&x)));
        let reach = Vector::repeat(within);
        Some(Lines { pieces, within, low: low - reach, high: high + reach })
    }

    /// w f (x) f of all cells where it is not zero.
    fn cells(&self, mesh: &VolumeMesh) -> Vec<CellStress> {
        let of_cell = |cell: usize| {
            let stress = self.mean(mesh, cell)?;
            Some(CellStress { cell: cell as u32, stress })
        };
        (0..mesh.cells.len()).into_par_iter().filter_map(of_cell).collect()
    }

    /// Whether a cell may have tissue within reach.
    fn may_reach(&self, corners: &[Vector]) -> bool {
        let Some(&first) = corners.first() else { return false };
        let (low, high) = corners.iter().fold((first, first), |(l, h), x| (l.inf(x), h.sup(x)));
        (0..3).all(|axis| high[axis] >= self.low[axis] && low[axis] <= self.high[axis])
    }

    /// The cells that may have tissue within reach.
    fn tissue_near(&self, mesh: &VolumeMesh) -> VolumeMesh {
        let mut near = VolumeMesh::default();
        let mut number_of = BTreeMap::new();
        for (cell, (shape, nodes)) in mesh.cells.iter().enumerate() {
            let corners: Vec<Vector> = mesh.corners(cell).collect();
            if !self.may_reach(&corners) {
                continue;
            }
            let numbered = nodes.iter().map(|&node| {
                *number_of.entry(node).or_insert_with(|| {
                    near.nodes.push(mesh.nodes[node as usize]);
                    near.nodes.len() as u32 - 1
                })
            });
            let numbered: Vec<u32> = numbered.collect();
            near.cells.push(shape, &numbered);
        }
        near
    }

    /// The mean over a cell; none where no point of it is within reach.
    fn mean(&self, mesh: &VolumeMesh, cell: usize) -> Option<Matrix3<f64>> {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        if !self.may_reach(&corners) {
            return None;
        }
        let (mut sum, mut volume) = (Matrix3::zeros(), 0.0);
        for point in &reference_cell(mesh.cells.shape(cell)).points {
            let physical = point.at(&corners)?;
            let place: Vector = corners.iter().zip(&point.values).map(|(x, n)| x * *n).sum();
            sum += self.at(&place) * physical.volume;
            volume += physical.volume;
        }
        (sum != Matrix3::zeros()).then(|| sum / volume)
    }

    /// w f (x) f at a place; where pieces are equally near, the mean of theirs, so that rounding does not choose.
    fn at(&self, place: &Vector) -> Matrix3<f64> {
        let reach = self.within * self.within;
        let (mut nearest, mut sum, mut count) = (reach, Matrix3::zeros(), 0.0);
        for piece in &self.pieces {
            let share = (place - piece.from).dot(&piece.along) / piece.along.norm_squared();
            let foot = piece.from + piece.along * share.clamp(0.0, 1.0);
            let squared = (place - foot).norm_squared();
            let Some(f) = unit(&piece.along).filter(|_| squared < nearest + EQUAL * reach) else {
                continue;
            };
            if squared < nearest - EQUAL * reach {
                (nearest, sum, count) = (squared, Matrix3::zeros(), 0.0);
            }
            sum += f * f.transpose();
            count += 1.0;
        }
        let fall = 1.0 - nearest / reach;
        if count == 0.0 { Matrix3::zeros() } else { sum * (fall * fall / count) }
    }
}
