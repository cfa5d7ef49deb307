//! Reference solution of a scene, at the skin nodes of level 0.
//!
//! A refined truth is finite elements on a finer mesh. At small strain and without contact it is linear in the movements of
//! segments, so that twelve load cases a segment serve every plan that is made of movements (`response`). Rows with contact are
//! held against a truth with contact, plan by plan. How far a truth is off itself: `truth_error.rs`.

use super::StudyError;
use super::answer::{NoAnswer, Refusal, solve};
use super::levels::Levels;
use super::truth_error::{OwnError, TruthErrors, own_error};
use super::truth_words::{grouped, halved};
use super::variant::{ClosedForm, Materials, Strain, StudyScene, Truth, Variant};
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::plan::RigidMovement;
use crate::prediction::{
    Case, ContactKind, ElementChoice, ModelError, Plan, Scene, Settings, Skin,
};
use crate::progress::Progress;
use crate::response::{self, Columns, ResponseError};
use crate::solver::SolverError;

/// Linear truths are solved to this relative residual, those at finite strain to that of every prediction.
const RESIDUAL: f64 = 1e-10;

/// Of a refined truth.
const MEMORY_MB: f64 = 12_000.0;

/// Plans for each segment from which on twelve columns cost less than a solve for each plan.
pub(super) const PLANS_A_SEGMENT: usize = 3;

/// The displacement of skin nodes in mm, or why there is none.
pub(super) type TrueSkin = Result<Vec<Vector>, Refusal>;

/// Reference solution and its description.
pub(super) struct Truths {
    /// For each plan, for each material.
    pub skins: Vec<Vec<TrueSkin>>,
    pub words: String,
    pub errors: TruthErrors,
}

impl Truths {
    /// Of which no error is known.
    fn exact(skins: Vec<Vec<TrueSkin>>, words: &str) -> Truths {
        Truths { skins, words: words.to_owned(), errors: TruthErrors::default() }
    }
}

/// How a refined truth is solved.
type TruthMethod = (ElementChoice, Strain, ContactKind);

/// A scene whose truth is wanted.
pub(super) struct TruthRequest<'a> {
    pub scene: &'a StudyScene,
    /// For each plan, at level 0.
    pub skins: &'a [Result<Skin, Refusal>],
    pub progress: &'a dyn Progress,
}

/// Why a variant at a level has no row, where it is the discretisation that is held for true, or a finer one of its kind.
pub(super) fn itself(scene: &StudyScene, variant: &Variant, level: u32) -> Option<String> {
    let settings = &variant.settings;
    let mesh = &scene.case.volume;
    let Truth::Refined { times, element, strain } = scene.truth else { return None };
    let element = match is_in_contact(scene, variant) {
        true => in_contact(element),
        false => element,
    };
    let is_itself = level >= times
        && variant.accepted.is_none()
        && settings.method == strain.method()
        && settings.membrane.is_none()
        && settings.contact.holds_sliding()
        && in_effect(settings.element, mesh) == in_effect(element, mesh);
    is_itself.then(|| {
        format!(
            "level {level} is the truth itself or finer than it: that is the same method and element, {}",
            halved(times)
        )
    })
}

/// Whether the rows of a variant are held against a truth that was solved with contact.
pub(super) fn is_in_contact(scene: &StudyScene, variant: &Variant) -> bool {
    variant.settings.contact.is_unilateral() && matches!(scene.truth, Truth::Refined { .. })
}

/// The element of a truth with contact: quadratic ones know none.
pub(super) fn in_contact(element: ElementChoice) -> ElementChoice {
    match element {
        ElementChoice::Quadratic => ElementChoice::Stabilised,
        ElementChoice::Auto
        | ElementChoice::Stabilised
        | ElementChoice::MeanDilatation
        | ElementChoice::Plain => element,
    }
}

