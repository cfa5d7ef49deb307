//! Muscles of a case: the cells that pull along their fibres, in a region, around polylines, or inside a closed surface.
//!
//! A muscle that pulls with T adds T w f (x) f to the stress of a cell, w the share of the cell that is muscle and f its direction:
//! w = 1 in a region, the share of sample points inside a surface, and around polylines w = (1 - (d / r)²)² at the distance
//! d < r of the nearest line, as the mean over the quadrature points of the cell. A single line pulls with the force
//! int T w dA = pi r² T / 3, spread smoothly over its width, so that the skin converges as the mesh is refined, which it would not
//! under forces at single nodes.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use super::case::{Activation, BodyFibres, FibreDirection, MuscleCourse, Plan};
use super::check::Check;
use super::error_code::SceneErrorCode;
use super::fibres::{Course, unit};
use super::hounsfield::TissueOfCells;
use super::method::Method;
use super::muscle_field::{MuscleBody, MuscleField, MuscleTissue, elsewhere};
use super::muscle_lines::{Lines, PullShare};
use super::muscle_work::NearMuscles;
use super::scene::Scene;
use crate::mesh::ignored::{listed, missing_region};
use crate::mesh::{ArrayUse, TriangleSurface, Vector, VolumeMesh, Warning, bounds_of, place};
use crate::model::fem::inner_stress::{CellStress, InnerStress};
use crate::muscle::lines::nearest;
use crate::muscle::share::shares_of;
use crate::muscle::strap::{Strap, strap_of};

/// Stresses in kPa with which a muscle may pull.
pub const PULL: RangeInclusive<f64> = 0.0..=10_000.0;

/// A body thinner than this many ways between sample points may be missed by them.
const THIN: f64 = 2.0;
/// A share of the volume of a body by which samples may be off.
const VOLUME_OFF: f64 = 0.1;

/// Directions in the cells of a mesh, of any length.
enum FibreDirections<'a> {
    Uniform(Vector),
    Array(Course<'a>),
    Strap(Strap),
    Lines(&'a [Vec<Vector>]),
}

impl FibreDirections<'_> {
    fn at(&self, mesh: &VolumeMesh, cell: usize) -> Option<Vector> {
        let middle = || mesh.centroid(cell);
        let along = match self {
            FibreDirections::Uniform(direction) => *direction,
            FibreDirections::Array(course) => course.axis(cell).along,
            FibreDirections::Strap(strap) => strap.axis_at(&middle())?,
            FibreDirections::Lines(lines) => nearest(&middle(), lines)?.1,
        };
        unit(&along)
    }
}

impl<'a> Check<'a> {
    /// The muscles of a case that is right so far, in regions with these names and the region of each cell, and what they make
    /// of its tissue and of the fibres of its cells.
    pub(super) fn muscles_of_cells(
        &mut self,
        (regions, region_of_cell): (&[String], &[u16]),
        (tissue, fibres): (&mut TissueOfCells, &mut Vec<Vector>),
        (method, plan): (&Method, &Plan),
    ) -> (Vec<MuscleField>, Option<MuscleTissue>) {
        if self.problems.count() > 0 {
            return (Vec::new(), None);
        }
        let Some(near) = self.near_muscles() else { return (Vec::new(), None) };
        let muscles = self.muscles(regions, region_of_cell, &near);
        let made = self.muscle_tissue(&muscles, (tissue, fibres), (method, plan));
        (muscles, made)
    }

    fn muscles(
        &mut self,
        regions: &[String],
        region_of_cell: &[u16],
        near: &NearMuscles,
    ) -> Vec<MuscleField> {
        let mut names = BTreeSet::new();
        let mut fields = Vec::new();
        for (index, muscle) in self.case.muscles.iter().enumerate() {
            if self.stop.is_asked() {
                return Vec::new();
            }
            let near = &near.cells(index)[..];
            let pointer = format!("/case/muscles/{index}");
            if !names.insert(&muscle.name) {
                let detail = format!("muscle {:?} is defined twice", muscle.name);
                let at = format!("{pointer}/name");
                self.problems.add(at, SceneErrorCode::PlanConflict, detail);
            }
            let (cells, body) = match &muscle.course {
                MuscleCourse::Region { region, fibres } => {
                    let cells = self.cells_of_region(region, regions, region_of_cell, &pointer);
                    let along = match cells.is_empty() {
                        true => None,
                        false => self.along_in_region(region, fibres.as_ref(), &pointer),
                    };
                    let whole = cells.into_iter().map(|cell| (cell, 1.0));
                    (self.directed(whole, along, &pointer), None)
                }
                MuscleCourse::Lines { lines, within } => {
                    (self.around(lines, *within, near, (&muscle.name, &pointer)), None)
                }
                MuscleCourse::Body { surface, fibres } => {
                    self.inside((surface, fibres), near, (index, &muscle.name), &pointer)
                }
            };
            let field = MuscleField::new(muscle, cells, body);
            self.warnings.extend(body_elsewhere(&field, &self.case.volume));
            self.warnings.extend(self.body_missed(&field));
            fields.push(field);
        }
        fields
    }

