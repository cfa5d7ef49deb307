//! Warnings of exponential laws at large stretch, read from the answer (docs/methods.md#hyperelastic-laws).
//!
//! Beyond an exponent of 30 an exponential goes on as a parabola: tissue that reaches it is softer than its law. And where tissue
//! stiffens by orders of magnitude its bulk modulus, which does not, no longer keeps its volume.

use nalgebra::Matrix3;

use super::Scene;
use super::method::Laws;
use crate::material::hyperelastic::{Hyperelastic, Invariants, LARGEST_EXPONENT};
use crate::mesh::{Vector, Warning};
use crate::model::fem::strain::gradient_at_centre;

/// Ratios of volume that tissue is taken to keep.
const KEPT: std::ops::RangeInclusive<f64> = 0.95..=1.05;

/// A cell of an exponential law, less its growth.
struct ExponentialCell {
    cell: usize,
    exponent: f64,
    volume: f64,
}

/// The warnings of an answer.
pub(super) fn warnings(scene: &Scene, displacement: &[Vector]) -> Vec<Warning> {
    match scene.settings.method.properties().laws {
        Laws::AtRest | Laws::SaintVenantKirchhoff => return Vec::new(),
        Laws::Any => {}
    }
    let laws: Vec<Hyperelastic> =
        scene.materials.iter().map(|material| material.hyperelastic()).collect();
    let strained: Vec<ExponentialCell> = scene
        .material_of_cell
        .iter()
        .enumerate()
        .filter_map(|(cell, &material)| {
            let grown = scene.distributed.inner.grown(cell).length;
            let moved = gradient_at_centre(&scene.mesh, displacement, cell);
            let f = (Matrix3::identity() + moved) / grown;
            let direction = scene.fibres.get(cell).copied().unwrap_or_default();
            let exponent = exponent(&laws[usize::from(material)], &f, &direction)?;
            Some(ExponentialCell { cell, exponent, volume: f.determinant() })
        })
        .collect();
    [bounded(&strained), volume_changes(&strained)].into_iter().flatten().collect()
}

/// The largest exponent of a law and its fibres; none where nothing is exponential.
fn exponent(tissue: &Hyperelastic, f: &Matrix3<f64>, direction: &Vector) -> Option<f64> {
    let of_law = tissue.law.exponent(&Invariants::of(f));
    let of_fibres = tissue.fibres.map(|fibres| fibres.exponent((f * direction).norm_squared()));
    [of_law, of_fibres].into_iter().flatten().reduce(f64::max)
}

fn bounded(strained: &[ExponentialCell]) -> Option<Warning> {
    let beyond = || strained.iter().filter(|at| at.exponent > LARGEST_EXPONENT);
    let first = beyond().next()?.cell;
    let cells = beyond().count();
    let largest = beyond().map(|at| at.exponent).fold(0.0, f64::max);
    let detail = format!(
        "{cells} cells, the first of them cell {first}, are stretched beyond an exponent of {LARGEST_EXPONENT} of their law, \
         which goes on as a parabola there: they are softer than the law"
    );
    let warning = Warning::new("exponent-bounded", detail).with("cells", cells as f64);
    Some(warning.with("first_cell", first as f64).with("largest_exponent", largest))
}

fn volume_changes(strained: &[ExponentialCell]) -> Option<Warning> {
    let changed = || strained.iter().map(|at| at.volume).filter(|volume| !KEPT.contains(volume));
    let cells = changed().count();
    let [least, most] = [f64::min, f64::max].map(|pick| changed().reduce(pick));
    let detail = format!(
        "{cells} of {} cells of exponential laws leave 0.95 to 1.05 of their volume: the bulk modulus has to be a hundred times \
         the shear modulus that the law reaches, or tissue escapes its stiffness by swelling",
        strained.len()
    );
    let warning = Warning::new("volume-not-kept", detail).with("cells", cells as f64);
    Some(warning.with("least_volume_ratio", least?).with("most_volume_ratio", most?))
}