/// One name for element choices that come to the same on this mesh.
fn in_effect(element: ElementChoice, mesh: &VolumeMesh) -> ElementChoice {
    let has_tetrahedra = mesh.cells.iter().any(|(shape, _)| shape == CellShape::Tet4);
    match element {
        ElementChoice::Auto | ElementChoice::Stabilised => ElementChoice::Stabilised,
        ElementChoice::MeanDilatation if !has_tetrahedra => ElementChoice::Stabilised,
        ElementChoice::MeanDilatation | ElementChoice::Plain | ElementChoice::Quadratic => element,
    }
}

impl TruthRequest<'_> {
    /// The truth of rows without contact, which slide where they may, or of those with it.
    pub(super) fn find(
        &self,
        levels: &mut Levels,
        contact: ContactKind,
    ) -> Result<Truths, StudyError> {
        match &self.scene.truth {
            Truth::ClosedForm(formula) => Ok(self.closed_form(formula)),
            Truth::Known { displacement, .. } => Ok(self.known(displacement)),
            Truth::Scan(_) => Ok(self.scanned()),
            Truth::Refined { times, element, strain } => {
                let element = match contact.is_unilateral() {
                    true => in_contact(*element),
                    false => *element,
                };
                self.refined(levels, *times, (element, *strain, contact))
            }
        }
    }

    /// Where no answer is to be held against it.
    pub(super) fn nothing(&self) -> Truths {
        let none = || Err(Refusal::new("truth-failed", "no method has an answer"));
        let skins = self.each(|_, _, _| none());
        Truths::exact(skins, "not sought: no method has an answer")
    }

    fn closed_form(&self, formula: &ClosedForm) -> Truths {
        let nodes = &self.scene.case.volume.nodes;
        let skins = self.each(|plan, materials, skin| {
            if plan.grows() {
                let detail = "the closed form knows no tissue that grows".to_owned();
                return Err(Refusal::new("truth-failed", detail));
            }
            let at = |&node: &u32| (formula.displacement)(&nodes[node as usize], plan, materials);
            Ok(skin.nodes().iter().map(at).collect())
        });
        Truths::exact(skins, "closed form")
    }

    fn known(&self, displacement: &[Vector]) -> Truths {
        let skins = self.each(|_, _, skin| match skin.nodes().len() == displacement.len() {
            true => Ok(displacement.to_vec()),
            false => {
                let (given, nodes) = (displacement.len(), skin.nodes().len());
                let detail = format!("{given} displacements are given for {nodes} skin nodes");
                Err(Refusal::new("truth-failed", detail))
            }
        });
        Truths::exact(skins, "given with the scene")
    }

    /// No displacement: a scan shows none.
    fn scanned(&self) -> Truths {
        let skins = self.each(|_, _, _| Ok(Vec::new()));
        Truths::exact(skins, "a scan")
    }

    /// What holds for each plan, as it is of the materials, and each material.
    fn each(&self, found: impl Fn(&Plan, &Materials, &Skin) -> TrueSkin) -> Vec<Vec<TrueSkin>> {
        let plans = self.scene.plans.iter().zip(self.skins);
        plans
            .map(|((_, plan), skin)| {
                let materials = self.scene.materials.iter();
                let of = |materials: &Materials| {
                    let skin = skin.as_ref().map_err(Refusal::clone)?;
                    found(&materials.plan(plan), materials, skin)
                };
                materials.map(of).collect()
            })
            .collect()
    }

    fn refined(
        &self,
        levels: &mut Levels,
        times: u32,
        how: TruthMethod,
    ) -> Result<Truths, StudyError> {
        // 1. The finest mesh and, for its error, one or two before it.
        let mut fields: Vec<Vec<Vec<TrueSkin>>> = Vec::new();
        let mut words = String::new();
        let (mut solved_meshes, of) =
            (0, self.scene.materials.len() * (times - coarsest(times) + 1) as usize);
        for level in coarsest(times)..=times {
            let mut of_level = vec![Vec::new(); self.scene.plans.len()];
            for materials in &self.scene.materials {
                self.progress.step(solved_meshes, of);
                solved_meshes += 1;
                let solved = self.solve_plans(levels, (level, materials), how)?;
                words = solved.words;
                for (plan, found) in of_level.iter_mut().zip(solved.skins) {
                    plan.push(found);
                }
            }
            fields.push(of_level);
        }

        // 2. Its description.
        let own = self.own_errors(&fields);
        let finest = fields.pop().unwrap_or_default();
        let of_mean = |own: &&OwnError| own.mean_and_p95[0];
        let largest = own.iter().flatten().flatten();
        let largest = largest.max_by(|one, other| of_mean(one).total_cmp(&of_mean(other)));
        let own_words = match largest {
            Some(own) if own.is_observed => {
                format!("own error extrapolated with the observed order {:.1}", own.order)
            }
            Some(_) => "own error extrapolated with order 1, which is assumed".to_owned(),
            None => "own error not known".to_owned(),
        };
        let strain = match how.1 {
            Strain::Small => "",
            Strain::Finite => " at finite strain",
        };
        let touching = if how.2.is_unilateral() { " with contact" } else { "" };
        let words = format!("{words}{strain}{touching}, {}; {own_words}", halved(times));
        Ok(Truths { skins: finest, words, errors: TruthErrors::of(&own) })
    }

    fn solve_plans(
        &self,
        levels: &mut Levels,
        (level, materials): (u32, &Materials),
        (element, strain, contact): TruthMethod,
    ) -> Result<Solved, StudyError> {
        let usual = Settings::default();
        let relative_residual = match strain {
            Strain::Small => RESIDUAL,
            Strain::Finite => usual.relative_residual,
        };
        let (method, memory_mb) = (strain.method(), MEMORY_MB);
        let settings = Settings { method, element, contact, relative_residual, memory_mb, ..usual };
        let case = match levels.case(level, materials) {
            Ok(case) => case,
            Err(refusal) => {
                let skins = self.scene.plans.iter().map(|_| Err(refusal.clone())).collect();
                return Ok(Solved { skins, words: "none".to_owned() });
            }
        };
        let finer = FinerCase { case, settings, progress: self.progress };
        let at_level = |(name, plan): &(String, Plan)| (name.clone(), levels.plan(plan, materials));
        let plans: Vec<(String, Plan)> = self.scene.plans.iter().map(at_level).collect();
        let columns = match strain {
            Strain::Small if !contact.is_unilateral() => finer.columns(&plans)?,
            Strain::Small | Strain::Finite => None,
        };
        let mut words = columns.as_ref().map_or_else(String::new, |columns| {
            let elements = columns.elements.join(", ");
            described(&elements, columns.solver.unknowns, ", plans summed from unit movements")
        });
        let mut skins = Vec::new();
        for ((_, plan), skin) in plans.iter().zip(self.skins) {
            let nodes = match skin {
                Ok(skin) => skin.nodes(),
                Err(refusal) => {
                    skins.push(Err(refusal.clone()));
                    continue;
                }
            };
            skins.push(match &columns {
                Some(columns) if is_of_segments(plan, &finer.case) => sum(columns, plan, nodes),
                _ => match finer.direct(plan, nodes) {
                    Ok((found, about)) => {
                        words = if words.is_empty() { about } else { words };
                        Ok(found)
                    }
                    Err(NoAnswer::Cancelled) => return Err(StudyError::Cancelled),
                    Err(NoAnswer::Refused(refusal) | NoAnswer::Late(refusal)) => Err(refusal),
                    Err(NoAnswer::Unserved(why)) => Err(Refusal::new("method-not-available", why)),
                },
            });
        }
        Ok(Solved { skins, words })
    }

    /// For each plan, for each material, as far as it is known.
    fn own_errors(&self, fields: &[Vec<Vec<TrueSkin>>]) -> Vec<Vec<Option<OwnError>>> {
        let of_plan = |(plan, skin): (usize, &Result<Skin, Refusal>)| {
            let areas = skin.as_ref().ok().map(|skin| skin.surface.point_areas());
            let of = |material: usize| {
                let found = fields.iter().map(|of_level| of_level[plan][material].as_ref().ok());
                own_error(&found.collect::<Option<Vec<_>>>()?, areas.as_ref()?)
            };
            (0..self.scene.materials.len()).map(of).collect()
        };
        self.skins.iter().enumerate().map(of_plan).collect()
    }
}

