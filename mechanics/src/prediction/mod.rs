//! The path of one prediction: scene in, nodal displacement and its measures out.

mod adaptive;
mod adequate;
mod answer;
mod at_points;
mod bone_in_tissue;
mod branch;
mod build;
#[cfg(test)]
mod build_tests;
pub mod case;
mod check;
mod contact;
mod cut;
mod element_choice;
mod error_code;
mod exponential_tissue;
mod far_segment;
mod far_skin;
mod fibres;
mod following_pressure;
mod growth;
mod held;
mod hounsfield;
mod imaged_tissue;
mod listed;
mod locking;
mod method;
mod muscle;
mod muscle_field;
mod muscle_lines;
mod muscle_pieces;
mod muscle_tissue;
mod muscle_work;
mod no_rest;
mod node_conditions;
mod nonlinearity;
mod numerical_error;
mod numerics_revision;
mod off_wall;
mod point_force;
mod pressed_tissue;
mod pressure_kind;
mod problem;
mod reaction;
mod refined_scene;
mod refinement_goal;
mod refinement_verdict;
pub mod scene;
mod skin;
mod skin_check;
mod skin_overlap;
mod small_strain;
mod solved_loosely;
mod stated;
mod states;
mod stiff_layer;
mod suspect_constants;
mod unconstrained;
mod walls;
mod wrinkles;

use std::collections::BTreeMap;

pub use at_points::points_refined;
pub use case::{
    Activation, BodyFibres, Bone, Case, CaseSegment, ContactKind, FibreDirection, Growth,
    Hounsfield, Load, Mixing, Muscle, MuscleCourse, MuscleMixing, Plan, Prescribed, RegionNames,
    Settings, SkinMembrane, Sliding, SlidingNormal, Stiffening, TissueWindow,
};
pub use contact::{ContactPair, StepTouch, Touch};
pub use element_choice::ElementChoice;
pub use error_code::SceneErrorCode;
pub use growth::{VOLUME_CHANGE, linear_strain, nothing_left};
pub use hounsfield::MOST_SAMPLE_POINTS;
pub use imaged_tissue::{ImagedTissue, TissueShare};
pub use method::{Laws, Method, MethodKind, MethodProperties, Unknowns};
pub use muscle::PULL;
pub use muscle_field::{MuscleBody, MuscleField, MuscleTissue};
pub use muscle_work::MOST_MUSCLE_WORK;
pub use nonlinearity::{Estimated, Nonlinearity, NonlinearityUnknown, without_second_order};
pub use numerical_error::{NUMERICAL_ERROR_LARGE, NotEstimated, NumericalError};
pub use numerics_revision::NUMERICS_REVISION;
pub use problem::{NoScene, SceneError, SceneErrors};
pub use reaction::ConditionReaction;
pub use refined_scene::NotRefined;
pub use scene::Scene;
pub use skin::{Skin, least_moving};
pub use skin_overlap::{SKIN_OVERLAPS, skin_overlap};
pub use solved_loosely::solved_loosely;
pub use stated::{StatedCondition, StatedHold};
pub use suspect_constants::suspect_growth_and_pull;
pub use unconstrained::{NOTHING_HELD, RigidlyCarried, rigidly_carried};
pub use walls::{is_normal_turned, normal_turned};

pub use adaptive::{AdaptiveError, AdaptivePrediction, Level, Stop, predict_adaptively};
pub use adequate::{
    Accepted, Adequate, Considered, Errors, MeanErrors, NEWTON_MAY_TAKE, Objection, Rung,
    SECOND_ORDER_TAKES, TimedProgress, USUALLY_ACCEPTED_MM, predict_adequately,
};
use answer::Answer;
pub use answer::{equilibrium, estimates};
use bone_in_tissue::bones_in_tissue;
use following_pressure::pressure_turned;
pub use refinement_goal::{LimitError, RefinementGoal};

