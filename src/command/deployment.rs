//! The deployment that settings name: opened, exported, imported.

use std::path::{Path, PathBuf};

use super::settings::Arguments as Settings;
use crate::config::{BlobLocation, Config, DatabaseLocation, StorageLocations};
use crate::jobs::JobInput;
use crate::store::{ClockDoubt, Store, StoreError, TransferCounts};

#[derive(Debug, thiserror::Error)]
pub enum AdminError {
    #[error("{0}")]
    Setting(#[from] crate::config::ConfigError),
    #[error("{0}")]
    Store(#[from] StoreError),
    /// The data folder, or one of it, which cannot be made or opened.
    #[error("{0}")]
    Folder(StoreError),
    #[error(
        "{} could not be written: no space is left on its disk, or its quota is used up; what is there is no export",
        to.display()
    )]
    TargetFull { to: PathBuf },
    #[error("{0}")]
    Io(#[from] std::io::Error),
    #[error("{0}")]
    Refused(String),
    #[error("retention erases nothing: {0}; `facies admin clock --trust` confirms it")]
    ClockDoubted(ClockDoubt),
    #[error("the audit log was changed: row {at} does not follow from those before it")]
    Audit { at: i64 },
    #[error(
        "{dangling} blobs are lost or damaged, {orphans} are known to no row; {unreached} meshes are reached by nothing"
    )]
    Findings { dangling: usize, orphans: usize, unreached: usize },
}

impl AdminError {
    /// Whether another setting would help.
    pub fn is_setting(&self) -> bool {
        match self {
            AdminError::Setting(_) | AdminError::Folder(_) => true,
            AdminError::Store(StoreError::Files(_)) => false,
            AdminError::Store(error) => error.is_setting() && !error.is_full(),
            _ => false,
        }
    }

    /// Whether what was asked for is refused, or the export.
    pub fn is_refused(&self) -> bool {
        matches!(
            self,
            AdminError::Refused(_)
                | AdminError::Store(StoreError::NotEmpty { .. } | StoreError::Export(_))
        )
    }
}

/// Opens a deployment that is there: in a new one nothing would be found, and nobody would be told.
pub async fn open(settings: &Settings) -> Result<Store, AdminError> {
    let config = config(settings)?;
    match Store::missing(&config.places) {
        None => connect(&config).await,
        Some(file) => Err(AdminError::Refused(format!(
            "there is no database {}: name the data folder of the deployment in the setting `data` (FACIES_DATA); a relative one is \
             looked for in the working folder",
            file.display()
        ))),
    }
}

/// Opens a deployment, or makes one.
pub async fn open_or_make(settings: &Settings) -> Result<Store, AdminError> {
    connect(&config(settings)?).await
}

fn config(settings: &Settings) -> Result<Config, AdminError> {
    let given = settings.given()?;
    Ok(Config::without_listener(|name| given.get(name))?)
}

async fn connect(config: &Config) -> Result<Store, AdminError> {
    let store = Store::connect_unchanged(&config.places).await.map_err(|error| match error {
        StoreError::Files(_) if !error.is_full() => AdminError::Folder(error),
        other => other.into(),
    })?;
    Ok(store.with_key_limit(config.most_keys).with_input_reader(JobInput::check_stored))
}

pub async fn export(to: &Path, settings: &Settings) -> Result<TransferCounts, AdminError> {
    if to.symlink_metadata().is_ok() {
        let detail = format!("{} is there: it has to be a new folder", to.display());
        return Err(AdminError::Refused(detail));
    }
    let store = open(settings).await?;
    store.check_pages().await?;
    store.check_owner().await?;
    // A database is only read here: the disk that is full is that of the target.
    store.export(to).await.map_err(|error| not_exported(to, error))
}

fn not_exported(to: &Path, error: StoreError) -> AdminError {
    match error.is_full() {
        true => AdminError::TargetFull { to: to.to_owned() },
        false => error.into(),
    }
}

/// Takes in an export. A data folder that was made for one that failed goes again, where everything is in it.
pub async fn import(from: &Path, settings: &Settings) -> Result<TransferCounts, AdminError> {
    let config = config(settings)?;
    let StorageLocations { data, database, blobs } = &config.places;
    let is_new = !data.exists();
    let imported = import_into(&config, from).await;
    let is_in_use = matches!(imported, Err(AdminError::Store(StoreError::InUse { .. })));
    if imported.is_err() && !is_in_use && is_new && data.exists() {
        let places = (database, blobs);
        let has_all = matches!(places, (DatabaseLocation::Embedded, BlobLocation::InData));
        if !has_all || std::fs::remove_dir_all(data).is_err() {
            eprintln!("left       {}, which was made for this import", data.display());
        }
    }
    imported
}

async fn import_into(config: &Config, from: &Path) -> Result<TransferCounts, AdminError> {
    let store = connect(config).await?;
    let imported = match store.check_owner().await {
        Ok(()) => store.import(from).await,
        Err(error) => Err(error),
    };
    store.close().await;
    Ok(imported?)
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use super::*;
    use crate::command::CommandError;
    use crate::command::serve::ServeError;

    #[test]
    fn a_full_disk_is_no_wrong_setting_and_an_export_names_its_folder() {
        let io = |kind: ErrorKind| sqlx::Error::Io(Error::from(kind));
        let opened = |kind| StoreError::CannotOpen { file: "facies.db".into(), source: io(kind) };
        for (kind, code) in [(ErrorKind::StorageFull, 3), (ErrorKind::PermissionDenied, 78)] {
            let codes = [
                CommandError::Admin(AdminError::Store(opened(kind))).exit_code(),
                CommandError::Serve(ServeError::Store(opened(kind))).exit_code(),
            ];
            assert_eq!(codes, [code; 2], "{kind}");
        }
        let full = StoreError::Database(io(ErrorKind::StorageFull));
        let told = CommandError::Admin(not_exported(Path::new("/backup/of today"), full));
        assert_eq!(told.exit_code(), 3);
        assert!(told.to_string().starts_with("/backup/of today could not be written"), "{told}");
    }
}
