//! The same bits on any number of threads.

use mechanics::mesh::Vector;
use mechanics::meshing::{MeshingSettings, SizeField, ThicknessRule};

use super::domains::{Body, balls};
use super::meshed;

fn on_threads(threads: usize) -> impl PartialEq + std::fmt::Debug {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let touching = [[-10.0, 3.0, 0.0], [11.0, 0.0, 2.0], [0.0, 13.0, -9.0], [2.0, -14.0, 5.0]];
    let pair = balls(touching.map(|at| (Vector::from(at), 10.5)).to_vec());
    let body = Body { thickness: Some(Box::new(|x: &Vector| 3.0 + x.norm() / 4.0)), ..pair };
    let thickness = Some(ThicknessRule { factor: 0.8, floor: 1.0 });
    let size = SizeField { coarsest: 6.0, thickness, ..SizeField::uniform(1.2) };
    let settings = MeshingSettings { size, ..MeshingSettings::default() };
    let tissue = pool.install(|| meshed(&body, &settings));
    let bits = |at: &Vector| [at.x, at.y, at.z].map(f64::to_bits);
    let nodes: Vec<[u64; 3]> = tissue.volume.nodes.iter().map(bits).collect();
    (nodes, tissue.volume.cells, tissue.boundaries, format!("{:?}", tissue.report))
}

#[test]
fn a_mesh_has_the_same_bits_on_one_and_two_and_three_threads() {
    let one = on_threads(1);
    for threads in [2, 3] {
        assert!(on_threads(threads) == one, "{threads} threads");
    }
}
