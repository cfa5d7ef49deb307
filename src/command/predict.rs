//! `facies predict`: the path of a job without a server.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::de::DeserializeOwned;

use super::claim::Claim;
use super::documents::{CASE_FILE, is_same};
use super::failure::CommandError;
use super::mesh::ScanArguments;
use super::scene::{PlanArgument, SceneArguments};
use super::screen::{print_check, print_files, print_warnings, run_with_progress};
use super::watch::Watch;
use crate::jobs::result::folder;
use crate::jobs::{JobContext, JobInput, check};
use crate::schema::Limits;
use crate::schema::methods::MethodName;
use crate::schema::methods::fem_nonlinear::FemNonlinearDocument;
use crate::schema::predict::check::CheckDocument;
use crate::schema::predict::document::{ContactName, EstimateName, OutputName};
use crate::schema::predict::newton::LoadStepDocument;
use crate::schema::predict::result::ResultDocument;
use mechanics::progress::StopQuery;

/// What is kept goes to the meshes of a tenant.
const NO_STORE: &str =
    "`keep` asks to store meshes, and a command has no store: ask for files by `outputs` instead";

/// A case alone has a check and no prediction.
const NO_PLAN: &str = "there is no plan to predict: give `plan` beside the case in the file, or --plan with --mesh or --scan; \
                       `facies check` looks at a case alone";

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    plan: PlanArgument,
    #[command(flatten)]
    scan: ScanArguments,
    /// The mechanical model of the soft tissue [default: auto, the cheapest expected to meet the accepted error]
    #[arg(long, value_name = "NAME", value_parser = word::<MethodName>, help_heading = "Tissue")]
    method: Option<MethodName>,
    /// Add what the mesh leaves out, as far as that is estimated, to the displacement
    #[arg(long, help_heading = "Result")]
    corrected: bool,
    /// Take the cheapest model whose expected mean error over the skin is within so many mm [default: 0.1]
    #[arg(
        long,
        allow_negative_numbers = true,
        value_name = "MM",
        conflicts_with = "corrected",
        help_heading = "Result"
    )]
    accept: Option<f64>,
    /// Refine the mesh until the estimated mean error over the skin is within so many mm
    #[arg(
        long,
        allow_negative_numbers = true,
        value_name = "MM",
        conflicts_with = "accept",
        help_heading = "Result"
    )]
    refine: Option<f64>,
    /// What keeps tissue from passing through itself and bone: none, sliding, unilateral or auto
    #[arg(long, value_name = "KIND", value_parser = word::<ContactName>, help_heading = "Result")]
    contact: Option<ContactName>,
    /// Apply the load in so many equal steps and report each; with the method fem_nonlinear
    #[arg(long, value_name = "NUMBER", help_heading = "Tissue")]
    load_steps: Option<u32>,
    /// Write stress and strain of the tissue to volume.vtu
    #[arg(long, conflicts_with = "refine", help_heading = "Result")]
    stress: bool,
    /// The files to write, e.g. skin.vtp,volume.vtu [default: skin, bones, pictures and report]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = word::<OutputName>, help_heading = "Result")]
    outputs: Option<Vec<OutputName>>,
    /// Do not estimate the error of the mesh
    #[arg(long, conflicts_with_all = ["corrected", "refine"], help_heading = "Result")]
    no_estimate: bool,
    /// The folder for the result
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
}

