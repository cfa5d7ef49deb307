//! Adaptive refinement: solve, estimate, mark, refine, until the estimated error of the skin is accepted or a bound is met.
//!
//! The error that is estimated at the skin nodes of the case (`numerical_error`) is held against what is accepted, over the whole
//! skin that moves and over parts of it that have a limit of their own; with what linearity leaves out where `auto` asks (`refinement_verdict`). Where it is larger, the goal of the next refinement is that error
//! itself, made linear: the mean over that skin of the displacement along the direction in which each place is estimated to
//! be off, J(v) = int w . v dA with w = sum_g e / (|e| tol_g A_g) over the limits g that are not met; at a landmark the displacement
//! of that point alone. Cells with half of what
//! the mesh leaves out of it (`discretisation_error::indicators`) are halved three times. Tissue is not made anew: the finer
//! scene asks the question of the first one (`refined_scene`), and its answer is given at the nodes of the case.

use std::collections::BTreeMap;

use super::answer::Answer;
use super::nonlinearity::{self, Estimated};
use super::numerical_error::{self, NotEstimated, NumericalError};
use super::refined_scene::NotRefined;
use super::refinement_goal::{Limit, LimitError, RefinementGoal, SkinPart};
use super::refinement_verdict::left_out;
use super::scene::Scene;
use super::{Prediction, described};
use crate::mesh::bisection::{Bisection, HALVES_EVERY_EDGE, NotTetrahedra};
use crate::mesh::{Vector, Warning};
use crate::model::fem::discretisation_error::{Estimate, Goal, marked};
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::fem::strain::deformations;
use crate::model::problem::ModelError;
use crate::progress::Progress;

/// The share of the indicators that marked cells have together.
const MARKED_SHARE: f64 = 0.5;

/// What a finer mesh may need more than its number of cells tells.
const MEMORY_MARGIN: f64 = 1.15;

/// Time for a mesh of more cells grows by this power of their number.
const TIME_GROWTH: f64 = 1.1;

/// A mesh that was solved on.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    pub cells: usize,
    pub nodes: usize,
    pub unknowns: usize,
    /// The estimated error at the skin nodes of the case that move, in mm.
    pub mean_mm: f64,
    pub p95_mm: f64,
    /// Its mean over each part of the skin that has a limit of its own, and itself at each landmark that has one.
    pub regions_mm: BTreeMap<String, f64>,
    pub landmarks_mm: BTreeMap<String, f64>,
    pub spent_s: f64,
}

/// Why no finer mesh was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The estimate is within what is accepted.
    Met,
    /// It is, but a warning speaks against the answer or names what no estimate has: muscles, points, or what linearity leaves out, where
    /// that is unknown or above what is accepted.
    Incomplete,
    Cells,
    Time,
    Memory,
}

/// A prediction with the meshes that it took.
pub struct AdaptivePrediction {
    /// At the nodes and cells of the scene.
    pub prediction: Prediction,
    /// None where no mesh was made.
    pub finest: Option<Finest>,
    pub levels: Vec<Level>,
    pub stop: Stop,
}

/// The last mesh of an adaptive prediction.
pub struct Finest {
    /// Any scene on the mesh of the case may be taken to this one by `Scene::on`.
    pub bisection: Bisection,
    pub scene: Scene,
    /// Of all its nodes, in mm.
    pub displacement: Vec<Vector>,
}

/// Why nothing was refined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AdaptiveError {
    #[error(transparent)]
    Shape(#[from] NotTetrahedra),
    #[error(transparent)]
    Scene(#[from] NotRefined),
    #[error(
        "meshes are refined where an estimate of their error asks for it, and there is none: {0}"
    )]
    NotEstimated(#[from] NotEstimated),
    #[error(transparent)]
    Limit(#[from] LimitError),
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl Stop {
    /// As documents call it.
    pub fn name(self) -> &'static str {
        match self {
            Stop::Met => "met",
            Stop::Incomplete => "incomplete",
            Stop::Cells => "cells",
            Stop::Time => "time",
            Stop::Memory => "memory",
        }
    }
}

/// A scene on one mesh, solved.
struct Step<'a> {
    scene: &'a Scene,
    system: LinearSystem<'a>,
    solved: Solved,
    error: NumericalError,
    /// Once it is asked for.
    linearity: Option<Estimated>,
}

impl<'a> Step<'a> {
    fn solve(scene: &'a Scene, progress: &dyn Progress) -> Result<Self, AdaptiveError> {
        let system = scene.assemble(progress)?.ok_or(NotEstimated::Quadratic)?;
        let solved = system.solve(&[scene.load_case()], progress)?.remove(0);
        let error = numerical_error::estimate(scene, &system, &solved, progress)??;
        Ok(Step { scene, system, solved, error, linearity: None })
    }

