//! The clock of a job: the wall time of each phase, and the total time budget.

use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::failure::{JobError, TIME_OF_STUDY};
use crate::schema::predict::result::TimingDocument;
use crate::schema::wire::date::date_and_time;
use mechanics::prediction::{ModelError, SolverError};
use mechanics::progress::{Phase, Progress, StopQuery};

/// Forwards progress, measures the time of the phases, and cancels the work once its time is used up.
pub struct Observed<'a> {
    inner: &'a dyn Progress,
    started: Instant,
    budget: Duration,
    /// How the budget follows from what was stated, if it is not that.
    how: &'static str,
    phases: Mutex<Phases>,
}

struct Phases {
    current: Phase,
    since: Instant,
    spent: Vec<(Phase, Duration)>,
}

impl<'a> Observed<'a> {
    /// Starts the clock; `wall_s` is the budget in seconds.
    pub fn start(inner: &'a dyn Progress, wall_s: f64) -> Self {
        let now = Instant::now();
        let phases = Phases { current: Phase::Validate, since: now, spent: Vec::new() };
        inner.allowed(wall_s);
        inner.phase(Phase::Validate);
        Observed {
            inner,
            started: now,
            budget: Duration::try_from_secs_f64(wall_s).unwrap_or(Duration::MAX),
            how: "",
            phases: Mutex::new(phases),
        }
    }

    /// The clock of a whole study, whose budget follows from that of its rows.
    pub fn of_study(self) -> Self {
        Observed { how: TIME_OF_STUDY, ..self }
    }

    /// The reason to stop, if there is one.
    pub fn check(&self) -> Result<(), JobError> {
        if self.inner.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        if self.is_over_budget() {
            return Err(self.over_budget());
        }
        Ok(())
    }

    /// The job error of a failed prediction: a cancelled one may have run out of time.
    pub fn judge(&self, error: ModelError) -> JobError {
        match error {
            ModelError::Solver(SolverError::Stopped) => self.stopped(),
            other => other.into(),
        }
    }

    /// The input of a job, checked while the clock runs.
    pub fn prepared<T>(
        &self,
        prepare: impl FnOnce(&StopQuery) -> Result<T, JobError>,
    ) -> Result<T, JobError> {
        prepare(&StopQuery::of(self)).map_err(|error| match error {
            JobError::Cancelled => self.stopped(),
            other => other,
        })
    }

    /// Reason of a cancellation: the caller, or the budget.
    pub fn stopped(&self) -> JobError {
        if self.inner.is_cancelled() { JobError::Cancelled } else { self.over_budget() }
    }

    /// The time of each phase so far.
    pub fn timing(&self, queue_s: Option<f64>) -> TimingDocument {
        let phases = self.lock();
        let of = |phase: Phase| {
            let ended = phases.spent.iter().filter(|(other, _)| *other == phase);
            let ended: Duration = ended.map(|(_, spent)| *spent).sum();
            let running =
                if phases.current == phase { phases.since.elapsed() } else { Duration::ZERO };
            (ended + running).as_secs_f64()
        };
        TimingDocument {
            queue_s,
            validate_s: of(Phase::Validate),
            mesh_s: of(Phase::Mesh),
            assemble_s: of(Phase::Assemble),
            solve_s: of(Phase::Solve),
            estimate_s: of(Phase::Estimate),
            contact_s: of(Phase::Contact),
            surface_s: of(Phase::Surface),
            compare_s: of(Phase::Compare),
            correction_s: of(Phase::Correct),
            write_s: of(Phase::Write),
            total_s: self.started.elapsed().as_secs_f64(),
        }
    }

    /// Since the start, in s.
    pub fn elapsed_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// The remaining budget, in s.
    pub fn left_s(&self) -> f64 {
        self.budget.saturating_sub(self.started.elapsed()).as_secs_f64()
    }

    fn is_over_budget(&self) -> bool {
        self.started.elapsed() > self.budget
    }

    fn over_budget(&self) -> JobError {
        let allowed = self.budget.as_secs_f64();
        JobError::Budget { which: "wall", allowed, unit: "s", how: self.how }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Phases> {
        // Times are whole after a panic elsewhere: each entry is pushed in one step.
        self.phases.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Progress for Observed<'_> {
    fn phase(&self, phase: Phase) {
        let mut phases = self.lock();
        let now = Instant::now();
        let ended = (phases.current, now - phases.since);
        phases.spent.push(ended);
        phases.current = phase;
        phases.since = now;
        drop(phases);
        self.inner.phase(phase);
    }

    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64) {
        self.inner.iteration(iteration, relative_residual, wanted);
    }

    fn step(&self, done: usize, of: usize) {
        self.inner.step(done, of);
    }

    fn is_cancelled(&self) -> bool {
        self.inner.is_cancelled() || self.is_over_budget()
    }
}

/// The time of day in RFC 3339, UTC, to the second.
pub fn now_rfc3339() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    format!("{}Z", date_and_time(i64::try_from(since.as_secs()).unwrap_or(i64::MAX)))
}

/// The peak memory of this process in MB, if the system reports it.
pub fn peak_rss_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024.0 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mechanics::progress::Unobserved;

    #[test]
    fn a_prediction_that_stops_without_a_request_ran_out_of_time() {
        let clock = Observed::start(&Unobserved, 0.0);
        assert!(clock.is_cancelled());
        let error = clock.judge(ModelError::Solver(SolverError::Stopped));
        assert_eq!(
            (error.kind().name(), &error.to_document().members["which"]),
            ("budget-exceeded", &"wall".into())
        );
    }

    #[test]
    fn a_study_out_of_time_tells_how_its_time_follows_from_its_budget() {
        let of_one = Observed::start(&Unobserved, 0.0).stopped().to_string();
        assert_eq!(of_one, "wall ran out: 0 s are allowed by `budget`");
        let of_study = Observed::start(&Unobserved, 0.0).of_study().stopped().to_string();
        assert!(of_study.contains("twice the `wall_s` of the study"), "{of_study}");
    }

    #[test]
    fn input_that_is_checked_beyond_the_budget_is_over_it_and_not_cancelled() {
        let clock = Observed::start(&Unobserved, 0.0);
        let stopped = |stop: &StopQuery| match stop.is_asked() {
            true => Err(JobError::Cancelled),
            false => Ok(()),
        };
        let error = clock.prepared(stopped).unwrap_err();
        assert_eq!(error.kind().name(), "budget-exceeded");
        assert!(Observed::start(&Unobserved, 60.0).prepared(stopped).is_ok());
    }

    #[test]
    fn the_phases_add_up_to_the_whole() {
        let clock = Observed::start(&Unobserved, 60.0);
        clock.phase(Phase::Mesh);
        clock.phase(Phase::Solve);
        let timing = clock.timing(None);
        let sum = timing.validate_s + timing.mesh_s + timing.solve_s;
        // The clock is read twice, some microseconds apart.
        assert!((timing.total_s - sum).abs() < 1e-3);
    }
}
