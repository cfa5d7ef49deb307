//! Operations of virtual patients: the jaw, or both jaws, moved as Zhang et al. 2016 name them.

use crate::draws::Draws;
use crate::mesh::{Vector, VolumeMesh};
use crate::plan::{PlannedSegment, RigidMovement};
use crate::prediction::Plan;

/// What is moved: the mandible (M) or the maxilla (X), forward (A), backward (B), to the right (R) or to the left (L).
pub const OPERATIONS: [Operation; 6] = [
    Operation { name: "MA", class: SINGLE, mandible: [0.0, -1.0], maxilla: None },
    Operation { name: "MB", class: SINGLE, mandible: [0.0, 1.0], maxilla: None },
    Operation { name: "MR", class: SINGLE, mandible: [-1.0, 0.0], maxilla: None },
    Operation { name: "ML", class: SINGLE, mandible: [1.0, 0.0], maxilla: None },
    Operation { name: "MB+XA", class: TWO, mandible: [0.0, 1.0], maxilla: Some([0.0, -1.0]) },
    Operation { name: "MB+XB", class: TWO, mandible: [0.0, 1.0], maxilla: Some([0.0, 1.0]) },
];

pub const SINGLE: &str = "single_jaw";
pub const TWO: &str = "two_jaw";

/// Directions by x (to the left) and y (to the back).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operation {
    pub name: &'static str,
    pub class: &'static str,
    mandible: [f64; 2],
    maxilla: Option<[f64; 2]>,
}

/// Lengths in mm and angles in degrees.
const MANDIBLE: [f64; 2] = [2.0, 6.0];
const MAXILLA: [f64; 2] = [1.5, 4.0];
const TURN: f64 = 2.0;

impl Operation {
    /// A plan of this operation.
    pub fn plan(&self, mesh: &VolumeMesh, draws: &mut Draws) -> Plan {
        let mut segments = vec![moved("mandible", self.mandible, MANDIBLE, mesh, draws)];
        if let Some(direction) = self.maxilla {
            segments.push(moved("maxilla", direction, MAXILLA, mesh, draws));
        }
        Plan { segments, ..Plan::default() }
    }
}

fn moved(
    name: &str,
    [x, y]: [f64; 2],
    [least, most]: [f64; 2],
    mesh: &VolumeMesh,
    draws: &mut Draws,
) -> PlannedSegment {
    let length = draws.between(least, most);
    let shift = Vector::new(x * length, y * length, draws.between(-1.0, 1.0));
    let angles: [f64; 3] = std::array::from_fn(|_| draws.between(-TURN, TURN).to_radians());
    let nodes = mesh.node_set(name).unwrap_or_default();
    let sum: Vector = nodes.iter().map(|&node| mesh.nodes[node as usize]).sum();
    let middle = sum / nodes.len().max(1) as f64;
    let movement = RigidMovement::about_pivot(Vector::from(angles), middle, shift);
    PlannedSegment { name: name.to_owned(), movement }
}
