//! Stiff layers of a single cell between soft tissue: linear displacement cannot bend them.
//!
//! A cell whose nodes all belong to softer cells too has no node of its own to bend with. Where it is a hundred
//! times as stiff as its neighbours, plain cells and those of mean dilatation leave the skin off by more than a
//! tenth of the movement (docs/stability.md); ten times as stiff they do not, nor do quadratic cells. Fibres that are ten
//! times as stiff along do.

use super::Scene;
use crate::mesh::Warning;

/// How many times as stiff as a neighbour a cell is from which on a single layer is reported.
const STIFFER: f64 = 30.0;
/// The same along its fibres.
const STIFFER_ALONG: f64 = 8.0;

/// A warning that counts the cells of such layers.
pub(super) fn thin_stiff_layers(scene: &Scene) -> Option<Warning> {
    if !scene.is_first_order() || scene.materials.len() < 2 {
        return None;
    }
    let mut softest = vec![f64::INFINITY; scene.mesh.nodes.len()];
    let of_cells = || {
        let material = |&material: &u16| &scene.materials[material as usize];
        scene.mesh.cells.iter().zip(scene.material_of_cell.iter().map(material))
    };
    for ((_, nodes), material) in of_cells() {
        for &node in nodes {
            let at = &mut softest[node as usize];
            *at = at.min(material.young_modulus());
        }
    }
    let (mut cells, mut largest) = (0, 0.0_f64);
    for ((_, nodes), material) in of_cells() {
        let softest = nodes.iter().map(|&node| softest[node as usize]).fold(0.0, f64::max);
        let ratio = material.young_modulus() / softest;
        let along = material.fibre_modulus().map_or(0.0, |modulus| modulus / softest);
        if ratio > STIFFER || along > STIFFER_ALONG {
            (cells, largest) = (cells + 1, largest.max(ratio).max(along));
        }
    }
    let detail = format!(
        "{cells} cells are more than {STIFFER} times, or along fibres {STIFFER_ALONG} times, as stiff as all tissue \
         around them and have no node of their own: a layer of one linear cell bends too little"
    );
    let warning = Warning::new("thin-stiff-layer", detail).with("cells", f64::from(cells));
    (cells > 0).then(|| warning.with("largest_ratio", largest))
}
