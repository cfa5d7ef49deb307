//! Elements that do not lock, against closed forms and published numbers: docs/verification.md#v4,
//! docs/verification.md#v7, docs/verification.md#v29 and more.

use std::collections::BTreeMap;

use mechanics::mesh::sample::{ThickSphere, block, thick_sphere_octant};
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::prediction::{
    Case, ElementChoice, Load, Method, Plan, Prediction, Prescribed, RegionNames, Scene, Settings,
    Sliding, SlidingNormal,
};

use crate::scenes::{case_of, constraint, exact, join, material, set, solve};

fn with(element: ElementChoice) -> Settings {
    Settings { element, ..Settings::default() }
}

/// Cook's membrane (V.4): n x n cells of one layer between sliding walls, a shear force on its right side.
/// The vertical displacement of its upper right corner in mm.
fn cook(n: usize, [young_modulus, nu, force]: [f64; 3], element: ElementChoice) -> f64 {
    let mut mesh = block(Vector::new(48.0, 1.0, 1.0), [n, n, 1], CellShape::Tet4);
    for node in &mut mesh.nodes {
        let along = node.x / 48.0;
        node.y = 44.0 * along + node.y * (44.0 - 28.0 * along);
    }
    let flat = Prescribed::Uniform { nodes: set("z_min"), displacement: [None, None, Some(0.0)] };
    let lid = Prescribed::Uniform { nodes: set("z_max"), displacement: [None, None, Some(0.0)] };
    let plan = Plan {
        prescribed: vec![constraint("x_min", [Some(0.0); 3]), flat, lid],
        loads: vec![Load::Traction {
            faces: set("x_max"),
            traction: Vector::new(0.0, force / 16.0, 0.0),
        }],
        ..Plan::default()
    };
    let case = case_of(mesh, material(young_modulus, nu));
    // Rounding stops the displacement form at about 1e-8 when nu is 0.4999 and forces act.
    let settings = Settings { relative_residual: 1e-7, ..with(element) };
    let corner = case.volume.nodes.iter().position(|x| (x.x, x.y, x.z) == (48.0, 60.0, 0.0));
    solve(&case, &plan, &settings).displacement[corner.unwrap()].y
}

const COOK_B: [f64; 3] = [240.565, 0.4999, 100.0];
const COOK_C: [f64; 3] = [1.12499998125, 0.499999975, 1.0];
const COOK_E: [f64; 3] = [15.0, 0.46, 1.0];

#[test]
fn elements_bend_cook_s_membrane_as_published() {
    let (plain, stabilised, quadratic) =
        (ElementChoice::Plain, ElementChoice::Stabilised, ElementChoice::Quadratic);
    let table = [
        (COOK_B, plain, [2.167, 2.208]),
        (COOK_B, stabilised, [6.336, 7.383]),
        (COOK_B, quadratic, [7.379, 7.795]),
        (COOK_C, stabilised, [13.547, 15.786]),
        (COOK_E, plain, [0.698, 0.998]),
        (COOK_E, stabilised, [1.075, 1.246]),
        (COOK_E, quadratic, [1.308, 1.336]),
    ];
    for (constants, element, expected) in table {
        for (n, expected) in [8, 16].into_iter().zip(expected) {
            let found = cook(n, constants, element);
            println!("{constants:?} {element:?} {n}: {found:.4} / {expected}");
            let error = (found / expected - 1.0).abs();
            // The published numbers are of triangles; a layer of tetrahedra has its pressure vary across.
            let tolerance = if element == stabilised && n == 8 { 0.04 } else { 0.03 };
            assert!(error < tolerance, "{constants:?} {element:?} {n}: {found:.4}, not {expected}");
        }
    }
}

#[test]
fn elements_that_do_not_lock_come_to_the_limit_of_cook_s_membrane() {
    for (constants, limit) in
        [([0.9375, 0.25, 1.0], 25.164), (COOK_B, 8.075), ([250.0, 0.4999, 100.0], 7.769)]
    {
        let stabilised = cook(32, constants, ElementChoice::Stabilised) / limit - 1.0;
        let quadratic = cook(32, constants, ElementChoice::Quadratic) / limit - 1.0;
        println!("{constants:?}: {stabilised:.4} {quadratic:.4}");
        assert!(stabilised.abs() < 0.04 && quadratic.abs() < 0.02, "{constants:?}");
    }
}

