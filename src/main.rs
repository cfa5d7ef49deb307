use std::process::ExitCode;

use clap::Parser;
use facies::command::{Facies, run};

fn main() -> ExitCode {
    run(&Facies::parse())
}
