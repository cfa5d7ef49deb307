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

/// What is left of a node's reaction for weaker conditions.
#[derive(Clone, Default)]
struct Rest {
    force: Vector,
    /// For each component the condition that has it, by its place; none for nodes that nothing holds.
    holders: Option<[Option<usize>; 3]>,
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
        rest[constraint.node as usize] = Rest { force: *reaction, holders: Some([None; 3]) };
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
            rest[node as usize].give(place, components, &mut sums);
        }
    }
    for (node, walls) in walls {
        rest[node as usize].split_by_normals(&walls, &mut sums);
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

impl Rest {
    /// Gives a condition the components that nothing stronger has.
    fn give(&mut self, place: usize, components: [bool; 3], sums: &mut [ConditionReaction]) {
        let Some(holders) = &mut self.holders else { return };
        let own = (0..3).filter(|&k| components[k] && holders[k].is_none());
        let own: Vec<usize> = own.collect();
        for &component in &own {
            sums[place].force[component] += self.force[component];
            self.force[component] = 0.0;
            holders[component] = Some(place);
        }
        sums[place].nodes += usize::from(!own.is_empty());
    }

    /// Splits what is left between walls into forces along their normals. What those have along components that stronger conditions
    /// hold, these withstand.
    fn split_by_normals(&self, walls: &[(usize, Vector)], sums: &mut [ConditionReaction]) {
        let Some(holders) = self.holders else { return };
        let left = |normal: &Vector| {
            Vector::from_fn(|k, _| if holders[k].is_none() { normal[k] } else { 0.0 })
        };
        let mut own: Vec<(usize, Vector)> = Vec::new();
        for (place, normal) in walls {
            let is_new = own.iter().all(|(_, other)| other.cross(normal).norm() > ONE_WALL);
            if is_new && left(normal).norm() > ONE_WALL {
                own.push((*place, *normal));
            }
        }
        if own.is_empty() {
            return;
        }
        let normals: Vec<Vector> = own.iter().map(|(_, normal)| left(normal)).collect();
        let inverse = Matrix3xX::from_columns(&normals).pseudo_inverse(ONE_WALL);
        let parts = inverse.map(|inverse| inverse * self.force);
        let parts = parts.unwrap_or_else(|_| DVector::zeros(own.len()));
        let mut last = None;
        for ((place, normal), part) in own.iter().zip(parts.iter()) {
            let force = normal * *part;
            sums[*place].force += force;
            for (component, holder) in holders.iter().enumerate() {
                holder.iter().for_each(|&holder| sums[holder].force[component] -= force[component]);
            }
            sums[*place].nodes += usize::from(last != Some(*place));
            last = Some(*place);
        }
    }
}
