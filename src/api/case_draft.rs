//! A case on its way in: its document, the meshes that came with it, and whether they make sense together.

use std::collections::BTreeMap;

use tokio::runtime::Handle;

use super::error::{ApiError, ApiResult};
use super::idempotency::NewId;
use super::meshes::{TakenIn, take_in};
use super::spool::Received;
use super::turns::Turn;
use super::{Service, job_input};
use crate::jobs::{CheckReport, PredictInput, StoredMesh};
use crate::library::upload::{Statement, Upload};
use crate::schema::predict::check::CheckDocument;
use crate::schema::{CaseDocument, ErrorCode, Limits, PredictDocument, Problem};
use crate::store::NewCase;

/// The part of a form that holds the document; the other parts are meshes.
const CASE_PART: &str = "case";

/// The parts of a form by their names.
pub(super) type Parts = Vec<(String, Received)>;

/// The document and the meshes of a form.
pub(super) fn split(mut parts: Parts) -> ApiResult<(Received, Parts)> {
    let at = parts.iter().position(|(name, _)| name == CASE_PART);
    let at = at.ok_or_else(|| {
        ApiError::new(ErrorCode::MalformedMultipart, "the form has no part `case`")
    })?;
    let (_, document) = parts.remove(at);
    Ok((document, parts))
}

/// A case on its way in, with the meshes that came with it.
pub(super) struct Draft {
    document: CaseDocument,
    uploads: Vec<Upload>,
}

impl Draft {
    /// Reads the meshes, in the turn of their request, and puts their ids where the document names their parts.
    pub async fn read(
        service: &Service,
        turn: &Turn,
        mut document: CaseDocument,
        parts: Parts,
        allow_any_scale: Option<bool>,
    ) -> ApiResult<Draft> {
        let statement = Statement {
            units: Some(document.units),
            frame: Some(document.frame),
            role: None,
            allow_any_scale: allow_any_scale.unwrap_or(false),
        };
        let mut ids: BTreeMap<String, String> = BTreeMap::new();
        let mut uploads: Vec<Upload> = Vec::new();
        for (name, body) in parts {
            let taken = take_in(service, turn, body, &statement, false).await;
            let id = match taken.map_err(|error| in_part(error, &name))? {
                TakenIn::Known(row) => row.id,
                TakenIn::New(upload) => {
                    let same = |other: &&Upload| other.row.sha256 == upload.row.sha256;
                    match uploads.iter().find(same) {
                        Some(other) => other.row.id.clone(),
                        None => {
                            let id = upload.row.id.clone();
                            uploads.push(*upload);
                            id
                        }
                    }
                }
            };
            ids.insert(name, id);
        }
        let mut unused: Vec<String> = ids.keys().cloned().collect();
        for (_, reference) in document.mesh_references_mut() {
            if let Some(id) = ids.get(reference) {
                unused.retain(|name| name != reference);
                *reference = id.clone();
            }
        }
        if unused.is_empty() {
            return Ok(Draft { document, uploads });
        }
        let detail = format!("the case refers to no part called {}", unused.join(", "));
        Err(ApiError::new(ErrorCode::UnusedPart, detail))
    }

    /// Whether the document and its meshes make sense; `None` where only a plan can tell.
    pub async fn check(&self, service: &Service) -> ApiResult<Option<CheckDocument>> {
        let input = PredictInput {
            job: None,
            queue_s: None,
            case: self.document.clone(),
            plan: Default::default(),
            spec: PredictDocument::default(),
        };
        let extra = self.uploads.iter().map(|upload| (upload.row.id.clone(), upload.mesh.clone()));
        let checked = checked(service, input, extra.collect()).await;
        match checked {
            Ok(report) => Ok(Some(report.document)),
            Err(error) if needs_a_plan(&error.problem) => Ok(None),
            Err(error) => Err(error.problem.moved("/case", "").into()),
        }
    }

    /// Keeps the case and its meshes under an id, unless an earlier request with its key has done so.
    pub async fn store(
        self,
        service: &Service,
        new: &NewId,
        check: Option<&CheckDocument>,
    ) -> ApiResult<()> {
        let id = &new.id;
        let is_known = new.is_known;
        let text = |value: serde_json::Result<String>| value.map_err(ApiError::internal);
        let (rows, meshes): (Vec<_>, Vec<_>) =
            self.uploads.into_iter().map(|upload| (upload.row, upload.mesh)).unzip();
        let new = NewCase {
            id: id.clone(),
            document: text(serde_json::to_string(&self.document))?,
            report: text(serde_json::to_string(&check))?,
            tags: self.document.tags.clone(),
            mesh_ids: self.document.mesh_ids(),
            meshes: rows,
        };
        if !service.store.add_case(&new).await? {
            if is_known && service.store.case(id).await?.is_some() {
                return Ok(());
            }
            let detail = "a mesh of the case came or went meanwhile; send the case again";
            return Err(ApiError::new(ErrorCode::Conflict, detail));
        }
        for (row, mesh) in new.meshes.iter().zip(meshes) {
            service.library.keep(&row.blob, mesh.shape);
        }
        tracing::info!(case.id = %id, meshes = new.mesh_ids.len(), "case stored");
        Ok(())
    }
}

/// Says in which part of a form a mesh was refused.
fn in_part(error: ApiError, name: &str) -> ApiError {
    error.map_problem(|problem| {
        let detail = format!("part {name}: {}", problem.detail);
        Problem { detail, ..problem }.with("part", name)
    })
}

/// Loose parts may be held by the sets that a plan names.
fn needs_a_plan(problem: &Problem) -> bool {
    !problem.errors.is_empty()
        && problem.errors.iter().all(|error| error.code == ErrorCode::Underconstrained)
}

/// Checks a prediction over stored meshes and those of a request.
pub(super) async fn checked(
    service: &Service,
    input: PredictInput,
    extra: BTreeMap<String, StoredMesh>,
) -> ApiResult<CheckReport> {
    let sources = service.library.source(Handle::current(), extra);
    let limits: Limits = (*service.limits).clone();
    let turn = service.check_turn().await?;
    let report = turn.compute(move || crate::jobs::check(&input, &sources, &limits)).await?;
    report.map_err(job_input::refusal)
}
