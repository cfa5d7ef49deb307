//! Only starts what `command` does.

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    facies::command::run(facies::command::Arguments::parse())
}
