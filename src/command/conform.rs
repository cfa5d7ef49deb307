//! `facies conform`: a template mesh brought to a patient, with the case that it is ready for.

use std::path::{Path, PathBuf};

use clap::Args;

use super::claim::Claim;
use super::documents::{CASE_FILE, read};
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments, UnitArgument};
use super::screen::{print_files, print_warnings, run_with_progress};
use crate::jobs::{ConformInput, JobContext, JobInput};
use crate::schema::conform::result::{ConformationDocument, LeftDocument, MappedMuscleDocument};
use crate::schema::wire::canonical;
use crate::schema::{ConformDocument, Limits};

#[derive(Debug, Args)]
pub struct Arguments {
    /// The JSON body of the REST job, with paths relative to its folder in place of ids
    #[arg(long, value_name = "FILE", help_heading = "What is conformed")]
    spec: PathBuf,
    /// The folder for the mesh, the result and `case.json`
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
    /// The unit of length of all meshes
    #[arg(long, help_heading = "What is conformed", default_value = "mm")]
    units: UnitArgument,
    #[command(flatten)]
    scale: ScaleArguments,
}

/// Conforms, writes mesh and case, and tells what is left.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let mut spec: ConformDocument = read(&arguments.spec)?;
    let folder = arguments.spec.parent().unwrap_or(Path::new(""));
    for (_, id) in spec.mesh_references_mut() {
        *id = folder.join(&*id).to_string_lossy().into_owned();
    }
    let limits = Limits::default();
    let sources = FileSource::new(&PathBuf::new(), arguments.units.unit(), arguments.scale)
        .beside(&[CASE_FILE]);
    let input = JobInput::Conform(ConformInput { job: None, queue_s: None, spec });
    let place = JobContext { sources: &sources, limits: &limits, out: &arguments.out };
    let claim = Claim::of(&arguments.out, &[CASE_FILE])?;
    let done = run_with_progress(&input, &place)?;
    if let Some(found) = &done.result.conformation {
        let case = canonical::to_value(&found.case);
        let file = serde_json::json!({ "case": case });
        claim.put(CASE_FILE, format!("{file:#}\n"))?;
        print_found(found);
        print_muscles(&found.muscles);
    }
    let check = done.result.conformation.iter().filter_map(|found| found.check.as_ref());
    let of_case = check.flat_map(|check| &check.warnings);
    let mut warnings = done.result.warnings.clone();
    warnings.extend(of_case.filter(|own| !done.result.warnings.contains(own)).cloned());
    print_warnings(&warnings);
    print_files(&done.files, &arguments.out);
    println!("wrote      {}", arguments.out.join(CASE_FILE).display());
    Ok(())
}

fn print_found(found: &ConformationDocument) {
    let told = |name: &str, left: &LeftDocument| {
        let LeftDocument { mean_mm, rms_mm, p95_mm, max_mm, .. } = left;
        println!(
            "{name:<10} left {mean_mm:.2} mm (mean), {rms_mm:.2} (rms), {p95_mm:.2} (95 %), {max_mm:.2} (largest)"
        );
    };
    found.skin.iter().for_each(|left| told("skin", left));
    found.bone.iter().for_each(|left| told("bone", left));
    let worst = found.landmarks_mm.iter().max_by(|a, b| a.1.total_cmp(b.1));
    if let Some((name, left)) = worst {
        println!("landmarks  {left:.2} mm at most, at {name}");
    }
    let bad = found.before_repair.inverted + found.before_repair.undecided;
    println!(
        "cells      {bad} of {} not valid, {} after {} nodes were moved by up to {:.2} mm",
        found.before_repair.cells,
        found.repair.unproven.len(),
        found.repair.nodes_moved,
        found.repair.largest_move_mm
    );
}

fn print_muscles(muscles: &[MappedMuscleDocument]) {
    if muscles.is_empty() {
        return;
    }
    let all = |length: fn(&MappedMuscleDocument) -> f64| muscles.iter().map(length).sum::<f64>();
    println!(
        "muscles    {}, their lines {:.0} mm long, {:.0} on the template",
        muscles.len(),
        all(|muscle| muscle.length_mm),
        all(|muscle| muscle.template_length_mm)
    );
    let bodies = muscles.iter().filter_map(|own| own.template_volume_ml.zip(own.volume_ml));
    if let Some((before, after)) = bodies.reduce(|a, b| (a.0 + b.0, a.1 + b.1)) {
        println!("           their surfaces enclose {after:.2} ml, {before:.2} on the template");
    }
    let beside = muscles.iter().filter_map(|own| Some((&own.name, own.beside_other_map?)));
    if let Some((name, most)) = beside.max_by(|a, b| a.1.mean_deg.total_cmp(&b.1.mean_deg)) {
        println!(
            "           {name}: landmarks and conformation differ most, {:.1} degrees and {:.1} mm in the mean",
            most.mean_deg, most.mean_mm
        );
    }
}
