//! Conversion of uploaded bytes to a mesh that can be stored: read, checked, reported, and written again by our own
//! writer, so that headers and comments, which often name the patient, stay behind.

use bytes::Bytes;
use serde_json::Value;

use super::mesh_report::mesh_report;

use super::meshes::parse_stored;
use crate::jobs::{MadeMesh, MeshSize, StoredMesh, StoredShape};
use crate::schema::ErrorCode;
use crate::schema::Problem;
use crate::schema::case::document::{FrameName, LengthUnit};
use crate::schema::mesh::{MeshDocument, MeshKind, MeshReport};
use crate::schema::wire::canonical::sha256_hex;
use crate::schema::wire::warning::WarningDocument;
use crate::store::NewMesh;
use mechanics::format::{
    self, FormatError, Member, Mesh, ReadLimits, ReadMesh, SurfaceOutput, VolumeInLps,
    VolumeOutput, vtk,
};
use mechanics::mesh::duplicate_cells::DUPLICATE_CELLS;
use mechanics::mesh::{Frame, TriangleSurface, VolumeMesh};

/// Statements of an upload about its bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statement {
    pub units: Option<LengthUnit>,
    pub frame: Option<FrameName>,
    pub role: Option<String>,
    pub allow_any_scale: bool,
}

impl Statement {
    /// What makes a mesh another although its bytes are the same.
    pub fn identity(&self) -> String {
        let units = self.units.map_or("", LengthUnit::name);
        let frame = self.frame.map_or("", |frame| Frame::from(frame).name());
        // A reader that keeps other arrays makes another mesh of the same bytes.
        let labels = ReadLimits::default().label_values;
        format!("units={units};frame={frame};labels={labels}")
    }
}

/// An upload that was read.
pub struct Upload {
    pub row: NewMesh,
    pub document: MeshDocument,
    pub mesh: StoredMesh,
}

/// Bytes that were read.
struct ReadBytes {
    read: ReadMesh,
    /// How many bytes, and their hash.
    bytes: u64,
    sha256: String,
    /// What the meshing that made it had to say.
    told: Vec<WarningDocument>,
}

/// Reads and checks an upload. Takes its time: not for an async thread.
pub fn read_upload(
    bytes: &Bytes,
    sha256: String,
    statement: &Statement,
    standalone: bool,
) -> Result<Upload, Problem> {
    let read = format::read(bytes, &ReadLimits::default()).map_err(|error| problem_of(&error))?;
    let received = ReadBytes { read, bytes: bytes.len() as u64, sha256, told: Vec::new() };
    validate_upload(received, statement, standalone)
}

/// A mesh that a job made, as if somebody had uploaded the file that we write of it.
pub fn upload_made(mesh: &MadeMesh) -> Result<Upload, Problem> {
    let bytes = encode(&mesh.shape, mesh.frame)?;
    let read = parse_stored(&bytes).map_err(|error| problem_of(&error))?;
    let statement = Statement {
        units: Some(LengthUnit::Mm),
        frame: (mesh.frame != Frame::Unspecified).then(|| mesh.frame.into()),
        role: Some(mesh.what.name().to_owned()),
        // That of the case was taken as it is.
        allow_any_scale: true,
    };
    let (bytes, sha256) = (bytes.len() as u64, sha256_hex(&bytes));
    let told = mesh.told.clone();
    validate_upload(ReadBytes { read, bytes, sha256, told }, &statement, false)
}

/// Checks a parsed mesh and converts it for the store.
fn validate_upload(
    received: ReadBytes,
    statement: &Statement,
    standalone: bool,
) -> Result<Upload, Problem> {
    let ReadBytes { read, bytes, sha256, told } = received;
    let is_image = matches!(read.mesh, Mesh::Image(_));
    let units = statement.units.filter(|_| !is_image);
    // The space of an image takes precedence.
    if !is_image {
        check_frame(&read, statement)?;
    }
    let frame = read.frame.or(statement.frame.map(Frame::from)).unwrap_or_default();
    let (mut report, stored) =
        rayon::join(|| mesh_report(&read), || encode_read(&read.mesh, frame));
    check_boundary(&report)?;
    let size = MeshSize {
        diagonal: report.diagonal,
        units: units.unwrap_or_default(),
        of_image: is_image,
    };
    let scale = size.check(statement.allow_any_scale)?;
    report.meshing = told;
    report.warnings.extend(scale.as_ref().map(WarningDocument::from));
    let id = uuid::Uuid::now_v7().to_string();
    let document = MeshDocument {
        id: id.clone(),
        sha256: sha256.clone(),
        bytes,
        format: read.format.name().to_ascii_lowercase().replace(' ', "-"),
        // Filled in from the clock of the database when it is read.
        created: String::new(),
        role: statement.role.clone(),
        units,
        frame: statement.frame,
        report,
    };
    let mesh = StoredMesh {
        frame: frame.known(),
        identity: document.identity(),
        ..StoredMesh::new(read, units, sha256.clone())
    };
    let stored = Bytes::from(stored?);
    let row = NewMesh {
        id,
        sha256,
        options: statement.identity(),
        blob: sha256_hex(&stored),
        bytes: stored,
        standalone,
        report: serde_json::to_string(&document).map_err(not_written)?,
    };
    Ok(Upload { row, document, mesh })
}

/// The form in which a mesh is stored: reading it gives the same mesh.
fn encode(shape: &StoredShape, frame: Frame) -> Result<Vec<u8>, Problem> {
    match shape {
        StoredShape::Volume(volume) => encode_volume(volume, frame),
        StoredShape::Surface(surface) => encode_surface(surface, frame),
        StoredShape::Image(image) => Ok(format::nrrd::write(image, frame)),
    }
}

