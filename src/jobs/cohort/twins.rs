//! Groups of a cohort of twins: the variants of the model, the measured outcome, and no movement.

use std::collections::BTreeMap;

use super::groups::{Groups, group};
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::made::refused_virtual;
use crate::schema::cohort::document::{CohortDocument, TwinsDocument};
use crate::schema::cohort::result::{CohortGroupDocument, CohortRowDocument};
use crate::schema::compare::result::StatDocument;
use mechanics::learning::virtual_cohort::{Twin, VARIANTS, twins};
use mechanics::validation::Statistics;

/// The names in the table of the outcome with measurement errors, and of a face without movement.
const HAPPENED: &str = "what happened";
const STILL: &str = "no movement";

pub(super) fn groups_of_twins(
    spec: &CohortDocument,
    made: &TwinsDocument,
    clock: &Observed,
) -> Result<Groups, JobError> {
    let (patients, fineness) = (made.patients as usize, made.fineness as usize);
    let found = twins(patients, u64::from(made.seed), fineness, clock);
    let found = found.map_err(|error| refused_virtual(error, clock))?;
    let of = |name: &str, distances: &dyn Fn(&Twin) -> &[f64]| {
        let rows = found.iter().enumerate().map(|(index, twin)| {
            let part = part(spec.region.as_ref(), &twin.regions, distances(twin));
            let distances = StatDocument::from(&Statistics::plain(&part)?);
            Ok(CohortRowDocument { subject: spec.subject(index), distances })
        });
        let rows: Result<Vec<CohortRowDocument>, JobError> = rows.collect();
        group(spec, name, rows?)
    };
    let variants = VARIANTS.iter().enumerate();
    let tested: Result<Vec<CohortGroupDocument>, JobError> =
        variants.map(|(at, own)| of(own.name, &|twin| &twin.distances[at])).collect();
    let beside = vec![of(HAPPENED, &|twin| &twin.measurement)?, of(STILL, &|twin| &twin.movement)?];
    Ok(Groups { tested: tested?, beside })
}

/// The distances of a region, or all.
fn part(
    region: Option<&String>,
    regions: &BTreeMap<String, Vec<u32>>,
    distances: &[f64],
) -> Vec<f64> {
    match region.and_then(|name| regions.get(name)) {
        Some(points) => points.iter().map(|&point| distances[point as usize]).collect(),
        None => distances.to_vec(),
    }
}
