//! Consistency check and repair of rows and bytes, after a restore from a backup or a fault of a disk.

use std::collections::{BTreeMap, BTreeSet};

use bytes::Bytes;

use super::database::{Row, query};
use super::events::record;
use super::references::new_place;
use super::sweep::PATIENCE;
use super::{Store, StoreError};

const PLACES: &str = "SELECT sha256, place FROM blobs";
const REFERENCES: &str = "SELECT blob, 'mesh' AS kind, id FROM meshes \
     UNION ALL SELECT DISTINCT blob, 'job' AS kind, job_id FROM job_files \
     UNION ALL SELECT meshes.blob, 'job' AS kind, made_meshes.job_id FROM made_meshes \
       JOIN meshes ON meshes.id = made_meshes.mesh_id";
/// Meshes that came with a case or from a job, and that nothing refers to any more: they are on no list, and no erasure
/// finds them.
const UNREACHED: &str = "SELECT id, tenant FROM meshes WHERE standalone = 0 \
     AND NOT EXISTS (SELECT 1 FROM case_meshes WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM job_meshes WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM cohort_members WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM made_meshes WHERE mesh_id = meshes.id) ORDER BY id";
/// Places that are about to be referred to, or removed.
const IN_MOTION: &str =
    "SELECT place FROM unfinished_blobs UNION SELECT place FROM discarded_blobs";
const MOVE: &str = "INSERT INTO blobs (sha256, place, announced) \
     VALUES ($1, $2, (SELECT now_ms FROM clock)) \
     ON CONFLICT (sha256) DO UPDATE SET place = excluded.place";
const RUN_AGAIN: &str = "UPDATE jobs SET status = 'accepted', result = NULL, progress = 0, losses = 0, \
     claimable_from = 0, finished = NULL, updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND status = 'successful'";

/// Inconsistencies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// Places that hold bytes.
    pub objects: usize,
    /// Bytes that rows refer to and that are lost or damaged.
    pub dangling: Vec<Dangling>,
    /// Places with bytes that no row knows.
    pub orphans: Vec<String>,
    /// Meshes of what was erased, which no case and no job refers to.
    pub unreached: Vec<Unreached>,
}

/// A mesh that nothing leads to, and whose it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreached {
    pub mesh: String,
    pub tenant: String,
}

/// Bytes that are lost or damaged, and who refers to them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dangling {
    pub sha256: String,
    pub meshes: Vec<String>,
    pub jobs: Vec<String>,
}

/// Repairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repaired {
    /// Bytes that were found again among those that no row knew.
    pub found_again: usize,
    /// Jobs whose files are lost, and that are to be solved again.
    pub jobs: usize,
    /// Places that no row knew and that are empty by now.
    pub removed: usize,
    /// Meshes that nothing led to and that are erased.
    pub erased: usize,
}

impl Findings {
    pub fn is_clean(&self) -> bool {
        self.dangling.is_empty() && self.orphans.is_empty() && self.unreached.is_empty()
    }
}

impl Store {
    /// Compares rows with bytes; with `read_all` the bytes with their hashes too. All rows are
    /// read before them then, and a damaged one is an error.
    pub async fn fsck(&self, read_all: bool) -> Result<Findings, StoreError> {
        if read_all {
            self.check_all_rows().await?;
        }
        // Places come first: bytes are stored after their row, so each of these has its row by now.
        let objects: BTreeSet<String> = self.blobs.list().await?.into_iter().collect();
        let places = self.places().await?;
        let mut known: BTreeSet<String> = places.values().cloned().collect();
        for row in query(IN_MOTION).fetch_all(self.database.reader()).await? {
            known.insert(row.try_get(0)?);
        }
        let mut dangling = Vec::new();
        for (sha256, referring) in self.referring().await? {
            let intact = match places.get(&sha256) {
                Some(place) if read_all => self.is_intact(place, &sha256).await?,
                Some(place) => objects.contains(place) || self.blobs.exists(place).await?,
                None => false,
            };
            if !intact {
                dangling.push(referring);
            }
        }
        let orphans = objects.difference(&known).cloned().collect();
        let unreached = self.unreached().await?;
        Ok(Findings { objects: objects.len(), dangling, orphans, unreached })
    }

