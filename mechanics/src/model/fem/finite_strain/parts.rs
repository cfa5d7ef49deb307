//! Rest of a movement in parts, each brought to rest before the next one, where the whole movement at once finds none.
//!
//! Tissue that buckles on the way, or is pressed to a few hundredths of its volume, is taken with more care than at first: bones
//! wait until it is near rest again after each tangent that is not positive definite, while its energy falls, and more of the bulk
//! modulus stays in the cells, near rest of the whole movement in pressed ones alone as after a movement at once.

use super::elements::CellBulkModulus;
use super::inner::is_too_much;
use super::newton_state::{Ending, Question, Rest, Start};
use super::problem::{Advance, FiniteStrain};
use super::tissue::Tissue;
use crate::model::parts::Parts;
use crate::model::problem::ModelError;
use crate::solver::{RestOnTheWay, SolverError, Tolerance};

/// The first part that is tried.
const FIRST: f64 = 0.5;

/// Relative residual of rest on the way.
const ON_THE_WAY: f64 = 1e-3;

/// The relative residual above which bones wait.
const OUT_OF_BALANCE: f64 = 0.02;

/// Steps after which a part is given up, and all of them together.
const MOST_OF_PART: usize = 150;
const MOST_ALTOGETHER: usize = 600;

impl<'a> FiniteStrain<'a> {
    /// Brings tissue to rest with the whole movement at once, or, where that finds no rest and parts are wanted, in parts.
    pub(super) fn rest_at_once_or_in_parts(
        &self,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        match self.rest_from(question, start.clone()) {
            Err(error) if self.advance != Advance::AtOnce && is_too_much(&error) => {
                let (tissue, mut rest, parts) = self.rest_in_parts(question, start)?;
                if let Some(newton) = &mut rest.report.newton {
                    newton.parts = parts;
                }
                Ok((tissue, rest))
            }
            ended => ended,
        }
    }

    fn rest_in_parts(
        &self,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>, Vec<RestOnTheWay>), ModelError> {
        let (from, to) = (start.made, question.share);
        let (mut reached, mut parts) = (start, Parts::beginning_with(FIRST));
        let (mut rests, mut spent) = (Vec::new(), 0);
        loop {
            let begun = reached.history.len();
            let share = parts.target_between(from, to);
            let part = in_part(question, share, begun);
            let found = match share < to {
                true => self.rest_of_part(part, reached.clone()),
                false => self.rest_from(part, reached.clone()),
            };
            match found {
                Ok((tissue, rest)) => {
                    rests.extend(rest.on_the_way(begun));
                    if parts.rested() {
                        return Ok((tissue, rest, rests));
                    }
                    reached = rest.into_start();
                    spent += reached.history.len() - begun;
                }
                Err(error) if is_too_much(&error) => {
                    spent += steps_of(&error).saturating_sub(begun);
                    if spent > MOST_ALTOGETHER || !parts.halve() {
                        return Err(error);
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Rest on the way: all cells keep bulk modulus.
    fn rest_of_part(
        &self,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        match self.with_bulk_in_cells(question.kept, question, start, false)? {
            (tissue, Ending::Rest(rest)) => Ok((tissue, *rest)),
            (_, Ending::Jam(_) | Ending::Near(..)) => unreachable!("only rest ends it"),
        }
    }
}

/// A question of a share of the movement, from rest at another one after so many steps.
fn in_part(question: Question, share: f64, begun: usize) -> Question {
    let asked = question.tolerance;
    let relative_residual = match share < question.share {
        true => asked.relative_residual.max(ON_THE_WAY),
        false => asked.relative_residual,
    };
    Question {
        share,
        kept: CellBulkModulus::IN_PARTS,
        out_of_balance: OUT_OF_BALANCE,
        by_energy: true,
        most_steps: begun + MOST_OF_PART,
        tolerance: Tolerance { relative_residual, ..asked },
        ..question
    }
}

/// Steps with those before.
fn steps_of(error: &ModelError) -> usize {
    match error {
        ModelError::Standstill { steps, .. } | ModelError::ContactAlternates { steps, .. } => {
            *steps
        }
        ModelError::Solver(SolverError::NotConverged { iterations, .. }) => *iterations,
        _ => 0,
    }
}