/// The plans on one mesh.
struct Solved {
    skins: Vec<TrueSkin>,
    words: String,
}

/// A finer case to be solved as the truth.
struct FinerCase<'a> {
    case: Case,
    settings: Settings,
    progress: &'a dyn Progress,
}

impl FinerCase<'_> {
    /// The columns of the segments that plans move, where they are worth their time; none where plans are
    /// solved one by one.
    fn columns(&self, plans: &[(String, Plan)]) -> Result<Option<Columns>, StudyError> {
        let sums = plans.iter().filter(|(_, plan)| is_of_segments(plan, &self.case)).count();
        let moved = moved_segments(plans, &self.case);
        if moved.is_empty() || sums <= PLANS_A_SEGMENT * moved.len() {
            return Ok(None);
        }
        let Ok(scene) = Scene::new(&self.case, &Plan::default(), &self.settings) else {
            return Ok(None);
        };
        match response::build(&scene, &moved, self.progress) {
            Ok(columns) => Ok(Some(columns)),
            Err(ResponseError::Prediction(ModelError::Solver(SolverError::Stopped))) => {
                Err(StudyError::Cancelled)
            }
            // What is in the way is reported plan by plan.
            Err(_) => Ok(None),
        }
    }

    /// A plan solved by itself, and the words for how.
    fn direct(&self, plan: &Plan, nodes: &[u32]) -> Result<(Vec<Vector>, String), NoAnswer> {
        let (scene, equilibrium) = solve(&self.case, plan, &self.settings, self.progress)?;
        let found = nodes.iter().map(|&node| equilibrium.displacement[node as usize]).collect();
        Ok((found, described(&scene.elements().join(", "), equilibrium.solver.unknowns, "")))
    }
}

