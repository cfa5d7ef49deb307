//! `facies optimise`: the plan that brings the skin nearest to where it is wanted.

use std::path::PathBuf;

use clap::Args;

use super::documents::{spec_beside, write};
use super::failure::CommandError;
use super::scene::SceneArguments;
use super::screen::{print_files, print_warnings, work_in_sight};
use crate::jobs::{JobContext, JobInput, OptimiseInput};
use crate::schema::Limits;
use crate::schema::optimise::result::OptimisationDocument;
use crate::schema::wire::canonical;

/// The plan that was found, as `predict --plan` reads it.
const PLAN_FILE: &str = "plan.json";

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// An optimise document with `targets` and `bounds`, as it is posted but for `case`. Method, element, materials,
    /// membrane, tolerance and budget that it does not state are those of the case file, whose plan is not used
    #[arg(long, value_name = "FILE", help_heading = "How it is computed")]
    spec: PathBuf,
    /// The folder for the result
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
}

/// Searches, writes the plan and its skin, and tells what is left of each target.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let asked = arguments.scene.documents(None)?;
    let spec = spec_beside(Some(&arguments.spec), &asked)?;
    let case = asked.file.case;
    let input = JobInput::Optimise(OptimiseInput { job: None, queue_s: None, case, spec });
    let limits = Limits::default();
    let place = JobContext { sources: &asked.sources, limits: &limits, out: &arguments.out };
    let done = work_in_sight(&input, &place)?;
    if let Some(found) = &done.result.optimisation {
        let plan = canonical::to_value(&found.plan);
        write(&arguments.out.join(PLAN_FILE), format!("{plan:#}\n"))?;
        print_found(found);
    }
    print_warnings(&done.result.warnings);
    print_files(&done.files, &arguments.out);
    println!("wrote      {}", arguments.out.join(PLAN_FILE).display());
    Ok(())
}

fn print_found(found: &OptimisationDocument) {
    for (parameter, error) in found.parameters.iter().zip(&found.standard_error) {
        let name = canonical::to_value(&parameter.name);
        let name = name.as_str().unwrap_or_default();
        println!("found      {} {name} {:.3} +- {error:.3}", parameter.segment, parameter.value);
    }
    for stopped in &found.at_bound {
        let name = canonical::to_value(&stopped.name);
        let name = name.as_str().unwrap_or_default();
        println!("at bound   {} {name} {:.3}", stopped.segment, stopped.value);
    }
    for (index, target) in found.targets.iter().enumerate() {
        println!(
            "target {index:<3} left {:.3} mm, at most {:.3} mm, over {} points",
            target.residual_mm, target.largest_mm, target.points
        );
    }
    if let Some(difference) = found.verified_difference_mm {
        println!("verified   {difference:.1e} mm from the full solution");
    }
}
