//! `result.json`, the manifest of a job: files, statistics, reactions, provenance.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::adequacy::AdequacyDocument;
use super::correction::CorrectedDocument;
use super::keep::KeptMeshDocument;
use super::newton::{LoadStepDocument, NewtonDocument};
use super::nonlinearity::NonlinearityDocument;
use super::output::PictureName;
use super::planned::{MeasureDocument, SymmetryDocument};
use super::pressing::ContactDocument;
use super::refine::RefinementDocument;
use super::stress::StressDocument;
use super::tissue_law::TissueLawDocument;
use crate::schema::Triple;
use crate::schema::case::acquisition::AcquisitionDocument;
use crate::schema::case::document::{FrameName, LengthUnit};
use crate::schema::case::hounsfield::ImagedTissueDocument;
use crate::schema::case::preset::UsedPresetDocument;
use crate::schema::cohort::result::CohortResultDocument;
use crate::schema::compare::result::{ComparisonDocument, StatDocument};
use crate::schema::conform::result::ConformationDocument;
use crate::schema::learn::result::LearningDocument;
use crate::schema::meshing::result::MeshingResultDocument;
use crate::schema::optimise::result::OptimisationDocument;
use crate::schema::plan::document::PlanDocument;
use crate::schema::reproduce::result::ReproductionDocument;
use crate::schema::study::report::StudySummaryDocument;
use crate::schema::wire::warning::WarningDocument;
use mechanics::prediction::ConditionReaction;

pub use super::timing::TimingDocument;
pub use crate::schema::engine::EngineDocument;

/// The notice in every result.
pub const NOT_A_DEVICE: &str =
    "not a medical device: a research computation, not to be used for treatment decisions";

/// The result of a job. Lengths are mm in the frame of `provenance`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResultDocument {
    /// The id of the job; absent in results of the command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    /// The files beside this one.
    pub files: Vec<FileDocument>,
    /// Of a job: pictures and reports that are drawn when first requested, available like files.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pictures: Vec<PictureName>,
    /// Absent from comparisons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub statistics: Option<StatisticsDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub comparison: Option<ComparisonDocument>,
    /// Of inverse planning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub optimisation: Option<OptimisationDocument>,
    /// Of a study.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub study: Option<StudySummaryDocument>,
    /// Of a meshing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub meshing: Option<MeshingResultDocument>,
    /// The movements of an operation, of a job that reproduces one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub reproduction: Option<ReproductionDocument>,
    /// A template on a patient, of a job of kind `conform`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub conformation: Option<ConformationDocument>,
    /// Comparison of methods over subjects, of a job of kind `cohort`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cohort: Option<CohortResultDocument>,
    /// The learned model and its validation, of a job of kind `learn`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub learning: Option<LearningDocument>,
    /// The meshes stored at the request of the spec.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kept: Vec<KeptMeshDocument>,
    /// Cephalometric measures before, as planned and as predicted, from the landmarks of the case.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cephalometry: Vec<MeasureDocument>,
    /// Paired and midline landmarks relative to the mid-sagittal plane of the head before the operation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub symmetry: Vec<SymmetryDocument>,
    /// Contact of tissue; absent without any, or if the spec does not request it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub contact: Option<ContactDocument>,
    /// Stress in the tissue, if requested by the spec.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub stress: Option<StressDocument>,
    /// The choice of the model, if an accepted error was stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub adequacy: Option<AdequacyDocument>,
    /// The correction by a learned model, if requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub correction: Option<CorrectedDocument>,
    /// The refinement of the mesh, if requested. All else in the result is at the nodes of the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub refinement: Option<RefinementDocument>,
    /// Null if it was not estimated.
    pub numerical_error_mm: Option<NumericalErrorDocument>,
    /// The linearisation error; null if `nonlinearity_unknown` says why it is not estimated.
    #[serde(default)]
    pub nonlinearity_mm: Option<NonlinearityDocument>,
    /// Of a prediction without an estimate of the linearisation error: why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub nonlinearity_unknown: Option<String>,
    /// Why the error of a prediction was not estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub numerical_error_unknown: Option<String>,
    /// The forces in mN that the nodes of each segment, and all `fixed`, `sliding` and `prescribed` nodes, exert on the
    /// tissue: a force that pulls tissue upwards points upwards.
    #[serde(default)]
    pub reaction_millinewton: BTreeMap<String, Triple>,
    /// Former name of `reaction_millinewton`, until the next version of this document.
    #[serde(default)]
    #[schema(deprecated)]
    pub reaction_mn: BTreeMap<String, Triple>,
    /// The same for each boundary condition of case and plan, and for each bone in contact with tissue: with the loads they
    /// add up to zero.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reactions: Vec<ReactionDocument>,
    /// Equilibrium after each load step, if `fem_nonlinear.load_steps` is in the spec.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load_steps: Vec<LoadStepDocument>,
    pub provenance: ProvenanceDocument,
    pub warnings: Vec<WarningDocument>,
}

impl ResultDocument {
    /// A result with files only; the other members are set by the kind of job.
    pub fn new(
        job: Option<String>,
        files: &[FileDocument],
        provenance: ProvenanceDocument,
        warnings: Vec<WarningDocument>,
    ) -> Self {
        ResultDocument {
            job,
            files: files.to_vec(),
            statistics: None,
            comparison: None,
            optimisation: None,
            study: None,
            meshing: None,
            reproduction: None,
            conformation: None,
            cohort: None,
            learning: None,
            pictures: Vec::new(),
            kept: Vec::new(),
            cephalometry: Vec::new(),
            symmetry: Vec::new(),
            contact: None,
            stress: None,
            adequacy: None,
            correction: None,
            refinement: None,
            numerical_error_mm: None,
            nonlinearity_mm: None,
            nonlinearity_unknown: None,
            numerical_error_unknown: None,
            reaction_millinewton: BTreeMap::new(),
            reaction_mn: BTreeMap::new(),
            reactions: Vec::new(),
            load_steps: Vec::new(),
            provenance,
            warnings,
        }
    }
}

