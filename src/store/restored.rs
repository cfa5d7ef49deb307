//! Stored bytes of meshes that were lost or damaged, and are stored again.

use super::database::query;
use super::meshes::{NewMesh, mesh_row};
use super::{MeshRow, Store, StoreError};

/// Bytes that another version of the program wrote of the same file have another hash.
const RESTORE: &str = "UPDATE meshes SET blob = $2 WHERE id = $1 AND tenant = $3 \
     RETURNING id, sha256, blob, report, created";

impl Store {
    /// Whether the bytes of a hash are there. Of a folder they are compared with the hash; of a bucket, which would have to send
    /// them, it is looked only whether there are any.
    pub async fn has_blob(&self, sha256: &str) -> Result<bool, StoreError> {
        let found = match self.find_blob(sha256).await {
            Ok(found) if found.is_far() => return Ok(found.bytes() > 0),
            Ok(found) => self.file_of(found).await.map(drop),
            Err(error) => Err(error),
        };
        match found {
            Ok(()) => Ok(true),
            Err(StoreError::Missing { .. } | StoreError::Integrity { .. }) => Ok(false),
            // With what referred to them: the caller finds that out.
            Err(StoreError::Erased) => Ok(true),
            Err(error) => Err(error),
        }
    }

    /// Stores the bytes of a mesh again, as another upload of the same file has them; `None` where the mesh was deleted meanwhile.
    pub async fn restore_mesh(
        &self,
        id: &str,
        mesh: &NewMesh,
    ) -> Result<Option<MeshRow>, StoreError> {
        let lost = self.mesh(id).await?.map(|row| row.blob);
        let content = (mesh.blob.clone(), mesh.bytes.clone());
        let mut transaction = self.begin_with(vec![content]).await?;
        let restored = query(RESTORE).bind(id).bind(&mesh.blob).bind(self.tenant());
        let restored = restored.fetch_optional(&mut transaction).await?;
        let row = restored.as_ref().map(mesh_row).transpose()?;
        transaction.commit().await?;
        let is_kept = |blob: &String| row.as_ref().is_some_and(|row| row.blob == *blob);
        let unused = lost.into_iter().chain([mesh.blob.clone()]).filter(|blob| !is_kept(blob));
        self.discard(unused.collect()).await;
        Ok(row)
    }
}

#[cfg(test)]
mod tests {
    use bytes::Bytes;

    use super::*;
    use crate::schema::wire::canonical::sha256_hex;

    fn mesh(bytes: &'static [u8]) -> NewMesh {
        let mesh = NewMesh::example(&sha256_hex(bytes));
        NewMesh { sha256: "of the upload".to_owned(), bytes: Bytes::from_static(bytes), ..mesh }
    }

    #[tokio::test]
    async fn a_mesh_gets_the_bytes_that_are_written_of_its_file_today() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let (old, new) = (mesh(b"as it was written"), mesh(b"as it is written"));
        assert!(store.add_mesh(&old).await.unwrap());
        assert!(store.has_blob(&old.blob).await.unwrap());
        std::fs::remove_dir_all(folder.path().join("blobs").join(&old.blob[..2])).unwrap();
        assert!(!store.has_blob(&old.blob).await.unwrap());
        let row = store.restore_mesh(&old.id, &new).await.unwrap().unwrap();
        assert_eq!((&row.id, &row.blob), (&old.id, &new.blob));
        assert_eq!(store.read_blob(&new.blob).await.unwrap(), new.bytes);
        let findings = store.fsck(false).await.unwrap();
        assert!(findings.is_clean(), "{findings:?}");
    }

    #[tokio::test]
    async fn nothing_is_stored_for_a_mesh_that_was_deleted_meanwhile() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let mesh = mesh(b"mesh");
        assert!(store.restore_mesh(&mesh.id, &mesh).await.unwrap().is_none());
        let findings = store.fsck(false).await.unwrap();
        assert!(findings.is_clean() && findings.objects == 0, "{findings:?}");
    }
}
