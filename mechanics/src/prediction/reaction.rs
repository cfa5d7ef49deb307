//! Reaction forces in mN of the boundary conditions on the tissue: at each constrained node K u - f along its
//! constrained directions. Where a bone pulls tissue upwards, its reaction points upwards, and the sum of all reactions
//! and loads is zero.

use std::collections::BTreeMap;

use nalgebra::{DVector, Matrix3xX};

use super::contact::Touch;
use super::scene::Scene;
use super::stated::{StatedCondition, StatedHold};
use crate::boundary::NodeClass;
use crate::boundary::contact::BoneSurface;
use crate::mesh::Vector;
use crate::model::fem::contact::PressingRow;
use crate::model::problem::Equilibrium;

/// Normals of one node that differ by less are one wall.
const ONE_WALL: f64 = 1e-6;

/// The force that one condition exerts on the tissue, or a bone that it presses on.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionReaction {
    pub pointer: String,
    /// The name of the segment that moves it.
    pub segment: Option<String>,
    /// The nodes of which it holds a direction that nothing stronger holds; of a bone those that press on it.
    pub nodes: usize,
    /// In mN.
    pub force: Vector,
}

/// Sums the reactions of the nodes of each segment and of each other class, with what the surfaces of bones press with: those of
/// segments with the nodes of these, the others with what is fixed.
pub(super) fn by_class(
    scene: &Scene,
    reactions: &[Vector],
    pressed: &[PressingRow],
) -> BTreeMap<String, Vector> {
    let mut sums: BTreeMap<String, Vector> =
        scene.segments.iter().map(|segment| (segment.name.clone(), Vector::zeros())).collect();
    for (constraint, reaction) in scene.conditions.constraints.iter().zip(reactions) {
        let holder = match scene.conditions.classes[constraint.node as usize] {
            NodeClass::Joined(segment) => scene.segments[segment as usize].name.clone(),
            other => other.name().to_owned(),
        };
        *sums.entry(holder).or_insert_with(Vector::zeros) += reaction;
    }
    let on_bone = pressed.iter().filter_map(|own| Some((own, own.row.bone?)));
    for (PressingRow { row, force }, on) in on_bone {
        let bone = &scene.bones[on.bone as usize];
        let holder = if bone.is_carried { bone.name.as_str() } else { NodeClass::Fixed.name() };
        *sums.entry(holder.to_owned()).or_insert_with(Vector::zeros) += row.normal() * *force;
    }
    sums
}

/// What is left of a node's reaction for weaker conditions, and of the directions in which it is held.
#[derive(Clone, Default)]
struct Rest {
    force: Vector,
    is_held: [bool; 3],
}

/// Sums the reactions of each condition by itself, in the order in which they are stated, and after them what the surface of each
/// bone presses with, so that all of them and the loads add up to zero.
pub(super) fn by_condition(
    scene: &Scene,
    equilibrium: &Equilibrium,
    contact: Option<&Touch>,
) -> Vec<ConditionReaction> {
    let mut rest = vec![Rest::default(); scene.mesh.nodes.len()];
    for (constraint, reaction) in scene.conditions.constraints.iter().zip(&equilibrium.reactions) {
        rest[constraint.node as usize] = Rest { force: *reaction, is_held: [true; 3] };
    }
    let name = |segment: u32| scene.segments[segment as usize].name.clone();
    let mut sums: Vec<ConditionReaction> = { scene.stated.iter() }
        .map(|stated| ConditionReaction {
            pointer: stated.pointer.clone(),
            segment: stated.segment.map(name),
            nodes: 0,
            force: Vector::zeros(),
        })
        .collect();
    let strength = |stated: &StatedCondition| match stated.constraints {
        StatedHold::Components(_) => 0,
        StatedHold::Joined => 1,
        StatedHold::Fixed => 2,
        StatedHold::Walls(_) => 3,
    };
    let mut order: Vec<usize> = (0..scene.stated.len()).collect();
    order.sort_by_key(|&place| strength(&scene.stated[place]));
    let mut walls: BTreeMap<u32, Vec<(usize, Vector)>> = BTreeMap::new();
    for place in order {
        let stated = &scene.stated[place];
        let components = match &stated.constraints {
            StatedHold::Components(components) => *components,
            StatedHold::Joined | StatedHold::Fixed => [true; 3],
            StatedHold::Walls(normals) => {
                for (&node, normals) in stated.nodes.iter().zip(normals) {
                    let normals = normals.iter().map(|normal| (place, *normal));
                    walls.entry(node).or_default().extend(normals);
                }
                continue;
            }
        };
        for &node in &stated.nodes {
            sums[place].take(&mut rest[node as usize], components);
        }
    }
    for (node, walls) in walls {
        if rest[node as usize].is_held.contains(&true) {
            split_by_normals(&rest[node as usize].force, &walls, &mut sums);
        }
    }
    sums.extend(by_bone(scene, contact));
    sums
}

/// Contact force of the surface of each bone.
fn by_bone(scene: &Scene, contact: Option<&Touch>) -> Vec<ConditionReaction> {
    let of_bone = |(number, bone): (usize, &BoneSurface)| {
        let mut own = ConditionReaction {
            pointer: format!("/case/bones/{}", bone.place),
            segment: bone.is_carried.then(|| bone.name.clone()),
            nodes: 0,
            force: Vector::zeros(),
        };
        let pressed = contact.iter().flat_map(|touch| &touch.contact.pressed);
        for PressingRow { row, force } in pressed {
            if row.bone.is_some_and(|on| on.bone as usize == number) {
                own.force += row.normal() * *force;
                own.nodes += 1;
            }
        }
        (own.nodes > 0).then_some(own)
    };
    scene.bones.iter().enumerate().filter_map(of_bone).collect()
}

impl ConditionReaction {
    /// Takes the components that nothing stronger has.
    fn take(&mut self, rest: &mut Rest, components: [bool; 3]) {
        let own: [bool; 3] = std::array::from_fn(|k| components[k] && rest.is_held[k]);
        for component in (0..3).filter(|&component| own[component]) {
            self.force[component] += rest.force[component];
            rest.force[component] = 0.0;
            rest.is_held[component] = false;
        }
        self.nodes += usize::from(own.contains(&true));
    }
}

/// Splits the force on a node between walls into components along their normals.
fn split_by_normals(force: &Vector, walls: &[(usize, Vector)], sums: &mut [ConditionReaction]) {
    let mut own: Vec<(usize, Vector)> = Vec::new();
    for (place, normal) in walls {
        if own.iter().all(|(_, other)| other.cross(normal).norm() > ONE_WALL) {
            own.push((*place, *normal));
        }
    }
    let normals: Vec<Vector> = own.iter().map(|(_, normal)| *normal).collect();
    let inverse = Matrix3xX::from_columns(&normals).pseudo_inverse(ONE_WALL);
    let parts = inverse.map(|inverse| inverse * force);
    let parts = parts.unwrap_or_else(|_| DVector::zeros(own.len()));
    let mut last = None;
    for ((place, normal), part) in own.iter().zip(parts.iter()) {
        sums[*place].force += normal * *part;
        sums[*place].nodes += usize::from(last != Some(*place));
        last = Some(*place);
    }
}
