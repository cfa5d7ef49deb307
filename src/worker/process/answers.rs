//! Answers of a worker to the process of a slot: what it has from the store, which may be down for a while.

use std::time::{Duration, Instant};

use bytes::Bytes;
use tokio::runtime::Handle;

use super::child::Process;
use super::protocol::{Answer, Order, Question};
use crate::library::meshes::{Library, why_unreadable};
use crate::store::StoreError;
use crate::worker::work::LOOK;

/// How long an attempt waits for a store that is down before it is lost.
const PATIENCE: Duration = Duration::from_secs(15);

pub(super) struct Answers<'a> {
    /// Scoped to the tenant of the job.
    pub library: &'a Library,
    pub runtime: &'a Handle,
    pub process: &'a Process,
    /// Whether nobody waits for the job any more, or its time is up.
    pub is_over: &'a dyn Fn() -> bool,
}

impl Answers<'_> {
    pub fn answer(&self, question: Question) {
        let library = self.library;
        let skin = |blob: Option<String>| blob.map_or(Answer::Unknown, Answer::Skin);
        let answer = match question {
            Question::Mesh(id) => self
                .asked(async || library.card(&id).await)
                .map(|card| card.map_or(Answer::Unknown, Answer::Mesh)),
            Question::Skin(job) => self.asked(async || library.skin_blob(&job).await).map(skin),
            Question::Model(job) => self.asked(async || library.model_blob(&job).await).map(skin),
            Question::Blob(blob) => {
                return self.give_blob(self.asked(async || library.bytes(&blob).await));
            }
        };
        self.tell(answer.unwrap_or_else(|error| unreadable(&error)));
    }

    /// What the store says, asked again while it is down, unless the job is over.
    fn asked<T>(&self, question: impl AsyncFn() -> Result<T, StoreError>) -> Result<T, StoreError> {
        let until = Instant::now() + PATIENCE;
        let asking = async {
            loop {
                match question().await {
                    Err(error) if error.is_unavailable() && Instant::now() < until => {
                        tracing::warn!(%error, "an attempt waits for the store");
                        tokio::time::sleep(LOOK).await;
                    }
                    said => return said,
                }
            }
        };
        let over = async {
            while !(self.is_over)() {
                tokio::time::sleep(LOOK).await;
            }
        };
        self.runtime.block_on(async {
            tokio::select! {
                said = asking => said,
                () = over => Err(StoreError::Interrupted),
            }
        })
    }

    fn give_blob(&self, bytes: Result<Bytes, StoreError>) {
        match bytes {
            Ok(bytes) => {
                self.tell(Answer::Bytes);
                self.process.give(Bytes::copy_from_slice(&(bytes.len() as u64).to_le_bytes()));
                self.process.give(bytes);
            }
            Err(error) => self.tell(unreadable(&error)),
        }
    }

    fn tell(&self, answer: Answer) {
        if let Err(error) = self.process.tell(&Order::Answer(answer)) {
            tracing::error!(%error, "an answer could not be written");
        }
    }
}

fn unreadable(error: &StoreError) -> Answer {
    // Of a job that is over nobody reads the answer.
    if !matches!(error, StoreError::Interrupted) {
        tracing::error!(%error, "an input of a job could not be read");
    }
    Answer::Unreadable(why_unreadable(error).to_owned())
}
