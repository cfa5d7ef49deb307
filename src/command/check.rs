//! `facies check`: what a case and a plan mean, without solving.

use std::path::PathBuf;

use clap::Args;

use super::documents::write;
use super::failure::CommandError;
use super::scene::{PlanArgument, SceneArguments};
use super::screen::print_check;
use crate::jobs::check;
use crate::schema::Limits;
use crate::schema::wire::canonical;

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    plan: PlanArgument,
    /// The folder for `check.json` and the picture `classes.svg`
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: Option<PathBuf>,
}

/// Prints the counts of every class of nodes, and draws them where a folder is given.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let asked = arguments.scene.documents(arguments.plan.plan.as_deref())?;
    let report = check(&asked.file.to_input(), &asked.sources, &Limits::default())?;
    print_check(&report.document);
    if let Some(out) = &arguments.out {
        let document = canonical::to_value(&report.document);
        write(&out.join("check.json"), format!("{document:#}\n"))?;
        write(&out.join("classes.svg"), &report.picture()?)?;
        println!("wrote      {}", out.join("check.json").display());
        println!("wrote      {}", out.join("classes.svg").display());
    }
    Ok(())
}
