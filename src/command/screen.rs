//! What the commands show: progress for people, tables for everybody.

use indicatif::{ProgressBar, ProgressStyle};

use crate::schema::WarningDocument;
use crate::schema::predict::check::CheckDocument;
use mechanics::progress::{Phase, Progress};

/// The phase and the residual on one line of a terminal; nothing where there is no terminal.
pub struct TerminalProgress(ProgressBar);

impl TerminalProgress {
    pub fn start() -> Self {
        let bar = ProgressBar::new_spinner();
        let template = "{spinner} {elapsed_precise} {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        TerminalProgress(bar)
    }

    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for TerminalProgress {
    fn phase(&self, phase: Phase) {
        self.0.set_message(phase.name());
        self.0.tick();
    }

    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64) {
        self.0.set_message(format!(
            "solve: iteration {iteration}, residual {relative_residual:.1e} of {wanted:.0e}"
        ));
        self.0.tick();
    }

    fn step(&self, done: usize, of: usize) {
        self.0.set_message(format!("row {} of {of}", (done + 1).min(of)));
        self.0.tick();
    }

    fn is_cancelled(&self) -> bool {
        false
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
    let time = check.time_s.map(|time| format!(", {:.1} to {:.1} s", time.low, time.high));
    let (unknowns, time) = (check.unknowns, time.unwrap_or_default());
    println!("unknowns   {unknowns}, about {:.0} MB{time}", check.memory_mb);
    print_warnings(&check.warnings);
}

pub fn print_warnings(warnings: &[WarningDocument]) {
    for warning in warnings {
        println!("warning    {} ({})", warning.detail, warning.code);
    }
}
