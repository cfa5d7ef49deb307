//! Input of a prediction, as stated by a client: unchecked names, checked values.

use super::element_choice::ElementChoice;
use super::method::Method;
use crate::boundary::NodeSelection;
use crate::image::ImageVolume;
use crate::material::mixture::MixingRule;
use crate::material::{Fibre, LinearElastic, MaterialError, PlaneStress};
use crate::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};
use crate::model::fem::finite_strain::Advance;
use crate::plan::PlannedSegment;
use std::collections::BTreeMap;

/// A patient's scene. All lengths in mm, all coordinates in `frame`.
#[derive(Clone, Debug, Default)]
pub struct Case {
    pub frame: Frame,
    pub volume: std::sync::Arc<VolumeMesh>,
    /// Surfaces by the key under which `bones` and selections ask for them.
    pub surfaces: BTreeMap<String, std::sync::Arc<TriangleSurface>>,
    pub bones: Vec<Bone>,
    pub landmarks: BTreeMap<String, Vector>,
    /// Absent: one region named `tissue`.
    pub regions: Option<RegionNames>,
    /// Absent: all boundary faces without a joined, fixed or sliding node.
    pub skin: Option<NodeSelection>,
    pub skin_regions: BTreeMap<String, NodeSelection>,
    pub segments: Vec<CaseSegment>,
    pub fixed: Vec<NodeSelection>,
    /// True lets a plan carry the whole tissue away as one, with nothing that stays.
    pub allow_unfixed: bool,
    pub sliding: Vec<Sliding>,
    /// By region name; `*` serves every region without an entry of its own.
    pub materials: BTreeMap<String, LinearElastic>,
    /// Materials by what an image shows, over those of the regions.
    pub hounsfield: Option<Hounsfield>,
    /// Where the fibres run, by region name or `*`; of use where a material has fibres.
    pub fibres: BTreeMap<String, FibreDirection>,
    /// Muscles that a plan may activate; names differ.
    pub muscles: Vec<Muscle>,
    pub muscle_mixing: MuscleMixing,
}

/// The course of fibres or of lines of the skin; its sign and its length do not matter.
#[derive(Clone, Debug, PartialEq)]
pub enum FibreDirection {
    /// The same everywhere.
    Uniform(Vector),
    /// A vector array of the volume mesh: of cells for fibres, of nodes for lines of the skin.
    Array(String),
}

/// The skin as a sheet that resists stretching beside the tissue under it.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinMembrane {
    pub sheet: PlaneStress,
    /// The course of its lines; absent where the sheet is isotropic.
    pub lines: Option<FibreDirection>,
}

/// A bone surface; it moves with the segment of the same name, if there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    pub name: String,
    pub surface: String,
}

/// The integer cell array that divides the mesh into regions, and names for its values.
/// A value without a name is called by its number.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionNames {
    pub array: String,
    pub names: BTreeMap<i64, String>,
}

/// The nodes that a bone segment carries with it.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseSegment {
    pub name: String,
    pub nodes: NodeSelection,
}

/// Nodes held across a direction and free along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sliding {
    pub nodes: NodeSelection,
    pub normal: SlidingNormal,
    /// The segment that carries the wall; absent where the wall stays.
    pub segment: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum SlidingNormal {
    /// The normals of the selected boundary faces.
    Surface,
    Direction(Vector),
}

/// The surgeon's plan, and the loads of mechanical cases.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    pub segments: Vec<PlannedSegment>,
    pub prescribed: Vec<Prescribed>,
    pub loads: Vec<Load>,
    pub growth: Vec<Growth>,
    pub activations: Vec<Activation>,
}

impl Plan {
    /// Whether loads, growth or muscles are stated.
    pub fn states_loads(&self) -> bool {
        !(self.loads.is_empty() && self.growth.is_empty() && self.activations.is_empty())
    }

    /// Whether some tissue is stated to change its volume, by more than nothing.
    pub fn grows(&self) -> bool {
        self.growth.iter().any(|growth| growth.volume_change != 0.0)
    }
}

/// Tissue that gains volume or loses it: swelling, weight change, atrophy.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// Of the case; `*` stands for every region without an entry of its own.
    pub region: String,
    /// As a share of the volume, in [`VOLUME_CHANGE`](super::growth::VOLUME_CHANGE).
    pub volume_change: f64,
}

/// A muscle that pulls.
#[derive(Clone, Debug, PartialEq)]
pub struct Activation {
    pub muscle: String,
    /// Along its fibres, in kPa, in [`PULL`](super::muscle::PULL).
    pub stress: f64,
}

/// Tissue that may pull along its fibres.
#[derive(Clone, Debug, PartialEq)]
pub struct Muscle {
    pub name: String,
    pub course: MuscleCourse,
    /// What it is made of, mixed by its share into the tissue of its cells; absent: it pulls in tissue that stays what it is.
    /// Of lines and bodies only.
    pub tissue: Option<LinearElastic>,
    /// How its tissue becomes stiffer along its fibres as it pulls; of tissue with fibres.
    pub stiffening: Option<Stiffening>,
}

