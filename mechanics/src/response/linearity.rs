//! Linearisation error of a response, estimated from the movements of its segments.
//!
//! Where elements have a second order, it is sampled: q_j, the mean length of the second-order term on the skin that moves
//! (`moving_points`) for a unit of translation along and of rotation about each axis of each segment, and e = sum_j alpha_j^2 q_j
//! for the numbers alpha of a plan, times what probes of the skin say of all directions together against the same sum of each
//! alone (`coupling`). Exact along a sampled direction. Where there is no second order (`prediction::without_second_order`), and in
//! responses of earlier programs, it is not known. Before anything is solved a rule of thumb stands for it:
//!
//! e = 0.15 d^2 / h + 2.7 h (1 - cos theta)
//!
//! d: the largest distance in mm by which a segment moves against another, or against what stays.
//! h: the thickness of the tissue, in mm: the median distance from skin nodes to the nearest held node.
//! theta: the largest rotation of a segment; each is also that of the tissue above it.
//!
//! The first term is the second order of elasticity in the displacement gradient d / h. Its factor is set so
//! that e is not below the mean difference of the skin between linear and neo-Hookean tissue in twelve
//! computations on a slab of 12 mm (docs/verification.md#v29: d 1.5 to 13.4 mm along, across and pulled
//! back, mean difference 0.013 to 1.46 mm); at most 4.4 times it, for movements along the skin. The
//! second term is the artefact of small strain under rotation: tissue that turns with its bone is strained by
//! cos theta - 1 in each direction across the axis, and its free side by nu / (1 - nu) times that along
//! the thickness; 2.7 = 1 + 2 nu / (1 - nu) at nu 0.46. An order of magnitude, not a bound.

use super::coupling::{Probed, second_together};
use super::rigid_numbers::{SAMPLES, rigid_numbers};
use crate::boundary::{ConnectedPart, Holder, NodeClass};
use crate::mesh::{EMPTY_BOUNDS, Vector, bounds_of};
use crate::plan::RigidMovement;
use crate::plan::doubt::farthest_apart;
use crate::prediction::Scene;

/// e above which an answer is said to be outside the linear range, in mm: half of the least mean error
/// that published systems report against patients (0.6 to 1.2 mm) would be left to everything else.
pub const LINEAR_RANGE_MM: f64 = 0.5;

const STRETCHED: f64 = 0.15;

const TURNED: f64 = 2.7;

/// Skin nodes whose distance to what is held is measured: enough for a median.
const MEASURED_NODES: usize = 1000;

/// Input of the estimate from a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearity {
    /// h in mm.
    pub thickness: f64,
    /// Whether something is held that does not move: fixed nodes, walls that stay, other segments.
    pub something_stays: bool,
    /// For each segment the lowest and the highest corner of the box around its nodes, in mm.
    pub boxes: Vec<[Vector; 2]>,
    /// Of each segment; empty where none is known.
    pub sampled: Vec<SampledSecond>,
    /// Of every pair of sampled directions; empty where lengths are added without it.
    pub coupling: Vec<Probed>,
}

/// Samples of the second order of one segment.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledSecond {
    /// About which it turns, in mm.
    pub centre: Vector,
    /// In mm for 1 mm along x, y, z and for 1 rad about x, y, z.
    pub second: [f64; SAMPLES],
}

/// How far movements are from the linear range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nonlinearity {
    /// In radians.
    pub largest_rotation: f64,
    /// d in mm.
    pub largest_relative_movement: f64,
    /// e in mm.
    pub estimate: f64,
}

impl Nonlinearity {
    pub fn is_within_linear_range(&self) -> bool {
        self.estimate <= LINEAR_RANGE_MM
    }
}

impl Linearity {
    /// Whether what linearity leaves out is known; the rule of thumb knows nothing of tissue and elements.
    pub fn is_known(&self) -> bool {
        !self.sampled.is_empty()
    }

