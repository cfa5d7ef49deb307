//! Estimated errors of answers beside their true errors.
//!
//! Effectivity is the estimated mean error over the true one. Of the mesh |m|, at the skin nodes of level 0; where the truth is one
//! of finite strain and the answer is linear, of mesh and linearity together, |m + l|. A model that was chosen by its error tells a
//! mean over the skin that moves, and is held against the true mean there.

use super::variant::Strain;
use crate::mesh::Vector;
use crate::prediction::least_moving;

/// True errors in mm below which an effectivity says nothing: a hundred times what solving to the usual residual leaves open.
const NO_ERROR: f64 = 1e-4;

/// What an answer is estimated to be off by, at the nodes that were asked for.
#[derive(Default)]
pub(super) struct Estimates {
    /// Discretisation error, in mm.
    pub mesh: Option<Vec<Vector>>,
    /// Linearisation error, in mm.
    pub linearity: Option<Vec<Vector>>,
    /// The mean error that is expected over the nodes that move, where that chose the model, in mm.
    pub of_moving: Option<f64>,
}

/// True errors at the nodes that were asked for, with their areas.
pub(super) struct TrueErrors<'a> {
    /// In mm, as lengths.
    pub errors: &'a [f64],
    pub areas: &'a [f64],
    /// None where it is not known what the truth takes for strain.
    pub strain: Option<Strain>,
}

impl Estimates {
    /// The mean error that is expected of an answer with this displacement over the true one.
    pub(super) fn effectivity(
        &self,
        displacement: &[Vector],
        own: Strain,
        truth: &TrueErrors,
    ) -> Option<f64> {
        let strain = truth.strain?;
        let (expected, actual) = match (self.of_moving, strain) {
            (Some(expected), Strain::Finite) => (expected, mean_of_moving(displacement, truth)),
            (Some(_), Strain::Small) => return None,
            (None, _) => {
                (mean(&self.lengths(own, strain)?, truth.areas), mean(truth.errors, truth.areas))
            }
        };
        (actual > NO_ERROR).then_some(expected / actual).filter(|ratio| ratio.is_finite())
    }

    /// The expected error of each node in mm, where all of it is known.
    fn lengths(&self, own: Strain, truth: Strain) -> Option<Vec<f64>> {
        let mesh = self.mesh.as_ref()?;
        match (own, truth) {
            (Strain::Small, Strain::Small) | (Strain::Finite, Strain::Finite) => {
                Some(lengths(mesh))
            }
            (Strain::Small, Strain::Finite) => {
                let both = mesh.iter().zip(self.linearity.as_ref()?);
                Some(both.map(|(mesh, linearity)| (mesh + linearity).norm()).collect())
            }
            (Strain::Finite, Strain::Small) => None,
        }
    }
}

pub(super) fn lengths(vectors: &[Vector]) -> Vec<f64> {
    vectors.iter().map(|vector| vector.norm()).collect()
}

fn mean(values: &[f64], areas: &[f64]) -> f64 {
    let sum: f64 = values.iter().zip(areas).map(|(value, area)| value * area).sum();
    sum / areas.iter().sum::<f64>()
}

/// Node by node, as models are chosen.
fn mean_of_moving(displacement: &[Vector], truth: &TrueErrors) -> f64 {
    let least = least_moving(displacement.iter().map(|u| u.norm()));
    let moving = displacement.iter().zip(truth.errors).filter(|(u, _)| u.norm() >= least);
    let (sum, count) =
        moving.fold((0.0, 0.0), |(sum, count), (_, error)| (sum + error, count + 1.0));
    sum / f64::max(count, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(lengths: &[f64]) -> Vec<Vector> {
        lengths.iter().map(|length| Vector::x() * *length).collect()
    }

    #[test]
    fn what_linearity_leaves_out_counts_against_a_truth_of_finite_strain_only() {
        let own = Estimates {
            mesh: Some(along(&[0.2, 0.4])),
            linearity: Some(along(&[0.6, 0.4])),
            of_moving: None,
        };
        let (errors, areas) = ([1.0, 1.0], [1.0, 3.0]);
        let moved = along(&[2.0, 2.0]);
        let against = |strain| TrueErrors { errors: &errors, areas: &areas, strain };
        let of = |of_answer, strain| own.effectivity(&moved, of_answer, &against(strain));
        let (small, finite) = (Strain::Small, Strain::Finite);
        // Rounding only.
        assert!((of(small, Some(small)).unwrap() - 0.35).abs() < 1e-12);
        assert!((of(small, Some(finite)).unwrap() - 0.8).abs() < 1e-12);
        assert!((of(finite, Some(finite)).unwrap() - 0.35).abs() < 1e-12);
        assert_eq!((of(finite, Some(small)), of(small, None)), (None, None));
    }

    #[test]
    fn an_error_that_chose_the_model_is_held_against_the_skin_that_moves() {
        let own = Estimates { of_moving: Some(0.3), ..Estimates::default() };
        let truth =
            TrueErrors { errors: &[0.6, 9.0], areas: &[1.0, 1.0], strain: Some(Strain::Finite) };
        let ratio = own.effectivity(&along(&[5.0, 0.1]), Strain::Small, &truth);
        assert!((ratio.unwrap() - 0.5).abs() < 1e-12);
    }
}
