//! What goes into a prediction, as stated by a client: unchecked names, checked values.

use crate::boundary::NodeSelection;
use crate::image::ImageVolume;
use crate::material::{LinearElastic, PlaneStress};
use crate::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};
use crate::model::fem::mass_tensor::MassTensorSettings;
use crate::model::mass_spring::MassSpringSettings;
use crate::model::spline::VolumeSpline;
use crate::model::thickness_warp::ThicknessWarp;
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
    pub sliding: Vec<Sliding>,
    /// By region name; `*` serves every region without an entry of its own.
    pub materials: BTreeMap<String, LinearElastic>,
    /// Materials by what an image shows, over those of the regions.
    pub hounsfield: Option<Hounsfield>,
    /// Where the fibres run, by region name or `*`; of use where a material has fibres.
    pub fibres: BTreeMap<String, FibreDirection>,
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
}

#[derive(Clone, Debug, PartialEq)]
pub enum SlidingNormal {
    /// The normals of the selected boundary faces.
    Surface,
    Direction(Vector),
}

/// What the surgeon decided, and, for mechanical cases, what else acts.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    pub segments: Vec<PlannedSegment>,
    pub prescribed: Vec<Prescribed>,
    pub loads: Vec<Load>,
}

/// Displacements in mm prescribed at nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Prescribed {
    /// `None` leaves a component free.
    Uniform { nodes: NodeSelection, displacement: [Option<f64>; 3] },
    /// Taken from a vector array of the volume mesh.
    FromArray { nodes: NodeSelection, array: String },
}

/// What pushes and pulls: mN, kPa, mm/ms².
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

/// The element for tetrahedra and the treatment of volume change in the other cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ElementChoice {
    /// The same as `Stabilised`.
    #[default]
    Auto,
    /// Full integration for every shape.
    Plain,
    /// Mean dilatation for hex8 and wedge6, the plain element for tet4.
    MeanDilatation,
    /// Mean dilatation for hex8 and wedge6, displacement and stabilised pressure for tet4.
    Stabilised,
    /// Tetrahedra with a node in the middle of each edge; no other shapes.
    Quadratic,
}

/// The way of modelling, with what only it has to be told.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Method {
    /// Linear finite elements at small strain.
    #[default]
    FemLinear,
    /// Springs along the edges of tetrahedra.
    MassSpring(MassSpringSettings),
    /// The energy of plain linear tetrahedra, brought to rest as its settings say.
    MassTensor(MassTensorSettings),
    /// The mass-tensor of tetrahedra with fibres: force = V g_j.C.g_k u, the plain finite element.
    MassTensorTransverse,
    /// A lattice of control points over the tissue.
    VolumeSpline(VolumeSpline),
    /// Tissue that rides on the nearest bone.
    ThicknessWarp(ThicknessWarp),
}

impl Method {
    /// Whether it solves for the nodes of elements.
    pub fn is_of_elements(&self) -> bool {
        matches!(self, Method::FemLinear | Method::MassTensor(_) | Method::MassTensorTransverse)
    }

    /// Whether its tissue may be stiffer along fibres than across them.
    pub fn knows_fibres(&self) -> bool {
        matches!(self, Method::FemLinear | Method::MassTensorTransverse)
    }

    /// Whether the skin may be a membrane of its own.
    pub fn knows_membrane(&self) -> bool {
        self.is_of_elements()
    }

    /// True where strain is the symmetric part of the displacement gradient, so that turning is taken for
    /// stretching.
    pub fn is_small_strain(&self) -> bool {
        self.is_of_elements() || matches!(self, Method::VolumeSpline(_))
    }
}

/// How the numbers are to be found.
#[derive(Clone, Debug)]
pub struct Settings {
    pub method: Method,
    pub element: ElementChoice,
    /// False lets sliding nodes go free.
    pub sliding: bool,
    /// |f - K u| / |f_D| of the free rows at which the solver may stop; in [1e-14, 1e-2].
    pub relative_residual: f64,
    /// What matrix and solver may take, in MB.
    pub memory_mb: f64,
    /// Absent: the skin is tissue like the rest.
    pub membrane: Option<SkinMembrane>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::FemLinear,
            element: ElementChoice::Auto,
            sliding: true,
            relative_residual: 1e-8,
            memory_mb: 4000.0,
            membrane: None,
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

/// What becomes of a cell with several tissues in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mixing {
    /// It is the tissue of its mean value.
    #[default]
    Mean,
    /// It is a mixture of its tissues.
    Fraction,
}
