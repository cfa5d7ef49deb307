//! Turns of tenants at what takes a processor for long.

use tokio::sync::oneshot;

use super::error::{ApiError, ApiResult};
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;
use crate::turns;
use crate::worker::niceness::give_way;

/// Places of one kind, and the queue for them.
#[derive(Clone)]
pub struct Turns(turns::Turns);

/// The turn of a request, until its last clone is dropped.
#[derive(Clone)]
pub struct Turn(turns::Turn);

impl Turns {
    /// `what` is what the places are for, in the words of the metrics; `most` requests of one tenant wait.
    pub fn new(what: &'static str, places: usize, most: usize) -> Turns {
        Turns(turns::Turns::new(what, places, most))
    }

    /// Waits for the turn of a request of a tenant.
    pub async fn turn(&self, tenant: &str) -> ApiResult<Turn> {
        self.0.turn(tenant).await.map(Turn).map_err(|turns::Full { most }| {
            let detail = format!("{most} requests of this tenant wait for their turn already");
            Problem::new(ErrorCode::Busy, detail).with("limit", most).into()
        })
    }
}

impl Turn {
    /// Runs work that takes a processor for long on a thread of its own, which gives way to those that answer. The turn
    /// lasts until the work is done, also where its client has gone.
    pub async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> ApiResult<T> {
        let (done, made) = oneshot::channel();
        let turn = self.clone();
        let patient = move || {
            let _turn = turn.0;
            give_way();
            // Nobody waits any more where the client has gone.
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
    async fn a_turn_lasts_as_long_as_its_work() {
        let turns = Turns::new("test", 1, 2);
        let (go, wait) = std::sync::mpsc::channel::<()>();
        let turn = turns.turn("a").await.unwrap();
        let (begin, begun) = std::sync::mpsc::channel::<()>();
        let work = turn.compute(move || {
            begin.send(()).unwrap();
            wait.recv()
        });
        let left = work.boxed().now_or_never();
        assert!(left.is_none(), "it computes");
        begun.recv().unwrap();
        drop(turn);
        let mut next = turns.turn("a").boxed();
        assert!((&mut next).now_or_never().is_none(), "it waits");
        go.send(()).unwrap();
        assert!(next.await.is_ok());
    }
}
