//! Uploaded meshes: immutable, known by the hash of the bytes that came and by what was said about them.

use bytes::Bytes;

use super::database::{Row, Transaction, is_duplicate, is_reference, query};
use super::{Store, StoreError};

/// A mesh to be stored, with the bytes that our own writer made of it.
#[derive(Clone, Debug)]
pub struct NewMesh {
    pub id: String,
    /// Of the bytes as they came.
    pub sha256: String,
    /// What the upload said about them, as stable text: the same bytes in another unit are another mesh.
    pub options: String,
    pub blob: String,
    pub bytes: Bytes,
    /// False: it came with a case or from a job, and goes with it.
    pub standalone: bool,
    pub report: String,
}

#[cfg(test)]
impl NewMesh {
    /// An uploaded mesh whose bytes are said to have this hash.
    pub fn example(hash: &str) -> NewMesh {
        NewMesh {
            id: uuid::Uuid::now_v7().to_string(),
            sha256: hash.to_owned(),
            options: String::new(),
            blob: hash.to_owned(),
            bytes: Bytes::from_static(b"mesh"),
            standalone: true,
            report: "{}".to_owned(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct MeshRow {
    pub id: String,
    pub sha256: String,
    pub blob: String,
    pub report: String,
    /// When it was uploaded, or uploaded again.
    pub created: i64,
}

/// Outcome of a deletion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MeshDeletion {
    Deleted,
    InUse(MeshUsers),
    NotFound,
}

/// What refers to a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshUsers {
    pub count: i64,
    /// The first of them: what each is (`case`, `job` or `cohort`), and its id.
    pub first: Vec<(String, String)>,
}

/// Users of a mesh that are named.
const NAMED_USERS: i64 = 10;

const BY_ID: &str = "SELECT id, sha256, blob, report, created FROM meshes \
     WHERE id = $1 AND tenant = $2";
const BY_CONTENT: &str = "SELECT id, sha256, blob, report, created FROM meshes \
     WHERE sha256 = $1 AND options = $2 AND tenant = $3";
const INSERT: &str = "INSERT INTO meshes (id, sha256, options, blob, standalone, report, tenant, created) \
     VALUES ($1, $2, $3, $4, $5, $6, $7, (SELECT now_ms FROM age_clock))";

const KEEP: &str = "UPDATE meshes SET standalone = 1, created = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND tenant = $2 RETURNING id, sha256, blob, report, created";
const DELETE: &str = "DELETE FROM meshes WHERE id = $1 AND tenant = $2 \
     AND ($3 = 0 OR created < (SELECT now_ms FROM clock) - $3) RETURNING blob";

/// Each user once: a job may both read a mesh and have made it.
macro_rules! users {
    ($what:literal, $rest:literal) => {
        concat!(
            "SELECT ",
            $what,
            " FROM (SELECT 'case' AS kind, case_id AS id FROM case_meshes WHERE mesh_id = $1 \
               UNION SELECT 'job', job_id FROM job_meshes WHERE mesh_id = $1 \
               UNION SELECT 'job', job_id FROM made_meshes WHERE mesh_id = $1 \
               UNION SELECT 'cohort', cohort_id FROM cohort_members WHERE mesh_id = $1) AS users",
            $rest
        )
    };
}
const USERS: &str = users!("kind, id", " ORDER BY kind, id LIMIT $2");
const COUNT_USERS: &str = users!("COUNT(*)", "");

pub(super) fn mesh_row(row: &Row) -> Result<MeshRow, sqlx::Error> {
    Ok(MeshRow {
        id: row.try_get("id")?,
        sha256: row.try_get("sha256")?,
        blob: row.try_get("blob")?,
        report: row.try_get("report")?,
        created: row.try_get("created")?,
    })
}

impl Store {
    pub async fn mesh(&self, id: &str) -> Result<Option<MeshRow>, StoreError> {
        let row = query(BY_ID)
            .bind(id)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.as_ref().map(mesh_row).transpose()?)
    }

    /// The mesh that these bytes, so described, were stored as before.
    pub async fn mesh_by_content(
        &self,
        sha256: &str,
        options: &str,
    ) -> Result<Option<MeshRow>, StoreError> {
        let row = query(BY_CONTENT)
            .bind(sha256)
            .bind(self.own(options))
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.as_ref().map(mesh_row).transpose()?)
    }