/// Tells what is held, solves, writes the result and the documents, and prints a table.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let plan = arguments.plan.plan.as_deref();
    let read_from = arguments.scene.case.as_deref();
    let is_own = |from: &Path| is_same(from, &arguments.out.join(CASE_FILE));
    let written: &[&str] = if read_from.is_some_and(is_own) { &[] } else { &[CASE_FILE] };
    let _claim = Claim::of(&arguments.out, written)?;
    let mut asked = match arguments.scan.is_given() {
        true => arguments.scene.documents_of_scan(&arguments.scan, plan, &arguments.out)?,
        false => arguments.scene.documents(plan)?,
    };
    asked.file.refuse_beside_spec(&asked.path)?;
    let stated = arguments.outputs.clone().or(asked.file.spec.outputs.take());
    let outputs = stated.unwrap_or_else(usual_outputs);
    folder::refuse_foreign(&arguments.out, outputs.iter().map(|output| output.file_name()))?;
    asked.file.spec.outputs = Some(outputs);
    asked.file.spec.method = arguments.method.unwrap_or(asked.file.spec.method);
    if arguments.load_steps.is_some() {
        let load_steps = arguments.load_steps;
        asked.file.spec.fem_nonlinear = Some(FemNonlinearDocument { load_steps });
    }
    asked.file.spec.corrected |= arguments.corrected;
    if arguments.stress {
        asked.file.spec.request_stress();
    }
    asked.file.spec.accept_mm = arguments.accept.or(asked.file.spec.accept_mm);
    if let Some(accept_mm) = arguments.refine {
        asked.file.spec.refine_to(accept_mm);
    }
    asked.file.spec.contact = arguments.contact.unwrap_or(asked.file.spec.contact);
    if arguments.no_estimate {
        asked.file.spec.estimate = EstimateName::None;
    }
    if !asked.file.spec.tags.is_empty() {
        eprintln!("not used   `tags` of the spec: a command has no list of jobs");
    }
    if !asked.file.spec.keep.is_empty() {
        return Err(CommandError::Usage(NO_STORE.to_owned()));
    }
    if asked.file.plan.is_none() {
        return Err(CommandError::Usage(NO_PLAN.to_owned()));
    }
    asked.sources = asked.sources.beside(written);
    let limits = Limits::default();
    let input = asked.file.to_input();
    let _watch = Watch::start(&input.spec.budget);

    let before = check(&input, &asked.sources, &limits, &StopQuery::never())?.document;
    print_check(&before);

    let place = JobContext { sources: &asked.sources, limits: &limits, out: &arguments.out };
    let done = run_with_progress(&JobInput::Predict(input), &place)?;

    let documents = asked.file.write_beside(&asked.folder, &arguments.out, read_from)?;
    print_result(&done.result, &before);
    print_files(&done.files, &arguments.out);
    println!("wrote      {}", documents.display());
    Ok(())
}

/// By the words of documents.
fn word<T: DeserializeOwned>(word: &str) -> Result<T, String> {
    serde_json::from_value(word.into()).map_err(|error| error.to_string())
}

/// What a person at a terminal looks at.
fn usual_outputs() -> Vec<OutputName> {
    vec![
        OutputName::SkinVtp,
        OutputName::SkinGlb,
        OutputName::BonesVtp,
        OutputName::ClassesSvg,
        OutputName::DisplacementSvg,
        OutputName::GapsSvg,
        OutputName::MusclesSvg,
        OutputName::ReportHtml,
        OutputName::ReportPdf,
    ]
}

fn print_result(result: &ResultDocument, before: &CheckDocument) {
    println!();
    if let Some(statistics) = &result.statistics {
        println!("displacement in mm   mean   median   p95     max    (skin nodes; by area)");
        let regions = statistics.regions.iter().map(|(name, region)| (name.as_str(), region));
        for (name, region) in [("skin", &statistics.skin)].into_iter().chain(regions) {
            for (weights, stat) in [("nodes", &region.nodes), ("area", &region.area)] {
                println!(
                    "{name:<12} {weights:<6} {:>7.3} {:>7.3} {:>7.3} {:>7.3}",
                    stat.mean, stat.median, stat.p95, stat.max
                );
            }
        }
        for (name, moved) in &statistics.landmarks {
            let [x, y, z] = moved.0;
            println!("landmark     {name} moves by {x:.3} {y:.3} {z:.3} mm");
        }
    }
    if let Some(nonlinearity) = &result.nonlinearity_mm {
        let left = &nonlinearity.skin;
        println!(
            "linearity    estimated linearisation error: mean {:.3} mm, p95 {:.3}, max {:.3}",
            left.mean, left.p95, left.max
        );
    }
    print_error_of_mesh(result);
    print_inside(result);
    if let Some(adequacy) = &result.adequacy {
        println!("model        {}", adequacy.why());
    }
    if let Some(refinement) = &result.refinement {
        println!("refined      {}", refinement.summary());
    }
    for (name, reaction) in &result.reaction_millinewton {
        let [x, y, z] = reaction.0;
        println!("reaction     {name} {x:.1} {y:.1} {z:.1} mN");
    }
    let provenance = &result.provenance;
    if let Some(solver) = &provenance.solver {
        println!(
            "solver       {}, {} iterations, residual {:.1e} (wanted {:.0e})",
            solver.name, solver.iterations, solver.relative_residual, solver.wanted_residual
        );
    }
    print_load_steps(&result.load_steps);
    let timing = &provenance.timing;
    println!(
        "time         {:.2} s: assemble {:.2}, solve {:.2}, estimate {:.2}, write {:.2}; peak memory {:.0} MB",
        timing.total_s,
        timing.assemble_s,
        timing.solve_s,
        timing.estimate_s,
        timing.write_s,
        provenance.peak_rss_mb.unwrap_or_default()
    );
    let solved: Vec<_> = result.warnings.iter().filter(|w| !before.warnings.contains(w)).collect();
    print_warnings(&solved.into_iter().cloned().collect::<Vec<_>>());
}

