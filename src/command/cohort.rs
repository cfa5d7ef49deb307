//! `facies cohort`: methods against each other over comparisons of the same subjects.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;

use super::claim::Claim;
use super::documents::read;
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments};
use super::screen::{print_files, print_warnings, run_with_progress};
use crate::jobs::{CohortInput, JobContext, JobInput};
use crate::schema::case::document::LengthUnit;
use crate::schema::cohort::document::TwinsDocument;
use crate::schema::cohort::result::CohortResultDocument;
use crate::schema::predict::budget::BudgetDocument;
use crate::schema::predict::result::ResultDocument;
use crate::schema::{CohortDocument, Limits};

/// Time that a cohort of twins may take here, in seconds.
const WALL_S: f64 = 3600.0;

#[derive(Debug, Args)]
pub struct Arguments {
    /// The JSON body of the REST job, with folders of results, relative to its folder, in place of ids
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "patients",
        help_heading = "What is compared"
    )]
    spec: Option<PathBuf>,
    /// So many twins of the generic face, of one tissue or with muscles, glued to the teeth or sliding along them
    #[arg(
        long = "virtual",
        value_name = "PATIENTS",
        conflicts_with = "spec",
        help_heading = "What is compared"
    )]
    patients: Option<u32>,
    /// Of the twins
    #[arg(long, value_name = "NUMBER", default_value_t = 1, help_heading = "What is compared")]
    seed: u32,
    /// Of the twins' faces: 5616 times its square in hexahedra
    #[arg(long, value_name = "NUMBER", default_value_t = 1, help_heading = "What is compared")]
    fineness: u32,
    /// Of the twins, in place of the whole skin: nose, lips, chin or cheeks
    #[arg(long, value_name = "NAME", requires = "patients", help_heading = "What is compared")]
    region: Option<String>,
    /// The folder for the result
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
}

/// Reads the comparisons, and prints the table and the tests.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let (spec, folder) = match &arguments.spec {
        Some(path) => (read(path)?, path.parent().unwrap_or(Path::new(""))),
        None => (of_twins(arguments), Path::new("")),
    };
    if spec.cohort.is_some() {
        let detail = "a stored cohort is a service's: state `groups` in its place";
        return Err(CommandError::Usage(detail.to_owned()));
    }
    let (comparisons, actuals) = (BTreeMap::new(), BTreeMap::new());
    let (job, queue_s, cohort) = (None, None, None);
    let mut input = CohortInput { job, queue_s, spec, cohort, comparisons, actuals };
    let spec = input.spec.clone();
    for (_, job) in spec.jobs() {
        let path = folder.join(job).join("result.json");
        let bytes = std::fs::read(&path)
            .map_err(|source| CommandError::Read { path: path.clone(), source })?;
        let result: ResultDocument = serde_json::from_slice(&bytes)
            .map_err(|error| CommandError::Usage(format!("{}: {error}", path.display())))?;
        input.take(job, result);
    }
    let limits = Limits::default();
    let sources = FileSource::new(&PathBuf::new(), LengthUnit::Mm, ScaleArguments::default());
    let input = JobInput::Cohort(input);
    let place = JobContext { sources: &sources, limits: &limits, out: &arguments.out };
    let _claim = Claim::of(&arguments.out, &[])?;
    let done = run_with_progress(&input, &place)?;
    if let Some(cohort) = &done.result.cohort {
        print_cohort(cohort);
    }
    print_warnings(&done.result.warnings);
    print_files(&done.files, &arguments.out);
    Ok(())
}

fn of_twins(arguments: &Arguments) -> CohortDocument {
    let Arguments { patients, seed, fineness, ref region, .. } = *arguments;
    let made = TwinsDocument {
        patients: patients.unwrap_or_default(),
        seed,
        fineness,
        budget: BudgetDocument { wall_s: WALL_S, ..BudgetDocument::default() },
    };
    let region = region.clone();
    CohortDocument { made: Some(made), region, ..CohortDocument::default() }
}

fn print_cohort(cohort: &CohortResultDocument) {
    println!("distance in mm                    mean     sd    p90    p95    max");
    for group in &cohort.groups {
        for row in &group.rows {
            let d = &row.distances;
            println!(
                "{:<19} {:<9} {:>7.3} {:>6.3} {:>6.3} {:>6.3} {:>6.3}",
                group.name, row.subject, d.mean, d.sd, d.p90, d.p95, d.max
            );
        }
    }
    for group in &cohort.groups {
        let over = &group.over_subjects;
        println!(
            "{:<19} box {:.3} {:.3} {:.3} {:.3} {:.3}, mean {:.3} +- {:.3}",
            group.name, over.min, over.p25, over.median, over.p75, over.max, over.mean, over.sd
        );
    }
    for pair in &cohort.pairs {
        let p = pair.p.map_or_else(|| "no p".to_owned(), |p| format!("p {p:.4}"));
        println!(
            "{} against {}: {:.3} mm, W {} and {}, {p} (at least {:.4} with {} subjects)",
            pair.first,
            pair.second,
            pair.median_difference_mm,
            pair.w_first_larger,
            pair.w_second_larger,
            pair.smallest_p,
            pair.differing
        );
    }
}
