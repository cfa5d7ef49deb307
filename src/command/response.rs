//! `facies response`: the plan response of a case, as the job of that kind builds it.

use std::path::PathBuf;

use clap::Args;

use super::claim::Claim;
use super::documents::spec_beside;
use super::failure::CommandError;
use super::scene::SceneArguments;
use super::screen::{print_files, print_warnings, run_with_progress};
use crate::jobs::{JobContext, JobInput, ResponseInput};
use crate::schema::{Limits, ResponseDocument};

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The JSON body of the REST job, without `case`. Method, element, materials, membrane, tolerance and budget that
    /// it does not state are those of the case file, whose plan is not used
    #[arg(long, value_name = "FILE", help_heading = "How it is computed")]
    spec: Option<PathBuf>,
    /// A segment that the response can move; may be given several times; default: all
    #[arg(long, value_name = "NAME", help_heading = "How it is computed")]
    only: Vec<String>,
    /// 2: with the second-order term of finite strain, as a quadratic form in the movements; default: 1
    #[arg(long, value_name = "ORDER", help_heading = "How it is computed")]
    order: Option<u8>,
    /// The folder for the result
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
}

/// Solves, writes columns and description, and tells what they hold.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let asked = arguments.scene.documents(None)?;
    let mut spec: ResponseDocument = spec_beside(arguments.spec.as_deref(), &asked)?;
    if !arguments.only.is_empty() {
        spec.segments.clone_from(&arguments.only);
    }
    spec.order = arguments.order.or(spec.order);
    let case = asked.file.case;
    let input = JobInput::Response(ResponseInput { job: None, queue_s: None, case, spec });
    let limits = Limits::default();
    let place = JobContext { sources: &asked.sources, limits: &limits, out: &arguments.out };
    let _claim = Claim::of(&arguments.out, &[])?;
    let done = run_with_progress(&input, &place)?;
    let provenance = &done.result.provenance;
    println!("time       {:.2} s; key {}", provenance.timing.total_s, provenance.spec_hash);
    print_warnings(&done.result.warnings);
    print_files(&done.files, &arguments.out);
    Ok(())
}
