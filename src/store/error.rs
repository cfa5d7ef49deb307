//! Reasons why rows or bytes could not be read or written.

use super::database::{FileFault, fault_of};

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("database: {0}")]
    Database(sqlx::Error),
    /// The embedded database is not used any more.
    #[error("{0}")]
    DatabaseFile(FileFault),
    #[error(
        "the database {file} cannot be opened or brought up to date: {source}. A full disk, a folder that cannot be written \
         and a limit on the size of files below 1 MB (ulimit -f) end so"
    )]
    CannotOpen { file: std::path::PathBuf, source: sqlx::Error },
    #[error(
        "the database at {server} cannot be used: {source}. The setting `database` names server, port, user and database"
    )]
    CannotConnect { server: String, source: sqlx::Error },
    #[error(
        "the database {place} can be read and not written: {source}. Its file and its folder have to be writable for the account of the service, and a server has to be no replica"
    )]
    ReadOnly { place: String, source: sqlx::Error },
    #[error("blobs: {0}")]
    Blobs(#[from] object_store::Error),
    #[error("the bucket of the setting `blobs` does not exist: create it, or name another one")]
    NoBucket,
    #[error(
        "the folder {} is not mounted or not there, or it is another: nothing is stored below it",
        folder.display()
    )]
    NoFolder { folder: std::path::PathBuf },
    #[error("the store of blobs did not answer within {within_s} s")]
    NoAnswer { within_s: f64 },
    #[error(
        "none of the {meshes} newest meshes of the database is in these blobs: all hosts of a database keep theirs in one place. The setting `blobs` (FACIES_BLOBS) has to name the folder, or the bucket and prefix, of the other hosts; without it blobs are in the data folder of each"
    )]
    OtherBlobs { meshes: usize },
    #[error(
        "the blobs of the setting `blobs` (FACIES_BLOBS) are not those of this database: they hold {owner}. Name a place that no other deployment has; if they are those of this database all the same, as after a restore, write {identity} into the file `facies-owner` there"
    )]
    ForeignBlobs { owner: String, identity: String },
    #[error(
        "the database {database} is new and {} holds blobs: its rows are lost. Restore the database from a backup; to begin anew, move \
         that folder away",
        folder.display()
    )]
    NewDatabase { database: String, folder: std::path::PathBuf },
    #[error("the database {place} is damaged: {}. Restore it from a backup", found.join("; "))]
    Damaged { place: String, found: Vec<String> },
    #[error("file system: {0}")]
    Files(#[from] std::io::Error),
    #[error(
        "the database is at schema step {found} and this program knows steps up to {known}: start a newer program"
    )]
    SchemaTooNew { found: i64, known: i64 },
    #[error(
        "the database is at schema step {found} and this program needs step {known}: run `facies migrate`"
    )]
    SchemaTooOld { found: i64, known: i64 },
    #[error(
        "the database {} is at schema step {found} and this program needs step {known}: it was left as it is. Copy the data folder, since \
         an earlier program cannot open it afterwards, and run `facies migrate`, or start `facies serve`, which migrates it too",
        file.display()
    )]
    FileTooOld { file: std::path::PathBuf, found: i64, known: i64 },
    #[error("the schema of the database does not fit this program: {0}")]
    Schema(String),
    #[error(
        "another facies serves the data folder {}: end it, or name another folder in the setting `data`",
        folder.display()
    )]
    InUse { folder: std::path::PathBuf },
    #[error(
        "another facies has the database of the data folder {} open, and migrated it when it started: for a new version end that process \
         and start the new one, which migrates SQLite itself; `facies migrate` is for a database that several share, or for a folder \
         that nobody serves",
        folder.display()
    )]
    ServedAlready { folder: std::path::PathBuf },
    #[error("blob {sha256} has changed on disk, its hash is {found}")]
    Integrity { sha256: String, found: String },
    #[error("blob {sha256} is not where it was kept")]
    Missing { sha256: String },
    #[error("it was erased meanwhile")]
    Erased,
    #[error("others changed the same rows at the same time, again and again")]
    Contended,
    #[error("{most} requests wait to be noted or written already")]
    Busy { most: usize },
    #[error("{0}")]
    OfMany(std::sync::Arc<StoreError>),
    #[error("the tenant has {keys} keys in force, and may have {most}")]
    TooManyKeys { keys: i64, most: i64 },
    #[error("there is something in this deployment already: {table} has rows")]
    NotEmpty { table: &'static str },
    #[error("the export cannot be read: {0}")]
    Export(String),
    #[error(
        "blob {sha256} was erased meanwhile, during the export: export again, into a new folder"
    )]
    ErasedDuringExport { sha256: String },
    #[error("the work was interrupted")]
    Interrupted,
    #[error("the system has no random bytes")]
    NoRandomness,
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        match fault_of(&error) {
            Some(fault) => StoreError::DatabaseFile(fault.clone()),
            None => StoreError::Database(error),
        }
    }
}

