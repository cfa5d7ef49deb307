//! The job of a prediction: documents checked, the displacement solved, the result written.

use super::input::PredictInput;
use super::publish::Predicted;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobOutput, Workplace};
use mechanics::prediction::predict;
use mechanics::progress::Progress;

/// Predicts the displacement of a case under a plan, and writes its files.
pub fn predict_job(
    input: &PredictInput,
    place: &Workplace,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, input.spec.budget.wall_s);

    // 1. Documents and meshes, checked together.
    let prepared = input.prepare(place.sources, place.limits)?;
    prepared.admit(0, place.limits)?;
    clock.check()?;

    // 2. The displacement of the tissue.
    let prediction = predict(&prepared.scene, &clock).map_err(|error| clock.judge(error))?;
    let predicted = Predicted { prepared, prediction, optimisation: None };
    predicted.publish(input, &clock, place.out)
}
