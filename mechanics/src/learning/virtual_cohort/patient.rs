//! A virtual patient: a face, an operation, what happens, what is measured of it, and what models predict.
//!
//! What happens to a half head: finite strain of the true tissue, and on top of it, to first order, the change of weight by fat that
//! gains or loses volume and the pull of the muscle around the mouth. To a generic face all of it happens at once, at finite strain and
//! with lips that press on each other where they touch. Fat and muscle do more after an operation on two jaws, which is what a
//! cohort can teach; the rest of them is chance. Models see the mapped preoperative mesh and the plan, and no contact.
//!
//! A patient whose tissue finds no rest, in truth or in a model, is drawn once more, by other draws that are the same each time.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::super::cohort::CohortError;
use super::super::features::Features;
use super::super::measures;
use super::face::face;
use super::generic::{AROUND_MOUTH, face_case, shaped};
use super::noise::Scanned;
use super::operation::{OPERATIONS, Operation, TWO};
use super::tissue::{Tissue, rubin_bodner, supposed, true_tissue};
use crate::boundary::NodeSelection;
use crate::draws::Draws;
use crate::material::MaterialError;
use crate::mesh::generic_face::FaceMuscle;
use crate::mesh::half_head::LAYERS;
use crate::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};
use crate::model::problem::ModelError;
use crate::prediction::{
    Activation, Case, CaseSegment, ContactKind, FibreDirection, Growth, Method, Muscle,
    MuscleCourse, Plan, RegionNames, Scene, SceneErrors, Settings, SolverError, equilibrium,
};
use crate::progress::Progress;

use super::super::theta::THETAS;

/// So often a patient is drawn at most.
const MOST_DRAWS: u64 = 5;

/// The muscle around the mouth of a half head, which is a region.
const MUSCLE: &str = "muscle";

/// A patient as a cohort sees them; displacements in mm, three numbers for each point of the skin.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualPatient {
    pub operation: Operation,
    /// The skin at rest, as it was mapped.
    pub face: TriangleSurface,
    /// Points of the skin by region.
    pub regions: BTreeMap<String, Vec<u32>>,
    pub features: Features,
    pub bone: Vec<f64>,
    pub linear: Vec<f64>,
    pub nonlinear: Vec<f64>,
    /// Of Rubin and Bodner's tissue with theta 0.5, 1 and 1.5.
    pub rubin_bodner: [Vec<f64>; 3],
    /// As it is measured.
    pub actual: Vec<f64>,
    /// As it is: the best that any prediction could say.
    pub happened: Vec<f64>,
    /// The area that presses on what it touches in mm2; none where the truth has no contact.
    pub contact_area: Option<f64>,
}

/// What a face is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceKind {
    /// Of tetrahedra, glued to bone, under seven modes of shape.
    #[default]
    HalfHead,
    /// Of hexahedra, with lips and mucosa that slides, under six modes of shape; what happens is in contact.
    Generic,
}

/// What a cohort is made by: the same for the same numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Making {
    pub seed: u64,
    pub face: FaceKind,
    /// Of the faces: 1728 times its square in tetrahedra of a half head, 5616 times in hexahedra of a generic face.
    pub fineness: usize,
    /// The mean length of a mapping error at the skin in mm.
    pub mapping: f64,
}

/// A patient who was drawn once more.
#[derive(Clone, Debug, PartialEq)]
pub struct Redrawn {
    /// From 0.
    pub patient: usize,
    /// What had no rest, and why.
    pub why: String,
}

/// A patient with the scene that the models see.
pub struct DrawnPatient {
    pub patient: VirtualPatient,
    pub scene: Scene,
    /// The draws before.
    pub redrawn: Vec<Redrawn>,
}

