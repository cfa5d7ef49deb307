//! Cases whose mesh a job makes, and the jobs that wait for it: completed, or failed with it, in the transaction in
//! which that job ends.

use serde_json::{Value, json};

use super::database::{Row, Transaction, query};
use crate::schema::ErrorCode;
use crate::schema::job::JobErrorDocument;

/// A case whose mesh was made.
#[derive(Clone, Debug)]
pub struct MeshedCase {
    pub document: String,
    /// The counts of its check, JSON.
    pub report: String,
    /// All meshes that the document refers to.
    pub mesh_ids: Vec<String>,
}

/// Locked before its jobs, as by an erasure.
const LOCK: &str = "SELECT 1 FROM cases WHERE meshing = $1 FOR UPDATE";
const LOCK_OVERDUE: &str = "SELECT 1 FROM cases WHERE meshing IN \
     (SELECT id FROM jobs WHERE status = 'running' AND lease_expires < $1) ORDER BY id FOR UPDATE";
const COMPLETE: &str = "UPDATE cases SET document = $2, report = $3, version = version + 1, \
     updated = (SELECT now_ms FROM age_clock) WHERE meshing = $1 RETURNING id";
const GO_ON: &str = "UPDATE jobs SET waits_for = '' WHERE case_id = $1 AND waits_for = $2";
/// A meshing of a case that has ended and made no mesh.
const WITHOUT: &str = "SELECT cases.id, jobs.status, jobs.error FROM cases JOIN jobs ON jobs.id = cases.meshing \
     WHERE cases.meshing = $1 AND jobs.status IN ('failed', 'dismissed')";
const FAIL: &str = "UPDATE jobs SET status = 'failed', error = $3, error_class = $4, \
     finished = (SELECT now_ms FROM clock), updated = (SELECT now_ms FROM age_clock) \
     WHERE case_id = $1 AND waits_for = $2 AND status = 'accepted' RETURNING id";
const WAIT_AGAIN: &str = "UPDATE jobs SET status = 'accepted', error = NULL, error_class = NULL, finished = NULL, \
     updated = (SELECT now_ms FROM age_clock) \
     WHERE case_id = (SELECT id FROM cases WHERE meshing = $1) AND waits_for = $1 AND status = 'failed' RETURNING id";
/// The states of the jobs that wait for a meshing, of those that are not in their last event.
const RECORD: &str = "INSERT INTO job_events \
     (job_id, number, at, status, phase, progress, iteration, residual, attempt) \
     SELECT jobs.id, last.number + 1, jobs.updated, jobs.status, jobs.phase, jobs.progress, jobs.iteration, \
       jobs.residual, jobs.attempt FROM jobs JOIN job_events AS last ON last.job_id = jobs.id \
       AND last.number = (SELECT MAX(number) FROM job_events WHERE job_events.job_id = jobs.id) \
     WHERE jobs.case_id = (SELECT id FROM cases WHERE meshing = $1) AND jobs.waits_for = $1 \
       AND jobs.status IN ('accepted', 'failed') AND last.status <> jobs.status";
const DOCUMENT: &str = "SELECT document FROM cases WHERE id = $1";
const FILL: &str = "UPDATE jobs SET document = $2 WHERE id = $1";

/// Holds the case that a job meshes, if it is for one, before the job itself is held.
pub(super) async fn hold_case(
    transaction: &mut Transaction,
    meshing: &str,
) -> Result<(), sqlx::Error> {
    query(LOCK).bind(meshing).fetch_optional(&mut *transaction).await?;
    Ok(())
}

/// The same for all jobs whose lease has run out by now. When that is.
pub(super) async fn hold_cases(transaction: &mut Transaction) -> Result<i64, sqlx::Error> {
    let now = query("SELECT now_ms FROM clock").fetch_one(&mut *transaction).await?.try_get(0)?;
    query(LOCK_OVERDUE).bind(now).fetch_all(&mut *transaction).await?;
    Ok(now)
}

