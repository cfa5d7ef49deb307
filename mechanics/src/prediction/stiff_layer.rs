//! Stiff layers of a single cell between soft tissue: linear displacement cannot bend them.
//!
//! A cell whose nodes all belong to softer cells too has no node of its own to bend with, and one whose other nodes lie on the boundary
//! of the mesh, as of a skin of one layer, has none inside. Where it is a hundred
//! times as stiff as its neighbours, plain cells and those of mean dilatation leave the skin off by more than a
//! tenth of the movement (docs/stability.md); ten times as stiff they do not, nor do quadratic cells. Fibres that are ten
//! times as stiff along do. The estimated error is too small from less stiff layers on.

use super::Scene;
use crate::mesh::Warning;
use crate::mesh::check::referenced;
use crate::mesh::volume::BoundaryFace;

pub(super) const THIN_STIFF_LAYER: &str = "thin-stiff-layer";

/// How many times as stiff as a neighbour a cell is from which on a single layer is reported.
const STIFFER: f64 = 15.0;
/// The same along its fibres.
const STIFFER_ALONG: f64 = 8.0;

/// The same from which on the error of the mesh is expected to be larger than its estimate: in a slab between walls that was .7 of it for
/// a layer 5 times as stiff, .5 for 9 times, .3 for 20 times (`stiff_layers_between_walls`).
const STIFFER_THAN_ESTIMATED: f64 = 8.0;

/// Fewer of all cells, as one that stands alone, are seen in few places.
const MANY: f64 = 0.01;

/// A warning that counts the cells of such layers.
pub(super) fn thin_stiff_layers(scene: &Scene) -> Option<Warning> {
    layers(scene, STIFFER).warning()
}

/// Whether so many cells are in layers so stiff that the error of the mesh is estimated too small.
pub(super) fn has_stiff_layers(scene: &Scene) -> bool {
    let cells = f64::from(layers(scene, STIFFER_THAN_ESTIMATED).cells());
    cells >= MANY * scene.mesh.cells.len() as f64
}

/// Layers so many times as stiff as the tissue beside them.
fn layers(scene: &Scene, stiffer: f64) -> Layers {
    let mut layers = Layers { stiffer, ..Layers::default() };
    if !scene.is_first_order() || scene.materials.len() < 2 {
        return layers;
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
    let outside = scene.boundary.iter().flat_map(BoundaryFace::nodes);
    let is_outside = referenced(scene.mesh.nodes.len(), outside);
    for ((_, nodes), material) in of_cells() {
        let own = material.young_modulus();
        let softer = |node: &&u32| softest[**node as usize] < own;
        let around = nodes.iter().filter(softer).map(|&node| softest[node as usize]);
        let softest_beside = around.fold(0.0, f64::max);
        let along = material.fibre_modulus().unwrap_or(0.0);
        if softest_beside == 0.0 {
            // Fibres may be stiff in tissue that is no stiffer than the rest.
            layers.add_inside(1.0, along / own);
            continue;
        }
        let (ratio, along) = (own / softest_beside, along / softest_beside);
        match nodes.iter().all(|node| softer(&node)) {
            true => layers.add_inside(ratio, along),
            false => {
                let is_layer = nodes.iter().all(|node| softer(&node) || is_outside[*node as usize]);
                layers.add_outside(ratio, along, is_layer);
            }
        }
    }
    layers
}

/// Cells that are much stiffer than the tissue beside them.
#[derive(Default)]
struct Layers {
    /// So many times as stiff counts.
    stiffer: f64,
    /// With no node of their own.
    inside: u32,
    /// With nodes of their own on the boundary of the mesh alone, of so many with some of their own.
    outside: u32,
    beside_softer: u32,
    largest: f64,
}

impl Layers {
    fn add_inside(&mut self, ratio: f64, along: f64) {
        if self.is_stiff(ratio, along) {
            self.inside += 1;
            self.largest = self.largest.max(ratio).max(along);
        }
    }

    fn add_outside(&mut self, ratio: f64, along: f64, is_layer: bool) {
        if self.is_stiff(ratio, along) {
            self.beside_softer += 1;
            if is_layer {
                self.outside += 1;
                self.largest = self.largest.max(ratio).max(along);
            }
        }
    }

    fn is_stiff(&self, ratio: f64, along: f64) -> bool {
        ratio > self.stiffer || along > STIFFER_ALONG
    }

    /// Of a layer of several cells few are outside with all their own nodes, at its rim.
    fn cells(&self) -> u32 {
        self.inside + if 2 * self.outside > self.beside_softer { self.outside } else { 0 }
    }

    fn warning(&self) -> Option<Warning> {
        let cells = self.cells();
        let detail = format!(
            "{cells} cells are more than {STIFFER} times, or along fibres {STIFFER_ALONG} times, as stiff as all tissue \
             around them and have no node of their own inside the tissue: a layer of one linear cell bends too little, and the \
             estimated error is too small"
        );
        let warning = Warning::new(THIN_STIFF_LAYER, detail).with("cells", f64::from(cells));
        (cells > 0).then(|| warning.with("largest_ratio", self.largest))
    }
}
