//! Springs on the edges of tetrahedra: what they are on average (docs/verification.md#v12, docs/verification.md#v13), and how
//! they come to rest.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Cells, Vector, VolumeMesh};
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::Dilatation;
use mechanics::model::mass_spring::{MassSpringSettings, Search, Springs};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Load, Method, ModelError, Plan, Prediction, Scene, Settings,
    Sliding, SlidingNormal, SolverError, predict,
};
use mechanics::progress::Unobserved;
use nalgebra::Matrix3;

use crate::scenes::{StopsAfter, case_of, constraint, material, on_the_boundary, set, solve};

const YOUNG: f64 = 15.0;

fn springs_of(mesh: &VolumeMesh) -> Springs {
    let (materials, of_cell) = ([material(YOUNG, 0.3)], vec![0; mesh.cells.len()]);
    let tissue = Tissue::isotropic(mesh, &materials, &of_cell, |_| Dilatation::Pointwise);
    Springs::new(&tissue).unwrap()
}

fn volume(mesh: &VolumeMesh) -> f64 {
    let cell = |cell: usize| {
        let x: Vec<Vector> = mesh.corners(cell).collect();
        (x[1] - x[0]).cross(&(x[2] - x[0])).dot(&(x[3] - x[0])) / 6.0
    };
    (0..mesh.cells.len()).map(cell).sum()
}

/// A block whose inner nodes are moved by up to a fifth of a cell: no symmetry is left.
fn crooked_block() -> VolumeMesh {
    let mut mesh = block(Vector::new(8.0, 6.0, 6.0), [4, 3, 3], CellShape::Tet4);
    for (number, x) in mesh.nodes.iter_mut().enumerate() {
        let is_inside = x.iter().zip([8.0, 6.0, 6.0]).all(|(x, size)| *x > 0.0 && *x < size);
        let shift = |k: usize| 0.4 * (((number * 7919 + 31 * k) % 101) as f64 / 50.0 - 1.0);
        if is_inside {
            *x += Vector::new(shift(0), shift(1), shift(2));
        }
    }
    mesh
}

/// One regular tetrahedron: every edge has the direction of one of the six of the lattice, with equal
/// weight, so that it has the constants of the whole lattice.
fn regular_tetrahedron() -> VolumeMesh {
    let nodes = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let mut cells = Cells::default();
    cells.push(CellShape::Tet4, &[0, 2, 1, 3]);
    VolumeMesh { nodes: nodes.map(Vector::from).to_vec(), cells, ..VolumeMesh::default() }
}

/// C = (1/V) sum k L^2 n n n n: the second derivative of the energy of an affine strain.
fn homogenised(mesh: &VolumeMesh) -> impl Fn(usize, usize, usize, usize) -> f64 + use<> {
    let springs = springs_of(mesh);
    let terms: Vec<(f64, Vector)> = springs
        .springs
        .iter()
        .map(|spring| {
            let [x, y] = spring.nodes.map(|node| mesh.nodes[node as usize]);
            (spring.stiffness * spring.length.powi(2), (y - x) / spring.length)
        })
        .collect();
    let volume = volume(mesh);
    move |i, j, k, l| {
        let term = |(weight, n): &(f64, Vector)| weight * n[i] * n[j] * n[k] * n[l];
        terms.iter().map(term).sum::<f64>() / volume / YOUNG
    }
}

#[test]
fn a_small_dilation_costs_what_tissue_of_a_poisson_ratio_of_a_quarter_costs() {
    let epsilon = 1e-6;
    for mesh in [crooked_block(), regular_tetrahedron()] {
        let springs = springs_of(&mesh);
        let dilated: Vec<Vector> = mesh.nodes.iter().map(|x| x * (1.0 + epsilon)).collect();
        let tissue = material(YOUNG, 0.25);
        // 9/2 K eps^2 V with K = 2 E / 3.
        let expected = 4.5 * tissue.bulk_modulus() * epsilon * epsilon * volume(&mesh);
        assert!((3.0 * YOUNG * epsilon * epsilon * volume(&mesh) / expected - 1.0).abs() < 1e-14);
        // The length of a spring is rounded at 1e-16, its change of 1e-6 to 1e-10, twice that for the energy.
        let energy = springs.energy(&dilated);
        assert!((energy / expected - 1.0).abs() < 1e-8, "{energy:e} against {expected:e}");
        let forces = springs.forces(&dilated);
        let virial: f64 = forces.iter().zip(&mesh.nodes).map(|(f, x)| f.dot(x)).sum();
        assert!((virial * epsilon / (2.0 * expected) - 1.0).abs() < 1e-5, "{virial:e}");
    }
}

