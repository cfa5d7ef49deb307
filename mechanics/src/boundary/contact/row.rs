//! One inequality of contact: a node and the point of the boundary that it may not pass.

use std::collections::BTreeMap;

use crate::boundary::Constraint;
use crate::mesh::Vector;

/// How nearly two rows of one node are to agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alike {
    /// While points are looked for, so that a point that slides over an edge does not alternate between faces.
    Nearly,
    /// In an answer: a force along a normal of before would hold as friction does.
    Exactly,
}

impl Alike {
    /// Gaps differ by less than this, in mm, and the cosine of the normals is above this: 2.6, 0.1 or 0.02 degrees. Tissue turns a
    /// little with every answer, bone rests.
    fn bounds(self, is_on_bone: bool) -> (f64, f64) {
        match (self, is_on_bone) {
            (Alike::Nearly, _) => (1e-3, 0.999),
            (Alike::Exactly, false) => (1e-4, 1.0 - 1.5e-6),
            (Alike::Exactly, true) => (1e-5, 1.0 - 6e-8),
        }
    }
}

/// Rows with a gap above this, in mm, are not expected to close.
const FAR_MM: f64 = 0.05;

/// g(u) = gap + sum c_a . u_a >= 0, with a pressing force along c_a at each node a (Signorini 1959; node to surface).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRow {
    /// The node that is kept from passing.
    pub node: u32,
    /// The node with the unit normal n, and the corners of the triangle of tissue that it faces with -w n, w their weights.
    pub terms: Vec<(u32, Vector)>,
    /// At rest, in mm; nothing may be below 0 there.
    pub gap: f64,
    /// What it faces where that is no tissue.
    pub bone: Option<OnBone>,
}

/// A place on the surface of a bone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnBone {
    /// Its number among the bones.
    pub bone: u32,
    /// -n . u of the place, u its whole movement: what that adds to the gap, in mm.
    pub carried: f64,
}

impl ContactRow {
    /// g in mm after a displacement of tissue and a share of the movement of bones.
    pub fn gap_after(&self, displacement: &[Vector], share: f64) -> f64 {
        self.gap + self.moved(displacement) + share * self.carried()
    }

    /// g in mm after a part of a displacement and of the movement of bones.
    pub fn gap_after_part(&self, displacement: &[Vector], part: f64) -> f64 {
        self.gap + part * (self.moved(displacement) + self.carried())
    }

    fn moved(&self, displacement: &[Vector]) -> f64 {
        let moved = self.terms.iter().map(|(node, along)| along.dot(&displacement[*node as usize]));
        moved.sum()
    }

    fn carried(&self) -> f64 {
        self.bone.map_or(0.0, |on| on.carried)
    }

    /// Whether another row of the same node says the same after a displacement and a share of the movement of bones.
    pub fn agrees(
        &self,
        other: &ContactRow,
        alike: Alike,
        displacement: &[Vector],
        share: f64,
    ) -> bool {
        let (mm, cosine) = alike.bounds(self.bone.is_some());
        let apart = self.gap_after(displacement, share) - other.gap_after(displacement, share);
        self.bone.map(|on| on.bone) == other.bone.map(|on| on.bone)
            && apart.abs() < mm
            && self.normal().dot(&other.normal()) > cosine
    }

    /// Whether the gap is closed or nearly so.
    pub fn is_near(&self, displacement: &[Vector], share: f64) -> bool {
        self.gap_after(displacement, share) < FAR_MM
    }

    /// Out of what the node faces.
    pub fn normal(&self) -> Vector {
        self.terms.first().map(|(_, along)| *along).unwrap_or_default()
    }
}

/// Holds, with those of nodes whose rows press: along the normal of what they press on.
pub fn with_pressing<'a>(
    constraints: &[Constraint],
    pressing: impl Iterator<Item = &'a ContactRow>,
) -> Vec<Constraint> {
    let mut by_node: BTreeMap<u32, Constraint> =
        constraints.iter().map(|constraint| (constraint.node, constraint.clone())).collect();
    for row in pressing {
        let constraint = by_node.entry(row.node).or_insert_with(|| Constraint::free(row.node));
        constraint.add(&row.normal(), 0.0);
    }
    by_node.into_values().collect()
}
