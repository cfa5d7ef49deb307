//! Coverage of bone: how much of its surface beside tissue has a node of its own near it.

use rayon::prelude::*;

use super::bone_labels::{BoneLabels, Owner};
use super::classes::{NodeClasses, Role, TissueBoundary};
use super::joining::{longest_edge, role_of};
use super::voxel_cells::VoxelCells;
use crate::mesh::Vector;
use crate::mesh::clusters::{Clusters, clusters};
use crate::mesh::cubes::Cubes;

/// Surface farther from all nodes of its bone than so many edges of the cell there is not covered.
const REACH: f64 = 1.5;
/// Faces of voxels have so many times the area of the surface that they stand for, in the mean over its directions.
const STAIRS: f64 = 1.5;
/// Places at most about so far apart are of one patch, in mm and in diagonals of a voxel, whichever is more.
const APART: [f64; 2] = [3.0, 1.5];

/// The surface of a bone beside tissue of a mesh, and what of it has no node. Areas in mm².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    pub area: f64,
    pub bare: f64,
    /// The largest connected patch without nodes, and the place of it that is nearest to its middle.
    pub patch: f64,
    pub patch_at: Vector,
    /// Bone in cells of tissue, in mm³.
    pub in_cells: f64,
}

/// A part of the surface of bone.
struct Facet {
    owner: usize,
    at: Vector,
    area: f64,
    /// How far a node may be, in mm; 0 where one is in the cell.
    reach: f64,
}

/// Bone and the tissue around it.
struct Surface<'a> {
    tissue: TissueBoundary<'a>,
    labels: &'a BoneLabels,
    cells: &'a VoxelCells,
    slides: &'a (dyn Fn(&Vector) -> bool + Sync),
    segments: usize,
}

/// Coverage of each segment, in their order, and of bone that stays, last. Teeth, which tissue slides on, are left out.
pub fn coverage(
    tissue: TissueBoundary<'_>,
    (labels, cells): (&BoneLabels, &VoxelCells),
    slides: &(dyn Fn(&Vector) -> bool + Sync),
    (classes, segments): (&NodeClasses, usize),
) -> Vec<Coverage> {
    let surface = Surface { tissue, labels, cells, slides, segments };
    let owners = surface.owners_of_nodes(classes);
    let facets = cells.iter().flat_map_iter(|found| surface.facets(found, &owners));
    let facets: Vec<Facet> = facets.collect();
    let mut in_cells = vec![0; segments + 1];
    let of_voxel = |(voxel, _): (usize, usize)| surface.owner(labels.owner(voxel)?);
    let held: Vec<usize> = cells.iter().filter_map(of_voxel).collect();
    held.into_iter().for_each(|owner| in_cells[owner] += 1);
    let of_owner = |owner: usize| {
        let of = facets.iter().filter(|facet| facet.owner == owner);
        let in_cells = f64::from(in_cells[owner]) * labels.voxel_volume();
        Coverage { in_cells, ..surface.coverage(&of.collect::<Vec<_>>(), &owners) }
    };
    (0..=segments).map(of_owner).collect()
}

