//! Twins of the generic face that are operated, and the four ways to model them that Kim et al. 2012 hold against each other.
//!
//! A twin is the generic face under six modes of shape, with its muscles. What happens to it: neo-Hookean tissue at finite strain,
//! its muscles mixed into it geometrically, sliding along its teeth, and to first order what fibres add to the stiffness of muscles
//! and a loss of fat, all by constants of its own. What is measured of it has the errors of a mapping and a registration. Models are
//! linear and have the mapped face, the plan and constants that nobody measured: one tissue, or muscles along their fibres in it
//! (Voigt); glued to the teeth, or sliding along them.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::generic::{VESTIBULES, face_case, shaped};
use super::noise::{Scanned, USUAL_MAPPING};
use super::operation::{OPERATIONS, Operation};
use super::patient::VirtualError;
use crate::boundary::NodeSelection;
use crate::draws::Draws;
use crate::material::mixture::MixingRule;
use crate::material::{Fibre, FibreLaw, LinearElastic, MaterialError};
use crate::mesh::generic_face::FaceMuscle;
use crate::mesh::{Vector, VolumeMesh};
use crate::prediction::{Case, Growth, Method, MuscleMixing, Plan, Scene, Settings, equilibrium};
use crate::progress::{Inner, Progress};

/// A way to model a twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    pub name: &'static str,
    pub muscles: bool,
    pub sliding: bool,
}

/// One tissue glued to the teeth, muscles in it, sliding along the teeth, and both.
pub const VARIANTS: [Variant; 4] = [
    Variant { name: "homogeneous", muscles: false, sliding: false },
    Variant { name: "muscles", muscles: true, sliding: false },
    Variant { name: "sliding", muscles: false, sliding: true },
    Variant { name: "muscles and sliding", muscles: true, sliding: true },
];

/// A twin, and how far each variant is from what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Twin {
    pub operation: &'static str,
    /// Points of the skin by region.
    pub regions: BTreeMap<String, Vec<u32>>,
    /// At each point of the skin in mm, in the order of [`VARIANTS`].
    pub distances: [Vec<f64>; 4],
    /// The same of what happened: no model can be nearer than the measurement.
    pub measurement: Vec<f64>,
    /// The same of a face that stays as it is.
    pub movement: Vec<f64>,
}

/// What tissue is made of: the rest, and muscle along lines.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tissue {
    rest: LinearElastic,
    muscle: Option<LinearElastic>,
    rule: MixingRule,
}

/// Makes so many twins, and models each in four ways.
pub fn twins(
    count: usize,
    seed: u64,
    fineness: usize,
    progress: &dyn Progress,
) -> Result<Vec<Twin>, VirtualError> {
    let made = AtomicUsize::new(0);
    let one = |number| {
        let twin = Twin::new(number, seed, fineness, &Inner(progress))?;
        progress.step(made.fetch_add(1, Ordering::Relaxed) + 1, count);
        Ok(twin)
    };
    (0..count).into_par_iter().map(one).collect()
}

impl Twin {
    /// The twin of a number in the cohort of a seed.
    fn new(
        number: usize,
        seed: u64,
        fineness: usize,
        progress: &dyn Progress,
    ) -> Result<Self, VirtualError> {
        let mut draws = Draws::of(seed, number as u64);
        let mut face = OperatedFace::new(number, fineness, &mut draws);
        let happens = |draws: &mut Draws| face.happened(draws, progress);
        let Scanned { happened, measured, mapped } =
            Scanned::of(&face.mesh, USUAL_MAPPING, &mut draws, happens)?;
        face.mesh = Arc::new(mapped);
        let apart = |moved: &[Vector], scene: &Scene| -> Vec<f64> {
            let nodes = scene.skin.nodes().iter().map(|&node| node as usize);
            nodes.map(|node| (moved[node] - measured[node]).norm()).collect()
        };
        let mut distances: [Vec<f64>; 4] = Default::default();
        let (mut regions, mut beside) = (BTreeMap::new(), [Vec::new(), Vec::new()]);
        for (variant, own) in VARIANTS.iter().zip(&mut distances) {
            let tissue = supposed(variant.muscles)?;
            let settings = (Method::FemLinear, variant.sliding);
            let (scene, moved) = face.solved(&face.plan, tissue, settings, progress)?;
            *own = apart(&moved, &scene);
            let still = vec![Vector::zeros(); moved.len()];
            beside = [apart(&happened, &scene), apart(&still, &scene)];
            regions.clone_from(&scene.skin.regions);
        }
        let [measurement, movement] = beside;
        let operation = face.operation.name;
        Ok(Twin { operation, regions, distances, measurement, movement })
    }
}

