//! Progress and cancellation of a long computation.

use std::sync::atomic::{AtomicBool, Ordering};

/// What the work is at; the caller takes the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Validate,
    Mesh,
    Assemble,
    Solve,
    Estimate,
    Contact,
    Surface,
    Compare,
    Correct,
    Write,
}

impl Phase {
    const ALL: [Phase; 10] = [
        Phase::Validate,
        Phase::Mesh,
        Phase::Assemble,
        Phase::Solve,
        Phase::Estimate,
        Phase::Contact,
        Phase::Surface,
        Phase::Compare,
        Phase::Correct,
        Phase::Write,
    ];

    /// The phase of that name.
    pub fn from_name(name: &str) -> Option<Phase> {
        Phase::ALL.into_iter().find(|phase| phase.name() == name)
    }

    pub fn name(self) -> &'static str {
        match self {
            Phase::Validate => "validate",
            Phase::Mesh => "mesh",
            Phase::Assemble => "assemble",
            Phase::Solve => "solve",
            Phase::Estimate => "estimate",
            Phase::Contact => "contact",
            Phase::Surface => "surface",
            Phase::Compare => "compare",
            Phase::Correct => "correct",
            Phase::Write => "write",
        }
    }
}

/// Observer of a computation. Called often, from the solving thread, so it must be quick.
pub trait Progress: Sync {
    fn phase(&self, phase: Phase);

    /// One more iteration of the solver, with its relative residual and the one asked for.
    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64);

    /// A part of the work is done, of so many that are alike.
    fn step(&self, _done: usize, _of: usize) {}

    /// The work stops by itself after so many seconds.
    fn allowed(&self, _wall_s: f64) {}

    /// True when the work is to end at its next check with a `cancelled` error.
    fn is_cancelled(&self) -> bool;
}

/// No observer: progress is ignored and nothing is cancelled.
pub struct Unobserved;

/// Work inside an iteration of other work: cancelled with it, without progress of its own.
pub struct Inner<'a>(pub &'a dyn Progress);

/// Whether to stop, for loops that then leave out the rest and whose results are dropped. A stop that was asked for once stays, so that
/// nobody who asks after the loop takes what is not whole for an answer.
pub struct StopQuery<'a> {
    progress: &'a dyn Progress,
    is_asked: AtomicBool,
}

/// Items of a loop between two questions to its observer.
const ITEMS_UNASKED: usize = 64;

impl<'a> StopQuery<'a> {
    pub fn of(progress: &'a dyn Progress) -> Self {
        StopQuery { progress, is_asked: AtomicBool::new(false) }
    }

    /// That of work that nobody stops.
    pub fn never() -> StopQuery<'static> {
        StopQuery::of(&Unobserved)
    }

    /// Asks the observer, unless the stop is known.
    pub fn is_asked(&self) -> bool {
        let is_asked = self.is_known() || self.progress.is_cancelled();
        if is_asked {
            self.is_asked.store(true, Ordering::Relaxed);
        }
        is_asked
    }

    /// The same for an item of a loop by its number: the observer is asked at every 64th.
    pub fn is_asked_at(&self, item: usize) -> bool {
        match item.is_multiple_of(ITEMS_UNASKED) {
            true => self.is_asked(),
            false => self.is_known(),
        }
    }

    fn is_known(&self) -> bool {
        self.is_asked.load(Ordering::Relaxed)
    }
}

impl Progress for Unobserved {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        false
    }
}

impl Progress for Inner<'_> {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}
