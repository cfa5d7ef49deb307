//! Validity of small strain for an answer.
//!
//! Where the second-order term is known (`nonlinearity`), e is the 95th percentile of its length over the skin, and over
//! each part of the skin that has a name: a thin lip must not hide in a large cheek. Where it is not, of quadratic
//! tetrahedra and of methods without a matrix of linear elements, a rule of thumb stands for it:
//!
//! e = p95 over free skin nodes of l (2 (1 - cos theta) + 0.9 s^2), in mm
//!
//! l: the distance in mm to the nearest node that cannot slide. theta: the rotation, s: the largest principal strain in
//! amount, both means over the cells around the node.
//!
//! What small strain leaves out is half of grad u^T grad u: 1 - cos theta where tissue turns, s^2 / 2 where it
//! stretches; over the length l that is a displacement. A layer on a bone that turns by theta is squeezed along
//! the bone by 1 - cos theta, so that its skin lies too high by l (1 - cos theta) / (1 - nu), at most twice. With
//! 0.9 for the stretching e is not below the difference between linear and finite elasticity in a swelling thick
//! sphere up to 25 mm (docs/verification.md#v8) nor below its mean on the slab (docs/verification.md#v29), 1.5 to 13.4 mm
//! along, across and pulled back; it is at most 5 times these. An order of magnitude, not a bound.
//!
//! Never of single cells: their strain at the edge of a bone grows without limit as cells shrink
//! (docs/methods.md#error-estimates).

use std::cell::LazyCell;

use rayon::prelude::*;

use super::Scene;
use super::nonlinearity::Estimated;
use crate::boundary::{Constraint, NodeClass};
use crate::mesh::{Vector, Warning};
use crate::model::fem::strain::CellDeformation;

/// e above which the answer is said to have left small strain, in mm; the same as for responses.
const SMALL_STRAIN_MM: f64 = 0.5;

const TURNED: f64 = 2.0;
const STRETCHED: f64 = 0.9;

/// Skin nodes of which e is taken: enough for its 95th percentile.
const MEASURED_NODES: usize = 1000;

/// What happens at one skin node.
#[derive(Clone, Copy)]
struct AtNode {
    rotation: f64,
    strain: f64,
    /// The two terms of e in mm.
    turned: f64,
    stretched: f64,
}

/// A warning where e is above half a millimetre: `large-rotation` or `large-strain`, whichever has the larger part.
pub(super) fn left(
    scene: &Scene,
    deformation: &[CellDeformation],
    estimated: &Estimated,
) -> Option<Warning> {
    if !scene.settings.method.properties().is_small_strain {
        return None;
    }
    let points = scene.skin.points();
    let parts = [("skin", &points)].into_iter();
    let named = scene.skin.regions.iter().map(|(name, points)| (name.as_str(), points));
    let around = LazyCell::new(|| around_skin_nodes(scene, deformation));
    let nodes_at = |points: &[u32]| measured(scene, points, &around);
    let left_out = estimated.as_ref().map(|known| scene.skin.lengths(&known.left_out));
    let estimates = parts.chain(named).filter_map(|(name, points)| {
        let by_rule = |nodes: &[AtNode]| p95(nodes, |at| at.turned + at.stretched);
        let estimate = match &left_out {
            Ok(_) if points.is_empty() => None,
            Ok(lengths) => Some(p95(points, |point| lengths[*point as usize])),
            Err(_) => Some(nodes_at(points)).filter(|nodes| !nodes.is_empty()).map(|n| by_rule(&n)),
        };
        estimate.map(|estimate| (estimate, name, points))
    });
    let (estimate, part, points) = estimates.max_by(|a, b| a.0.total_cmp(&b.0))?;
    if estimate <= SMALL_STRAIN_MM {
        return None;
    }
    let nodes = nodes_at(points);
    let (turned, stretched) = (p95(&nodes, |at| at.turned), p95(&nodes, |at| at.stretched));
    let (code, what) = match turned > stretched {
        true => ("large-rotation", "turns"),
        false => ("large-strain", "stretches"),
    };
    let detail = format!(
        "the tissue {what} beyond small strain: the displacement may be off by about {estimate:.1} mm at {part:?}"
    );
    Some(
        Warning::new(code, detail)
            .with("estimate_mm", estimate)
            .with("rotation_p95_deg", p95(&nodes, |at| at.rotation).to_degrees())
            .with("strain_p95", p95(&nodes, |at| at.strain))
            .with("largest_rotation_deg", largest(deformation).to_degrees()),
    )
}

