//! The slab's table of element errors, cell by cell: docs/verification.md#v29. Rows of 1.5 mm are those of `cargo bench
//! --bench elements`: their matrices take too long without optimisation.

use std::collections::BTreeMap;

use mechanics::boundary::conditions::combine;
use mechanics::boundary::{Conditions, Constraint, HeldNodes, NodeClass, WallNode};
use mechanics::mesh::refinement::refine;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::Dilatation;
use mechanics::model::fem::displacement::Problem;
use mechanics::model::fem::edge_nodes::EdgeNodes;
use mechanics::model::fem::quadratic;
use mechanics::model::problem::LoadCase;
use mechanics::plan::RigidMovement;
use mechanics::prediction::{ElementChoice, Settings};
use mechanics::progress::Unobserved;
use mechanics::solver::Tolerance;
use mechanics::study::StudyScene;
use mechanics::study::scenes::{slab, slab_hex};

use crate::scenes::{material, solve};

const NU: [f64; 5] = [0.3, 0.43, 0.46, 0.49, 0.499];

/// Of the reference, mean |u| of the 45 points in mm.
const MEANS: [f64; 5] = [4.51239, 4.28518, 4.22975, 4.17612, 4.16587];

/// Displacements at the 45 skin points, by their place on the grid of 6 mm.
type SkinPoints = BTreeMap<[i32; 2], Vector>;

fn skin_points(mesh: &VolumeMesh, displacement: &[Vector]) -> SkinPoints {
    let mut points = SkinPoints::new();
    for (x, u) in mesh.nodes.iter().zip(displacement) {
        let place = [x.x / 6.0, x.y / 6.0];
        let on_grid = place.iter().all(|c| (c - c.round()).abs() < 1e-9);
        if on_grid && x.z > 11.9 && x.x.abs() < 24.1 && x.y < 24.1 {
            points.insert(place.map(|c| c.round() as i32), *u);
        }
    }
    assert_eq!(points.len(), 45);
    points
}

/// Quadratic cells of h mm, every node held as the scene says of its place, and so the middles of edges too. In a
/// `Scene` the middle of an edge goes with its two ends.
fn quadratic_slab(h: f64, nu: f64) -> SkinPoints {
    let cells = [60.0, 30.0, 12.0].map(|size: f64| (size / h).round() as usize);
    let mut mesh = block(Vector::new(60.0, 30.0, 12.0), cells, CellShape::Tet4);
    mesh.nodes.iter_mut().for_each(|x| x.x -= 30.0);
    let positions = EdgeNodes::new(&mesh).positions(&mesh);
    let nodes_where = |is_inside: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        (0..).zip(&positions).filter(|(_, x)| is_inside(x)).map(|(node, _)| node).collect()
    };
    let base = |x: &Vector| x.z < 1e-9;
    let movement =
        RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::new(4.0, 0.0, 8.0));
    let patch = nodes_where(&|x| base(x) && x.x.abs() < 12.1 && x.y < 12.1);
    let held = HeldNodes {
        joined: vec![(patch, movement)],
        fixed: nodes_where(&|x| base(x) && (x.x.abs() > 23.9 || x.y > 23.9)),
        sliding: nodes_where(&|x| x.y < 1e-9)
            .into_iter()
            .map(|node| WallNode { node, across: vec![Vector::y()], carrier: None })
            .collect(),
        ..HeldNodes::default()
    };
    let Conditions { classes, mut constraints, .. } = combine(&positions, &held).unwrap();
    // Middles of edges whose ends are held by different things are free by their place.
    let middles = mesh.nodes.len()..positions.len();
    let free = middles.filter(|&node| classes[node] == NodeClass::Free && base(&positions[node]));
    constraints.extend(free.map(|node| Constraint::free(node as u32)));
    let (materials, of_cell) = ([material(15.0, nu)], vec![0; mesh.cells.len()]);
    let tissue = Tissue::isotropic(&mesh, &materials, &of_cell, |_| Dilatation::Pointwise);
    let case = LoadCase {
        held: constraints.iter().map(|constraint| *constraint.values()).collect(),
        forces: vec![Vector::zeros(); mesh.nodes.len()],
        ..LoadCase::default()
    };
    let tolerance = Tolerance { relative_residual: 1e-8, memory_mb: 4000.0 };
    let problem = Problem { tissue, constraints: &constraints, forces: &case.forces, tolerance };
    let solved = quadratic::solve_cases(&problem, std::slice::from_ref(&case), &Unobserved);
    skin_points(&mesh, &solved.unwrap()[0].displacement)
}

/// The first plan of a scene of the study with every edge halved a few times.
fn study_slab(scene: &StudyScene, halved: usize, nu: f64, element: ElementChoice) -> SkinPoints {
    let mut case = scene.case.clone();
    for _ in 0..halved {
        case.volume = refine(&case.volume).into();
    }
    case.materials = BTreeMap::from([("*".to_owned(), material(15.0, nu))]);
    let settings = Settings { element, ..Settings::default() };
    let answer = solve(&case, &scene.plans[0].1, &settings);
    skin_points(&case.volume, &answer.displacement)
}

fn mean_error(found: &SkinPoints, reference: &SkinPoints) -> f64 {
    found.iter().map(|(place, u)| (u - reference[place]).norm()).sum::<f64>() / 45.0
}

/// The table has two or three digits: half of the last is allowed besides.
const LAST_DIGIT: f64 = 0.0005;

#[test]
fn the_elements_err_on_the_slab_as_the_table_says() {
    let (tetrahedra, hexahedra) = (slab(), slab_hex());
    let (plain, mean) = (ElementChoice::Plain, ElementChoice::MeanDilatation);
    for (place, nu) in NU.into_iter().enumerate() {
        let reference = quadratic_slab(2.0, nu);
        let length = reference.values().map(|u| u.norm()).sum::<f64>() / 45.0;
        // The same mesh and elements: what is left is the tolerance of the solver.
        assert!((length / MEANS[place] - 1.0).abs() < 1e-5, "nu {nu}: {length}");
        let rows = [
            ("P1 6", [0.266, 0.402, 0.518, 0.870, 1.294], study_slab(&tetrahedra, 0, nu, plain)),
            ("P1 3", [0.105, 0.165, 0.233, 0.500, 1.071], study_slab(&tetrahedra, 1, nu, plain)),
            ("P2 6", [0.060, 0.050, 0.052, 0.069, 0.100], quadratic_slab(6.0, nu)),
            ("P2 3", [0.014, 0.012, 0.011, 0.013, 0.019], quadratic_slab(3.0, nu)),
            ("Q1 3", [0.049, 0.046, 0.086, 0.345, 1.360], study_slab(&hexahedra, 1, nu, plain)),
            ("Q1P0 3", [0.062, 0.060, 0.062, 0.066, 0.071], study_slab(&hexahedra, 1, nu, mean)),
        ];
        for (name, expected, found) in rows {
            let (found, expected) = (mean_error(&found, &reference), expected[place]);
            println!("nu {nu} {name}: {found:.4} / {expected}");
            let allowed = 0.05 * expected + LAST_DIGIT;
            assert!((found - expected).abs() < allowed, "nu {nu} {name}: {found}, not {expected}");
        }
        let stabilised = study_slab(&tetrahedra, 1, nu, ElementChoice::Stabilised);
        let (found, published) =
            (mean_error(&stabilised, &reference), [0.076, 0.072, 0.073, 0.075, 0.073][place]);
        println!("nu {nu} stabilised 3: {found:.4} / {published}");
        assert!(found < 1.2 * published, "nu {nu}: {found}, {published} with another projection");
    }
}