    /// Stores a mesh; false when it was there before, by whichever request came first.
    pub async fn add_mesh(&self, mesh: &NewMesh) -> Result<bool, StoreError> {
        let mut transaction =
            self.begin_with(vec![(mesh.blob.clone(), mesh.bytes.clone())]).await?;
        match self.insert_mesh(&mut transaction, mesh).await {
            Ok(()) => {
                transaction.commit().await?;
                Ok(true)
            }
            Err(error) => {
                transaction.rollback().await;
                self.discard(vec![mesh.blob.clone()]).await;
                if is_duplicate(&error) { Ok(false) } else { Err(error.into()) }
            }
        }
    }

    /// Keeps a mesh that was uploaded again, although the case that it came with may go; its age counts from now. `None`
    /// where it went meanwhile.
    pub async fn keep_mesh(&self, id: &str) -> Result<Option<MeshRow>, StoreError> {
        let mut transaction = self.database.begin().await?;
        let kept = query(KEEP).bind(id).bind(self.tenant());
        let kept = kept.fetch_optional(&mut transaction).await?;
        transaction.commit().await?;
        Ok(kept.as_ref().map(mesh_row).transpose()?)
    }

    /// Deletes a mesh that no case and no job refers to, and its bytes.
    pub async fn delete_mesh(&self, id: &str) -> Result<MeshDeletion, StoreError> {
        self.delete_mesh_of_age(id, 0).await
    }

    /// The same where nobody has uploaded it for `age`, in ms.
    pub(super) async fn delete_mesh_of_age(
        &self,
        id: &str,
        age: i64,
    ) -> Result<MeshDeletion, StoreError> {
        let mut transaction = self.database.begin().await?;
        let deleted = query(DELETE)
            .bind(id)
            .bind(self.tenant())
            .bind(age)
            .fetch_optional(&mut transaction)
            .await;
        match deleted {
            Ok(None) => Ok(MeshDeletion::NotFound),
            Ok(Some(row)) => {
                self.insert_tombstone(&mut transaction, id).await?;
                transaction.commit().await?;
                self.mark_erased();
                self.discard(vec![row.try_get("blob")?]).await;
                Ok(MeshDeletion::Deleted)
            }
            Err(error) if is_reference(&error) => {
                transaction.rollback().await;
                Ok(MeshDeletion::InUse(self.mesh_users(id).await?))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// What refers to a mesh now; nothing where it went meanwhile.
    async fn mesh_users(&self, id: &str) -> Result<MeshUsers, StoreError> {
        let reader = self.database.reader();
        let count = query(COUNT_USERS).bind(id).fetch_one(reader).await?.try_get(0)?;
        let rows = query(USERS).bind(id).bind(NAMED_USERS).fetch_all(reader).await?;
        let user = |row: &Row| Ok((row.try_get("kind")?, row.try_get("id")?));
        let first: Result<_, sqlx::Error> = rows.iter().map(user).collect();
        Ok(MeshUsers { count, first: first? })
    }

    pub(super) async fn insert_mesh(
        &self,
        transaction: &mut Transaction,
        mesh: &NewMesh,
    ) -> Result<(), sqlx::Error> {
        query(INSERT)
            .bind(&mesh.id)
            .bind(&mesh.sha256)
            .bind(self.own(&mesh.options))
            .bind(&mesh.blob)
            .bind(i64::from(mesh.standalone))
            .bind(&mesh.report)
            .bind(self.tenant())
            .execute(&mut *transaction)
            .await?;
        Ok(())
    }
}
