//! Pressure that stays at right angles to the faces it acts on, as they lie after the movement.
//!
//! Tissue at finite strain is solved under nodal forces that do not change; those of pressure are set to what they are on the faces of
//! the solution before, until they agree. That is a fixed point: each round leaves what the pressure turns by over what the
//! tissue resists with, a small part as long as pressure is far below the stiffness. Small strain keeps faces as they lie before the
//! movement. Source: Bonet, Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd edition, 2008, section 8.5, for
//! pressure on deformed faces.

use std::borrow::Cow;
use std::sync::Arc;

use super::method::MethodKind;
use super::scene::Scene;
use crate::mesh::{Vector, VolumeMesh, Warning};
use crate::model::fem::discretisation_error::DistributedLoads;
use crate::model::fem::loads::{FaceLoad, add_face_load};
use crate::model::problem::ModelError;

pub(super) const PRESSURE_UNSETTLED: &str = "pressure-unsettled";

/// Nodal forces of pressure agree where their changes, summed over the nodes, are at most this share of them.
const AGREES: f64 = 1e-6;
/// They agree too where they are at most this share and change no less from one round to the next, as contact does that is as exact.
const ENOUGH: f64 = 1e-4;
/// Rounds after which no agreement is expected any more.
const MOST_ROUNDS: usize = 25;
/// The least and the largest part of the way.
const PARTS: [f64; 2] = [0.1, 2.0];
/// A larger share of change is told.
const NOTICEABLE: f64 = 0.05;

/// The scene under the pressure of its faces as they lie in its solution, found by solving it again and again; with what is left where
/// that does not settle. `solve` gives the displacement of a scene, in mm by node.
pub(super) fn pressed_in_solution(
    scene: &Scene,
    solve: impl Fn(&Scene) -> Result<Vec<Vector>, ModelError>,
) -> Result<(Cow<'_, Scene>, Option<Warning>), ModelError> {
    let (mut pressed, mut left) = (Cow::Borrowed(scene), 0.0_f64);
    let mut places = PlacesOfFaces::at_rest(scene);
    let rounds = if has_pressure(scene) { MOST_ROUNDS } else { 0 };
    for _ in 0..rounds {
        let found = solve(&pressed)?;
        let there = pressed_at(scene, &found);
        let before = left;
        left = share_of_change(scene, &pressed.forces, &there.forces);
        let agrees = left <= AGREES || (left <= ENOUGH && left > 0.5 * before);
        let next = if agrees { there } else { pressed_at(scene, places.next(&found)) };
        pressed = Cow::Owned(Scene { near: Some(found), ..next });
        if agrees {
            break;
        }
    }
    Ok((pressed, (left > ENOUGH).then(|| unsettled(left))))
}

/// Displacements of the nodes at which pressure is taken, round by round.
///
/// They go towards those of the solution by a part of the way that two rounds tell (Aitken's). Source: Küttler, Wall, Fixed-point
/// fluid-structure interaction solvers with dynamic relaxation, Computational Mechanics 43 (2008).
struct PlacesOfFaces {
    at: Vec<Vector>,
    /// The last way from there to the solution, and the part of it that was gone.
    way: Option<Vec<Vector>>,
    part: f64,
}

impl PlacesOfFaces {
    fn at_rest(scene: &Scene) -> Self {
        PlacesOfFaces { at: vec![Vector::zeros(); scene.mesh.nodes.len()], way: None, part: 1.0 }
    }

    fn next(&mut self, found: &[Vector]) -> &[Vector] {
        let way: Vec<Vector> = found.iter().zip(&self.at).map(|(found, at)| found - at).collect();
        if let Some(before) = &self.way {
            let pairs = || before.iter().zip(&way).map(|(before, now)| (before, now - before));
            let along: f64 = pairs().map(|(before, change)| before.dot(&change)).sum();
            let square: f64 = pairs().map(|(_, change)| change.norm_squared()).sum();
            let part = -self.part * along / square;
            self.part = if part.is_finite() { part.clamp(PARTS[0], PARTS[1]) } else { 1.0 };
        }
        self.at.iter_mut().zip(&way).for_each(|(at, way)| *at += way * self.part);
        self.way = Some(way);
        &self.at
    }
}

