//! Stress and strain of cells: affine states, growth, muscles, columns, balance of every element, and finite strain.

use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::point::Point;
use mechanics::mesh::jacobian::signed_volume;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::Dilatation;
use mechanics::model::fem::inner_stress::InnerStress;
use mechanics::model::fem::law_states::at_second_order;
use mechanics::model::fem::strain::gradient_at_centre;
use mechanics::prediction::{
    Activation, Case, CellState, ElementChoice, FibreDirection, Growth, Method, MethodKind, Muscle,
    MuscleCourse, Plan, Prediction, Prescribed, Scene, Settings, linear_strain, node_states,
};
use mechanics::study::methods;
use nalgebra::Matrix3;

use super::contact::{PRESSING, bar, pushed, unilateral};
use super::growth::between_walls;
use crate::material::anisotropy::{ELEMENTS, MUSCLE, fibred, gradients, tight};
use crate::material::hyperelastic::rows;
use crate::scenes::{case_of, constraint, exact, material, on_the_boundary, set, solve};

const SIZE: Vector = Vector::new(6.0, 4.0, 2.0);
const SIDES: [&str; 6] = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];

fn asked(element: ElementChoice) -> Settings {
    Settings { element, states: true, ..exact() }
}

/// A block whose inner nodes are moved by up to a tenth of a mm, the same at every run.
fn distorted(shape: CellShape) -> VolumeMesh {
    let mut mesh = block(SIZE, [6, 4, 3], shape);
    for (number, node) in mesh.nodes.iter_mut().enumerate() {
        if (0..3).all(|k| node[k] > 0.1 && node[k] < SIZE[k] - 0.1) {
            let wave = |k: f64| (k * number as f64).sin() * 0.1;
            *node += Vector::new(wave(1.7), wave(2.3), wave(3.1));
        }
    }
    mesh
}

/// Every cell and node has a stress and a strain.
fn assert_uniform(
    answer: &Prediction,
    mesh: &VolumeMesh,
    expected: &CellState,
    most: f64,
    what: &str,
) {
    assert_eq!(answer.states.cells.len(), mesh.cells.len(), "{what}");
    let nodes = node_states(mesh, &answer.states.cells);
    assert_eq!(nodes.len(), mesh.nodes.len(), "{what}");
    for state in answer.states.cells.iter().chain(&nodes) {
        let off = (state.stress - expected.stress).amax();
        assert!(off < most, "{what}: {} for {}", state.stress, expected.stress);
        let off = (state.strain - expected.strain).amax();
        assert!(off < 1e-6, "{what}: {} for {}", state.strain, expected.strain);
    }
}

fn affine() -> Matrix3<f64> {
    Matrix3::new(1.0, 2.0, -1.0, 3.0, -1.0, 2.0, -1.0, 1.0, 2.0) * 1e-3
}

fn moved_by(mesh: &mut VolumeMesh, gradient: Matrix3<f64>) -> Plan {
    on_the_boundary(mesh, |x| gradient * x)
}

fn lame(nu: f64) -> (f64, f64) {
    let tissue = material(15.0, nu);
    (tissue.lambda(), tissue.shear_modulus())
}

#[test]
fn a_uniform_strain_has_the_stress_of_hooke_in_every_element() {
    let strain = (affine() + affine().transpose()) * 0.5;
    for (shape, element) in ELEMENTS {
        for nu in [0.0, 0.3, 0.46, 0.4999] {
            let mut mesh = distorted(shape);
            let plan = moved_by(&mut mesh, affine());
            let case = case_of(mesh, material(15.0, nu));
            let answer = solve(&case, &plan, &asked(element));
            let (lambda, mu) = lame(nu);
            let volume = Matrix3::from_diagonal_element(lambda * strain.trace());
            let expected = CellState { stress: strain * (2.0 * mu) + volume, strain };
            let most = if nu > 0.499 { 1e-5 } else { 1e-9 };
            let what = format!("{shape:?} {element:?} nu {nu}");
            assert_uniform(&answer, &case.volume, &expected, most, &what);
            assert!(!answer.states.is_green);
        }
    }
}

