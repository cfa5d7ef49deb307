//! Main loop of the process of a slot: takes jobs from its worker, one after the other, and keeps parsed meshes.

use std::io::{self, BufReader};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::memory;
use super::protocol::{
    Answer, Assignment, AttemptReport, Order, Outcome, Report, Settings, read_frame, read_message,
};
use super::reports::Reports;
use super::source::{FullAnswer, SlotSource};
use crate::library::cache::MeshCache;
use crate::worker::fail_point::FailPoints;
use crate::worker::niceness::lower_priority;
use crate::worker::process::attempt::attempt;
use mechanics::progress::{Phase, Progress};

/// Between two reports of iterations: a worker looks at them no more often.
const BETWEEN_REPORTS: Duration = Duration::from_millis(50);

#[derive(Debug, thiserror::Error)]
pub enum SlotError {
    #[error("a slot is started by `facies serve` and takes its orders from it")]
    NoOrders,
    #[error("the slot could not be set up: {0}")]
    Setup(#[from] io::Error),
    #[error("the slot has no threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Serves until standard input is closed.
pub fn serve() -> Result<(), SlotError> {
    end_with_parent();
    lower_priority();
    FailPoints::of(0, "").pass_by("slot:start", &|| false);
    let mut orders = BufReader::new(io::stdin());
    let first = read_message(&mut orders).map_err(|_| SlotError::NoOrders)?;
    let Some(Order::Start(settings)) = first else { return Err(SlotError::NoOrders) };
    memory::bound(settings.memory_bytes)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .thread_name(|thread| format!("solver-{thread}"))
        .build()?;
    let (ears, heard) = listen(orders)?;
    let reports = Reports::to(io::stdout());
    let source = SlotSource {
        reports: &reports,
        answers: Mutex::new(heard.answers),
        cache: Mutex::new(MeshCache::new(settings.cache_bytes)),
    };
    reports.tell(&Report::Ready);
    for order in heard.work {
        let Order::Work(assignment) = order else {
            reports.tell(&Report::Ready);
            continue;
        };
        let progress = ProgressReporter::new(&reports, &ears, &assignment);
        let outcome = pool.install(|| outcome(&assignment, &source, &settings, &progress));
        let memory = memory::usage("self");
        reports.tell(&Report::Ended(Box::new(AttemptReport { outcome, memory })));
    }
    Ok(())
}

/// Asks the system to end this process with its worker, even if it no longer reads.
fn end_with_parent() {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{Signal, set_parent_process_death_signal};
        if let Err(error) = set_parent_process_death_signal(Some(Signal::KILL)) {
            tracing::warn!(%error, "only a closed pipe will tell that the worker is gone");
        }
    }
}

fn outcome(
    assignment: &Assignment,
    source: &SlotSource,
    settings: &Settings,
    progress: &ProgressReporter,
) -> Outcome {
    let work = || attempt(assignment, source, &settings.limits, progress);
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied());
        Outcome::Panicked(words.unwrap_or("unknown").to_owned())
    })
}

/// Incoming messages, by kind.
struct Inbox {
    /// Assignments and pings.
    work: Receiver<Order>,
    answers: Receiver<FullAnswer>,
}

/// The flag that tells the work to stop.
type StopFlag = Arc<AtomicBool>;

/// Reads orders on a thread of its own, so that a solver can be told to stop, and a closed pipe ends the process.
fn listen(mut orders: BufReader<io::Stdin>) -> Result<(StopFlag, Inbox), SlotError> {
    let (give, work) = channel();
    let (answer, answers) = channel();
    let stop = StopFlag::default();
    let ears = stop.clone();
    std::thread::Builder::new().name("orders".into()).spawn(move || {
        while let Ok(Some(order)) = read_message(&mut orders) {
            if take(order, &mut orders, &stop, &give, &answer).is_none() {
                break;
            }
        }
        // The worker is gone or breaks the protocol: no result can be delivered.
        std::process::exit(0);
    })?;
    Ok((ears, Inbox { work, answers }))
}

fn take(
    order: Order,
    orders: &mut BufReader<io::Stdin>,
    stop: &AtomicBool,
    give: &Sender<Order>,
    answer: &Sender<FullAnswer>,
) -> Option<()> {
    match order {
        Order::Start(_) => None,
        Order::Stop => {
            stop.store(true, Ordering::Relaxed);
            Some(())
        }
        Order::Work(_) => {
            stop.store(false, Ordering::Relaxed);
            give.send(order).ok()
        }
        Order::Ping => give.send(order).ok(),
        Order::Answer(Answer::Bytes) => {
            let bytes = read_frame(orders).ok()??;
            answer.send((Answer::Bytes, bytes)).ok()
        }
        Order::Answer(other) => answer.send((other, Vec::new())).ok(),
    }
}

/// Progress of one attempt, told to the worker.
struct ProgressReporter<'a> {
    reports: &'a Reports,
    stop: &'a AtomicBool,
    fail_points: FailPoints,
    last: Mutex<Option<Instant>>,
}

impl<'a> ProgressReporter<'a> {
    fn new(reports: &'a Reports, stop: &'a AtomicBool, assignment: &Assignment) -> Self {
        ProgressReporter {
            reports,
            stop,
            fail_points: FailPoints::of(assignment.attempt, &assignment.document),
            last: Mutex::new(None),
        }
    }

    /// Whether it is time for another report of the same kind.
    fn is_time(&self) -> bool {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let is_time = last.is_none_or(|last| last.elapsed() >= BETWEEN_REPORTS);
        if is_time {
            *last = Some(Instant::now());
        }
        is_time
    }

    fn pass(&self, point: &str) {
        self.fail_points.pass_by(point, &|| self.stop.load(Ordering::Relaxed));
    }
}

impl Progress for ProgressReporter<'_> {
    fn phase(&self, phase: Phase) {
        self.reports.tell(&Report::Phase(phase.name().to_owned()));
        self.pass(&format!("{}:begin", phase.name()));
    }

    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64) {
        if self.is_time() {
            let residual = relative_residual.is_finite().then_some(relative_residual);
            self.reports.tell(&Report::Iteration { iteration, residual, wanted });
        }
        self.pass("solve:iteration");
    }

    fn step(&self, done: usize, of: usize) {
        if self.is_time() {
            self.reports.tell(&Report::Step { done, of });
        }
    }

    fn allowed(&self, wall_s: f64) {
        self.reports.tell(&Report::Budget { wall_s });
    }

    fn is_cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
