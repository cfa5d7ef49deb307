//! Time and memory for a study.

use std::time::Instant;

use crate::jobs::clock::peak_rss_mb;
use mechanics::study::Stopwatch;

/// The clock of this machine and the memory of this process.
pub struct MachineStopwatch(Instant);

impl MachineStopwatch {
    pub fn start() -> Self {
        MachineStopwatch(Instant::now())
    }
}

impl Stopwatch for MachineStopwatch {
    fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    /// Linux resets the peak of a process that writes 5 here (proc(5), since 4.0). If not permitted, the peak
    /// remains that of all earlier work.
    fn reset_peak(&self) {
        let _ = std::fs::write("/proc/self/clear_refs", "5");
    }

    fn peak_mb(&self) -> Option<f64> {
        peak_rss_mb()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_that_since_it_was_forgotten() {
        let watch = MachineStopwatch::start();
        let Some(before) = watch.peak_mb() else { return };
        // Other tests run beside this one: only a block larger than all they take together shows.
        let block = vec![1u8; 600 << 20];
        let with = watch.peak_mb().unwrap_or_default();
        assert!(block.iter().step_by(4096).map(|&byte| u64::from(byte)).sum::<u64>() > 0);
        assert!(with > before.max(600.0), "{before} {with}");
        drop(block);
        let can_forget =
            std::fs::OpenOptions::new().write(true).open("/proc/self/clear_refs").is_ok();
        watch.reset_peak();
        let after = watch.peak_mb().unwrap_or_default();
        assert!(!can_forget || after < with - 300.0, "{with} {after}");
    }
}
