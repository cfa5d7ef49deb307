//! Arguments of a prediction: a file with the documents, or a mesh and a plan.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::documents::{CaseDocuments, CaseFile, read};
use super::failure::CommandError;
use super::files::{FileSource, FrameArgument, ScaleArguments, UnitArgument};
use super::mesh::{Meshed, ScanArguments, ScanContext};
use super::selection::{segment, selection};
use crate::schema::case::document::{FrameName, SegmentDocument};
use crate::schema::case::preset_name::PresetName;
use crate::schema::case::selection::SelectionDocument;
use crate::schema::methods::ElementName;
use crate::schema::{CaseDocument, MaterialDocument, PlanDocument, PredictDocument};
use mechanics::prediction::ElementChoice;

/// Groups of the arguments in the help.
const SCENE: &str = "What is predicted";
const BOUNDARY: &str = "What holds and moves it";
const TISSUE: &str = "Tissue";

/// Arguments about a mesh that is there, beside what is meshed first.
const FIXED_BESIDE_SCAN: &str = "--fixed has no meaning where a scan or surfaces are meshed: bone that no cut frees is fixed; \
                                 `facies mesh` writes a case.json whose `fixed` may be changed";
const SEGMENT_BESIDE_SCAN: &str = "--segment has no meaning where a scan or surfaces are meshed: segments are those of \
                                   `osteotomy` in the plan, or of --bone NAME=FILE";
const FRAME_BESIDE_SURFACES: &str = "--frame has no meaning where surfaces are meshed: the frame is that of their files; state `frame` \
                                     in the plan where they name none";

/// What is to be predicted.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// The case, plan and spec documents in one file; mesh paths are relative to it
    #[arg(long, value_name = "FILE", help_heading = SCENE)]
    pub case: Option<PathBuf>,
    /// The volume mesh: VTU, VTK or Gmsh
    #[arg(long, value_name = "FILE", conflicts_with = "case", help_heading = SCENE)]
    mesh: Option<PathBuf>,
    /// Fixed nodes: a set of the mesh, or the nodes where an integer array has a value, as in tag=4; may be given
    /// several times
    #[arg(long, value_name = "SET|ARRAY=VALUE", value_parser = selection, conflicts_with = "case", help_heading = BOUNDARY)]
    fixed: Vec<SelectionDocument>,
    /// The nodes of the skin, as for --fixed; default: every boundary face without constraint. Where a command meshes
    /// bone, the file of the skin around it
    #[arg(long, value_name = "SET|ARRAY=VALUE|FILE", conflicts_with = "case", help_heading = BOUNDARY)]
    skin: Option<String>,
    /// A bone that plans move by NAME, and its nodes, as for --fixed; may be given several times; node sets of the mesh
    /// are segments without it
    #[arg(long, value_name = "NAME=SET|NAME=ARRAY=VALUE", value_parser = segment, conflicts_with = "case", help_heading = BOUNDARY)]
    segment: Vec<SegmentDocument>,
    /// The unit of length of the mesh, or of the surfaces that are meshed; default mm
    #[arg(long, conflicts_with = "case", help_heading = SCENE)]
    units: Option<UnitArgument>,
    /// The frame of the mesh; default unspecified. Beside --scan or --labels that of an image which states none
    #[arg(long, conflicts_with = "case", help_heading = SCENE)]
    frame: Option<FrameArgument>,
    /// The material of all tissue by its name in the literature: `facies materials` lists them; moduli given as well override those of the preset
    #[arg(long, value_name = "NAME", value_parser = preset, conflicts_with = "case", help_heading = TISSUE)]
    preset: Option<PresetName>,
    /// Young's modulus of all tissue, in kPa; default 15
    #[arg(long, allow_negative_numbers = true, value_name = "KPA", conflicts_with = "case", help_heading = TISSUE)]
    young_modulus_kpa: Option<f64>,
    /// Poisson's ratio of all tissue; default 0.46
    #[arg(long, allow_negative_numbers = true, value_name = "RATIO", conflicts_with = "case", help_heading = TISSUE)]
    poisson_ratio: Option<f64>,
    /// The treatment of cells
    #[arg(long, default_value = "auto", conflicts_with = "case", help_heading = TISSUE)]
    element: ElementArgument,
    #[command(flatten)]
    scale: ScaleArguments,
}

