//! Meshes: uploaded once, immutable, downloaded in other formats.

use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::IntoResponse;
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::routes;

use super::download::ServedFile;
use super::error::{ApiError, ApiResult};
use super::parameters::{Id, Parameters};
use super::permits::Permit;
use super::resources::Resources;
use super::spool::SpooledBody;
use super::{Service, body, conditional, json, time, with_header};
use crate::library::upload::{ExportFormat, Statement, Upload, export, read_upload};
use crate::schema::ErrorCode;
use crate::schema::case::document::{FrameName, LengthUnit};
use crate::schema::key::Scope;
use crate::schema::mesh::{MeshDocument, MeshKind};
use crate::schema::wire::problem::Problem;
use crate::store::{MeshDeletion, MeshRow, MeshUsers};

const READ_HERE: &str = "model/stl, model/obj, application/vnd.ply, application/vnd.vtk, \
     application/vnd.vtk.xml, application/x-gmsh, application/x-nrrd, application/x-nifti, application/gzip, \
     application/x-metaimage, application/dicom, application/zip, application/octet-stream, multipart/form-data";
const MULTIPART: &str = "multipart/form-data";

/// So often a mesh is tried to be stored while others store and delete the same bytes.
const ATTEMPTS: usize = 8;

pub fn router() -> Resources {
    let json = Resources::new()
        .changes(Scope::Write, routes!(upload))
        .reads(Scope::Read, routes!(show))
        .changes(Scope::Write, routes!(remove))
        .json_only();
    json.reads(Scope::Read, routes!(content))
}

/// Parameters of an upload.
#[derive(Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct UploadParameters {
    /// The frame of the coordinates; a `SPACE=` mark in the file has to agree. The `space` of an image takes
    /// precedence.
    frame: Option<FrameName>,
    /// The unit of length of the file. Default: mm. An image is in mm or in its own `space units`.
    units: Option<LengthUnit>,
    /// Use of the mesh, a word of at most 32 letters; stored and not interpreted.
    #[param(pattern = "^[A-Za-z0-9_-]{1,32}$")]
    role: Option<String>,
    /// Accepts a mesh smaller or larger than any head. Default: false.
    allow_any_scale: Option<bool>,
}

impl UploadParameters {
    fn into_statement(self) -> ApiResult<Statement> {
        let is_word = |role: &str| {
            let plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
            (1..=32).contains(&role.len()) && role.bytes().all(plain)
        };
        if self.role.as_deref().is_some_and(|role| !is_word(role)) {
            let detail = "role has 1 to 32 letters, digits, `_` or `-`";
            return Err(ApiError::invalid_parameter("role", detail));
        }
        Ok(Statement {
            units: self.units,
            frame: self.frame,
            role: self.role,
            allow_any_scale: self.allow_any_scale.unwrap_or(false),
        })
    }
}

