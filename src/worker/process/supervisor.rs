//! Supervisor of a slot: hands attempts to its process, follows them, and classifies their outcome.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::Value;
use tokio::runtime::Handle;

use super::answers::Answers;
use super::child::{Death, Output, Process, Program};
use super::memory::Usage;
use super::protocol::{Assignment, Order, Outcome, Products, Question, Report, Settings};
use super::restarts::{Restarts, recycling};
use super::spent::{MemoryBound, megabytes, out_of_memory, over_time};
use crate::library::meshes::Library;
use crate::metrics;
use crate::schema::job::ErrorClass;
use crate::store::Claim;
use crate::worker::process::attempt::broke_off;
use crate::worker::work::{Failure, Finished, FinishedFile, FinishedMesh, GRACE, LOOK, Work};
use mechanics::progress::{Phase, Progress};

/// How long a process may take to begin, itself or a job that it was given: no longer than a job may go on after its budget,
/// which counts from there.
const BEGIN: Duration = GRACE;
/// How long a process without a job may take to answer. A healthy one that is killed for being late costs no job anything.
const ANSWER: Duration = Duration::from_secs(2);

/// Shared state of all slots of a worker.
pub struct SlotSettings {
    pub library: Library,
    pub runtime: Handle,
    pub program: Program,
    pub settings: Settings,
}

/// The work of one slot. Its process begins before the first job and outlives jobs.
pub struct SlotWork {
    shared: Arc<SlotSettings>,
    process: Option<Process>,
    restarts: Restarts,
}

/// An attempt under way.
struct Attempt<'a> {
    shared: &'a SlotSettings,
    /// Scoped to the tenant of the job.
    library: Library,
    /// The input of the job.
    document: &'a str,
    process: &'a Process,
    progress: &'a dyn Progress,
    /// When the process was given the job; none once it has begun it.
    given: Option<Instant>,
    /// When it was cancelled.
    stopped: Option<Instant>,
    /// When it should have stopped by itself, and after how many seconds that is.
    budget: Option<(Instant, f64)>,
    memory: Option<MemoryBound>,
    usage: Option<Usage>,
}

/// How an attempt came to its end.
enum End {
    Outcome(Outcome),
    /// The process ended.
    Died,
    /// The process gave no sign of having begun.
    Silent,
    /// It did not stop when it was told to.
    Deaf,
    /// Its time was up, and it did not notice, with the error that says so.
    OverTime(Value),
    /// It took more memory than its budget, with the error that says so.
    OverMemory(Value),
}

impl SlotWork {
    pub fn new(shared: Arc<SlotSettings>) -> Self {
        SlotWork { shared, process: None, restarts: Restarts::default() }
    }

    fn start(&self) -> Result<Process, String> {
        let started = Process::start(&self.shared.program, &self.shared.settings);
        let process = started.map_err(|error| error.to_string())?;
        match process.receive(BEGIN) {
            Output::Report(Report::Ready) => Ok(process),
            // It is killed when it is dropped.
            Output::Nothing => Err(format!("it was not ready after {} s", BEGIN.as_secs())),
            Output::Report(_) | Output::Gone => Err(process.end().to_string()),
        }
    }

    /// Ends a process that has died or stands still without a job: given to it, a job would lose an attempt.
    fn end_unresponsive(&mut self) {
        let Some(process) = self.process.take() else { return };
        let why = match process.ping(ANSWER) {
            Output::Report(Report::Ready) => {
                self.process = Some(process);
                return;
            }
            Output::Gone => process.end().name(),
            // It is killed when it is dropped.
            Output::Nothing | Output::Report(_) => "silent",
        };
        tracing::warn!(why, "the process of a slot died or stood still without a job");
        self.died(why);
    }

    /// Delays the next start, longer after each crash in a row.
    fn died(&mut self, why: &str) {
        metrics::slot_ended(why);
        self.process = None;
        self.restarts.died();
    }

    /// A process that was killed for its job has not crashed.
    fn killed(&mut self, why: &str) {
        metrics::slot_ended(why);
        self.process = None;
        self.restarts.job_ended();
    }

