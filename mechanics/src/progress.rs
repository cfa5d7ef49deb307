//! Progress of a long computation: where it is, and whether it is to stop.

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

/// Told by the numerics, kept by the caller. Called from the solving thread, often, so it must be quick.
pub trait Progress: Sync {
    fn phase(&self, phase: Phase);

    /// One more iteration of the solver, with its relative residual and the one asked for.
    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64);

    /// A part of the work is done, of so many that are alike.
    fn step(&self, _done: usize, _of: usize) {}

    /// The work stops by itself once it has taken so many seconds; who waits longer waits in vain.
    fn allowed(&self, _wall_s: f64) {}

    /// True when the work is to end at its next check with a `cancelled` error.
    fn is_cancelled(&self) -> bool;
}

/// Progress nobody follows, of work that nobody stops.
pub struct Unobserved;

/// Work inside an iteration of other work: it ends with that, and tells nothing of its own.
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
