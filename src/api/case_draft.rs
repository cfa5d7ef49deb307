//! Draft of a posted case: its document, the meshes uploaded with it, and their consistency.

use std::collections::BTreeMap;

use tokio::runtime::Handle;

use super::Service;
use super::accepted::{Accepted, LONGEST_QUEUE, checked_in_time, queue_full};
use super::error::{ApiError, ApiResult};
use super::idempotency::{KeyedRequest, NewId};
use super::meshes::{UploadedMesh, take_in};
use super::permits::Permit;
use super::spool::SpooledBody;
use crate::jobs::{
    CheckReport, JobError, JobInput, MeshSource, MeshingInput, PredictInput, SourceError,
    StoredMesh, StoredShape, WaitingCase,
};
use crate::library::upload::{Statement, Upload};
use crate::schema::case::meshed::{CaseBody, MeshedCaseDocument};
use crate::schema::predict::check::CheckDocument;
use crate::schema::{
    CaseDocument, ErrorCode, Faults, MeshingDocument, Pointer, PredictDocument, Problem, hashes,
};
use crate::store::{AddedCase, NewCase, NewJob};

/// The part of a form with the document; the other parts are meshes.
const CASE_PART: &str = "case";

/// The parts of a form by their names.
pub(super) type FormParts = Vec<(String, SpooledBody)>;

/// The document and the meshes of a form.
pub(super) fn split(mut parts: FormParts) -> ApiResult<(SpooledBody, FormParts)> {
    let at = parts.iter().position(|(name, _)| name == CASE_PART);
    let at = at.ok_or_else(|| {
        ApiError::new(ErrorCode::MalformedMultipart, "the form has no part `case`")
    })?;
    let (_, document) = parts.remove(at);
    Ok((document, parts))
}

/// So often a case is tried to be stored while others store and erase the same bytes.
const ATTEMPTS: usize = 8;

/// A posted case.
pub(super) struct PostedCase {
    pub document: CaseBody,
    pub parts: FormParts,
    pub allow_any_scale: bool,
}

impl PostedCase {
    /// Stores the case with its meshes; its id.
    pub async fn stored(
        &self,
        service: &Service,
        asked: &KeyedRequest,
        traceparent: Option<String>,
    ) -> ApiResult<String> {
        // Its meshes are in memory until the case is stored.
        let permit = service.parse_permit().await?;
        let mut left = ATTEMPTS;
        loop {
            left -= 1;
            let (document, scale) = (self.document.clone(), self.allow_any_scale);
            let draft = Draft::read(service, &permit, document, &self.parts, scale).await?;
            let checked = match draft.check(service).await {
                Err(error) if left > 0 && draft.may_lack_known(&error) => continue,
                checked => checked?,
            };
            // What comes before this changes nothing, so that it ends with its client.
            let new = asked.reserve(service).await?;
            match draft.store(service, &new, &checked, traceparent.clone()).await {
                Err(error) if left > 0 && error.problem.code == ErrorCode::Conflict => {}
                stored => return stored.map(|()| new.id),
            }
        }
    }
}

/// A case to be stored, with the meshes uploaded with it.
struct Draft {
    document: CaseBody,
    uploads: Vec<Upload>,
    /// Whether the bytes of a part were stored before: somebody may erase them meanwhile.
    has_known: bool,
}

/// The checks of a case before it is stored.
enum Checked {
    /// Boundary conditions of its nodes; `None` if they depend on a plan.
    Whole(Box<Option<CheckDocument>>),
    /// For each mesh or image of the meshing the hash of its content.
    ToMesh { contents: BTreeMap<String, String> },
}

