//! Mesh source of a slot's process, which has neither database nor credentials: it asks its worker, and keeps parsed
//! meshes.

use std::alloc::{Layout, handle_alloc_error};
use std::sync::mpsc::Receiver;
use std::sync::{Mutex, PoisonError};

use super::protocol::{Answer, Question, Report};
use super::reports::Reports;
use crate::jobs::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::library::cache::MeshCache;
use crate::library::meshes::parse_stored;
use crate::schema::case::document::LengthUnit;
use mechanics::format::{FormatError, ReadMesh};

/// An answer, with the bytes that follow it where some do.
pub type FullAnswer = (Answer, Vec<u8>);

/// Stored meshes by way of the worker.
pub struct SlotSource<'a> {
    pub reports: &'a Reports,
    /// One question at a time.
    pub answers: Mutex<Receiver<FullAnswer>>,
    pub cache: Mutex<MeshCache>,
}

impl SlotSource<'_> {
    fn ask(&self, id: &str, question: Question) -> Result<FullAnswer, SourceError> {
        let answers = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
        self.reports.tell(&Report::Ask(question));
        let unreadable = |detail: String| unreadable(id, detail);
        match answers.recv() {
            Ok((Answer::Unknown, _)) => Err(SourceError::Unknown { id: id.to_owned() }),
            Ok((Answer::Unreadable(detail), _)) => Err(unreadable(detail)),
            Ok(answer) => Ok(answer),
            Err(_) => Err(unreadable("the worker is gone".to_owned())),
        }
    }

    fn read(&self, id: &str, blob: &str) -> Result<ReadMesh, SourceError> {
        let (_, bytes) = self.ask(id, Question::Blob(blob.to_owned()))?;
        parse_stored(&bytes).map_err(|error| match error {
            // Too little memory ends a slot in the same way wherever it is noticed.
            FormatError::Memory { values } => out_of_memory(values),
            error => unreadable(id, format!("its stored bytes are damaged: {error}")),
        })
    }

    fn shape(&self, id: &str, blob: &str) -> Result<StoredShape, SourceError> {
        let cache = || self.cache.lock().unwrap_or_else(PoisonError::into_inner);
        let cached = cache().get(blob);
        if let Some(shape) = cached {
            return Ok(shape);
        }
        let parsed = self.read(id, blob)?;
        let shape = StoredMesh::new(parsed, None, String::new()).shape;
        cache().insert(blob, shape.clone());
        Ok(shape)
    }
}

fn out_of_memory(values: u64) -> SourceError {
    let layout = Layout::array::<f64>(usize::try_from(values).unwrap_or(0));
    handle_alloc_error(layout.unwrap_or_else(|_| Layout::new::<f64>()))
}

impl MeshSource for SlotSource<'_> {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        match self.ask(id, Question::Mesh(id.to_owned()))? {
            (Answer::Mesh(card), _) => {
                let shape = self.shape(id, &card.blob)?;
                Ok(card.with(shape))
            }
            _ => Err(misunderstood(id)),
        }
    }

    fn model(&self, job: &str) -> Result<Vec<u8>, SourceError> {
        match self.ask(job, Question::Model(job.to_owned()))? {
            (Answer::Skin(blob), _) => self.ask(job, Question::Blob(blob)).map(|(_, bytes)| bytes),
            _ => Err(misunderstood(job)),
        }
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        match self.ask(job, Question::Skin(job.to_owned()))? {
            (Answer::Skin(blob), _) => {
                let parsed = self.read(job, &blob)?;
                Ok(StoredMesh::new(parsed, Some(LengthUnit::Mm), blob))
            }
            _ => Err(misunderstood(job)),
        }
    }
}

fn misunderstood(id: &str) -> SourceError {
    unreadable(id, "the worker answered another question".to_owned())
}

fn unreadable(id: &str, detail: String) -> SourceError {
    SourceError::Unreadable { id: id.to_owned(), detail, may_pass: false }
}
