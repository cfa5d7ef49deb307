//! Reasons why there is no mesh.

use crate::mesh::{Vector, place};

/// Why a body was not meshed. Lengths in mm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshingError {
    #[error("the setting `{setting}` is {value}, but must be {wanted}")]
    Setting { setting: &'static str, value: f64, wanted: &'static str },
    #[error(
        "the box that is to hold the tissue reaches from {} to {}, which is no box",
        place(low, 2),
        place(high, 2)
    )]
    Bounds { low: Vector, high: Vector },
    #[error(
        "no tissue was found between {} and {} with cells of {size:.2} mm",
        place(low, 2),
        place(high, 2)
    )]
    Empty { low: Vector, high: Vector, size: f64 },
    #[error(
        "the tissue is in {pieces} pieces with {all:.1} ml together, of which the largest has {kept:.1} ml: it holds together nowhere"
    )]
    Scattered { pieces: usize, all: f64, kept: f64 },
    #[error(
        "{made} tetrahedra came of the {target} that were asked for: nearly all tissue is thinner than its cells of {finest:.2} mm"
    )]
    TooFew { made: usize, target: usize, finest: f64 },
    #[error(
        "about {estimated} tetrahedra or more would be needed, and at most {allowed} are allowed; \
         the finest cells are {finest} mm"
    )]
    TooMany { estimated: u64, allowed: u64, finest: f64 },
    #[error(
        "the lattice would have {cells} cells of {finest} mm along an axis, and at most {allowed} can be numbered"
    )]
    TooFine { cells: f64, allowed: u32, finest: f64 },
    #[error("the body has no finite {what} at {}", place(at, 2))]
    NotFinite { what: &'static str, at: Vector },
    #[error("the mesh would be wrong: {count} {what}, the first at {}", place(at, 2))]
    Broken { what: &'static str, count: usize, at: Vector },
    #[error("cancelled")]
    Cancelled,
}