/// The same of a mesh that was just read.
fn encode_read(mesh: &Mesh, frame: Frame) -> Result<Vec<u8>, Problem> {
    match mesh {
        Mesh::Volume(volume) => encode_volume(volume, frame),
        Mesh::Surface(surface) => encode_surface(surface, frame),
        Mesh::Image(image) => Ok(format::nrrd::write(image, frame)),
    }
}

fn encode_volume(volume: &VolumeMesh, frame: Frame) -> Result<Vec<u8>, Problem> {
    vtk::vtu::write(&VolumeOutput::plain(volume, frame)).map_err(not_written)
}

fn encode_surface(surface: &TriangleSurface, frame: Frame) -> Result<Vec<u8>, Problem> {
    vtk::vtp::write(&SurfaceOutput::plain(surface, frame)).map_err(not_written)
}

pub fn not_written(error: impl std::fmt::Display) -> Problem {
    Problem::new(ErrorCode::MeshParse, format!("the mesh cannot be written: {error}"))
}

/// A refusal of the bytes, with its numbers.
pub fn problem_of(error: &FormatError) -> Problem {
    let code = match error {
        FormatError::UnsupportedFormat { .. } => ErrorCode::UnsupportedMediaType,
        other => other.into(),
    };
    let mut problem = Problem::new(code, error.to_string());
    for (name, member) in error.members().into_iter().filter(|(name, _)| *name != "detail") {
        let value: Value = match member {
            Member::Text(text) => text.into(),
            Member::Count(count) => count.into(),
            Member::Number(number) => number.into(),
            Member::Counts(counts) => counts.into(),
            Member::Texts(texts) => texts.into(),
        };
        problem.members.insert(name.to_owned(), value);
    }
    problem
}

fn check_frame(read: &ReadMesh, statement: &Statement) -> Result<(), Problem> {
    let stated = statement.frame.map(Frame::from).and_then(Frame::known);
    let marked = read.frame.and_then(Frame::known);
    match (stated, marked) {
        (Some(stated), Some(marked)) if stated != marked => {
            let detail = format!("the upload says {stated} and the file says SPACE={marked}");
            Err(Problem::new(ErrorCode::FrameConflict, detail))
        }
        _ => Ok(()),
    }
}

/// Refuses a volume without a face on its boundary, of which no case can be made.
fn check_boundary(report: &MeshReport) -> Result<(), Problem> {
    if report.kind != MeshKind::Volume || report.triangles > 0 {
        return Ok(());
    }
    let doubled = report.warnings.iter().find(|warning| warning.code == DUPLICATE_CELLS);
    let why = doubled.map_or_else(String::new, |warning| format!(": {}", warning.detail));
    Err(Problem::new(ErrorCode::MeshDegenerate, format!("the mesh has no boundary face{why}")))
}

/// A mesh in another format, as `GET /v1/meshes/{id}/content` hands it out.
pub fn export(mesh: &StoredMesh, format: ExportFormat) -> Result<Vec<u8>, Problem> {
    let frame = mesh.frame.unwrap_or_default();
    let surface = mesh.surface();
    let surface = surface.as_deref().map(|surface| SurfaceOutput::plain(surface, frame));
    let written = match (format, &mesh.shape, &surface) {
        (ExportFormat::Vtu, StoredShape::Volume(volume), _) => {
            let written = VolumeInLps::new(volume, frame);
            vtk::vtu::write(&VolumeOutput::plain(&written.mesh, written.frame))
        }
        (ExportFormat::Nrrd, StoredShape::Image(_), _) => return encode(&mesh.shape, frame),
        (ExportFormat::Vtp, _, Some(surface)) => vtk::vtp::write(surface),
        (ExportFormat::Stl, _, Some(surface)) => format::stl::write(surface),
        (ExportFormat::Ply, _, Some(surface)) => format::ply::write(surface),
        (_, StoredShape::Image(_), _) => {
            return Err(Problem::new(
                ErrorCode::FormatNotAvailable,
                "an image has the form nrrd only",
            ));
        }
        _ => {
            let detail = "a surface has no VTU form, and no mesh has an NRRD form; \
                 vtp, stl and ply are there";
            return Err(Problem::new(ErrorCode::FormatNotAvailable, detail));
        }
    };
    written.map_err(not_written)
}

/// Formats of a stored mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    Vtu,
    Vtp,
    Stl,
    Ply,
    Nrrd,
}

impl ExportFormat {
    pub const ALL: [ExportFormat; 5] = [
        ExportFormat::Vtu,
        ExportFormat::Vtp,
        ExportFormat::Stl,
        ExportFormat::Ply,
        ExportFormat::Nrrd,
    ];

    /// The word in the request and the extension of the file.
    pub fn name(self) -> &'static str {
        match self {
            ExportFormat::Vtu => "vtu",
            ExportFormat::Vtp => "vtp",
            ExportFormat::Stl => "stl",
            ExportFormat::Ply => "ply",
            ExportFormat::Nrrd => "nrrd",
        }
    }

    pub fn media_type(self) -> &'static str {
        match self {
            ExportFormat::Vtu | ExportFormat::Vtp => "application/vnd.vtk.xml",
            ExportFormat::Stl => "model/stl",
            ExportFormat::Ply => "application/vnd.ply",
            ExportFormat::Nrrd => "application/x-nrrd",
        }
    }
}
