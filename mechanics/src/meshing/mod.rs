//! Tetrahedral meshes by isosurface stuffing on a graded body-centred cubic lattice.
//!
//! Source: Labelle, Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good dihedral angles, ACM Transactions on
//! Graphics 26 (2007).
