//! A progress that asks the work to stop when it reaches a phase.

use std::sync::atomic::{AtomicBool, Ordering};

use mechanics::progress::{Phase, Progress};

/// Somebody who asks the work to stop when it reaches a phase.
pub struct StopAt {
    phase: Phase,
    is_reached: AtomicBool,
}

impl StopAt {
    pub fn phase(phase: Phase) -> Self {
        StopAt { phase, is_reached: AtomicBool::new(false) }
    }
}

impl Progress for StopAt {
    fn phase(&self, phase: Phase) {
        if phase == self.phase {
            self.is_reached.store(true, Ordering::SeqCst);
        }
    }

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        self.is_reached.load(Ordering::SeqCst)
    }
}