#[test]
fn tissue_pressed_from_all_sides_has_a_pressure_and_no_other_stress() {
    for (shape, element) in ELEMENTS {
        for nu in [0.3, 0.49, 0.4999] {
            let mut mesh = distorted(shape);
            let plan = moved_by(&mut mesh, Matrix3::from_diagonal_element(-1e-3));
            let case = case_of(mesh, material(15.0, nu));
            let answer = solve(&case, &plan, &asked(element));
            // p = -3 K eps, K = E / (3 (1 - 2 nu)).
            let pressure = 15.0 / (1.0 - 2.0 * nu) * 1e-3;
            for state in &answer.states.cells {
                let off = (state.pressure() / pressure - 1.0).abs();
                assert!(off < 1e-7, "{shape:?} {element:?} nu {nu}: {}", state.pressure());
                assert!(state.von_mises() < 1e-7 * pressure, "{}", state.von_mises());
            }
        }
    }
}

#[test]
fn tissue_with_fibres_has_the_stress_of_its_tensor() {
    let along = Vector::new(1.0, 2.0, -0.5).normalize();
    let tissue = fibred(MUSCLE).unwrap();
    let strain = (affine() + affine().transpose()) * 0.5;
    let expected = CellState { stress: tissue.tensor(&along).stress(&affine()), strain };
    for (shape, element) in ELEMENTS {
        let mut mesh = distorted(shape);
        let plan = moved_by(&mut mesh, affine());
        let mut case = case_of(mesh, tissue);
        case.fibres.insert("*".to_owned(), FibreDirection::Uniform(along));
        let settings = Settings { element, states: true, ..tight() };
        let answer = solve(&case, &plan, &settings);
        assert_uniform(&answer, &case.volume, &expected, 1e-5, &format!("{shape:?} {element:?}"));
    }
}

/// Holds the upper side of a block at a height in mm over where it lies at rest.
fn top_at(height: f64) -> Prescribed {
    constraint("z_max", [None, None, Some(height)])
}

#[test]
fn growth_that_is_not_allowed_is_stress_and_growth_that_is_none() {
    let growth = |change| vec![Growth { region: "tissue".to_owned(), volume_change: change }];
    for (shape, element) in ELEMENTS {
        let what = format!("{shape:?} {element:?}");
        let case = case_of(distorted(shape), material(15.0, 0.46));
        // g .9 confined: 6.47074 kPa of tension; g .98 held at its sides: .186434 kPa along them (docs/verification.md#growth).
        let plan = Plan {
            prescribed: between_walls(Some(top_at(0.0))),
            growth: growth(-0.1),
            ..Plan::default()
        };
        let answer = solve(&case, &plan, &asked(element));
        let stress = Matrix3::from_diagonal_element(6.470_74);
        let confined = CellState { stress, strain: Matrix3::zeros() };
        assert_uniform(&answer, &case.volume, &confined, 2e-5, &what);
        let plan =
            Plan { prescribed: between_walls(None), growth: growth(-0.02), ..Plan::default() };
        let answer = solve(&case, &plan, &asked(element));
        let stress = Matrix3::from_diagonal(&Vector::new(0.186_434, 0.186_434, 0.0));
        let strain = Matrix3::from_diagonal(&Vector::new(0.0, 0.0, -0.018_146_2));
        assert_uniform(&answer, &case.volume, &CellState { stress, strain }, 1e-6, &what);
        // Nothing hinders the third: planes of symmetry.
        let free = ["x_min", "y_min", "z_min"].into_iter().enumerate().map(|(axis, name)| {
            constraint(name, std::array::from_fn(|k| (k == axis).then_some(0.0)))
        });
        let plan = Plan { prescribed: free.collect(), growth: growth(-0.1), ..Plan::default() };
        let answer = solve(&case, &plan, &asked(element));
        let strain = Matrix3::from_diagonal_element(linear_strain(-0.1));
        let free = CellState { stress: Matrix3::zeros(), strain };
        assert_uniform(&answer, &case.volume, &free, 1e-8, &what);
    }
}