/// The thick sphere of V.7 at cells of about 3 mm: mean radial displacement of the outer surface.
fn outer_displacement(nu: f64, element: ElementChoice) -> f64 {
    outer_displacement_of(CellShape::Tet4, nu, 2.0, &with(element))
}

/// The same for an inner surface that moves outwards by so many mm.
fn outer_displacement_of(shape: CellShape, nu: f64, by: f64, settings: &Settings) -> f64 {
    let sphere =
        ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 4, cells_along: 16 };
    let mut mesh = thick_sphere_octant(sphere, shape);
    mesh.node_vectors
        .insert("radial".to_owned(), mesh.nodes.iter().map(|x| x.normalize() * by).collect());
    let inner = Prescribed::FromArray { nodes: set("inner"), array: "radial".to_owned() };
    let symmetry = [
        constraint("x_min", [Some(0.0), None, None]),
        constraint("y_min", [None, Some(0.0), None]),
        constraint("z_min", [None, None, Some(0.0)]),
    ];
    let plan = Plan { prescribed: [vec![inner], symmetry.to_vec()].concat(), ..Plan::default() };
    let case = case_of(mesh, material(15.0, nu));
    let displacement = solve(&case, &plan, settings).displacement;
    let outer = case.volume.node_set("outer").unwrap();
    let radial = |&node: &u32| {
        displacement[node as usize].dot(&case.volume.nodes[node as usize].normalize())
    };
    outer.iter().map(radial).sum::<f64>() / outer.len() as f64
}

#[test]
fn a_thick_sphere_of_stabilised_tetrahedra_moves_as_the_closed_form_up_to_nu_0_4999() {
    let expected =
        [(0.0, 1.93133), (0.3, 1.65441), (0.46, 1.44919), (0.499, 1.39045), (0.4999, 1.38904)];
    for (nu, exact) in expected {
        let found = outer_displacement(nu, ElementChoice::Stabilised);
        println!("nu {nu}: {found} / {exact}");
        assert!((found / exact - 1.0).abs() < 0.005, "nu {nu}: {found} instead of {exact}");
    }
}

/// Tissue that hardly changes its volume: V.8. Hexahedra do not come to rest at 5 mm and say so.
#[test]
fn a_thick_sphere_at_finite_strain_keeps_its_volume() {
    for (shape, element, by, exact) in [
        (CellShape::Tet4, ElementChoice::Stabilised, 2.0, 1.40799),
        (CellShape::Tet4, ElementChoice::Stabilised, 5.0, 3.58785),
        (CellShape::Hex8, ElementChoice::Auto, 2.0, 1.40799),
    ] {
        let settings = Settings { method: Method::FemNonlinear, ..with(element) };
        let found = outer_displacement_of(shape, 0.4999, by, &settings);
        println!("{shape:?} {by} mm: {found} / {exact}");
        assert!((found / exact - 1.0).abs() < 0.0005, "{shape:?} {by}: {found} {exact}");
    }
}

/// Straight edges make the inner surface a polyhedron whose edge middles move by the mean of their ends.
#[test]
fn a_thick_sphere_of_quadratic_tetrahedra_moves_as_the_closed_form() {
    for (nu, exact) in [(0.3, 1.65441), (0.499, 1.39045)] {
        let found = outer_displacement(nu, ElementChoice::Quadratic);
        println!("nu {nu}: {found} / {exact}");
        assert!((found / exact - 1.0).abs() < 0.005, "nu {nu}: {found} instead of {exact}");
    }
}

/// The slab of V.29 with cells of h mm and nu.
pub fn slab(h: f64, nu: f64) -> (Case, Plan) {
    let cells = [60.0, 30.0, 12.0].map(|size: f64| (size / h) as usize);
    let mut mesh = block(Vector::new(60.0, 30.0, 12.0), cells, CellShape::Tet4);
    mesh.nodes.iter_mut().for_each(|x| x.x -= 30.0);
    let select = |mesh: &VolumeMesh, inside: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        let nodes = mesh.nodes.iter().enumerate().filter(|(_, x)| inside(x));
        nodes.map(|(node, _)| node as u32).collect()
    };
    let patch = select(&mesh, &|x| x.z < 1e-9 && x.x.abs() < 12.1 && x.y < 12.1);
    let far = select(&mesh, &|x| x.z < 1e-9 && (x.x.abs() > 23.9 || x.y > 23.9));
    mesh.node_sets.insert("patch".to_owned(), patch);
    mesh.node_sets.insert("far".to_owned(), far);
    let plan = Plan {
        prescribed: vec![
            constraint("patch", [Some(4.0), Some(0.0), Some(8.0)]),
            constraint("far", [Some(0.0); 3]),
            constraint("y_min", [None, Some(0.0), None]),
        ],
        ..Plan::default()
    };
    (case_of(mesh, material(15.0, nu)), plan)
}

