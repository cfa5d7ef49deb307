//! Growth and muscles at finite strain.
//!
//! Growth: F = F_e F_g, F_g = (1 + eps_g) 1 (Rodriguez, Hoger, McCulloch 1994). Each cell is that of its grown shape: with the
//! gradients g / (1 + eps_g) and the volume V (1 + eps_g)^3 at rest every element and every law is that of F_e, and has the
//! energy int W(F_e) dV_g.
//!
//! Muscles: the active stress S of a cell is its second Piola-Kirchhoff stress, with the energy S : (C - 1) / 2 for each unit of
//! volume, so that P = F S: fibres that are stretched by lambda pull with lambda T on the section that they have at rest, along
//! where they have turned to, and several muscles in a cell add up. Both are at rest what `model::fem::inner_stress` has.
//!
//! All of it acts from the first step on, while bones move. Where Newton's method stands still on that way, bones are moved
//! first, and what grows and pulls comes by and by, in shares that are halved where one is too much again and doubled where it
//! is not.

use std::sync::Arc;

use super::newton_state::{Question, Rest, Start};
use super::problem::FiniteStrain;
use super::tissue::Tissue;
use crate::model::parts::Parts;
use crate::model::problem::ModelError;
use crate::solver::{SolverError, Tolerance};

/// Relative residual of the states on the way.
const ON_THE_WAY: f64 = 1e-3;

/// Whether Newton's method may go on where less grows and pulls.
pub(super) fn is_too_much(error: &ModelError) -> bool {
    matches!(
        error,
        ModelError::Standstill { .. } | ModelError::Solver(SolverError::NotConverged { .. })
    )
}

impl<'a> FiniteStrain<'a> {
    /// The same tissue in which a share of it grows and pulls.
    fn with_share(&self, share: f64) -> FiniteStrain<'a> {
        FiniteStrain { inner: Arc::new(self.inner.share(share)), ..self.clone() }
    }

    /// Brings bones to where they go, and then growth and muscles to what they are.
    pub(super) fn rest_by_and_by(
        &self,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        let asked = question.tolerance;
        let relative_residual = asked.relative_residual.max(ON_THE_WAY);
        let on_the_way =
            Question { tolerance: Tolerance { relative_residual, ..asked }, ..question };
        let (_, rest) = self.with_share(0.0).rest_at_once_or_in_parts(on_the_way, start)?;
        let (mut reached, mut parts) = (rest.into_start(), Parts::beginning_with(0.5));
        loop {
            let share = parts.target();
            let found = match share < 1.0 {
                true => self.with_share(share).rest_from(on_the_way, reached.clone()),
                false => self.rest_from(question, reached.clone()),
            };
            match found {
                Ok((tissue, rest)) => {
                    if parts.rested() {
                        return Ok((tissue, rest));
                    }
                    reached = rest.into_start();
                }
                Err(error) if is_too_much(&error) && parts.halve() => {}
                Err(error) => return Err(error),
            }
        }
    }
}
