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
//! is not. Of a load step that is what it adds to the one before.

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
        ModelError::Standstill { .. }
            | ModelError::ContactAlternates { .. }
            | ModelError::Solver(SolverError::NotConverged { .. })
    )
}

impl<'a> FiniteStrain<'a> {
    /// The same tissue in which a share of it grows and pulls.
    fn with_share(&self, share: f64) -> FiniteStrain<'a> {
        FiniteStrain { inner: Arc::new(self.inner.share(share)), ..self.clone() }
    }

    /// Brings the tissue to rest at a share of what moves, acts, grows and pulls: with all of that at once, or, where what grows and
    /// pulls is too much for one path, by and by.
    pub(super) fn rest_at_share(
        &self,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        let there = self.with_share(question.share);
        if self.inner.is_zero() {
            return there.rest_at_once_or_in_parts(question, start);
        }
        match there.rest_from(question, start.clone()) {
            Err(error) if is_too_much(&error) => self.rest_by_and_by(question, start),
            ended => ended,
        }
    }

    /// Brings bones to where they go, and then growth and muscles to what they are there.
    fn rest_by_and_by(
        &self,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        let asked = question.tolerance;
        let relative_residual = asked.relative_residual.max(ON_THE_WAY);
        let on_the_way =
            Question { tolerance: Tolerance { relative_residual, ..asked }, ..question };
        let (from, to) = (start.made, question.share);
        let (_, rest) = self.with_share(from).rest_at_once_or_in_parts(on_the_way, start)?;
        let (mut reached, mut parts) = (rest.into_start(), Parts::beginning_with(0.5));
        loop {
            let share = parts.target_between(from, to);
            let next = if share < to { on_the_way } else { question };
            match self.with_share(share).rest_from(next, reached.clone()) {
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
