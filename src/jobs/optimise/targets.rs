//! Inverse planning: the documents of a job, checked, and its targets as points of the skin.

use std::collections::BTreeMap;

use super::input::OptimiseInput;
use super::tissue::TissueConstant;
use crate::jobs::failure::JobError;
use crate::jobs::predict::{PredictInput, Prepared};
use crate::jobs::source::MeshSource;
use crate::schema::ErrorCode;
use crate::schema::hashes;
use crate::schema::optimise::target::TargetDocument;
use crate::schema::{Faults, Limits, Pointer, Problem, Triple};
use mechanics::mesh::{SurfaceSearch, Vector, Warning};
use mechanics::optimisation::{Goal, InnerBounds, SkinPoint, Target};
use mechanics::prediction::{LANDMARK_FAR, Skin};
use mechanics::progress::StopQuery;
use mechanics::response::{InnerLoad, ResponseError, chosen};

/// Inverse planning with valid documents.
pub struct PreparedOptimisation {
    /// The scene in which nothing moves.
    pub rest: Prepared,
    pub targets: Vec<Target>,
    /// The number of moving segments.
    pub moving: usize,
    /// Growth and muscles, with their bounds.
    pub inner: Vec<InnerLoad>,
    pub inner_bounds: Vec<InnerBounds>,
    pub constants: Vec<TissueConstant>,
    /// Settings of inverse planning only.
    pub warnings: Vec<Warning>,
    pub spec_hash: String,
}

/// The name of the part of the skin of a target. A part of the case with the same name would be
/// hidden while the targets are read, and is back in the prediction.
fn part_of(target: usize) -> String {
    format!("target {target}")
}

impl OptimiseInput {
    /// Fetches the meshes and checks the documents as those of a prediction in which nothing moves.
    /// All faults are reported; pointers start at `/case` and `/spec`.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<PreparedOptimisation, JobError> {
        let mut faults = Faults::default();
        self.spec.check(&self.case, limits, &mut faults);
        faults.into_result()?;
        let rest = self.at_rest().prepare(sources, limits, stop);
        let rest = rest.map_err(|error| self.in_spec(error))?;
        let moving = chosen(&rest.scene, &self.spec.moving());
        let moving = moving.map_err(|error| self.judge(error))?.len();
        let inner = self.spec.to_response().inner_loads(&rest.scene);
        let inner = inner.map_err(|error| self.judge(error))?;
        self.check_growth(&rest.scene)?;
        let inner_bounds = self.inner_bounds(&inner);
        let constants = self.constants(&rest)?;
        let mut warnings = Vec::new();
        let targets = self.targets(&rest, limits, &mut warnings)?;
        let content = |id: &str| rest.contents.get(id).cloned();
        let spec_hash = hashes::optimise_hash(&self.case, &self.spec, &content);
        Ok(PreparedOptimisation {
            rest,
            targets,
            moving,
            inner,
            inner_bounds,
            constants,
            warnings,
            spec_hash,
        })
    }

    /// The ids of all meshes that the job reads.
    pub fn mesh_ids(&self) -> Vec<String> {
        self.at_rest().case.mesh_ids()
    }

    /// A prediction in which the segments stay, with a part of the skin for each target.
    fn at_rest(&self) -> PredictInput {
        let mut case = self.case.clone();
        for (index, target) in self.spec.targets.iter().enumerate() {
            if let Some(nodes) = &target.nodes {
                case.skin_regions.insert(part_of(index), nodes.clone());
            }
        }
        let (plan, spec) = (self.spec.rest(), self.spec.to_prediction());
        PredictInput { job: None, queue_s: None, case, plan, spec }
    }

    /// Maps places of a prediction's documents, undeformed or of the plan that was found, to places of the spec.
    pub(super) fn in_spec(&self, error: JobError) -> JobError {
        let JobError::Refused(mut problem) = error else { return error };
        for index in 0..self.spec.targets.len() {
            let part = format!("/case/skin_regions/{}", part_of(index));
            problem = problem.moved(&part, &format!("/spec/targets/{index}/nodes"));
        }
        let bounds = Pointer::root().key("spec").key("bounds");
        for (index, name) in self.spec.bounds.keys().enumerate() {
            let planned = format!("/plan/segments/{index}");
            for end in ["/name", ""] {
                problem = problem.moved(&format!("{planned}{end}"), bounds.key(name).as_str());
            }
        }
        JobError::Refused(problem)
    }

    /// The job error of a response that cannot be built.
    pub(super) fn judge(&self, error: ResponseError) -> JobError {
        match error {
            ResponseError::Prediction(error) => error.into(),
            refused => {
                JobError::Refused(self.in_optimise(self.spec.to_response().refusal(&refused)))
            }
        }
    }

    /// Maps places of the response's spec to places of this one.
    fn in_optimise(&self, mut problem: Problem) -> Problem {
        for index in 0..self.spec.growth.len() {
            let own = format!("/spec/growth/{index}");
            problem = problem.moved(&own, &format!("{own}/region"));
        }
        let grows = self.spec.tissue_bounds.iter().filter(|(_, own)| own.volume_change.is_some());
        for ((region, _), place) in grows.zip(self.spec.growth.len()..) {
            let own = Pointer::root().key("spec").key("tissue_bounds").key(region);
            problem = problem.moved(&format!("/spec/growth/{place}"), own.as_str());
        }
        for index in 0..self.spec.activations.len() {
            let own = format!("/spec/activations/{index}/muscle");
            problem = problem.moved(&format!("/spec/muscles/{index}"), &own);
        }
        problem
    }

    fn targets(
        &self,
        rest: &Prepared,
        limits: &Limits,
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<Target>, JobError> {
        let skin = &rest.scene.skin;
        let degenerate = |error| {
            Problem::at(
                &Pointer::from_text("/case/skin"),
                ErrorCode::MeshDegenerate,
                format!("{error}"),
            )
        };
        let mut search = None;
        let mut targets = Vec::new();
        let mut faults = Faults::default();
        for (index, document) in self.spec.targets.iter().enumerate() {
            let goals = match place_of(document, &rest.scene.landmarks) {
                None => {
                    warnings.extend(off_skin(index, skin));
                    node_goals(document, &part_of(index), skin)
                }
                Some(NamedPoint { at: landmark, name }) => {
                    let search = match &search {
                        Some(search) => search,
                        None => {
                            search.insert(SurfaceSearch::new(&skin.surface).map_err(degenerate)?)
                        }
                    };
                    let closest = search.closest(&landmark);
                    if closest.distance > LANDMARK_FAR {
                        let detail = format!(
                            "{name} takes the displacement of the closest point of the skin"
                        );
                        let warning = Warning::new("landmark-far", detail);
                        warnings.push(warning.with("distance_mm", closest.distance));
                    }
                    let corners = skin.surface.triangles[closest.triangle];
                    let point = SkinPoint::within(corners, closest.barycentric);
                    vec![Goal { point, displacement: document.displacement(&landmark) }]
                }
            };
            let (at, _) = document.wanted(&Pointer::root().key("spec").key("targets").index(index));
            check_one_place(document, &goals, &at, &mut faults);
            check_reach(&goals, &at, limits, &mut faults);
            targets.push(Target { goals, sigma: document.sigma_mm });
        }
        faults.into_result()?;
        Ok(targets)
    }
}

