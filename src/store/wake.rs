//! Notification of changed jobs to requests that wait for one. Processes that share a database notify each other
//! (NOTIFY), so that nobody waits for the poll of each second. A notification that was lost with a connection or in a
//! proxy costs no more than that second: the next poll finds the change.

use std::sync::Arc;
use std::time::Duration;

use sqlx::postgres::{PgListener, PgPool};
use tokio::sync::broadcast::{self, error::RecvError};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use super::StoreError;

const CHANNEL: &str = "facies_jobs";
/// Between two notifications of the other processes, each of which names all jobs changed meanwhile.
const PAUSE: Duration = Duration::from_millis(10);
/// Before a lost connection is restored.
const RECOVERY: Duration = Duration::from_secs(1);
/// Jobs named in one notification: ids of 36 characters, of which PostgreSQL takes less than 8000 at a time.
const NAMED_AT_ONCE: usize = 100;
/// Changes that a waiting request may lag behind. One that lags further reads its job.
const BACKLOG: usize = 1024;
/// In place of the id of a job: some have changed, without names.
const ANY: &str = "";

/// Sender of changes of jobs.
#[derive(Clone)]
pub(super) struct Wake {
    here: broadcast::Sender<Arc<str>>,
    /// To the other processes, where there may be some.
    there: Option<UnboundedSender<Arc<str>>>,
}

/// Receiver of changes of jobs.
pub struct Changes(broadcast::Receiver<Arc<str>>);

impl Wake {
    /// Exchanges notifications with the other processes on a shared database, until its last clone is dropped.
    pub fn new(server: Option<&PgPool>) -> Wake {
        let here = broadcast::Sender::new(BACKLOG);
        let Some(pool) = server else { return Wake { here, there: None } };
        let (there, changed) = unbounded_channel();
        let others = PeerProcesses {
            pool: pool.clone(),
            // Sender of this process's notifications, so that it ignores its own.
            name: uuid::Uuid::now_v7().to_string(),
        };
        tokio::spawn(others.exchange(changed, here.clone()));
        Wake { here, there: Some(there) }
    }

    pub fn tell(&self, job: &str) {
        let job: Arc<str> = job.into();
        if let Some(there) = &self.there {
            // An error: the pool is closed.
            let _ = there.send(job.clone());
        }
        // An error: nobody waits.
        let _ = self.here.send(job);
    }

    pub fn changes(&self) -> Changes {
        Changes(self.here.subscribe())
    }
}

impl Changes {
    /// Forgets the changes so far.
    pub fn mark_seen(&mut self) {
        self.0 = self.0.resubscribe();
    }

    /// Until any job has changed.
    pub async fn of_any(&mut self) -> Result<(), StoreError> {
        match self.0.recv().await {
            Ok(_) | Err(RecvError::Lagged(_)) => Ok(()),
            Err(RecvError::Closed) => Err(StoreError::Interrupted),
        }
    }

    /// Until this job has changed, or may have.
    pub async fn of(&mut self, job: &str) -> Result<(), StoreError> {
        loop {
            match self.0.recv().await {
                Ok(told) if &*told == job || &*told == ANY => return Ok(()),
                Ok(_) => {}
                Err(RecvError::Lagged(_)) => return Ok(()),
                Err(RecvError::Closed) => return Err(StoreError::Interrupted),
            }
        }
    }
}

/// The other processes on the same database.
struct PeerProcesses {
    pool: PgPool,
    name: String,
}

impl PeerProcesses {
    async fn exchange(
        self,
        changed: UnboundedReceiver<Arc<str>>,
        here: broadcast::Sender<Arc<str>>,
    ) {
        tokio::select! {
            () = self.tell(changed) => {}
            () = self.listen(&here) => {}
        }
    }

    async fn tell(&self, mut changed: UnboundedReceiver<Arc<str>>) {
        let mut jobs = Vec::new();
        while changed.recv_many(&mut jobs, NAMED_AT_ONCE).await > 0 && !self.pool.is_closed() {
            let word = format!("{} {}", self.name, jobs.join(" "));
            let told = sqlx::query("SELECT pg_notify($1, $2)").bind(CHANNEL).bind(word);
            if let Err(error) = told.execute(&self.pool).await {
                tracing::debug!(%error, "the others were not woken");
            }
            jobs.clear();
            tokio::time::sleep(PAUSE).await;
        }
    }

    async fn listen(&self, here: &broadcast::Sender<Arc<str>>) {
        while !self.pool.is_closed() {
            if let Err(error) = self.receive(here).await {
                tracing::debug!(%error, "the others are not heard");
            }
            tokio::time::sleep(RECOVERY).await;
        }
    }

    /// Passes notifications of other processes on to the requests of this one, until the connection breaks.
    async fn receive(&self, here: &broadcast::Sender<Arc<str>>) -> Result<(), sqlx::Error> {
        let mut listener = PgListener::connect_with(&self.pool).await?;
        listener.listen(CHANNEL).await?;
        loop {
            let word = listener.recv().await?;
            for job in jobs_of(word.payload(), &self.name) {
                // An error: nobody waits.
                let _ = here.send(job.into());
            }
        }
    }
}

/// The jobs that a word of another process names; an earlier program names none.
fn jobs_of<'a>(word: &'a str, own_name: &str) -> Vec<&'a str> {
    match word.split_once(' ') {
        Some((name, _)) if name == own_name => Vec::new(),
        Some((_, jobs)) => jobs.split(' ').collect(),
        None => vec![ANY],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures::FutureExt;

    #[test]
    fn a_word_names_jobs_and_one_of_an_earlier_program_names_none() {
        assert_eq!(jobs_of("other a b", "own"), ["a", "b"]);
        assert!(jobs_of("own a b", "own").is_empty());
        assert_eq!(jobs_of("other", "own"), [ANY]);
    }

    #[tokio::test]
    async fn who_waits_for_a_job_sleeps_through_the_changes_of_others() {
        let wake = Wake { here: broadcast::Sender::new(BACKLOG), there: None };
        let mut changes = wake.changes();
        wake.tell("another");
        assert!(changes.of("own").now_or_never().is_none());
        wake.tell("own");
        changes.of("own").await.unwrap();
        for _ in 0..2 * BACKLOG {
            wake.tell("another");
        }
        changes.of("own").await.unwrap();
        changes.mark_seen();
        assert!(changes.of_any().now_or_never().is_none());
    }
}