pub use crate::boundary::NodeClass;
use crate::mesh::{Vector, Warning};
pub use crate::model::cell_state::{CellState, CellStates};
pub use crate::model::fem::finite_strain::Advance;
pub use crate::model::fem::linear_states::node_states;
use crate::model::fem::strain::{
    CellDeformation, INVERTED, deformations, determinants_at_corners, inverted_cells,
};
pub use crate::model::problem::{InvertedCell, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::LoadStep;
pub use crate::solver::{NewtonReport, RestOnTheWay, SolveReport, SolverError};

/// A landmark farther than this from the tissue, in mm, is told to move as something it is not part of.
pub const LANDMARK_FAR: f64 = 2.0;

/// The answer. Node and cell order are those of the volume mesh of the case.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// In mm, for each node.
    pub displacement: Vec<Vector>,
    /// For each cell.
    pub deformation: Vec<CellDeformation>,
    /// Stress and strain of each cell, before anything is `corrected`; empty where they were not asked for or the method has none.
    pub states: CellStates,
    /// In mN: what each segment, `fixed`, `sliding` and `prescribed` nodes exert on the tissue.
    pub reactions: BTreeMap<String, Vector>,
    /// The same for each condition by itself, in the order of case and plan.
    pub condition_reactions: Vec<ConditionReaction>,
    /// The displacement of each landmark in mm.
    pub landmarks: BTreeMap<String, Vector>,
    /// Linearisation error, or the reason why it is not known.
    pub nonlinearity: Estimated,
    /// Discretisation error of the displacement, or the reason why it is not known.
    pub numerical_error: Result<NumericalError, NotEstimated>,
    /// The same at each landmark, in mm; empty where it is not known.
    pub landmarks_missing: BTreeMap<String, Vector>,
    /// How tissue presses on what it touches, where anything does.
    pub contact: Option<Touch>,
    pub solver: SolveReport,
    /// Rest at the end of each load step that was asked for.
    pub load_steps: Vec<PredictedStep>,
    /// The elements used, e.g. `hex8 mean dilatation`.
    pub elements: Vec<String>,
    /// Those of the scene and those of the solution.
    pub warnings: Vec<Warning>,
}

/// Tissue at rest at the end of a load step.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedStep {
    pub rest: RestOnTheWay,
    pub relative_residual: f64,
    pub is_stable: Option<bool>,
    /// As those of a [`crate::solver::LoadStep`].
    pub bulk_in_cells: f64,
    pub cells_with_bulk: usize,
    pub is_bulk_in_all: bool,
    /// As those of a prediction.
    pub reactions: BTreeMap<String, Vector>,
    /// Where anything presses.
    pub contact: Option<StepTouch>,
}

/// The load steps of an answer.
fn load_steps(
    scene: &Scene,
    steps: impl Iterator<Item = LoadStep>,
    touch: Option<&Touch>,
) -> Vec<PredictedStep> {
    let at = |step: usize| {
        let (touch, step) = touch.and_then(|touch| {
            Some((touch.at_load_steps.get(step)?, touch.contact.at_load_steps.get(step)?))
        })?;
        (!step.pressed.is_empty()).then_some((*touch, &*step.pressed))
    };
    let predicted = |(step, own): (usize, LoadStep)| {
        let (contact, pressed) = at(step).unzip();
        PredictedStep {
            reactions: reaction::by_class(scene, &own.reactions, pressed.unwrap_or_default()),
            rest: own.rest,
            relative_residual: own.relative_residual,
            is_stable: own.is_stable,
            bulk_in_cells: own.bulk_in_cells,
            cells_with_bulk: own.cells_with_bulk,
            is_bulk_in_all: own.is_bulk_in_all,
            contact,
        }
    };
    steps.enumerate().map(predicted).collect()
}

/// Solves a scene by the method it asks for. The same scene gives the same bits on any number of threads.
pub fn predict(scene: &Scene, progress: &dyn Progress) -> Result<Prediction, ModelError> {
    let answer = answer::solve(scene, progress)?.corrected(scene.settings.corrected);
    Ok(described(scene, answer, progress))
}

/// Where the nodes of a scene go, in mm, as [`predict`] has it: with what the mesh leaves out where the settings add that.
pub fn displacement(scene: &Scene, progress: &dyn Progress) -> Result<Vec<Vector>, ModelError> {
    let found = match scene.settings.corrected {
        true => answer::solve(scene, progress)?.corrected(true).equilibrium,
        false => equilibrium(scene, progress)?.0,
    };
    Ok(found.displacement)
}