/// A file of a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FileDocument {
    pub name: String,
    pub media_type: String,
    pub bytes: u64,
    /// In hexadecimal.
    pub sha256: String,
}

/// The force that one boundary condition exerts on the tissue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReactionDocument {
    /// Its place in the case or the plan, e.g. `/case/sliding/0`, `/plan/prescribed/1` or `/case/bones/0`.
    pub condition: String,
    /// The segment that moves it; absent if no segment does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
    /// The nodes with a direction constrained by it and no stronger condition; of a bone the points in contact with it.
    pub nodes: u64,
    /// Absent in results of before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub force_millinewton: Option<Triple>,
    /// Former name of `force_millinewton`, until the next version of this document.
    #[schema(deprecated)]
    pub force_mn: Triple,
}

/// Displacement of the skin, in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StatisticsDocument {
    pub skin: DisplacementDocument,
    /// By the names of `skin_regions`.
    pub regions: BTreeMap<String, DisplacementDocument>,
    /// The displacement of each landmark.
    pub landmarks: BTreeMap<String, Triple>,
    /// Tissues of the mesh by an image, if materials come from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub imaged: Option<ImagedTissueDocument>,
}

/// The length of the displacement over skin nodes, in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DisplacementDocument {
    /// Unweighted.
    pub nodes: StatDocument,
    /// Weighted by the area around each node.
    pub area: StatDocument,
}

/// The estimated discretisation error of the displacement: unweighted lengths over nodes, in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NumericalErrorDocument {
    /// Over the skin.
    pub mean: f64,
    pub p95: f64,
    pub max: f64,
    /// By the names of `skin_regions`.
    pub regions: BTreeMap<String, ErrorLengthsDocument>,
    /// At each landmark.
    pub landmarks: BTreeMap<String, f64>,
    /// Whether it was added to the displacement, by `corrected` of the spec.
    pub corrected: bool,
}

/// Lengths of an estimated error over nodes, in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ErrorLengthsDocument {
    pub mean: f64,
    pub p95: f64,
    pub max: f64,
}

/// Provenance of the numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ProvenanceDocument {
    pub engine: EngineDocument,
    /// SHA-256 over everything that determines the numbers.
    pub spec_hash: String,
    pub inputs: Vec<InputDocument>,
    /// The plan at that time, and the id of the stored plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub plan: Option<PlanDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub plan_id: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub method: Option<String>,
    /// Of `auto`, in addition to `method`: the chosen model, as `adequacy.taken`. With `second_order` the numbers are not
    /// those of `fem_linear` alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub model: Option<String>,
    /// Why this method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub why: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub solver: Option<SolverDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mesh: Option<MeshSummaryDocument>,
    /// Of methods of finite strain: the law of each region, or of each tissue of an image, with its constants.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub laws: BTreeMap<String, TissueLawDocument>,
    /// Materials of the literature in use, in full: by region of the case, or tissue of its image.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub presets: BTreeMap<String, UsedPresetDocument>,
    /// How the scan of the case was taken, from the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub acquisition: Option<AcquisitionDocument>,
    pub threads: u32,
    /// `bitwise`: the same input gives the same bits on any number of threads.
    pub determinism: String,
    pub timing: TimingDocument,
    /// Of the whole process so far; absent if the system does not report it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub peak_rss_mb: Option<f64>,
    pub frame: FrameName,
    pub units: LengthUnit,
    /// RFC 3339, UTC.
    pub created: String,
    pub statement: String,
}

/// An input mesh or image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct InputDocument {
    /// `volume`, `bone NAME`, `surface`, `image`, `prediction` or `actual`.
    pub role: String,
    pub sha256: String,
    /// 0 of an image.
    pub nodes: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cells: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub triangles: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub voxels: Option<u64>,
}

/// How the equations were solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SolverDocument {
    pub name: String,
    pub preconditioner: String,
    pub why: String,
    pub unknowns: u64,
    pub iterations: u64,
    /// |f - K u| / |f_D| of the free rows, recomputed at the end; with pressures, of both equations.
    pub relative_residual: f64,
    pub wanted_residual: f64,
    pub elements: Vec<String>,
    /// The relative residual after each iteration, at most 200 of them, of methods with their own
    /// iterations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub history: Vec<f64>,
    /// Steps of load or time.
    pub steps: u32,
    /// Of tissue at finite strain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub newton: Option<NewtonDocument>,
}

/// The mesh of the computation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeshSummaryDocument {
    pub nodes: u64,
    pub cells: u64,
    /// The smallest scaled Jacobian of a cell; 1 is perfect, below 0 is inverted.
    pub min_quality: f64,
    pub inverted: u64,
}

impl From<&ConditionReaction> for ReactionDocument {
    fn from(reaction: &ConditionReaction) -> Self {
        ReactionDocument {
            condition: reaction.pointer.clone(),
            segment: reaction.segment.clone(),
            nodes: reaction.nodes as u64,
            force_millinewton: Some(reaction.force.into()),
            force_mn: reaction.force.into(),
        }
    }
}
