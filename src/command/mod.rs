//! The commands of the program, one file for each.

pub mod admin;
pub mod check;
mod claim;
pub mod cohort;
pub mod compare;
pub mod config;
pub mod conform;
pub mod demo;
mod deployment;
mod documents;
pub mod face;
mod failure;
mod files;
pub mod health;
pub mod learn;
mod limits_of_files;
pub mod materials;
pub mod mesh;
pub mod migrate;
pub mod openapi;
pub mod optimise;
pub mod predict;
pub mod reproduce;
pub mod response;
mod scene;
mod screen;
mod selection;
pub mod serve;
pub mod settings;
pub mod simplify;
pub mod slot;
pub mod stability;
mod stability_random;
pub mod study;
mod study_screen;
mod sweep;
mod threshold;
mod watch;
pub mod worker;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

pub use failure::CommandError;

/// Predicts how a face will look after the bones under it are moved. Not a medical device.
#[derive(Debug, Parser)]
#[command(name = "facies", version)]
pub struct Facies {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Predict a face that the program makes itself, and say how good the numbers are
    Demo(demo::Arguments),
    /// Write a generic face that the program makes itself, with its muscles, as a case to start from
    Face(face::Arguments),
    /// Make a volume mesh of the soft tissue in a CT, with the segments that a plan cuts
    Mesh(mesh::Arguments),
    /// Predict the skin after a plan; write it with its statistics into a folder
    Predict(predict::Arguments),
    /// Solve a case once, so that the skin of every further plan of its segments is a sum
    Response(response::Arguments),
    /// Find the plan whose skin is nearest to given targets
    Optimise(optimise::Arguments),
    /// Find what an operation did from bone before and after it; write it as a plan
    Reproduce(reproduce::Arguments),
    /// Fit a template mesh to a patient; write the mesh and its case
    Conform(conform::Arguments),
    /// Measure the distances between two surfaces
    Compare(compare::Arguments),
    /// Reduce the triangles of a surface, within a bound on its deviation
    Simplify(simplify::Arguments),
    /// Find the threshold at which a bone is as large in one scan as in another
    Threshold(threshold::Arguments),
    /// Compare methods over comparisons with the scans of several patients
    Cohort(cohort::Arguments),
    /// Learn from operated cases what predictions miss, and say whether that helps
    Learn(learn::Arguments),
    /// Compare methods: the time each takes, and its distance from a reference solution
    Study(study::Arguments),
    /// List the materials of the literature that a case may name, with their sources
    Materials(materials::Arguments),
    /// Check a case and a plan and report what they contain, without solving
    Check(check::Arguments),
    /// Serve the API, with workers in the same process unless there are 0
    Serve(settings::Arguments),
    /// Work on the jobs of a shared database, without an API
    Worker(settings::Arguments),
    /// Compute the jobs of one slot; started by `serve` and `worker`
    #[command(hide = true)]
    Slot(slot::Arguments),
    /// Bring the schema of the database up to date
    Migrate(settings::Arguments),
    /// Move, back up and check a deployment
    Admin(admin::Arguments),
    /// Print the settings in force, with secrets hidden
    Config(settings::Arguments),
    /// Ask the service on this machine whether it is alive
    Health(settings::Arguments),
    /// Print the OpenAPI description of the service
    Openapi,
}

/// Headings of the help and the commands under each.
const GROUPS: [(&str, &[&str]); 2] = [
    (
        "Predict and plan",
        &[
            "demo",
            "face",
            "mesh",
            "check",
            "predict",
            "response",
            "optimise",
            "reproduce",
            "conform",
            "compare",
            "simplify",
            "threshold",
            "cohort",
            "learn",
            "study",
            "materials",
        ],
    ),
    ("Serve", &["serve", "worker", "migrate", "admin", "config", "health", "openapi"]),
];

/// The command that was asked for; ends the program where there is none.
pub fn read() -> Facies {
    let command = Facies::command();
    let template = help_template(&command);
    let matches = command.help_template(template).get_matches();
    Facies::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
}

/// The help of the program with its commands in groups, which clap has for arguments only.
fn help_template(command: &clap::Command) -> String {
    let mut groups = String::new();
    for (heading, names) in GROUPS {
        groups += &format!("{heading}:\n");
        for name in names {
            let about = command.find_subcommand(name).and_then(clap::Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            groups += &format!("  {name:<10} {about}\n");
        }
        groups += "\n";
    }
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}Options:\n{{options}}\n"
    )
}

/// The stack of a thread that computes, in bytes: that of a main thread.
const STACK: usize = 8 << 20;

/// Runs what computes on a thread of the pool: from another thread each parallel loop would wake one and wait for it, 3 400 times in the
/// prediction of a face.
fn computing<T: Send>(run: impl FnOnce() -> T + Send) -> T {
    // A pool that is there already, or none that can be had, serves as well.
    let _ = rayon::ThreadPoolBuilder::new().stack_size(STACK).build_global();
    rayon::scope(|_| run())
}

/// Runs the command and says what went wrong, one line for each mistake.
pub fn run(facies: &Facies) -> ExitCode {
    if let Err(error) = limits_of_files::ignore_file_size_signal() {
        eprintln!("error: the signal of files that grow too large is not listened to: {error}");
        return ExitCode::from(failure::INFRASTRUCTURE);
    }
    let result = match &facies.command {
        Command::Demo(arguments) => demo::run(arguments).map_err(CommandError::from),
        Command::Face(arguments) => computing(|| face::run(arguments)),
        Command::Mesh(arguments) => computing(|| mesh::run(arguments)),
        Command::Predict(arguments) => computing(|| predict::run(arguments)),
        Command::Response(arguments) => computing(|| response::run(arguments)),
        Command::Optimise(arguments) => computing(|| optimise::run(arguments)),
        Command::Reproduce(arguments) => computing(|| reproduce::run(arguments)),
        Command::Conform(arguments) => computing(|| conform::run(arguments)),
        Command::Compare(arguments) => computing(|| compare::run(arguments)),
        Command::Simplify(arguments) => computing(|| simplify::run(arguments)),
        Command::Threshold(arguments) => computing(|| threshold::run(arguments)),
        Command::Cohort(arguments) => computing(|| cohort::run(arguments)),
        Command::Learn(arguments) => computing(|| learn::run(arguments)),
        Command::Study(arguments) => computing(|| study::run(arguments)),
        Command::Materials(arguments) => materials::run(arguments),
        Command::Check(arguments) => computing(|| check::run(arguments)),
        Command::Serve(arguments) => serve::run(arguments).map_err(CommandError::from),
        Command::Slot(arguments) => slot::run(arguments).map_err(CommandError::from),
        Command::Worker(arguments) => worker::run(arguments).map_err(CommandError::from),
        Command::Migrate(arguments) => migrate::run(arguments).map_err(CommandError::from),
        Command::Admin(arguments) => admin::run(arguments).map_err(CommandError::from),
        Command::Config(arguments) => config::run(arguments).map_err(CommandError::from),
        Command::Health(arguments) => health::run(arguments).map_err(CommandError::from),
        Command::Openapi => openapi::run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            for line in error.lines() {
                eprintln!("error: {line}");
            }
            ExitCode::from(error.exit_code())
        }
    }
}
