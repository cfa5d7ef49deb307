//! Contact result of a prediction: contact pairs with their places and forces.

use std::collections::{BTreeMap, BTreeSet};

use super::case::ContactKind;
use super::numerical_error::{ErrorOrReason, at_last_tangent, estimate_in_contact};
use super::scene::Scene;
use crate::boundary::NodeClass;
use crate::boundary::contact::{BoneInside, Embedded, FacingSurfaces, bones_inside};
use crate::mesh::cell_overlap::{Overlap, deepest_overlap};
use crate::mesh::{Vector, Warning};
use crate::model::fem::contact::{
    Contact, ContactProblem, Effort, PressedStep, PressingRow, SETTLED_MM, forces_of,
};
use crate::model::fem::finite_strain;
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::problem::{Equilibrium, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::SolverError;

/// Parts of the boundary that lie in each other deeper than this, in mm, are reported.
const DEEP_MM: f64 = 0.05;

/// Contact of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    pub contact: Contact,
    /// For each node, in kPa; 0 where nothing presses.
    pub pressure: Vec<f64>,
    pub pairs: Vec<ContactPair>,
    /// Where the boundary lies in itself, as at the corners of a mouth, whose edges no node is held against.
    pub overlap: Option<Overlap>,
    /// The surfaces of bone that lie in tissue nevertheless, as those narrower than its cells may.
    pub bones_inside: Vec<BoneInside>,
    /// At the end of each load step; empty where none were asked for.
    pub at_load_steps: Vec<StepTouch>,
}

/// What presses at the end of a load step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTouch {
    /// Nodes that are held against what they face.
    pub points: usize,
    /// In mm², of all pairs.
    pub area: f64,
    /// In kPa.
    pub largest_pressure: f64,
}

/// Two parts of the boundary that press on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPair {
    /// Names of segments, bones, regions of the skin, `fixed`, `skin` or `inner`.
    pub between: [String; 2],
    /// In mm²: of the nodes that are pressed, on the side that has less, or on that of tissue against the surface of a bone.
    pub area: f64,
    /// In kPa.
    pub largest_pressure: f64,
    /// Force of one side on the other one, in mN.
    pub force: f64,
    pub nodes: usize,
}

/// An answer in which parts of the boundary press on each other, or lie in each other nevertheless.
pub(super) struct InTouch {
    pub equilibrium: Equilibrium,
    pub touch: Touch,
    /// Where something presses and it was asked for.
    pub numerical_error: Option<ErrorOrReason>,
}

/// Result of a solution with contact.
struct Pressing {
    equilibrium: Equilibrium,
    contact: Contact,
    numerical_error: Option<ErrorOrReason>,
}

/// What may touch in a scene; none where contact is not asked for.
pub(super) fn facing_surfaces(scene: &Scene) -> Option<FacingSurfaces<'_>> {
    let Scene { mesh, boundary, conditions, bones, .. } = scene;
    let is_asked = scene.settings.contact.is_unilateral();
    is_asked.then(|| FacingSurfaces::new(mesh, boundary, &conditions.constraints, bones))
}

/// The answer of linear elasticity in which what touches presses; none where nothing does or contact is not asked for. On
/// request with what the mesh leaves out.
pub(super) fn touch(
    scene: &Scene,
    system: &LinearSystem,
    free: &Solved,
    with_error: bool,
    progress: &dyn Progress,
) -> Result<Option<InTouch>, ModelError> {
    let Some(surfaces) = &facing_surfaces(scene) else { return Ok(None) };
    let found = pressed(scene, surfaces, Some(&free.equilibrium), progress, || {
        let relative_residual = scene.settings.relative_residual;
        let found = ContactProblem { system, free, surfaces, relative_residual }.solve(progress)?;
        let Some(mut found) = found else { return Ok(None) };
        let mut estimate = || estimate_in_contact(scene, system, &mut found, progress);
        let numerical_error = with_error.then(&mut estimate).transpose()?;
        let equilibrium = scene.stated(system, found.solved)?;
        Ok(Some(Pressing { equilibrium, contact: found.contact, numerical_error }))
    })?;
    let Some(mut found) = found else { return Ok(None) };
    // Where nothing presses the answer is the one without contact.
    if found.equilibrium.states.cells.is_empty() {
        found.equilibrium.states = scene.states_of(system, free)?;
    }
    Ok(Some(found))
}

