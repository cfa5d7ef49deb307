//! The search over movements, growth and constants together.
//!
//! The skin is linear in the columns of a response, and the response depends on the constants: each step solves the least-squares
//! problem of the response at hand with a column more for each constant, its derivative (Gauss, Newton), and solves the response
//! anew where the step ends. A step that does not lower the least sum over movements and growth is halved. Where no step is left,
//! J has the derivatives by all parameters, and its covariance is that of all of them together.

use super::constants::ConstantFailure;
use super::{
    ConstantBounds, ConstantColumn, ConstantError, InnerBounds, OptimisationError, Optimum,
    Question, SegmentBounds, Target, check_free, minimum_of,
};
use crate::prediction::Scene;
use crate::progress::Progress;
use crate::response::{Amounts, ColumnRequest, Columns, Response, ResponseError, build_of};

/// The step at which constants are found, of nu and of ln E; a hundredth of a standard error is as good.
const SMALL_STEP: f64 = 1e-5;
const SMALL_SHARE: f64 = 0.01;
/// Planted constants take three or four.
const MOST_STEPS: usize = 20;
const MOST_HALVINGS: usize = 6;
/// A sum of squares of residuals over sigma that is larger by less is as good.
const NEGLIGIBLE: f64 = 1e-6;

/// Unknowns and targets of the search.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// Of second order without internal loads and constants only.
    pub asked: ColumnRequest<'a>,
    /// Of each segment that is asked for, in the order of the scene.
    pub bounds: &'a [SegmentBounds],
    pub targets: &'a [Target],
    /// For each of `asked.inner`.
    pub inner: &'a [InnerBounds],
    pub constants: &'a [ConstantBounds],
}

/// Result of the search. Of `Optimum::constants`, Young's modulus is there by its natural logarithm.
#[derive(Clone, Debug)]
pub struct SearchResult {
    pub optimum: Optimum,
    /// Those of the constants that were found.
    pub columns: Columns,
    pub response: Response,
    /// Steps of the constants.
    pub steps: usize,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    #[error(transparent)]
    Response(#[from] ResponseError),
    #[error(transparent)]
    Optimisation(#[from] OptimisationError),
    #[error(transparent)]
    Constant(#[from] ConstantError),
    #[error(
        "after {steps} steps of the constants the next one is still {step:.2e}, wanted {wanted:.0e}"
    )]
    NotConverged { steps: usize, step: f64, wanted: f64 },
}

impl From<ConstantFailure> for SearchError {
    fn from(failure: ConstantFailure) -> Self {
        match failure {
            ConstantFailure::Constant(error) => SearchError::Constant(error),
            ConstantFailure::Response(error) => SearchError::Response(error),
        }
    }
}

/// Finds what comes nearest to the targets. The scene keeps the constants that were found.
pub fn search(
    scene: &mut Scene,
    search: &Search,
    progress: &dyn Progress,
) -> Result<SearchResult, SearchError> {
    search.constants.iter().try_for_each(|own| own.check(scene))?;
    let start = search.constants.iter().map(|own| own.start(scene)).collect();
    let mut iterate = search.solved_at(scene, start, progress)?;
    if search.constants.is_empty() {
        check_free(&search.question(&iterate.response, &iterate.columns, &[]))?;
        let optimum = iterate.held.clone();
        return Ok(iterate.found(optimum, 0));
    }
    let mut step = f64::INFINITY;
    for steps in 0..MOST_STEPS {
        let free = iterate.with_constants(scene, progress)?;
        let change = |share: f64| -> Vec<f64> {
            let both = iterate.values.iter().zip(&free.constants);
            both.map(|(value, wanted)| value + share * (wanted - value)).collect()
        };
        step = search.size(&iterate.values, &free);
        if step <= SMALL_STEP {
            for (constant, value) in search.constants.iter().zip(&free.constants) {
                constant.set(scene, *value)?;
            }
            return Ok(iterate.found(free, steps));
        }
        let mut share = 1.0;
        let mut next = search.solved_at(scene, change(share), progress)?;
        for _ in 0..MOST_HALVINGS {
            if next.sum <= iterate.sum + NEGLIGIBLE {
                break;
            }
            share /= 2.0;
            next = search.solved_at(scene, change(share), progress)?;
        }
        iterate = next;
    }
    Err(SearchError::NotConverged { steps: MOST_STEPS, step, wanted: SMALL_STEP })
}

/// A response at some constants, and the least sum there is with it.
struct Iterate<'a> {
    search: &'a Search<'a>,
    /// The parameters of the constants.
    values: Vec<f64>,
    columns: Columns,
    response: Response,
    /// Where the constants stay.
    held: Optimum,
    sum: f64,
}

impl<'a> Search<'a> {
    fn solved_at(
        &'a self,
        scene: &mut Scene,
        values: Vec<f64>,
        progress: &dyn Progress,
    ) -> Result<Iterate<'a>, SearchError> {
        for (constant, value) in self.constants.iter().zip(&values) {
            constant.set(scene, *value)?;
        }
        let columns = build_of(scene, &self.asked, progress)?;
        let response = columns.to_response();
        let held = minimum_of(&self.question(&response, &columns, &[]), None)?;
        let sum = held.weighted_square_sum;
        Ok(Iterate { search: self, values, columns, response, held, sum })
    }

    fn question<'b>(
        &'b self,
        response: &'b Response,
        columns: &'b Columns,
        constants: &'b [ConstantColumn],
    ) -> Question<'b> {
        let Search { bounds, targets, inner, .. } = *self;
        let second_order = columns.second_order.as_ref();
        Question { response, second_order, bounds, targets, inner, constants }
    }

    /// The largest step, less what counts as none.
    fn size(&self, from: &[f64], to: &Optimum) -> f64 {
        let moved = from.iter().zip(&to.constants).enumerate();
        let size = |(place, (value, wanted)): (usize, (&f64, &f64))| {
            let error = to.certainty.standard_error_of(super::Parameter::Constant(place));
            let step = (wanted - value).abs();
            if step <= SMALL_SHARE * error.unwrap_or_default() { 0.0 } else { step }
        };
        moved.map(size).fold(0.0, f64::max)
    }
}

impl Iterate<'_> {
    /// The optimum with the constants free, to first order.
    fn with_constants(
        &self,
        scene: &mut Scene,
        progress: &dyn Progress,
    ) -> Result<Optimum, SearchError> {
        let Search { asked, constants, .. } = self.search;
        let amounts = Amounts { movements: &self.held.movements, inner: &self.held.inner };
        let mut columns = Vec::with_capacity(constants.len());
        for (constant, &value) in constants.iter().zip(&self.values) {
            columns.push(constant.column(scene, (asked, &amounts), value, progress)?);
        }
        let question = self.search.question(&self.response, &self.columns, &columns);
        Ok(minimum_of(&question, Some(&self.held))?)
    }

    fn found(self, optimum: Optimum, steps: usize) -> SearchResult {
        // With constants, of the last search that held them.
        let Optimum { starts, other_minima, .. } = self.held;
        let optimum = Optimum { starts, other_minima, ..optimum };
        SearchResult { optimum, columns: self.columns, response: self.response, steps }
    }
}
