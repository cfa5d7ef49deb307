//! Finite strain: exact states, the linear limit, the hard block, and what is refused.

use mechanics::boundary::Constraint;
use mechanics::material::hyperelastic::{Law, NeoHookean, SaintVenantKirchhoff};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::finite_strain::{Advance, Elements, FibreField, FiniteStrain};
use mechanics::model::problem::{Equilibrium, LoadCase, ModelError};
use mechanics::prediction::{Case, ElementChoice, Load, Method, Plan, Prediction, Settings};
use mechanics::progress::{Progress, Unobserved};
use mechanics::solver::{SolverError, Tolerance};
use nalgebra::{Matrix3, Rotation3};

use crate::scenes::{StopsAfter, case_of, constraint, material, on_the_boundary, set, solve};

/// E 15 kPa.
fn lame(poisson_ratio: f64) -> (f64, f64) {
    let mu = 7.5 / (1.0 + poisson_ratio);
    (2.0 * mu * poisson_ratio / (1.0 - 2.0 * poisson_ratio), mu)
}

pub(super) fn neo_hookean(poisson_ratio: f64) -> Law {
    let (lambda, mu) = lame(poisson_ratio);
    Law::NeoHookean(NeoHookean { lambda, mu })
}

/// Plain tetrahedra.
fn rest(
    mesh: &VolumeMesh,
    law: Law,
    constraints: &[Constraint],
    progress: &dyn Progress,
) -> Result<Equilibrium, ModelError> {
    rest_of(Elements::PLAIN, mesh, law, constraints, progress)
}

pub(super) fn rest_of(
    elements: Elements,
    mesh: &VolumeMesh,
    law: Law,
    constraints: &[Constraint],
    progress: &dyn Progress,
) -> Result<Equilibrium, ModelError> {
    rest_by((Advance::default(), elements), mesh, law, constraints, progress)
}

pub(super) fn rest_by(
    (advance, elements): (Advance, Elements),
    mesh: &VolumeMesh,
    law: Law,
    constraints: &[Constraint],
    progress: &dyn Progress,
) -> Result<Equilibrium, ModelError> {
    let one = vec![0; mesh.cells.len()];
    let problem = FiniteStrain {
        mesh,
        nodes: &mesh.nodes,
        laws: &[law],
        law_of_cell: &one,
        pressure_of_cell: &one,
        elements,
        fibres: FibreField::default(),
        membrane: None,
        inner: std::sync::Arc::default(),
        constraints,
        tolerance: Tolerance { relative_residual: 1e-7, memory_mb: 1000.0 },
        with_states: false,
        advance,
        near: None,
    };
    let held = constraints.iter().map(|constraint| *constraint.values()).collect();
    let forces = vec![Vector::zeros(); mesh.nodes.len()];
    problem.solve(&LoadCase { held, forces, ..LoadCase::default() }, progress)
}

/// Holds the nodes that something is said of.
pub(super) fn constraints(
    mesh: &VolumeMesh,
    displacement: impl Fn(&Vector) -> Option<Vector>,
) -> Vec<Constraint> {
    let nodes = (0..).zip(&mesh.nodes);
    nodes.filter_map(|(node, x)| displacement(x).map(|u| Constraint::at(node, u))).collect()
}

fn least_det_f(mesh: &VolumeMesh, displacement: &[Vector]) -> f64 {
    let cells = mechanics::model::fem::strain::deformations(mesh, displacement);
    cells.iter().map(|cell| cell.det_f).fold(f64::INFINITY, f64::min)
}

/// Each shape with the elements that there are for it.
const EVERY: [(CellShape, Elements, ElementChoice); 7] = [
    (CellShape::Tet4, Elements::PLAIN, ElementChoice::Plain),
    (CellShape::Tet4, Elements::STABLE, ElementChoice::Stabilised),
    (CellShape::Tet4, Elements::QUADRATIC, ElementChoice::Quadratic),
    (CellShape::Hex8, Elements::PLAIN, ElementChoice::Plain),
    (CellShape::Hex8, Elements::STABLE, ElementChoice::Stabilised),
    (CellShape::Wedge6, Elements::PLAIN, ElementChoice::Plain),
    (CellShape::Wedge6, Elements::STABLE, ElementChoice::MeanDilatation),
];

