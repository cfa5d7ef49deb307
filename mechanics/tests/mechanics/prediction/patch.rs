//! docs/verification.md#v1, docs/verification.md#v2: affine fields and rigid movements.

use mechanics::boundary::Constraint;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::dofs::DofMap;
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::{Dilatation, cell_stiffness};
use mechanics::prediction::{ElementChoice, Settings};
use mechanics::progress::Unobserved;
use mechanics::solver::HalfMatrix;
use nalgebra::DMatrix;

use crate::scenes::{SHAPES, case_of, exact, largest_error, material, on_the_boundary, solve};

/// A 3 x 3 x 3 block whose inner nodes are moved by up to 20 % of a cell, the same at every run.
fn distorted_block(shape: CellShape) -> VolumeMesh {
    let mut mesh = block(Vector::new(3.0, 3.0, 3.0), [3, 3, 3], shape);
    let mut seed = 12345_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 33) as f64 / (1_u64 << 31) as f64 * 0.4 - 0.2
    };
    for node in &mut mesh.nodes {
        if node.iter().all(|&x| x > 0.1 && x < 2.9) {
            *node += Vector::new(random(), random(), random());
        }
    }
    mesh
}

fn affine(x: &Vector) -> Vector {
    Vector::new(x.x + 2.0 * x.y - x.z, 3.0 * x.x - x.y + 2.0 * x.z, -x.x + x.y + 2.0 * x.z) * 1e-3
}

#[test]
fn an_affine_boundary_gives_the_affine_field_inside() {
    for shape in SHAPES {
        let quadratic = (shape == CellShape::Tet4).then_some(ElementChoice::Quadratic);
        for element in [ElementChoice::Auto, ElementChoice::Plain].into_iter().chain(quadratic) {
            for nu in [0.0, 0.3, 0.46, 0.49, 0.4999] {
                let mut mesh = distorted_block(shape);
                let plan = on_the_boundary(&mut mesh, affine);
                let case = case_of(mesh, material(15.0, nu));
                let settings = Settings { element, ..exact() };
                let prediction = solve(&case, &plan, &settings);
                let largest = prediction.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
                let error = largest_error(&case.volume, &prediction.displacement, affine);
                // The condition number grows as 1 / (1 - 2 nu), and rounding with it.
                let tolerance = if nu > 0.499 { 1e-11 } else { 1e-12 };
                assert!(error < tolerance * largest, "{shape:?} {element:?} nu {nu}: {error:.2e}");
            }
        }
    }
}

#[test]
fn an_affine_field_has_the_same_principal_strains_in_every_cell() {
    for shape in SHAPES {
        let mut mesh = distorted_block(shape);
        let plan = on_the_boundary(&mut mesh, affine);
        let prediction = solve(&case_of(mesh, material(15.0, 0.3)), &plan, &exact());
        let first = prediction.deformation[0];
        for cell in &prediction.deformation {
            for (a, b) in cell.principal_strain().iter().zip(first.principal_strain()) {
                assert!((a - b).abs() < 1e-10 * first.principal_strain()[0], "{shape:?}");
            }
            assert!((cell.det_f - first.det_f).abs() < 1e-12, "{shape:?}");
        }
    }
}

/// A matrix whose rows are not in the order of the nodes.
struct Assembled {
    matrix: HalfMatrix<f64, 3>,
    dof_map: DofMap,
}

impl Assembled {
    fn new(mesh: &VolumeMesh, dilatation: fn(CellShape) -> Dilatation) -> Self {
        let materials = [material(15.0, 0.49)];
        let material_of_cell = vec![0; mesh.cells.len()];
        let tissue = Tissue::isotropic(mesh, &materials, &material_of_cell, dilatation);
        let dof_map = DofMap::new(mesh, &vec![false; mesh.nodes.len()]);
        let matrix = tissue.assemble(&dof_map, &Unobserved).unwrap().unwrap();
        Assembled { matrix, dof_map }
    }

    fn dense(&self) -> DMatrix<f64> {
        let rows = self.matrix.rows();
        let mut dense = DMatrix::zeros(3 * rows, 3 * rows);
        for row in 0..rows {
            let mut put = |column: usize, block: &[[f64; 3]; 3]| {
                for i in 0..3 {
                    for j in 0..3 {
                        dense[(3 * row + i, 3 * column + j)] = block[i][j];
                        dense[(3 * column + j, 3 * row + i)] = block[i][j];
                    }
                }
            };
            put(row, &self.matrix.diagonal[row]);
            self.matrix.lower_row(row).for_each(|(column, block)| put(column, block));
        }
        dense
    }
}

