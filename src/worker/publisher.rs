//! Publisher of an attempt: on a thread of its own, so that a store that does not answer holds no slot.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use tokio::runtime::Handle;

use super::fail_point::FailPoints;
use super::heartbeat::RunningJob;
use super::publication::Publication;
use super::work::{Failure, GRACE, LOOK};
use crate::store::Store;
use mechanics::progress::Progress;

/// Between the first two tries to publish while the store is down; twice as long after each further one, up to the longest.
const PAUSE: Duration = Duration::from_millis(200);
const LONGEST_PAUSE: Duration = Duration::from_secs(2);

pub struct Publisher {
    /// Scoped to the tenant of the job.
    pub store: Store,
    pub runtime: Handle,
    pub job: Arc<RunningJob>,
    pub fail_points: FailPoints,
    /// How long a store that is down is waited for.
    pub patience: Duration,
}

impl Publisher {
    /// Makes files, meshes and the manifest visible at once; false when the job is not ours. A publication that goes on for too long
    /// after `until`, or after its job was cancelled, is left to itself: by then its lease is that of nobody.
    pub fn publish(
        self,
        publication: Publication,
        until: Option<Instant>,
    ) -> Result<bool, Failure> {
        let job = self.job.clone();
        let least = Instant::now() + GRACE + Duration::from_secs(publication.bytes() >> 20);
        let until = until.map(|until| until.max(least));
        let (told, outcome) = channel();
        let span = tracing::Span::current();
        std::thread::Builder::new().name("publisher".into()).spawn(move || {
            let _inside = span.enter();
            // Nobody may be there to be told.
            let _ = told.send(self.run(&publication));
        })?;
        wait(&outcome, until, &|| job.is_cancelled())
    }

    fn run(&self, publication: &Publication) -> Result<bool, Failure> {
        self.fail_points.pass("publish:before", &|| self.job.is_cancelled())?;
        let published = self.store_all(publication);
        self.fail_points.pass("publish:after", &|| self.job.is_cancelled())?;
        published
    }

    fn store_all(&self, publication: &Publication) -> Result<bool, Failure> {
        let until = Instant::now() + self.patience;
        let mut pause = PAUSE;
        loop {
            let published = publication.publish(&self.store, &self.job.lease);
            match self.runtime.block_on(published) {
                Err(error) if error.is_unavailable() && Instant::now() < until => {
                    tracing::warn!(%error, "the result waits for the store");
                    std::thread::sleep(pause);
                    pause = LONGEST_PAUSE.min(2 * pause);
                }
                published => return Ok(published?),
            }
        }
    }
}

fn wait(
    outcome: &Receiver<Result<bool, Failure>>,
    until: Option<Instant>,
    is_cancelled: &dyn Fn() -> bool,
) -> Result<bool, Failure> {
    let mut until = until;
    let mut is_told = false;
    loop {
        match outcome.recv_timeout(LOOK) {
            Ok(outcome) => return outcome,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::Lost("the publication of the result broke off".to_owned()));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let now = Instant::now();
        if !is_told && is_cancelled() {
            is_told = true;
            until = Some(until.map_or(now + GRACE, |until| until.min(now + GRACE)));
        }
        if until.is_some_and(|until| now > until) {
            return Err(Failure::of_results("the store did not take the result in time"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_publication_is_waited_for_until_its_time_is_up() {
        let (told, outcome) = channel();
        let past = Some(Instant::now());
        assert!(matches!(wait(&outcome, past, &|| false), Err(Failure::Storage { .. })));
        told.send(Ok(true)).unwrap();
        assert!(matches!(wait(&outcome, past, &|| true), Ok(true)));
        drop(told);
        assert!(matches!(wait(&outcome, None, &|| false), Err(Failure::Lost(_))));
    }
}
