//! Heartbeat: one thread renews the leases of this process, over connections and an async runtime of its own, so that
//! neither a solver nor a busy server delays it.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::config::Config;
use crate::metrics;
use crate::schema::ErrorCode;
use crate::store::{Lease, Point, Store, StoreError};
use crate::traces;
use mechanics::progress::{Phase, Progress};

/// How long a dismissed job may run on before its solver is cancelled.
const LOOK: Duration = Duration::from_millis(500);

/// A running job of this process: the progress of its solver, and its cancellation.
pub struct RunningJob {
    pub lease: Lease,
    pub trace: traces::Attempt,
    stopped: AtomicBool,
    point: Mutex<Point>,
    renewed: Mutex<(Instant, Point)>,
}

impl RunningJob {
    fn new(lease: Lease, trace: traces::Attempt) -> Self {
        RunningJob {
            lease,
            trace,
            stopped: AtomicBool::new(false),
            point: Mutex::default(),
            renewed: Mutex::new((Instant::now(), Point::default())),
        }
    }

    /// Tells the solver to end at its next check.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    fn advance(&self, change: impl FnOnce(&mut Point)) {
        let mut point = lock(&self.point);
        let before = point.progress;
        change(&mut point);
        point.progress = point.progress.max(before);
    }
}

/// A poisoned lock holds a whole value all the same: each is written in one assignment.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Where a phase begins, in percent. Solving fills the space between its own and the next.
fn percent(phase: Phase) -> i64 {
    match phase {
        Phase::Validate => 1,
        Phase::Mesh => 5,
        Phase::Assemble => 10,
        Phase::Solve => SOLVE_BEGINS,
        Phase::Estimate | Phase::Contact => SOLVE_ENDS,
        Phase::Surface => 92,
        Phase::Compare => 94,
        Phase::Correct => 96,
        Phase::Write => 97,
    }
}
const SOLVE_BEGINS: i64 = 20;
const SOLVE_ENDS: i64 = 90;

impl Progress for RunningJob {
    fn phase(&self, phase: Phase) {
        self.trace.phase(phase.name());
        self.advance(|point| {
            point.phase = Some(phase.name());
            point.progress = percent(phase);
        });
    }

    fn iteration(&self, iteration: usize, relative_residual: f64, wanted: f64) {
        // Conjugate gradients gain about the same number of digits in each iteration.
        let digits = (relative_residual.ln() / wanted.ln()).clamp(0.0, 1.0);
        let solved = if digits.is_nan() { 0.0 } else { digits };
        self.advance(|point| {
            point.iteration = i64::try_from(iteration).ok();
            point.residual = relative_residual.is_finite().then_some(relative_residual);
            point.progress = SOLVE_BEGINS + ((SOLVE_ENDS - SOLVE_BEGINS) as f64 * solved) as i64;
        });
    }

    fn step(&self, done: usize, of: usize) {
        let share = done as f64 / of.max(1) as f64;
        self.advance(|point| {
            point.iteration = i64::try_from(done).ok();
            point.progress = SOLVE_BEGINS + ((SOLVE_ENDS - SOLVE_BEGINS) as f64 * share) as i64;
        });
    }

    fn is_cancelled(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

/// The jobs of this process by their lease.
type RunningJobs = Arc<Mutex<HashMap<Lease, Arc<RunningJob>>>>;

/// The thread that keeps leases alive, and takes jobs from workers that gave no sign of life.
pub struct Heartbeat {
    held: RunningJobs,
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Heartbeat {
    pub fn start(store: Store, config: &Config) -> Result<Heartbeat, StoreError> {
        let held = RunningJobs::default();
        let pulse = Pulse {
            held: held.clone(),
            lease: config.lease,
            interval: config.heartbeat,
            attempts: config.attempts,
            lost: worker_lost(config.attempts, None),
        };
        let (stop, stopped) = channel();
        let (connected, connection) = channel();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let thread = std::thread::Builder::new().name("heartbeat".into()).spawn(move || {
            let store = match runtime.block_on(store.again()) {
                Ok(store) => store,
                Err(error) => {
                    // An error: the process is about to end.
                    let _ = connected.send(Err(error));
                    return;
                }
            };
            let _ = connected.send(Ok(()));
            let look = LOOK.min(pulse.interval);
            let mut reaped = None;
            while stopped.recv_timeout(look) == Err(RecvTimeoutError::Timeout) {
                runtime.block_on(pulse.renew_all(&store, &mut reaped));
            }
            runtime.block_on(store.close());
        })?;
        connection.recv().map_err(|_| StoreError::Interrupted)??;
        Ok(Heartbeat { held, stop: Some(stop), thread: Some(thread) })
    }

    /// Keeps a lease alive until `unregister`.
    pub fn hold(&self, lease: Lease, trace: traces::Attempt) -> Arc<RunningJob> {
        let job = Arc::new(RunningJob::new(lease.clone(), trace));
        lock(&self.held).insert(lease, job.clone());
        job
    }

    pub fn unregister(&self, lease: &Lease) {
        lock(&self.held).remove(lease);
    }

    pub fn held(&self) -> Vec<Arc<RunningJob>> {
        lock(&self.held).values().cloned().collect()
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        self.stop.take();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been reported where it happened.
            let _ = thread.join();
        }
    }
}

/// The error of a job that lost its worker too often; `how` tells the last time, where it is known.
pub(super) fn worker_lost(attempts: u32, how: Option<&str>) -> String {
    let last = how.map(|how| format!("; at last, {how}")).unwrap_or_default();
    serde_json::json!({
        "type": ErrorCode::WorkerLost,
        "class": "infrastructure",
        "detail": format!("the job lost its worker {attempts} times{last}"),
        "attempts": attempts,
    })
    .to_string()
}

struct Pulse {
    held: RunningJobs,
    lease: Duration,
    interval: Duration,
    attempts: u32,
    lost: String,
}

impl Pulse {
    async fn renew_all(&self, store: &Store, reaped: &mut Option<Instant>) {
        let jobs: Vec<_> = lock(&self.held).values().cloned().collect();
        for job in jobs {
            match self.renew_or_report(store, &job).await {
                Ok(true) => {}
                Ok(false) => job.stop(),
                Err(error) => {
                    tracing::warn!(job.id = %job.lease.job, %error, "a sign of life got lost");
                }
            }
        }
        if reaped.is_none_or(|last| last.elapsed() >= self.interval) {
            *reaped = Some(Instant::now());
            self.reap(store).await;
            metrics::release_memory();
        }
    }

    /// Renews the lease when it is time or when there is something to tell; false when the job is not ours.
    async fn renew_or_report(&self, store: &Store, job: &RunningJob) -> Result<bool, StoreError> {
        let point = lock(&job.point).clone();
        let (last, told) = lock(&job.renewed).clone();
        let moved = point.phase != told.phase || point.progress != told.progress;
        if !moved && last.elapsed() < self.interval {
            return store.holds(&job.lease).await;
        }
        let ours = store.renew(&job.lease, self.lease, &point).await?;
        *lock(&job.renewed) = (Instant::now(), point);
        Ok(ours)
    }

    async fn reap(&self, store: &Store) {
        match store.reap(self.attempts, &self.lost).await {
            Ok(jobs) => {
                for job in jobs {
                    metrics::attempt_lost("silent");
                    tracing::warn!(
                        job.id = %job.job,
                        attempt = job.attempt,
                        accepted_again = job.accepted_again,
                        "a worker gave no sign of life"
                    );
                }
            }
            Err(error) => tracing::warn!(%error, "lost jobs were not looked for"),
        }
    }
}
