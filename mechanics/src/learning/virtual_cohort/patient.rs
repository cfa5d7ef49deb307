//! A virtual patient: a face, an operation, what happens, what is measured of it, and what models predict.
//!
//! What happens: finite strain of the true tissue, and on top of it, to first order, the change of weight by fat that gains or
//! loses volume and the pull of the muscle around the mouth. Both are larger after an operation on two jaws, which is what a
//! cohort can teach; the rest of them is chance. Models see the mapped preoperative mesh and the plan.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::super::cohort::CohortError;
use super::super::features::Features;
use super::super::measures;
use super::face::face;
use super::noise::Scanned;
use super::operation::{OPERATIONS, Operation, TWO};
use super::tissue::{Tissue, rubin_bodner, supposed, true_tissue};
use crate::boundary::NodeSelection;
use crate::draws::Draws;
use crate::material::MaterialError;
use crate::mesh::half_head::LAYERS;
use crate::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};
use crate::model::problem::ModelError;
use crate::prediction::{
    Activation, Case, CaseSegment, FibreDirection, Growth, Method, Muscle, MuscleCourse, Plan,
    RegionNames, Scene, SceneErrors, Settings, equilibrium,
};
use crate::progress::Progress;

use super::super::theta::THETAS;

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
}

/// What a cohort is made by: the same for the same numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Making {
    pub seed: u64,
    /// Of the faces: 1728 times its square in tetrahedra.
    pub fineness: usize,
    /// The mean length of a mapping error at the skin in mm.
    pub mapping: f64,
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

impl VirtualPatient {
    /// The patient of a number in a cohort.
    pub fn new(
        number: usize,
        making: Making,
        progress: &dyn Progress,
    ) -> Result<Self, VirtualError> {
        let mut draws = Draws::of(making.seed, number as u64);
        let mesh = face(making.fineness, &mut draws);
        let operation = OPERATIONS[number % OPERATIONS.len()];
        let plan = operation.plan(&mesh, &mut draws);

        // 1. What happens, and what is measured of it.
        let happens = |draws: &mut Draws| happened(&mesh, &plan, operation, draws, progress);
        let Scanned { happened, measured, mapped } =
            Scanned::of(&mesh, making.mapping, &mut draws, happens)?;

        // 2. What models predict on the mapped mesh.
        let known = Arc::new(mapped);
        let solved =
            |tissue: Tissue, method: Method| solved(&known, &plan, tissue, method, progress);
        let (scene, linear) = solved(supposed()?, Method::FemLinear)?;
        let (_, nonlinear) = solved(supposed()?, Method::FemNonlinear)?;
        let of_theta = |theta| {
            let (_, moved) = solved(rubin_bodner(theta)?, Method::FemNonlinear)?;
            Ok::<_, VirtualError>(measures::skin(&scene, &moved))
        };
        let [low, high] = THETAS;
        Ok(VirtualPatient {
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
        })
    }
}

/// The displacement of every node in mm.
fn happened(
    mesh: &VolumeMesh,
    plan: &Plan,
    operation: Operation,
    draws: &mut Draws,
    progress: &dyn Progress,
) -> Result<Vec<Vector>, VirtualError> {
    let tissue = true_tissue(draws)?;
    let [lost, pull] = match operation.class == TWO {
        true => [0.12, 8.0],
        false => [0.05, 3.0],
    };
    let volume_change = -lost + 0.03 * draws.usual();
    let stress = pull * draws.between(0.5, 1.5);
    let inner = Plan {
        growth: vec![Growth { region: "fat".to_owned(), volume_change }],
        activations: vec![Activation { muscle: "muscle".to_owned(), stress }],
        ..Plan::default()
    };
    let mesh = Arc::new(mesh.clone());
    let (_, moved) = solved(&mesh, plan, tissue.clone(), Method::FemNonlinear, progress)?;
    let (_, changed) = solved(&mesh, &inner, tissue, Method::FemLinear, progress)?;
    Ok(moved.iter().zip(&changed).map(|(moved, changed)| moved + changed).collect())
}

fn solved(
    mesh: &Arc<VolumeMesh>,
    plan: &Plan,
    tissue: Tissue,
    method: Method,
    progress: &dyn Progress,
) -> Result<(Scene, Vec<Vector>), VirtualError> {
    let settings = Settings { method, estimate: false, ..Settings::default() };
    let scene = Scene::new(&case(mesh.clone(), tissue), plan, &settings)?;
    let (equilibrium, _) = equilibrium(&scene, progress)?;
    Ok((scene, equilibrium.displacement))
}

/// The half head of the studies, without its bone surfaces.
fn case(volume: Arc<VolumeMesh>, materials: Tissue) -> Case {
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let segment = |name: &str| CaseSegment { name: name.to_owned(), nodes: set(name) };
    let names = (0..).zip(LAYERS).map(|(label, layer)| (label, layer.to_owned())).collect();
    let fibres = Some(FibreDirection::Uniform(Vector::x()));
    let course = MuscleCourse::Region { region: "muscle".to_owned(), fibres };
    Case {
        frame: Frame::Lps,
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        skin: Some(set("skin")),
        skin_regions: ["nose", "lips", "chin"].map(|name| (name.to_owned(), set(name))).into(),
        segments: vec![segment("maxilla"), segment("mandible")],
        fixed: vec![set("skull"), set("rim")],
        muscles: vec![Muscle { name: "muscle".to_owned(), course, tissue: None, stiffening: None }],
        materials,
        volume,
        ..Case::default()
    }
}
