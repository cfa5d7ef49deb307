//! Watchdog of a job's budget on the command line: it does to this process what a worker does to the process of a slot.
//!
//! The work looks at its budget of time between iterations, and bounds the memory of its solver by an estimate. What
//! neither notices, a factorisation or a structure that grows beyond its estimate, is ended here.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use super::failure::FAILED;
use crate::schema::ErrorCode;
use crate::schema::predict::budget::BudgetDocument;
use crate::worker::process::memory;

/// How often is looked.
const LOOK: Duration = Duration::from_millis(50);
/// How long work may go on once its time is used up, as in a slot.
const GRACE: Duration = Duration::from_secs(10);

/// Looks on until it is dropped.
pub struct Watch {
    _work_goes_on: Sender<()>,
}

/// What ends the process.
struct Bounds {
    wall_s: f64,
    /// None where the time never comes.
    until: Option<Instant>,
    memory_mb: f64,
    /// Of the whole process.
    most_bytes: f64,
}

impl Watch {
    /// Ends the process with a message once it takes more than the budget beyond what it takes now.
    pub fn start(budget: &BudgetDocument) -> Watch {
        let wall = Duration::try_from_secs_f64(budget.wall_s).ok();
        let taken = memory::usage("self").map_or(0.0, |usage| usage.now_bytes as f64);
        let bounds = Bounds {
            wall_s: budget.wall_s,
            until: wall.and_then(|wall| Instant::now().checked_add(wall + GRACE)),
            memory_mb: budget.memory_mb,
            most_bytes: taken + memory::ROOM * budget.memory_mb * 1e6,
        };
        let (work_goes_on, heard) = channel();
        std::thread::spawn(move || watch_bounds(&bounds, &heard));
        Watch { _work_goes_on: work_goes_on }
    }
}

fn watch_bounds(bounds: &Bounds, work: &Receiver<()>) {
    while let Err(RecvTimeoutError::Timeout) = work.recv_timeout(LOOK) {
        let usage = memory::usage("self").map(|usage| usage.now_bytes as f64);
        if let Some(why) = bounds.broken(Instant::now(), usage) {
            eprintln!("error: {why} ({})", ErrorCode::BudgetExceeded);
            std::process::exit(i32::from(FAILED));
        }
    }
}

impl Bounds {
    /// In which way the budget is used up, if it is.
    fn broken(&self, now: Instant, bytes: Option<f64>) -> Option<String> {
        let (wall_s, memory_mb) = (self.wall_s, self.memory_mb);
        if self.until.is_some_and(|until| now > until) {
            return Some(format!("wall ran out: {wall_s} s are allowed by `budget`"));
        }
        let bytes = bytes.filter(|bytes| *bytes > self.most_bytes)?;
        let (taken, most) = (bytes / 1e6, self.most_bytes / 1e6);
        Some(format!(
            "memory ran out: a budget of {memory_mb} MB lets the program take {most:.0} MB, and it took {taken:.0} MB"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_broken_by_time_or_by_memory_with_its_numbers() {
        let now = Instant::now();
        let later = now + Duration::from_secs(1);
        let bounds =
            Bounds { wall_s: 5.0, until: Some(later), memory_mb: 100.0, most_bytes: 150e6 };
        assert_eq!(bounds.broken(now, Some(149e6)), None);
        assert_eq!(bounds.broken(now, None), None);
        let time = bounds.broken(later + LOOK, Some(1.0)).unwrap();
        assert_eq!(time, "wall ran out: 5 s are allowed by `budget`");
        let memory = bounds.broken(now, Some(151e6)).unwrap();
        assert!(memory.contains("100 MB") && memory.contains("took 151 MB"), "{memory}");
    }
}