/// A face with its muscles, and what is done to it.
struct OperatedFace {
    mesh: Arc<VolumeMesh>,
    muscles: Vec<FaceMuscle>,
    operation: Operation,
    plan: Plan,
}

impl OperatedFace {
    fn new(number: usize, fineness: usize, draws: &mut Draws) -> Self {
        let (mesh, muscles) = shaped(fineness, draws);
        let operation = OPERATIONS[number % OPERATIONS.len()];
        let plan = operation.plan(&mesh, draws);
        OperatedFace { mesh: Arc::new(mesh), muscles, operation, plan }
    }

    /// The displacement of every node in mm.
    fn happened(
        &self,
        draws: &mut Draws,
        progress: &dyn Progress,
    ) -> Result<Vec<Vector>, VirtualError> {
        let rest = LinearElastic::new(50.0, 0.48, 1.0)?;
        let across = 50.0 * draws.between(2.0, 6.0);
        let muscle = LinearElastic::new(across, 0.46, 1.0)?;
        let fibred = along(muscle, across * draws.between(1.5, 3.0))?;
        let of = |muscle| Tissue { rest, muscle: Some(muscle), rule: MixingRule::Geometric };
        let volume_change = -0.05 + 0.03 * draws.usual();
        let growth = vec![Growth { region: "fat".to_owned(), volume_change }];
        let lost = Plan { growth, ..Plan::default() };
        let solve = |plan: &Plan, muscle, method| {
            let (_, moved) = self.solved(plan, of(muscle), (method, true), progress)?;
            Ok::<_, VirtualError>(moved)
        };
        let moved = solve(&self.plan, muscle, Method::FemNonlinear)?;
        let with = solve(&self.plan, fibred, Method::FemLinear)?;
        let without = solve(&self.plan, muscle, Method::FemLinear)?;
        let shrunk = solve(&lost, fibred, Method::FemLinear)?;
        let sum = |node: usize| moved[node] + with[node] - without[node] + shrunk[node];
        Ok((0..moved.len()).map(sum).collect())
    }

    fn solved(
        &self,
        plan: &Plan,
        tissue: Tissue,
        (method, sliding): (Method, bool),
        progress: &dyn Progress,
    ) -> Result<(Scene, Vec<Vector>), VirtualError> {
        let settings = Settings { method, estimate: false, ..Settings::default() };
        let scene = Scene::new(&self.case(tissue, sliding), plan, &settings)?;
        let (equilibrium, _) = equilibrium(&scene, progress)?;
        Ok((scene, equilibrium.displacement))
    }

    fn case(&self, tissue: Tissue, sliding: bool) -> Case {
        let mut case = face_case(self.mesh.clone(), &self.muscles);
        if !sliding {
            case.sliding.clear();
            for (segment, (vestibule, name)) in case.segments.iter_mut().zip(VESTIBULES) {
                let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
                segment.nodes = NodeSelection::Any(vec![set(name), set(vestibule)]);
            }
        }
        match tissue.muscle {
            Some(_) => case.muscles.iter_mut().for_each(|muscle| muscle.tissue = tissue.muscle),
            None => case.muscles.clear(),
        }
        Case {
            muscle_mixing: MuscleMixing { rule: tissue.rule, ..MuscleMixing::default() },
            materials: BTreeMap::from([("*".to_owned(), tissue.rest)]),
            ..case
        }
    }
}

/// What the models take the tissue for: the optimum of Zachow et al. 2006, its muscles twice as stiff along their fibres.
fn supposed(has_muscles: bool) -> Result<Tissue, MaterialError> {
    let muscle = along(LinearElastic::new(150.0, 0.44, 1.0)?, 300.0)?;
    let rest = LinearElastic::new(50.0, 0.455, 1.0)?;
    Ok(Tissue { rest, muscle: has_muscles.then_some(muscle), rule: MixingRule::Voigt })
}

fn along(across: LinearElastic, young_modulus: f64) -> Result<LinearElastic, MaterialError> {
    across.with_fibre(&Fibre { young_modulus, shear_modulus: None, law: FibreLaw::Engineering })
}
