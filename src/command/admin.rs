//! `facies admin`: a deployment as a whole.

use std::path::PathBuf;

use clap::{Args, Subcommand};

pub use super::deployment::AdminError;
use super::deployment::{export, import, open, open_or_make};
use super::settings::Arguments as Settings;
use crate::schema::key::{KeyDocument, RETENTION_DAYS, TENANT_NAMES, is_tenant, scopes_of};
use crate::schema::wire::date::date_and_time;
use crate::schema::wire::letters::is_unseen;
use crate::schema::wire::problem::Problem;
use crate::store::{AuditRow, AuditedAction, Chain, DEFAULT_TENANT, Findings, Store};

/// Rows of the audit log that are read together.
const AUDIT_ROWS: i64 = 1000;
/// Keys that are read together.
const KEYS_AT_ONCE: i64 = 200;

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
    /// Make, list, rotate and end keys
    Key {
        #[command(subcommand)]
        command: KeyCommand,
    },
    /// How long what nobody changes is kept, for a tenant
    Retention {
        #[arg(long, default_value = DEFAULT_TENANT, value_parser = tenant)]
        tenant: String,
        /// Days; without them until it is erased
        #[arg(long, value_parser = clap::value_parser!(i64).range(RETENTION_DAYS))]
        days: Option<i64>,
        #[command(flatten)]
        settings: Settings,
    },
    /// Tell whether retention trusts the clock; exits with 1 while it erases nothing because the clock is far off
    Clock {
        /// The clock is right
        #[arg(long)]
        trust: bool,
        #[command(flatten)]
        settings: Settings,
    },
    /// Print the audit log and check its integrity; exits with 1 if it was changed
    Audit {
        /// Rows with a larger number
        #[arg(long, default_value_t = 0)]
        after: i64,
        #[command(flatten)]
        settings: Settings,
    },
    /// Tell whether SQLite finds its file damaged, which rows miss their bytes, which bytes no row knows and which meshes nothing leads
    /// to; exits with 1 where there are some
    Fsck {
        /// Read every row, and every blob and compare it with its hash
        #[arg(long)]
        read_all: bool,
        /// Have jobs whose files are lost solved again, and remove bytes that no row knows and meshes that nothing leads to
        #[arg(long)]
        repair: bool,
        #[command(flatten)]
        settings: Settings,
    },
}

#[derive(Debug, Subcommand)]
enum KeyCommand {
    /// Make a key and print it, this once
    New {
        #[arg(long, default_value = DEFAULT_TENANT, value_parser = tenant)]
        tenant: String,
        /// What it is for
        #[arg(long)]
        label: String,
        /// Of read, write, run and admin, with commas between them
        #[arg(long, default_value = "read,write,run")]
        scopes: String,
        /// Days until it ends; without them it does not
        #[arg(long)]
        days: Option<i64>,
        #[command(flatten)]
        settings: Settings,
    },
    /// The keys of a tenant, without their secrets
    List {
        #[arg(long, default_value = DEFAULT_TENANT, value_parser = tenant)]
        tenant: String,
        #[command(flatten)]
        settings: Settings,
    },
    /// Make a key that allows the same, print it, and let the old one end after a while
    Rotate {
        #[arg(long, default_value = DEFAULT_TENANT, value_parser = tenant)]
        tenant: String,
        /// The middle part of the key
        id: String,
        /// How many hours the old key can still be used
        #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(i64).range(0..=8760))]
        overlap_h: i64,
        #[command(flatten)]
        settings: Settings,
    },
    /// End a key at once
    Revoke {
        #[arg(long, default_value = DEFAULT_TENANT, value_parser = tenant)]
        tenant: String,
        /// The middle part of the key
        id: String,
        #[command(flatten)]
        settings: Settings,
    },
}