    /// Outcome of an attempt for the job and for the process.
    fn judge(
        &mut self,
        end: End,
        usage: Option<Usage>,
        folder: &Path,
    ) -> Result<Finished, Failure> {
        match end {
            End::Outcome(outcome) => {
                self.restarts.job_ended();
                self.keep_or_recycle(&outcome, usage);
                finished(outcome, folder)
            }
            End::Died => {
                let process = self.process.take();
                let death = process.map_or(Death::Unknown, Process::end);
                tracing::error!(%death, "the process of a slot died");
                self.died(death.name());
                Err(self.failure(&death, usage))
            }
            End::Silent => {
                tracing::warn!("the process of a slot did not begin its job; it is killed");
                self.killed("silent");
                let waited_s = BEGIN.as_secs();
                let how = format!("the process of the job did not begin it within {waited_s} s");
                Err(Failure::Lost(how))
            }
            End::Deaf => {
                tracing::warn!("a job did not stop in time; its process is killed");
                // A factorisation cannot be interrupted: this does not count as a crash.
                self.killed("deaf");
                Err(Failure::Cancelled)
            }
            End::OverTime(error) => {
                tracing::warn!("a job did not notice the end of its time; its process is killed");
                self.killed("over-time");
                Err(Failure::Permanent(error))
            }
            End::OverMemory(error) => {
                tracing::warn!("a job took more memory than its budget; its process is killed");
                self.killed("over-memory");
                Err(Failure::Permanent(error))
            }
        }
    }

    /// Too little memory is the job's own fault; any other death is a loss, which may not come again.
    fn failure(&self, death: &Death, usage: Option<Usage>) -> Failure {
        match death {
            Death::OutOfMemory { asked_bytes } => {
                let limit = self.shared.settings.memory_bytes;
                Failure::Permanent(out_of_memory(*asked_bytes, limit, usage))
            }
            other => {
                let taken = usage.map(|usage| megabytes(usage.now_bytes));
                let taken =
                    taken.map(|mb| format!(", having taken {mb:.0} MB")).unwrap_or_default();
                Failure::Lost(format!("the process of the job died: {other}{taken}"))
            }
        }
    }

    fn keep_or_recycle(&mut self, outcome: &Outcome, usage: Option<Usage>) {
        let Some(process) = &mut self.process else { return };
        process.jobs += 1;
        let panicked = matches!(outcome, Outcome::Panicked(_));
        let limit = self.shared.settings.memory_bytes;
        let why = recycling(panicked, process.jobs, usage.map(|usage| usage.now_bytes), limit);
        if let Some(why) = why {
            tracing::info!(why, jobs = process.jobs, "a slot gets a fresh process");
            metrics::slot_ended(why);
            self.process = None;
        }
    }
}

impl Work for SlotWork {
    fn prepare(&mut self) -> Result<(), Duration> {
        self.end_unresponsive();
        if let Some(wait) = self.restarts.wait() {
            return Err(wait);
        }
        if self.process.is_none() {
            match self.start() {
                Ok(process) => self.process = Some(process),
                Err(reason) => {
                    tracing::error!(%reason, "the process of a slot did not start");
                    self.died("start");
                    return Err(LOOK);
                }
            }
        }
        Ok(())
    }

    fn work(
        &mut self,
        claim: &Claim,
        folder: &Path,
        progress: &dyn Progress,
    ) -> Result<Finished, Failure> {
        let Some(process) = &self.process else {
            return Err(Failure::Lost("there was no process for the job".to_owned()));
        };
        let lease = &claim.lease;
        let assignment = Assignment {
            job: lease.job.clone(),
            attempt: lease.attempt,
            queue_s: (claim.started - claim.created) as f64 / 1e3,
            document: claim.document.clone(),
            folder: std::path::absolute(folder)?,
        };
        process.set_log_owner(Some((&lease.job, lease.attempt)));
        process.tell(&Order::Work(assignment))?;
        let mut attempt = Attempt {
            shared: &self.shared,
            library: self.shared.library.of_tenant(&claim.tenant),
            document: &claim.document,
            process,
            progress,
            given: Some(Instant::now()),
            stopped: None,
            budget: None,
            memory: MemoryBound::of(&claim.document, process.usage()),
            usage: None,
        };
        let end = attempt.follow();
        let usage = attempt.usage;
        let until = attempt.budget.map(|(until, _)| until);
        let ended = self.judge(end, usage, folder).map(|made| Finished { until, ..made });
        if let Some(process) = &self.process {
            process.set_log_owner(None);
        }
        if let Some(usage) = usage {
            metrics::job_memory(usage.peak_bytes);
        }
        ended
    }
}