/// The same at finite strain, on the way to an answer without contact.
pub(super) fn touch_at_finite_strain(
    scene: &Scene,
    surfaces: &FacingSurfaces,
    free: &Equilibrium,
    with_error: bool,
    progress: &dyn Progress,
) -> Result<Option<InTouch>, ModelError> {
    pressed(scene, surfaces, Some(free), progress, || {
        pressed_at_finite_strain(scene, &free.displacement, surfaces, with_error, progress)
    })
}

/// The same where the answer of linear elasticity touches, without one of finite strain before it; none where that says nothing.
pub(super) fn expected_touch_at_finite_strain(
    scene: &Scene,
    surfaces: &FacingSurfaces,
    with_error: bool,
    progress: &dyn Progress,
) -> Result<Option<InTouch>, ModelError> {
    let from_linear = || {
        let Some(system) = scene.assemble(progress)? else { return Ok(None) };
        let load_case = scene.linear_load_case()?;
        let expected = system.solve(&[load_case], progress)?.remove(0).equilibrium;
        drop(system);
        let displacement = &expected.displacement;
        pressed_at_finite_strain(scene, displacement, surfaces, with_error, progress)
    };
    pressed(scene, surfaces, None, progress, || match from_linear() {
        // What does not touch otherwise may rest.
        Err(
            ModelError::ContactUnsettled { .. }
            | ModelError::ContactAlternates { .. }
            | ModelError::Standstill { .. }
            | ModelError::Solver(SolverError::NotConverged { .. }),
        ) => Ok(None),
        ended => ended,
    })
}

fn pressed_at_finite_strain(
    scene: &Scene,
    free: &[Vector],
    surfaces: &FacingSurfaces,
    with_error: bool,
    progress: &dyn Progress,
) -> Result<Option<Pressing>, ModelError> {
    let found = scene.at_finite_strain(|problem, finer| {
        let finer = with_error.then_some(finer);
        let may_touch = finite_strain::MayTouch { free, surfaces };
        problem.solve_in_contact(&scene.load_case(), may_touch, finer, progress)
    })?;
    Ok(found.map(|finite_strain::InContact { equilibrium, contact, mesh_error }| {
        let numerical_error = mesh_error.map(at_last_tangent);
        Pressing { equilibrium, contact, numerical_error }
    }))
}

/// What a solution with contact says of an answer without; also where nothing presses and parts lie in each other nevertheless,
/// if there is such an answer.
fn pressed(
    scene: &Scene,
    surfaces: &FacingSurfaces,
    free: Option<&Equilibrium>,
    progress: &dyn Progress,
    solve: impl FnOnce() -> Result<Option<Pressing>, ModelError>,
) -> Result<Option<InTouch>, ModelError> {
    progress.phase(Phase::Contact);
    let found = solve()?;
    let nothing_presses = found.is_none();
    let without = || {
        let forces = vec![Vector::zeros(); scene.mesh.nodes.len()];
        let contact = Contact { forces, ..Contact::default() };
        Some(Pressing { equilibrium: free?.clone(), contact, numerical_error: None })
    };
    let Some(Pressing { equilibrium, contact, numerical_error }) = found.or_else(without) else {
        return Ok(None);
    };
    let cells = &scene.mesh.cells;
    let at_rest = deepest_overlap(cells, surfaces.rest_positions(), surfaces.rest());
    let moved = surfaces.after(&equilibrium.displacement);
    let positions = surfaces.positions(&equilibrium.displacement);
    let overlap = deepest_overlap(cells, &positions, &moved)
        .filter(|own| own.depth > at_rest.map_or(0.0, |at_rest| at_rest.depth) + DEEP_MM);
    // What of bone lies between the nodes of tissue may enter: edges, narrow parts, roundings that cells span as chords.
    let boundaries = [surfaces.rest(), &moved];
    let bones_inside = bones_inside(boundaries, &scene.bones, DEEP_MM, Embedded::IfMoved);
    if nothing_presses && overlap.is_none() && bones_inside.is_empty() {
        return Ok(None);
    }
    let of_step = |PressedStep { pressed, areas }: &PressedStep| {
        let forces = forces_of(pressed, scene.mesh.nodes.len());
        let contact = Contact { pressed: pressed.clone(), forces, ..Contact::default() };
        StepTouch::of(&Touch::new(scene, areas, contact))
    };
    let at_load_steps = contact.at_load_steps.iter().map(of_step).collect();
    // Stress of linear elasticity is force on the area at rest.
    let areas = match scene.settings.method.properties().is_small_strain {
        true => surfaces.areas(&contact.forces, surfaces.rest_positions()),
        false => surfaces.areas(&contact.forces, &positions),
    };
    let touch = Touch::new(scene, &areas, contact);
    let touch = Touch { overlap, bones_inside, at_load_steps, ..touch };
    Ok(Some(InTouch { equilibrium, touch, numerical_error }))
}

