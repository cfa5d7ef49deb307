//! The job of a prediction: documents checked, the displacement solved, the result written.

use super::cost::refined_bound;
use super::input::{PredictInput, Prepared};
use super::publish::Predicted;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput};
use crate::schema::predict::adequacy::AdequacyDocument;
use crate::schema::predict::refine::{RefineDocument, RefinementDocument};
use crate::schema::{ErrorCode, Limits, Pointer, Problem};
use mechanics::prediction::{
    Accepted, AdaptiveError, TimedProgress, predict, predict_adaptively, predict_adequately,
};
use mechanics::progress::Progress;

/// Predicts the displacement of a case under a plan, and writes its files.
pub fn predict_job(
    input: &PredictInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, input.spec.budget.wall_s);

    // 1. Documents and meshes, checked together.
    let prepared = clock.prepared(|stop| input.prepare(place.sources, place.limits, stop))?;
    prepared.admit(0, place.limits)?;
    clock.check()?;

    // 2. The displacement of the tissue.
    let predicted = match (&input.spec.refine, input.spec.accepted()) {
        (Some(refine), accepted) => {
            refined(prepared, (refine, accepted.is_some()), &clock, place.limits)?
        }
        (None, Some(accepted)) => {
            let time_s = clock.left_s();
            let no_finite_strain = prepared.too_large_at_finite_strain(place.limits);
            adequately(prepared, Accepted { time_s, no_finite_strain, ..accepted }, &clock)?
        }
        (None, None) => {
            let prediction =
                predict(&prepared.scene, &clock).map_err(|error| clock.judge(error))?;
            Predicted::of(prepared, prediction)
        }
    };
    predicted.publish(input, &clock, place)
}

/// Predicts by the cheapest model whose estimated error is accepted.
fn adequately(
    mut prepared: Prepared,
    accepted: Accepted,
    clock: &Observed,
) -> Result<Predicted, JobError> {
    let stopwatch = || clock.elapsed_s();
    let watched = TimedProgress { stopwatch: &stopwatch, progress: clock };
    let Prepared { case, plan, scene, .. } = &prepared;
    let adequate = predict_adequately(case, plan, scene, &accepted, watched)
        .map_err(|error| clock.judge(error))?;
    let adequacy = Some(AdequacyDocument::new(&accepted, &adequate));
    prepared.scene = adequate.scene.unwrap_or(prepared.scene);
    Ok(Predicted { adequacy, ..Predicted::of(prepared, adequate.prediction) })
}

/// Predicts on meshes refined until the estimated error of the skin is accepted.
fn refined(
    prepared: Prepared,
    (refine, is_of_answer): (&RefineDocument, bool),
    clock: &Observed,
    limits: &Limits,
) -> Result<Predicted, JobError> {
    let bound = refined_bound(&prepared.scene, refine.cells, limits);
    let wanted = refine.wanted(bound.cells as usize, clock.left_s(), is_of_answer);
    let stopwatch = || clock.elapsed_s();
    let adapted = match predict_adaptively(&prepared.scene, &wanted, &stopwatch, clock) {
        Ok(adapted) => adapted,
        Err(AdaptiveError::Model(error)) => return Err(clock.judge(error)),
        Err(error) => return Err(not_refined(&error)),
    };
    let refinement = Some(RefinementDocument::new(&wanted, &adapted));
    Ok(Predicted { refinement, ..Predicted::of(prepared, adapted.prediction) })
}

fn not_refined(error: &AdaptiveError) -> JobError {
    let at = Pointer::from_text("/spec/refine");
    JobError::Refused(Problem::at(&at, ErrorCode::MethodNotAvailable, error.to_string()))
}
