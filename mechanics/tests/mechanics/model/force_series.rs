//! Taylor series of internal forces: against Newton's forces, under rotation, and of every element.

use mechanics::boundary::Constraint;
use mechanics::material::hyperelastic::{Law, NeoHookean};
use mechanics::material::{Fibre, FibreLaw, LinearElastic, PlaneStress, Sheet};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::Dilatation;
use mechanics::model::fem::displacement::Problem;
use mechanics::model::fem::finite_strain::{Advance, Elements, FibreField, FiniteStrain};
use mechanics::model::fem::force_series::{ForceSeries, Forces, LinearState};
use mechanics::model::fem::inner_stress::InnerStress;
use mechanics::model::fem::membrane::Membrane;
use mechanics::model::problem::LoadCase;
use mechanics::progress::Unobserved;
use mechanics::solver::Tolerance;
use nalgebra::{Matrix3, Rotation3};

use crate::scenes::{SHAPES, material};

const TOLERANCE: Tolerance = Tolerance { relative_residual: 1e-12, memory_mb: 1000.0 };

/// A block with its inner nodes out of line.
fn irregular(shape: CellShape) -> VolumeMesh {
    let mut mesh = block(Vector::new(9.0, 8.0, 7.0), [3, 2, 2], shape);
    for x in &mut mesh.nodes {
        *x += Vector::new((x.y * 2.0).sin(), (x.z + x.x).cos(), (x.x * 3.0).sin()) * 0.2;
    }
    mesh
}

fn mean_of_bricks(shape: CellShape) -> Dilatation {
    match shape {
        CellShape::Tet4 => Dilatation::Pointwise,
        CellShape::Hex8 | CellShape::Wedge6 => Dilatation::Mean,
    }
}

fn series(tissue: Tissue<'_>) -> ForceSeries<'_> {
    ForceSeries::new(tissue, None)
}

fn moved(displacement: &[Vector]) -> LinearState<'_> {
    LinearState { displacement, pressures: &[] }
}

fn largest(forces: &[Vector]) -> f64 {
    forces.iter().map(Vector::norm).fold(0.0, f64::max)
}

/// K0 u, as reactions of nodes that are all held.
fn linear_forces(tissue: Tissue, displacement: &[Vector]) -> Vec<Vector> {
    let constraints: Vec<Constraint> =
        (0..).zip(displacement).map(|(node, &u)| Constraint::at(node, u)).collect();
    let forces = vec![Vector::zeros(); displacement.len()];
    let problem =
        Problem { tissue, constraints: &constraints, forces: &forces, tolerance: TOLERANCE };
    problem.solve(&Unobserved).unwrap().reactions
}

/// f(u) of neo-Hookean tetrahedra, as reactions of nodes that are all held.
fn newton_forces(mesh: &VolumeMesh, law: &Law, displacement: &[Vector]) -> Vec<Vector> {
    let constraints: Vec<Constraint> =
        (0..).zip(displacement).map(|(node, &u)| Constraint::at(node, u)).collect();
    let problem = FiniteStrain {
        mesh,
        nodes: &mesh.nodes,
        laws: std::slice::from_ref(law),
        law_of_cell: &vec![0; mesh.cells.len()],
        pressure_of_cell: &vec![0; mesh.cells.len()],
        elements: Elements::PLAIN,
        fibres: FibreField::default(),
        membrane: None,
        inner: std::sync::Arc::default(),
        constraints: &constraints,
        tolerance: TOLERANCE,
        with_states: false,
        advance: Advance::default(),
        near: None,
    };
    let held = displacement.to_vec();
    let case =
        LoadCase { held, forces: vec![Vector::zeros(); mesh.nodes.len()], ..LoadCase::default() };
    problem.solve(&case, &Unobserved).unwrap().reactions
}

/// Some displacement whose gradient changes from cell to cell.
fn bent(mesh: &VolumeMesh, by: f64) -> Vec<Vector> {
    let at = |x: &Vector| {
        Vector::new((0.3 * x.y).sin() + 0.1 * x.z, (0.4 * x.z).cos(), 0.05 * x.x * x.x) * by
    };
    mesh.nodes.iter().map(at).collect()
}

fn sum(terms: &[(f64, &[Vector])]) -> Vec<Vector> {
    let mut sum = vec![Vector::zeros(); terms[0].1.len()];
    for (factor, forces) in terms {
        sum.iter_mut().zip(*forces).for_each(|(sum, force)| *sum += force * *factor);
    }
    sum
}