impl Touch {
    /// `areas` on which each node presses, in mm².
    fn new(scene: &Scene, areas: &BTreeMap<u32, f64>, contact: Contact) -> Self {
        let mut pressure = vec![0.0; scene.mesh.nodes.len()];
        for (node, area) in areas.iter().filter(|(_, area)| **area > 0.0) {
            pressure[*node as usize] = contact.forces[*node as usize].norm() / area;
        }
        let pairs = pairs(scene, areas, &contact, &pressure);
        Touch {
            contact,
            pressure,
            pairs,
            overlap: None,
            bones_inside: Vec::new(),
            at_load_steps: Vec::new(),
        }
    }

    /// The largest gap below 0, or how deep parts or bones lie in each other, in mm and positive.
    pub fn largest_penetration(&self) -> f64 {
        let overlap = self.overlap.as_ref().map_or(0.0, |deepest| deepest.depth);
        let depths = self.bones_inside.iter().map(|inside| inside.depth);
        let gaps = self.contact.gaps.values().map(|gap| -gap);
        depths.chain(gaps).fold(overlap, f64::max)
    }

    pub fn largest_pressure(&self) -> f64 {
        self.pressure.iter().copied().fold(0.0, f64::max)
    }

    /// In mm².
    pub fn area(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.area).sum()
    }

    /// Warnings.
    pub(super) fn warnings(&self, scene: &Scene) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let Contact { pressed, effort: Effort { kept, rounds, .. }, last_moved_mm, .. } =
            &self.contact;
        if scene.settings.contact == ContactKind::Auto && !pressed.is_empty() {
            let detail =
                format!("gaps close: tissue presses on what it touches at {} nodes", pressed.len());
            let warning =
                Warning::new("contact-closed", detail).with("nodes", pressed.len() as f64);
            warnings.push(warning.with("area_mm2", self.area()));
        }
        if *kept > 0 {
            let detail = format!(
                "{kept} points of contact did not settle between pressing and not, and were kept closed: there contact may pull"
            );
            warnings.push(Warning::new("contact-chatter", detail).with("points", *kept as f64));
        }
        if let Some(Overlap { depth, at }) = &self.overlap {
            let detail = format!(
                "contact leaves parts of the boundary in each other, {depth:.2} mm deep: it holds nodes of tissue against triangles, not edges against edges, and what lies between the nodes is free: an edge, a narrow part, or a rounding that cells of tissue span as chords"
            );
            let warning = Warning::new("contact-overlap", detail).with("depth_mm", *depth);
            warnings.push(warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z));
        }
        warnings.extend(self.bones_inside.iter().map(|inside| bone_inside(scene, inside)));
        if *last_moved_mm > SETTLED_MM {
            let detail = format!(
                "closest points of contact still move the answer by {last_moved_mm:.1e} mm when they are looked for the {rounds}th time"
            );
            warnings
                .push(Warning::new("contact-points-move", detail).with("moved_mm", *last_moved_mm));
        }
        warnings
    }
}

