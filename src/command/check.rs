//! `facies check`: what a case and a plan mean, without solving.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;

use super::claim::Claim;
use super::failure::CommandError;
use super::scene::{PlanArgument, SceneArguments};
use super::screen::print_check;
use crate::jobs::check;
use crate::schema::Limits;
use crate::schema::predict::planned::MovementReportDocument;
use crate::schema::wire::canonical;

/// The document of a check.
const CHECK: &str = "check.json";
const PICTURE: &str = "classes.svg";

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
        let claim = Claim::of(out, &[CHECK, PICTURE])?;
        remove_earlier_movements(out);
        let document = canonical::to_value(&report.document);
        claim.put(CHECK, format!("{document:#}\n"))?;
        claim.put(PICTURE, &report.picture()?)?;
        println!("wrote      {}", out.join(CHECK).display());
        let movements = &report.document.movements;
        let names = files_of(movements.iter().map(|movement| &*movement.segment));
        for (movement, name) in movements.iter().zip(names) {
            write_movement(movement, &claim, out, &name)?;
        }
        println!("wrote      {}", out.join(PICTURE).display());
    }
    Ok(())
}

/// The movement of a segment as files for navigation.
fn write_movement(
    movement: &MovementReportDocument,
    claim: &Claim,
    out: &Path,
    name: &str,
) -> Result<(), CommandError> {
    let mut files = vec![(format!("{name}.txt"), &movement.matrix_text)];
    files.extend(movement.itk_transform.iter().map(|text| (format!("{name}.tfm"), text)));
    for (file, text) in files {
        claim.put(&file, text)?;
        println!("wrote      {}", out.join(&file).display());
    }
    Ok(())
}

/// Removes the movements of an earlier check of a folder: those of segments that this one does not move would be taken for its own.
fn remove_earlier_movements(out: &Path) {
    let Ok(bytes) = std::fs::read(out.join(CHECK)) else { return };
    let Ok(check) = serde_json::from_slice::<serde_json::Value>(&bytes) else { return };
    let movements = check["movements"].as_array().into_iter().flatten();
    for name in files_of(movements.filter_map(|movement| movement["segment"].as_str())) {
        for end in ["txt", "tfm"] {
            // One that is not there need not go.
            let _ = std::fs::remove_file(out.join(format!("{name}.{end}")));
        }
    }
}

/// The names of files of segments, without their ends: a segment's may hold what leads to another folder.
fn files_of<'a>(segments: impl Iterator<Item = &'a str>) -> Vec<String> {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_ ".contains(letter);
    let plain = |letter: char| if is_plain(letter) { letter } else { '_' };
    let mut taken = BTreeSet::new();
    segments.map(|name| free_name(name.chars().map(plain).collect(), &mut taken)).collect()
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
