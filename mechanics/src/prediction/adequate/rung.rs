//! Models in the order of their cost, and the error that is expected of each.

use super::accepted::MeanErrors;
use crate::mesh::{CellShape, Vector};
use crate::model::fem::finite_strain::COLLAPSED;
use crate::model::problem::Equilibrium;
use crate::prediction::following_pressure::has_pressure;
use crate::prediction::scene::Scene;
use crate::prediction::stiff_layer::has_stiff_layers;

/// What is left of the error of a mesh where its estimate is added, as a share of the estimate.
const LEFT_BY_CORRECTION: f64 = 0.8;

/// Where forces act, tissue grows or muscles pull, what coarse meshes leave out was up to three times its estimate: so much of it is expected.
const LOADED: f64 = 2.0;

/// The same again where pressure follows its faces: the last tangent, with which errors are estimated, leaves out how it turns.
const PRESSED: f64 = 2.0;

/// The same where layers of one cell are much stiffer than what is beside them.
const WITH_STIFF_LAYERS: f64 = 2.0;

/// Where cells all but collapse, so many times.
const LEFT_OUT: f64 = 2.0;

/// A rung that is not adequate is tried if it is expected to leave at most this share of the error so far, and one is as good as
/// the best if its error is at most so many times as large.
pub(super) const WORTHWHILE: f64 = 0.8;

/// Differences of an error below this share of it are rounding: what a correction leaves is as good as the best by the same share that
/// it leaves, and the uncorrected answer is exactly at that limit.
const ROUNDING: f64 = 1e-9;

/// How many times its estimate the error of the mesh of a scene is expected to be.
pub fn error_over_estimate(scene: &Scene) -> f64 {
    let acts = scene.forces.iter().any(|force| *force != Vector::zeros());
    // At finite strain what grows and pulls is no force on nodes.
    let loaded = if acts || !scene.distributed.inner.is_zero() { LOADED } else { 1.0 };
    loaded * if has_stiff_layers(scene) { WITH_STIFF_LAYERS } else { 1.0 }
}

/// The same of an answer at finite strain: estimates leave out the inner modes of cells that all but collapse.
pub(super) fn error_over_estimate_at_rest(scene: &Scene, answer: &Equilibrium) -> f64 {
    let collapsed = if collapses(scene, answer) { LEFT_OUT } else { 1.0 };
    let pressed = if has_pressure(scene) { PRESSED } else { 1.0 };
    error_over_estimate(scene) * collapsed * pressed
}

/// Whether hexahedra or wedges all but collapse at finite strain.
pub(super) fn collapses(scene: &Scene, answer: &Equilibrium) -> bool {
    let mut shapes = scene.mesh.cells.iter().map(|(shape, _)| shape);
    let has_modes = shapes.any(|shape| shape != CellShape::Tet4);
    let newton = answer.solver.newton.as_ref();
    has_modes && newton.is_some_and(|newton| newton.least_det_f < COLLAPSED)
}

/// The first of rungs that is adequate, or else the first that is nearly as good as the best; each with its error as a share of the
/// accepted one.
pub(super) fn cheapest(shares: &[(Rung, f64)]) -> Option<Rung> {
    let least = shares.iter().map(|(_, share)| *share).fold(f64::INFINITY, f64::min);
    let enough = if least <= 1.0 { 1.0 } else { least / WORTHWHILE * (1.0 + ROUNDING) };
    let mut shares = shares.iter();
    shares.find(|(_, share)| *share <= enough).map(|(rung, _)| *rung)
}

/// A way to predict, of rising cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rung {
    Linear,
    Corrected,
    SecondOrder,
    SecondOrderCorrected,
    FiniteStrain,
    FiniteStrainCorrected,
}

/// Mean errors, as far as they are known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of the mesh, estimated with the linear answer.
    pub mesh: Option<MeanErrors>,
    /// Linearisation error.
    pub linearity: Option<MeanErrors>,
    /// Error beyond the second order.
    pub third_order: Option<MeanErrors>,
    /// Of the mesh, at rest at finite strain.
    pub mesh_at_rest: Option<MeanErrors>,
}

/// A rung that was stood on or passed over.
#[derive(Clone, Debug, PartialEq)]
pub struct Considered {
    pub rung: Rung,
    /// The mean errors that are expected of it; none where they are not known.
    pub error: Option<MeanErrors>,
    /// Time spent on it in s, where it was tried; a corrected answer takes none of its own.
    pub spent_s: Option<f64>,
    /// Time it was expected to take in s.
    pub expected_s: f64,
    /// Why it was not tried, or not possible.
    pub passed_over: Option<String>,
}

