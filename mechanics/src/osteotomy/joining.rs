//! Nodes that bone holds although no cell resolved it: bone thinner than cells lies in cells of tissue, whose nodes nearest to it
//! go with it.
//!
//! Cells with a node on that bone are left alone, so that nothing changes where bone is resolved. Nodes of the skin and of the ends of
//! the scan are not taken, nor those that air parts from the bone, nor those that two bones with different movements would have.

use rayon::prelude::*;

use super::bone_labels::{BoneLabels, Owner};
use super::classes::{ClassRules, NodeClasses, Role, TissueBoundary};
use super::free_band::near_other_segments;
use super::voxel_cells::VoxelCells;
use crate::domain::{Boundary, Domain};
use crate::mesh::Vector;

/// Nodes farther from bone than this part of the longest edge of its cell are not taken. In a body-centred cubic lattice every place
/// has a node within .56 of that.
const REACH: f64 = 0.75;
/// Steps in which the way from a node to bone is looked at, the first of them from the node on.
const STEPS: usize = 8;

/// Bone in cells of tissue, and where teeth are.
pub struct MissedBone<'a> {
    pub labels: &'a BoneLabels,
    pub cells: &'a VoxelCells,
    pub domain: &'a dyn Domain,
    /// Whether tissue slides there: nodes inside tissue have no wall to slide on, and are not taken.
    pub slides: &'a (dyn Fn(&Vector) -> bool + Sync),
}

/// Gives nodes beside bone that no cell resolved the role of nodes on it; returns them, ascending.
pub fn join_missed(
    tissue: TissueBoundary<'_>,
    bone: &MissedBone<'_>,
    rules: &ClassRules,
    classes: &mut NodeClasses,
) -> Vec<u32> {
    let before: &NodeClasses = classes;
    let of_voxels = bone.cells.iter().filter_map(|(voxel, cell)| {
        let role = role_of(bone.labels.owner(voxel)?)?;
        let node = bone.node(&tissue, before, rules, (voxel, cell, role))?;
        Some((node, role))
    });
    let mut taken: Vec<(u32, Role)> = of_voxels.collect();
    taken.par_sort_unstable();
    taken.dedup();
    let alone = |role: &[(u32, Role)]| {
        let same =
            role.iter().all(|(_, other)| rules.movement(*other) == rules.movement(role[0].1));
        same.then_some(role[0])
    };
    let taken: Vec<(u32, Role)> =
        taken.chunk_by(|one, other| one.0 == other.0).filter_map(alone).collect();
    for &(node, role) in &taken {
        classes.roles[node as usize] = role;
    }
    let movements: Vec<Option<u32>> =
        classes.roles.iter().map(|role| rules.movement(*role)).collect();
    let near = near_other_segments(tissue.mesh, &movements, rules.band_mm);
    let (apart, kept): (Vec<_>, Vec<_>) =
        taken.into_iter().partition(|(node, _)| near.contains(node));
    for &(node, role) in &apart {
        classes.roles[node as usize] = Role::Free;
        classes.freed.push((node, role));
    }
    let was_unbacked = |(node, _): &&(u32, Role)| classes.unbacked.binary_search(node).is_ok();
    classes.without_bone -= kept.iter().filter(was_unbacked).count();
    classes.in_band += apart.len();
    classes.freed.sort_unstable();
    kept.into_iter().map(|(node, _)| node).collect()
}

/// What a node on that bone is; none where bone holds nothing.
pub(super) fn role_of(owner: Owner) -> Option<Role> {
    match owner {
        Owner::Rest => Some(Role::Fixed),
        Owner::Segment(segment) => Some(Role::Joined(segment)),
        Owner::Sawn | Owner::Loose => None,
    }
}

impl MissedBone<'_> {
    /// The node that a voxel of bone takes from its cell.
    fn node(
        &self,
        tissue: &TissueBoundary<'_>,
        classes: &NodeClasses,
        rules: &ClassRules,
        (voxel, cell, role): (usize, usize, Role),
    ) -> Option<u32> {
        let nodes = tissue.mesh.cells.nodes(cell);
        let role_before = |node: &u32| classes.roles[*node as usize];
        let was_freed =
            |node: &u32| classes.freed.binary_search_by_key(node, |(freed, _)| *freed).is_ok();
        let is_unbacked = |node: &u32| classes.unbacked.binary_search(node).is_ok();
        let movement = rules.movement(role);
        let is_resolved =
            |node: &u32| rules.movement(role_before(node)) == movement || was_freed(node);
        let at = self.labels.centre_of(voxel);
        if nodes.iter().any(is_resolved) || self.domain.value(&at) > 0.0 || (self.slides)(&at) {
            return None;
        }
        let distance = |node: &u32| (tissue.mesh.nodes[*node as usize] - at).norm();
        let reach = REACH * longest_edge(tissue, cell);
        let middle = tissue.mesh.centroid(cell);
        let is_free = |node: &&u32| {
            let counts = match tissue.marks[**node as usize] {
                Some(Boundary::Skin | Boundary::Cut) => false,
                Some(Boundary::Bone) => is_unbacked(node),
                Some(Boundary::Airway) | None => true,
            };
            counts && role_before(node) == Role::Free && distance(node) <= reach
        };
        let mut nodes: Vec<u32> = nodes.iter().filter(is_free).copied().collect();
        nodes.sort_by(|one, other| distance(one).total_cmp(&distance(other)));
        nodes.into_iter().find(|&node| {
            let on_bone = tissue.marks[node as usize] == Some(Boundary::Bone);
            on_bone || self.is_reached(&tissue.mesh.nodes[node as usize], &middle, &at)
        })
    }

    /// Whether the first boundary on the way from a node to bone, both in one cell, is that of bone.
    fn is_reached(&self, node: &Vector, middle: &Vector, bone: &Vector) -> bool {
        // A node on a wall lies on neither side of it.
        let from = node + (middle - node) * 0.05;
        let place = |step: usize| from + (bone - from) * (step as f64 / STEPS as f64);
        let is_tissue = |step: usize| self.domain.value(&place(step)) > 0.0;
        let outside = (0..=STEPS).find(|&step| !is_tissue(step));
        match outside {
            Some(0) | None => false,
            Some(step) => {
                self.domain.crossing(&place(step - 1), &place(step)).boundary == Boundary::Bone
            }
        }
    }
}

/// About the edge of a cube of the lattice, in mm.
pub(super) fn longest_edge(tissue: &TissueBoundary<'_>, cell: usize) -> f64 {
    let corners: Vec<Vector> = tissue.mesh.corners(cell).collect();
    let edges = corners
        .iter()
        .enumerate()
        .flat_map(|(n, one)| corners[n + 1..].iter().map(move |other| (one - other).norm()));
    edges.fold(0.0, f64::max)
}
