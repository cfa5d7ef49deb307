//! Whose blobs these are: a store of blobs beside the data folder bears the identity of its database, so that no other one removes what
//! its own rows do not know.

use super::database::query;
use super::{Store, StoreError};

const IDENTITY: &str = "SELECT id FROM identity";
/// What a database has that ran beside its blobs, if only once.
const LIVED: &str = "SELECT 1 FROM seen_clock UNION ALL SELECT 1 FROM blobs UNION ALL SELECT 1 FROM unfinished_blobs \
     UNION ALL SELECT 1 FROM discarded_blobs LIMIT 1";
const MAKE: &str = "INSERT INTO identity (number, id) VALUES (1, $1) ON CONFLICT DO NOTHING";

/// The places of the meshes that were stored last.
const NEWEST: &str = "SELECT blobs.place FROM meshes JOIN blobs ON blobs.sha256 = meshes.blob \
     ORDER BY meshes.id DESC LIMIT 5";

/// How many of the newest meshes there are, and whether the bytes of one are.
pub(super) struct NewestMeshes {
    pub meshes: usize,
    pub is_there: bool,
}

impl Store {
    /// Refuses blobs that bear the mark of another database, and those that bear none and hold what this one does not know. The mark is
    /// made in a store that is empty as the database is, and beside the newest meshes of the database. In a data folder, which has
    /// one owner, only a new database beside old blobs is refused.
    pub async fn check_owner(&self) -> Result<(), StoreError> {
        let owner = self.blobs.owner().await?;
        if owner.is_none() && self.blobs.are_in_data() {
            return self.refuse_new_beside_blobs().await;
        }
        let identity = self.identity().await?;
        let foreign = |owner| StoreError::ForeignBlobs { owner, identity: identity.clone() };
        match owner {
            Some(owner) if owner == identity => {
                self.blobs.know_owner(&identity);
                return Ok(());
            }
            Some(owner) => return Err(foreign(format!("the mark of another database, {owner}"))),
            None => {}
        }
        let (newest, is_empty) = (self.newest().await?, self.blobs.is_empty().await?);
        // One that had its mark and is empty is not mounted.
        let is_new = is_empty && newest.meshes == 0 && !self.blobs.had_owner();
        if newest.is_there || is_new {
            self.blobs.set_owner(&identity).await?;
            self.blobs.know_owner(&identity);
            return Ok(());
        }
        // Another host may have stored its first mesh meanwhile.
        match self.blobs.owner().await? {
            Some(owner) if owner == identity => {
                self.blobs.know_owner(&identity);
                Ok(())
            }
            _ if is_empty => Err(foreign("nothing, as a disk that is not mounted".into())),
            _ => Err(foreign("bytes, and neither a mark nor the newest meshes of this one".into())),
        }
    }

    /// A database that nothing was ever stored through, where there are blobs, stands in the place of one that was lost.
    async fn refuse_new_beside_blobs(&self) -> Result<(), StoreError> {
        let lived = query(LIVED).fetch_optional(self.database.reader()).await?;
        if lived.is_some() || self.blobs.is_empty().await? {
            return Ok(());
        }
        let folder = self.folder.join("blobs");
        Err(StoreError::NewDatabase { database: self.database.place(), folder })
    }

    pub(super) async fn newest(&self) -> Result<NewestMeshes, StoreError> {
        let rows = query(NEWEST).fetch_all(self.database.reader()).await?;
        for row in &rows {
            if self.blobs.exists(&row.try_get::<String, _>(0)?).await? {
                return Ok(NewestMeshes { meshes: rows.len(), is_there: true });
            }
        }
        Ok(NewestMeshes { meshes: rows.len(), is_there: false })
    }

    /// Random, made once for each database; an export leaves it out.
    async fn identity(&self) -> Result<String, StoreError> {
        if let Some(row) = query(IDENTITY).fetch_optional(self.database.reader()).await? {
            return Ok(row.try_get(0)?);
        }
        let made = query(MAKE).bind(uuid::Uuid::now_v7().to_string());
        made.execute(&self.database.writer().await?).await?;
        let row = query(IDENTITY).fetch_one(self.database.reader()).await?;
        Ok(row.try_get(0)?)
    }
}