impl Rung {
    pub const ALL: [Rung; 6] = [
        Rung::Linear,
        Rung::Corrected,
        Rung::SecondOrder,
        Rung::SecondOrderCorrected,
        Rung::FiniteStrain,
        Rung::FiniteStrainCorrected,
    ];

    /// As documents call it.
    pub fn name(self) -> &'static str {
        match self {
            Rung::Linear => "linear",
            Rung::Corrected => "corrected",
            Rung::SecondOrder => "second_order",
            Rung::SecondOrderCorrected => "second_order_corrected",
            Rung::FiniteStrain => "finite_strain",
            Rung::FiniteStrainCorrected => "finite_strain_corrected",
        }
    }

    /// Whether what the mesh leaves out is added.
    pub fn is_corrected(self) -> bool {
        match self {
            Rung::Linear | Rung::SecondOrder | Rung::FiniteStrain => false,
            Rung::Corrected | Rung::SecondOrderCorrected | Rung::FiniteStrainCorrected => true,
        }
    }

    /// The rung whose solution it takes.
    pub fn solution(self) -> Rung {
        match self {
            Rung::Linear | Rung::Corrected => Rung::Linear,
            Rung::SecondOrder | Rung::SecondOrderCorrected => Rung::SecondOrder,
            Rung::FiniteStrain | Rung::FiniteStrainCorrected => Rung::FiniteStrain,
        }
    }
}

impl Errors {
    /// Those that are expected of an answer before it is there: its mesh leaves out as much at finite strain.
    pub(super) fn expected(&self, rung: Rung) -> Option<MeanErrors> {
        let mesh_at_rest = self.mesh_at_rest.clone().or_else(|| self.mesh.clone());
        Errors { mesh_at_rest, ..self.clone() }.on(rung)
    }

    /// The mean errors of an answer of a rung: of the mesh, and of the model.
    pub(super) fn on(&self, rung: Rung) -> Option<MeanErrors> {
        let (mesh, model) = match rung.solution() {
            Rung::SecondOrder | Rung::SecondOrderCorrected => {
                (self.mesh.as_ref()?, Some(self.third_order.as_ref()?))
            }
            Rung::FiniteStrain | Rung::FiniteStrainCorrected => (self.mesh_at_rest.as_ref()?, None),
            Rung::Linear | Rung::Corrected => (self.mesh.as_ref()?, Some(self.linearity.as_ref()?)),
        };
        let left = if rung.is_corrected() { LEFT_BY_CORRECTION } else { 1.0 };
        let mesh = mesh.map(|error| left * error);
        Some(model.map_or_else(|| mesh.clone(), |model| mesh.plus(model)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::adequate::Accepted;

    fn none() -> MeanErrors {
        MeanErrors { skin_mm: 0.0, regions_mm: Default::default() }
    }

    #[test]
    fn an_answer_of_finite_strain_has_its_own_error_or_none() {
        let mesh = MeanErrors { skin_mm: 0.2, ..none() };
        let errors = Errors { mesh: Some(mesh.clone()), ..Errors::default() };
        assert_eq!(errors.expected(Rung::FiniteStrain), Some(mesh));
        assert_eq!(errors.on(Rung::FiniteStrain), None);
    }

    #[test]
    fn of_an_answer_and_its_correction_that_leaves_four_fifths_the_answer_is_taken() {
        for number in 1..=1000 {
            let mesh = MeanErrors { skin_mm: 0.1 + 1e-3 / f64::from(number), ..none() };
            let errors = Errors { mesh_at_rest: Some(mesh), ..Errors::default() };
            for skin_mm in [0.01, 0.03, 0.05, 0.07, 0.08] {
                let accepted = Accepted { skin_mm, ..Accepted::default() };
                let rungs = [Rung::FiniteStrain, Rung::FiniteStrainCorrected];
                let shares = rungs.map(|rung| (rung, accepted.share(errors.on(rung).as_ref())));
                assert_eq!(cheapest(&shares), Some(Rung::FiniteStrain), "{shares:?}");
            }
        }
        let shares = [(Rung::FiniteStrain, 1.3), (Rung::FiniteStrainCorrected, 1.03)];
        assert_eq!(cheapest(&shares), Some(Rung::FiniteStrainCorrected));
    }
}
