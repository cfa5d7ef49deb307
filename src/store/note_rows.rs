//! Rows of audited actions: inserted before the action begins, completed with its outcome.

use super::StoreError;
use super::audited_action::AuditedAction;
use super::database::{Transaction, query};
use super::open_actions::{End, Open};

const BEGIN: &str = "INSERT INTO deeds (id, at, alive, tenant, actor, action, object, request) \
     VALUES ($1, (SELECT now_ms FROM clock), (SELECT now_ms FROM clock), $2, $3, $4, $5, $6) RETURNING at";
const END: &str = "UPDATE deeds SET object = $2, outcome = $3 WHERE id = $1";
/// Of an audited action that has no row: it was over before it was noted, or its row was lost or is in the chain.
const WHOLE: &str = "INSERT INTO deeds (id, at, alive, tenant, actor, action, object, request, outcome) \
     VALUES ($1, COALESCE($2, (SELECT now_ms FROM clock)), (SELECT now_ms FROM clock), $3, $4, $5, $6, $7, $8) \
     ON CONFLICT (id) DO UPDATE SET outcome = excluded.outcome";
/// Told again, its end stands among the last rows of the chain or nowhere.
const CHAINED: &str = "SELECT 1 FROM audit \
     WHERE number > (SELECT number FROM audit_end WHERE one = 1) - 100000 AND tenant = $1 AND actor = $2 \
     AND action = $3 AND object = $4 AND request = $5 AND outcome = $6 AND at = COALESCE($7, at) LIMIT 1";

/// Makes the row of an audited action; when it begins, by the clock of the database.
pub(super) async fn begin(
    transaction: &mut Transaction,
    id: &str,
    audited: &AuditedAction,
) -> Result<i64, StoreError> {
    let row =
        query(BEGIN).bind(id).bind(&audited.tenant).bind(&audited.actor).bind(&audited.action);
    let row = row.bind(&audited.object).bind(&audited.request).fetch_one(transaction).await?;
    Ok(row.try_get("at")?)
}

/// Says in the row of an audited action how it ended, once however often it is said.
pub(super) async fn end(
    transaction: &mut Transaction,
    id: &str,
    open: &Open,
    end: &End,
) -> Result<(), StoreError> {
    let has_begun = open.at.is_some();
    if has_begun {
        let row = query(END).bind(id).bind(&end.object).bind(&end.outcome);
        if row.execute(&mut *transaction).await? > 0 {
            return Ok(());
        }
    }
    if (has_begun || open.was_told) && is_chained(transaction, open, end).await? {
        return Ok(());
    }
    if has_begun {
        // It is in the chain as unknown, or a crash took it: how it ended becomes a row of its own.
        tracing::error!(request = %open.audited.request, "an audited action has no row for its outcome");
    }
    let AuditedAction { tenant, actor, action, request, .. } = &open.audited;
    let row = query(WHOLE).bind(id).bind(open.at).bind(tenant).bind(actor).bind(action);
    row.bind(&end.object).bind(request).bind(&end.outcome).execute(transaction).await?;
    Ok(())
}

async fn is_chained(
    transaction: &mut Transaction,
    open: &Open,
    end: &End,
) -> Result<bool, StoreError> {
    let AuditedAction { tenant, actor, action, request, .. } = &open.audited;
    let row = query(CHAINED).bind(tenant).bind(actor).bind(action).bind(&end.object);
    let row = row.bind(request).bind(&end.outcome).bind(open.at).fetch_optional(transaction);
    Ok(row.await?.is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Store;

    /// As where the database crashed after it had taken an end and before anybody heard of it.
    #[tokio::test]
    async fn an_end_that_is_reported_again_is_in_the_log_once() {
        let folder = tempfile::TempDir::new().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let audited = AuditedAction { action: "posted".into(), ..AuditedAction::default() };
        let told = End { object: "job".into(), outcome: "201".into() };
        let mut open = Open { audited, at: None, end: None, was_told: false };
        let mut transaction = store.database.begin().await.unwrap();
        open.at = Some(begin(&mut transaction, "one", &open.audited).await.unwrap());
        transaction.commit().await.unwrap();
        for _ in 0..2 {
            let mut transaction = store.database.begin().await.unwrap();
            end(&mut transaction, "one", &open, &told).await.unwrap();
            transaction.commit().await.unwrap();
            let rows = store.audit(0, "", 10).await.unwrap();
            assert_eq!((rows.len(), rows[0].outcome.as_str()), (1, "201"));
            open.was_told = true;
        }
    }
}
