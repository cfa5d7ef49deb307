//! Export and import of a whole deployment, for another engine or as a backup: a file of rows for each table, a file
//! for each blob, and a manifest, which is written last and read first.
//!
//! Where bytes are is a deployment's own affair: places are left out, and made anew by the import.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{DirBuilder, File};
use std::io::{BufRead, BufReader, BufWriter, ErrorKind, Lines, Write};
use std::os::unix::fs::DirBuilderExt;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::database::{Executor, Row, Statement, Transaction, Value, newest_step, query, query_of};
use super::references::{Content, hold};
use super::{Store, StoreError};
use crate::schema::wire::canonical::sha256_hex;

/// Every table with rows of a deployment, each behind those that it refers to.
const TABLES: [&str; 23] = [
    "tenants",
    "keys",
    "meshes",
    "cases",
    "case_tags",
    "case_meshes",
    "plans",
    "jobs",
    "job_tags",
    "job_cases",
    "job_meshes",
    "made_meshes",
    "cohorts",
    "cohort_members",
    "cohort_left",
    "cohort_models",
    "job_files",
    "job_events",
    "idempotency_keys",
    "tombstones",
    "deeds",
    "audit",
    "audit_end",
];
const REFERENCED: &str = "SELECT blob FROM meshes UNION SELECT blob FROM job_files";
const MANIFEST: &str = "export.json";

/// How much was moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TransferCounts {
    pub rows: usize,
    pub blobs: usize,
}

#[derive(Serialize, Deserialize)]
struct Manifest {
    /// The schema step of the rows.
    schema: i64,
    rows: BTreeMap<String, usize>,
    blobs: BTreeSet<String>,
}

/// The first line of a file of rows: the names of the columns and their types.
#[derive(Serialize, Deserialize)]
struct Head {
    columns: Vec<(String, Kind)>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Text,
    Integer,
    Real,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Kind::Text => "text",
            Kind::Integer => "integers",
            Kind::Real => "numbers",
        }
    }
}

/// The bytes of an exported blob, whose file has their hash for its name.
fn read_exported(folder: &Path, sha256: &str) -> Result<Vec<u8>, StoreError> {
    let file = folder.join("blobs").join(sha256);
    let bytes = std::fs::read(&file)
        .map_err(at(&file, "the manifest of the export names it"))
        .map_err(absent)?;
    let found = sha256_hex(&bytes);
    if found == *sha256 {
        return Ok(bytes);
    }
    Err(StoreError::Export(format!("{} is damaged: its hash is {found}", file.display())))
}

impl Store {
    /// Writes everything into a new folder, as it is at this moment.
    pub async fn export(&self, folder: &Path) -> Result<TransferCounts, StoreError> {
        // It holds faces of patients.
        DirBuilder::new()
            .mode(0o700)
            .create(folder)
            .map_err(at(folder, "it has to be a new folder"))?;
        std::fs::create_dir(folder.join("blobs"))?;
        let mut snapshot = self.database.snapshot().await?;
        let mut manifest =
            Manifest { schema: newest_step(), rows: BTreeMap::new(), blobs: BTreeSet::new() };
        for table in TABLES {
            let file = folder.join(format!("{table}.ndjson"));
            let rows = export_table(&mut snapshot, table, &file).await?;
            manifest.rows.insert(table.to_owned(), rows);
        }
        for row in query(REFERENCED).without_timeout().fetch_all(&mut snapshot).await? {
            manifest.blobs.insert(row.try_get(0)?);
        }
        snapshot.rollback().await;
        self.export_blobs(folder, &manifest.blobs).await?;
        let text = serde_json::to_vec_pretty(&manifest).map_err(unreadable)?;
        write_durably(&folder.join(MANIFEST), &text)?;
        Ok(TransferCounts { rows: manifest.rows.values().sum(), blobs: manifest.blobs.len() })
    }

    /// After the snapshot has ended, which must not last as long as they take.
    async fn export_blobs(
        &self,
        folder: &Path,
        blobs: &BTreeSet<String>,
    ) -> Result<(), StoreError> {
        for sha256 in blobs {
            let bytes = self.read_blob(sha256).await.map_err(|error| match error {
                StoreError::Erased => StoreError::ErasedDuringExport { sha256: sha256.clone() },
                other => other,
            })?;
            write_durably(&folder.join("blobs").join(sha256), &bytes)?;
        }
        Ok(())
    }

