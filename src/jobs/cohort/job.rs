//! The job of a cohort.

use super::files::{PICTURE, TABLE, picture, table};
use super::groups::{Groups, group};
use super::input::CohortInput;
use super::subjects::doubts;
use super::twins::groups_of_twins;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::jobs::result::warnings::warning_documents;
use crate::schema::cohort::document::{CohortDistance, CohortStatistic};
use crate::schema::cohort::result::{
    CohortGroupDocument, CohortPairDocument, CohortResultDocument, CohortRowDocument,
};
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::ResultDocument;
use crate::schema::{ErrorCode, Faults, Pointer};
use mechanics::mesh::Frame;
use mechanics::progress::{Phase, Progress};
use mechanics::study::paired::{Equality, ZeroRule, signed_rank};
use mechanics::validation::Statistics;

/// Time a cohort may take, in seconds.
const WALL_S: f64 = 60.0;

/// Negligible differences in mm: a hundred times those from the default solver residual.
const EQUAL_WITHIN_MM: f64 = 1e-4;

/// Writes the table, the box plots and the tests.
pub fn cohort_job(
    input: &CohortInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let made = input.spec.made.as_ref();
    let clock = Observed::start(progress, made.map_or(WALL_S, |made| made.budget.wall_s));
    let mut faults = Faults::default();
    input.spec.check(place.limits, &mut faults);
    faults.into_result()?;

    let mut distance = input.spec.distance;
    let mut groups = match made {
        Some(made) => {
            clock.phase(Phase::Solve);
            distance = CohortDistance::NodeWise;
            groups_of_twins(&input.spec, made, &clock)?
        }
        None => groups(input)?,
    };
    clock.phase(Phase::Compare);
    let pairs = pairs(input.spec.statistic, &groups.tested)?;
    groups.tested.extend(groups.beside);
    let (groups, statistic) = (groups.tested, input.spec.statistic);
    let cohort = input.cohort.clone();
    let cohort = CohortResultDocument { cohort, distance, statistic, groups, pairs };

    clock.phase(Phase::Write);
    let origin = Origin {
        spec_hash: input.spec_hash(),
        inputs: Vec::new(),
        frame: Frame::Unspecified,
        queue_s: input.queue_s,
    };
    let mut folder = ResultFolder::open(place)?;
    let files = [(PICTURE, picture(&cohort)), (TABLE, table(&cohort))];
    for ((name, media_type), text) in &files {
        folder.add_file(name, media_type, text.as_bytes())?;
    }
    let provenance = origin.provenance(&clock);
    let warnings = warning_documents(doubts(input).iter());
    let result = ResultDocument {
        cohort: Some(cohort),
        ..ResultDocument::new(input.job.clone(), &folder.files, provenance, warnings)
    };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files, meshes: Vec::new() })
}

fn groups(input: &CohortInput) -> Result<Groups, JobError> {
    let spec = &input.spec;
    let mut faults = Faults::default();
    let mut groups = Vec::new();
    for (name, jobs) in &spec.groups {
        let mut rows = Vec::new();
        for (index, job) in jobs.iter().enumerate() {
            let subject = spec.subject(index);
            match input.comparisons.get(job).and_then(|comparison| spec.row(comparison)) {
                Some(distances) => rows.push(CohortRowDocument { subject, distances }),
                None => {
                    let at = Pointer::root().key("spec").key("groups").key(name).index(index);
                    let detail = "this comparison does not have the distances of `distance`; `node_wise` needs surfaces whose nodes correspond";
                    faults.add(&at, ErrorCode::NoSuchOutput, detail);
                }
            }
        }
        groups.push(group(spec, name, rows)?);
    }
    faults.into_result()?;
    Ok(Groups { tested: groups, beside: Vec::new() })
}

fn pairs(
    statistic: CohortStatistic,
    groups: &[CohortGroupDocument],
) -> Result<Vec<CohortPairDocument>, JobError> {
    let values = |group: &CohortGroupDocument| -> Vec<f64> {
        group.rows.iter().map(|row| statistic.of(&row.distances)).collect()
    };
    let mut pairs = Vec::new();
    for (index, first) in groups.iter().enumerate() {
        for second in &groups[index + 1..] {
            let (a, b) = (values(first), values(second));
            pairs.push(tested_pair(&first.name, &a, &second.name, &b)?);
        }
    }
    Ok(pairs)
}

/// Two methods by their numbers for the same subjects.
pub fn tested_pair(
    first: &str,
    a: &[f64],
    second: &str,
    b: &[f64],
) -> Result<CohortPairDocument, JobError> {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let equality = Equality { within: EQUAL_WITHIN_MM, zeros: ZeroRule::Wilcox };
    let test = signed_rank(a, b, equality).ok();
    Ok(CohortPairDocument {
        first: first.to_owned(),
        second: second.to_owned(),
        median_difference_mm: Statistics::of_subjects(&differences)?.median,
        differing: test.map_or(0, |test| test.differing as u64),
        w_first_larger: test.map_or(0.0, |test| test.positive),
        w_second_larger: test.map_or(0.0, |test| test.negative),
        p: test.map(|test| test.two_sided_p),
        is_exact: test.is_none_or(|test| test.exact),
        smallest_p: test.map_or(1.0, |test| test.smallest_p),
    })
}
