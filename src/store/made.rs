//! Meshes made by jobs: stored with the result, and erased with the job or its case unless something else refers to
//! them.

use super::database::{Transaction, is_duplicate, query};
use super::meshes::{MeshRow, NewMesh};
use super::referred::ReferredRows;
use super::{Store, StoreError};

/// A mesh that a job made, to be stored with its result.
#[derive(Clone, Debug)]
pub struct MadeMesh {
    pub mesh: NewMesh,
    /// The same content, so described, where it was stored before.
    pub known: Option<MeshRow>,
}

const KNOWN: &str = "SELECT id FROM meshes WHERE id = $1 AND tenant = $2";
const REFER: &str =
    "INSERT INTO made_meshes (job_id, mesh_id) VALUES ($1, $2) ON CONFLICT DO NOTHING";
/// Locked, so that a request which is about to refer to one of them has either done so or finds it gone.
const MESHES_OF_JOB: &str = "SELECT id FROM meshes \
     WHERE id IN (SELECT mesh_id FROM made_meshes WHERE job_id = $1 \
       UNION SELECT mesh_id FROM job_meshes WHERE job_id = $1 \
       UNION SELECT mesh_id FROM cohort_members WHERE job_id = $1) ORDER BY id FOR UPDATE";
const DELETE_UNUSED: &str = "DELETE FROM meshes WHERE id = $1 AND standalone = 0 \
     AND NOT EXISTS (SELECT 1 FROM case_meshes WHERE mesh_id = $1) \
     AND NOT EXISTS (SELECT 1 FROM job_meshes WHERE mesh_id = $1) \
     AND NOT EXISTS (SELECT 1 FROM cohort_members WHERE mesh_id = $1) \
     AND NOT EXISTS (SELECT 1 FROM made_meshes WHERE mesh_id = $1) RETURNING blob";

impl MadeMesh {
    /// The id under which it is stored.
    pub fn id(&self) -> &str {
        self.known.as_ref().map_or(&self.mesh.id, |row| &row.id)
    }

    /// Whether its bytes are those that its row refers to; an earlier program may have written others.
    pub(super) fn is_as_stored(&self) -> bool {
        self.known.as_ref().is_none_or(|row| row.blob == self.mesh.blob)
    }
}

impl Store {
    /// Stores the meshes of a job and holds those that were there, with the `others` that are about to be referred to; `Contended`, for
    /// a retry, where one of them was stored or erased meanwhile.
    pub(super) async fn insert_made(
        &self,
        transaction: &mut Transaction,
        job: &str,
        made: &[MadeMesh],
        others: &[String],
    ) -> Result<(), StoreError> {
        // First, while nothing is held that who removes the same content may wait for.
        for made in made.iter().filter(|made| made.known.is_none()) {
            self.insert_mesh(transaction, &made.mesh).await.map_err(contended)?;
        }
        let meshes = made.iter().map(MadeMesh::id).chain(others.iter().map(String::as_str));
        ReferredRows { meshes: meshes.collect(), ..ReferredRows::default() }
            .hold(transaction)
            .await?;
        for made in made {
            if let Some(row) = &made.known {
                self.require_stored(transaction, row).await?;
            }
            query(REFER).bind(job).bind(made.id()).execute(&mut *transaction).await?;
        }
        Ok(())
    }

    async fn require_stored(
        &self,
        transaction: &mut Transaction,
        row: &MeshRow,
    ) -> Result<(), StoreError> {
        let found = query(KNOWN)
            .bind(&row.id)
            .bind(self.tenant())
            .fetch_optional(&mut *transaction)
            .await?;
        found.map(drop).ok_or(StoreError::Contended)
    }

    /// Removes those of the given meshes that came with something which is gone, and that nothing refers to. Their blobs.
    pub(super) async fn remove_unused(
        &self,
        transaction: &mut Transaction,
        meshes: Vec<String>,
    ) -> Result<Vec<String>, sqlx::Error> {
        let mut blobs = Vec::new();
        for mesh in meshes {
            let unused = column(transaction, DELETE_UNUSED, &mesh).await?;
            if !unused.is_empty() {
                self.insert_tombstone(transaction, &mesh).await?;
            }
            blobs.extend(unused);
        }
        Ok(blobs)
    }
}

fn contended(error: sqlx::Error) -> StoreError {
    if is_duplicate(&error) { StoreError::Contended } else { error.into() }
}

/// The meshes that a job made, those that it reads, and those that leave a cohort with it: when it goes, it may be the last that refers to them.
pub(super) async fn meshes_of_job(
    transaction: &mut Transaction,
    job: &str,
) -> Result<Vec<String>, sqlx::Error> {
    column(transaction, MESHES_OF_JOB, job).await
}

/// The first column of a query with one parameter.
pub(super) async fn column(
    transaction: &mut Transaction,
    sql: &'static str,
    id: &str,
) -> Result<Vec<String>, sqlx::Error> {
    let rows = query(sql).bind(id).fetch_all(&mut *transaction).await?;
    rows.iter().map(|row| row.try_get(0)).collect()
}
