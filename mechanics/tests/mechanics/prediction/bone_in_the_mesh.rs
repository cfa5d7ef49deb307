//! Bone that is part of the mesh: cells all of whose nodes are held do not change what tissue beside them does.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::prediction::{Case, ElementChoice, Method, Plan, Settings};

use crate::scenes::{SHAPES, case_of, constraint, exact, largest_error, material, set, solve};

const BONE: f64 = 4.0;
const TOP: f64 = 20.0;
const DOWN: f64 = -0.5;
const NU: f64 = 0.49;

/// A column of 12 x 12 mm between smooth walls, the lowest layer of which is bone and whose top goes down.
fn column(shape: CellShape) -> (Case, Plan) {
    let mut mesh = block(Vector::new(12.0, 12.0, TOP), [3, 3, 5], shape);
    let is_bone = |x: &Vector| x.z < BONE + 0.1;
    let bone = (0_u32..).zip(&mesh.nodes).filter(|(_, x)| is_bone(x)).map(|(node, _)| node);
    mesh.node_sets.insert("bone".to_owned(), bone.collect());
    // Askew where nothing is flat.
    let is_inner = |x: &Vector| [x.x, x.y].iter().all(|at| *at > 0.1 && *at < 11.9);
    for x in mesh.nodes.iter_mut().filter(|x| is_inner(x) && x.z > BONE + 0.1 && x.z < TOP - 0.1) {
        *x += Vector::new((2.0 * x.y).sin(), (1.7 * x.z).cos(), (2.3 * x.x).sin()) * 0.4;
    }
    let zero = Some(0.0);
    let walls = [
        ("x_min", [zero, None, None]),
        ("x_max", [zero, None, None]),
        ("y_min", [None, zero, None]),
        ("y_max", [None, zero, None]),
        ("z_max", [None, None, Some(DOWN)]),
    ];
    let prescribed = walls.map(|(set, held)| constraint(set, held)).to_vec();
    let case = Case { fixed: vec![set("bone")], ..case_of(mesh, material(15.0, NU)) };
    (case, Plan { prescribed, ..Plan::default() })
}

/// Even strain above the bone.
fn even(x: &Vector) -> Vector {
    Vector::z() * (DOWN * (x.z - BONE).max(0.0) / (TOP - BONE))
}

#[test]
fn tissue_on_cells_of_bone_has_even_strain_and_no_estimated_error() {
    for shape in SHAPES {
        let (case, plan) = column(shape);
        let found = solve(&case, &plan, &exact());
        let error = largest_error(&case.volume, &found.displacement, even);
        assert!(error < 1e-7, "{shape:?}: {error} mm");
        let missing = found.numerical_error.unwrap().missing;
        let estimated = missing.iter().map(Vector::norm).fold(0.0, f64::max);
        assert!(estimated < 1e-6, "{shape:?}: an estimate of {estimated} mm");
    }
}

#[test]
fn quadratic_tetrahedra_do_not_move_through_bone() {
    let (case, plan) = column(CellShape::Tet4);
    let settings = Settings { element: ElementChoice::Quadratic, ..exact() };
    let found = solve(&case, &plan, &settings);
    let error = largest_error(&case.volume, &found.displacement, even);
    assert!(error < 1e-7, "{error} mm");
}

#[test]
fn elements_agree_beside_bone_at_finite_strain() {
    let (case, plan) = column(CellShape::Tet4);
    let [stabilised, plain] = [ElementChoice::Stabilised, ElementChoice::Plain].map(|element| {
        let settings = Settings { element, method: Method::FemNonlinear, ..exact() };
        solve(&case, &plan, &settings).displacement
    });
    let pairs = stabilised.iter().zip(&plain);
    let apart = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart} mm");
}

/// Blocks of 10 mm on each other, with the nodes of both at one place made one.
fn stack(shapes: &[CellShape]) -> VolumeMesh {
    let mut mesh = VolumeMesh::default();
    for (level, &shape) in shapes.iter().enumerate() {
        let mut above = block(Vector::repeat(10.0), [2, 2, 2], shape);
        above.nodes.iter_mut().for_each(|x| x.z += 10.0 * level as f64);
        let below = mesh.nodes.clone();
        let mut number = |x: &Vector| {
            let same = below.iter().position(|own| (own - x).norm() < 1e-9);
            same.unwrap_or_else(|| {
                mesh.nodes.push(*x);
                mesh.nodes.len() - 1
            }) as u32
        };
        let numbers: Vec<u32> = above.nodes.iter().map(&mut number).collect();
        for (shape, nodes) in above.cells.iter() {
            let nodes: Vec<u32> = nodes.iter().map(|&node| numbers[node as usize]).collect();
            mesh.cells.push(shape, &nodes);
        }
    }
    mesh
}

#[test]
fn tetrahedra_between_hexahedra_are_solved_at_finite_strain() {
    // The last free nodes have no pressure, and no node of a tetrahedron is held.
    let mut mesh = stack(&[CellShape::Hex8, CellShape::Tet4, CellShape::Hex8]);
    for (name, z) in [("bottom", 0.0), ("top", 30.0)] {
        let at = (0_u32..).zip(&mesh.nodes).filter(|(_, x)| (x.z - z).abs() < 1e-9);
        let nodes = at.map(|(node, _)| node).collect();
        mesh.node_sets.insert(name.to_owned(), nodes);
    }
    let top = constraint("top", [Some(1.0), Some(0.0), Some(-1.5)]);
    let case = Case { fixed: vec![set("bottom")], ..case_of(mesh, material(15.0, 0.46)) };
    let plan = Plan { prescribed: vec![top], ..Plan::default() };
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let found = solve(&case, &plan, &settings);
    let pairs = case.volume.nodes.iter().zip(&found.displacement);
    let mut inside = pairs.filter(|(x, _)| x.z > 9.0 && x.z < 21.0);
    assert!(inside.all(|(_, u)| u.x > 0.1 && u.x < 0.9 && u.z < -0.1 && u.z > -1.4));
}