    /// Looks for lost bytes among those that no row knows, has jobs with lost files or meshes solved again, and
    /// removes what is left over, and the meshes that nothing leads to. Other meshes that are lost stay so: only an upload or a backup has them.
    pub async fn repair(&self, findings: &Findings) -> Result<Repaired, StoreError> {
        let mut repaired = Repaired::default();
        for lost in &findings.dangling {
            if self.find_again(&lost.sha256, &findings.orphans).await? {
                repaired.found_again += 1;
                continue;
            }
            for job in &lost.jobs {
                repaired.jobs += usize::from(self.run_again(job).await?);
            }
        }
        for place in &findings.orphans {
            self.blobs.delete(place).await?;
            repaired.removed += 1;
        }
        for Unreached { mesh, tenant } in &findings.unreached {
            repaired.erased +=
                usize::from(self.of_tenant(tenant).erase_if_unreferenced(mesh).await?);
        }
        self.sweep_blobs(PATIENCE).await?;
        Ok(repaired)
    }

    async fn unreached(&self) -> Result<Vec<Unreached>, StoreError> {
        let rows = query(UNREACHED).fetch_all(self.database.reader()).await?;
        let unreached =
            |row: &Row| Ok(Unreached { mesh: row.try_get("id")?, tenant: row.try_get("tenant")? });
        rows.iter().map(unreached).collect()
    }

    /// Erases a mesh unless something refers to it by now.
    async fn erase_if_unreferenced(&self, mesh: &str) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        let blobs = self.remove_unused(&mut transaction, vec![mesh.to_owned()]).await?;
        transaction.commit().await?;
        self.mark_erased();
        let is_erased = !blobs.is_empty();
        self.discard(blobs).await;
        Ok(is_erased)
    }

    async fn places(&self) -> Result<BTreeMap<String, String>, StoreError> {
        let rows = query(PLACES).fetch_all(self.database.reader()).await?;
        rows.iter().map(|row| Ok((row.try_get(0)?, row.try_get(1)?))).collect()
    }

    async fn referring(&self) -> Result<BTreeMap<String, Dangling>, StoreError> {
        let mut all: BTreeMap<String, Dangling> = BTreeMap::new();
        for row in query(REFERENCES).fetch_all(self.database.reader()).await? {
            let sha256: String = row.try_get(0)?;
            let referring = all.entry(sha256.clone()).or_default();
            referring.sha256 = sha256;
            match row.try_get::<String, _>(1)?.as_str() {
                "mesh" => referring.meshes.push(row.try_get(2)?),
                _ => referring.jobs.push(row.try_get(2)?),
            }
        }
        Ok(all)
    }

    async fn is_intact(&self, place: &str, sha256: &str) -> Result<bool, StoreError> {
        Ok(self.intact(place, sha256).await?.is_some())
    }

    /// The bytes of a place, if they have this hash.
    async fn intact(&self, place: &str, sha256: &str) -> Result<Option<Bytes>, StoreError> {
        match self.blobs.get(place, sha256).await {
            Ok(bytes) => Ok(Some(bytes)),
            Err(StoreError::Missing { .. } | StoreError::Integrity { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Brings bytes that no row knows to a new place of the row that misses them.
    async fn find_again(&self, sha256: &str, orphans: &[String]) -> Result<bool, StoreError> {
        for orphan in orphans.iter().filter(|place| place.contains(sha256)) {
            if let Some(bytes) = self.intact(orphan, sha256).await? {
                let place = new_place(sha256);
                self.blobs.put(&place, bytes).await?;
                query(MOVE)
                    .bind(sha256)
                    .bind(&place)
                    .execute(&self.database.writer().await?)
                    .await?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Accepts a successful job once more; false when it is not there or accepted already.
    async fn run_again(&self, job: &str) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        let accepted = query(RUN_AGAIN).bind(job).execute(&mut transaction).await?;
        if accepted == 1 {
            let files = "DELETE FROM job_files WHERE job_id = $1";
            query(files).bind(job).execute(&mut transaction).await?;
            record(&mut transaction, job).await?;
        }
        transaction.commit().await?;
        self.job_changed(job);
        Ok(accepted == 1)
    }
}
