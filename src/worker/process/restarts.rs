//! When the process of a slot may start anew: at once, or later after each crash in a row.

use std::time::{Duration, Instant};

/// Waits after one death more than one in a row; each is twice the one before.
const FIRST_WAIT: Duration = Duration::from_millis(100);
const LONGEST_WAIT: Duration = Duration::from_secs(10);

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
}
