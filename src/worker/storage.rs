//! Condition of a worker's storage, asked before a job is claimed: results that cannot be stored would only cost attempts.

use std::time::{Duration, Instant};

use tokio::sync::Mutex;

use crate::store::{StorageFault, Store};

/// How long an answer counts.
const ASKED_EVERY: Duration = Duration::from_secs(1);

/// The storage of a worker process, with the last answer about it.
pub(super) struct StorageWatch {
    store: Store,
    /// The least free space of the data folder, in bytes.
    floor_bytes: u64,
    last: Mutex<Option<Answer>>,
}

struct Answer {
    at: Instant,
    is_sound: bool,
}

impl StorageWatch {
    pub fn new(store: Store, floor_bytes: u64) -> StorageWatch {
        StorageWatch { store, floor_bytes, last: Mutex::default() }
    }

    /// Whether results can be stored, by the checks that readiness has of the storage. All slots share an answer.
    pub async fn is_sound(&self) -> bool {
        let mut last = self.last.lock().await;
        if let Some(answer) = last.as_ref().filter(|answer| answer.at.elapsed() < ASKED_EVERY) {
            return answer.is_sound;
        }
        let faults = self.store.storage_faults(self.floor_bytes).await;
        log_change(last.as_ref().is_none_or(|answer| answer.is_sound), &faults);
        let is_sound = faults.is_empty();
        *last = Some(Answer { at: Instant::now(), is_sound });
        is_sound
    }

    /// Has the next claim ask anew, after something could not be stored.
    pub async fn doubt(&self) {
        self.last.lock().await.take_if(|answer| answer.is_sound);
    }
}

fn log_change(was_sound: bool, faults: &[StorageFault]) {
    match (was_sound, faults.first()) {
        (true, Some(StorageFault { check, reason })) => {
            tracing::warn!(check, %reason, "no job is claimed while the storage fails");
        }
        (false, None) => tracing::info!("the storage is back: jobs are claimed again"),
        (true, None) | (false, Some(_)) => {}
    }
}
