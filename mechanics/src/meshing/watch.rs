//! Progress and cancellation of the stages of meshing.

use rayon::prelude::*;

use super::error::MeshingError;
use crate::progress::Progress;

/// Things that are worked on between two questions whether to stop.
const BLOCK: usize = 1 << 14;
/// Things that a thread takes at a time.
const GRAIN: usize = 64;

/// Follows one meshing through its stages.
pub(super) struct Watch<'a> {
    progress: &'a dyn Progress,
    done: usize,
    stages: usize,
}

impl<'a> Watch<'a> {
    pub fn new(progress: &'a dyn Progress, stages: usize) -> Self {
        Watch { progress, done: 0, stages }
    }

    /// The next stage begins.
    pub fn stage(&mut self) -> Result<(), MeshingError> {
        self.progress.step(self.done, self.stages);
        self.done += 1;
        self.check_cancelled()
    }

    /// All of it is done.
    pub fn end(&self) {
        self.progress.step(self.stages, self.stages);
    }

    pub fn check_cancelled(&self) -> Result<(), MeshingError> {
        if self.progress.is_cancelled() { Err(MeshingError::Cancelled) } else { Ok(()) }
    }

    /// Does the same with each thing, on all threads and in the order of the things.
    pub fn map<T: Sync, R: Send>(
        &self,
        things: &[T],
        work: impl Fn(&T) -> R + Sync,
    ) -> Result<Vec<R>, MeshingError> {
        let mut results = Vec::with_capacity(things.len());
        for block in things.chunks(BLOCK) {
            self.check_cancelled()?;
            results.par_extend(block.par_iter().with_min_len(GRAIN).map(&work));
        }
        Ok(results)
    }

    /// The lists that chunks of things give, one after the other in the order of the things.
    pub fn gather<T: Sync, R: Send + Sync + Copy>(
        &self,
        things: &[T],
        work: impl Fn(&[T], &mut Vec<R>) + Sync,
    ) -> Result<Vec<R>, MeshingError> {
        self.check_cancelled()?;
        let chunks: Vec<Vec<R>> = things
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut list = Vec::new();
                work(chunk, &mut list);
                list
            })
            .collect();
        self.check_cancelled()?;
        Ok(chunks.concat())
    }
}

/// Things whose results stand in one list while they are gathered.
const CHUNK: usize = 1 << 10;
