//! The file of an embedded database: whether what is open is what its path names, whether the folder is still that of this process, and
//! whether the file is damaged.

use std::ffi::OsString;
use std::fs::Metadata;
use std::io::{Error, ErrorKind};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::SystemTime;

use super::sqlite_codes::damage;

/// Why nothing is read from the file of an embedded database and nothing written to it, until the service is started again.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FileFault {
    #[error(
        "the file of the database is another or gone since it was opened, and what is written would be lost: put the right file in its \
         place and restart the service"
    )]
    Replaced,
    #[error(
        "the file `lock` of the data folder is another or gone since this process took it, and another facies may use the database: end \
         that one and restart the service"
    )]
    LockReplaced,
    #[error(
        "the log of the database, `facies.db-wal`, is gone while it is in use, and what is written would be lost: restart the service"
    )]
    LogRemoved,
    #[error(
        "the database is damaged ({0}): nothing is read or written until the service is restarted; if `facies admin fsck` finds damage \
         then, restore it from a backup"
    )]
    Damaged(String),
}

impl From<FileFault> for sqlx::Error {
    fn from(fault: FileFault) -> Self {
        sqlx::Error::Io(Error::other(fault))
    }
}

/// The fault that an error of a connection is about, if it is about one.
pub fn fault_of(error: &sqlx::Error) -> Option<&FileFault> {
    let sqlx::Error::Io(error) = error else { return None };
    error.get_ref()?.downcast_ref()
}

/// Device, number and birth of a file: the number alone is given again to a file that is made after another was removed.
type Identity = (u64, u64, Option<SystemTime>);

fn identity(file: &Metadata) -> Identity {
    (file.dev(), file.ino(), file.created().ok())
}

/// A path, and the file that it named when that was opened.
#[derive(Clone, Debug)]
pub struct PlacedFile {
    path: PathBuf,
    opened: Identity,
}

impl PlacedFile {
    pub fn new(path: PathBuf, file: &Metadata) -> PlacedFile {
        PlacedFile { path, opened: identity(file) }
    }

    /// Whether the path names this file.
    pub fn is_in_place(&self) -> Result<bool, Error> {
        match self.path.metadata() {
            Ok(found) => Ok(identity(&found) == self.opened),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
            Err(error) => Err(error),
        }
    }
}

/// The file that was opened at the start. Its first fault stays.
#[derive(Debug)]
pub struct DatabaseFile {
    file: PlacedFile,
    /// The lock of its folder, which this process holds.
    lock: PlacedFile,
    log: PathBuf,
    fault: OnceLock<FileFault>,
}

impl DatabaseFile {
    /// The file at this path, which has just been opened.
    pub fn opened(path: &Path, lock: PlacedFile) -> Result<DatabaseFile, Error> {
        let mut log = OsString::from(path);
        log.push("-wal");
        let file = PlacedFile::new(path.into(), &path.metadata()?);
        Ok(DatabaseFile { file, lock, log: log.into(), fault: OnceLock::new() })
    }

    /// Whether it had a fault.
    pub fn is_given_up(&self) -> bool {
        self.fault.get().is_some()
    }

    /// Refuses a file that had a fault, or that is not at its path any more, and one in a folder whose lock is not at its path.
    pub fn check(&self) -> Result<(), sqlx::Error> {
        if let Some(fault) = self.fault.get() {
            return Err(fault.clone().into());
        }
        if !self.file.is_in_place()? {
            return Err(self.gives_up(FileFault::Replaced));
        }
        match self.lock.is_in_place()? {
            true => Ok(()),
            false => Err(self.gives_up(FileFault::LockReplaced)),
        }
    }

    /// How many rows a statement changed on a connection that is still held. One that has changed a row has a write-ahead log, unless
    /// that was removed.
    pub fn changed(&self, answer: Result<u64, sqlx::Error>) -> Result<u64, sqlx::Error> {
        let changed = self.watched(answer)?;
        if changed > 0 {
            self.check_log()?;
        }
        Ok(changed)
    }

    fn check_log(&self) -> Result<(), sqlx::Error> {
        match self.log.metadata() {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Err(self.gives_up(FileFault::LogRemoved))
            }
            _ => Ok(()),
        }
    }

    /// An answer of the database. One that tells of damage is the last: what else is read may be wrong, and what is written lost.
    pub fn watched<T>(&self, answer: Result<T, sqlx::Error>) -> Result<T, sqlx::Error> {
        answer.map_err(|error| match damage(&error) {
            Some(told) => self.gives_up(FileFault::Damaged(told)),
            None => error,
        })
    }

    fn gives_up(&self, fault: FileFault) -> sqlx::Error {
        let first = self.fault.get_or_init(|| {
            tracing::error!(file = %self.file.path.display(), %fault, "the database is given up");
            fault
        });
        first.clone().into()
    }
}