    /// The estimate for one movement of each segment.
    pub fn of(&self, movements: &[RigidMovement]) -> Nonlinearity {
        let mut farthest: f64 = 0.0;
        for (number, (movement, corners)) in movements.iter().zip(&self.boxes).enumerate() {
            if self.something_stays {
                let stays = RigidMovement::default();
                farthest = farthest.max(farthest_apart(movement, &stays, corners));
            }
            for (other, others) in movements.iter().zip(&self.boxes).skip(number + 1) {
                farthest = farthest.max(farthest_apart(movement, other, corners));
                farthest = farthest.max(farthest_apart(movement, other, others));
            }
        }
        let largest_rotation = movements.iter().map(RigidMovement::angle).fold(0.0, f64::max);
        let stretched = STRETCHED * farthest * farthest / self.thickness;
        let turned = TURNED * self.thickness * (1.0 - largest_rotation.cos());
        let estimate = match self.sampled.is_empty() {
            true => stretched + turned,
            false => self.by_samples(movements),
        };
        Nonlinearity { largest_rotation, largest_relative_movement: farthest, estimate }
    }

    fn by_samples(&self, movements: &[RigidMovement]) -> f64 {
        let moved = self.sampled.iter().zip(movements);
        let numbers: Vec<f64> = moved.flat_map(|(of, by)| rigid_numbers(by, &of.centre)).collect();
        let lengths = self.sampled.iter().flat_map(|of| of.second);
        let alone = numbers.iter().zip(lengths).map(|(number, q)| number * number * q);
        alone.sum::<f64>() * second_together(&numbers, &self.coupling)
    }
}

/// The rule of thumb for the plan of a scene: nothing is solved.
pub fn by_rule_of_thumb(scene: &Scene) -> Nonlinearity {
    let segments: Vec<usize> = (0..scene.segments.len()).collect();
    let movements: Vec<RigidMovement> =
        scene.segments.iter().map(|segment| segment.movement).collect();
    of_scene(scene, &segments, &scene.parts).of(&movements)
}

/// What the estimate needs, for the segments of these numbers and the parts where only these move.
pub(super) fn of_scene(scene: &Scene, segments: &[usize], parts: &[ConnectedPart]) -> Linearity {
    let mut holders = parts.iter().flat_map(|part| &part.held).map(|rows| rows.holder);
    let box_of = |&segment: &usize| bounds_of(joined_nodes(scene, segment)).unwrap_or(EMPTY_BOUNDS);
    Linearity {
        thickness: thickness(scene),
        something_stays: holders.any(|holder| holder == Holder::Rest),
        boxes: segments.iter().map(box_of).collect(),
        sampled: Vec::new(),
        coupling: Vec::new(),
    }
}

/// The median distance in mm from skin nodes that are not held to the nearest held node; where all are
/// held, a tenth of the diagonal of the mesh.
fn thickness(scene: &Scene) -> f64 {
    let place = |node: u32| scene.mesh.nodes[node as usize];
    let held: Vec<Vector> =
        scene.conditions.constraints.iter().map(|constraint| place(constraint.node)).collect();
    let is_free = |node: &u32| scene.conditions.classes[*node as usize] == NodeClass::Free;
    let free: Vec<u32> = scene.skin.nodes().iter().copied().filter(is_free).collect();
    let step = free.len().div_ceil(MEASURED_NODES).max(1);
    let mut distances: Vec<f64> = free
        .iter()
        .step_by(step)
        .map(|&node| {
            let squared = held.iter().map(|other| (place(node) - other).norm_squared());
            squared.fold(f64::INFINITY, f64::min).sqrt()
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    match distances.get(distances.len() / 2) {
        Some(&median) if median > 0.0 && median.is_finite() => median,
        _ => {
            let [low, high] = scene.mesh.bounds();
            0.1 * (high - low).norm()
        }
    }
}

/// The places of the nodes that a segment holds.
pub(super) fn joined_nodes(scene: &Scene, segment: usize) -> impl Iterator<Item = &Vector> {
    let classes = scene.conditions.classes.iter();
    let is_joined = move |class: &NodeClass| *class == NodeClass::Joined(segment as u32);
    classes.zip(&scene.mesh.nodes).filter(move |(class, _)| is_joined(class)).map(|(_, x)| x)
}