/// Displacements at the 45 skin points of V.29, in a fixed order.
pub fn at_skin_points(case: &Case, answer: &Prediction) -> Vec<Vector> {
    let mut found = BTreeMap::new();
    for (x, u) in case.volume.nodes.iter().zip(&answer.displacement) {
        let on_grid = |c: f64| (c / 6.0 - (c / 6.0).round()).abs() < 1e-9;
        if (x.z - 12.0).abs() < 1e-9
            && on_grid(x.x)
            && on_grid(x.y)
            && x.x.abs() < 24.1
            && x.y < 24.1
        {
            found.insert([(x.x / 6.0).round() as i32, (x.y / 6.0).round() as i32], *u);
        }
    }
    found.into_values().collect()
}

fn slab_at(h: f64, nu: f64, element: ElementChoice) -> Vec<Vector> {
    let (case, plan) = slab(h, nu);
    at_skin_points(&case, &solve(&case, &plan, &with(element)))
}

/// Against quadratic cells of 3 mm, whose own error is at most 0.019 mm (V.29): the tolerance is 20 % and that.
#[test]
fn elements_err_on_the_slab_as_published() {
    for (nu, plain, stabilised, quadratic) in
        [(0.46, 0.233, 0.073, 0.052), (0.499, 1.071, 0.073, 0.100)]
    {
        let reference = slab_at(3.0, nu, ElementChoice::Quadratic);
        assert_eq!(reference.len(), 45);
        for (h, element, expected) in [
            (3.0, ElementChoice::Plain, plain),
            (3.0, ElementChoice::Stabilised, stabilised),
            (6.0, ElementChoice::Quadratic, quadratic),
        ] {
            let found = slab_at(h, nu, element);
            let error =
                found.iter().zip(&reference).map(|(a, b)| (a - b).norm()).sum::<f64>() / 45.0;
            println!("nu {nu} {element:?} {h}: {error:.4} / {expected}");
            assert!((error - expected).abs() < 0.2 * expected + 0.02, "{nu} {element:?}: {error}");
        }
    }
}

/// Neo-Hookean tissue against linear one on the skin of V.29, computed elsewhere by quadratic tetrahedra of 6 mm.
#[test]
fn large_movements_of_the_slab_differ_from_linear_ones_as_published() {
    for (share, expected) in [(0.25, 0.048), (0.5, 0.186), (1.0, 0.697), (1.5, 1.464)] {
        let (case, mut plan) = slab(3.0, 0.46);
        plan.prescribed[0] = constraint("patch", [Some(4.0 * share), Some(0.0), Some(8.0 * share)]);
        let element = ElementChoice::Stabilised;
        let nonlinear = Settings { method: Method::FemNonlinear, ..with(element) };
        let [one, other] = [nonlinear, with(element)]
            .map(|settings| at_skin_points(&case, &solve(&case, &plan, &settings)));
        let apart = one.iter().zip(&other).map(|(a, b)| (a - b).norm()).sum::<f64>() / 45.0;
        println!("{share}: {apart:.4} / {expected}");
        assert!((apart / expected - 1.0).abs() < 0.06, "{share}: {apart}");
    }
}

/// The skin of V.29 under quadratic cells of 2 mm, computed elsewhere with the same cells.
#[test]
fn the_skin_of_the_slab_moves_as_published_for_every_poisson_ratio() {
    for (nu, expected) in
        [(0.3, 4.51239), (0.43, 4.28518), (0.46, 4.22975), (0.49, 4.17612), (0.499, 4.16587)]
    {
        let skin = slab_at(2.0, nu, ElementChoice::Quadratic);
        let mean = skin.iter().map(Vector::norm).sum::<f64>() / skin.len() as f64;
        println!("nu {nu}: {mean:.5} / {expected}");
        // Found 0.0003 to 0.0010 mm less: how the middles of edges between held and free nodes are held differs.
        assert!((mean - expected).abs() < 0.002, "nu {nu}: {mean} instead of {expected}");
    }
}

