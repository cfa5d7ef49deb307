//! Processes that share a database tell each other that a job has changed (NOTIFY), so that nobody who waits
//! for one sleeps to the end of his second. It only wakes: who missed a word, because a connection broke or a
//! proxy swallowed it, finds the change when he looks the next time.

use std::time::Duration;

use sqlx::postgres::{PgListener, PgPool};
use tokio::sync::watch;

use super::Store;
use super::database::Pool;

const CHANNEL: &str = "facies_jobs";
/// Between two words to the others: a hundred jobs that move at the same time are one.
const PAUSE: Duration = Duration::from_millis(10);
/// Before a lost connection is made again.
const RECOVERY: Duration = Duration::from_secs(1);

impl Store {
    /// Starts to tell and to listen, where there may be others. It ends with the last of this store.
    pub(super) fn listen_to_others(&self) {
        if let Pool::Postgres(pool) = self.database.writer() {
            // What this process signs its words with, so that it does not wake itself.
            let name = uuid::Uuid::now_v7().to_string();
            tokio::spawn(tell(pool.clone(), self.own_changes.subscribe(), name.clone()));
            let here = self.own_changes.subscribe();
            tokio::spawn(listen(pool.clone(), self.changes.clone(), here, name));
        }
    }
}

async fn tell(pool: PgPool, mut own_changes: watch::Receiver<u64>, name: String) {
    while own_changes.changed().await.is_ok() && !pool.is_closed() {
        let told = sqlx::query("SELECT pg_notify($1, $2)").bind(CHANNEL).bind(&name);
        if let Err(error) = told.execute(&pool).await {
            tracing::debug!(%error, "the others were not woken");
        }
        tokio::time::sleep(PAUSE).await;
    }
}

async fn listen(
    pool: PgPool,
    changes: watch::Sender<u64>,
    mut here: watch::Receiver<u64>,
    name: String,
) {
    while !pool.is_closed() {
        tokio::select! {
            // Only the end of the store is waited for; its changes are told elsewhere.
            () = async { while here.changed().await.is_ok() {} } => return,
            heard = hear(&pool, &changes, &name) => {
                if let Err(error) = heard {
                    tracing::debug!(%error, "the others are not heard");
                }
                tokio::time::sleep(RECOVERY).await;
            }
        }
    }
}

/// Wakes those who wait here whenever another process says so, until the connection breaks.
async fn hear(pool: &PgPool, changes: &watch::Sender<u64>, name: &str) -> Result<(), sqlx::Error> {
    let mut listener = PgListener::connect_with(pool).await?;
    listener.listen(CHANNEL).await?;
    loop {
        let word = listener.recv().await?;
        if word.payload() != name {
            changes.send_modify(|count| *count = count.wrapping_add(1));
        }
    }
}
