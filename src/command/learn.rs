//! `facies learn`: from operated cases, or from virtual ones.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::claim::Claim;
use super::documents::{CaseFile, read};
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments};
use super::screen::{print_files, print_warnings, run_with_progress};
use crate::jobs::{JobContext, JobInput, LearnInput, LearnedCase};
use crate::schema::case::document::LengthUnit;
use crate::schema::learn::document::{VirtualCohortDocument, VirtualFaceName};
use crate::schema::learn::result::{
    CurveDocument, GainsDocument, LearningDocument, MadeCohortDocument, RedrawnDocument,
    ValidationDocument, WidthDocument,
};
use crate::schema::{LearnDocument, Limits};
use mechanics::learning::virtual_cohort::USUAL_MAPPING;

#[derive(Debug, Args)]
pub struct Arguments {
    /// The JSON body of the REST job, with files of predictions (`case`, `plan`, `spec`) and meshes, relative to its folder, in
    /// place of ids
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "patients",
        help_heading = "What is learned from"
    )]
    spec: Option<PathBuf>,
    /// So many patients that the program makes itself
    #[arg(
        long = "virtual",
        value_name = "PATIENTS",
        conflicts_with = "spec",
        help_heading = "What is learned from"
    )]
    patients: Option<u32>,
    /// Of the virtual patients
    #[arg(long, value_name = "NUMBER", default_value_t = 1, help_heading = "What is learned from")]
    seed: u32,
    /// Of the virtual patients: half heads, or generic faces, to which all happens in contact
    #[arg(long, value_enum, default_value = "half_head", help_heading = "What is learned from")]
    face: FaceArgument,
    /// Of the virtual faces: 1728 times its square in tetrahedra of a half head [default: 2], 5616 times in hexahedra of a
    /// generic face [default: 1]
    #[arg(long, value_name = "NUMBER", help_heading = "What is learned from")]
    fineness: Option<u32>,
    /// By how much their mapped skin is off in the mean
    #[arg(
        long,
        value_name = "MM",
        default_value_t = USUAL_MAPPING,
        help_heading = "What is learned from"
    )]
    mapping: f64,
    /// The folder for the model, the picture and the result
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
#[value(rename_all = "snake_case")]
enum FaceArgument {
    HalfHead,
    GenericFace,
}

/// Learns, and prints the table.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let (spec, folder) = match (&arguments.spec, arguments.patients) {
        (Some(path), _) => (read(path)?, path.parent().unwrap_or(Path::new("")).to_owned()),
        (None, patients) => {
            let (patients, seed) = (patients.unwrap_or_default(), arguments.seed);
            let (fineness, mapping_mm) = (arguments.fineness, arguments.mapping);
            let face = match arguments.face {
                FaceArgument::HalfHead => VirtualFaceName::HalfHead,
                FaceArgument::GenericFace => VirtualFaceName::GenericFace,
            };
            let made = VirtualCohortDocument { patients, seed, face, fineness, mapping_mm };
            (LearnDocument { made: Some(made), ..LearnDocument::default() }, PathBuf::new())
        }
    };
    if spec.cohort.is_some() {
        let detail = "a stored cohort is a service's: state `cases` in its place";
        return Err(CommandError::Usage(detail.to_owned()));
    }
    let mut cases = Vec::new();
    for case in &spec.cases {
        let path = folder.join(&case.prediction);
        let file: CaseFile = read(&path)?;
        file.refuse_beside_spec(&path)?;
        cases.push(LearnedCase { case: None, spec_hash: None, prediction: file.to_input() });
    }
    let limits = Limits::default();
    let sources = FileSource::new(&folder, LengthUnit::Mm, ScaleArguments::default());
    let (job, queue_s, cohort) = (None, None, None);
    let input = JobInput::Learn(LearnInput { job, queue_s, spec, cohort, cases });
    let place = JobContext { sources: &sources, limits: &limits, out: &arguments.out };
    let _claim = Claim::of(&arguments.out, &[])?;
    let done = run_with_progress(&input, &place)?;
    if let Some(found) = &done.result.learning {
        print_learning(found);
    }
    print_warnings(&done.result.warnings);
    print_files(&done.files, &arguments.out);
    Ok(())
}