/// What presses, and stress.
fn print_inside(result: &ResultDocument) {
    if let Some(contact) = &result.contact {
        println!(
            "contact      {:.1} mm2, largest pressure {:.2} kPa, {} passes",
            contact.area_mm2, contact.largest_pressure_kpa, contact.passes
        );
    }
    for (region, stress) in result.stress.iter().flat_map(|stress| &stress.regions) {
        let (mises, pressure) = (&stress.von_mises_kpa, &stress.pressure_kpa);
        println!(
            "stress       {region}: Mises {:.3} kPa in the mean, p95 {:.3}, max {:.3}; pressure {:.3} to {:.3} kPa",
            mises.mean, mises.p95, mises.max, pressure.min, pressure.max
        );
    }
}

fn print_load_steps(steps: &[LoadStepDocument]) {
    let Some(first) = steps.first() else { return };
    let held: Vec<String> =
        first.reaction_millinewton.keys().map(|name| format!("{name} mN")).collect();
    let presses = steps.iter().any(|step| step.contact.is_some());
    let area = if presses { " contact mm2" } else { "" };
    println!(
        "load steps   {:>6} {:>5} {:>12} {:>10} {:>9} {:>7}{area}   {}",
        "share",
        "steps",
        "energy mN mm",
        "det F",
        "residual",
        "stable",
        held.join("   ")
    );
    for step in steps {
        let LoadStepDocument { rest, is_stable, reaction_millinewton, contact, .. } = step;
        let stable = is_stable.map_or("?", |is_stable| if is_stable { "yes" } else { "no" });
        let norms = reaction_millinewton.values().zip(&held).map(|(force, title)| {
            let [x, y, z] = force.0;
            format!("{:>width$.1}", x.hypot(y).hypot(z), width = title.chars().count())
        });
        let area = match contact {
            _ if !presses => String::new(),
            Some(contact) => format!("{:>12.1}", contact.area_mm2),
            None => format!("{:>12}", "-"),
        };
        println!(
            "             {:>6.3} {:>5} {:>12.2} {:>10.4} {:>9.1e} {stable:>7}{area}   {}{}",
            rest.share,
            rest.steps,
            rest.energy_mn_mm,
            rest.least_det_f,
            step.relative_residual,
            norms.collect::<Vec<_>>().join("   "),
            step.warnings.iter().map(|code| format!("   {code}")).collect::<String>()
        );
    }
}

fn print_error_of_mesh(result: &ResultDocument) {
    match (&result.numerical_error_mm, &result.numerical_error_unknown) {
        (Some(error), _) => println!(
            "mesh         estimated discretisation error: mean {:.3} mm, p95 {:.3}, max {:.3}{}",
            error.mean,
            error.p95,
            error.max,
            if error.corrected { ", added to the result" } else { "" }
        ),
        (None, Some(why)) => println!("mesh         discretisation error unknown: {why}"),
        (None, None) => (),
    }
}