#[test]
fn iterations_hardly_depend_on_how_incompressible_the_tissue_is() {
    let iterations = |nu: f64| {
        let (case, plan) = slab(3.0, nu);
        let found = solve(&case, &plan, &with(ElementChoice::Stabilised));
        assert_eq!(
            (found.solver.method, found.elements[0].as_str()),
            ("conjugate_residual", "tet4 stabilised")
        );
        found.solver.iterations as f64
    };
    let moderate = iterations(0.46);
    for nu in [0.3, 0.499, 0.4999] {
        println!("{moderate} {nu}: {}", iterations(nu));
    }
    for nu in [0.499, 0.4999] {
        let found = iterations(nu);
        assert!(found <= 1.3 * moderate, "nu {nu}: {found} iterations, {moderate} at 0.46");
    }
}

/// A block of two layers, 260 times as stiff above as below.
fn layers(shape: CellShape) -> (Case, Plan) {
    let mut mesh = block(Vector::new(20.0, 20.0, 12.0), [8, 8, 6], shape);
    let height = |cell: usize| mesh.corners(cell).map(|x| x.z).fold(0.0, f64::max);
    let labels = (0..mesh.cells.len()).map(|cell| i64::from(height(cell) > 8.1)).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    let mut case = case_of(mesh, material(3.0, 0.499));
    let names = BTreeMap::from([(1, "stiff".to_owned())]);
    case.regions = Some(RegionNames { array: "layer".to_owned(), names });
    case.materials.insert("stiff".to_owned(), material(790.0, 0.43));
    case.fixed.push(set("x_min"));
    let plan = Plan {
        prescribed: vec![constraint("x_max", [Some(1.0), None, Some(2.0)])],
        ..Plan::default()
    };
    (case, plan)
}

#[test]
fn pressure_jumps_between_layers_as_quadratic_tetrahedra_have_it() {
    let (case, plan) = layers(CellShape::Tet4);
    let found = solve(&case, &plan, &with(ElementChoice::Stabilised)).displacement;
    let fine = solve(&case, &plan, &with(ElementChoice::Quadratic)).displacement;
    let plain = solve(&case, &plan, &with(ElementChoice::Plain)).displacement;
    let difference = |other: &[Vector]| {
        let sum: f64 = other.iter().zip(&fine).map(|(a, b)| (a - b).norm()).sum();
        sum / fine.len() as f64
    };
    println!("stabilised {:.4}, plain {:.4}", difference(&found), difference(&plain));
    assert!(difference(&found) < 0.5 * difference(&plain));
}

#[test]
fn reactions_balance_with_each_other_and_with_loads() {
    for element in [ElementChoice::Stabilised, ElementChoice::Quadratic] {
        let (case, plan) = layers(CellShape::Tet4);
        let settings = Settings { element, relative_residual: 1e-12, ..Settings::default() };
        let reactions = solve(&case, &plan, &settings).reactions;
        let (fixed, pulled) = (reactions["fixed"], reactions["prescribed"]);
        assert!((fixed + pulled).norm() < 1e-9 * fixed.norm(), "{element:?}: {fixed} {pulled}");

        let mut case = case_of(
            block(Vector::new(4.0, 5.0, 6.0), [2, 2, 3], CellShape::Tet4),
            material(15.0, 0.3),
        );
        case.fixed.push(set("z_min"));
        for (load, total) in [
            (
                Load::Traction { faces: set("z_max"), traction: Vector::new(1.0, 2.0, 3.0) },
                Vector::new(20.0, 40.0, 60.0),
            ),
            (Load::Pressure { faces: set("x_max"), pressure: 2.0 }, Vector::new(-60.0, 0.0, 0.0)),
            (
                Load::Gravity { acceleration: Vector::new(0.0, 0.0, -0.01) },
                Vector::new(0.0, 0.0, -1.2),
            ),
            (
                Load::Force { nodes: set("z_max"), force: Vector::new(0.0, 1.0, 0.0) },
                Vector::new(0.0, 9.0, 0.0),
            ),
        ] {
            let plan = Plan { loads: vec![load.clone()], ..Plan::default() };
            let reaction = solve(&case, &plan, &settings).reactions["fixed"];
            assert!(
                (reaction + total).norm() < 1e-9 * total.norm(),
                "{element:?} {load:?}: {reaction}"
            );
        }
    }
}