/// Stores a mesh: VTU, VTP, VTK legacy, Gmsh, STL, PLY or OBJ, or an image: NRRD, NIfTI, MetaImage or the files of a
/// DICOM series in one zip archive; recognised by content. Identical bytes are not stored twice.
#[utoipa::path(
    post, path = "/v1/meshes", operation_id = "upload_mesh", tag = "meshes", params(UploadParameters),
    request_body(description = "the file", content(
        (Vec<u8> = "application/octet-stream"), (Vec<u8> = "model/stl"), (Vec<u8> = "model/obj"),
        (Vec<u8> = "application/vnd.ply"), (Vec<u8> = "application/vnd.vtk"),
        (Vec<u8> = "application/vnd.vtk.xml"), (Vec<u8> = "application/x-gmsh"),
        (Vec<u8> = "application/x-nrrd"), (Vec<u8> = "application/x-nifti"),
        (Vec<u8> = "application/gzip"), (Vec<u8> = "application/x-metaimage"),
        (Vec<u8> = "application/dicom"), (Vec<u8> = "application/zip"),
        (MeshForm = "multipart/form-data"),
    )),
    responses(
        (status = 201, description = "stored", body = MeshDocument, headers(("Location" = String, description = "the mesh"))),
        (status = 200, description = "the same bytes, so described, existed before", body = MeshDocument),
    )
)]
async fn upload(
    service: Service,
    Parameters(parameters): Parameters<UploadParameters>,
    request: Request,
) -> ApiResult {
    let statement = parameters.into_statement()?;
    let kind = body::content_type(request.headers());
    let body = if kind == MULTIPART {
        single_part(body::parts(&service, request).await?)?
    } else if READ_HERE.split(", ").any(|known| known == kind) {
        body::upload(&service, request).await?
    } else {
        return Err(body::unsupported(&kind, READ_HERE));
    };
    let permit = service.parse_permit().await?;
    let (row, is_new) = stored(&service, &permit, &body, &statement).await?;
    let location = format!("/v1/meshes/{}", row.id);
    let status = if is_new { StatusCode::CREATED } else { StatusCode::OK };
    let answer = json(status, &document_of(&row)?);
    Ok(with_header(answer, header::LOCATION, &location))
}

/// A form with the file as its only part.
#[derive(utoipa::ToSchema)]
#[allow(dead_code, reason = "describes the form for the OpenAPI document")]
struct MeshForm {
    #[schema(value_type = String, format = Binary)]
    file: Vec<u8>,
}

fn single_part(mut parts: Vec<(String, SpooledBody)>) -> ApiResult<SpooledBody> {
    match (parts.pop(), parts.len()) {
        (Some((_, part)), 0) => Ok(part),
        (last, others) => {
            let count = others + usize::from(last.is_some());
            let detail = format!("the form has {count} parts, and needs exactly one, the file");
            Err(ApiError::new(ErrorCode::MalformedMultipart, detail))
        }
    }
}

/// An upload: stored before, or to be stored.
pub enum UploadedMesh {
    Known(MeshRow),
    New(Box<Upload>),
}

/// Looks up bytes, and parses unknown ones with the permit of their request.
pub async fn take_in(
    service: &Service,
    permit: &Permit,
    body: SpooledBody,
    statement: &Statement,
    standalone: bool,
) -> ApiResult<UploadedMesh> {
    let hash = body.sha256_hex();
    let known = service.store.mesh_by_content(&hash, &statement.identity()).await?;
    if let Some(row) = &known
        && service.store.has_blob(&row.blob).await?
    {
        return Ok(UploadedMesh::Known(row.clone()));
    }
    let statement = statement.clone();
    let read = permit.compute(move || -> ApiResult<Upload> {
        let bytes = body.read()?;
        Ok(read_upload(&bytes, hash, &statement, standalone)?)
    });
    let upload = Box::new(read.await??);
    match known {
        Some(row) => restored(service, row, *upload).await,
        None => Ok(UploadedMesh::New(upload)),
    }
}

/// A known mesh whose stored bytes are lost or damaged, with those of an upload of the same file in their place.
async fn restored(service: &Service, row: MeshRow, upload: Upload) -> ApiResult<UploadedMesh> {
    let row = match service.store.restore_mesh(&row.id, &upload.row).await? {
        Some(row) => row,
        // It was deleted meanwhile.
        None => return Ok(UploadedMesh::New(Box::new(upload))),
    };
    service.library.keep(&row.blob, upload.mesh.shape);
    tracing::warn!(
        mesh.id = %row.id, blob = %row.blob,
        "the stored bytes of a mesh were lost or damaged, and are stored again from an upload"
    );
    Ok(UploadedMesh::Known(row))
}

