//! Reports of the process of a slot to its worker.

use std::io::{Stdout, Write};
use std::sync::{Mutex, PoisonError};

use super::protocol::{Report, encode};

/// Messages of a process to its worker.
pub struct Reports(Mutex<Stdout>);

impl Reports {
    pub fn to(output: Stdout) -> Self {
        Reports(Mutex::new(output))
    }

    pub fn tell(&self, report: &Report) {
        let told = encode(report).and_then(|frame| {
            let mut to = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            to.write_all(&frame)?;
            to.flush()
        });
        if told.is_err() {
            // The worker is gone: the result of this process is of no use.
            std::process::exit(0);
        }
    }
}
