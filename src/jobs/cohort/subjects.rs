//! Consistency of a cohort: the comparisons in one place should be of one patient, those of one group of several.

use std::collections::BTreeMap;

use super::input::CohortInput;
use mechanics::mesh::Warning;
use mechanics::mesh::ignored::listed;

/// The warnings of a cohort with inconsistent pairs.
pub(super) fn doubts(input: &CohortInput) -> Vec<Warning> {
    differing(input).into_iter().chain(twice(input)).collect()
}

/// Places at which groups have different scans: lists in different order.
fn differing(input: &CohortInput) -> Option<Warning> {
    let most = input.spec.groups.values().map(Vec::len).max().unwrap_or(0);
    let scans_at = |place: usize| {
        let jobs = input.spec.groups.values().filter_map(move |jobs| jobs.get(place));
        jobs.filter_map(|job| input.actuals.get(job))
    };
    let differs = |place: &usize| {
        let mut scans = scans_at(*place);
        let first = scans.next();
        scans.any(|other| Some(other) != first)
    };
    let places: Vec<usize> = (0..most).filter(differs).collect();
    let detail = format!(
        "groups are compared in pairs, and in {} of {most} places their comparisons are with different scans (place {}): are the \
         lists in the same order?",
        places.len(),
        listed(places.iter().map(|place| (place + 1).to_string()))
    );
    let warning = Warning::new("subjects-differ", detail).with("places", places.len() as f64);
    (!places.is_empty()).then_some(warning)
}

/// Groups with one scan more than once.
fn twice(input: &CohortInput) -> Vec<Warning> {
    let of_group = |(name, jobs): (&String, &Vec<String>)| {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for job in jobs {
            let subject = input.actuals.get(job).unwrap_or(job);
            *counts.entry(subject).or_default() += 1;
        }
        let most = counts.into_values().max().unwrap_or(0);
        let detail = format!(
            "group {name:?} has {most} comparisons with the same scan: the test counts each as another patient"
        );
        (most > 1).then(|| Warning::new("subject-twice", detail).with("times", most as f64))
    };
    input.spec.groups.iter().filter_map(of_group).collect()
}