impl StoreError {
    /// The same error, with the file of the embedded database that it arose from.
    pub(super) fn of_file(self, file: &std::path::Path) -> StoreError {
        let place = file.display().to_string();
        match self {
            StoreError::Database(source) if super::database::is_damaged(&source) => {
                StoreError::Damaged { place, found: vec![source.to_string()] }
            }
            StoreError::DatabaseFile(FileFault::Damaged(told)) => {
                StoreError::Damaged { place, found: vec![told] }
            }
            StoreError::Database(source) => {
                StoreError::CannotOpen { file: file.to_owned(), source }
            }
            StoreError::SchemaTooOld { found, known } => {
                StoreError::FileTooOld { file: file.to_owned(), found, known }
            }
            other => other,
        }
    }

    /// True when the disk or the quota is full.
    pub fn is_full(&self) -> bool {
        match self {
            StoreError::Database(error)
            | StoreError::CannotOpen { source: error, .. }
            | StoreError::CannotConnect { source: error, .. } => super::database::is_full(error),
            StoreError::Files(error) => is_full(error),
            StoreError::OfMany(error) => error.is_full(),
            StoreError::Blobs(error) => {
                let mut cause: Option<&(dyn std::error::Error + 'static)> = Some(error);
                while let Some(error) = cause {
                    if error.downcast_ref::<std::io::Error>().is_some_and(is_full) {
                        return true;
                    }
                    cause = error.source();
                }
                false
            }
            _ => false,
        }
    }

    /// True when the store is busy or out of reach, so that the same request may succeed later.
    pub fn is_unavailable(&self) -> bool {
        match self {
            StoreError::Database(error) | StoreError::CannotConnect { source: error, .. } => {
                super::database::is_unavailable(error)
            }
            // A server that does not answer, a disk that errs, no descriptor left.
            StoreError::Blobs(object_store::Error::Generic { .. }) => !self.is_full(),
            StoreError::DatabaseFile(_)
            | StoreError::Contended
            | StoreError::Busy { .. }
            | StoreError::NoBucket
            | StoreError::NoFolder { .. }
            | StoreError::NoAnswer { .. } => true,
            StoreError::OfMany(error) => error.is_unavailable(),
            _ => false,
        }
    }

    /// True when the file of an embedded database is damaged.
    pub fn is_damaged(&self) -> bool {
        match self {
            StoreError::Damaged { .. } | StoreError::DatabaseFile(FileFault::Damaged(_)) => true,
            StoreError::Database(error) => super::database::is_damaged(error),
            StoreError::OfMany(error) => error.is_damaged(),
            _ => false,
        }
    }

    /// True when another setting, folder or program would help.
    pub fn is_setting(&self) -> bool {
        match self {
            StoreError::InUse { .. }
            | StoreError::ServedAlready { .. }
            | StoreError::NoBucket
            | StoreError::OtherBlobs { .. }
            | StoreError::ForeignBlobs { .. }
            | StoreError::NewDatabase { .. }
            | StoreError::CannotOpen { .. }
            | StoreError::ReadOnly { .. }
            | StoreError::Files(_)
            | StoreError::SchemaTooNew { .. }
            | StoreError::SchemaTooOld { .. }
            | StoreError::FileTooOld { .. }
            | StoreError::Schema(_) => true,
            StoreError::Database(error) | StoreError::CannotConnect { source: error, .. } => {
                super::database::is_refused(error)
            }
            _ => false,
        }
    }
}

/// An error of the file system with the path that it is of.
pub(super) fn at(path: &std::path::Path) -> impl Fn(std::io::Error) -> std::io::Error {
    move |error| std::io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

fn is_full(error: &std::io::Error) -> bool {
    use std::io::ErrorKind;
    matches!(
        error.kind(),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge
    )
}
