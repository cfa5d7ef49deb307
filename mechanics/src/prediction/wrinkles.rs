//! Skin as a membrane that is pressed along itself: a sheet without bending stiffness wrinkles, as finely as its cells allow.
//!
//! A sheet pressed by N (mN/mm) on deep tissue of E* = E / (1 - nu²) is unstable in waves shorter than 4 pi N / E*: a wave of length w stores
//! pi E* / (2 w) a² in the tissue and gives N pi² / w² a² back (Allen, Analysis and Design of Structural Sandwich Panels, 1969, chapter 8,
//! without the bending stiffness that bounds the wave from below). Two edges are the shortest wave of a mesh, and one edge is that of the
//! mesh halved once: where 4 pi N / E* is longer, finer meshes do not approach one answer.

use super::Scene;
use crate::mesh::{Vector, Warning};

/// The share of the sheet from which on it is told.
const SHARE: f64 = 0.02;

pub(super) const MEMBRANE_WRINKLES: &str = "membrane-wrinkles";

/// A warning of the part of the sheet that is so pressed after a displacement of the nodes.
pub(super) fn wrinkles(scene: &Scene, displacement: &[Vector]) -> Option<Warning> {
    let membrane = scene.membrane.as_ref()?;
    // Of the softest cell at each node, in kPa.
    let mut modulus = vec![f64::INFINITY; scene.mesh.nodes.len()];
    for ((_, nodes), &material) in scene.mesh.cells.iter().zip(&scene.material_of_cell) {
        let material = &scene.materials[usize::from(material)];
        let (mu, nu) = (material.shear_modulus(), material.poisson_ratio());
        for &node in nodes {
            let at = &mut modulus[node as usize];
            *at = at.min(2.0 * mu / (1.0 - nu));
        }
    }
    let (mut all, mut pressed, mut most) = (0.0, 0.0, (0.0, 0.0, Vector::zeros()));
    for own in membrane.pressed(&scene.mesh, displacement) {
        let below = own.nodes.map(|node| modulus[node as usize]).into_iter().fold(0.0, f64::max);
        let wave = 4.0 * std::f64::consts::PI * own.force / below;
        all += own.area;
        if wave > own.edge {
            pressed += own.area;
            if wave > most.0 {
                most = (wave, own.force, own.centre);
            }
        }
    }
    if pressed <= SHARE * all {
        return None;
    }
    let (wave, force, at) = most;
    let detail = format!(
        "{pressed:.0} mm² of the skin, which is a membrane without bending stiffness, are pressed along themselves, by up to {force:.2} mN/mm \
         near ({:.1}, {:.1}, {:.1}) mm: on this tissue it wrinkles in waves of up to {wave:.1} mm, as finely as cells allow, so that finer \
         meshes find other wrinkles and the error of the mesh is not known there; a pretension of the membrane, or a thicker layer of cells \
         instead of it, resists that, and with `fem_nonlinear` a membrane of `compression` `none` has a limit",
        at.x, at.y, at.z
    );
    let warning = Warning::new(MEMBRANE_WRINKLES, detail).with("area_mm2", pressed);
    let warning = warning.with("force_mn_per_mm", force).with("wave_mm", wave);
    Some(warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z))
}