#[test]
fn the_constants_of_the_regular_and_of_kuhn_s_lattice_are_those_of_the_closed_form() {
    let regular = homogenised(&regular_tetrahedron());
    assert!((regular(0, 0, 0, 0) - 1.0).abs() < 1e-12);
    assert!((regular(0, 0, 1, 1) - 0.5).abs() < 1e-12);
    assert!((regular(0, 1, 0, 1) - 0.5).abs() < 1e-12);
    let (c11, c12) = (regular(0, 0, 0, 0), regular(0, 0, 1, 1));
    let along = c11 - 2.0 * c12 * c12 / (c11 + c12);
    assert!((along - 2.0 / 3.0).abs() < 1e-12, "Young's modulus along [100] is 2/3 E, {along}");

    let kuhn = homogenised(&block(Vector::new(4.0, 3.0, 2.0), [4, 3, 2], CellShape::Tet4));
    // Three axes, three face diagonals, one space diagonal: 1 + 4/9 and 5/18.
    assert!((kuhn(0, 0, 0, 0) - 13.0 / 9.0).abs() < 1e-12, "{}", kuhn(0, 0, 0, 0));
    for [i, j, k, l] in [[0, 0, 1, 1], [0, 1, 0, 1], [0, 0, 0, 1]] {
        assert!((kuhn(i, j, k, l) - 5.0 / 18.0).abs() < 1e-12, "{}", kuhn(i, j, k, l));
    }
}

#[test]
fn the_trace_of_the_constants_is_six_young_s_moduli_on_any_mesh() {
    for mesh in [regular_tetrahedron(), crooked_block()] {
        let constants = homogenised(&mesh);
        let trace: f64 = (0..3)
            .flat_map(|i| (0..3).map(move |j| (i, j)))
            .map(|(i, j)| constants(i, i, j, j))
            .sum();
        assert!((trace - 6.0).abs() < 1e-12, "{trace}");
        assert!((constants(0, 0, 1, 1) - constants(0, 1, 0, 1)).abs() < 1e-12, "Cauchy's symmetry");
    }
}

#[test]
fn the_energy_of_a_small_affine_strain_is_that_of_the_homogenised_constants() {
    let mesh = block(Vector::new(4.0, 3.0, 2.0), [4, 3, 2], CellShape::Tet4);
    let constants = homogenised(&mesh);
    let springs = springs_of(&mesh);
    let strain = Matrix3::new(1.0, 0.4, -0.2, 0.4, -0.7, 0.3, -0.2, 0.3, 0.5) * 1e-5;
    // Only n . eps n counts at this order; what the next order adds is odd and cancels between + and -.
    let energy = |sign: f64| {
        let moved: Vec<Vector> = mesh.nodes.iter().map(|x| x + strain * x * sign).collect();
        springs.energy(&moved)
    };
    let mut expected = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                for l in 0..3 {
                    expected += 0.5 * constants(i, j, k, l) * strain[(i, j)] * strain[(k, l)];
                }
            }
        }
    }
    let expected = expected * YOUNG * volume(&mesh);
    let found = 0.5 * (energy(1.0) + energy(-1.0));
    assert!((found / expected - 1.0).abs() < 1e-9, "{:.1e}", found / expected - 1.0);
}