#[test]
fn a_muscle_that_cannot_shorten_is_stressed_along_its_fibres_alone() {
    let along = Vector::new(-3.0, 0.0, 4.0);
    for (shape, element) in ELEMENTS {
        let course = MuscleCourse::Region {
            region: "tissue".to_owned(),
            fibres: Some(FibreDirection::Uniform(along)),
        };
        let case = Case {
            fixed: SIDES.map(set).to_vec(),
            muscles: vec![Muscle {
                name: "biceps".to_owned(),
                course,
                tissue: None,
                stiffening: None,
            }],
            ..case_of(distorted(shape), material(15.0, 0.46))
        };
        let activations = vec![Activation { muscle: "biceps".to_owned(), stress: 10.0 }];
        let plan = Plan { activations, ..Plan::default() };
        let answer = solve(&case, &plan, &asked(element));
        let unit = along.normalize();
        let stress = unit * unit.transpose() * 10.0;
        let expected = CellState { stress, strain: Matrix3::zeros() };
        assert_uniform(&answer, &case.volume, &expected, 1e-7, &format!("{shape:?} {element:?}"));
    }
}

#[test]
fn a_column_between_walls_is_pressed_by_the_closed_form() {
    // Half a millimetre of ten (docs/verification.md#v24).
    for (nu, along) in [(0.3, -1.009_615), (0.46, -3.467_465), (0.49, -12.835_570)] {
        for (shape, element) in ELEMENTS {
            let mesh = block(Vector::repeat(10.0), [3, 3, 3], shape);
            let case = case_of(mesh, material(15.0, nu));
            let plan = Plan { prescribed: between_walls(Some(top_at(-0.5))), ..Plan::default() };
            let answer = solve(&case, &plan, &asked(element));
            for state in &answer.states.cells {
                let found = state.stress[(2, 2)];
                assert!((found - along).abs() < 1e-6, "{shape:?} {element:?} nu {nu}: {found}");
                let across = along * nu / (1.0 - nu);
                assert!((state.stress[(0, 0)] - across).abs() < 1e-5, "{shape:?} {element:?}");
            }
        }
    }
}

/// A jaw lifts the middle of the bottom of a slab: nothing is uniform there.
fn lifted(by_mm: f64, shape: CellShape, tissue: LinearElastic) -> (Case, Plan) {
    let mut mesh = block(Vector::new(30.0, 30.0, 10.0), [8, 8, 3], shape);
    let bottom = mesh.node_sets["z_min"].clone();
    let is_jaw =
        |&node: &u32| (mesh.nodes[node as usize] - Vector::new(15.0, 15.0, 0.0)).amax() < 6.1;
    let (jaw, rest): (Vec<u32>, Vec<u32>) = bottom.into_iter().partition(is_jaw);
    mesh.node_sets.insert("jaw".to_owned(), jaw);
    mesh.node_sets.insert("rest".to_owned(), rest);
    let case = Case { fixed: vec![set("rest")], ..case_of(mesh, tissue) };
    let up = constraint("jaw", [Some(0.3 * by_mm), Some(0.0), Some(by_mm)]);
    (case, Plan { prescribed: vec![up], ..Plan::default() })
}

/// The force on each node that stresses exert, by their means: sum V J sigma F^-T grad N at finite strain, sum V sigma grad N.
fn forces(case: &Case, answer: &Prediction) -> Vec<Vector> {
    let mesh = &*case.volume;
    let mut forces = vec![Vector::zeros(); mesh.nodes.len()];
    for (cell, state) in answer.states.cells.iter().enumerate() {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        let (volume, gradients) = gradients(&[corners[0], corners[1], corners[2], corners[3]]);
        let f = Matrix3::identity() + gradient_at_centre(mesh, &answer.displacement, cell);
        let first = match answer.states.is_green {
            true => state.stress * f.try_inverse().unwrap().transpose() * f.determinant(),
            false => state.stress,
        };
        for (&node, gradient) in mesh.cells.nodes(cell).iter().zip(&gradients) {
            forces[node as usize] += first * gradient * volume;
        }
    }
    forces
}

#[test]
fn the_stresses_of_tetrahedra_balance_at_every_node_with_their_pressures() {
    for method in [Method::FemLinear, Method::FemNonlinear] {
        for element in [ElementChoice::Plain, ElementChoice::Stabilised] {
            for nu in [0.3, 0.49] {
                let (case, plan) = lifted(1.0, CellShape::Tet4, material(15.0, nu));
                let relative_residual = 1e-10;
                let method = method.clone();
                let what = format!("{method:?} {element:?} nu {nu}");
                let settings = Settings {
                    method,
                    element,
                    states: true,
                    relative_residual,
                    ..Settings::default()
                };
                let answer = solve(&case, &plan, &settings);
                let forces = forces(&case, &answer);
                let jaw = case.volume.node_set("jaw").unwrap();
                let found: Vector = jaw.iter().map(|&node| forces[node as usize]).sum();
                let mut exerted = answer.condition_reactions.iter();
                let of_plan = exerted.find(|one| one.pointer.starts_with("/plan")).unwrap();
                let reaction = of_plan.force;
                assert!(
                    (found - reaction).norm() < 1e-6 * reaction.norm(),
                    "{what}: {found} {reaction}"
                );
                let bottom = case.volume.node_set("z_min").unwrap();
                let free = (0..forces.len()).filter(|node| !bottom.contains(&(*node as u32)));
                let left = free.map(|node| forces[node].norm()).fold(0.0, f64::max);
                assert!(left < 1e-6 * reaction.norm(), "{what}: {left}");
            }
        }
    }
}