fn nonlinear_of(element: ElementChoice) -> Settings {
    let method = Method::FemNonlinear;
    Settings { method, element, relative_residual: 1e-11, ..Settings::default() }
}

#[test]
fn an_affine_boundary_moves_the_inside_alike_however_large_it_is() {
    let stretch = Matrix3::new(1.5, 0.4, 0.0, -0.2, 0.8, 0.1, 0.0, 0.3, 1.1);
    let affine = |x: &Vector| stretch * x - x + Vector::new(3.0, 0.0, -2.0);
    for (shape, _, element) in EVERY {
        let mut mesh = block(Vector::new(9.0, 9.0, 9.0), [3, 3, 3], shape);
        let plan = on_the_boundary(&mut mesh, affine);
        let case = case_of(mesh, material(15.0, 0.46));
        let moved = solve(&case, &plan, &nonlinear_of(element));
        let error = crate::scenes::largest_error(&case.volume, &moved.displacement, affine);
        assert!(error < 1e-8, "{shape:?} {element:?}: {error}");
        let det_f = stretch.determinant();
        assert!(moved.deformation.iter().all(|cell| (cell.det_f - det_f).abs() < 1e-8));
    }
}

#[test]
fn tissue_that_is_turned_as_a_whole_stays_as_it_is() {
    for ((shape, elements, _), degrees) in
        EVERY.into_iter().flat_map(|own| [75, 79, 80].map(|by| (own, by)))
    {
        let turn = Rotation3::from_axis_angle(&Vector::x_axis(), f64::from(degrees).to_radians());
        let turned = |x: &Vector| turn * x - x + Vector::new(0.0, 12.0, -5.0);
        let mesh = block(Vector::new(30.0, 20.0, 10.0), [6, 4, 2], shape);
        let ends = constraints(&mesh, |x| (x.x < 1e-9 || x.x > 29.9).then(|| turned(x)));
        let moved = rest_of(elements, &mesh, neo_hookean(0.46), &ends, &Unobserved).unwrap();
        let error = crate::scenes::largest_error(&mesh, &moved.displacement, turned);
        assert!(error < 1e-5, "{shape:?} {elements:?} {degrees}: {error}");
        assert!(moved.reactions.iter().all(|force| force.norm() < 1e-3));
    }
}

/// A jaw lifts the middle of the bottom of a slab.
fn lifted(by_mm: f64, shape: CellShape, settings: &Settings) -> Prediction {
    let mut mesh = block(Vector::new(30.0, 30.0, 10.0), [10, 10, 4], shape);
    let bottom = mesh.node_sets["z_min"].clone();
    let is_jaw = |&node: &u32| {
        let x = &mesh.nodes[node as usize];
        (x - Vector::new(15.0, 15.0, 0.0)).amax() < 6.1
    };
    let (jaw, rest): (Vec<u32>, Vec<u32>) = bottom.into_iter().partition(is_jaw);
    mesh.node_sets.insert("jaw".to_owned(), jaw);
    mesh.node_sets.insert("rest".to_owned(), rest);
    let case = Case { fixed: vec![set("rest")], ..case_of(mesh, material(15.0, 0.4)) };
    let up = constraint("jaw", [Some(0.3 * by_mm), Some(0.0), Some(by_mm)]);
    solve(&case, &Plan { prescribed: vec![up], ..Plan::default() }, settings)
}