#[test]
fn forces_are_the_derivative_of_the_energy() {
    let mesh = crooked_block();
    let springs = springs_of(&mesh);
    let bent = |x: &Vector| x + Vector::new(0.03 * x.y * x.y, -0.2 * x.z, 0.05 * x.x * x.y);
    let positions: Vec<Vector> = mesh.nodes.iter().map(bent).collect();
    let forces = springs.forces(&positions);
    let h = 1e-5;
    for node in [0, 17, 40] {
        for axis in 0..3 {
            let at = |by: f64| {
                let mut moved = positions.clone();
                moved[node][axis] += by;
                springs.energy(&moved)
            };
            let slope = (at(h) - at(-h)) / (2.0 * h);
            // Rounding of the energy over h.
            assert!((slope - forces[node][axis]).abs() < 1e-5, "{slope} {}", forces[node][axis]);
        }
    }
}

#[test]
fn a_rotation_costs_nothing_however_large() {
    let mesh = crooked_block();
    let springs = springs_of(&mesh);
    let turn = RigidMovement::about_pivot(Vector::new(0.5, -1.0, 2.0), Vector::x(), Vector::y());
    let turned: Vec<Vector> = mesh.nodes.iter().map(|x| turn.apply(x)).collect();
    let energy = springs.energy(&turned);
    assert!(energy < 1e-24 * YOUNG * volume(&mesh), "{energy:e}");
}

fn springs(search: Search) -> Settings {
    let method = Method::MassSpring(MassSpringSettings { search, most_iterations: 20_000 });
    Settings { method, relative_residual: 1e-11, ..Settings::default() }
}

/// A slab on a bone that moves under its middle.
fn slab(shape: CellShape, poisson_ratio: f64) -> Case {
    let mut mesh = block(Vector::new(48.0, 24.0, 12.0), [8, 4, 2], shape);
    let of = |on: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        (0..mesh.nodes.len() as u32).filter(|&node| on(&mesh.nodes[node as usize])).collect()
    };
    let bone = of(&|x| x.z == 0.0 && (x.x - 24.0).abs() < 7.0);
    let skull = of(&|x| x.z == 0.0 && (x.x - 24.0).abs() > 13.0);
    mesh.node_sets.insert("bone".to_owned(), bone);
    mesh.node_sets.insert("skull".to_owned(), skull);
    let mut case = case_of(mesh, material(YOUNG, poisson_ratio));
    case.segments.push(CaseSegment { name: "bone".to_owned(), nodes: set("bone") });
    case.fixed.push(set("skull"));
    case
}

fn moved(by: Vector) -> Plan {
    let movement =
        RigidMovement::about_pivot(Vector::new(0.0, 0.05, 0.0), Vector::new(24.0, 0.0, 0.0), by);
    let segment = PlannedSegment { name: "bone".to_owned(), movement };
    Plan { segments: vec![segment], ..Plan::default() }
}

