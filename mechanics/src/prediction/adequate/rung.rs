//! Ways to predict in the order of their cost, and the error that is expected of each.

use super::accepted::MeanErrors;
use crate::mesh::Vector;

/// What is left of the error of a mesh where its estimate is added, as a share of the estimate.
const LEFT_BY_CORRECTION: f64 = 0.8;

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
    /// What linearity leaves out.
    pub linearity: Option<MeanErrors>,
    /// What the second order leaves out.
    pub third_order: Option<MeanErrors>,
    /// Of the mesh, at rest at finite strain.
    pub mesh_at_rest: Option<MeanErrors>,
    /// Of the mesh and the model together, of linear answers and of those to second order.
    pub linear: Option<Together>,
    pub second_order: Option<Together>,
}

/// Mean lengths of what the mesh and the model leave out, added as vectors; and where the estimate of the mesh is added.
#[derive(Clone, Debug, PartialEq)]
pub struct Together {
    pub plain: MeanErrors,
    pub corrected: MeanErrors,
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
    /// The mean errors of an answer of a rung: of the mesh, and of the model.
    pub(super) fn on(&self, rung: Rung) -> Option<MeanErrors> {
        let at_rest = self.mesh_at_rest.as_ref().or(self.mesh.as_ref());
        match rung {
            Rung::Linear => Some(self.linear.as_ref()?.plain.clone()),
            Rung::Corrected => Some(self.linear.as_ref()?.corrected.clone()),
            Rung::SecondOrder => Some(self.second_order.as_ref()?.plain.clone()),
            Rung::SecondOrderCorrected => Some(self.second_order.as_ref()?.corrected.clone()),
            Rung::FiniteStrain => at_rest.cloned(),
            Rung::FiniteStrainCorrected => Some(at_rest?.map(|error| LEFT_BY_CORRECTION * error)),
        }
    }

    /// The least that a corrected answer may be off by, of the means of what its mesh and its model leave out.
    pub(super) fn corrected_at_least(mesh: &MeanErrors, model: &MeanErrors) -> MeanErrors {
        mesh.map(|error| LEFT_BY_CORRECTION * error).beside(model)
    }
}

/// What is left at a place of an answer once the estimate of its mesh is added: it has no direction that is known.
pub(super) fn left_by_correction(mesh: &Vector, model: &Vector) -> f64 {
    (LEFT_BY_CORRECTION * mesh.norm()).hypot(model.norm())
}
