//! A block of hexahedra with noise on its nodes, for tests and comparisons: 200 cells.

use crate::mesh::sample::block;
use crate::mesh::{CellShape, Vector, VolumeMesh};

/// Side of a cell, in mm.
const SIDE: f64 = 3.0;

/// 10 x 10 x 2 hexahedra of 3 mm, each coordinate of each node moved by up to `noise` sides.
pub fn noisy_block(noise: f64, seed: u64) -> VolumeMesh {
    let size = Vector::new(10.0, 10.0, 2.0) * SIDE;
    let mut mesh = block(size, [10, 10, 2], CellShape::Hex8);
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
    for node in &mut mesh.nodes {
        *node += Vector::from_fn(|_, _| (2.0 * uniform(&mut state) - 1.0) * noise * SIDE);
    }
    mesh
}

/// Splitmix64 of Steele, Lea, Flood 2014, from 0 to 1.
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
