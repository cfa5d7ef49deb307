//! `facies optimise`: the plan that brings the skin nearest to its targets.

use std::path::PathBuf;

use clap::Args;

use super::claim::Claim;
use super::documents::spec_beside;
use super::failure::CommandError;
use super::scene::SceneArguments;
use super::screen::{print_files, print_warnings, run_with_progress};
use crate::jobs::{JobContext, JobInput, OptimiseInput};
use crate::schema::Limits;
use crate::schema::optimise::result::{OptimisationDocument, ParameterName, PartDocument};
use crate::schema::wire::canonical;

/// The plan that was found, as `predict --plan` reads it.
const PLAN_FILE: &str = "plan.json";

/// Correlations that are larger are told: one of the two has nearly all its error from the other.
const TOLD_CORRELATION: f64 = 0.9;

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The JSON body of the REST job, with `targets`, `bounds` and `tissue_bounds`, without `case`. Method, element, materials,
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
    let sources = asked.sources.beside(&[PLAN_FILE]);
    let place = JobContext { sources: &sources, limits: &limits, out: &arguments.out };
    let claim = Claim::of(&arguments.out, &[PLAN_FILE])?;
    let done = run_with_progress(&input, &place)?;
    if let Some(found) = &done.result.optimisation {
        let plan = canonical::to_value(&found.plan);
        claim.put(PLAN_FILE, format!("{plan:#}\n"))?;
        print_found(found);
    }
    print_warnings(&done.result.warnings);
    print_files(&done.files, &arguments.out);
    println!("wrote      {}", arguments.out.join(PLAN_FILE).display());
    Ok(())
}

/// A number by what it is of and by its name in documents.
fn called(segment: Option<&String>, region: Option<&String>, name: ParameterName) -> String {
    let of = segment.or(region).map_or("", String::as_str);
    let name = canonical::to_value(&name);
    format!("{of} {}", name.as_str().unwrap_or_default())
}

fn print_found(found: &OptimisationDocument) {
    for (parameter, error) in found.parameters.iter().zip(&found.standard_error) {
        let called = called(parameter.segment.as_ref(), parameter.region.as_ref(), parameter.name);
        let value = parameter.value;
        match parameter.region {
            Some(_) => println!("found      {called} {value:.4} +- {error:.4}"),
            None => println!("found      {called} {value:.3} +- {error:.3}"),
        }
    }
    for stopped in &found.at_bound {
        let called = called(stopped.segment.as_ref(), stopped.region.as_ref(), stopped.name);
        println!("at bound   {called} {:.3}", stopped.value);
    }
    for (row, one) in found.parameters.iter().enumerate() {
        for (other, correlation) in found.parameters.iter().zip(&found.correlation[row]).take(row) {
            if correlation.abs() > TOLD_CORRELATION {
                let [one, other] = [one, other]
                    .map(|own| called(own.segment.as_ref(), own.region.as_ref(), own.name));
                println!("correlated {one} with {other}: {correlation:.3}");
            }
        }
    }
    for parts in &found.undetermined {
        let part = |own: &PartDocument| {
            format!(
                "{:.3} x {}",
                own.part,
                called(own.segment.as_ref(), own.region.as_ref(), own.name)
            )
        };
        println!("undetermined {}", parts.iter().map(part).collect::<Vec<_>>().join(" + "));
    }
    if let Some(factor) = found.residual_factor {
        println!("residual   {factor:.2} times the stated uncertainty (sigma_mm)");
    }
    for (index, target) in found.targets.iter().enumerate() {
        println!(
            "target {index:<3} residual {:.3} mm, at most {:.3} mm, over {} points",
            target.residual_mm, target.largest_mm, target.points
        );
    }
    if let Some(difference) = found.verified_difference_mm {
        println!("verified   {difference:.1e} mm from the full solution");
    }
}