#[test]
fn a_small_rigid_movement_stores_no_energy() {
    let (axis, shift) =
        (Vector::new(1.0, 2.0, 3.0).normalize() * 1e-3, Vector::new(0.1, -0.2, 0.3));
    for shape in SHAPES {
        let mesh = distorted_block(shape);
        let assembled = Assembled::new(&mesh, |_| Dilatation::Mean);
        let mut rigid = vec![[[0.0]; 3]; mesh.nodes.len()];
        for (x, &row) in mesh.nodes.iter().zip(&assembled.dof_map.ordering.place) {
            rigid[row as usize] = <[f64; 3]>::from(axis.cross(x) + shift).map(|value| [value]);
        }
        let mut forces = vec![[[0.0]; 3]; rigid.len()];
        assembled.matrix.multiply(&assembled.dof_map.ordering, &rigid, &mut forces);
        let (rigid, forces) = (rigid.as_flattened(), forces.as_flattened());
        let energy: f64 = rigid.iter().zip(forces).map(|([u], [f])| u * f).sum::<f64>() / 2.0;
        // The shift is 0.3 mm: rounding leaves about 1e-16 of E V |u|^2 / h^2 there.
        assert!(energy.abs() < 1e-15 * 15.0 * 27.0, "{shape:?}: {energy:.2e}");
    }
}

#[test]
fn the_stiffness_matrix_has_exactly_six_rigid_modes() {
    for shape in SHAPES {
        for dilatation in
            [|_| Dilatation::Mean, |_| Dilatation::Pointwise] as [fn(CellShape) -> Dilatation; 2]
        {
            let matrix = Assembled::new(&distorted_block(shape), dilatation).dense();
            let mut eigenvalues: Vec<f64> =
                matrix.symmetric_eigenvalues().iter().copied().collect();
            eigenvalues.sort_by(f64::total_cmp);
            let largest = eigenvalues[eigenvalues.len() - 1];
            assert!(
                eigenvalues[5] < 1e-12 * largest,
                "{shape:?}: {:.2e}",
                eigenvalues[5] / largest
            );
            assert!(eigenvalues[6] > 1e-8 * largest, "{shape:?}: {:.2e}", eigenvalues[6] / largest);
        }
    }
}

#[test]
fn the_assembled_matrix_is_the_sum_of_its_cells() {
    for shape in SHAPES {
        let mesh = distorted_block(shape);
        let assembled = Assembled::new(&mesh, |_| Dilatation::Mean);
        let mut sum = DMatrix::zeros(3 * mesh.nodes.len(), 3 * mesh.nodes.len());
        for (cell, (_, nodes)) in mesh.cells.iter().enumerate() {
            let corners: Vec<Vector> = mesh.corners(cell).collect();
            let tensor = material(15.0, 0.49).tensor(&Vector::zeros());
            let blocks = cell_stiffness(shape, &corners, &tensor, Dilatation::Mean).unwrap();
            for (k, block) in blocks.iter().enumerate() {
                let row = assembled.dof_map.row(nodes[k / nodes.len()]);
                let column = assembled.dof_map.row(nodes[k % nodes.len()]);
                for i in 0..3 {
                    for j in 0..3 {
                        sum[(3 * row + i, 3 * column + j)] += block[i][j];
                    }
                }
            }
        }
        let difference = (assembled.dense() - &sum).amax();
        assert!(difference < 1e-12 * sum.amax(), "{shape:?}: {difference:.2e}");
    }
}

#[test]
fn a_node_held_nowhere_has_no_hold() {
    let mut mesh = distorted_block(CellShape::Hex8);
    let plan = on_the_boundary(&mut mesh, affine);
    let case = case_of(mesh, material(15.0, 0.3));
    let scene = mechanics::prediction::Scene::new(&case, &plan, &exact()).unwrap();
    let held: Vec<u32> = scene
        .conditions
        .constraints
        .iter()
        .map(|constraint: &Constraint| constraint.node)
        .collect();
    assert_eq!(held, case.volume.node_sets["boundary"]);
}