    fn answer(mut self, progress: &dyn Progress) -> Result<Answer, ModelError> {
        let nonlinearity = self.linearity(progress)?.clone();
        let Step { scene, solved, error, .. } = self;
        let answer = Answer {
            equilibrium: solved.equilibrium,
            numerical_error: Ok(error),
            nonlinearity,
            contact: None,
        };
        Ok(answer.corrected(scene.settings.corrected))
    }

    /// What linearity leaves out.
    fn linearity(&mut self, progress: &dyn Progress) -> Result<&Estimated, ModelError> {
        let found = match (self.linearity.take(), nonlinearity::reason_for_none(self.scene)) {
            (Some(known), _) => known,
            (None, Some(reason)) => Err(reason),
            (None, None) => {
                let (found, doubt) =
                    nonlinearity::estimate(self.scene, &self.system, &self.solved, true, progress)?;
                self.solved.equilibrium.warnings.extend(doubt);
                found
            }
        };
        Ok(self.linearity.insert(found))
    }

    /// The limits that a finer mesh may meet and this one does not.
    fn open<'b>(
        &mut self,
        first: &Scene,
        limits: &'b [Limit<'b>],
        is_of_answer: bool,
        progress: &dyn Progress,
    ) -> Result<Vec<&'b Limit<'b>>, ModelError> {
        let scenes = [first, self.scene];
        let of_mesh = |own: &'b Limit<'b>| {
            let missing = &self.error.missing;
            let expected = match is_of_answer {
                true => own.expected_of_mesh(scenes, missing),
                false => own.error(scenes, missing),
            };
            (own, expected)
        };
        let expected: Vec<(&Limit, f64)> = limits.iter().map(of_mesh).collect();
        let open_where = |is_open: &dyn Fn(&Limit, f64) -> bool| {
            expected
                .iter()
                .filter(|(own, of_mesh)| is_open(own, *of_mesh))
                .map(|(own, _)| *own)
                .collect()
        };
        let open: Vec<&Limit> = open_where(&|own, of_mesh| of_mesh > own.accepted_mm);
        if !is_of_answer || !open.is_empty() {
            return Ok(open);
        }
        let Ok(left) = self.linearity(progress)? else { return Ok(open) };
        Ok(open_where(&|own, of_mesh| {
            let of_linearity = own.error(scenes, &left.left_out);
            of_linearity < own.accepted_mm && of_linearity + of_mesh > own.accepted_mm
        }))
    }

    /// The cells from which most of the error comes that is not accepted.
    fn marked(&self, limits: &[&Limit], progress: &dyn Progress) -> Result<Vec<usize>, ModelError> {
        let Scene { mesh, skin, boundary, distributed: loads, .. } = self.scene;
        let mut weights = vec![Vector::zeros(); mesh.nodes.len()];
        let displacement = &self.solved.equilibrium.displacement;
        for limit in limits {
            for (node, weight) in limit.weights(self.scene, displacement, &self.error.missing) {
                weights[node as usize] += weight;
            }
        }
        let nodes = skin.nodes();
        let corners = |points: &[u32; 3]| points.map(|point| nodes[point as usize]);
        let triangles: Vec<[u32; 3]> = skin.surface.triangles.iter().map(corners).collect();
        let goal = Goal { triangles: &triangles, weights: &weights };
        let estimate =
            Estimate { tissue: self.scene.tissue(), system: &self.system, boundary, loads };
        Ok(marked(&estimate.indicators(&self.solved, &goal, progress)?, MARKED_SHARE))
    }

    /// The next mesh, or the bound that does not allow one.
    fn finer(
        &self,
        bisection: &Bisection,
        open: &[&Limit],
        most_cells: usize,
        progress: &dyn Progress,
    ) -> Result<Result<Bisection, Stop>, ModelError> {
        let mut finer = bisection.clone();
        finer.refine(&self.marked(open, progress)?, HALVES_EVERY_EDGE);
        if finer.cell_count() > most_cells {
            return Ok(Err(Stop::Cells));
        }
        let growth = finer.cell_count() as f64 / bisection.cell_count() as f64;
        let needed_mb = self.system.megabytes() * growth * MEMORY_MARGIN;
        let fits = needed_mb <= self.scene.settings.memory_mb;
        Ok(if fits { Ok(finer) } else { Err(Stop::Memory) })
    }

    fn level(&self, first: &Scene, limits: &[Limit], spent_s: f64) -> Level {
        let missing = &self.error.missing;
        let error = |limit: &Limit| limit.error([first, self.scene], missing);
        let all = first.skin.lengths(missing);
        let mut lengths = match &limits[0].part {
            SkinPart::Moving(points) => points.iter().map(|&point| all[point as usize]).collect(),
            SkinPart::Region(..) | SkinPart::Landmark(..) => all,
        };
        lengths.sort_by(f64::total_cmp);
        let p95 = (lengths.len() * 95).div_ceil(100).max(1) - 1;
        let (mut regions_mm, mut landmarks_mm) = (BTreeMap::new(), BTreeMap::new());
        for limit in limits {
            match &limit.part {
                SkinPart::Moving(_) => None,
                SkinPart::Region(name, _) => regions_mm.insert((*name).to_owned(), error(limit)),
                SkinPart::Landmark(name, _) => {
                    landmarks_mm.insert((*name).to_owned(), error(limit))
                }
            };
        }
        Level {
            cells: self.scene.mesh.cells.len(),
            nodes: self.scene.mesh.nodes.len(),
            unknowns: self.solved.equilibrium.solver.unknowns,
            mean_mm: error(&limits[0]),
            p95_mm: lengths.get(p95).copied().unwrap_or_default(),
            regions_mm,
            landmarks_mm,
            spent_s,
        }
    }
}

