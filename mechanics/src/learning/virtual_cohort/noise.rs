//! Errors of measuring a virtual face: where its template is mapped to, and how scans are registered.
//!
//! A mapped node is not where the same point of the tissue is, by a smooth field of Gaussian bells of 20 mm. Pre- and
//! postoperative faces are mapped separately, so that the errors of both are in every measured displacement: no prediction can
//! be nearer than that.

use crate::draws::Draws;
use crate::mesh::{Vector, VolumeMesh};
use crate::plan::RigidMovement;

/// The mean length of a mapping error at the skin in mm where none is stated.
pub const USUAL_MAPPING: f64 = 0.2;

/// Standard deviations of a registration by components, in mm and degrees.
const SHIFT: f64 = 0.1;
const TURN: f64 = 0.1;

const BELLS: usize = 40;
const WIDTH: f64 = 20.0;

/// A face as it is known: mapped before, and measured after what happened.
pub struct Scanned {
    /// Of each node in mm: what happened, and what is measured of it.
    pub happened: Vec<Vector>,
    pub measured: Vec<Vector>,
    pub mapped: VolumeMesh,
}

impl Scanned {
    /// A face whose `skin` is a node set, mapped to so many mm in the mean, under what happens to it: displacements of its nodes
    /// in mm.
    pub fn of<E>(
        face: &VolumeMesh,
        mapped_to: f64,
        draws: &mut Draws,
        happens: impl FnOnce(&mut Draws) -> Result<Vec<Vector>, E>,
    ) -> Result<Self, E> {
        let skin = face.node_set("skin").unwrap_or_default();
        let before = mapping(&face.nodes, skin, mapped_to, draws);
        let after = mapping(&face.nodes, skin, mapped_to, draws);
        let happened = happens(draws)?;
        let missed = registration(draws);
        let measured = measured(&face.nodes, &happened, [&before, &after], &missed);
        let mut mapped = face.clone();
        mapped.nodes.iter_mut().zip(&before).for_each(|(node, error)| *node += error);
        Ok(Scanned { happened, measured, mapped })
    }
}

/// A mapping error at each of some points, of this mean length at `skin`.
fn mapping(points: &[Vector], skin: &[u32], mean: f64, draws: &mut Draws) -> Vec<Vector> {
    let bells: Vec<(Vector, Vector)> = (0..BELLS)
        .map(|_| {
            let middle = points[skin[draws.below(skin.len())] as usize];
            (middle, Vector::from_fn(|_, _| draws.normal()))
        })
        .collect();
    let at = |point: &Vector| -> Vector {
        let bell =
            |middle: &Vector| (-(point - middle).norm_squared() / (2.0 * WIDTH * WIDTH)).exp();
        bells.iter().map(|(middle, amplitude)| amplitude * bell(middle)).sum()
    };
    let field: Vec<Vector> = points.iter().map(at).collect();
    let length = skin.iter().map(|&node| field[node as usize].norm()).sum::<f64>();
    let factor = mean * skin.len() as f64 / length;
    field.into_iter().map(|own| own * factor).collect()
}

/// By what a registration misses, about the middle of the head.
fn registration(draws: &mut Draws) -> RigidMovement {
    let angles = Vector::from_fn(|_, _| (TURN * draws.normal()).to_radians());
    let shift = Vector::from_fn(|_, _| SHIFT * draws.normal());
    RigidMovement::about_pivot(angles, Vector::zeros(), shift)
}

/// What is measured of a displacement at some points: with the errors of both mappings, and of the registration where they go to.
fn measured(
    points: &[Vector],
    happened: &[Vector],
    [before, after]: [&[Vector]; 2],
    missed: &RigidMovement,
) -> Vec<Vector> {
    let of = |node: usize| {
        let place = points[node] + happened[node];
        happened[node] + missed.displacement(&place) + after[node] - before[node]
    };
    (0..points.len()).map(of).collect()
}