/// Pressed between oblique sliding walls the field is affine, which every element has exactly.
#[test]
fn tetrahedra_slide_along_oblique_walls() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    for element in [ElementChoice::Stabilised, ElementChoice::Quadratic] {
        let mut mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 3, 2], CellShape::Tet4);
        mesh.nodes.iter_mut().for_each(|x| *x = turn * *x);
        let field =
            |x: &Vector| turn * (turn.inverse() * x).component_mul(&Vector::new(0.0, 0.0, -0.05));
        mesh.node_vectors.insert("lid".to_owned(), mesh.nodes.iter().map(field).collect());
        let mut case = case_of(mesh, material(15.0, 0.46));
        for wall in ["x_min", "x_max", "y_min", "y_max", "z_min"] {
            case.sliding.push(Sliding {
                nodes: set(wall),
                normal: SlidingNormal::Surface,
                segment: None,
            });
        }
        let lid = Prescribed::FromArray { nodes: set("z_max"), array: "lid".to_owned() };
        let plan = Plan { prescribed: vec![lid], ..Plan::default() };
        let answer = solve(&case, &plan, &Settings { element, ..exact() });
        for (x, u) in case.volume.nodes.iter().zip(&answer.displacement) {
            assert!((u - field(x)).norm() < 1e-10, "{element:?}: {u} at {x}");
        }
        let pressure = -answer.reactions["prescribed"].dot(&(turn * Vector::z())) / 100.0;
        assert!((pressure / 0.05 / 69.3493 - 1.0).abs() < 1e-5, "{element:?}: {pressure}");
    }
}

#[test]
fn quadratic_elements_are_refused_on_meshes_with_other_cells() {
    let (case, plan) = layers(CellShape::Wedge6);
    let errors = Scene::new(&case, &plan, &with(ElementChoice::Quadratic)).err().unwrap();
    assert_eq!(
        (errors.0[0].code.name(), errors.0[0].pointer.as_str()),
        ("method-not-available", "/spec/element")
    );
    assert!(errors.0[0].detail.contains("wedge6"));
}

#[test]
fn a_stabilised_system_larger_than_the_memory_is_refused() {
    let (case, plan) = layers(CellShape::Tet4);
    let scene =
        Scene::new(&case, &plan, &Settings { memory_mb: 1.0, ..Settings::default() }).unwrap();
    let refused =
        mechanics::prediction::predict(&scene, &mechanics::progress::Unobserved).unwrap_err();
    assert!(
        matches!(refused, mechanics::prediction::ModelError::Solver(mechanics::prediction::SolverError::OverBudget { needed_mb, .. }) if needed_mb > 1.0)
    );
}

#[test]
fn a_residual_nobody_can_reach_ends_with_the_history() {
    let (case, plan) = layers(CellShape::Tet4);
    let settings = Settings { relative_residual: 1e-30, ..Settings::default() };
    let scene = Scene::new(&case, &plan, &settings).unwrap();
    let failed =
        mechanics::prediction::predict(&scene, &mechanics::progress::Unobserved).unwrap_err();
    assert!(
        matches!(failed, mechanics::prediction::ModelError::Solver(mechanics::prediction::SolverError::NotConverged { history, .. }) if !history.is_empty())
    );
}

#[test]
fn tetrahedra_between_hexahedra_are_solved_at_finite_strain() {
    // The last free nodes have no pressure, and no node of a tetrahedron is held.
    let mut mesh = VolumeMesh::default();
    for (level, shape) in
        [CellShape::Hex8, CellShape::Tet4, CellShape::Hex8].into_iter().enumerate()
    {
        let mut above = block(Vector::repeat(10.0), [2, 2, 2], shape);
        above.nodes.iter_mut().for_each(|x| x.z += 10.0 * level as f64);
        join(&mut mesh, &above, |_| true);
    }
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
