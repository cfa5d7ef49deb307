//! The folder for a result: one command at a time writes into it, and replaces no file that no command wrote.

use std::fs::{File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::failure::CommandError;
use crate::jobs::result::folder;

/// Holds a folder until it is dropped or the program ends, however it does.
pub struct Claim {
    folder: PathBuf,
    is_new: bool,
    _lock: Option<File>,
}

impl Claim {
    /// Makes the folder if it is missing, and refuses one that has other files with the names of those to be written.
    pub fn of(folder: &Path, names: &[&str]) -> Result<Claim, CommandError> {
        let failed = |source| CommandError::Write { path: folder.to_owned(), source };
        if folder.is_file() {
            return Err(failed(ErrorKind::NotADirectory.into()));
        }
        let is_new = !folder.exists();
        std::fs::create_dir_all(folder).map_err(failed)?;
        // Where folders cannot be locked, nothing tells of another command.
        let lock = File::open(folder).ok();
        if let Some(Err(TryLockError::WouldBlock)) = lock.as_ref().map(File::try_lock) {
            return Err(CommandError::Usage(format!(
                "another command is writing into {}: wait until it has ended, or give another folder",
                folder.display()
            )));
        }
        let claim = Claim { folder: folder.to_owned(), is_new, _lock: lock };
        folder::refuse_foreign(folder, names.iter().copied())?;
        Ok(claim)
    }

    /// Writes a file beside those of the result.
    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), CommandError> {
        folder::put(&self.folder, name, content.as_ref())?;
        Ok(())
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if self.is_new {
            // Only where nothing was written into it.
            let _ = std::fs::remove_dir(&self.folder);
        }
    }
}