/// A single point of a target, and its name.
struct NamedPoint {
    at: Vector,
    name: String,
}

/// `None` for a target of nodes.
fn place_of(document: &TargetDocument, landmarks: &BTreeMap<String, Vector>) -> Option<NamedPoint> {
    let stated = document.point_mm.map(|Triple([x, y, z])| NamedPoint {
        at: Vector::new(x, y, z),
        name: format!("point {x} {y} {z}"),
    });
    let landmark = document.landmark.as_ref().map(|name| NamedPoint {
        at: landmarks.get(name).copied().unwrap_or_default(),
        name: format!("landmark {name:?}"),
    });
    stated.or(landmark)
}

/// A goal for each point of a part of the skin.
fn node_goals(document: &TargetDocument, part: &str, skin: &Skin) -> Vec<Goal> {
    let points = skin.regions.get(part).map(Vec::as_slice).unwrap_or_default();
    let goal = |&point: &u32| Goal {
        point: SkinPoint::node(point),
        displacement: document.displacement(&skin.surface.points[point as usize]),
    };
    points.iter().map(goal).collect()
}

/// The warning of a target some of whose nodes are not on the skin.
fn off_skin(target: usize, skin: &Skin) -> Option<Warning> {
    let off = *skin.off.get(&part_of(target))?;
    let of = off + skin.regions.get(&part_of(target)).map_or(0, Vec::len);
    let detail = format!(
        "{off} of {of} nodes of target {target} are not on the skin, and count for nothing"
    );
    Some(Warning::new("target-off-skin", detail).with("off", off as f64).with("of", of as f64))
}

/// Refuses several nodes that are to go to one point, or to one line.
fn check_one_place(document: &TargetDocument, goals: &[Goal], at: &Pointer, faults: &mut Faults) {
    let stated = document.position_mm.map_or(0, |own| own.0.into_iter().flatten().count());
    if goals.len() > 1 && stated > 1 {
        let detail = format!(
            "{} nodes cannot all go to one place: state `displacement_mm`, one component of `position_mm`, or one node",
            goals.len()
        );
        faults.add(at, ErrorCode::OutOfRange, detail);
    }
}

/// Refuses positions beyond all movements within the limits.
fn check_reach(goals: &[Goal], at: &Pointer, limits: &Limits, faults: &mut Faults) {
    let wanted = goals.iter().flat_map(|goal| goal.displacement).flatten();
    let farthest = wanted.map(f64::abs).fold(0.0, f64::max);
    let limit = limits.translation_mm;
    if farthest > limit {
        let detail = format!(
            "a component is {farthest:.3} mm from its start position, at most {limit} mm are allowed"
        );
        faults.add(at, ErrorCode::OutOfRange, detail);
    }
}
