//! `facies check`: what a case and a plan mean, without solving.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::Args;

use super::claim::Claim;
use super::failure::CommandError;
use super::scene::{PlanArgument, SceneArguments};
use super::screen::print_check;
use crate::jobs::check;
use crate::jobs::result::folder::{self, CHECK, CHECK_PICTURE};
use crate::schema::Limits;
use crate::schema::predict::planned::MovementReportDocument;
use crate::schema::wire::canonical;
use mechanics::progress::StopQuery;

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
    let input = asked.file.to_input();
    let report = check(&input, &asked.sources, &Limits::default(), &StopQuery::never())?;
    print_check(&report.document);
    let Some(out) = &arguments.out else { return Ok(()) };
    let document = canonical::to_value(&report.document);
    let mut files = vec![(CHECK.to_owned(), format!("{document:#}\n"))];
    files.extend(movements(&report.document.movements));
    files.push((CHECK_PICTURE.to_owned(), report.picture()?));
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let claim = Claim::of(out, &names)?;
    folder::refuse_other_plan(out, &canonical::to_value(&input.plan))?;
    folder::remove_check(out)?;
    for (name, content) in &files {
        claim.put(name, content)?;
        println!("wrote      {}", out.join(name).display());
    }
    Ok(())
}

/// The movements of segments as files for navigation.
fn movements(movements: &[MovementReportDocument]) -> Vec<(String, String)> {
    let names = files_of(movements.iter().map(|movement| &*movement.segment));
    let files = movements.iter().zip(names).flat_map(|(movement, name)| {
        let itk = movement.itk_transform.iter().map(|text| (format!("{name}.tfm"), text.clone()));
        let itk: Vec<_> = itk.collect();
        std::iter::once((format!("{name}.txt"), movement.matrix_text.clone())).chain(itk)
    });
    files.collect()
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