    /// Takes in what was exported, all of it or nothing. Only into a deployment in which there is nothing.
    pub async fn import(&self, folder: &Path) -> Result<TransferCounts, StoreError> {
        let file = folder.join(MANIFEST);
        let text = std::fs::read(&file)
            .map_err(at(&file, "it has to be what `admin export` wrote"))
            .map_err(absent)?;
        let manifest: Manifest = serde_json::from_slice(&text).map_err(unreadable)?;
        if manifest.schema != newest_step() {
            let (found, known) = (manifest.schema, newest_step());
            let detail = format!("it is of schema step {found}, and this program of step {known}");
            return Err(StoreError::Export(detail));
        }
        self.refuse_unless_empty().await?;
        // All of it before anything is stored.
        check_rows(folder, &manifest)?;
        for sha256 in &manifest.blobs {
            read_exported(folder, sha256)?;
        }
        let mut stored = Vec::with_capacity(manifest.blobs.len());
        for sha256 in &manifest.blobs {
            let content: Content = (sha256.clone(), read_exported(folder, sha256)?.into());
            stored.extend(self.put(&[content]).await?);
        }
        let mut transaction = self.database.begin().await?;
        let mut moved = TransferCounts { rows: 0, blobs: stored.len() };
        if !hold(&mut transaction, &stored).await? {
            return Err(StoreError::Contended);
        }
        for table in TABLES {
            moved.rows += import_table(&mut transaction, table, folder).await?;
        }
        transaction.commit().await?;
        Ok(moved)
    }

    async fn refuse_unless_empty(&self) -> Result<(), StoreError> {
        for table in TABLES {
            let row = query_of(format!("SELECT COUNT(*) FROM {table}"))
                .fetch_one(self.database.reader())
                .await?;
            if row.try_get::<i64, _>(0)? > 0 {
                return Err(StoreError::NotEmpty { table });
            }
        }
        Ok(())
    }
}

/// An error of the file system with its place and what has to be there.
fn at(path: &Path, wanted: &'static str) -> impl Fn(std::io::Error) -> std::io::Error {
    let path = path.display().to_string();
    move |error| std::io::Error::new(error.kind(), format!("{path}: {error}; {wanted}"))
}

/// What an export lacks is a fault of the export, and not of the disk.
fn absent(error: std::io::Error) -> StoreError {
    match error.kind() {
        ErrorKind::NotFound => StoreError::Export(error.to_string()),
        _ => StoreError::Files(error),
    }
}

async fn export_table(
    snapshot: &mut Transaction,
    table: &'static str,
    file: &Path,
) -> Result<usize, StoreError> {
    let mut out = BufWriter::new(File::create(file)?);
    let mut rows = 0;
    let mut take = |row: Row| {
        if rows == 0 {
            write_line(&mut out, &Head { columns: head(&row)? })?;
        }
        rows += 1;
        let values: Vec<Json> = row.values()?.into_iter().map(json).collect();
        write_line(&mut out, &values)
    };
    let all = query_of(format!("SELECT * FROM {table}")).without_timeout();
    all.run(Executor::Transaction(snapshot), &mut take).await?;
    out.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()?;
    Ok(rows)
}

/// The rows of an exported table, one after the other.
struct ExportedRows {
    /// The file, for errors.
    file: String,
    columns: Vec<(String, Kind)>,
    lines: Lines<BufReader<File>>,
    read: usize,
}

impl ExportedRows {
    /// `None` where the table had no rows.
    fn open(folder: &Path, table: &str) -> Result<Option<ExportedRows>, StoreError> {
        let file = folder.join(format!("{table}.ndjson"));
        let opened = File::open(&file).map_err(at(&file, "the manifest of the export names it"));
        let mut lines = BufReader::new(opened.map_err(absent)?).lines();
        let Some(head) = lines.next() else { return Ok(None) };
        let Head { columns } = serde_json::from_str(&head?).map_err(unreadable)?;
        let is_name = |name: &str| {
            name.bytes()
                .all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_')
        };
        if let Some((strange, _)) = columns.iter().find(|(name, _)| !is_name(name)) {
            return Err(StoreError::Export(format!("{table} has no column {strange:?}")));
        }
        Ok(Some(ExportedRows { file: file.display().to_string(), columns, lines, read: 0 }))
    }

    /// The next row, a value for each column, of its type.
    fn next_row(&mut self) -> Result<Option<Vec<Value>>, StoreError> {
        let Some(line) = self.lines.next() else { return Ok(None) };
        self.read += 1;
        let (row, wanted) = (self.read, self.columns.len());
        let fault = |what: String| StoreError::Export(format!("{}, row {row}: {what}", self.file));
        let values: Vec<Json> =
            serde_json::from_str(&line?).map_err(|error| fault(error.to_string()))?;
        if values.len() != wanted {
            return Err(fault(format!("{} values for {wanted} columns", values.len())));
        }
        let value = |(json, (name, kind)): (Json, &(String, Kind))| {
            value_of(json, *kind)
                .ok_or_else(|| fault(format!("column {name} holds {}", kind.name())))
        };
        values.into_iter().zip(&self.columns).map(value).collect::<Result<_, _>>().map(Some)
    }

