//! Ends and starts of the process of a slot: when it makes room for a fresh one, and when that may start, at once or later after
//! each crash in a row.

use std::time::{Duration, Instant};

/// Waits after one death more than one in a row; each is twice the one before.
const FIRST_WAIT: Duration = Duration::from_millis(100);
const LONGEST_WAIT: Duration = Duration::from_secs(10);
/// After so many jobs a process makes room for a fresh one.
const JOBS_OF_A_PROCESS: usize = 1000;

#[derive(Default)]
pub struct Restarts {
    /// In a row, with no job that ended in between.
    deaths: u32,
    not_before: Option<Instant>,
}

impl Restarts {
    /// A job ended, by itself or because its process was killed for it: crashes before it do not count.
    pub fn job_ended(&mut self) {
        *self = Restarts::default();
    }

    /// Delays the next start, longer after each crash in a row.
    pub fn died(&mut self) {
        self.deaths += 1;
        let wait = match self.deaths {
            0 | 1 => Duration::ZERO,
            deaths => FIRST_WAIT.saturating_mul(1 << (deaths - 2).min(16)).min(LONGEST_WAIT),
        };
        self.not_before = Some(Instant::now() + wait);
    }

    /// How long it has to wait still, if at all.
    pub fn wait(&self) -> Option<Duration> {
        let wait = self.not_before?.checked_duration_since(Instant::now());
        wait.filter(|wait| !wait.is_zero())
    }
}

/// Why a process is not to be used again, if so: a bug may have left anything, many jobs leave memory in pieces, and a
/// half of the memory that is not given back is missing in the next job.
pub fn recycling(
    panicked: bool,
    jobs: usize,
    bytes: Option<u64>,
    limit: u64,
) -> Option<&'static str> {
    if panicked {
        return Some("panic");
    }
    if jobs >= JOBS_OF_A_PROCESS {
        return Some("jobs");
    }
    bytes.filter(|bytes| *bytes > limit / 2).map(|_| "memory")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_waits_after_crashes_in_a_row_and_not_after_a_job_that_ended() {
        let mut restarts = Restarts::default();
        restarts.died();
        assert_eq!(restarts.wait(), None, "once is no row");
        (0..20).for_each(|_| restarts.died());
        let longest = restarts.wait().unwrap();
        assert!(longest > LONGEST_WAIT / 2 && longest <= LONGEST_WAIT, "{longest:?}");
        restarts.job_ended();
        assert_eq!(restarts.wait(), None);
        restarts.died();
        assert_eq!(restarts.wait(), None, "the row begins anew");
    }

    #[test]
    fn a_process_is_used_until_it_panics_is_old_or_keeps_half_of_its_memory() {
        assert_eq!(recycling(false, JOBS_OF_A_PROCESS - 1, Some(500), 1000), None);
        assert_eq!(recycling(true, 1, Some(1), 1000), Some("panic"));
        assert_eq!(recycling(false, JOBS_OF_A_PROCESS, Some(1), 1000), Some("jobs"));
        assert_eq!(recycling(false, 1, Some(501), 1000), Some("memory"));
        assert_eq!(recycling(false, 1, None, 1000), None);
    }
}
