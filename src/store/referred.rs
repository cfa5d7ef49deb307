//! What a transaction is about to refer to, locked in the order of all locks (see the head of the store): it stays until the end of
//! the transaction, or is gone by now, which its reference tells.

use std::collections::BTreeSet;

use super::database::{Transaction, query};

/// Ids of rows, of each table.
#[derive(Default)]
pub(super) struct ReferredRows<'a> {
    pub cases: BTreeSet<&'a str>,
    pub jobs: BTreeSet<&'a str>,
    pub meshes: BTreeSet<&'a str>,
}

const CASE: &str = "SELECT 1 FROM cases WHERE id = $1 FOR KEY SHARE";
const JOB: &str = "SELECT 1 FROM jobs WHERE id = $1 FOR KEY SHARE";
const MESH: &str = "SELECT 1 FROM meshes WHERE id = $1 FOR KEY SHARE";

impl ReferredRows<'_> {
    pub async fn hold(&self, transaction: &mut Transaction) -> Result<(), sqlx::Error> {
        let ReferredRows { cases, jobs, meshes } = self;
        for (sql, ids) in [(CASE, cases), (JOB, jobs), (MESH, meshes)] {
            for id in ids {
                query(sql).bind(id).fetch_optional(&mut *transaction).await?;
            }
        }
        Ok(())
    }
}