fn distance(a: &Prediction, b: &Prediction) -> f64 {
    let pairs = a.displacement.iter().zip(&b.displacement);
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn what_linear_elements_leave_out_grows_with_the_square_of_the_movement() {
    for (shape, _, element) in EVERY {
        let linear = Settings { element, relative_residual: 1e-12, ..Settings::default() };
        let apart = |mm: f64| {
            distance(&lifted(mm, shape, &linear), &lifted(mm, shape, &nonlinear_of(element)))
        };
        let (small, twice) = (apart(0.02), apart(0.04));
        let is_square = (3.9..4.1).contains(&(twice / small));
        assert!(small < 1e-4 && is_square, "{shape:?} {element:?}: {small} {twice}");
    }
}

#[test]
fn a_bar_is_pulled_with_the_force_of_one_material_point() {
    for (shape, _, element) in EVERY {
        pull_a_bar(shape, element);
    }
}

fn pull_a_bar(shape: CellShape, element: ElementChoice) {
    let mut mesh = block(Vector::new(10.0, 4.0, 4.0), [5, 2, 2], shape);
    let corner = |name: &str, axis: usize, mesh: &mut VolumeMesh| {
        let low =
            (0..).zip(&mesh.nodes).filter(|(_, x)| x[axis].abs() < 1e-9).map(|(node, _)| node);
        let low: Vec<u32> = low.collect();
        mesh.node_sets.insert(name.to_owned(), low);
    };
    corner("left", 0, &mut mesh);
    corner("front", 1, &mut mesh);
    corner("low", 2, &mut mesh);
    let case = case_of(mesh, material(15.0, 0.46));
    let prescribed = vec![
        constraint("left", [Some(0.0), None, None]),
        constraint("front", [None, Some(0.0), None]),
        constraint("low", [None, None, Some(0.0)]),
        constraint("x_max", [Some(5.0), None, None]),
    ];
    let pulled = solve(&case, &Plan { prescribed, ..Plan::default() }, &nonlinear_of(element));
    // docs/verification.md#printed-values: 5.359007 kPa and a lateral stretch of .827750 at 1.5, on 16 mm^2.
    let force = pulled.condition_reactions.iter().find(|one| one.pointer == "/plan/prescribed/3");
    let force = force.unwrap().force.x;
    assert!((force - 16.0 * 5.359007).abs() < 1e-4, "{shape:?} {element:?}: {force}");
    let side = pulled.displacement.iter().map(|u| u.y).fold(0.0, f64::min);
    assert!((side - 4.0 * (0.827750 - 1.0)).abs() < 1e-5, "{side}");
}

/// 100 x 100 x 20 mm, a patch of its bottom moved by 26.9 mm and turned by 15 degrees times a share, with a free ring
/// around it, of 25 mm for block B and of none for block A of docs/verification.md#hard-block.
pub(super) const RING: f64 = 25.0;

pub(super) fn hard_block(
    cells: [usize; 3],
    share: f64,
    ring_mm: f64,
) -> (VolumeMesh, Vec<Constraint>) {
    let mesh = block(Vector::new(100.0, 100.0, 20.0), cells, CellShape::Tet4);
    let turn = Rotation3::from_axis_angle(&Vector::y_axis(), (15.0 * share).to_radians());
    let pivot = Vector::new(50.0, 50.0, 0.0);
    let held = constraints(&mesh, |x| {
        let outside = [x.x, x.y].map(|v| (35.0 - v).max(v - 65.0).max(0.0));
        match (x.z.abs() < 1e-9, outside[0].hypot(outside[1])) {
            (true, 0.0) => {
                Some(turn * (x - pivot) + pivot - x + Vector::new(25.0, 0.0, 10.0) * share)
            }
            (true, distance) if distance > ring_mm => Some(Vector::zeros()),
            _ => None,
        }
    });
    (mesh, held)
}

#[test]
fn the_hard_block_comes_to_rest_and_no_cell_turns_over() {
    for (poisson_ratio, ring, most) in [(0.46, RING, 15), (0.49, RING, 25), (0.46, 0.0, 25)] {
        let (mesh, held) = hard_block([20, 20, 4], 1.0, ring);
        let moved = rest(&mesh, neo_hookean(poisson_ratio), &held, &Unobserved).unwrap();
        let steps = moved.solver.iterations;
        assert!(steps <= most, "{poisson_ratio} {ring}: {steps} steps");
        assert!(least_det_f(&mesh, &moved.displacement) > 0.1);
        // The tail is quadratic: the last step takes far more than the one before.
        let [.., third, second, last] = moved.solver.history[..] else { unreachable!() };
        assert!(last < 1e-7 && second < 0.05 * third, "{third} {second} {last}");
    }
}

#[test]
fn only_pressed_cells_keep_bulk_modulus_at_rest_and_all_do_where_that_jams() {
    for (ring, all_keep_it) in [(RING, false), (0.0, true)] {
        let (mesh, held) = hard_block([20, 20, 4], 1.5, ring);
        let moved =
            rest_of(Elements::STABLE, &mesh, neo_hookean(0.46), &held, &Unobserved).unwrap();
        let newton = moved.solver.newton.unwrap();
        assert!(newton.bulk_in_cells == 1.0 && newton.least_det_f < 0.2);
        let expected = if all_keep_it { mesh.cells.len()..=mesh.cells.len() } else { 1..=20 };
        assert!(expected.contains(&newton.cells_with_bulk), "{ring}: {}", newton.cells_with_bulk);
    }
}

#[test]
fn pressures_take_the_hard_block_to_rest_in_as_many_steps_for_every_poisson_ratio() {
    let steps: Vec<usize> = [0.46, 0.49, 0.499, 0.4999]
        .into_iter()
        .map(|poisson_ratio| {
            let (mesh, held) = hard_block([20, 20, 4], 1.0, RING);
            let law = neo_hookean(poisson_ratio);
            let moved = rest_of(Elements::STABLE, &mesh, law, &held, &Unobserved).unwrap();
            assert!(least_det_f(&mesh, &moved.displacement) > 0.1);
            let newton = moved.solver.newton.unwrap();
            // No cell is pressed to a fifth of its volume: all of the bulk modulus is shared in the end.
            assert!(newton.bulk_in_cells == 0.0 && newton.is_stable != Some(false));
            assert!(newton.is_stable.is_some() || poisson_ratio > 0.49, "{poisson_ratio}");
            moved.solver.iterations
        })
        .collect();
    let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
    assert!(*most <= 20 && *most <= least + 5, "{steps:?}");
}

/// A bar of 100 mm, held at its ends, of which one goes by so many mm.
fn bar(shape: CellShape, by_mm: f64) -> Equilibrium {
    let mesh = block(Vector::new(100.0, 10.0, 10.0), [20, 2, 2], shape);
    let ends = constraints(&mesh, |x| match x.x {
        x if x < 1e-9 => Some(Vector::zeros()),
        x if x > 99.9 => Some(Vector::x() * by_mm),
        _ => None,
    });
    rest(&mesh, neo_hookean(0.3), &ends, &Unobserved).unwrap()
}

#[test]
fn a_pulled_bar_rests_in_one_way_and_a_pressed_one_that_buckled_may_in_another() {
    for shape in [CellShape::Tet4, CellShape::Hex8] {
        let doubts = |by_mm: f64| {
            let moved = bar(shape, by_mm);
            assert!(moved.solver.newton.unwrap().indefinite_steps > 0, "{shape:?} {by_mm}");
            moved.warnings
        };
        assert!(doubts(100.0).is_empty(), "{shape:?}");
        let [doubt] = &doubts(-30.0)[..] else { panic!("{shape:?}: there is no one warning") };
        assert_eq!(doubt.code, "another-equilibrium");
        let share =
            doubt.numbers.iter().find(|(name, _)| *name == "pressed_energy_share").unwrap().1;
        assert!((0.5..=1.0).contains(&share), "{shape:?}: {share}");
    }
}

#[test]
fn pressures_take_even_tissue_without_a_free_ring_to_rest() {
    for poisson_ratio in [0.46, 0.4999] {
        let (mesh, held) = hard_block([20, 20, 4], 1.0, 0.0);
        let law = neo_hookean(poisson_ratio);
        let moved = rest_of(Elements::STABLE, &mesh, law, &held, &Unobserved).unwrap();
        assert!(least_det_f(&mesh, &moved.displacement) > 0.05);
    }
}

#[test]
fn hexahedra_and_wedges_bear_the_hard_block_too() {
    for shape in [CellShape::Hex8, CellShape::Wedge6] {
        for ring in [RING, 0.0] {
            let (tetrahedra, held) = hard_block([20, 20, 4], 1.0, ring);
            let mesh = block(Vector::new(100.0, 100.0, 20.0), [20, 20, 4], shape);
            assert_eq!(mesh.nodes, tetrahedra.nodes);
            let moved =
                rest_of(Elements::STABLE, &mesh, neo_hookean(0.46), &held, &Unobserved).unwrap();
            let newton = moved.solver.newton.unwrap();
            assert!(newton.least_det_f > 0.01, "{shape:?}: {}", newton.least_det_f);
        }
    }
}

/// The mean distance of the upper sides of two blocks, one of which has nodes in between.
fn apart_on_top(coarse: (&VolumeMesh, &[Vector]), fine: (&VolumeMesh, &[Vector])) -> f64 {
    let key = |x: &Vector| -> [i64; 3] { x.map(|v| (v * 1e6).round() as i64).into() };
    let of_place: std::collections::BTreeMap<[i64; 3], Vector> =
        (fine.0.nodes.iter()).zip(fine.1).map(|(x, u)| (key(x), *u)).collect();
    let top = coarse.0.nodes.iter().zip(coarse.1).filter(|(x, _)| x.z > 19.9);
    let apart: Vec<f64> = top.map(|(x, u)| (u - of_place[&key(x)]).norm()).collect();
    apart.iter().sum::<f64>() / apart.len() as f64
}

#[test]
fn pressures_come_nearer_to_the_finest_mesh_than_plain_tetrahedra_by_far() {
    let of = |cells: [usize; 3], elements: Elements| {
        // Both meshes hold what lies 30 mm or more from the patch.
        let (mesh, held) = hard_block(cells, 0.5, 29.0);
        let moved = rest_of(elements, &mesh, neo_hookean(0.49), &held, &Unobserved).unwrap();
        (mesh, moved.displacement)
    };
    let (fine, finest) = of([40, 40, 8], Elements::STABLE);
    let off = |cells: [usize; 3], elements: Elements| {
        let (coarse, moved) = of(cells, elements);
        apart_on_top((&coarse, &moved), (&fine, &finest))
    };
    let [plain, stable] = [Elements::PLAIN, Elements::STABLE].map(|own| off([20, 20, 4], own));
    assert!(plain > 3.0 * stable && stable < 0.2, "{plain} {stable}");
    let quadratic = off([20, 20, 4], Elements::QUADRATIC);
    assert!(quadratic < 0.7 * stable, "{stable} {quadratic}");
}

#[test]
fn the_same_block_has_the_same_bits_on_one_thread_and_on_two() {
    let (mesh, held) = hard_block([20, 20, 4], 0.5, RING);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| rest(&mesh, neo_hookean(0.46), &held, &Unobserved).unwrap().displacement)
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn a_search_that_is_stopped_ends() {
    let (mesh, held) = hard_block([10, 10, 2], 1.0, RING);
    let stopped = rest(&mesh, neo_hookean(0.46), &held, &StopsAfter::iterations(3));
    assert!(matches!(stopped, Err(ModelError::Solver(SolverError::Stopped))));
}

#[test]
fn bones_that_fold_a_cell_between_them_are_refused_before_anything_is_solved() {
    for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
        let mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 2, 1], shape);
        let pressed = |x: &Vector| {
            let is_top = x.z > 9.0;
            Some(Vector::new(0.0, 0.0, if is_top { -12.0 } else { 0.0 }))
        };
        let held = constraints(&mesh, pressed);
        let refused = rest(&mesh, neo_hookean(0.3), &held, &StopsAfter::iterations(0));
        let Err(ModelError::Folded { cell, det_f }) = refused else {
            panic!("{shape:?} is not refused")
        };
        assert!(cell < mesh.cells.len() && (det_f + 0.2).abs() < 1e-12, "{cell} {det_f}");
    }
}

