//! Muscles in the cells of a mesh: cells, fibre axes, and the tissue of a cell that holds several.
//!
//! A muscle comes as polylines ([`lines`]) or as a closed surface ([`share`]), whose axis is that of its box where it is a strap
//! ([`strap`]). Source: Kim et al. 2012 (Mass tensor), sections 3.1 and 3.2, and Zachow et al. 2006, section 3.5, who take the mean
//! over the nodes of a cell.

pub mod axis;
pub mod equivalent;
pub mod lines;
pub mod share;
pub mod strap;