/// The mean of a stress over a body at rest is that of what is exerted on it: int sigma dV = sum f x (x) / V, by nodes.
#[test]
fn the_mean_stress_of_a_body_is_that_of_the_forces_that_hold_it() {
    for (shape, element) in ELEMENTS {
        let (case, plan) = lifted(0.5, shape, material(15.0, 0.46));
        let answer = solve(&case, &plan, &asked(element));
        let mesh = &case.volume;
        let volume = |cell: usize| {
            let corners: Vec<Vector> = mesh.corners(cell).collect();
            signed_volume(mesh.cells.shape(cell), &corners)
        };
        let states = answer.states.cells.iter().enumerate();
        let sum: Matrix3<f64> = states.map(|(cell, state)| state.stress * volume(cell)).sum();
        // What holds the bottom acts at z = 0: the third column of sum f x^T is zero.
        assert!(sum.column(2).norm() < 1e-6 * sum.norm(), "{shape:?} {element:?}: {sum}");
        assert!(sum.norm() > 1.0, "{shape:?} {element:?}: {sum}");
    }
}

#[test]
fn simple_shear_at_finite_strain_has_the_printed_stress_whatever_the_law() {
    let gamma = 0.6;
    for row in rows() {
        let tissue = LinearElastic::of_law(row.law, 1.0).unwrap();
        for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
            for element in [ElementChoice::Plain, ElementChoice::Auto] {
                let mut mesh = block(Vector::repeat(9.0), [3, 3, 3], shape);
                let plan = on_the_boundary(&mut mesh, |x| Vector::x() * (gamma * x.y));
                let case = case_of(mesh, tissue);
                let settings = Settings {
                    method: Method::FemNonlinear,
                    element,
                    states: true,
                    relative_residual: 1e-10,
                    ..Settings::default()
                };
                let answer = solve(&case, &plan, &settings);
                let [s12, s11, s22, s33] = row.shear[..] else { panic!("{}", row.name) };
                let stress = Matrix3::new(s11, s12, 0.0, s12, s22, 0.0, 0.0, 0.0, s33);
                let half = gamma / 2.0;
                let strain = Matrix3::new(0.0, half, 0.0, half, gamma * half, 0.0, 0.0, 0.0, 0.0);
                let what = format!("{} {shape:?} {element:?}", row.name);
                assert_uniform(&answer, &case.volume, &CellState { stress, strain }, 2e-5, &what);
                assert!(answer.states.is_green);
            }
        }
    }
}

#[test]
fn an_answer_to_second_order_has_the_stress_of_its_law_at_its_displacement() {
    let gradient = affine() * 60.0;
    let f = Matrix3::identity() + gradient;
    let tissue = material(15.0, 0.46);
    let point = Point::new(&tissue.hyperelastic().law, None, f);
    let expected = point.stress() * f.transpose() / f.determinant();
    let (lambda, _) = lame(0.46);
    for (shape, dilatation) in [
        (CellShape::Tet4, (|_| Dilatation::Pointwise) as fn(CellShape) -> Dilatation),
        (CellShape::Hex8, |_| Dilatation::Mean),
        (CellShape::Wedge6, |_| Dilatation::Pointwise),
    ] {
        let mesh = distorted(shape);
        let moved: Vec<Vector> = mesh.nodes.iter().map(|x| gradient * x).collect();
        let (materials, of_cell) = ([tissue], vec![0; mesh.cells.len()]);
        let own = Tissue::isotropic(&mesh, &materials, &of_cell, dilatation);
        let pressure = (shape == CellShape::Tet4).then(|| lambda * f.determinant().ln());
        let states = at_second_order(
            &own,
            &InnerStress::default(),
            &moved,
            &vec![pressure; mesh.cells.len()],
        );
        for state in states {
            let off = (state.unwrap().stress - expected).amax();
            assert!(off < 1e-11, "{shape:?}: {off}");
        }
        let inside_out: Vec<Vector> = mesh.nodes.iter().map(|x| x * -1.5).collect();
        assert!(
            at_second_order(&own, &InnerStress::default(), &inside_out, &[])
                .iter()
                .all(Option::is_none)
        );
    }
}