/// A modulus along fibres that grows with the stress with which they pull, E_f (1 - T / T_0) + E_0 T / T_0 (Chabanas et al. 2003).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffening {
    /// At rest.
    pub fibre: Fibre,
    /// E_0 in kPa, of the fully active muscle.
    pub young_modulus: f64,
    /// T_0 in kPa, above 0.
    pub stress: f64,
}

impl Stiffening {
    /// Tissue whose fibres pull with a stress in kPa.
    pub fn at(&self, tissue: LinearElastic, stress: f64) -> Result<LinearElastic, MaterialError> {
        let share = stress / self.stress;
        let young_modulus = self.fibre.young_modulus * (1.0 - share) + self.young_modulus * share;
        tissue.without_fibre().with_fibre(&Fibre { young_modulus, ..self.fibre })
    }
}

/// Where a muscle is, and which way it pulls.
#[derive(Clone, Debug, PartialEq)]
pub enum MuscleCourse {
    /// The cells of a region; without fibres of its own along those of the region's material.
    Region { region: String, fibres: Option<FibreDirection> },
    /// Around polylines: full at a line, and nothing at the distance `within` in mm.
    Lines { lines: Vec<Vec<Vector>>, within: f64 },
    /// Inside a closed surface in mm.
    Body { surface: std::sync::Arc<TriangleSurface>, fibres: BodyFibres },
}

/// The course of fibres in a body.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyFibres {
    /// Along the longest axis of its box, halved so many times (0 to 2): of strap muscles only.
    Box {
        halvings: usize,
    },
    Course(FibreDirection),
    /// Along the nearest of some polylines.
    Lines(Vec<Vec<Vector>>),
}

/// How muscles become the tissue of cells that they fill in part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MuscleMixing {
    pub rule: MixingRule,
    /// Points in each cell by which the share of a body is found.
    pub samples: usize,
}

impl Default for MuscleMixing {
    fn default() -> Self {
        MuscleMixing { rule: MixingRule::Voigt, samples: 64 }
    }
}

/// Displacements in mm prescribed at nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Prescribed {
    /// `None` leaves a component free.
    Uniform { nodes: NodeSelection, displacement: [Option<f64>; 3] },
    /// Taken from a vector array of the volume mesh.
    FromArray { nodes: NodeSelection, array: String },
}

/// Loads: mN, kPa, mm/ms².
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// The same force at each node.
    Force {
        nodes: NodeSelection,
        force: Vector,
    },
    /// On boundary faces all of whose nodes are selected.
    Traction {
        faces: NodeSelection,
        traction: Vector,
    },
    /// Positive into the body.
    Pressure {
        faces: NodeSelection,
        pressure: f64,
    },
    Gravity {
        acceleration: Vector,
    },
}

/// Kind of contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactKind {
    /// Nothing: sliding nodes go free.
    None,
    /// Sliding nodes are held across their walls.
    #[default]
    Sliding,
    /// The same, and no part of the boundary passes through another one.
    Unilateral,
    /// `Unilateral` where a gap closes, which is reported; `Sliding` elsewhere.
    Auto,
}

impl ContactKind {
    /// Whether sliding nodes are held.
    pub fn holds_sliding(self) -> bool {
        self != ContactKind::None
    }

    /// Whether parts of the boundary are kept from passing through each other.
    pub fn is_unilateral(self) -> bool {
        matches!(self, ContactKind::Unilateral | ContactKind::Auto)
    }
}

/// How the numbers are to be found.
#[derive(Clone, Debug)]
pub struct Settings {
    pub method: Method,
    pub element: ElementChoice,
    pub contact: ContactKind,
    /// |f - K u| / |f_D| of the free rows at which the solver may stop; in [1e-14, 1e-2].
    pub relative_residual: f64,
    /// Memory limit of matrix and solver, in MB.
    pub memory_mb: f64,
    /// Absent: the skin is tissue like the rest.
    pub membrane: Option<SkinMembrane>,
    /// Whether the discretisation error is estimated, where it can be.
    pub estimate: bool,
    /// Whether what the mesh leaves out, as far as that is estimated, is added to the displacement.
    pub corrected: bool,
    /// Whether stress and strain of the cells are wanted, of methods that have them.
    pub states: bool,
    /// At finite strain.
    pub advance: Advance,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::FemLinear,
            element: ElementChoice::Auto,
            contact: ContactKind::Sliding,
            relative_residual: 1e-8,
            memory_mb: 4000.0,
            membrane: None,
            estimate: true,
            corrected: false,
            states: false,
            advance: Advance::default(),
        }
    }
}

/// An image and what its values mean.
#[derive(Clone, Debug)]
pub struct Hounsfield {
    /// In mm, in the frame of the case.
    pub image: std::sync::Arc<ImageVolume>,
    /// Points in each cell.
    pub samples: usize,
    /// Their windows do not overlap.
    pub tissues: Vec<TissueWindow>,
    pub mixing: Mixing,
}

/// A tissue and its values, `from_hu` <= value < `to_hu`.
#[derive(Clone, Debug, PartialEq)]
pub struct TissueWindow {
    pub name: String,
    pub from_hu: f64,
    pub to_hu: f64,
    pub material: LinearElastic,
}

/// Treatment of a cell with several tissues.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mixing {
    /// It is the tissue of its mean value.
    #[default]
    Mean,
    /// It is a mixture of its tissues.
    Fraction,
}
