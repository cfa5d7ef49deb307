//! Classes of the nodes of a tissue mesh: joined to a segment, fixed, sliding on a bone, or free.
//!
//! A node on bone goes with the bone that lies behind its boundary; where that slides, only along the wall's normal. The
//! rest of the bone is fixed. Nodes beside an osteotomy would tear the tissue if each went with its side, so that a band
//! along it is free: the soft tissue is lifted there anyway and slips (Zachow et al. 2006, section 4.4).
//! Source of the classes: Kim et al. 2012, section 2.3.

use std::collections::BTreeMap;

use super::bone_labels::{NearestBone, Owner};
use super::cut::Plane;
use super::free_band::near_other_segments;
use crate::domain::Boundary;

use crate::mesh::{Vector, VolumeMesh, Warning};

/// Class of a node. Segments by their number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    Joined(usize),
    Fixed,
    /// Along the bone of a segment, or along bone that stays.
    Sliding(Option<usize>),
    Free,
}

/// A mesh of tissue and what each of its nodes lies on; `None` for the nodes inside.
#[derive(Clone, Copy)]
pub struct TissueBoundary<'a> {
    pub mesh: &'a VolumeMesh,
    pub marks: &'a [Option<Boundary>],
}

/// Classes of nodes on bone.
pub struct BoneContact<'a> {
    /// The bone behind a place, seen along the normal that leaves the tissue.
    pub behind: &'a dyn Fn(&Vector, &Vector) -> Option<NearestBone>,
    /// Whether tissue slides there: teeth and mucosa.
    pub slides: &'a dyn Fn(&Vector) -> bool,
}

/// Rules of the classes, and the width of the free band along osteotomies.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassRules {
    /// For each segment a number that those share which move alike; 0 for those that stay with the rest of the bone.
    pub movements: Vec<u32>,
    /// Held nodes this near to one that moves otherwise are free, in mm.
    pub band_mm: f64,
    /// Whether tissue is fixed where the scan ends.
    pub scan_ends_fixed: bool,
    /// All nodes above this plane are fixed: the most posterior part of the tissue.
    pub fixed_above: Option<Plane>,
}

/// The role of each node, and what a reader must know of how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeClasses {
    pub roles: Vec<Role>,
    /// Nodes that are free because others beside them move otherwise.
    pub in_band: usize,
    /// These, ascending, with the roles that they would have.
    pub freed: Vec<(u32, Role)>,
    /// Nodes on bone that no bone was found behind.
    pub without_bone: usize,
    /// These, ascending, before any is joined to bone that no cell resolved.
    pub unbacked: Vec<u32>,
    pub warnings: Vec<Warning>,
}

/// Gives each node one role: joined before fixed before sliding before free.
pub fn classify(
    tissue: TissueBoundary<'_>,
    bone: &BoneContact<'_>,
    rules: &ClassRules,
) -> NodeClasses {
    let normals = outward_normals(&tissue);
    let mut unbacked = Vec::new();
    let mut overlaps = Overlaps::default();
    let mut roles = Vec::with_capacity(tissue.mesh.nodes.len());
    for (node, place) in tissue.mesh.nodes.iter().enumerate() {
        let on_bone = match tissue.marks[node] {
            Some(Boundary::Bone) => role_on_bone(bone, place, &normals[node]),
            Some(Boundary::Cut) if rules.scan_ends_fixed => Some(Role::Fixed),
            Some(Boundary::Cut | Boundary::Skin | Boundary::Airway) | None => Some(Role::Free),
        };
        unbacked.extend(on_bone.is_none().then_some(node as u32));
        let beyond = rules.fixed_above.is_some_and(|plane| plane.height(place) > 0.0);
        roles.push(overlaps.strongest(on_bone.unwrap_or(Role::Free), beyond));
    }
    let freed = free_near_other_segments(&tissue, rules, &mut roles);
    let (in_band, without_bone) = (freed.len(), unbacked.len());
    NodeClasses { roles, in_band, freed, without_bone, unbacked, warnings: overlaps.warnings() }
}

/// `None` where no bone lies behind a node that lies on bone.
fn role_on_bone(bone: &BoneContact<'_>, place: &Vector, normal: &Vector) -> Option<Role> {
    let behind = (bone.behind)(place, normal)?;
    let slides = (bone.slides)(place);
    Some(match behind.owner {
        Owner::Segment(segment) if slides => Role::Sliding(Some(segment)),
        Owner::Segment(segment) => Role::Joined(segment),
        Owner::Rest if slides => Role::Sliding(None),
        Owner::Rest => Role::Fixed,
        Owner::Sawn | Owner::Loose => Role::Free,
    })
}

