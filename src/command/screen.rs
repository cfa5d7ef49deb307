//! Output of the commands: progress for people, tables for everybody.

use std::io::{IsTerminal, stderr};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::jobs::result::folder;
use crate::jobs::{JobContext, JobError, JobInput, JobOutput, work};
use crate::schema::WarningDocument;
use crate::schema::case::muscle_mixing::MusclesDocument;
use crate::schema::predict::check::CheckDocument;
use crate::schema::predict::expectation::ExpectationDocument;
use crate::schema::predict::planned::ContactMapDocument;
use crate::schema::predict::result::FileDocument;
use mechanics::progress::{Phase, Progress};

/// Interval of progress lines of a long phase without a terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// The phase and the residual on standard error: one line that changes on a terminal, a line for each phase elsewhere.
pub struct TerminalProgress {
    bar: ProgressBar,
    started: Instant,
    /// When the last line was written; absent on a terminal.
    last: Option<Mutex<Instant>>,
}

impl TerminalProgress {
    pub fn start() -> Self {
        let bar = ProgressBar::new_spinner();
        let template = "{spinner} {elapsed_precise} {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let started = Instant::now();
        let last = (!stderr().is_terminal()).then(|| Mutex::new(started));
        TerminalProgress { bar, started, last }
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Shows what is being done; as a line at once or when the last one is old.
    fn tell(&self, what: String, at_once: bool) {
        let Some(last) = &self.last else {
            self.bar.set_message(what);
            self.bar.tick();
            return;
        };
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        if at_once || last.elapsed() >= LINE_EVERY {
            *last = Instant::now();
            eprintln!("{:8.2} s  {what}", self.started.elapsed().as_secs_f64());
        }
    }
}

/// Does a job, and shows where it is.
pub fn run_with_progress(input: &JobInput, place: &JobContext) -> Result<JobOutput, JobError> {
    folder::check(place)?;
    let progress = TerminalProgress::start();
    let done = work(input, place, &progress);
    progress.finish();
    done
}

impl Progress for TerminalProgress {
    fn phase(&self, phase: Phase) {
        self.tell(phase.name().to_owned(), true);
    }

    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64) {
        let residual = format!("residual {relative_residual:.1e} of {wanted:.0e}");
        self.tell(format!("solve: iteration {iteration}, {residual}"), false);
    }

    fn step(&self, done: usize, of: usize) {
        self.tell(format!("part {} of {of}", (done + 1).min(of)), false);
    }

    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Where the files of a job are.
pub fn print_files(files: &[FileDocument], folder: &Path) {
    for file in files {
        println!("wrote      {}", folder.join(&file.name).display());
    }
}

/// The classes of nodes, the skin and the size of the problem.
pub fn print_check(check: &CheckDocument) {
    println!("mesh       {} nodes, {} cells", check.nodes, check.cells);
    let classes = &check.classes;
    for (segment, count) in &classes.joined {
        println!("joined     {count} nodes to {segment}");
    }
    let others = [
        ("prescribed", classes.prescribed),
        ("fixed", classes.fixed),
        ("sliding", classes.sliding),
        ("free", classes.free),
    ];
    for (name, count) in others {
        println!("{name:<10} {count} nodes");
    }
    let skin = &check.skin;
    println!(
        "skin       {} nodes, {} triangles, {:.1} mm2",
        skin.nodes, skin.triangles, skin.area_mm2
    );
    for (name, count) in &skin.regions {
        println!("  {name:<8} {count} nodes");
    }
    check.muscles.iter().for_each(print_muscles);
    let time = check.time_s.map(|time| format!(", {:.1} to {:.1} s", time.low, time.high));
    let (unknowns, time) = (check.unknowns, time.unwrap_or_default());
    println!("unknowns   {unknowns}, about {:.0} MB{time}", check.memory_mb);
    match &check.auto {
        Some(auto) => print_expectation(auto),
        None => println!("model      {}, {}", check.method, check.why),
    }
    for contact in &check.contacts {
        let [one, other] = &contact.bones;
        let [before, planned] = [&contact.before, &contact.planned].map(|map| {
            let ContactMapDocument { area_mm2, overlap_area_mm2, depth_mm, count, .. } = map;
            format!("{count} of {area_mm2:.1} mm2, {overlap_area_mm2:.1} mm2 {depth_mm:.2} mm deep")
        });
        println!("contacts   {one} with {other}: {before} -> {planned}");
    }
    for measure in &check.cephalometry {
        let planned = measure.planned.map(|planned| format!(" -> {planned:.2}"));
        let planned = planned.unwrap_or_default();
        let norm = measure.norm.as_ref().map(|norm| {
            let z = norm.planned_z.map(|z| format!(" -> {z:+.1}")).unwrap_or_default();
            format!(", z {:+.1}{z} of {} ({})", norm.before_z, norm.mean, norm.source)
        });
        let norm = norm.unwrap_or_default();
        println!(
            "measure    {} {:.2}{planned} {}{norm}",
            measure.name, measure.before, measure.unit
        );
    }
    for own in &check.symmetry {
        let planned = own.planned.map(|planned| format!(" -> {:.2}", planned.length_mm));
        let (before, planned) = (own.before.length_mm, planned.unwrap_or_default());
        println!("symmetry   {} off by {before:.2}{planned} mm", own.landmark);
    }
    print_warnings(&check.warnings);
}

fn print_muscles(told: &MusclesDocument) {
    for (name, own) in &told.muscles {
        let of = own.enclosed_mm3.map(|enclosed| format!(" of {enclosed:.0}"));
        println!(
            "muscle     {name}: {} cells, {:.0}{} mm3",
            own.cells,
            own.volume_mm3,
            of.unwrap_or_default()
        );
    }
    if let Some(tissue) = &told.tissue {
        println!(
            "  mixed    {} of {} cells, {} with fibres that cross; the rule decides in {:.1} % of the tissue",
            tissue.mixed_cells,
            tissue.cells,
            tissue.crossing_cells,
            100.0 * tissue.rule_decides_share
        );
    }
}

fn print_expectation(auto: &ExpectationDocument) {
    let ExpectationDocument { accepted_mm, movement_mm, rotation_deg, at_least, at_most, .. } =
        auto;
    let models = match at_least == at_most {
        true => format!("`{at_least}`"),
        false => format!("`{at_least}` to `{at_most}`"),
    };
    println!(
        "auto       {models} for {accepted_mm} mm of error, by {movement_mm:.1} mm and {rotation_deg:.1} degrees of movement"
    );
    for rung in &auto.rungs {
        let time = rung.time_s.map(|time| format!(", {:.1} to {:.1} s", time.low, time.high));
        let time = time.unwrap_or_default();
        println!("  {:<14} about {:.0} MB{time}", rung.name, rung.memory_mb);
    }
}

pub fn print_warnings(warnings: &[WarningDocument]) {
    for warning in warnings {
        println!("warning    {} ({})", warning.detail, warning.code);
    }
}