#[test]
fn a_law_that_collapses_is_reported_where_it_came_to_a_standstill() {
    let (lambda, mu) = lame(0.46);
    let law = Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu });
    let (mesh, held) = hard_block([20, 20, 4], 1.0, RING);
    let Err(ModelError::Standstill { made, least_det_f, .. }) =
        rest(&mesh, law, &held, &Unobserved)
    else {
        panic!("it is no standstill")
    };
    assert!((0.05..1.0).contains(&made) && least_det_f > 0.0, "{made} {least_det_f}");
}

#[test]
fn a_load_bends_tissue_as_linear_elements_say_where_it_is_small() {
    let mesh = block(Vector::new(20.0, 6.0, 6.0), [10, 3, 3], CellShape::Tet4);
    let case = Case { fixed: vec![set("x_min")], ..case_of(mesh, material(15.0, 0.3)) };
    let plan = Plan {
        loads: vec![Load::Gravity { acceleration: Vector::new(0.0, 0.0, -1e-6) }],
        ..Plan::default()
    };
    let linear =
        Settings { element: ElementChoice::Plain, relative_residual: 1e-12, ..Settings::default() };
    let [straight, bent] =
        [linear, nonlinear_of(ElementChoice::Plain)].map(|settings| solve(&case, &plan, &settings));
    let most = straight.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
    assert!(most > 0.0 && distance(&straight, &bent) < 1e-3 * most);
}