#[test]
fn second_and_third_order_are_those_of_the_forces_that_newton_balances() {
    let mesh = irregular(CellShape::Tet4);
    let (materials, of_cell) = ([material(15.0, 0.4)], vec![0; mesh.cells.len()]);
    let tissue = Tissue::isotropic(&mesh, &materials, &of_cell, mean_of_bricks);
    let (lambda, mu) = (materials[0].lambda(), materials[0].shear_modulus());
    let law = Law::NeoHookean(NeoHookean { lambda, mu });
    let u = bent(&mesh, 1.0);
    let second = &series(tissue).second(&[moved(&u)], &[[0, 0]]).unwrap()[0].nodes;
    let still = vec![Vector::zeros(); u.len()];
    let third = &series(tissue).third(moved(&u), moved(&still)).unwrap().nodes;

    let a = 0.01;
    let [there, back] = [a, -a].map(|a| newton_forces(&mesh, &law, &bent(&mesh, a)));
    let even = sum(&[(0.5 / (a * a), &there), (0.5 / (a * a), &back)]);
    let apart = largest(&sum(&[(1.0, &even), (-1.0, second)])) / largest(second);
    assert!(apart < 1e-3, "{apart}");

    let first = linear_forces(tissue, &u);
    let odd =
        sum(&[(0.5 / a.powi(3), &there), (-0.5 / a.powi(3), &back), (-1.0 / (a * a), &first)]);
    let apart = largest(&sum(&[(1.0, &odd), (-1.0, third)])) / largest(third);
    assert!(apart < 1e-2, "{apart}");
}

/// Tissue with fibres under a skin that is a membrane with lines.
fn fibrous(fibres: bool) -> LinearElastic {
    let isotropic = material(15.0, 0.45);
    let law = FibreLaw::default();
    let fibre = Fibre { young_modulus: 90.0, shear_modulus: Some(12.0), law };
    if fibres { isotropic.with_fibre(&fibre).unwrap() } else { isotropic }
}

fn top(mesh: &VolumeMesh) -> Membrane {
    let sheet =
        Sheet { thickness: 1.5, young_modulus: 200.0, poisson_ratio: 0.4, along_lines: None };
    let top = &mesh.node_sets["z_max"];
    let faces = mesh.boundary_faces().into_iter();
    let faces = faces.filter(|face| face.nodes().iter().all(|node| top.contains(node)));
    let triangles: Vec<[u32; 3]> =
        faces.flat_map(|face| face.triangles(&mesh.nodes).collect::<Vec<_>>()).collect();
    Membrane { sheet: PlaneStress::new(&sheet).unwrap(), triangles, lines: Vec::new() }
}

#[test]
fn tissue_that_is_turned_as_a_whole_has_no_forces_up_to_the_third_order() {
    for (shape, fibres) in SHAPES.into_iter().flat_map(|shape| [(shape, false), (shape, true)]) {
        let mesh = irregular(shape);
        let (materials, of_cell) = ([fibrous(fibres)], vec![0; mesh.cells.len()]);
        let direction = Vector::new(0.6, 0.48, 0.64);
        let directions = vec![direction; if fibres { mesh.cells.len() } else { 0 }];
        let membrane = top(&mesh);
        let tissue = Tissue {
            fibres: &directions,
            membrane: Some(&membrane),
            ..Tissue::isotropic(&mesh, &materials, &of_cell, mean_of_bricks)
        };
        let left = |angle: f64| -> [f64; 3] {
            let turn = Rotation3::new(Vector::new(1.0, -2.0, 2.0) * (angle / 3.0));
            let u: Vec<Vector> = mesh.nodes.iter().map(|x| turn * x - x).collect();
            let still = vec![Vector::zeros(); u.len()];
            let first = linear_forces(tissue, &u);
            let second = &series(tissue).second(&[moved(&u)], &[[0, 0]]).unwrap()[0].nodes;
            let third = &series(tissue).third(moved(&u), moved(&still)).unwrap().nodes;
            let two = sum(&[(1.0, &first), (1.0, second)]);
            let three = sum(&[(1.0, &two), (1.0, third)]);
            [&first, &two, &three].map(|forces| largest(forces))
        };
        let [coarse, fine] = [0.04, 0.02].map(left);
        let falls: [f64; 3] = std::array::from_fn(|order| coarse[order] / fine[order]);
        // Of the second, the third, and the fourth order in the angle.
        let name = format!("{shape:?} {fibres} {falls:?}");
        assert!((3.9..4.1).contains(&falls[0]), "{name}");
        assert!(falls[1] > 7.8 && falls[2] > 15.0, "{name}");
        assert!(coarse[1] < 0.1 * coarse[0] && coarse[2] < 0.1 * coarse[1], "{name} {coarse:?}");
    }
}

