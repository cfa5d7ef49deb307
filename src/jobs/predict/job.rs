//! The job of a prediction: documents checked, the displacement solved, the result written.

use super::input::{PredictInput, Prepared};
use super::publish::Predicted;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobOutput, Workplace};
use crate::schema::predict::adequacy::AdequacyDocument;
use mechanics::prediction::{Accepted, Watched, predict, predict_adequately};
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
    let predicted = match input.spec.accepted() {
        Some(accepted) => {
            let time_s = clock.left_s();
            let no_finite_strain = prepared.too_large_at_finite_strain(place.limits);
            adequately(prepared, Accepted { time_s, no_finite_strain, ..accepted }, &clock)?
        }
        None => {
            let prediction =
                predict(&prepared.scene, &clock).map_err(|error| clock.judge(error))?;
            Predicted { prepared, prediction, optimisation: None, adequacy: None }
        }
    };
    predicted.publish(input, &clock, place.out)
}

/// By the cheapest model whose estimated error is accepted.
fn adequately(
    mut prepared: Prepared,
    accepted: Accepted,
    clock: &Observed,
) -> Result<Predicted, JobError> {
    let stopwatch = || clock.elapsed_s();
    let watched = Watched { stopwatch: &stopwatch, progress: clock };
    let Prepared { case, plan, scene, .. } = &prepared;
    let adequate = predict_adequately(case, plan, scene, &accepted, watched)
        .map_err(|error| clock.judge(error))?;
    let adequacy = Some(AdequacyDocument::new(&accepted, &adequate));
    prepared.scene = adequate.scene.unwrap_or(prepared.scene);
    Ok(Predicted { prepared, prediction: adequate.prediction, optimisation: None, adequacy })
}