#[derive(Debug, thiserror::Error)]
pub enum VirtualError {
    #[error(transparent)]
    Material(#[from] MaterialError),
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Cohort(#[from] CohortError),
}

impl VirtualError {
    /// Whether other draws of the same patient may do without it.
    fn is_of_draws(&self) -> bool {
        match self {
            VirtualError::Model(ModelError::Solver(error)) => {
                !matches!(error, SolverError::Stopped | SolverError::OverBudget { .. })
            }
            VirtualError::Model(_) => true,
            VirtualError::Material(_) | VirtualError::Scene(_) | VirtualError::Cohort(_) => false,
        }
    }
}

/// A face with its muscles.
struct Face {
    kind: FaceKind,
    mesh: VolumeMesh,
    muscles: Vec<FaceMuscle>,
}

/// What happened to each node in mm, and the area in contact in mm2.
type Happened = (Vec<Vector>, Option<f64>);

impl DrawnPatient {
    /// The patient of a number in a cohort.
    pub fn new(
        number: usize,
        making: Making,
        progress: &dyn Progress,
    ) -> Result<Self, VirtualError> {
        let mut redrawn = Vec::new();
        let mut draw = 0;
        loop {
            // Other than those of any patient.
            let mut draws = Draws::of(making.seed, number as u64 + (draw << 32));
            match VirtualPatient::drawn(number, making, &mut draws, progress) {
                Ok((patient, scene)) => return Ok(DrawnPatient { patient, scene, redrawn }),
                Err(error) if error.is_of_draws() && draw + 1 < MOST_DRAWS => {
                    redrawn.push(Redrawn { patient: number, why: error.to_string() });
                    draw += 1;
                }
                Err(error) => return Err(error),
            }
        }
    }
}

impl VirtualPatient {
    fn drawn(
        number: usize,
        making: Making,
        draws: &mut Draws,
        progress: &dyn Progress,
    ) -> Result<(Self, Scene), VirtualError> {
        let face = Face::drawn(making, draws);
        let operation = OPERATIONS[number % OPERATIONS.len()];
        let plan = operation.plan(&face.mesh, draws);

        // 1. What happens, and what is measured of it.
        let mut contact_area = None;
        let happens = |draws: &mut Draws| {
            let (moved, area) = face.happened(&plan, operation, draws, progress)?;
            contact_area = area;
            Ok::<_, VirtualError>(moved)
        };
        let Scanned { happened, measured, mapped } =
            Scanned::of(&face.mesh, making.mapping, draws, happens)?;

        // 2. What models predict on the mapped mesh.
        let known = Arc::new(mapped);
        let solved = |tissue: Tissue, method: Method| {
            let settings = Settings { method, estimate: false, ..Settings::default() };
            let scene = Scene::new(&face.case(known.clone(), tissue), &plan, &settings)?;
            let (equilibrium, _) = equilibrium(&scene, progress)?;
            Ok::<_, VirtualError>((scene, equilibrium.displacement))
        };
        let (scene, linear) = solved(supposed()?, Method::FemLinear)?;
        let (_, nonlinear) = solved(supposed()?, Method::FemNonlinear)?;
        let of_theta = |theta| {
            let (_, moved) = solved(rubin_bodner(theta)?, Method::FemNonlinear)?;
            Ok::<_, VirtualError>(measures::skin(&scene, &moved))
        };
        let [low, high] = THETAS;
        let patient = VirtualPatient {
            operation,
            face: scene.skin.surface.clone(),
            regions: scene.skin.regions.clone(),
            features: measures::features(&scene, &linear),
            bone: measures::bone(&scene, &linear),
            linear: measures::skin(&scene, &linear),
            nonlinear: measures::skin(&scene, &nonlinear),
            rubin_bodner: [of_theta(low)?, of_theta(1.0)?, of_theta(high)?],
            actual: measures::skin(&scene, &measured),
            happened: measures::skin(&scene, &happened),
            contact_area,
        };
        Ok((patient, scene))
    }
}

impl Face {
    fn drawn(making: Making, draws: &mut Draws) -> Self {
        let Making { face: kind, fineness, .. } = making;
        let (mesh, muscles) = match kind {
            FaceKind::HalfHead => (face(fineness, draws), Vec::new()),
            FaceKind::Generic => shaped(fineness, draws),
        };
        Face { kind, mesh, muscles }
    }

    fn case(&self, volume: Arc<VolumeMesh>, materials: Tissue) -> Case {
        match self.kind {
            FaceKind::HalfHead => half_head_case(volume, materials),
            FaceKind::Generic => Case { materials, ..face_case(volume, &self.muscles) },
        }
    }

    fn happened(
        &self,
        plan: &Plan,
        operation: Operation,
        draws: &mut Draws,
        progress: &dyn Progress,
    ) -> Result<Happened, VirtualError> {
        let tissue = true_tissue(draws)?;
        let [lost, pull] = match operation.class == TWO {
            true => [0.12, 8.0],
            false => [0.05, 3.0],
        };
        let volume_change = -lost + 0.03 * draws.usual();
        let stress = pull * draws.between(0.5, 1.5);
        let muscle = match self.kind {
            FaceKind::HalfHead => MUSCLE,
            FaceKind::Generic => AROUND_MOUTH,
        };
        let inner = Plan {
            growth: vec![Growth { region: "fat".to_owned(), volume_change }],
            activations: vec![Activation { muscle: muscle.to_owned(), stress }],
            ..Plan::default()
        };
        let case = self.case(Arc::new(self.mesh.clone()), tissue);
        let solved = |plan: &Plan, method: Method, contact: ContactKind| {
            let settings = Settings { method, contact, estimate: false, ..Settings::default() };
            let (equilibrium, touch) = equilibrium(&Scene::new(&case, plan, &settings)?, progress)?;
            Ok::<_, VirtualError>((equilibrium.displacement, touch.map_or(0.0, |own| own.area())))
        };
        match self.kind {
            FaceKind::HalfHead => {
                let (moved, _) = solved(plan, Method::FemNonlinear, ContactKind::default())?;
                let (changed, _) = solved(&inner, Method::FemLinear, ContactKind::default())?;
                let both = moved.iter().zip(&changed).map(|(moved, changed)| moved + changed);
                Ok((both.collect(), None))
            }
            FaceKind::Generic => {
                let whole = Plan { segments: plan.segments.clone(), ..inner };
                let (moved, area) = solved(&whole, Method::FemNonlinear, ContactKind::Unilateral)?;
                Ok((moved, Some(area)))
            }
        }
    }
}

/// The half head of the studies, without its bone surfaces.
fn half_head_case(volume: Arc<VolumeMesh>, materials: Tissue) -> Case {
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let segment = |name: &str| CaseSegment { name: name.to_owned(), nodes: set(name) };
    let names = (0..).zip(LAYERS).map(|(label, layer)| (label, layer.to_owned())).collect();
    let fibres = Some(FibreDirection::Uniform(Vector::x()));
    let course = MuscleCourse::Region { region: MUSCLE.to_owned(), fibres };
    Case {
        frame: Frame::Lps,
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        skin: Some(set("skin")),
        skin_regions: ["nose", "lips", "chin"].map(|name| (name.to_owned(), set(name))).into(),
        segments: vec![segment("maxilla"), segment("mandible")],
        fixed: vec![set("skull"), set("rim")],
        muscles: vec![Muscle { name: MUSCLE.to_owned(), course, tissue: None, stiffening: None }],
        materials,
        volume,
        ..Case::default()
    }
}
