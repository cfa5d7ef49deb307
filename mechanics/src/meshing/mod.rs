//! Tetrahedral meshes by isosurface stuffing on a graded body-centred cubic lattice.
//!
//! [`mesh`] is the path: an octree that is as fine as the [size field](SizeField) asks for (`octree`, `refine`), the lattice
//! of its leaves (`lattice`), the places where that is cut by the boundary (`cuts`), nodes moved onto it (`warp`), places
//! where tissue touches itself taken apart (`pinches`, `edge_copies`), the cells (`stencils`), nodes moved to where the worst
//! of them are better (`climb`), cells told their region (`regions`), and the surface moved to where it encloses the volume of the body (`fitting`). What comes
//! out is held against what is promised of it (`check`): cells of positive volume, a boundary whose edges lie between two
//! triangles each, one piece.
//!
//! Source: Labelle, Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good dihedral angles, ACM Transactions on
//! Graphics 26 (2007).

mod apart;
mod boundary_set;
mod check;
mod climb;
mod creases;
mod cuts;
mod draft;
mod edge_copies;
mod error;
mod fitting;
mod gaps;
mod grid;
mod lattice;
#[cfg(test)]
mod lattice_tests;
mod lost;
mod missed;
mod node_table;
mod octree;
mod pieces;
mod pinches;
mod prism;
mod refine;
mod regions;
mod report;
mod rims;
mod settings;
mod shape;
mod size;
mod star;
mod stencils;
mod target;
mod tissue;
mod touching_voids;
mod warp;
mod watch;

pub use boundary_set::BoundarySet;
pub use error::MeshingError;
pub use gaps::Gap;
pub use lost::LostPiece;
pub use pieces::Piece;
pub use report::{Angles, MeshingReport};
pub use settings::MeshingSettings;
pub use size::{RegionShape, SizeField, SizeRegion, ThicknessRule};
pub use tissue::{REGIONS, TissueMesh, mesh};