fn largest(deformation: &[CellDeformation]) -> f64 {
    deformation.iter().map(|cell| cell.rotation).fold(0.0, f64::max)
}

/// For each point of the skin the mean rotation and strain of the cells around it.
fn around_skin_nodes(scene: &Scene, deformation: &[CellDeformation]) -> Vec<[f64; 2]> {
    let mut point_of = vec![u32::MAX; scene.mesh.nodes.len()];
    for (point, &node) in (0_u32..).zip(scene.skin.nodes()) {
        point_of[node as usize] = point;
    }
    let mut sums = vec![[0.0; 3]; scene.skin.nodes().len()];
    for ((_, nodes), cell) in scene.mesh.cells.iter().zip(deformation) {
        if nodes.iter().all(|&node| point_of[node as usize] == u32::MAX) {
            continue;
        }
        let strain = cell.principal_strain().iter().map(|s| s.abs()).fold(0.0, f64::max);
        for &node in nodes {
            if let Some(sum) = sums.get_mut(point_of[node as usize] as usize) {
                *sum = [sum[0] + cell.rotation, sum[1] + strain, sum[2] + 1.0];
            }
        }
    }
    sums.iter().map(|[rotation, strain, cells]| [rotation / cells, strain / cells]).collect()
}

/// The holds of nodes that cannot slide.
fn holds_in_place(scene: &Scene) -> impl Iterator<Item = &Constraint> {
    scene.conditions.constraints.iter().filter(|constraint| constraint.count() == 3)
}

/// Evenly chosen free nodes among some points of the skin.
fn measured(scene: &Scene, points: &[u32], around: &[[f64; 2]]) -> Vec<AtNode> {
    let node_of = |point: u32| scene.skin.nodes()[point as usize] as usize;
    let is_free = |point: &u32| scene.conditions.classes[node_of(*point)] == NodeClass::Free;
    let free: Vec<u32> = points.iter().copied().filter(is_free).collect();
    let place = |node: usize| scene.mesh.nodes[node];
    let held: Vec<Vector> =
        holds_in_place(scene).map(|constraint| place(constraint.node as usize)).collect();
    let step = free.len().div_ceil(MEASURED_NODES).max(1);
    let chosen: Vec<u32> = free.into_iter().step_by(step).collect();
    chosen
        .par_iter()
        .map(|&point| {
            let here = place(node_of(point));
            let squared = held.iter().map(|other| (here - other).norm_squared());
            let distance = squared.fold(f64::INFINITY, f64::min).sqrt();
            let [rotation, strain] = around[point as usize];
            let distance = if distance.is_finite() { distance } else { 0.0 };
            AtNode {
                rotation,
                strain,
                turned: distance * TURNED * (1.0 - rotation.cos()),
                stretched: distance * STRETCHED * strain * strain,
            }
        })
        .collect()
}

/// The smallest value that at least 95 % of the nodes do not exceed.
fn p95<T>(nodes: &[T], value: impl Fn(&T) -> f64) -> f64 {
    let mut values: Vec<f64> = nodes.iter().map(value).collect();
    if values.is_empty() {
        return 0.0;
    }
    values.sort_by(f64::total_cmp);
    values[(values.len() * 95).div_ceil(100).max(1) - 1]
}
