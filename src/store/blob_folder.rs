//! Presence of the folder of blobs: one whose disk is not mounted is out of reach, and neither empty nor damaged.

use std::fs::File;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use tokio::sync::Mutex;

use super::StoreError;

/// The place that says whose blobs these are.
pub(super) const OWNER: &str = "facies-owner";

/// A folder that was made or found at the start, and is never made again.
#[derive(Clone)]
pub(super) struct BlobFolder {
    root: PathBuf,
    /// Whether it is in the data folder, and bears no mark.
    in_data: bool,
    /// The identity in its mark, once it is known.
    owner: Arc<OnceLock<String>>,
    /// One probe at a time: those that hang in a file system would take all threads.
    probe: Arc<Mutex<()>>,
}

impl BlobFolder {
    pub fn new(root: PathBuf, in_data: bool) -> BlobFolder {
        BlobFolder { root, in_data, owner: Arc::default(), probe: Arc::default() }
    }

    pub fn is_in_data(&self) -> bool {
        self.in_data
    }

    /// Its mark was read or made, and has to stay as it is.
    pub fn know_owner(&self, identity: &str) {
        self.owner.get_or_init(|| identity.to_owned());
    }

    /// Whether it is known what has to be there.
    pub fn is_known(&self) -> bool {
        self.in_data || self.owner.get().is_some()
    }

    /// Whether it is there; `NoFolder` where its mark is another or none.
    pub async fn require(&self) -> Result<(), StoreError> {
        let folder = self.clone();
        let is_there = tokio::task::spawn_blocking(move || folder.is_there()).await;
        match is_there.map_err(|_| StoreError::Interrupted)? {
            true => Ok(()),
            false => Err(self.gone()),
        }
    }

    fn is_there(&self) -> bool {
        if self.in_data {
            return self.root.is_dir();
        }
        let mark = std::fs::read_to_string(self.root.join(OWNER));
        mark.is_ok_and(|mark| self.owner.get().is_some_and(|owner| mark.trim() == owner))
    }

    /// Whether it takes a file. A file system that hangs does not answer, and who asks has to set a limit.
    pub async fn try_write(&self) -> Result<(), StoreError> {
        let alone = self.probe.clone().lock_owned().await;
        // No listing has names of this form, which files have while they are written.
        let name = format!("ready#{}", uuid::Uuid::now_v7().as_u128());
        let place = self.root.join(name);
        let written = tokio::task::spawn_blocking(move || {
            let _alone = alone;
            File::create_new(&place)?;
            std::fs::remove_file(&place)
        });
        match written.await.map_err(|_| StoreError::Interrupted)? {
            Ok(()) => Ok(()),
            Err(error) if error.kind() == ErrorKind::NotFound => Err(self.gone()),
            Err(error) => {
                let source = Box::new(error);
                Err(object_store::Error::Generic { store: "folder", source }.into())
            }
        }
    }

    fn gone(&self) -> StoreError {
        StoreError::NoFolder { folder: self.root.clone() }
    }
}
