//! Progress and cancellation of a long computation.

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