#[test]
fn the_second_order_is_bilinear_and_symmetric() {
    for shape in SHAPES {
        let mesh = irregular(shape);
        let (materials, of_cell) = ([material(15.0, 0.45)], vec![0; mesh.cells.len()]);
        let tissue = Tissue::isotropic(&mesh, &materials, &of_cell, mean_of_bricks);
        let u = bent(&mesh, 1.0);
        let v: Vec<Vector> = mesh.nodes.iter().map(|x| x.yzx() * 0.1).collect();
        let both: Vec<Vector> = u.iter().zip(&v).map(|(u, v)| u + v * 3.0).collect();
        let states = [moved(&u), moved(&v), moved(&both)];
        let pairs = [[0, 0], [0, 1], [1, 0], [1, 1], [2, 2]];
        let found = series(tissue).second(&states, &pairs).unwrap();
        let [uu, uv, vu, vv, all] = [0, 1, 2, 3, 4].map(|k: usize| found[k].nodes.as_slice());
        let apart = largest(&sum(&[(1.0, uv), (-1.0, vu)])) / largest(uv);
        assert!(apart < 1e-13, "{apart}");
        let expected = sum(&[(1.0, uu), (3.0, uv), (3.0, vu), (9.0, vv), (-1.0, all)]);
        assert!(largest(&expected) < 1e-12 * largest(all));
    }
}

#[test]
fn pressures_give_the_forces_of_plain_cells_where_the_gradient_is_one() {
    let mesh = irregular(CellShape::Tet4);
    let (materials, of_cell) = ([material(15.0, 0.45)], vec![0; mesh.cells.len()]);
    let tissue = Tissue::isotropic(&mesh, &materials, &of_cell, mean_of_bricks);
    let gradient = Matrix3::new(0.2, -0.1, 0.3, 0.4, 0.1, -0.2, 0.05, 0.3, -0.25);
    let u: Vec<Vector> = mesh.nodes.iter().map(|x| gradient * x).collect();
    let plain = &series(tissue).second(&[moved(&u)], &[[0, 0]]).unwrap()[0].nodes;

    let corners: Vec<Option<[u32; 4]>> =
        mesh.cells.iter().map(|(_, nodes)| Some(std::array::from_fn(|k| nodes[k]))).collect();
    let pressure = materials[0].lambda() * gradient.trace();
    let pressures = vec![pressure; mesh.nodes.len()];
    let mixed = ForceSeries {
        tissue,
        pressures_of_cell: corners,
        pressure_count: mesh.nodes.len(),
        inner: InnerStress::default(),
    };
    let state = LinearState { displacement: &u, pressures: &pressures };
    let Forces { nodes, volumes } = mixed.second(&[state], &[[0, 0]]).unwrap().remove(0);
    // The volume that is left over raises the pressure by p2 = lambda times it, which acts as B^T p2.
    let second_pressure = materials[0].lambda() * -0.5 * (gradient * gradient).trace();
    let volume: f64 = volumes.iter().sum();
    let whole: f64 = mesh.cells.iter().map(|(_, nodes)| volume_of(&mesh, nodes)).sum();
    let expected = -0.5 * (gradient * gradient).trace() * whole;
    assert!((volume / expected - 1.0).abs() < 1e-12, "{volume} {expected}");
    let mut acting = nodes;
    for (_, corners) in mesh.cells.iter() {
        for (corner, gradient) in gradients(&mesh, corners).iter().enumerate() {
            let volume = volume_of(&mesh, corners);
            acting[corners[corner] as usize] += gradient * (volume * second_pressure);
        }
    }
    let apart = largest(&sum(&[(1.0, &acting), (-1.0, plain)])) / largest(plain);
    assert!(apart < 1e-12, "{apart}");
}

/// Six times the volume is the determinant of the edges.
fn edges(mesh: &VolumeMesh, nodes: &[u32]) -> Matrix3<f64> {
    let at = |k: usize| mesh.nodes[nodes[k] as usize] - mesh.nodes[nodes[0] as usize];
    Matrix3::from_columns(&[at(1), at(2), at(3)])
}

fn volume_of(mesh: &VolumeMesh, nodes: &[u32]) -> f64 {
    edges(mesh, nodes).determinant() / 6.0
}

fn gradients(mesh: &VolumeMesh, nodes: &[u32]) -> [Vector; 4] {
    let inverse = edges(mesh, nodes).try_inverse().unwrap();
    let rows = [0, 1, 2].map(|k| inverse.row(k).transpose());
    [-(rows[0] + rows[1] + rows[2]), rows[0], rows[1], rows[2]]
}
