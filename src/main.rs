use std::io::Write;
use std::panic;
use std::process::{ExitCode, exit};

use facies::command::{read, run};

/// Exit status of a program that wrote to a closed pipe: 128 and SIGPIPE.
const NOBODY_READS: i32 = 141;
/// Exit status where a result could not be written, as for files.
const NOT_WRITTEN: i32 = 3;

fn main() -> ExitCode {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |told| {
        // `println!` panics where standard output is a pipe whose reader has gone, as `head` goes, or a file on a full disk.
        let text = told.payload().downcast_ref::<String>().map_or("", String::as_str);
        match text.strip_prefix("failed printing to ") {
            Some(reason) if reason.contains("Broken pipe") => exit(NOBODY_READS),
            Some(reason) => {
                // Standard error may be full as well.
                let _ = writeln!(std::io::stderr(), "error: could not write to {reason}");
                exit(NOT_WRITTEN)
            }
            None => usual(told),
        }
    }));
    run(&read())
}
