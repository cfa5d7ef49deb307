//! Meshes out of files, by paths relative to a folder.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use clap::{Args, ValueEnum};

use crate::jobs::{MeshSize, MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::case::document::LengthUnit;
use crate::schema::learn::model::MODEL_FILE;
use crate::schema::wire::canonical;
use crate::schema::{CaseDocument, ErrorCode};
use mechanics::format::{self, ReadLimits};
use mechanics::mesh::Frame;

/// Whether meshes are refused that no head can measure, as the service refuses them.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct ScaleArguments {
    /// Takes meshes of any size: without it one that measures less than 5 mm or more than 5 m is refused
    #[arg(long)]
    allow_any_scale: bool,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum UnitArgument {
    #[default]
    Mm,
    M,
    Um,
}

impl UnitArgument {
    pub fn unit(self) -> LengthUnit {
        match self {
            UnitArgument::Mm => LengthUnit::Mm,
            UnitArgument::M => LengthUnit::M,
            UnitArgument::Um => LengthUnit::Um,
        }
    }
}

/// Which way axes point that a file says nothing of.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum FrameArgument {
    #[value(name = "LPS")]
    Lps,
    #[value(name = "RAS")]
    Ras,
    Unspecified,
}

impl FrameArgument {
    pub fn frame(self) -> Frame {
        match self {
            FrameArgument::Lps => Frame::Lps,
            FrameArgument::Ras => Frame::Ras,
            FrameArgument::Unspecified => Frame::Unspecified,
        }
    }
}

/// What the meshes of files are in.
enum FileUnits {
    All(LengthUnit),
    /// By path, where each case says it for its own; two cases may disagree.
    OfCases(BTreeMap<String, LengthUnit>),
}

/// Reads each file once.
pub struct FileSource {
    folder: PathBuf,
    units: FileUnits,
    allow_any_scale: bool,
    /// Of images that state none.
    frame: Option<Frame>,
    read: Mutex<BTreeMap<String, StoredMesh>>,
    /// The documents that the command writes beside its result.
    beside: Vec<String>,
}

impl FileSource {
    pub fn new(folder: &Path, units: LengthUnit, scale: ScaleArguments) -> Self {
        FileSource {
            folder: folder.to_owned(),
            units: FileUnits::All(units),
            allow_any_scale: scale.allow_any_scale,
            frame: None,
            read: Mutex::default(),
            beside: Vec::new(),
        }
    }

    /// The same for a command that writes documents beside its result.
    pub fn beside(self, documents: &[&str]) -> Self {
        FileSource { beside: documents.iter().map(|&name| name.to_owned()).collect(), ..self }
    }

    /// The same with the frame of images that state none.
    pub fn in_frame(self, frame: Option<Frame>) -> Self {
        FileSource { frame: frame.and_then(Frame::known), ..self }
    }

    /// The frame of a mesh that was read: that of its file, or of an image the one that is stated for those without.
    fn frame_of(&self, id: &str, stored: &StoredMesh) -> Result<Option<Frame>, SourceError> {
        let marked = stored.frame.and_then(Frame::known);
        let StoredShape::Image(_) = &stored.shape else { return Ok(stored.frame) };
        match (marked, self.frame) {
            (Some(mark), Some(frame)) if mark != frame => {
                let detail = format!(
                    "--frame has no meaning beside an image that states its axes: the file is in {mark}, --frame says {frame}; the plan \
                     has a `frame` of its own"
                );
                let code = ErrorCode::FrameConflict;
                Err(SourceError::Refused { id: id.to_owned(), code, detail })
            }
            (marked, frame) => Ok(marked.or(frame).or(stored.frame)),
        }
    }

    /// The same with meshes that need not be read.
    pub fn with(self, read: BTreeMap<String, StoredMesh>) -> Self {
        FileSource { read: Mutex::new(read), ..self }
    }