/// Whether all that a plan does is to move segments of the case.
pub(super) fn is_of_segments(plan: &Plan, case: &Case) -> bool {
    let is_of_case = |name: &str| case.segments.iter().any(|segment| segment.name == name);
    plan.prescribed.is_empty()
        && !plan.states_loads()
        && plan.segments.iter().all(|segment| is_of_case(&segment.name))
}

/// The segments that such plans move.
pub(super) fn moved_segments(plans: &[(String, Plan)], case: &Case) -> Vec<String> {
    let sums = plans.iter().map(|(_, plan)| plan).filter(|plan| is_of_segments(plan, case));
    let mut moved: Vec<String> = sums
        .flat_map(|plan| &plan.segments)
        .filter(|segment| segment.movement != RigidMovement::default())
        .map(|segment| segment.name.clone())
        .collect();
    moved.sort_unstable();
    moved.dedup();
    moved
}

/// The plan as a sum of columns, at some of their nodes.
fn sum(columns: &Columns, plan: &Plan, nodes: &[u32]) -> TrueSkin {
    let movement = |name: &str| {
        let planned = plan.segments.iter().find(|planned| planned.name == name);
        planned.map_or_else(RigidMovement::default, |planned| planned.movement)
    };
    let movements: Vec<RigidMovement> =
        columns.segments.iter().map(|segment| movement(&segment.name)).collect();
    let whole = columns.apply(&movements);
    let at = |node: &u32| {
        let place = columns.nodes.binary_search(node).map_err(|_| {
            let detail = format!("node {node} of the skin is not on the skin of the refined mesh");
            Refusal::new("truth-failed", detail)
        })?;
        Ok(whole[place])
    };
    nodes.iter().map(at).collect()
}

fn described(elements: &str, unknowns: usize, how: &str) -> String {
    format!("{elements}, {} unknowns{how}", grouped(unknowns))
}

/// The level from which on meshes are solved, so that the error of the finest is known.
pub(super) fn coarsest(times: u32) -> u32 {
    times.saturating_sub(2)
}
