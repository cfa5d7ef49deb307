//! The column under its own weight, one hexahedron wide: the edge functions hold all that the mesh lacks.

use nalgebra::{DMatrix, DVector};

use super::edge_equations::EdgeEquations;
use super::edges::Edges;
use super::held_edges::HeldEdges;
use super::points::EnrichedCell;
use super::{DistributedLoads, EdgeEquation, MAX_EDGES};
use crate::boundary::Constraint;
use crate::element::MAX_NODES;
use crate::material::LinearElastic;
use crate::mesh::sample::block;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::dofs::{nodes_of_cells, number};
use crate::model::fem::assembly::Tissue;
use crate::model::fem::cell_stiffness::Dilatation;

const LENGTH: f64 = 100.0;
const WEIGHT: f64 = 1.04 * 9.81e-3;
const E: f64 = 15.0;

/// u = rho g (L z - z²/2) / E along z, which hexahedra have exactly at their nodes; downwards is +z.
fn exact(x: &Vector) -> Vector {
    Vector::z() * (WEIGHT * (LENGTH * x.z - 0.5 * x.z * x.z) / E)
}

fn cell(mesh: &VolumeMesh, material: &LinearElastic, cell: usize) -> EnrichedCell {
    let tensor = material.tensor(&Vector::zeros());
    EnrichedCell::new(mesh, cell, &tensor, Dilatation::Pointwise).unwrap()
}

#[test]
fn edge_functions_that_are_solved_exactly_have_the_energy_of_the_error() {
    for (cells, energy) in [(10, 0.578_272), (20, 0.144_568)] {
        let mesh = block(Vector::new(10.0, 10.0, LENGTH), [1, 1, cells], CellShape::Hex8);
        let material = [LinearElastic::new(E, 0.0, 1.04).unwrap()];
        let material_of_cell = vec![0; mesh.cells.len()];
        let tissue =
            Tissue::isotropic(&mesh, &material, &material_of_cell, |_| Dilatation::Pointwise);
        let bottom = mesh.node_sets["z_min"].iter();
        let constraints: Vec<Constraint> =
            bottom.map(|&node| Constraint::at(node, Vector::zeros())).collect();
        let dof_map = number(&nodes_of_cells(&mesh), &mesh.nodes, &constraints);
        let edges = Edges::new(&mesh, &dof_map);

        // The residual and the whole matrix of the edge functions.
        let mut equations = EdgeEquations::zeros(edges.count());
        let mut whole = DMatrix::<f64>::zeros(3 * edges.count(), 3 * edges.count());
        for number in 0..mesh.cells.len() {
            let own = cell(&mesh, &material[0], number);
            let mut moved = [Vector::zeros(); MAX_NODES];
            moved.iter_mut().zip(mesh.corners(number)).for_each(|(u, x)| *u = exact(&x));
            let of_cell: [EdgeEquation; MAX_EDGES] =
                own.equations(&moved, &own.modes(&moved), &None);
            let numbers = edges.of_cell(number);
            for (a, edge) in numbers.numbers().enumerate() {
                equations.add(edge, &of_cell[a]);
                for (b, other) in numbers.numbers().enumerate() {
                    let mut block = whole.fixed_view_mut::<3, 3>(3 * edge, 3 * other);
                    block += own.stiffness(a, b);
                }
            }
        }
        let acceleration = Vector::z() * 9.81e-3;
        let loads = DistributedLoads { acceleration, ..DistributedLoads::default() };
        loads.add_to(&tissue, &edges, &|_| false, &mut equations.residual).unwrap();
        let faces = mesh.boundary_faces();
        let held = HeldEdges::new(&mesh, &faces, &constraints, &edges);
        let steps = equations.steps(&held);

        // Held edges, and pairs of nodes that no edge joins, stay out.
        let is_free =
            |k: &usize| steps[k / 3] != Vector::zeros() || is_solved(&whole, &held, k / 3);
        let free: Vec<usize> = (0..3 * edges.count()).filter(is_free).collect();
        let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| whole[(free[i], free[j])]);
        let right =
            DVector::from_fn(free.len(), |i, _| equations.residual[free[i] / 3][free[i] % 3]);
        let solved = matrix.cholesky().unwrap().solve(&right);
        let effectivity = solved.dot(&right) / energy;
        assert!((effectivity - 1.0).abs() < 0.01, "{cells} cells: {effectivity}");
        println!("{cells} cells: one step {:.3}", equations.work(&steps) / energy);
    }
}

/// Whether an edge has a stiffness and is not held.
fn is_solved(whole: &DMatrix<f64>, held: &HeldEdges, edge: usize) -> bool {
    let block = whole.fixed_view::<3, 3>(3 * edge, 3 * edge).into_owned();
    held.step(edge, &Vector::repeat(1.0), &block) != Vector::zeros()
}
