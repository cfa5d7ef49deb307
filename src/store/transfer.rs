//! Export and import of a whole deployment, for another engine or as a backup: a file of rows for each table, a file
//! for each blob, and a manifest, which is written last and read first.
//!
//! Where bytes are is a deployment's own affair: places are left out, and made anew by the import.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::DirBuilder;
use std::io::Read;
use std::os::unix::fs::DirBuilderExt;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::database::{Transaction, newest_step, query, query_of};
use super::exported_files::{at, open_plain, read_exported, write_durably};
use super::exported_rows::{ExportedRows, export_table, import_table};
use super::references::{Content, hold};
use super::{Store, StoreError};

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
/// Rows that belong together, and so to one tenant: the table that says so, and its columns with what they refer to.
const OF_ONE_TENANT: [(&str, [(&str, &str); 2]); 8] = [
    ("case_meshes", [("case_id", "cases"), ("mesh_id", "meshes")]),
    ("jobs", [("id", "jobs"), ("case_id", "cases")]),
    ("job_cases", [("job_id", "jobs"), ("case_id", "cases")]),
    ("job_meshes", [("job_id", "jobs"), ("mesh_id", "meshes")]),
    ("made_meshes", [("job_id", "jobs"), ("mesh_id", "meshes")]),
    ("cohort_members", [("cohort_id", "cohorts"), ("case_id", "cases")]),
    ("cohort_members", [("cohort_id", "cohorts"), ("job_id", "jobs")]),
    ("cohort_members", [("cohort_id", "cohorts"), ("mesh_id", "meshes")]),
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
#[serde(expecting = "an object with `schema`, `rows` and `blobs`")]
struct Manifest {
    /// The schema step of the rows.
    schema: i64,
    rows: BTreeMap<String, usize>,
    blobs: BTreeSet<String>,
}

impl Store {
    /// Reads every page of an embedded database; an error where one is damaged. To be done before rows are trusted.
    pub async fn check_pages(&self) -> Result<(), StoreError> {
        let found = self.database.faults().await?;
        match found.is_empty() {
            true => Ok(()),
            false => Err(StoreError::Damaged { place: self.database.place(), found }),
        }
    }

    /// Writes everything into a new folder, as it is at this moment. What an import would refuse is refused, and has no manifest.
    pub async fn export(&self, folder: &Path) -> Result<TransferCounts, StoreError> {
        let damaged = |error| self.damaged_row(error, folder);
        let manifest = self.export_rows(folder).await.map_err(damaged)?;
        std::fs::create_dir(folder.join("blobs"))?;
        let sizes = self.export_blobs(folder, &manifest.blobs).await?;
        self.check_rows(folder, &manifest, Some(&sizes)).await.map_err(damaged)?;
        let text = serde_json::to_vec_pretty(&manifest).map_err(std::io::Error::from)?;
        write_durably(&folder.join(MANIFEST), &text)?;
        Ok(TransferCounts { rows: manifest.rows.values().sum(), blobs: manifest.blobs.len() })
    }

    /// Reads all rows; an error at one that an export could not write or an import would refuse, apart from its blob.
    pub(super) async fn check_all_rows(&self) -> Result<(), StoreError> {
        let temporary = tempfile::TempDir::new_in(self.folder.join("tmp"))?;
        let folder = temporary.path().join("rows");
        let damaged = |error| self.damaged_row(error, &folder);
        let manifest = self.export_rows(&folder).await.map_err(damaged)?;
        self.check_rows(&folder, &manifest, None).await.map_err(damaged)
    }

    /// The error of a row, without the folder of its file; other errors stay as they are.
    fn damaged_row(&self, error: StoreError, folder: &Path) -> StoreError {
        let row = match error {
            StoreError::Export(text) => text.replace(&format!("{}/", folder.display()), ""),
            StoreError::Database(sqlx::Error::ColumnDecode { index, source }) => {
                format!("column {index} cannot be read: {source}")
            }
            other => return other,
        };
        StoreError::Damaged { place: self.database.place(), found: vec![row] }
    }

    /// Writes the rows into a new folder.
    async fn export_rows(&self, folder: &Path) -> Result<Manifest, StoreError> {
        // They hold faces of patients.
        DirBuilder::new()
            .mode(0o700)
            .create(folder)
            .map_err(at(folder, "it has to be a new folder"))?;
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
        Ok(manifest)
    }

    /// After the snapshot has ended, which must not last as long as they take. Returns their sizes.
    async fn export_blobs(
        &self,
        folder: &Path,
        blobs: &BTreeSet<String>,
    ) -> Result<BTreeMap<String, u64>, StoreError> {
        let mut sizes = BTreeMap::new();
        for sha256 in blobs {
            let bytes = self.read_blob(sha256).await.map_err(|error| match error {
                StoreError::Erased => StoreError::ErasedDuringExport { sha256: sha256.clone() },
                other => other,
            })?;
            write_durably(&folder.join("blobs").join(sha256), &bytes)?;
            sizes.insert(sha256.clone(), bytes.len() as u64);
        }
        Ok(sizes)
    }

    /// Takes in what was exported, all of it or nothing. Only into a deployment in which there is nothing.
    pub async fn import(&self, folder: &Path) -> Result<TransferCounts, StoreError> {
        let file = folder.join(MANIFEST);
        let mut text = Vec::new();
        let mut opened = open_plain(&file, "it has to be what `admin export` wrote")?;
        opened.read_to_end(&mut text)?;
        let manifest: Manifest = serde_json::from_slice(&text)
            .map_err(|error| StoreError::Export(format!("{}: {error}", file.display())))?;
        if manifest.schema != newest_step() {
            let (found, known) = (manifest.schema, newest_step());
            let detail = format!("it is of schema step {found}, and this program of step {known}");
            return Err(StoreError::Export(detail));
        }
        self.refuse_unless_empty().await?;
        // All of it before anything is stored.
        let blobs = check_blobs(folder, &manifest)?;
        self.check_rows(folder, &manifest, Some(&blobs)).await?;
        let mut stored = Vec::with_capacity(manifest.blobs.len());
        for sha256 in &manifest.blobs {
            let content: Content = (sha256.clone(), read_exported(folder, sha256)?.into());
            stored.extend(self.put(&[content]).await?);
        }
        let mut transaction = self.database.begin().await?;
        if !hold(&mut transaction, &stored).await? {
            return Err(StoreError::Contended);
        }
        match import_tables(&mut transaction, folder).await {
            Ok(rows) => {
                transaction.commit().await?;
                Ok(TransferCounts { rows, blobs: stored.len() })
            }
            Err(error) => {
                transaction.rollback().await;
                self.discard(manifest.blobs.into_iter().collect()).await;
                Err(error)
            }
        }
    }

    /// Looks at all rows that a manifest names, and at what they say of their blobs if the sizes of these are known.
    async fn check_rows(
        &self,
        folder: &Path,
        manifest: &Manifest,
        blobs: Option<&BTreeMap<String, u64>>,
    ) -> Result<(), StoreError> {
        for table in TABLES {
            let columns = self.database.columns(table).await?;
            let rows = ExportedRows::open(folder, table)?;
            let found = rows.map_or(Ok(0), |rows| rows.check(&columns, self.reads_input, blobs))?;
            check_count(folder, table, found, manifest.rows.get(table).copied())?;
        }
        Ok(())
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

/// The sizes of the blobs that a manifest names, each of which is read.
fn check_blobs(folder: &Path, manifest: &Manifest) -> Result<BTreeMap<String, u64>, StoreError> {
    let is_hash = |blob: &str| {
        blob.len() == 64 && blob.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
    };
    if let Some(strange) = manifest.blobs.iter().find(|blob| !is_hash(blob)) {
        return Err(StoreError::Export(format!("{MANIFEST}: {strange:?} is no hash of a blob")));
    }
    let size = |sha256: &String| Ok((sha256.clone(), read_exported(folder, sha256)?.len() as u64));
    manifest.blobs.iter().map(size).collect()
}

/// Refuses another number of rows than the manifest says.
fn check_count(
    folder: &Path,
    table: &str,
    found: usize,
    declared: Option<usize>,
) -> Result<(), StoreError> {
    let file = folder.join(format!("{table}.ndjson"));
    let file = file.display();
    let Some(declared) = declared else {
        let detail = format!("{MANIFEST} does not say how many rows {file} has");
        return Err(StoreError::Export(detail));
    };
    match found.cmp(&declared) {
        Ordering::Equal => Ok(()),
        Ordering::Less => Err(StoreError::Export(format!(
            "{file} is cut short: it has {found} rows, and the manifest says {declared}"
        ))),
        Ordering::Greater => ExportedRows::open(folder, table)?
            .map_or(Ok(()), |rows| Err(rows.surplus(found, declared))),
    }
}

/// Refuses rows that belong together, of two tenants.
async fn check_tenants(transaction: &mut Transaction, folder: &Path) -> Result<(), StoreError> {
    for (table, [(one, of), (other, others)]) in OF_ONE_TENANT {
        let first = query_of(format!(
            "SELECT a.id, a.tenant, b.id, b.tenant FROM {table} AS tied JOIN {of} AS a ON a.id = tied.{one} \
             JOIN {others} AS b ON b.id = tied.{other} WHERE a.tenant <> b.tenant ORDER BY a.id, b.id LIMIT 1"
        ));
        let found = first.without_timeout().fetch_optional(&mut *transaction).await?;
        let Some(row) = found else { continue };
        let text = |place: usize| row.try_get::<String, _>(place);
        let (id, tenant, other_id, other_tenant) = (text(0)?, text(1)?, text(2)?, text(3)?);
        // Either may have the wrong tenant, and neither may be meant.
        let place = ExportedRows::place_of(folder, of, &id)?;
        let other_place = ExportedRows::place_of(folder, others, &other_id)?;
        return Err(StoreError::Export(format!(
            "{place}: {id} is of tenant {tenant:?}, and {other_place}: {other_id} of {other_tenant:?}; by {table}.ndjson they belong \
             together"
        )));
    }
    Ok(())
}

async fn import_tables(transaction: &mut Transaction, folder: &Path) -> Result<usize, StoreError> {
    let mut rows = 0;
    for table in TABLES {
        rows += import_table(transaction, table, folder).await?;
    }
    check_tenants(transaction, folder).await?;
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::key::{KeyDocument, Scope};
    use crate::schema::wire::canonical::sha256_hex;

    #[tokio::test]
    async fn what_cannot_be_read_of_an_export_is_named_by_its_file_and_line() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to, export] = ["from", "to", "export"].map(|name| folder.path().join(name));
        let (store, empty) = (Store::open(&from).await.unwrap(), Store::open(&to).await.unwrap());
        let label = "test".to_owned();
        let key = KeyDocument { label, scopes: [Scope::Read].into(), days: None };
        store.make_key(&key).await.unwrap();
        store.export(&export).await.unwrap();
        let keys = std::fs::read_to_string(export.join("keys.ndjson")).unwrap();
        let (head, row) = keys.trim_end().split_once('\n').unwrap();
        let twice = format!("{head}\n{row}\n{row}\n");
        let another = format!("{head}\n{row}\n{}\n", row.replace("test", "tests"));
        let faults: [(&str, &[u8], &str); 9] = [
            ("export.json", b"{}", ": missing field `schema` at line 1 column 2"),
            ("export.json", b"5", ", expected an object with `schema`, `rows` and `blobs`"),
            ("keys.ndjson", b"{}\n", ", line 1: missing field `columns` at column 2"),
            ("keys.ndjson", b"[]\n", ", line 1: invalid length 0, expected an object with"),
            ("keys.ndjson", b"\xff\n", ", line 1: stream did not contain valid UTF-8"),
            ("keys.ndjson", &[head.as_bytes(), b"\n[1,\n"].concat(), ", line 2 (row 1): EOF"),
            (
                "keys.ndjson",
                head.as_bytes(),
                " is cut short: it has 0 rows, and the manifest says 1",
            ),
            (
                "keys.ndjson",
                twice.as_bytes(),
                ", line 3 (row 2): it repeats line 2: the file has 2 ",
            ),
            (
                "keys.ndjson",
                another.as_bytes(),
                " is longer than what was exported: the file has 2 ",
            ),
        ];
        for (name, text, wanted) in faults {
            let file = export.join(name);
            let whole = std::fs::read(&file).unwrap();
            std::fs::write(&file, text).unwrap();
            let told = empty.import(&export).await.unwrap_err().to_string();
            let place = file.display().to_string();
            assert!(told.contains(&place) && told.contains(wanted), "{wanted:?}: {told}");
            assert!(!told.contains("struct"), "{told}");
            std::fs::write(&file, whole).unwrap();
        }
        for name in ["export.json", "keys.ndjson"] {
            let file = export.join(name);
            let moved = folder.path().join("moved");
            std::fs::rename(&file, &moved).unwrap();
            std::fs::create_dir(&file).unwrap();
            let told = empty.import(&export).await.unwrap_err().to_string();
            assert!(told.contains(&format!("{} is no plain file", file.display())), "{told}");
            std::fs::remove_dir(&file).unwrap();
            std::fs::rename(&moved, &file).unwrap();
        }
        empty.import(&export).await.unwrap();
    }

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