/// How much pressure would change if it followed its faces to where they are displaced, for methods in which it does not.
pub(super) fn pressure_turned(scene: &Scene, displacement: &[Vector]) -> Option<Warning> {
    if !has_pressure(scene) || follows(scene) {
        return None;
    }
    let after = pressed_at(scene, displacement);
    let share = share_of_change(scene, &scene.forces, &after.forces);
    let detail = format!(
        "pressure acts on faces as they lie before the movement; on the faces as they lie after it its forces would differ by {:.0} %: \
         with `fem_nonlinear` it follows them",
        100.0 * share
    );
    (share > NOTICEABLE).then(|| Warning::new("pressure-turned", detail).with("share", share))
}

impl Scene {
    /// The forces that act in a solution, in mN by node.
    pub fn acting_in(&self, displacement: &[Vector]) -> Vec<Vector> {
        match has_pressure(self) && follows(self) {
            true => pressed_at(self, displacement).forces,
            false => self.forces.clone(),
        }
    }
}

fn follows(scene: &Scene) -> bool {
    scene.settings.method.kind() == MethodKind::FemNonlinear
}

fn unsettled(left: f64) -> Warning {
    let detail = format!(
        "after {MOST_ROUNDS} rounds the forces of pressure still change by {left:.1e} of themselves from one solution to the next: the tissue \
         hardly resists it"
    );
    Warning::new(PRESSURE_UNSETTLED, detail).with("share", left)
}

pub(super) fn has_pressure(scene: &Scene) -> bool {
    let mut loads = scene.distributed.faces.iter();
    loads.any(|(_, load)| matches!(load, FaceLoad::Pressure(pressure) if *pressure != 0.0))
}

/// The scene with pressure as forces on faces where a displacement takes them.
fn pressed_at(scene: &Scene, displacement: &[Vector]) -> Scene {
    let mesh = moved(&scene.mesh, displacement);
    let (before, after) =
        (forces_of_pressure(scene, &scene.mesh), forces_of_pressure(scene, &mesh));
    let changes = after.iter().zip(&before).map(|(after, before)| after - before);
    let forces = scene.forces.iter().zip(changes).map(|(force, change)| force + change).collect();
    let mut faces = Vec::new();
    for (own, load) in &scene.distributed.faces {
        let FaceLoad::Pressure(pressure) = *load else {
            faces.push((own.clone(), *load));
            continue;
        };
        faces.extend(own.iter().map(|face| {
            let area = face.area_vector(&scene.mesh.nodes).norm();
            (vec![*face], FaceLoad::Traction(face.area_vector(&mesh.nodes) * (-pressure / area)))
        }));
    }
    let distributed = DistributedLoads { faces, ..scene.distributed.clone() };
    Scene { forces, distributed, ..scene.clone() }
}

/// By node, in mN.
fn forces_of_pressure(scene: &Scene, mesh: &VolumeMesh) -> Vec<Vector> {
    let mut forces = vec![Vector::zeros(); scene.forces.len()];
    let edges = scene.edge_nodes();
    for (faces, load) in &scene.distributed.faces {
        match (load, &edges) {
            (FaceLoad::Traction(_), _) => {}
            (FaceLoad::Pressure(_), Some(edges)) => {
                edges.add_face_load(mesh, faces, *load, &mut forces);
            }
            (FaceLoad::Pressure(_), None) => add_face_load(mesh, faces, *load, &mut forces),
        }
    }
    forces
}

/// The change of forces over those of pressure at rest, each summed over the nodes.
fn share_of_change(scene: &Scene, before: &[Vector], after: &[Vector]) -> f64 {
    let all: f64 = forces_of_pressure(scene, &scene.mesh).iter().map(Vector::norm).sum();
    before.iter().zip(after).map(|(before, after)| (after - before).norm()).sum::<f64>() / all
}

fn moved(mesh: &Arc<VolumeMesh>, displacement: &[Vector]) -> VolumeMesh {
    let mut moved = VolumeMesh::clone(mesh);
    moved.nodes.iter_mut().zip(displacement).for_each(|(node, u)| *node += u);
    moved
}