    /// Reads all rows; each that names a blob has to name one of the manifest. Returns how many.
    fn check(mut self, blobs: &BTreeSet<String>) -> Result<usize, StoreError> {
        let column = self.columns.iter().position(|(name, _)| name == "blob");
        while let Some(values) = self.next_row()? {
            let blob = column.map(|column| &values[column]);
            let is_known =
                |blob: &Value| matches!(blob, Value::Text(Some(hash)) if blobs.contains(hash));
            if blob.is_some_and(|blob| !is_known(blob)) {
                let what = "its blob is none of those of the manifest";
                let detail = format!("{}, row {}: {what}", self.file, self.read);
                return Err(StoreError::Export(detail));
            }
        }
        Ok(self.read)
    }
}

/// Looks at everything that a manifest names except the bytes, before anything is stored.
fn check_rows(folder: &Path, manifest: &Manifest) -> Result<(), StoreError> {
    let is_hash = |blob: &str| {
        blob.len() == 64 && blob.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
    };
    if let Some(strange) = manifest.blobs.iter().find(|blob| !is_hash(blob)) {
        return Err(StoreError::Export(format!("{MANIFEST}: {strange:?} is no hash of a blob")));
    }
    for table in TABLES {
        let rows = ExportedRows::open(folder, table)?;
        let rows = rows.map_or(Ok(0), |rows| rows.check(&manifest.blobs))?;
        if manifest.rows.get(table) != Some(&rows) {
            let file = folder.join(format!("{table}.ndjson"));
            return Err(StoreError::Export(format!("{} is cut short", file.display())));
        }
    }
    Ok(())
}

async fn import_table(
    transaction: &mut Transaction,
    table: &'static str,
    folder: &Path,
) -> Result<usize, StoreError> {
    let Some(mut rows) = ExportedRows::open(folder, table)? else { return Ok(0) };
    let names: Vec<&str> = rows.columns.iter().map(|(name, _)| name.as_str()).collect();
    let places: Vec<String> = (1..=names.len()).map(|number| format!("${number}")).collect();
    let (names, places) = (names.join(", "), places.join(", "));
    let insert = format!("INSERT INTO {table} ({names}) VALUES ({places})");
    while let Some(values) = rows.next_row()? {
        let statement = query_of(insert.clone());
        let statement = values.into_iter().fold(statement, Statement::bind);
        statement.execute(&mut *transaction).await?;
    }
    Ok(rows.read)
}

fn head(row: &Row) -> Result<Vec<(String, Kind)>, sqlx::Error> {
    let kind = |(name, value)| {
        let kind = match value {
            Value::Text(_) => Kind::Text,
            Value::Integer(_) => Kind::Integer,
            Value::Real(_) => Kind::Real,
        };
        (name, kind)
    };
    Ok(row.columns()?.into_iter().map(kind).collect())
}

fn json(value: Value) -> Json {
    match value {
        Value::Text(text) => text.into(),
        Value::Integer(number) => number.into(),
        Value::Real(number) => number.into(),
    }
}

/// `None` for a value of another type.
fn value_of(json: Json, kind: Kind) -> Option<Value> {
    Some(match (kind, json) {
        (Kind::Text, Json::Null) => Value::Text(None),
        (Kind::Integer, Json::Null) => Value::Integer(None),
        (Kind::Real, Json::Null) => Value::Real(None),
        (Kind::Text, Json::String(text)) => Value::Text(Some(text)),
        (Kind::Integer, Json::Number(number)) => Value::Integer(Some(number.as_i64()?)),
        (Kind::Real, Json::Number(number)) => Value::Real(Some(number.as_f64()?)),
        _ => return None,
    })
}

fn write_line(out: &mut impl Write, line: &impl Serialize) -> Result<(), sqlx::Error> {
    let mut text = serde_json::to_vec(line).map_err(std::io::Error::from)?;
    text.push(b'\n');
    Ok(out.write_all(&text)?)
}

fn write_durably(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

fn unreadable(error: serde_json::Error) -> StoreError {
    StoreError::Export(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_blob_that_went_after_the_snapshot_ends_an_export_with_the_advice_to_repeat_it() {
        let folder = tempfile::TempDir::new().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let gone = sha256_hex(b"gone");
        let error = store.export_blobs(folder.path(), &[gone.clone()].into()).await.unwrap_err();
        let text = error.to_string();
        assert!(text.contains(&gone) && text.contains("export again"), "{text}");
    }
}