fn print_learning(found: &LearningDocument) {
    let regions: Vec<&String> =
        found.table.first().map(|own| own.regions.keys().collect()).unwrap_or_default();
    let heads: String = regions.iter().map(|name| format!(" {name:>8}")).collect();
    println!("   {:<36} {:>8} {:>8}{heads}", "error in mm", "mean", "p95");
    for (number, column) in (1..).zip(&found.table) {
        let of = |name: &&String| format!(" {:>8.3}", column.regions.get(*name).unwrap_or(&0.0));
        let regions: String = regions.iter().map(of).collect();
        println!(
            "{number:>2} {:<36} {:>8.3} {:>8.3}{regions}",
            column.name, column.mean, column.p95
        );
    }
    print_patients(found);
    if let Some(made) = &found.made {
        print_made(made);
    }
    for test in &found.tests {
        let p = test.p.map_or_else(|| "no p".to_owned(), |p| format!("p {p:.4}"));
        println!(
            "{} against {}: {:.3} mm, {p} (at least {:.2e})",
            test.first, test.second, test.median_difference_mm, test.smallest_p
        );
    }
    found.validation.iter().for_each(print_validation);
    if let Some(width) = &found.width {
        print_width(&found.method, width);
    }
    print_curves(&found.curve, "cases learned from");
    print_curves(&found.curve_of_other_classes, "cases of other classes");
    for own in &found.thetas {
        let known = if own.is_determined { "" } else { ", which the data do not determine" };
        println!(
            "theta of {}: {:.2}{known} ({:.3} mm, {:.3} over 0.5 to 1.5)",
            own.class, own.theta, own.error_mm, own.spread_mm
        );
    }
}

/// A row for each patient, methods by their numbers in the table above.
fn print_patients(found: &LearningDocument) {
    let heads: String = (1..=found.table.len()).map(|number| format!(" {number:>6}")).collect();
    println!("{:<20} {:<12} {:>7}{heads}", "patient", "class", "bone");
    for (place, patient) in found.patients.iter().enumerate() {
        let errors = found.table.iter().filter_map(|own| own.cases.get(place));
        let errors: String = errors.map(|case| format!(" {:>6.3}", case.mean)).collect();
        println!(
            "{:<20} {:<12} {:>7.3}{errors}",
            patient.name, patient.class, patient.largest_bone_movement_mm
        );
    }
}

fn print_made(made: &MadeCohortDocument) {
    if let Some(areas) = &made.contact_mm2 {
        let touching = areas.iter().filter(|area| **area > 0.0).count();
        let mean = areas.iter().sum::<f64>() / areas.len().max(1) as f64;
        println!("in contact: {touching} of {} patients, {mean:.1} mm2 in the mean", areas.len());
    }
    for RedrawnDocument { patient, why } in &made.redrawn {
        println!("{patient} was drawn again: {why}");
    }
}

fn print_validation(own: &ValidationDocument) {
    let coverage = own.coverage.map_or_else(
        || "no band".to_owned(),
        |share| format!("{:.1} % in the band of 80 %", 100.0 * share),
    );
    let gains = |own: &GainsDocument| {
        let told = |gain: Option<f64>| gain.map_or("-".to_owned(), |own| format!("{own:.3}"));
        let [refused, others] = [own.gain_of_refused_mm, own.gain_of_others_mm].map(told);
        format!("gain {refused} mm of these, {others} of the others")
    };
    let (refused, harmed) = (own.gains.refused.len(), own.gains.harmed.len());
    let gained = gains(&own.gains);
    println!("{}: {coverage}, {harmed} harmed, {refused} refused ({gained})", own.method);
    if let Some(modes) = own.modes {
        let limited =
            if modes.is_limited_by_cases { ": limited by the number of cases" } else { "" };
        println!("{}: {} modes of {} at most{limited}", own.method, modes.count, modes.most);
    }
    if let Some(other) = &own.other_classes {
        let (refused, harmed) = (other.gains.refused.len(), other.gains.harmed.len());
        let gained = gains(&other.gains);
        println!(
            "{} of other classes: {:.3} mm, {harmed} harmed, {refused} refused ({gained})",
            own.method, other.mean
        );
    }
}

fn print_width(method: &str, width: &WidthDocument) {
    let told = width.width.map_or_else(|| "none".to_owned(), |own| format!("{own:.4}"));
    println!("{method}: width {told} ({:?}), rmse {:.4}", width.end, width.rmse);
    if let Some(climb) = &width.climb {
        println!(
            "{method}: the climb of Zhang et al. from 1 by .01: width {:.2} after {} steps ({:?}), rmse {:.4}",
            climb.width, climb.steps, climb.end, climb.rmse
        );
    }
}

fn print_curves(curves: &[CurveDocument], by: &str) {
    for curve in curves {
        let points: String =
            curve.points.iter().map(|own| format!(" {}: {:.3}", own.cases, own.error_mm)).collect();
        println!("{} by {by}{points}", curve.method);
    }
}