/// Nodes that two classes claim.
#[derive(Default)]
struct Overlaps {
    joined: usize,
    sliding: usize,
}

impl Overlaps {
    /// The stronger of a role and of being fixed beyond the plane.
    fn strongest(&mut self, role: Role, fixed: bool) -> Role {
        match role {
            Role::Joined(_) => self.joined += usize::from(fixed),
            Role::Sliding(_) if fixed => {
                self.sliding += 1;
                return Role::Fixed;
            }
            Role::Free if fixed => return Role::Fixed,
            Role::Sliding(_) | Role::Fixed | Role::Free => {}
        }
        role
    }

    fn warnings(&self) -> Vec<Warning> {
        if self.joined + self.sliding == 0 {
            return Vec::new();
        }
        let detail = format!(
            "{} nodes in the fixed part are joined to a segment and go with it, {} would slide and are fixed",
            self.joined, self.sliding
        );
        let warning = Warning::new("conditions-overlap", detail).with("joined", self.joined as f64);
        vec![warning.with("sliding", self.sliding as f64)]
    }
}

/// Frees constrained nodes that are near nodes with another movement, or share a cell with one; returns them.
fn free_near_other_segments(
    tissue: &TissueBoundary<'_>,
    rules: &ClassRules,
    roles: &mut [Role],
) -> Vec<(u32, Role)> {
    let movements: Vec<Option<u32>> = roles.iter().map(|role| rules.movement(*role)).collect();
    let near = near_other_segments(tissue.mesh, &movements, rules.band_mm);
    let freed = |node: u32| (node, std::mem::replace(&mut roles[node as usize], Role::Free));
    near.into_iter().map(freed).collect()
}

impl ClassRules {
    /// The number of the movement of nodes with a role; none of free ones.
    pub(super) fn movement(&self, role: Role) -> Option<u32> {
        match role {
            Role::Joined(segment) | Role::Sliding(Some(segment)) => Some(self.movements[segment]),
            Role::Fixed | Role::Sliding(None) => Some(0),
            Role::Free => None,
        }
    }
}

/// For each node on bone the unit normal out of the tissue, by the area of its faces; those of which all nodes are on
/// bone count before others. Zero for nodes that are not on bone.
fn outward_normals(tissue: &TissueBoundary<'_>) -> Vec<Vector> {
    let on_bone = |node: &u32| tissue.marks[*node as usize] == Some(Boundary::Bone);
    let mut whole = vec![Vector::zeros(); tissue.mesh.nodes.len()];
    let mut part = whole.clone();
    for face in tissue.mesh.boundary_faces() {
        let area_vector = face.area_vector(&tissue.mesh.nodes);
        let normals = if face.nodes().iter().all(on_bone) { &mut whole } else { &mut part };
        for &node in face.nodes().iter().filter(|node| on_bone(node)) {
            normals[node as usize] += area_vector;
        }
    }
    let unit = |normal: Vector| normal.try_normalize(f64::MIN_POSITIVE);
    let both = whole.into_iter().zip(part);
    both.map(|(whole, part)| unit(whole).or_else(|| unit(part)).unwrap_or_default()).collect()
}

/// The node set of what slides on a segment.
pub fn sliding_set(segment: &str) -> String {
    format!("sliding_{segment}")
}

impl NodeClasses {
    /// Node sets: `NAME` of each segment, `fixed`, and `sliding_NAME` or `sliding_rest`; those that hold a node.
    pub fn node_sets(&self, segments: &[String]) -> BTreeMap<String, Vec<u32>> {
        let mut sets: BTreeMap<String, Vec<u32>> = BTreeMap::new();
        for (node, role) in self.roles.iter().enumerate() {
            let name = match role {
                Role::Joined(segment) => segments[*segment].clone(),
                Role::Fixed => "fixed".to_owned(),
                Role::Sliding(Some(segment)) => sliding_set(&segments[*segment]),
                Role::Sliding(None) => "sliding_rest".to_owned(),
                Role::Free => continue,
            };
            sets.entry(name).or_default().push(node as u32);
        }
        sets
    }

    /// How many nodes have a role.
    pub fn count(&self, role: Role) -> usize {
        self.roles.iter().filter(|other| **other == role).count()
    }
}