    fn cells_of_region(
        &mut self,
        region: &str,
        regions: &[String],
        region_of_cell: &[u16],
        pointer: &str,
    ) -> Vec<usize> {
        let Some(number) = regions.iter().position(|name| name == region) else {
            let detail = missing_region(region, regions.iter());
            let at = format!("{pointer}/region");
            self.problems.add(at, SceneErrorCode::UnknownRegion, detail);
            return Vec::new();
        };
        let cells = region_of_cell.iter().enumerate();
        cells.filter(|(_, own)| usize::from(**own) == number).map(|(cell, _)| cell).collect()
    }

    /// The fibres that are stated, or else those of the material of the region.
    fn along_in_region(
        &mut self,
        region: &str,
        fibres: Option<&'a FibreDirection>,
        pointer: &str,
    ) -> Option<FibreDirections<'a>> {
        let case = self.case;
        let own = fibres.or_else(|| case.fibres.get(region)).or_else(|| case.fibres.get("*"));
        match own {
            Some(course) => self.along(course, pointer),
            None => {
                let detail = format!(
                    "region {region:?} has no fibres along which the muscle could pull: state `direction` or `array`"
                );
                self.problems.add(pointer, SceneErrorCode::MissingField, detail);
                None
            }
        }
    }

    fn along(&mut self, course: &FibreDirection, pointer: &str) -> Option<FibreDirections<'a>> {
        let array = match course {
            FibreDirection::Uniform(direction) => {
                return Some(FibreDirections::Uniform(*direction));
            }
            FibreDirection::Array(array) => array,
        };
        let found = Course::of(&self.case.volume, array);
        if found.is_none() {
            let detail = self.case.volume.missing_array(ArrayUse::CellVectors, array);
            let at = format!("{pointer}/array");
            self.problems.add(at, SceneErrorCode::UnknownArray, detail);
        }
        found.map(FibreDirections::Array)
    }

    /// w f (x) f of cells and their shares.
    fn directed(
        &mut self,
        shares: impl IntoIterator<Item = (usize, f64)>,
        along: Option<FibreDirections>,
        pointer: &str,
    ) -> Vec<CellStress> {
        let Some(along) = along else { return Vec::new() };
        let (mut cells, mut without) = (Vec::new(), 0);
        for (cell, share) in shares {
            match along.at(&self.case.volume, cell) {
                Some(f) => {
                    let stress = f * f.transpose() * share;
                    cells.push(CellStress { cell: cell as u32, stress });
                }
                None => without += 1,
            }
        }
        if without > 0 {
            let detail = format!(
                "{without} cells of the muscle have a fibre direction without length: it pulls along none there"
            );
            self.problems.add(pointer, SceneErrorCode::FibreDirectionZero, detail);
        }
        cells
    }

    fn around(
        &mut self,
        lines: &[Vec<Vector>],
        within: f64,
        near: &[u32],
        (name, pointer): (&str, &str),
    ) -> Vec<CellStress> {
        let (course, mesh) = (Lines::new(lines, within), &self.case.volume);
        let cells = course.as_ref().map_or_else(Vec::new, |own| own.cells(mesh, near, self.stop));
        match &course {
            Some(course) if !cells.is_empty() => {
                let pull = PullShare::new(course, mesh, (near, &cells), self.stop);
                self.warnings.extend(pull.warnings(name));
            }
            _ => {
                let detail = match &course {
                    None => format!(
                        "the lines of muscle {name:?} have no length: all points of each are at one place"
                    ),
                    Some(_) => format!(
                        "no cell has a point of its tissue near the lines of muscle {name:?}: are they in mm, in the frame of the case?"
                    ),
                };
                let at = format!("{pointer}/lines_mm");
                self.problems.add(at, SceneErrorCode::EmptySelection, detail);
            }
        }
        cells
    }

    fn inside(
        &mut self,
        (surface, fibres): (&TriangleSurface, &'a BodyFibres),
        near: &[u32],
        (number, name): (usize, &str),
        pointer: &str,
    ) -> (Vec<CellStress>, Option<MuscleBody>) {
        let samples = self.case.muscle_mixing.samples;
        let of = (surface, number);
        let shares = match shares_of(&self.case.volume, near, of, samples, self.stop) {
            Ok(shares) => shares,
            Err(error) => {
                let at = format!("{pointer}/surface");
                self.problems.add(at, SceneErrorCode::NoInside, error.to_string());
                return (Vec::new(), None);
            }
        };
        let of_cells = near.iter().map(|&cell| cell as usize).zip(shares);
        let filled: Vec<(usize, f64)> = of_cells.filter(|(_, share)| *share > 0.0).collect();
        if filled.is_empty() {
            let detail = format!(
                "no cell has a sample point inside muscle {name:?}, which {}; the mesh {}: are both in the same frame and unit, and is it thicker than the way between sample \
                 points?",
                reach(&surface.points),
                reach(&self.case.volume.nodes)
            );
            self.problems.add(pointer, SceneErrorCode::EmptySelection, detail);
            return (Vec::new(), None);
        }
        let mut broadness = None;
        let along = match fibres {
            BodyFibres::Course(course) => self.along(course, pointer),
            BodyFibres::Lines(lines) => Some(FibreDirections::Lines(lines)),
            BodyFibres::Box { halvings } => strap_of(surface, *halvings).map(|strap| {
                broadness = Some(strap.broadness);
                self.warnings.extend(not_a_strap(name, &strap));
                FibreDirections::Strap(strap)
            }),
        };
        let enclosed = surface.signed_volume().abs();
        let body = MuscleBody { enclosed, thickness: 2.0 * enclosed / surface.area(), broadness };
        (self.directed(filled, along, pointer), Some(body))
    }

    /// The warning of a body so thin that the samples of cells have another volume than its surface encloses.
    fn body_missed(&self, field: &MuscleField) -> Option<Warning> {
        let body = field.body.filter(|_| !field.cells.is_empty())?;
        let mesh = &self.case.volume;
        let cells = field.cells.iter().map(|own| own.cell as usize);
        let of_cells: f64 = cells.map(|cell| mesh.cell_volume(cell)).sum();
        let samples = (field.cells.len() * self.case.muscle_mixing.samples) as f64;
        let apart = (of_cells / samples).cbrt();
        let share = field.volume(mesh) / body.enclosed;
        let is_thin = body.thickness < THIN * apart;
        let is_off = share > 1.0 + VOLUME_OFF || is_thin && share < 1.0 - VOLUME_OFF;
        let detail = format!(
            "muscle {:?} is {:.2} mm thick in the mean, sample points of its cells are {apart:.2} mm apart, and they hold {:.0} % of its \
             volume: so much of it pulls; finer cells or more `samples` hold it",
            field.name,
            body.thickness,
            100.0 * share
        );
        let warning =
            Warning::new("muscle-few-cells", detail).with("cells", field.cells.len() as f64);
        is_off.then(|| warning.with("pull_share", share))
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

/// The warning of a body of which little lies in the tissue.
fn body_elsewhere(field: &MuscleField, mesh: &VolumeMesh) -> Option<Warning> {
    let body = field.body.filter(|_| !field.cells.is_empty())?;
    let of = format!("the volume of muscle {:?}", field.name);
    elsewhere(field.volume(mesh) / body.enclosed, &of, "are both in the same frame?")
}

/// The warning of a broad muscle whose fibres are taken from its boxes.
fn not_a_strap(name: &str, strap: &Strap) -> Option<Warning> {
    let detail = format!(
        "muscle {name:?} is no strap, {:.2} times as broad as long, and fibres of broad muscles may run across the longest axis of \
         their box: state `direction`, `array` or `lines_mm`",
        strap.broadness
    );
    strap
        .is_broad()
        .then(|| Warning::new("muscle-broad", detail).with("broadness", strap.broadness))
}

/// `reaches from (0.0, 0.0, 0.0) to (1.0, 1.0, 1.0) mm`.
fn reach(points: &[Vector]) -> String {
    let Some([low, high]) = bounds_of(points) else { return "has no points".to_owned() };
    format!("reaches from {} to {} mm", place(&low, 1), place(&high, 1))
}
