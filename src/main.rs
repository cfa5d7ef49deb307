use std::process::ExitCode;

use facies::command::{read, run};

fn main() -> ExitCode {
    run(&read())
}
