//! `facies check`: what a case and a plan mean, without solving.

use std::path::{Path, PathBuf};

use clap::Args;

use super::documents::write;
use super::failure::CommandError;
use super::scene::{PlanArgument, SceneArguments};
use super::screen::print_check;
use crate::jobs::check;
use crate::schema::Limits;
use crate::schema::predict::planned::MovementReportDocument;
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
        for movement in &report.document.movements {
            write_movement(movement, out)?;
        }
        println!("wrote      {}", out.join("classes.svg").display());
    }
    Ok(())
}

/// The movement of a segment as files for navigation.
fn write_movement(movement: &MovementReportDocument, out: &Path) -> Result<(), CommandError> {
    // A name may hold what leads to another folder.
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_ ".contains(letter);
    let plain = |letter: char| if is_plain(letter) { letter } else { '_' };
    let name: String = movement.segment.chars().map(plain).collect();
    let mut files = vec![(format!("{name}.txt"), &movement.matrix_text)];
    files.extend(movement.itk_transform.iter().map(|text| (format!("{name}.tfm"), text)));
    for (file, text) in files {
        write(&out.join(&file), text)?;
        println!("wrote      {}", out.join(&file).display());
    }
    Ok(())
}