impl StepTouch {
    fn of(touch: &Touch) -> Self {
        StepTouch {
            points: touch.contact.pressed.len(),
            area: touch.area(),
            largest_pressure: touch.largest_pressure(),
        }
    }
}

/// Warning of a bone that lies in tissue.
fn bone_inside(scene: &Scene, BoneInside { bone, depth, at, points }: &BoneInside) -> Warning {
    let detail = format!(
        "contact leaves bone {:?} in tissue, {depth:.2} mm deep, with {points} of the points of its corners and edges: nodes of tissue are held against bone, and what of it lies between them goes in: an edge, a part narrower than their distance, or a rounding that cells of tissue span as chords",
        scene.bones[*bone].name
    );
    let warning = Warning::new("contact-overlap", detail).with("depth_mm", *depth);
    let warning = warning.with("points", *points as f64);
    warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z)
}

/// The parts of the boundary by name that press on each other.
fn pairs(
    scene: &Scene,
    areas: &BTreeMap<u32, f64>,
    contact: &Contact,
    pressure: &[f64],
) -> Vec<ContactPair> {
    let names = names(scene);
    let mut sides: BTreeMap<[&str; 2], [Side; 2]> = BTreeMap::new();
    for PressingRow { row, force } in &contact.pressed {
        let corners = row.terms.iter().skip(1);
        let nearest = corners.max_by(|(_, a), (_, b)| a.norm().total_cmp(&b.norm()));
        let of_tissue = || nearest.map(|(other, _)| names[*other as usize].as_str());
        let of_bone = row.bone.map(|on| scene.bones[on.bone as usize].name.as_str());
        let Some(other) = of_bone.or_else(of_tissue) else { continue };
        let own = names[row.node as usize].as_str();
        let between = [own.min(other), own.max(other)];
        let of_pair = sides.entry(between).or_default();
        let own = usize::from(own > other);
        of_pair[own].force += force;
        for (place, (node, _)) in row.terms.iter().enumerate() {
            of_pair[if place == 0 { own } else { 1 - own }].nodes.insert(*node);
        }
    }
    let pair = |(between, [one, other]): ([&str; 2], [Side; 2])| {
        let is_one = between[0] == between[1];
        let nodes: BTreeSet<u32> = one.nodes.union(&other.nodes).copied().collect();
        let area = |nodes: &BTreeSet<u32>| -> f64 {
            nodes.iter().map(|node| areas.get(node).copied().unwrap_or_default()).sum()
        };
        ContactPair {
            area: match (is_one, one.nodes.is_empty() || other.nodes.is_empty()) {
                // The surface of a bone has no nodes of its own.
                (_, true) => area(&nodes),
                (true, false) => 0.5 * area(&nodes),
                (false, false) => area(&one.nodes).min(area(&other.nodes)),
            },
            between: between.map(str::to_owned),
            largest_pressure: nodes.iter().map(|&node| pressure[node as usize]).fold(0.0, f64::max),
            force: one.force + other.force,
            nodes: nodes.len(),
        }
    };
    sides.into_iter().map(pair).collect()
}

/// What one side of a pair takes part with.
#[derive(Default)]
struct Side {
    /// Those that press or are pressed.
    nodes: BTreeSet<u32>,
    /// In mN, of what its nodes are held against.
    force: f64,
}

/// What each node of the mesh is called as a part of the boundary.
fn names(scene: &Scene) -> Vec<String> {
    let mut names = vec!["inner".to_owned(); scene.mesh.nodes.len()];
    let skin = scene.skin.nodes();
    skin.iter().for_each(|&node| names[node as usize] = "skin".to_owned());
    for (region, points) in &scene.skin.regions {
        points.iter().for_each(|&point| names[skin[point as usize] as usize].clone_from(region));
    }
    for (name, class) in names.iter_mut().zip(&scene.conditions.classes) {
        match class {
            NodeClass::Joined(segment) => name.clone_from(&scene.segments[*segment as usize].name),
            NodeClass::Fixed => "fixed".clone_into(name),
            NodeClass::Prescribed | NodeClass::Sliding | NodeClass::Free => {}
        }
    }
    names
}