fn largest_difference(a: &Prediction, b: &Prediction) -> f64 {
    let pairs = a.displacement.iter().zip(&b.displacement);
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn direct_iteration_and_newton_come_to_the_same_rest() {
    let case = slab(CellShape::Tet4, 0.25);
    let plan = moved(Vector::new(1.0, 0.5, 2.0));
    let newton = solve(&case, &plan, &springs(Search::Newton));
    let direct = solve(&case, &plan, &springs(Search::Direct));
    // The residual of 1e-11 times the condition number of some hundreds, and 2 mm.
    assert!(
        largest_difference(&newton, &direct) < 1e-8,
        "{:.1e}",
        largest_difference(&newton, &direct)
    );
    assert!(newton.solver.iterations < 10, "{}", newton.solver.why);
    assert!(direct.solver.iterations > 100);
    for (found, name) in [(&newton, "newton"), (&direct, "direct_iteration")] {
        assert_eq!(found.solver.method, name);
        assert_eq!(found.solver.history.len(), found.solver.iterations);
        assert!(found.solver.relative_residual <= 1e-11);
        for (axis, sum) in found.reactions.values().sum::<Vector>().iter().enumerate() {
            assert!(sum.abs() < 1e-6, "reactions balance where nothing else acts: {axis} {sum:e}");
        }
    }
}

#[test]
fn springs_that_hardly_move_answer_like_their_own_linear_springs() {
    // On a dilated boundary a crooked lattice is not affine inside; a symmetric one is.
    let mut mesh = block(Vector::new(6.0, 6.0, 6.0), [3, 3, 3], CellShape::Tet4);
    let plan = on_the_boundary(&mut mesh, |x| x * 1e-4);
    let case = case_of(mesh, material(YOUNG, 0.25));
    let found = solve(&case, &plan, &springs(Search::Newton));
    for (x, u) in case.volume.nodes.iter().zip(&found.displacement) {
        assert!((u - x * 1e-4).norm() < 1e-13);
    }
}

#[test]
fn materials_that_say_another_poisson_ratio_are_told_that_springs_have_a_quarter() {
    let told = |nu: f64, settings: &Settings| {
        let scene = Scene::new(&slab(CellShape::Tet4, nu), &moved(Vector::z()), settings).unwrap();
        let named = |code: &str| scene.warnings.iter().find(|w| w.code == code).cloned();
        assert!(named("locking").is_none(), "springs do not lock");
        named("built-in-poisson-ratio").map(|warning| warning.detail)
    };
    let other = told(0.46, &springs(Search::Newton)).unwrap();
    assert!(other.contains("1/4") && other.contains("tissue 0.46"), "{other}");
    let same = told(0.25, &springs(Search::Newton)).unwrap();
    assert!(same.contains("1/4") && !same.contains("tissue"), "{same}");
    assert_eq!(told(0.46, &Settings::default()), None);
}

#[test]
fn the_poisson_ratio_of_the_material_changes_nothing() {
    let answer = |nu: f64| {
        solve(&slab(CellShape::Tet4, nu), &moved(Vector::z()), &springs(Search::Newton))
            .displacement
    };
    assert_eq!(answer(0.0), answer(0.46));
}

/// A block between two walls on which it slides, pressed from above by a traction.
fn between_walls(turn: &RigidMovement) -> (Case, Plan) {
    let mut mesh = block(Vector::new(6.0, 4.0, 4.0), [3, 2, 2], CellShape::Tet4);
    mesh.nodes.iter_mut().for_each(|x| *x = turn.apply(x));
    let mut case = case_of(mesh, material(YOUNG, 0.25));
    for (name, normal) in [
        ("x_min", -Vector::x()),
        ("x_max", Vector::x()),
        ("y_min", -Vector::y()),
        ("z_min", -Vector::z()),
    ] {
        let normal = SlidingNormal::Direction(turn.rotation() * normal);
        case.sliding.push(Sliding { nodes: set(name), normal, segment: None });
    }
    let force = turn.rotation() * Vector::new(0.0, 0.3, -1.0);
    let loads = vec![Load::Force { nodes: set("z_max"), force }];
    (case, Plan { loads, ..Plan::default() })
}

#[test]
fn sliding_walls_and_loads_at_any_angle_turn_with_the_scene() {
    let straight = RigidMovement::default();
    let turn = RigidMovement::about_pivot(Vector::new(0.4, -1.1, 0.8), Vector::y(), Vector::z());
    for search in [Search::Newton, Search::Direct] {
        let (case, plan) = between_walls(&straight);
        let here = solve(&case, &plan, &springs(search));
        let (case, plan) = between_walls(&turn);
        let there = solve(&case, &plan, &springs(search));
        let largest = here.displacement.iter().map(Vector::norm).fold(0.0, f64::max);
        assert!(largest > 0.1, "the load does something: {largest}");
        for (a, b) in here.displacement.iter().zip(&there.displacement) {
            // A residual of 1e-11 in both.
            assert!((turn.rotation() * a - b).norm() < 1e-8, "{search:?}");
        }
        for &node in case.volume.node_set("z_min").unwrap() {
            let normal = turn.rotation() * Vector::z();
            assert!(there.displacement[node as usize].dot(&normal).abs() < 1e-14);
        }
        let pressed: Vector = there.reactions.values().sum();
        let acting = turn.rotation() * Vector::new(0.0, 0.3, -1.0) * 12.0;
        assert!((pressed + acting).norm() < 1e-8, "reactions balance the loads: {pressed}");
    }
}

#[test]
fn a_network_that_is_pushed_through_itself_says_that_cells_are_inverted() {
    let case = slab(CellShape::Tet4, 0.25);
    let plan = moved(Vector::new(0.0, 0.0, 16.0));
    for search in [Search::Newton, Search::Direct] {
        let found = solve(&case, &plan, &springs(search));
        let smallest =
            found.deformation.iter().map(|cell| cell.det_f).fold(f64::INFINITY, f64::min);
        assert!(smallest <= 0.0, "{search:?} {smallest}");
        assert!(
            found.warnings.iter().any(|warning| warning.code == "cells-inverted"),
            "{search:?}"
        );
    }
}

#[test]
fn rest_that_is_not_found_is_an_error_with_its_history() {
    let case = slab(CellShape::Tet4, 0.25);
    for search in [Search::Newton, Search::Direct] {
        let method = Method::MassSpring(MassSpringSettings { search, most_iterations: 2 });
        let settings = Settings { method, ..Settings::default() };
        let scene = Scene::new(&case, &moved(Vector::z() * 4.0), &settings).unwrap();
        let Err(ModelError::Solver(SolverError::NotConverged {
            iterations,
            residual,
            wanted,
            history,
        })) = predict(&scene, &Unobserved)
        else {
            panic!("two iterations are not enough");
        };
        assert_eq!((iterations, history.len(), wanted), (2, 2, 1e-8));
        assert_eq!(history[1], residual);
        assert!(residual > 1e-8);
    }
}

#[test]
fn both_searches_stop_when_cancelled() {
    let case = slab(CellShape::Tet4, 0.25);
    for search in [Search::Newton, Search::Direct] {
        let settings = Settings { relative_residual: 1e-13, ..springs(search) };
        let scene = Scene::new(&case, &moved(Vector::z() * 3.0), &settings).unwrap();
        assert_eq!(
            predict(&scene, &StopsAfter::iterations(3)).unwrap_err(),
            ModelError::Solver(SolverError::Stopped),
            "{search:?}"
        );
    }
}

#[test]
fn an_identity_plan_leaves_the_springs_at_rest_exactly() {
    let found = solve(&slab(CellShape::Tet4, 0.25), &Plan::default(), &springs(Search::Newton));
    assert!(found.displacement.iter().all(|u| *u == Vector::zeros()));
    assert_eq!(found.solver.method, "none");
}

#[test]
fn cells_and_elements_that_springs_do_not_know_are_refused_where_they_stand() {
    let refused = |shape: CellShape, element: ElementChoice| {
        let settings = Settings { element, ..springs(Search::Newton) };
        let errors = Scene::new(&slab(shape, 0.25), &moved(Vector::z()), &settings).err().unwrap();
        (errors.0[0].pointer.clone(), errors.0[0].code.name())
    };
    let code = "method-not-available";
    assert_eq!(refused(CellShape::Hex8, ElementChoice::Auto), ("/case/volume".to_owned(), code));
    assert_eq!(refused(CellShape::Wedge6, ElementChoice::Auto), ("/case/volume".to_owned(), code));
    assert_eq!(refused(CellShape::Tet4, ElementChoice::Plain), ("/spec/element".to_owned(), code));
}

#[test]
fn a_prescribed_component_is_met_exactly() {
    let mut case = slab(CellShape::Tet4, 0.25);
    case.segments.clear();
    let plan =
        Plan { prescribed: vec![constraint("bone", [None, None, Some(1.5)])], ..Plan::default() };
    let found = solve(&case, &plan, &springs(Search::Newton));
    for &node in case.volume.node_set("bone").unwrap() {
        assert!((found.displacement[node as usize].z - 1.5).abs() < 1e-14);
    }
    assert!(found.displacement.iter().any(|u| u.x.abs() > 1e-3), "the others are free to move");
}
