//! `facies reproduce`: the plan of an operation that was performed, from bone before and after it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::claim::Claim;
use super::documents::read;
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments, UnitArgument};
use super::screen::{print_files, print_warnings, run_with_progress};
use crate::jobs::{JobContext, JobInput, ReproduceInput};
use crate::schema::reproduce::result::{FitDocument, ReproductionDocument};
use crate::schema::wire::canonical;
use crate::schema::{Limits, ReproduceDocument};

/// The plan that was found, as `predict --plan` reads it.
const PLAN_FILE: &str = "plan.json";

#[derive(Debug, Args)]
pub struct Arguments {
    /// The JSON body of the REST job, with paths relative to its folder in place of ids
    #[arg(long, value_name = "FILE", help_heading = "What is reproduced")]
    spec: PathBuf,
    /// The folder for the result and `plan.json`
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
    /// The unit of length of all meshes
    #[arg(long, help_heading = "What is reproduced", default_value = "mm")]
    units: UnitArgument,
    #[command(flatten)]
    scale: ScaleArguments,
}

/// Finds the movements, writes them as a plan, and tells how well the bone fits.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let mut spec: ReproduceDocument = read(&arguments.spec)?;
    let folder = arguments.spec.parent().unwrap_or(Path::new(""));
    for (_, id) in spec.mesh_references_mut() {
        *id = folder.join(&*id).to_string_lossy().into_owned();
    }
    let limits = Limits::default();
    let sources = FileSource::new(&PathBuf::new(), arguments.units.unit(), arguments.scale)
        .beside(&[PLAN_FILE]);
    let input = JobInput::Reproduce(ReproduceInput { job: None, queue_s: None, spec });
    let place = JobContext { sources: &sources, limits: &limits, out: &arguments.out };
    let claim = Claim::of(&arguments.out, &[PLAN_FILE])?;
    let done = run_with_progress(&input, &place)?;
    if let Some(found) = &done.result.reproduction {
        let plan = canonical::to_value(&found.plan);
        claim.put(PLAN_FILE, format!("{plan:#}\n"))?;
        print_found(found);
    }
    print_warnings(&done.result.warnings);
    print_files(&done.files, &arguments.out);
    println!("wrote      {}", arguments.out.join(PLAN_FILE).display());
    Ok(())
}

fn print_found(found: &ReproductionDocument) {
    println!("base       {}", told(&found.base.fit));
    for segment in &found.segments {
        let [x, y, z] = segment.displacement_mm.0;
        println!(
            "{:<10} moved by {x:.2} {y:.2} {z:.2} mm, turned by {:.2} degrees; {}",
            segment.name,
            segment.rotation_deg,
            told(&segment.fit)
        );
        let error = &segment.standard_error;
        if let (Some(rotation), Some(displacement)) = (error.rotation_deg, error.displacement_mm) {
            println!("           standard error {displacement:.2} mm and {rotation:.2} degrees");
        }
        if let Some(beyond) = &segment.from_planned {
            let [x, y, z] = beyond.displacement_mm.0;
            println!(
                "           {x:.2} {y:.2} {z:.2} mm and {:.2} degrees from the plan",
                beyond.rotation_deg
            );
        }
    }
}

fn told(fit: &FitDocument) -> String {
    let percent = 100.0 * fit.share_above_1_mm;
    format!("fits to {:.3} mm rms, {percent:.1} % above 1 mm", fit.rms_mm)
}
