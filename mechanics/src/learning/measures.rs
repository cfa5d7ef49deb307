//! Features of a prediction: what mechanics says of a case, as numbers that correspond between cases.
//!
//! Three blocks: the deviatoric Cauchy stress at each skin node over the shear modulus of the whole face, its mean by volume (no
//! unit, six numbers, the mean over the cells of the node by volume); the displacement of each skin node in mm; and twelve numbers
//! for each segment in mm: where its centre goes, and (R - I) by rows, times the radius of the segment about it, so that turning
//! counts by what it moves. At small strain dev sigma = 2 mu dev eps with the shear modulus mu of the cell; what fibres,
//! muscle pull and growth add is left out.
//! Source of the first block: Zhang et al. 2016, section 2.4, whose theta scales it as a whole.

use nalgebra::{Matrix3, Vector6};

use super::features::Features;
use crate::boundary::NodeClass;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::strain::gradient_at_centre;
use crate::model::reference_cell;
use crate::plan::RigidMovement;
use crate::prediction::Scene;

/// The blocks of a case whose nodes move so, in mm.
pub fn features(scene: &Scene, displacement: &[Vector]) -> Features {
    let stress = nodal_stress(scene, displacement);
    let at_skin = scene.skin.nodes().iter().map(|&node| stress[node as usize]);
    let stress = at_skin.flat_map(|own| own.iter().copied().collect::<Vec<_>>()).collect();
    Features { blocks: vec![stress, skin(scene, displacement), plan_numbers(scene)] }
}

/// The displacement of the skin, three numbers for each of its points.
pub fn skin(scene: &Scene, displacement: &[Vector]) -> Vec<f64> {
    let moved = scene.skin.nodes().iter().map(|&node| displacement[node as usize]);
    moved.flat_map(|own| [own.x, own.y, own.z]).collect()
}

/// The displacement of the nodes that segments carry, three numbers for each.
pub fn bone(scene: &Scene, displacement: &[Vector]) -> Vec<f64> {
    let joined = carried(scene, None).map(|node| displacement[node]);
    joined.flat_map(|own| [own.x, own.y, own.z]).collect()
}

/// The nodes that a segment carries, ascending.
pub fn carried_by(scene: &Scene, segment: usize) -> Vec<u32> {
    carried(scene, Some(segment)).map(|node| node as u32).collect()
}

/// dev sigma of each node over the mean shear modulus: xx, yy, zz, xy, yz, xz.
fn nodal_stress(scene: &Scene, displacement: &[Vector]) -> Vec<Vector6<f64>> {
    let mesh = &*scene.mesh;
    let volumes: Vec<f64> = (0..mesh.cells.len()).map(|cell| volume(mesh, cell)).collect();
    let shear =
        |cell: usize| scene.materials[scene.material_of_cell[cell] as usize].shear_modulus();
    let whole: f64 = volumes.iter().sum();
    let mean = volumes.iter().enumerate().map(|(cell, own)| own * shear(cell)).sum::<f64>() / whole;
    let mut sums = vec![(Vector6::zeros(), 0.0); mesh.nodes.len()];
    for (cell, &volume) in volumes.iter().enumerate() {
        let stress = deviator(&gradient_at_centre(mesh, displacement, cell));
        let stress = stress * (2.0 * shear(cell) / mean);
        for &node in mesh.cells.nodes(cell) {
            let (sum, weight) = &mut sums[node as usize];
            *sum += stress * volume;
            *weight += volume;
        }
    }
    sums.into_iter().map(|(sum, weight)| sum / weight.max(f64::MIN_POSITIVE)).collect()
}

/// dev eps of a displacement gradient.
fn deviator(gradient: &Matrix3<f64>) -> Vector6<f64> {
    let strain = (gradient + gradient.transpose()) * 0.5;
    let mean = strain.trace() / 3.0;
    let [x, y, z] = [0, 1, 2].map(|axis| strain[(axis, axis)] - mean);
    Vector6::new(x, y, z, strain[(0, 1)], strain[(1, 2)], strain[(0, 2)])
}

/// In mm³; nothing of a cell that is inverted.
fn volume(mesh: &VolumeMesh, cell: usize) -> f64 {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let points = reference_cell(mesh.cells.shape(cell)).points.iter();
    points.filter_map(|point| Some(point.at(&corners)?.volume)).sum()
}

fn plan_numbers(scene: &Scene) -> Vec<f64> {
    let segments = scene.segments.iter().enumerate();
    let of = |(number, segment): (usize, &crate::plan::PlannedSegment)| {
        let nodes: Vec<Vector> =
            carried(scene, Some(number)).map(|node| scene.mesh.nodes[node]).collect();
        movement_numbers(&segment.movement, &nodes)
    };
    segments.flat_map(of).collect()
}

/// Where the middle of some points goes, and by how much points at their radius turn, in mm.
fn movement_numbers(movement: &RigidMovement, points: &[Vector]) -> [f64; 12] {
    let count = points.len().max(1) as f64;
    let middle = points.iter().sum::<Vector>() / count;
    let squares = points.iter().map(|point| (point - middle).norm_squared()).sum::<f64>();
    let turned = (movement.rotation() - Matrix3::identity()) * (squares / count).sqrt();
    let moved = movement.displacement(&middle);
    std::array::from_fn(|place| match place {
        0..3 => moved[place],
        later => turned[((later - 3) / 3, (later - 3) % 3)],
    })
}

/// The nodes that a segment carries, or any of them.
fn carried(scene: &Scene, segment: Option<usize>) -> impl Iterator<Item = usize> + '_ {
    let classes = scene.conditions.classes.iter().enumerate();
    classes.filter_map(move |(node, class)| match *class {
        NodeClass::Joined(own) => {
            segment.is_none_or(|wanted| wanted == own as usize).then_some(node)
        }
        NodeClass::Free | NodeClass::Fixed | NodeClass::Sliding | NodeClass::Prescribed => None,
    })
}
