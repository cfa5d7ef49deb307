//! Muscle fields on a mesh: the active stress of cells for each kPa of a muscle, its volume in them, and the equivalent
//! tissue of all muscles.

use super::case::{Muscle, MuscleCourse};
use crate::material::mixture::MixingRule;
use crate::mesh::{VolumeMesh, Warning};
use crate::model::fem::inner_stress::{CellStress, InnerStress};

/// A muscle, whether it pulls or not.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleField {
    pub name: String,
    /// w f (x) f of its cells, ascending, w the share of the cell that is muscle.
    pub cells: Vec<CellStress>,
    /// Of a muscle with a surface.
    pub body: Option<MuscleBody>,
    /// Whether it pulls around polylines.
    pub has_lines: bool,
    /// Whether its tissue becomes stiffer as it pulls, so that what it does is not in proportion to its stress.
    pub stiffens: bool,
}

/// Measures of the closed surface of a muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuscleBody {
    /// That it encloses, in mm³.
    pub enclosed: f64,
    /// In the mean: twice the volume for its area, in mm.
    pub thickness: f64,
    /// Of the second to the first standard deviation of the surface, where fibres run along its boxes.
    pub broadness: Option<f64>,
}

/// Tissue of a mesh with its muscles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuscleTissue {
    pub rule: MixingRule,
    /// Cells that have some muscle in them.
    pub cells: usize,
    /// Cells of several parts.
    pub mixed: usize,
    /// Cells whose fibres cross, so that one axis does not stand for them.
    pub crossing: usize,
    /// The share of the volume of the tissue in which Voigt's modulus is more than three times Reuss's.
    pub rule_decides: f64,
}

impl MuscleField {
    pub(super) fn new(muscle: &Muscle, cells: Vec<CellStress>, body: Option<MuscleBody>) -> Self {
        let (name, stiffens) = (muscle.name.clone(), muscle.stiffening.is_some());
        let has_lines = matches!(muscle.course, MuscleCourse::Lines { .. });
        MuscleField { name, cells, body, has_lines, stiffens }
    }

    /// Whether it has cells that pull.
    pub(super) fn is_active(&self, inner: &InnerStress) -> bool {
        let pulls = |cell: u32| inner.active.get(cell as usize).is_some_and(|s| s.norm() > 0.0);
        self.cells.iter().any(|own| pulls(own.cell))
    }

    /// Of the muscle in the tissue of its mesh, in mm³.
    pub fn volume(&self, mesh: &VolumeMesh) -> f64 {
        self.cells.iter().map(|own| muscle_volume(mesh, own)).sum()
    }

    /// What it exerts in a mesh of so many cells when it pulls with `stress` in kPa.
    pub fn pulling(&self, cells: usize, stress: f64) -> InnerStress {
        let mut inner = InnerStress::default();
        inner.pull(cells, &self.cells, stress);
        inner
    }
}

/// Of a muscle the share in the tissue below which it may lie elsewhere.
const MOSTLY: f64 = 0.5;

/// The warning of a muscle of which little lies in the tissue; `of` names the measured part.
pub(super) fn elsewhere(share: f64, of: &str, question: &str) -> Option<Warning> {
    let detail = format!("{:.0} % of {of} lies in the tissue: {question}", 100.0 * share);
    (share < MOSTLY).then(|| Warning::new("muscle-outside", detail).with("share", share))
}

/// The volume of a muscle in a cell, in mm³.
pub(super) fn muscle_volume(mesh: &VolumeMesh, own: &CellStress) -> f64 {
    own.stress.trace() * mesh.cell_volume(own.cell as usize)
}
