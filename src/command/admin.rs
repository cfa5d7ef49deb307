//! `facies admin`: a deployment as a whole.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::settings::Arguments as Settings;
use crate::config::Config;
use crate::store::{Findings, Store, StoreError};

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write all rows and blobs into a new folder: a backup, or the way to another database
    Export {
        /// The folder to be made
        #[arg(long, value_name = "FOLDER")]
        to: PathBuf,
        #[command(flatten)]
        settings: Settings,
    },
    /// Take in an export, into a deployment in which there is nothing
    Import {
        /// The folder of the export
        #[arg(long, value_name = "FOLDER")]
        from: PathBuf,
        #[command(flatten)]
        settings: Settings,
    },
    /// Tell which rows miss their bytes and which bytes no row knows; exits with 1 where there are some
    Fsck {
        /// Read every blob and compare it with its hash
        #[arg(long)]
        read_all: bool,
        /// Have jobs whose files are lost solved again, and remove bytes that no row knows
        #[arg(long)]
        repair: bool,
        #[command(flatten)]
        settings: Settings,
    },
}

#[derive(Debug, thiserror::Error)]
pub enum AdminError {
    #[error("{0}")]
    Setting(#[from] crate::config::ConfigError),
    #[error("{0}")]
    Store(#[from] StoreError),
    #[error("{0}")]
    Io(#[from] std::io::Error),
    #[error("{dangling} blobs are lost or damaged, {orphans} are known to no row")]
    Findings { dangling: usize, orphans: usize },
}

impl AdminError {
    /// Whether another setting would help.
    pub fn is_setting(&self) -> bool {
        match self {
            AdminError::Setting(_) => true,
            AdminError::Store(StoreError::Files(_)) => false,
            AdminError::Store(error) => error.is_setting(),
            _ => false,
        }
    }
}

pub fn run(arguments: &Arguments) -> Result<(), AdminError> {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    runtime.block_on(async {
        match &arguments.command {
            Command::Export { to, settings } => {
                let moved = open(settings).await?.export(to).await?;
                println!("exported {} rows and {} blobs", moved.rows, moved.blobs);
                Ok(())
            }
            Command::Import { from, settings } => {
                let moved = open(settings).await?.import(from).await?;
                println!("imported {} rows and {} blobs", moved.rows, moved.blobs);
                Ok(())
            }
            Command::Fsck { read_all, repair, settings } => {
                check(&open(settings).await?, *read_all, *repair).await
            }
        }
    })
}

async fn open(settings: &Settings) -> Result<Store, AdminError> {
    let given = settings.given()?;
    let config = Config::without_listener(|name| given.get(name))?;
    Ok(Store::connect(&config.places).await?)
}

async fn check(store: &Store, read_all: bool, repair: bool) -> Result<(), AdminError> {
    let mut findings = store.fsck(read_all).await?;
    tell(&findings);
    if repair && !findings.is_clean() {
        let repaired = store.repair(&findings).await?;
        println!(
            "found {} blobs again, accepted {} jobs again, removed {} blobs",
            repaired.found_again, repaired.jobs, repaired.removed
        );
        findings = store.fsck(read_all).await?;
        tell(&findings);
    }
    if findings.is_clean() {
        println!("{} blobs, each known to a row and none missing", findings.objects);
        return Ok(());
    }
    let (dangling, orphans) = (findings.dangling.len(), findings.orphans.len());
    Err(AdminError::Findings { dangling, orphans })
}

fn tell(findings: &Findings) {
    for lost in &findings.dangling {
        for mesh in &lost.meshes {
            println!("lost or damaged: blob {} of mesh {mesh}", lost.sha256);
        }
        for job in &lost.jobs {
            println!("lost or damaged: blob {} of job {job}", lost.sha256);
        }
    }
    for place in &findings.orphans {
        println!("known to no row: {place}");
    }
}