#[test]
fn tissue_with_fibres_has_to_second_order_the_stress_of_its_tensor_where_strain_is_small() {
    let small = 1e-4;
    let along = Vector::new(1.0, 2.0, -0.5).normalize();
    let tissue = fibred(MUSCLE).unwrap();
    let expected = tissue.tensor(&along).stress(&(affine() * small));
    for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
        let mut mesh = distorted(shape);
        let plan = moved_by(&mut mesh, affine() * small);
        let mut case = case_of(mesh, tissue);
        case.fibres.insert("*".to_owned(), FibreDirection::Uniform(along));
        let scene = Scene::new(&case, &plan, &asked(ElementChoice::Plain)).unwrap();
        let moved: Vec<Vector> = case.volume.nodes.iter().map(|x| affine() * small * x).collect();
        let states = at_second_order(&scene.tissue(), &InnerStress::default(), &moved, &[]);
        for state in states {
            let off = (state.unwrap().stress - expected).amax() / expected.amax();
            assert!(off < 1e-5, "{shape:?}: {off:e}");
        }
    }
}

/// A bar of 20 mm that is pushed by 1.5 mm against a block half a millimetre away: a strain of -1/20 along it.
#[test]
fn contact_that_presses_has_the_stress_of_what_is_pressed() {
    for (shape, element) in PRESSING {
        let case = bar(shape);
        let linear = Settings { element, states: true, ..unilateral() };
        let finite = Settings { method: Method::FemNonlinear, ..linear.clone() };
        let l: f64 = 0.95;
        // Hooke at nu 0, and mu (l - 1/l) of the neo-Hookean law with the Green strain (l² - 1) / 2.
        for (settings, stress, strain) in [
            (linear, 15.0 * (l - 1.0), l - 1.0),
            (finite, 7.5 * (l - 1.0 / l), (l * l - 1.0) / 2.0),
        ] {
            let answer = solve(&case, &pushed(1.5), &settings);
            assert!(answer.contact.is_some());
            let along = |value: f64| Matrix3::from_diagonal(&Vector::new(value, 0.0, 0.0));
            let in_bar = |cell: usize| case.volume.corners(cell).all(|x| x.x < 20.1);
            assert_eq!(answer.states.cells.len(), case.volume.cells.len());
            for (cell, state) in answer.states.cells.iter().enumerate() {
                let [stress, strain] = match in_bar(cell) {
                    true => [along(stress), along(strain)],
                    false => [Matrix3::zeros(); 2],
                };
                let off = [(state.stress - stress).amax(), (state.strain - strain).amax()];
                assert!(off[0] < 1e-6 && off[1] < 1e-7, "{shape:?} {element:?} {cell}: {state:?}");
            }
            // What does not reach the block is not pressed.
            let free = solve(&case, &pushed(0.3), &settings);
            assert!(free.contact.is_none() && free.states.cells.len() == case.volume.cells.len());
            assert!(free.states.cells.iter().all(|state| state.stress.amax() < 1e-6));
        }
    }
}

#[test]
fn stress_is_given_where_it_is_asked_for_by_methods_that_have_one() {
    let (case, plan) = lifted(0.5, CellShape::Tet4, material(15.0, 0.3));
    for kind in MethodKind::ALL.iter().copied() {
        let usual = methods::of_method(kind).remove(0).settings;
        let settings = Settings { states: true, ..usual };
        let answer = solve(&case, &plan, &settings);
        let expected = if kind.properties().gives_stress { case.volume.cells.len() } else { 0 };
        assert_eq!(answer.states.cells.len(), expected, "{}", kind.name());
        let silent = solve(&case, &plan, &Settings { states: false, ..settings });
        assert!(silent.states.cells.is_empty());
        assert_eq!(silent.displacement, answer.displacement, "{}", kind.name());
    }
}
