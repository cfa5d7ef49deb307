//! Stiff layers of a single cell, where the estimate of the discretisation error is too small.

use std::collections::BTreeMap;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{CaseSegment, RegionNames, Settings, Sliding, SlidingNormal};

use super::adequate::{adequate, true_error, within};
use crate::scenes::{case_of, material, set};
use crate::support::responses::plan_of;

/// A slab of hexahedra whose middle layer of one cell is stiff, between side walls, on bone that moves askew by 6 mm.
#[test]
fn stiff_layers_between_walls_are_expected_to_be_off_by_more_than_is_estimated() {
    for stiffer in [2.0, 5.0, 9.0, 11.0, 20.0, 100.0] {
        let mut mesh = block(Vector::new(75.0, 57.0, 13.0), [5, 6, 3], CellShape::Hex8);
        let in_middle = |cell: usize| {
            let height = mesh.corners(cell).map(|x| x.z).sum::<f64>() / 8.0;
            i64::from((height - 6.5).abs() < 2.0)
        };
        let labels = (0..mesh.cells.len()).map(in_middle).collect();
        mesh.cell_labels.insert("layer".to_owned(), labels);
        let mut case = case_of(mesh, material(15.0, 0.45));
        let names = BTreeMap::from([(1, "stiff".to_owned())]);
        case.regions = Some(RegionNames { array: "layer".to_owned(), names });
        case.materials.insert("stiff".to_owned(), material(15.0 * stiffer, 0.45));
        case.skin = Some(set("z_max"));
        case.segments = vec![CaseSegment { name: "bone".to_owned(), nodes: set("z_min") }];
        case.allow_unfixed = true;
        for side in ["x_min", "x_max", "y_min", "y_max"] {
            let nodes = set(side);
            case.sliding.push(Sliding { nodes, normal: SlidingNormal::Surface, segment: None });
        }
        let movement =
            RigidMovement::new(nalgebra::Matrix3::identity(), Vector::new(3.5, 2.5, 4.2)).unwrap();
        let plan = plan_of(&case, &[movement]);
        let found = adequate(&case, &plan, &Settings::default(), within(0.1));
        let error = true_error(&case, &plan, &found.prediction.displacement);
        let told = found.errors.mesh.map(|mesh| mesh.skin_mm).unwrap_or_default();
        println!("{stiffer}: {:?} met {} mesh {told:.4} true {error:.4}", found.rung, found.is_met);
        assert!(!found.is_met || error <= 0.1, "{stiffer}: {error}");
    }
}