/// The row of an upload, and whether it is new. Where others delete the same bytes meanwhile it is tried again.
async fn stored(
    service: &Service,
    permit: &Permit,
    body: &SpooledBody,
    statement: &Statement,
) -> ApiResult<(MeshRow, bool)> {
    for _ in 0..ATTEMPTS {
        let known = match take_in(service, permit, body.clone(), statement, true).await? {
            UploadedMesh::Known(row) => Some((row, false)),
            UploadedMesh::New(upload) => store(service, *upload).await?,
        };
        let kept = match known {
            Some((row, true)) => return Ok((row, true)),
            Some((row, false)) => service.store.keep_mesh(&row.id).await?,
            None => None,
        };
        if let Some(row) = kept {
            return Ok((row, false));
        }
    }
    Err(ApiError::new(ErrorCode::Conflict, "the mesh was deleted meanwhile, again and again"))
}

/// `None` where it was deleted meanwhile.
async fn store(service: &Service, upload: Upload) -> ApiResult<Option<(MeshRow, bool)>> {
    let is_new = service.store.add_mesh(&upload.row).await?;
    let (hash, options) = (&upload.row.sha256, &upload.row.options);
    let row = service.store.mesh_by_content(hash, options).await?;
    let Some(row) = row else { return Ok(None) };
    service.library.keep(&row.blob, upload.mesh.shape);
    tracing::info!(mesh.id = %row.id, mesh.nodes = upload.document.report.nodes, is_new, "mesh stored");
    Ok(Some((row, is_new)))
}

/// The description of a stored mesh.
pub fn document_of(row: &MeshRow) -> ApiResult<MeshDocument> {
    let mut document = crate::library::meshes::document_of(row)?;
    document.created = time::rfc3339(row.created);
    Ok(document)
}

async fn row_of(service: &Service, id: &str) -> ApiResult<MeshRow> {
    let row = service.store.mesh(id).await?;
    row.ok_or_else(|| ApiError::not_found("mesh"))
}

/// Content of a mesh.
#[utoipa::path(
    get, path = "/v1/meshes/{id}", operation_id = "show_mesh", tag = "meshes", params(("id" = uuid::Uuid, Path, description = "the mesh")),
    responses(
        (status = 200, description = "the report of its upload", body = MeshDocument, headers(("ETag" = String, description = "of the bytes as uploaded"))),
        (status = 304, description = "the client has it already"),
    )
)]
async fn show(service: Service, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let row = row_of(&service, &id).await?;
    if conditional::is_known(&headers, &row.sha256) {
        return Ok(conditional::not_modified(&row.sha256));
    }
    let answer = json(StatusCode::OK, &document_of(&row)?);
    Ok(with_header(answer, header::ETAG, &format!("\"{}\"", row.sha256)))
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct ContentParameters {
    /// `vtu` (volumes only), `vtp`, `stl` or `ply`; of a volume the last three have the boundary. `nrrd` (images
    /// only).
    #[param(inline)]
    format: Option<ContentFormat>,
}

#[derive(Clone, Copy, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "lowercase")]
enum ContentFormat {
    Vtu,
    Vtp,
    Stl,
    Ply,
    Nrrd,
}

impl From<ContentFormat> for ExportFormat {
    fn from(format: ContentFormat) -> Self {
        match format {
            ContentFormat::Vtu => ExportFormat::Vtu,
            ContentFormat::Vtp => ExportFormat::Vtp,
            ContentFormat::Stl => ExportFormat::Stl,
            ContentFormat::Ply => ExportFormat::Ply,
            ContentFormat::Nrrd => ExportFormat::Nrrd,
        }
    }
}

/// The mesh as a file, written from the parsed content of the upload, in its unit and frame; a volume mesh in RAS is
/// written in LPS and marked so, because 3D Slicer reads no other frame from a VTU file that meshio reads.
#[utoipa::path(
    get, path = "/v1/meshes/{id}/content", operation_id = "download_mesh", tag = "meshes",
    params(("id" = uuid::Uuid, Path, description = "the mesh"), ContentParameters),
    responses(
        (status = 200, description = "the file", content(
            (Vec<u8> = "application/vnd.vtk.xml"), (Vec<u8> = "model/stl"), (Vec<u8> = "application/vnd.ply"),
            (Vec<u8> = "application/x-nrrd"))),
        (status = 206, description = "the requested range", content(
            (Vec<u8> = "application/vnd.vtk.xml"), (Vec<u8> = "model/stl"), (Vec<u8> = "application/vnd.ply"),
            (Vec<u8> = "application/x-nrrd"))),
        (status = 304, description = "the client has it already"),
        (status = 416, description = "the range is outside the file"),
        (status = 422, description = "the mesh has no such form"),
    )
)]
async fn content(
    service: Service,
    Id(id): Id,
    Parameters(parameters): Parameters<ContentParameters>,
    headers: HeaderMap,
) -> ApiResult {
    let row = row_of(&service, &id).await?;
    let document = document_of(&row)?;
    let stored_as = match document.report.kind {
        MeshKind::Volume => ExportFormat::Vtu,
        MeshKind::Surface => ExportFormat::Vtp,
        MeshKind::Image => ExportFormat::Nrrd,
    };
    let format = parameters.format.map_or(stored_as, ExportFormat::from);
    super::middleware::check_accept(&headers, format.media_type())?;
    let blob = row.blob.clone();
    let frame = document.report.space.or(document.frame);
    let is_turned = format == ExportFormat::Vtu && frame == Some(FrameName::Ras);
    let name = format!("{id}.{}", format.name());
    let in_lps = if is_turned { "-lps" } else { "" };
    let tag = format!("{blob}-{}{in_lps}", format.name());
    if conditional::is_known(&headers, &tag) {
        return Ok(conditional::not_modified(&tag));
    }
    let damaged = |error: ApiError| error.of_bytes(format_args!("mesh {id}"));
    let file = if format == stored_as && !is_turned {
        ServedFile::blob(&service, &blob).await.map_err(damaged)?
    } else {
        let permit = service.parse_permit().await?;
        let mesh = service.library.open(row).await.map_err(|error| damaged(error.into()))?;
        ServedFile::made(&service, &permit, move || export(&mesh, format)).await?
    };
    conditional::file(&headers, file, (format.media_type(), &name), &tag)
}

