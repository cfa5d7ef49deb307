//! Models in the order of their cost, and the error that is expected of each.

use super::accepted::MeanErrors;

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

    #[test]
    fn an_answer_of_finite_strain_has_its_own_error_or_none() {
        let mesh = MeanErrors { skin_mm: 0.2, regions_mm: Default::default() };
        let errors = Errors { mesh: Some(mesh.clone()), ..Errors::default() };
        assert_eq!(errors.expected(Rung::FiniteStrain), Some(mesh));
        assert_eq!(errors.on(Rung::FiniteStrain), None);
    }
}
