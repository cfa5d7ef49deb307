//! Permits of tenants for long computations, first in first out within a tenant and round robin between them, and what stops these
//! computations.

use std::time::{Duration, Instant};

use tokio::sync::oneshot;

use super::error::{ApiError, ApiResult};
use crate::fair_semaphore;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;
use crate::worker::niceness::lower_priority;
use mechanics::progress::{Phase, Progress};

/// A semaphore whose permits go round robin between tenants.
#[derive(Clone)]
pub struct FairSemaphore(fair_semaphore::FairSemaphore);

/// A permit of a request, held until its last clone is dropped.
#[derive(Clone)]
pub struct Permit(fair_semaphore::Permit);

impl FairSemaphore {
    /// `what` is the use of the permits, as in the metrics; at most `most` requests of one tenant wait.
    pub fn new(what: &'static str, places: usize, most: usize) -> FairSemaphore {
        FairSemaphore(fair_semaphore::FairSemaphore::new(what, places, most))
    }

    /// The same where one tenant has all permits but one at most.
    pub fn keeping_one(what: &'static str, places: usize, most: usize) -> FairSemaphore {
        FairSemaphore(fair_semaphore::FairSemaphore::keeping_one(what, places, most))
    }

    /// Waits for a permit for a request of a tenant.
    pub async fn acquire(&self, tenant: &str) -> ApiResult<Permit> {
        self.0.acquire(tenant).await.map(Permit).map_err(|fair_semaphore::Full { most }| {
            let detail = format!("{most} requests of this tenant are waiting already");
            Problem::new(ErrorCode::Busy, detail).with("limit", most).into()
        })
    }
}

impl Permit {
    /// Runs long computations on a separate thread of lower priority than those that respond. The permit
    /// is held until the work is done, even if its client has disconnected.
    pub async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> ApiResult<T> {
        self.compute_within(Duration::MAX, |_: &RequestWatch<T>| work()).await
    }

    /// The same with a watch that asks to stop after so much time, and when the client has disconnected.
    pub async fn compute_within<T: Send + 'static>(
        &self,
        longest: Duration,
        work: impl FnOnce(&RequestWatch<T>) -> T + Send + 'static,
    ) -> ApiResult<T> {
        let (done, made) = oneshot::channel();
        let permit = self.clone();
        let patient = move || {
            let _permit = permit.0;
            lower_priority();
            let watch = RequestWatch { done, started: Instant::now(), longest };
            let found = work(&watch);
            // The client has disconnected.
            let _ = watch.done.send(found);
        };
        let thread = std::thread::Builder::new().name("parser".to_owned()).spawn(patient);
        thread.map_err(ApiError::internal)?;
        // A thread that panics drops its end.
        made.await.map_err(ApiError::internal)
    }
}

/// Asks a computation to stop when the request that waits for it ends, or after its time.
pub struct RequestWatch<T> {
    done: oneshot::Sender<T>,
    started: Instant,
    longest: Duration,
}

impl<T: Send> Progress for RequestWatch<T> {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        self.done.is_closed() || self.started.elapsed() >= self.longest
    }
}

#[cfg(test)]
mod tests {
    use futures::FutureExt as _;

    use super::*;

    #[tokio::test]
    async fn a_permit_lasts_as_long_as_its_work() {
        let semaphore = FairSemaphore::new("test", 1, 2);
        let (go, wait) = std::sync::mpsc::channel::<()>();
        let permit = semaphore.acquire("a").await.unwrap();
        let (begin, begun) = std::sync::mpsc::channel::<()>();
        let work = permit.compute(move || {
            begin.send(()).unwrap();
            wait.recv()
        });
        let left = work.boxed().now_or_never();
        assert!(left.is_none(), "it computes");
        begun.recv().unwrap();
        drop(permit);
        let mut next = semaphore.acquire("a").boxed();
        assert!((&mut next).now_or_never().is_none(), "it waits");
        go.send(()).unwrap();
        assert!(next.await.is_ok());
    }

    #[tokio::test]
    async fn work_is_asked_to_stop_when_its_client_leaves_and_then_gives_its_permit_back() {
        let semaphore = FairSemaphore::new("test", 1, 2);
        let permit = semaphore.acquire("a").await.unwrap();
        let (begin, begun) = std::sync::mpsc::channel::<bool>();
        let request = async move {
            let work = permit.compute_within(Duration::MAX, move |watch| {
                begin.send(watch.is_cancelled()).unwrap();
                while !watch.is_cancelled() {
                    std::thread::yield_now();
                }
            });
            work.await
        };
        let mut request = request.boxed();
        assert!((&mut request).now_or_never().is_none(), "it computes");
        assert!(!begun.recv().unwrap(), "nobody has left");
        drop(request);
        let next = tokio::time::timeout(Duration::from_secs(60), semaphore.acquire("a")).await;
        assert!(next.expect("it has stopped").is_ok());
    }

    #[tokio::test]
    async fn work_is_asked_to_stop_when_its_time_is_over() {
        let semaphore = FairSemaphore::new("test", 1, 2);
        let permit = semaphore.acquire("a").await.unwrap();
        for (longest, is_over) in [(Duration::ZERO, true), (Duration::from_secs(3600), false)] {
            let asked = permit.compute_within(longest, |watch| watch.is_cancelled()).await;
            assert_eq!(asked.unwrap(), is_over);
        }
    }
}