/// Gives the case that a job has meshed its document, and lets those go on that wait for it. Its id; other jobs have no such case.
pub(super) async fn complete(
    transaction: &mut Transaction,
    meshing: &str,
    case: &MeshedCase,
) -> Result<Option<String>, sqlx::Error> {
    let completed = query(COMPLETE).bind(meshing).bind(&case.document).bind(&case.report);
    let Some(row) = completed.fetch_optional(&mut *transaction).await? else { return Ok(None) };
    let id: String = row.try_get(0)?;
    query(GO_ON).bind(&id).bind(meshing).execute(&mut *transaction).await?;
    Ok(Some(id))
}

/// Fails the jobs that wait for a meshing, where that has ended without a mesh. Their ids.
pub(super) async fn fail_waiting(
    transaction: &mut Transaction,
    meshing: &str,
) -> Result<Vec<String>, sqlx::Error> {
    let row = query(WITHOUT).bind(meshing).fetch_optional(&mut *transaction).await?;
    let Some(row) = row else { return Ok(Vec::new()) };
    let (case, error): (String, Option<String>) = (row.try_get("id")?, row.try_get("error")?);
    let error = error.and_then(|error| serde_json::from_str(&error).ok());
    let error = without_mesh(meshing, error);
    let class = error["class"].as_str().map(str::to_owned);
    let fail = query(FAIL).bind(&case).bind(meshing).bind(error.to_string()).bind(class);
    let failed = fail.fetch_all(&mut *transaction).await?;
    changed(transaction, meshing, &failed).await
}

/// Has the jobs wait again that failed with a meshing which is tried again. Their ids.
pub(super) async fn wait_again(
    transaction: &mut Transaction,
    meshing: &str,
) -> Result<Vec<String>, sqlx::Error> {
    let again = query(WAIT_AGAIN).bind(meshing).fetch_all(&mut *transaction).await?;
    changed(transaction, meshing, &again).await
}

/// Writes down the states of all jobs that were changed together, in one statement: they may be thousands. Their ids.
async fn changed(
    transaction: &mut Transaction,
    meshing: &str,
    rows: &[Row],
) -> Result<Vec<String>, sqlx::Error> {
    query(RECORD).bind(meshing).execute(&mut *transaction).await?;
    rows.iter().map(|row| row.try_get(0)).collect()
}

/// The error of a job whose case got no mesh: that of the meshing, by name. One that was dismissed has none of its own.
fn without_mesh(meshing: &str, error: Option<Value>) -> Value {
    let (error, why) = match error {
        Some(error) => {
            let text = |member: &str| error[member].as_str().unwrap_or_default().to_owned();
            let why = format!("failed with {}: {}", text("type"), text("detail"));
            (error, why)
        }
        None => {
            let dismissed = JobErrorDocument::of_unended_meshing("dismissed");
            (json!(dismissed), "was dismissed".to_owned())
        }
    };
    json!({
        "type": ErrorCode::CaseNotReady,
        "class": error["class"],
        "detail": format!("the case has no mesh: its meshing {meshing} {why}"),
        "meshing": { "job": meshing, "error": error },
    })
}

/// The document of a claimed job with its case, which it lacks where it was accepted before that had its mesh. The case of a
/// job stays as long as the job, so that it is written down once and for all who read it later.
pub(super) async fn filled(
    transaction: &mut Transaction,
    job: &str,
    case: Option<&str>,
    document: String,
) -> Result<String, sqlx::Error> {
    let Some(case) = case.filter(|_| document.contains(LACKING)) else { return Ok(document) };
    let unreadable = |error: serde_json::Error| sqlx::Error::Decode(error.into());
    let mut parsed: Value = serde_json::from_str(&document).map_err(unreadable)?;
    let inputs = parsed.as_object_mut().into_iter().flat_map(serde_json::Map::values_mut);
    let lacking = inputs.filter_map(|input| input.get_mut("case")).find(|case| case.is_null());
    let Some(place) = lacking else { return Ok(document) };
    let row = query(DOCUMENT).bind(case).fetch_one(&mut *transaction).await?;
    *place = serde_json::from_str(&row.try_get::<String, _>(0)?).map_err(unreadable)?;
    let filled = parsed.to_string();
    query(FILL).bind(job).bind(&filled).execute(&mut *transaction).await?;
    Ok(filled)
}

/// Within a text a quotation mark has a backslash before it, so that these words are found as a member only.
const LACKING: &str = "\"case\":null";
