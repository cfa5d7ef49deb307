//! Operations on the store of blobs, each within a limit of time: a store that hangs is one that is down.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Semaphore;

use super::StoreError;

/// How long an operation may take, and each MiB of what it reads or writes besides.
pub(super) const WITHIN: Duration = Duration::from_secs(30);
const MIB_WITHIN: Duration = Duration::from_secs(1);
/// Operations on a folder at the same time: those that hang in its file system take no more threads.
const TURNS: usize = 64;

/// Where all operations on blobs pass.
#[derive(Clone)]
pub(super) struct Operations {
    /// Of a folder; a bucket takes no threads.
    turns: Option<Arc<Semaphore>>,
}

impl Operations {
    pub fn new(in_folder: bool) -> Operations {
        Operations { turns: in_folder.then(|| Arc::new(Semaphore::new(TURNS))) }
    }

    /// Does an operation; `NoAnswer` where it takes longer.
    pub async fn within<T, E>(
        &self,
        limit: Duration,
        operation: impl Future<Output = Result<T, E>> + Send + 'static,
    ) -> Result<T, StoreError>
    where
        T: Send + 'static,
        E: Into<StoreError> + Send + 'static,
    {
        let Some(turns) = self.turns.clone() else {
            return in_time(limit, async { operation.await.map_err(Into::into) }).await;
        };
        in_time(limit, async {
            let turn = turns.acquire_owned().await.map_err(|_| StoreError::Interrupted)?;
            // What hangs in a file system keeps its thread, and with it its turn, when nobody waits any more.
            let running = tokio::spawn(async move {
                let done = operation.await;
                drop(turn);
                done
            });
            running.await.map_err(|_| StoreError::Interrupted)?.map_err(Into::into)
        })
        .await
    }
}

/// The limit of an operation on so many bytes.
pub(super) fn limit_of(bytes: u64) -> Duration {
    WITHIN + MIB_WITHIN * u32::try_from(bytes >> 20).unwrap_or(u32::MAX)
}

/// Waits for something; `NoAnswer` where it takes longer.
pub(super) async fn in_time<T>(
    limit: Duration,
    operation: impl Future<Output = Result<T, StoreError>>,
) -> Result<T, StoreError> {
    let late = |_| Err(StoreError::NoAnswer { within_s: limit.as_secs_f64() });
    tokio::time::timeout(limit, operation).await.unwrap_or_else(late)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;

    const SOON: Duration = Duration::from_millis(1);

    #[tokio::test]
    async fn operations_that_hang_end_in_time_and_take_a_bounded_number_of_threads() {
        let operations = Operations::new(true);
        for _ in 0..TURNS {
            let hung = std::future::pending::<Result<(), StoreError>>();
            let error = operations.within(SOON, hung).await.unwrap_err();
            assert!(matches!(error, StoreError::NoAnswer { .. }) && error.is_unavailable());
        }
        let begun = Arc::new(AtomicBool::new(false));
        let begins = begun.clone();
        let next = async move {
            begins.store(true, Ordering::Relaxed);
            Ok::<_, StoreError>(())
        };
        let waiting = operations.within(SOON, next).await;
        assert!(matches!(waiting, Err(StoreError::NoAnswer { .. })));
        assert!(!begun.load(Ordering::Relaxed), "no thread is taken");
    }

    #[tokio::test]
    async fn a_turn_is_free_again_after_an_operation_that_was_late() {
        let operations = Operations::new(true);
        let (go, gone) = tokio::sync::watch::channel(());
        for _ in 0..TURNS {
            let mut gone = gone.clone();
            let late = async move { gone.changed().await.map_err(|_| StoreError::Interrupted) };
            assert!(operations.within(SOON, late).await.is_err());
        }
        go.send(()).unwrap();
        operations.within(WITHIN, async { Ok::<_, StoreError>(()) }).await.unwrap();
    }

    #[test]
    fn a_large_body_has_more_time() {
        assert_eq!(limit_of(1000), WITHIN);
        assert_eq!(limit_of(256 << 20), WITHIN + Duration::from_secs(256));
    }
}