/// Deletes a mesh that no case and no job refers to.
#[utoipa::path(
    delete, path = "/v1/meshes/{id}", operation_id = "remove_mesh", tag = "meshes",
    params(
        ("id" = uuid::Uuid, Path, description = "the mesh"),
        ("If-Match" = Option<String>, Header, description = "the ETag of the mesh, or *"),
    ),
    responses(
        (status = 204, description = "deleted"),
        (status = 409, description = "a case, a job or a cohort refers to it: `users` of the problem has the first ten"),
        (status = 412, description = "its ETag is another"),
    )
)]
async fn remove(service: Service, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let row = row_of(&service, &id).await?;
    conditional::allow_match(&headers, &row.sha256)?;
    match service.store.delete_mesh(&id).await? {
        MeshDeletion::Deleted => {
            service.library.forget(&row.blob);
            Ok(StatusCode::NO_CONTENT.into_response())
        }
        MeshDeletion::InUse(users) => Err(in_use(&users)),
        MeshDeletion::NotFound => Err(ApiError::not_found("mesh")),
    }
}

/// The refusal to delete a mesh, with what has to go first.
fn in_use(users: &MeshUsers) -> ApiError {
    let MeshUsers { count, first } = users;
    let named: Vec<String> = first.iter().map(|(kind, id)| format!("{kind} {id}")).collect();
    let more = count - first.len() as i64;
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let detail =
        format!("{}{more} refer to this mesh: erase what is not needed first", named.join(", "));
    let listed: Vec<serde_json::Value> =
        first.iter().map(|(kind, id)| serde_json::json!({ "kind": kind, "id": id })).collect();
    let problem = Problem::new(ErrorCode::ConflictInUse, detail);
    problem.with("count", *count).with("users", listed).into()
}
