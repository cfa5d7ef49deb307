//! Deadline and cancellation of a computation.

use super::Stopwatch;
use crate::progress::{Phase, Progress};

pub(super) struct Deadline<'a> {
    stopwatch: &'a dyn Stopwatch,
    progress: &'a dyn Progress,
    /// Of the stopwatch, in s; infinite where there is none.
    until: f64,
}

impl<'a> Deadline<'a> {
    /// So many seconds from now.
    pub(super) fn after(
        seconds: f64,
        stopwatch: &'a dyn Stopwatch,
        progress: &'a dyn Progress,
    ) -> Self {
        let until = if seconds.is_finite() { stopwatch.seconds() + seconds } else { seconds };
        Deadline { stopwatch, progress, until }
    }
}

impl Progress for Deadline<'_> {
    fn phase(&self, phase: Phase) {
        self.progress.phase(phase);
    }

    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64) {
        self.progress.iteration(iteration, relative_residual, wanted);
    }

    fn is_cancelled(&self) -> bool {
        let is_late = self.until.is_finite() && self.stopwatch.seconds() > self.until;
        is_late || self.progress.is_cancelled()
    }
}