    /// Files of several cases.
    pub fn of_cases<'a>(
        cases: impl Iterator<Item = &'a CaseDocument>,
        scale: ScaleArguments,
    ) -> Self {
        let named = |case: &CaseDocument| {
            let units = case.units;
            case.mesh_ids().into_iter().map(move |id| (id, units))
        };
        let units = FileUnits::OfCases(cases.flat_map(named).collect());
        FileSource { units, ..FileSource::new(Path::new(""), LengthUnit::Mm, scale) }
    }

    /// The unit that every mesh is in, and the one that a mesh is measured in.
    fn units_of(&self, id: &str) -> (Option<LengthUnit>, LengthUnit) {
        match &self.units {
            FileUnits::All(units) => (Some(*units), *units),
            FileUnits::OfCases(cases) => (None, cases.get(id).copied().unwrap_or_default()),
        }
    }
}

impl MeshSource for FileSource {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        let mut read = self.read.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(known) = read.get(id) {
            return Ok(known.clone());
        }
        let path = self.folder.join(id);
        let bytes = std::fs::read(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound => SourceError::Refused {
                id: id.to_owned(),
                code: ErrorCode::UnknownMesh,
                detail: format!("there is no mesh {id:?}: no file {}", path.display()),
            },
            ErrorKind::IsADirectory => SourceError::Refused {
                id: id.to_owned(),
                code: ErrorCode::UnknownMesh,
                detail: format!(
                    "{} is a folder, and no file of a mesh; the files of a DICOM series are given as one zip archive of them",
                    path.display()
                ),
            },
            _ => SourceError::Unreadable {
                id: id.to_owned(),
                detail: error.to_string(),
                may_pass: false,
            },
        })?;
        let mesh = format::read(&bytes, &ReadLimits::default()).map_err(|error| {
            let (code, detail) = ((&error).into(), error.to_string());
            SourceError::Refused { id: id.to_owned(), code, detail }
        })?;
        let (stated, measured) = self.units_of(id);
        let mut stored = StoredMesh::new(mesh, stated, canonical::sha256_hex(&bytes));
        stored.frame = self.frame_of(id, &stored)?;
        let size = MeshSize::of(&stored.shape, measured);
        size.check(self.allow_any_scale).map_err(|problem| {
            let remedy = match &stored.shape {
                StoredShape::Image(_) => {
                    "the unit and the spacing are those that the file of the image states, which --units does not replace: correct them in \
                     the file (`xyzt_units` and `pixdim` of NIfTI, `space units` and `space directions` of NRRD)"
                }
                StoredShape::Volume(_) | StoredShape::Surface(_) => {
                    "state the unit by --units or by `units` of the case"
                }
            };
            let detail = format!(
                "{}: {remedy}, or take it as it is by --allow-any-scale",
                problem.detail
            );
            SourceError::Refused { id: id.to_owned(), code: problem.code, detail }
        })?;
        read.insert(id.to_owned(), stored.clone());
        Ok(stored)
    }

    fn model(&self, job: &str) -> Result<Vec<u8>, SourceError> {
        let path = self.folder.join(job).join(MODEL_FILE);
        std::fs::read(path).map_err(|_| SourceError::Unknown { id: job.to_owned() })
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        Err(SourceError::Unknown { id: job.to_owned() })
    }

    fn takes_any_scale(&self) -> bool {
        self.allow_any_scale
    }

    fn files(&self) -> Vec<PathBuf> {
        let read = self.read.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        read.keys().map(|id| self.folder.join(id)).collect()
    }

    fn beside_result(&self) -> Vec<String> {
        self.beside.clone()
    }
}

/// A path that leads from a folder to a file, for documents that may move together with their meshes.
pub fn relative(file: &Path, folder: &Path) -> PathBuf {
    let (Ok(file), Ok(folder)) = (file.canonicalize(), folder.canonicalize()) else {
        return file.to_owned();
    };
    let common = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| Path::new(".."));
    let down = file.components().skip(common);
    up.map(Path::to_owned).chain(down.map(|part| Path::new(part.as_os_str()).to_owned())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relative_path_leads_to_the_file() {
        let root = tempfile::tempdir().expect("a folder");
        let (near, far) = (root.path().join("a/b"), root.path().join("c"));
        std::fs::create_dir_all(&near).expect("made");
        std::fs::create_dir_all(&far).expect("made");
        let file = far.join("mesh.vtu");
        std::fs::write(&file, "").expect("written");
        assert_eq!(relative(&file, &near), Path::new("../../c/mesh.vtu"));
        assert_eq!(relative(&file, &far), Path::new("mesh.vtu"));
    }
}