/// The movement that is predicted, of commands about one.
#[derive(Debug, Args)]
pub struct PlanArgument {
    /// The plan document; its segments are segments of the case or node sets of the mesh
    #[arg(long, value_name = "FILE", conflicts_with = "case", help_heading = SCENE)]
    pub plan: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
#[value(rename_all = "snake_case")]
enum ElementArgument {
    Auto,
    Plain,
    MeanDilatation,
    Stabilised,
    Quadratic,
}

impl SceneArguments {
    /// The documents that the arguments name or stand for, with a plan where the command has one.
    pub fn documents(&self, plan: Option<&Path>) -> Result<CaseDocuments, CommandError> {
        let (file, path, folder) = match (&self.case, &self.mesh) {
            (Some(path), _) => {
                let folder = path.parent().unwrap_or(Path::new("")).to_owned();
                (read::<CaseFile>(path)?, path, folder)
            }
            (None, Some(mesh)) => (self.documents_of(mesh, plan)?, mesh, PathBuf::new()),
            (None, None) => {
                let detail =
                    "give --case, or --mesh and --plan, or a scan where a command takes one";
                return Err(CommandError::Usage(detail.to_owned()));
            }
        };
        let sources = FileSource::new(&folder, file.case.units, self.scale);
        Ok(CaseDocuments { file, path: path.clone(), folder, sources })
    }

    /// The documents of a scan or surfaces that are meshed first; the mesh is written into `mesh` of the folder for the result.
    pub fn documents_of_scan(
        &self,
        scan: &ScanArguments,
        plan: Option<&Path>,
        out: &Path,
    ) -> Result<CaseDocuments, CommandError> {
        if self.case.is_some() || self.mesh.is_some() {
            let detail = "give one of --case, --mesh, --scan and --bone: the last two become a mesh and a case";
            return Err(CommandError::Usage(detail.to_owned()));
        }
        self.refuse_beside_scan(scan)?;
        let folder = out.join("mesh");
        let (skin, units, scale) = (self.skin.as_deref(), self.units, self.scale);
        let frame = self.frame;
        let meshed = scan.mesh(&ScanContext { skin, plan, units, frame, scale }, &folder)?;
        meshed.print(&folder);
        let Meshed { mut file, meshes, .. } = meshed;
        file.spec = self.spec();
        let sources = FileSource::new(&folder, file.case.units, self.scale).with(meshes);
        Ok(CaseDocuments { file, path: folder.clone(), folder, sources })
    }

    /// Refuses what says of a mesh that is there what a meshing finds.
    fn refuse_beside_scan(&self, scan: &ScanArguments) -> Result<(), CommandError> {
        let given = [
            (!self.fixed.is_empty(), FIXED_BESIDE_SCAN),
            (!self.segment.is_empty(), SEGMENT_BESIDE_SCAN),
            (self.frame.is_some() && !scan.is_image(), FRAME_BESIDE_SURFACES),
        ];
        let refused: Vec<&str> =
            given.into_iter().filter(|(is_given, _)| *is_given).map(|(_, why)| why).collect();
        match refused.is_empty() {
            true => Ok(()),
            false => Err(CommandError::Usage(refused.join("; "))),
        }
    }

    fn documents_of(&self, mesh: &Path, plan: Option<&Path>) -> Result<CaseFile, CommandError> {
        let plan = plan.map(read::<PlanDocument>).transpose()?;
        let mut case =
            CaseDocument::of_volume(&mesh.to_string_lossy(), self.units.unwrap_or_default().unit());
        case.frame = self.frame.map_or(FrameName::Unspecified, |frame| frame.frame().into());
        let skin = self.skin.as_deref().map(selection).transpose();
        case.skin = skin.map_err(CommandError::Usage)?;
        case.fixed.clone_from(&self.fixed);
        case.segments.clone_from(&self.segment);
        Ok(CaseFile { case, plan, spec: self.spec() })
    }

    /// How tissue is computed, where no case file says it.
    fn spec(&self) -> PredictDocument {
        let choice = match self.element {
            ElementArgument::Auto => ElementChoice::Auto,
            ElementArgument::Plain => ElementChoice::Plain,
            ElementArgument::MeanDilatation => ElementChoice::MeanDilatation,
            ElementArgument::Stabilised => ElementChoice::Stabilised,
            ElementArgument::Quadratic => ElementChoice::Quadratic,
        };
        let element = ElementName::from(choice);
        let materials = self.material().map(|material| [("*".to_owned(), material)].into());
        PredictDocument { element, materials, ..PredictDocument::default() }
    }

    fn material(&self) -> Option<MaterialDocument> {
        let given = self.young_modulus_kpa.is_some() || self.poisson_ratio.is_some();
        (given || self.preset.is_some()).then_some(MaterialDocument {
            preset: self.preset,
            young_modulus_kpa: self.young_modulus_kpa,
            poisson_ratio: self.poisson_ratio,
            ..MaterialDocument::default()
        })
    }
}

fn preset(name: &str) -> Result<PresetName, String> {
    let found = PresetName::ALL.into_iter().find(|preset| preset.name() == name);
    let known = PresetName::ALL.map(PresetName::name).join(", ");
    found.ok_or_else(|| format!("there is no material {name:?}; there are {known}"))
}