/// What an answer says of the tissue and to a reader.
fn described(scene: &Scene, answer: Answer, progress: &dyn Progress) -> Prediction {
    let Answer { mut equilibrium, numerical_error, nonlinearity, contact } = answer;

    // 1. What it does to the tissue and to the landmarks.
    progress.phase(Phase::Surface);
    let deformation = deformations(&scene.mesh, &equilibrium.displacement);
    let landmarks =
        skin::landmark_displacement(&scene.mesh, &scene.landmarks, &equilibrium.displacement);

    // 2. What a reader must know.
    let mut warnings = scene.warnings.clone();
    warnings.extend(scene.nothing_moves());
    warnings.extend(equilibrium.warnings.iter().cloned());
    warnings.extend(loosely(scene, &equilibrium.solver));
    warnings.extend(contact.iter().flat_map(|touch| touch.warnings(scene)));
    let at_corners = determinants_at_corners(&scene.mesh, &equilibrium.displacement);
    let pairs = deformation.iter().zip(at_corners);
    let det_f: Vec<f64> = pairs.map(|(cell, at_corners)| cell.det_f.min(at_corners)).collect();
    // Quadratic cells have been looked at with their edge nodes.
    if !warnings.iter().any(|warning| warning.code == INVERTED) {
        warnings.extend(inverted_cells(&det_f));
    }
    warnings.extend(far_skin::outrun(scene, &equilibrium.displacement));
    warnings.extend(pressure_turned(scene, &equilibrium.displacement));
    warnings.extend(wrinkles::wrinkles(scene, &equilibrium.displacement));
    warnings.extend(small_strain::left(scene, &deformation, &nonlinearity));
    warnings.extend(exponential_tissue::warnings(scene, &equilibrium.displacement));
    warnings.extend(off_wall::left_wall(scene, &equilibrium.displacement));
    let moved = scene.skin.moved(&equilibrium.displacement);
    warnings.extend(skin_overlap(&scene.skin, &moved));
    warnings.extend(bones_in_tissue(scene, &equilibrium.displacement));
    warnings.extend(far_landmarks(&landmarks));
    warnings.extend(numerical_error::warnings(scene, &numerical_error));
    let at_landmarks =
        |missing| skin::landmark_displacement(&scene.mesh, &scene.landmarks, missing);
    let missing = numerical_error.as_ref().map(|error| at_landmarks(&error.missing));
    let newton = equilibrium.solver.newton.iter_mut();
    let steps = newton.flat_map(|newton| newton.load_steps.drain(..));
    let load_steps = load_steps(scene, steps, contact.as_ref());
    let pressed = contact.as_ref().map_or(&[][..], |touch| &touch.contact.pressed[..]);
    Prediction {
        load_steps,
        reactions: reaction::by_class(scene, &equilibrium.reactions, pressed),
        condition_reactions: reaction::by_condition(scene, &equilibrium, contact.as_ref()),
        nonlinearity,
        landmarks: landmarks.into_iter().map(|(name, (moved, _))| (name, moved)).collect(),
        landmarks_missing: missing
            .map(|all| all.into_iter().map(|(name, (missing, _))| (name, missing)).collect())
            .unwrap_or_default(),
        numerical_error,
        contact,
        solver: equilibrium.solver,
        elements: scene.elements(),
        displacement: equilibrium.displacement,
        states: equilibrium.states,
        deformation,
        warnings,
    }
}

/// What was asked of the equations of a scene, if little.
fn loosely(scene: &Scene, solver: &SolveReport) -> Option<Warning> {
    solved_loosely(scene.settings.relative_residual, solver.relative_residual)
}

/// The landmarks of a scene that are far from the surface they follow, as a prediction tells them: that needs no answer.
pub fn landmarks_far(scene: &Scene) -> Vec<Warning> {
    let still = vec![Vector::zeros(); scene.mesh.nodes.len()];
    far_landmarks(&skin::landmark_displacement(&scene.mesh, &scene.landmarks, &still))
}

fn far_landmarks(landmarks: &BTreeMap<String, (Vector, f64)>) -> Vec<Warning> {
    let far = landmarks.iter().filter(|(_, (_, distance))| *distance > LANDMARK_FAR);
    far.map(|(name, (_, distance))| {
        let detail = format!(
            "landmark {name:?} takes the displacement of the closest point of the tissue surface"
        );
        Warning::new("landmark-far", detail).with("distance_mm", *distance)
    })
    .collect()
}
