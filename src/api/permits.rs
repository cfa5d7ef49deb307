//! Permits of tenants for long computations, first in first out within a tenant and round robin between them.

use tokio::sync::oneshot;

use super::error::{ApiError, ApiResult};
use crate::fair_semaphore;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;
use crate::worker::niceness::lower_priority;

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
        let (done, made) = oneshot::channel();
        let permit = self.clone();
        let patient = move || {
            let _permit = permit.0;
            lower_priority();
            // The client has disconnected.
            let _ = done.send(work());
        };
        let thread = std::thread::Builder::new().name("parser".to_owned()).spawn(patient);
        thread.map_err(ApiError::internal)?;
        // A thread that panics drops its end.
        made.await.map_err(ApiError::internal)
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
}
