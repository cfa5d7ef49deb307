//! From a spec of inverse planning to a job that can be queued.

use std::collections::BTreeMap;

use tokio::runtime::Handle;

use super::Service;
use super::error::{ApiError, ApiResult};
use super::job_input::{Accepted, in_spec, refusal, require_case};
use crate::jobs::{JobInput, OptimiseInput};
use crate::schema::job::JobKind;
use crate::schema::{CaseDocument, Limits, OptimiseDocument};
use crate::store::NewJob;

/// Inverse planning: its case as it is at this moment, checked with its meshes.
pub async fn of_optimisation(service: &Service, mut spec: OptimiseDocument) -> ApiResult<NewJob> {
    let row = require_case(service, &spec.case).await?;
    spec.case.clone_from(&row.id);
    let case: CaseDocument = serde_json::from_str(&row.document).map_err(ApiError::internal)?;
    let tags = spec.tags.clone();
    let input = OptimiseInput { job: None, queue_s: None, case, spec };
    let mesh_ids = input.mesh_ids();
    let sources = service.library.source(Handle::current(), BTreeMap::new());
    let limits: Limits = (*service.limits).clone();
    let (input, prepared) = service
        .compute(move || {
            let spec_hash = input.prepare(&sources, &limits).map(|prepared| prepared.spec_hash);
            (input, spec_hash)
        })
        .await?;
    let spec_hash = prepared.map_err(|error| refusal(error).map_problem(in_spec))?;
    let case_id = Some(row.id);
    let new = Accepted { kind: JobKind::Optimise, case_id, spec_hash, tags, mesh_ids };
    new.with(&JobInput::Optimise(input))
}