impl Surface<'_> {
    fn owner(&self, owner: Owner) -> Option<usize> {
        role_of(owner).and_then(|role| self.owner_of_role(role))
    }

    fn owner_of_role(&self, role: Role) -> Option<usize> {
        match role {
            Role::Joined(segment) | Role::Sliding(Some(segment)) => Some(segment),
            Role::Fixed | Role::Sliding(None) => Some(self.segments),
            Role::Free => None,
        }
    }

    /// Of each node the bone that it goes with, or would go with but for the band along cuts.
    fn owners_of_nodes(&self, classes: &NodeClasses) -> Vec<Option<usize>> {
        let of = |role: &Role| self.owner_of_role(*role);
        let mut owners: Vec<Option<usize>> = classes.roles.iter().map(of).collect();
        for (node, role) in &classes.freed {
            owners[*node as usize] = of(role);
        }
        owners
    }

    /// Faces of bone at most two voxels from a voxel beside it.
    fn facets(&self, (voxel, cell): (usize, usize), owners: &[Option<usize>]) -> Vec<Facet> {
        let mut facets = Vec::new();
        if self.labels.owner(voxel).is_some() {
            return facets;
        }
        let (size, steps) = (self.labels.size(), self.labels.placement().steps);
        let strides = [1, size[0], size[0] * size[1]];
        let place = [voxel % size[0], voxel / size[0] % size[1], voxel / strides[2]];
        for axis in 0..3 {
            for forwards in [false, true] {
                let room = if forwards { size[axis] - 1 - place[axis] } else { place[axis] };
                let there = |step: usize| match forwards {
                    true => voxel + step * strides[axis],
                    false => voxel - step * strides[axis],
                };
                let bone = (1..=room.min(2)).find(|&step| self.labels.owner(there(step)).is_some());
                let Some(step) = bone.filter(|&step| step == 1 || !self.cells.is_held(there(1)))
                else {
                    continue;
                };
                let owner = self.labels.owner(there(step)).and_then(|owner| self.owner(owner));
                let way = (step as f64 - 0.5) * if forwards { 1.0 } else { -1.0 };
                let at = self.labels.centre_of(voxel) + steps[axis] * way;
                let Some(owner) = owner.filter(|_| !(self.slides)(&at)) else { continue };
                let area = steps[(axis + 1) % 3].cross(&steps[(axis + 2) % 3]).norm() / STAIRS;
                let nodes = self.tissue.mesh.cells.nodes(cell);
                let is_covered = nodes.iter().any(|node| owners[*node as usize] == Some(owner));
                let reach = if is_covered { 0.0 } else { REACH * longest_edge(&self.tissue, cell) };
                facets.push(Facet { owner, at, area, reach });
            }
        }
        facets
    }

    /// Of the facets of one bone.
    fn coverage(&self, facets: &[&Facet], owners: &[Option<usize>]) -> Coverage {
        let Some(owner) = facets.first().map(|facet| facet.owner) else {
            return Coverage::default();
        };
        let farthest = facets.iter().map(|facet| facet.reach).fold(f64::MIN_POSITIVE, f64::max);
        let place = |node: u32| self.tissue.mesh.nodes[node as usize];
        let own = (0..owners.len() as u32).filter(|node| owners[*node as usize] == Some(owner));
        let cubes = Cubes::new(farthest, own.map(|node| (node, place(node))));
        let is_bare = |facet: &&&Facet| {
            let near = |node: u32| (place(node) - facet.at).norm() <= facet.reach;
            facet.reach > 0.0 && !cubes.around(&facet.at).any(near)
        };
        let bare: Vec<&Facet> = facets.par_iter().filter(is_bare).copied().collect();
        let steps = self.labels.placement().steps;
        let apart = APART[0].max(APART[1] * steps.iter().sum::<Vector>().norm());
        let patch = largest_patch(&bare, apart);
        // The sum of no numbers is -0.
        let area = |facets: &[&Facet]| facets.iter().map(|facet| facet.area).sum::<f64>() + 0.0;
        Coverage {
            area: area(facets),
            bare: area(&bare),
            patch: area(&patch),
            patch_at: middle_of(&patch),
            in_cells: 0.0,
        }
    }
}

/// Of the patches of facets in neighbouring cubes that with the largest area, of equals the first.
fn largest_patch<'a>(facets: &[&'a Facet], apart: f64) -> Vec<&'a Facet> {
    let places: Vec<Vector> = facets.iter().map(|facet| facet.at).collect();
    let Clusters { of_place, count } = clusters(&places, apart);
    let mut areas = vec![0.0; count];
    of_place.iter().zip(facets).for_each(|(&patch, facet)| areas[patch] += facet.area);
    let largest = areas.iter().copied().fold(0.0, f64::max);
    let first = areas.iter().position(|area| *area == largest);
    let of_patch = of_place.iter().zip(facets).filter(|(patch, _)| Some(**patch) == first);
    of_patch.map(|(_, facet)| *facet).collect()
}

/// The place of a patch that is nearest to the mean of all of it.
fn middle_of(patch: &[&Facet]) -> Vector {
    let mean = patch.iter().map(|facet| facet.at).sum::<Vector>() / patch.len().max(1) as f64;
    let off = |facet: &&&Facet| (facet.at - mean).norm();
    let nearest = patch.iter().min_by(|one, other| off(one).total_cmp(&off(other)));
    nearest.map_or(mean, |facet| facet.at)
}
