//! `facies check`: what a case and a plan mean, without solving.

use std::collections::BTreeSet;
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
    asked.file.refuse_beside_spec(&asked.path)?;
    let report = check(&asked.file.to_input(), &asked.sources, &Limits::default())?;
    print_check(&report.document);
    if let Some(out) = &arguments.out {
        let document = canonical::to_value(&report.document);
        write(&out.join("check.json"), format!("{document:#}\n"))?;
        write(&out.join("classes.svg"), &report.picture()?)?;
        println!("wrote      {}", out.join("check.json").display());
        let mut taken = BTreeSet::new();
        for movement in &report.document.movements {
            write_movement(movement, out, &mut taken)?;
        }
        println!("wrote      {}", out.join("classes.svg").display());
    }
    Ok(())
}

/// The movement of a segment as files for navigation.
fn write_movement(
    movement: &MovementReportDocument,
    out: &Path,
    taken: &mut BTreeSet<String>,
) -> Result<(), CommandError> {
    // A name may hold what leads to another folder.
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_ ".contains(letter);
    let plain = |letter: char| if is_plain(letter) { letter } else { '_' };
    let name = free_name(movement.segment.chars().map(plain).collect(), taken);
    let mut files = vec![(format!("{name}.txt"), &movement.matrix_text)];
    files.extend(movement.itk_transform.iter().map(|text| (format!("{name}.tfm"), text)));
    for (file, text) in files {
        write(&out.join(&file), text)?;
        println!("wrote      {}", out.join(&file).display());
    }
    Ok(())
}

/// A name of files, or the same with a number where another segment has it: on some disks large and small letters are the same.
fn free_name(wanted: String, taken: &mut BTreeSet<String>) -> String {
    let mut name = wanted.clone();
    let mut number = 2;
    while !taken.insert(name.to_lowercase()) {
        name = format!("{wanted}-{number}");
        number += 1;
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_whose_names_are_written_alike_have_files_of_their_own() {
        let mut taken = BTreeSet::new();
        let names = ["jaw_1", "jaw_1", "Jaw_1", "chin"];
        let names = names.map(|name| free_name(name.to_owned(), &mut taken));
        assert_eq!(names, ["jaw_1", "jaw_1-2", "Jaw_1-3", "chin"]);
    }
}
