//! Versions of the program: which may run which job while several share one database.
//!
//! A job carries the revision of the numbers of the program that accepted it. A program with an earlier revision leaves it
//! alone: it would put other numbers under a hash that promises later ones. One with the same or a later revision runs it,
//! so that a rolling restart loses no job. Where another version ran a job than the one that accepted it, the result says
//! which, and so does the row from then on: its engine and, where no other job has it, its hash. The hash of a job that was
//! accepted before its case had a mesh is known by then only.

use serde::Deserialize;

use super::database::{Transaction, query};
use super::tenants;
use crate::schema::engine::EngineDocument;

/// The part of a manifest that names the program.
#[derive(Deserialize)]
struct Manifest {
    provenance: Provenance,
}

#[derive(Deserialize)]
struct Provenance {
    engine: EngineDocument,
    spec_hash: String,
}

const FOUND: &str = "SELECT engine, spec_hash FROM jobs WHERE id = $1";
const NOTE: &str = "UPDATE jobs SET engine = $2, spec_hash = CASE \
       WHEN EXISTS (SELECT 1 FROM jobs AS other WHERE other.spec_hash = $3) THEN spec_hash ELSE $3 END \
     WHERE id = $1";

/// Writes down which program made the result of a job, where it is another version than the one that accepted it, and of
/// what.
pub(super) async fn note_engine(
    transaction: &mut Transaction,
    job: &str,
    manifest: &str,
) -> Result<(), sqlx::Error> {
    let Ok(Manifest { provenance }) = serde_json::from_str(manifest) else { return Ok(()) };
    let row = query(FOUND).bind(job).fetch_one(&mut *transaction).await?;
    let (accepted, known): (String, String) = (row.try_get("engine")?, row.try_get("spec_hash")?);
    let spec_hash = tenants::with_plain(&known, &provenance.spec_hash);
    if known == spec_hash && !is_another(&accepted, &provenance.engine) {
        return Ok(());
    }
    let engine = serde_json::to_string(&provenance.engine)
        .map_err(|error| sqlx::Error::Encode(error.into()))?;
    query(NOTE).bind(job).bind(engine).bind(spec_hash).execute(&mut *transaction).await?;
    Ok(())
}

/// Whether hashes of jobs tell two programs apart.
fn is_another(accepted: &str, ran: &EngineDocument) -> bool {
    let accepted: Option<EngineDocument> = serde_json::from_str(accepted).ok();
    accepted.is_some_and(|accepted| {
        (accepted.numerics, accepted.version) != (ran.numerics, ran.version.clone())
    })
}