impl Draft {
    /// Parses the meshes, with the permit of their request, and replaces the names of their parts in the document by ids.
    async fn read(
        service: &Service,
        permit: &Permit,
        mut document: CaseBody,
        parts: &FormParts,
        allow_any_scale: bool,
    ) -> ApiResult<Draft> {
        let (units, frame, image) = match &document {
            CaseBody::Whole(case) => {
                let image = case.hounsfield.as_ref().map(|own| own.image.clone());
                (Some(case.units), Some(case.frame), image)
            }
            CaseBody::ToMesh(_) => (None, None, None),
        };
        // The frame of a case is that of its meshes, to which an image is turned.
        let of_image = Statement { units, frame: None, role: None, allow_any_scale };
        let of_mesh = Statement { frame, ..of_image.clone() };
        let mut ids: BTreeMap<String, String> = BTreeMap::new();
        let mut uploads: Vec<Upload> = Vec::new();
        let mut has_known = false;
        for (name, body) in parts {
            let statement = if image.as_ref() == Some(name) { &of_image } else { &of_mesh };
            let taken = take_in(service, permit, body.clone(), statement, false).await;
            let id = match taken.map_err(|error| in_part(error, name))? {
                UploadedMesh::Known(row) => {
                    has_known = true;
                    row.id
                }
                UploadedMesh::New(upload) => {
                    let same = |other: &&Upload| {
                        let (one, other) = (&upload.row, &other.row);
                        one.sha256 == other.sha256 && one.options == other.options
                    };
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
            ids.insert(name.clone(), id);
        }
        let mut unused: Vec<String> = ids.keys().cloned().collect();
        for (_, reference) in document.mesh_references_mut() {
            if let Some(id) = ids.get(reference) {
                unused.retain(|name| name != reference);
                *reference = id.clone();
            }
        }
        if unused.is_empty() {
            return Ok(Draft { document, uploads, has_known });
        }
        let detail = format!("the case does not refer to part {}", unused.join(", "));
        Err(ApiError::new(ErrorCode::UnusedPart, detail))
    }

    /// Checks the document with its meshes.
    async fn check(&self, service: &Service) -> ApiResult<Checked> {
        match &self.document {
            CaseBody::Whole(case) => {
                self.check_whole(service, case).await.map(Box::new).map(Checked::Whole)
            }
            CaseBody::ToMesh(case) => self.check_scan(service, case).await,
        }
    }

    async fn check_whole(
        &self,
        service: &Service,
        case: &CaseDocument,
    ) -> ApiResult<Option<CheckDocument>> {
        let input = PredictInput {
            job: None,
            queue_s: None,
            case: case.clone(),
            plan: Default::default(),
            spec: PredictDocument::default(),
        };
        let checked = checked(service, input, self.brought()).await;
        match checked {
            Ok(report) => Ok(Some(report.document)),
            // Loose parts may be held by the sets that a plan names.
            Err(error) if error.problem.is_only(ErrorCode::Underconstrained) => Ok(None),
            Err(error) => Err(error.problem.moved("/case", "").into()),
        }
    }

    async fn check_scan(&self, service: &Service, case: &MeshedCaseDocument) -> ApiResult<Checked> {
        let mut faults = Faults::default();
        case.check(&service.limits, &mut faults);
        faults.into_result()?;
        let spec = case.meshing.clone();
        let input = MeshingInput { job: None, queue_s: None, spec, case: None };
        let sources = service.library.source(Handle::current(), self.brought());
        let image = case.hounsfield.as_ref().map(|hounsfield| hounsfield.image.clone());
        let prepared = checked_in_time(service, move |limits, _| {
            image.iter().try_for_each(|image| require_image(&sources, image))?;
            input.prepare(&sources, limits)
        });
        let prepared = prepared.await;
        let moved = |problem: Problem| problem.moved("/spec", "/meshing");
        let prepared = prepared.map_err(|error| error.map_problem(moved))?;
        let contents = prepared.meshes.into_iter().map(|(_, mesh)| mesh.identity);
        Ok(Checked::ToMesh {
            contents: case.meshing.clone().mesh_ids().into_iter().zip(contents).collect(),
        })
    }

    /// Whether an error of its check can be that a mesh known before is erased now, and another attempt reads its part.
    fn may_lack_known(&self, error: &ApiError) -> bool {
        self.has_known && error.problem.is_only(ErrorCode::UnknownMesh)
    }

    /// The meshes uploaded with the case, by their ids.
    fn brought(&self) -> BTreeMap<String, StoredMesh> {
        self.uploads.iter().map(|upload| (upload.row.id.clone(), upload.mesh.clone())).collect()
    }

    /// Stores the case and its meshes under an id, unless an earlier request with its key has done so.
    async fn store(
        self,
        service: &Service,
        new: &NewId,
        checked: &Checked,
        traceparent: Option<String>,
    ) -> ApiResult<()> {
        let id = &new.id;
        let is_known = new.is_known;
        let text = |value: serde_json::Result<String>| value.map_err(ApiError::internal);
        let (rows, meshes): (Vec<_>, Vec<_>) =
            self.uploads.into_iter().map(|upload| (upload.row, upload.mesh)).unzip();
        let mut document = self.document;
        let tags_of_job = document.take_tags_of_job();
        let check = match checked {
            Checked::Whole(check) => check.as_ref().as_ref(),
            Checked::ToMesh { .. } => None,
        };
        let new = NewCase {
            id: id.clone(),
            document: text(serde_json::to_string(&document))?,
            report: text(serde_json::to_string(&check))?,
            tags: document.tags().to_vec(),
            mesh_ids: document.mesh_ids(),
            meshes: rows,
            meshing: meshing_of(id, &document, tags_of_job, checked, traceparent)?,
        };
        match service.store.add_case(&new, LONGEST_QUEUE).await? {
            AddedCase::Stored => {}
            AddedCase::Contended if is_known && service.store.case(id).await?.is_some() => {
                return Ok(());
            }
            AddedCase::Contended => {
                let detail = "a mesh of the case changed meanwhile; send the case again";
                return Err(ApiError::new(ErrorCode::Conflict, detail));
            }
            AddedCase::QueueFull => return Err(queue_full()),
        }
        for (row, mesh) in new.meshes.iter().zip(meshes) {
            service.library.keep(&row.blob, mesh.shape);
        }
        tracing::info!(case.id = %id, meshes = new.mesh_ids.len(), "case stored");
        Ok(())
    }
}

/// Adds the part of a form whose mesh was refused.
fn in_part(error: ApiError, name: &str) -> ApiError {
    error.map_problem(|problem| {
        let detail = format!("part {name}: {}", problem.detail);
        Problem { detail, ..problem }.with("part", name)
    })
}

/// An image of materials has to exist before hours of meshing end without it.
fn require_image(sources: &dyn MeshSource, image: &str) -> Result<(), JobError> {
    let at = Pointer::root().key("hounsfield").key("image");
    match sources.mesh(image) {
        Ok(StoredMesh { shape: StoredShape::Image(_), .. }) => Ok(()),
        Ok(_) => {
            let detail = "this is a mesh, and an image is needed";
            Err(Problem::at(&at, ErrorCode::WrongMesh, detail).into())
        }
        Err(SourceError::Unknown { .. }) => {
            let detail = format!("there is no image {image:?}");
            Err(Problem::at(&at, ErrorCode::UnknownMesh, detail).into())
        }
        Err(other) => Err(JobError::Source(other)),
    }
}

/// The job that makes the mesh of a case without one. It belongs to the case, and is erased with it.
fn meshing_of(
    case: &str,
    document: &CaseBody,
    tags: Vec<String>,
    checked: &Checked,
    traceparent: Option<String>,
) -> ApiResult<Option<NewJob>> {
    let (CaseBody::ToMesh(document), Checked::ToMesh { contents }) = (document, checked) else {
        return Ok(None);
    };
    let spec = MeshingDocument { tags: tags.clone(), ..document.meshing.clone() };
    let accepted = Accepted {
        case_id: Some(case.to_owned()),
        shared_cases: Vec::new(),
        spec_hash: hashes::meshing_hash(&spec, &|id| contents.get(id).cloned(), Some(case)),
        tags,
        mesh_ids: document
            .clone()
            .mesh_references_mut()
            .into_iter()
            .map(|(_, id)| id.clone())
            .collect(),
        study: None,
    };
    let waiting = WaitingCase { id: case.to_owned(), document: (**document).clone() };
    let input = MeshingInput { job: None, queue_s: None, spec, case: Some(waiting) };
    Ok(Some(NewJob { traceparent, ..accepted.with(&JobInput::Meshing(input))? }))
}

/// Checks a prediction over stored meshes and those of a request.
pub(super) async fn checked(
    service: &Service,
    input: PredictInput,
    extra: BTreeMap<String, StoredMesh>,
) -> ApiResult<CheckReport> {
    let sources = service.library.source(Handle::current(), extra);
    checked_in_time(service, move |limits, stop| crate::jobs::check(&input, &sources, limits, stop))
        .await
}