impl Attempt<'_> {
    /// Passes on what the process tells until it is done, or has to be done with.
    fn follow(&mut self) -> End {
        loop {
            match self.process.receive(LOOK) {
                Output::Report(Report::Ended(ended)) => {
                    self.usage = ended.memory.or(self.usage);
                    return End::Outcome(ended.outcome);
                }
                Output::Report(report) => self.pass_on(report),
                Output::Nothing => self.usage = self.process.usage().or(self.usage),
                Output::Gone => return End::Died,
            }
            if let Some(end) = self.enforce_deadlines() {
                return end;
            }
        }
    }

    fn pass_on(&mut self, report: Report) {
        match report {
            Report::Phase(name) => {
                if let Some(phase) = Phase::from_name(&name) {
                    self.progress.phase(phase);
                }
            }
            Report::Iteration { iteration, residual, wanted } => {
                self.progress.iteration(iteration, residual.unwrap_or(f64::NAN), wanted);
            }
            Report::Step { done, of } => self.progress.step(done, of),
            Report::Budget { wall_s } => {
                self.given = None;
                let wall = Duration::try_from_secs_f64(wall_s).ok();
                let until = wall.and_then(|wall| Instant::now().checked_add(wall + GRACE));
                self.budget = until.map(|until| (until, wall_s));
            }
            Report::Ask(question) => self.answer(question),
            Report::Ready | Report::Ended(_) => {}
        }
    }

    /// Tells the process to stop when its job was cancelled; says when to kill it.
    fn enforce_deadlines(&mut self) -> Option<End> {
        let now = Instant::now();
        if self.stopped.is_none() && self.progress.is_cancelled() {
            self.stopped = Some(now);
            // One that cannot be told is killed after the same wait.
            let _ = self.process.tell(&Order::Stop);
        }
        if self.stopped.is_some_and(|stopped| now.duration_since(stopped) > GRACE) {
            return Some(End::Deaf);
        }
        if self.given.is_some_and(|given| now.duration_since(given) > BEGIN) {
            return Some(End::Silent);
        }
        if let Some(error) = self.over_memory() {
            return Some(End::OverMemory(error));
        }
        let (until, wall_s) = self.budget?;
        (now > until).then(|| End::OverTime(over_time(self.document, wall_s)))
    }

    fn answer(&self, question: Question) {
        let (library, runtime) = (&self.library, &self.shared.runtime);
        let over = self.budget.map(|(until, _)| until);
        let is_over =
            || self.progress.is_cancelled() || over.is_some_and(|until| Instant::now() > until);
        Answers { library, runtime, process: self.process, is_over: &is_over }.answer(question);
    }

    /// Asks now and then what the process takes.
    fn over_memory(&mut self) -> Option<Value> {
        let bound = self.memory.as_mut().filter(|_| self.stopped.is_none())?;
        if !bound.is_time(LOOK) {
            return None;
        }
        let usage = self.process.usage()?;
        self.usage = Some(usage);
        bound.broken(usage)
    }
}

fn finished(outcome: Outcome, folder: &Path) -> Result<Finished, Failure> {
    match outcome {
        Outcome::Done(Products { result, files, meshes, effort }) => Ok(Finished {
            result,
            files: files
                .into_iter()
                .map(|file| FinishedFile {
                    path: folder.join(&file.name),
                    name: file.name,
                    media_type: file.media_type,
                })
                .collect(),
            meshes: meshes
                .into_iter()
                .map(|mesh| FinishedMesh { path: folder.join(&mesh.file), mesh })
                .collect(),
            effort,
            until: None,
        }),
        Outcome::Failed(error) => Err(Failure::Permanent(error)),
        Outcome::Cancelled => Err(Failure::Cancelled),
        Outcome::Storage { error, reason } => Err(Failure::Storage { error, reason }),
        Outcome::Panicked(reason) => {
            tracing::error!(%reason, "a job panicked");
            // The same job would meet the same bug: it is the job's own, until somebody shows otherwise.
            Err(Failure::Permanent(broke_off(ErrorClass::Numerical)))
        }
    }
}