/// Predicts a scene on meshes that are refined until what is wanted is met; `stopwatch` tells seconds.
pub fn predict_adaptively(
    scene: &Scene,
    wanted: &RefinementGoal,
    stopwatch: &dyn Fn() -> f64,
    progress: &dyn Progress,
) -> Result<AdaptivePrediction, AdaptiveError> {
    let mut limits = wanted.limits(scene)?;
    if let Some(reason) = numerical_error::reason_for_none(scene) {
        return Err(reason.into());
    }
    let begun = stopwatch();
    let mut bisection = Bisection::new(scene.mesh.clone())?;
    let mut finest: Option<Scene> = None;
    let mut levels: Vec<Level> = Vec::new();
    let (answer, stop) = loop {
        let level_begun = stopwatch();
        let mut step = Step::solve(finest.as_ref().unwrap_or(scene), progress)?;
        if levels.is_empty() {
            let moving = scene.skin.moving_points(&step.solved.equilibrium.displacement);
            limits[0].part = SkinPart::Moving(moving);
        }
        let open = step.open(scene, &limits, wanted.is_of_answer, progress)?;
        let next = match open.is_empty() {
            true => Err(Stop::Met),
            false => step.finer(&bisection, &open, wanted.cells, progress)?,
        };
        let spent_s = stopwatch() - level_begun;
        levels.push(step.level(scene, &limits, spent_s));
        let next = next.and_then(|finer| {
            let growth = finer.cell_count() as f64 / bisection.cell_count() as f64;
            let expected_s = spent_s * growth.powf(TIME_GROWTH);
            let fits = stopwatch() - begun + expected_s <= wanted.time_s;
            if fits { Ok(finer) } else { Err(Stop::Time) }
        });
        match next {
            Err(stop) => break (step.answer(progress)?, stop),
            Ok(finer) => {
                drop(step);
                finest = Some(scene.on(&finer)?);
                bisection = finer;
            }
        }
    };
    let on = finest.as_ref().unwrap_or(scene);
    let left_out = left_out(wanted, &limits, [scene, on], &answer)?;
    let mut prediction = described(on, answer, progress);
    let finest = finest.map(|on_it| {
        let displacement = at_first_nodes(&mut prediction, scene);
        Finest { bisection, scene: on_it, displacement }
    });
    prediction.warnings.extend((stop != Stop::Met).then(|| not_met(&limits, &levels, stop)));
    let is_incomplete = stop == Stop::Met && !left_out.is_empty();
    let stop = if is_incomplete { Stop::Incomplete } else { stop };
    prediction.warnings.extend(left_out);
    Ok(AdaptivePrediction { prediction, finest, levels, stop })
}

/// Gives a prediction at the nodes and cells of the scene that was refined; returns the displacement of all nodes.
fn at_first_nodes(prediction: &mut Prediction, scene: &Scene) -> Vec<Vector> {
    let count = scene.mesh.nodes.len();
    let all = prediction.displacement.clone();
    prediction.displacement.truncate(count);
    prediction.deformation = deformations(&scene.mesh, &prediction.displacement);
    if let Ok(left) = &mut prediction.nonlinearity {
        left.left_out.truncate(count);
    }
    if let Ok(error) = &mut prediction.numerical_error {
        error.missing.truncate(count);
    }
    all
}

fn not_met(limits: &[Limit], levels: &[Level], stop: Stop) -> Warning {
    let bound = match stop {
        Stop::Met | Stop::Incomplete => "nothing",
        Stop::Cells => "the bound on cells",
        Stop::Time => "the time that is left",
        Stop::Memory => "the memory that is allowed",
    };
    let wanted = limits[0].accepted_mm;
    let mean = levels.last().map_or(f64::NAN, |level| level.mean_mm);
    let cells = levels.last().map_or(0, |level| level.cells);
    let detail = format!(
        "the mesh of {cells} cells leaves out an estimated {mean:.3} mm in the mean over the skin that moves, where {wanted:.3} mm were to be \
         met there, or more over a part of it, at a landmark with a limit of its own or with what linearity leaves out: {bound} allows no finer \
         one"
    );
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    warning.with("expected_mm", mean)
}