fn tenant(text: &str) -> Result<String, String> {
    match is_tenant(text) {
        true => Ok(text.to_owned()),
        false => Err(TENANT_NAMES.to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> Result<(), AdminError> {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    runtime.block_on(async {
        match &arguments.command {
            Command::Export { to, settings } => {
                let moved = export(to, settings).await?;
                println!("exported {} rows and {} blobs", moved.rows, moved.blobs);
                Ok(())
            }
            Command::Import { from, settings } => {
                let moved = import(from, settings).await?;
                println!("imported {} rows and {} blobs", moved.rows, moved.blobs);
                Ok(())
            }
            Command::Key { command } => key(command).await,
            Command::Retention { tenant, days, settings } => {
                let store = open(settings).await?.of_tenant(tenant);
                let (audited, retained) =
                    (store.audited_action(COMMAND, "admin retention", ""), store.retain(*days));
                store.noted(audited, retained, |_| None).await?;
                let kept =
                    days.map_or("until it is erased".to_owned(), |days| format!("{days} days"));
                println!("what {tenant} does not change is kept {kept}");
                Ok(())
            }
            Command::Clock { trust, settings } => clock(&open(settings).await?, *trust).await,
            Command::Audit { after, settings } => audit(&open(settings).await?, *after).await,
            Command::Fsck { read_all, repair, settings } => {
                let store = open(settings).await?;
                store.check_pages().await?;
                store.check_owner().await?;
                check(&store, *read_all, *repair).await
            }
        }
    })
}

async fn clock(store: &Store, trust: bool) -> Result<(), AdminError> {
    if trust {
        let audited = store.audited_action(COMMAND, "admin clock", "");
        store.noted(audited, store.trust_clock(), |()| None).await?;
    }
    let Some(doubt) = store.clock_doubt().await? else {
        println!("retention trusts the clock");
        return Ok(());
    };
    Err(AdminError::ClockDoubted(doubt))
}

async fn key(command: &KeyCommand) -> Result<(), AdminError> {
    match command {
        KeyCommand::New { tenant, label, scopes, days, settings } => {
            let scopes = scopes_of(scopes)
                .map_err(|word| AdminError::Refused(format!("there is no scope {word:?}")))?;
            let wanted = KeyDocument { label: label.clone(), scopes, days: *days };
            wanted.check().map_err(|problem| AdminError::Refused(lines(&problem)))?;
            // The first key may be made before a service is started.
            let store = open_or_make(settings).await?.of_tenant(tenant);
            let made = store.make_key(&wanted);
            let key = store
                .noted(store.audited_action(COMMAND, "admin key new", ""), made, |key| {
                    Some(&key.id)
                })
                .await?;
            println!("{}", key.text);
            Ok(())
        }
        KeyCommand::List { tenant, settings } => {
            list_keys(&open(settings).await?.of_tenant(tenant)).await
        }
        KeyCommand::Rotate { tenant, id, overlap_h, settings } => {
            let store = open(settings).await?.of_tenant(tenant);
            let rotated = store.rotate_key(id, *overlap_h);
            let key = store
                .noted(store.audited_action(COMMAND, "admin key rotate", id), rotated, |_| None)
                .await?;
            let key = key.ok_or_else(|| no_key(id))?;
            println!("{}", key.text);
            Ok(())
        }
        KeyCommand::Revoke { tenant, id, settings } => {
            let store = open(settings).await?.of_tenant(tenant);
            let revoked = store.revoke_key(id);
            if !store
                .noted(store.audited_action(COMMAND, "admin key revoke", id), revoked, |_| None)
                .await?
            {
                return Err(no_key(id));
            }
            println!("{id} is not let in any more");
            Ok(())
        }
    }
}

async fn list_keys(store: &Store) -> Result<(), AdminError> {
    let mut last: Option<String> = None;
    loop {
        let rows = store.keys(last.as_deref(), KEYS_AT_ONCE).await?;
        for row in &rows {
            let state = match (row.revoked, row.expires) {
                (Some(_), _) => "revoked".to_owned(),
                (None, Some(ms)) => format!("until {}Z", date_and_time(ms.div_euclid(1000))),
                (None, None) => "lasts".to_owned(),
            };
            println!("{}  {state:<26}  {}  {}", row.id, row.scopes, shown(&row.label));
        }
        let Some(row) = rows.last() else { return Ok(()) };
        last = Some(row.id.clone());
    }
}

/// A text in which a terminal finds no commands, and a reader all that is there.
fn shown(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter.is_control() || is_unseen(letter) {
            true => shown.extend(letter.escape_default()),
            false => shown.push(letter),
        }
    }
    shown
}

fn lines(problem: &Problem) -> String {
    let faults = problem.errors.iter().map(|fault| format!("{}: {}", fault.pointer, fault.detail));
    faults.collect::<Vec<_>>().join("; ")
}

fn no_key(id: &str) -> AdminError {
    AdminError::Refused(format!("the tenant has no key {id:?} that is in force"))
}

/// Actor of changes on the command line, for the audit log.
const COMMAND: &str = "command";

async fn audit(store: &Store, mut after: i64) -> Result<(), AdminError> {
    loop {
        let rows = store.audit(after, "", AUDIT_ROWS).await?;
        let Some(last) = rows.last() else { break };
        after = last.number;
        for AuditRow { number, at, audited, outcome, .. } in &rows {
            let AuditedAction { tenant, actor, action, object, request } = audited;
            println!(
                "{number} {at} {tenant:?} {actor} {action:?} {object:?} {outcome} {request:?}"
            );
        }
    }
    match store.check_audit().await? {
        Chain::Whole { rows, hash } => {
            println!(
                "{rows} rows, each following from those before it; the last has hash {hash:?}"
            );
            Ok(())
        }
        Chain::Broken { at } => Err(AdminError::Audit { at }),
    }
}

async fn check(store: &Store, read_all: bool, repair: bool) -> Result<(), AdminError> {
    let mut findings = store.fsck(read_all).await?;
    tell(&findings);
    if repair && !findings.is_clean() {
        let repaired = store.repair(&findings).await?;
        println!(
            "found {} blobs again, accepted {} jobs again, removed {} blobs, erased {} meshes",
            repaired.found_again, repaired.jobs, repaired.removed, repaired.erased
        );
        findings = store.fsck(read_all).await?;
        tell(&findings);
    }
    if findings.is_clean() {
        println!("{} blobs, each known to a row and none missing", findings.objects);
        return Ok(());
    }
    Err(AdminError::Findings {
        dangling: findings.dangling.len(),
        orphans: findings.orphans.len(),
        unreached: findings.unreached.len(),
    })
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
    for lost in &findings.unreached {
        println!("reached by nothing: mesh {} of the tenant {:?}", lost.mesh, lost.tenant);
    }
}
