//! Scenes of tissue with fibres: the isotropic limit, turned scenes, locking, the mass-tensor, what is refused.

use mechanics::material::{FibreLaw, LinearElastic};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::cell_stiffness::{Dilatation, cell_stiffness};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::prediction::{
    Case, ContactKind, ElementChoice, FibreDirection, Method, Plan, Prescribed, RegionNames, Scene,
    Settings, Sliding, SlidingNormal,
};
use mechanics::progress::Unobserved;
use mechanics::solver::stationary::{Iteration, Stationary};
use nalgebra::{Matrix3, Rotation3};

use crate::material::anisotropy::{ELEMENTS, MUSCLE, Stated, fibred, gradients, tight};
use crate::scenes::{case_of, exact, material, set, solve};

/// A block of two layers of which the upper one has fibres, bent and sliding; everything turned.
fn bent(
    upper: LinearElastic,
    fibre: Vector,
    shape: CellShape,
    turn: Rotation3<f64>,
) -> (Case, Plan) {
    let mut mesh = block(Vector::new(20.0, 12.0, 8.0), [5, 3, 4], shape);
    let upper_half = |mesh: &VolumeMesh, cell| mesh.corners(cell).all(|x| x.z > 3.99);
    let labels = (0..mesh.cells.len()).map(|cell| i64::from(upper_half(&mesh, cell))).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    let wavy = |cell: usize| {
        let along = mesh.corners(cell).map(|x| x.x).sum::<f64>() / 20.0;
        turn * Rotation3::from_axis_angle(&Vector::z_axis(), 0.1 * along) * fibre
    };
    let fibres: Vec<Vector> = (0..mesh.cells.len()).map(wavy).collect();
    mesh.cell_vectors.insert("course".to_owned(), fibres);
    let bend = |x: &Vector| turn * Vector::new(0.0, 0.1 * x.x, 0.02 * x.x * x.x);
    mesh.node_vectors.insert("bend".to_owned(), mesh.nodes.iter().map(bend).collect());
    mesh.nodes.iter_mut().for_each(|x| *x = turn * *x);
    let mut case = case_of(mesh, material(15.0, 0.46));
    let names = [(1, "muscle".to_owned())].into();
    case.regions = Some(RegionNames { array: "layer".to_owned(), names });
    case.materials.insert("muscle".to_owned(), upper);
    case.fibres.insert("muscle".to_owned(), FibreDirection::Array("course".to_owned()));
    case.sliding =
        vec![Sliding { nodes: set("y_min"), normal: SlidingNormal::Surface, segment: None }];
    let end = |name: &str| Prescribed::FromArray { nodes: set(name), array: "bend".to_owned() };
    (case, Plan { prescribed: vec![end("x_min"), end("x_max")], ..Plan::default() })
}

fn displacement(case: &Case, plan: &Plan, element: ElementChoice) -> Vec<Vector> {
    solve(case, plan, &Settings { element, ..tight() }).displacement
}

fn largest_difference(a: &[Vector], b: &[Vector]) -> f64 {
    let scale = b.iter().map(Vector::norm).fold(0.0, f64::max);
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / scale
}

#[test]
fn fibres_as_stiff_as_what_lies_across_them_change_nothing() {
    let plain = material(6.2, 0.49);
    for law in [FibreLaw::Engineering, FibreLaw::Kim2012] {
        let fibre = fibred((6.2, 6.2, 0.49, law)).unwrap();
        for (shape, element) in ELEMENTS {
            let answer = |upper| {
                let (case, plan) =
                    bent(upper, Vector::new(1.0, 0.5, 0.2), shape, Rotation3::identity());
                displacement(&case, &plan, element)
            };
            let difference = largest_difference(&answer(fibre), &answer(plain));
            // Both are solved to 1e-13 of the right-hand side, and the system is that much worse conditioned.
            assert!(difference < 1e-10, "{law:?} {shape:?} {element:?}: {difference:.1e}");
        }
        let corners = block(Vector::new(2.0, 1.0, 1.5), [1, 1, 1], CellShape::Hex8).nodes;
        let order = [0, 1, 3, 2, 4, 5, 7, 6].map(|k: usize| corners[k]);
        for dilatation in [Dilatation::Pointwise, Dilatation::Mean] {
            let of = |material: LinearElastic| {
                let tensor = material.tensor(&Vector::new(0.6, 0.0, 0.8));
                cell_stiffness(CellShape::Hex8, &order, &tensor, dilatation).unwrap()
            };
            let (found, expected) = (of(fibre), of(plain));
            let flat = |blocks: &[[[f64; 3]; 3]]| blocks.as_flattened().as_flattened().to_vec();
            let (found, expected) = (flat(&found), flat(&expected));
            let scale = expected.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let differences = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
            assert!(differences.fold(0.0, f64::max) < 1e-12 * scale, "{law:?} {dilatation:?}");
        }
    }
}

#[test]
fn turning_scene_and_fibres_together_turns_the_answer() {
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let upper = fibred(MUSCLE).unwrap();
    for (shape, element) in ELEMENTS {
        let answer = |turn| {
            let (case, plan) = bent(upper, Vector::new(1.0, 0.5, 0.2), shape, turn);
            displacement(&case, &plan, element)
        };
        let straight: Vec<Vector> =
            answer(Rotation3::identity()).iter().map(|u| turn * u).collect();
        let difference = largest_difference(&answer(turn), &straight);
        assert!(difference < 1e-9, "{shape:?} {element:?}: {difference:.1e}");
        // The fibres matter: without them the answer is another.
        let (mut case, plan) = bent(upper, Vector::x(), shape, turn);
        case.materials.insert("muscle".to_owned(), material(6.2, 0.49));
        let without = displacement(&case, &plan, element);
        assert!(largest_difference(&without, &straight) > 1e-3, "{shape:?} {element:?}");
    }
}

#[test]
fn pressure_and_mean_dilatation_do_not_lock_where_plain_cells_with_fibres_do() {
    let upper = fibred((110.0, 6.2, 0.4995, FibreLaw::Engineering)).unwrap();
    let answer = |shape, element| {
        let (mut case, plan) =
            bent(upper, Vector::new(1.0, 0.5, 0.2), shape, Rotation3::identity());
        case.materials.insert("*".to_owned(), material(15.0, 0.4995));
        displacement(&case, &plan, element)
    };
    let fine = answer(CellShape::Tet4, ElementChoice::Quadratic);
    let error = |shape, element| {
        let pairs = answer(shape, element).into_iter().zip(&fine);
        pairs.map(|(u, fine)| (u - fine).norm()).sum::<f64>()
    };
    let plain = error(CellShape::Tet4, ElementChoice::Plain);
    let stabilised = error(CellShape::Tet4, ElementChoice::Stabilised);
    let (plain_hex, mean_hex) = (
        error(CellShape::Hex8, ElementChoice::Plain),
        error(CellShape::Hex8, ElementChoice::MeanDilatation),
    );
    println!("{plain} {stabilised} {plain_hex} {mean_hex}");
    assert!(stabilised < plain / 2.0, "{stabilised} {plain}");
    assert!(mean_hex < plain_hex / 2.0, "{mean_hex} {plain_hex}");
}

/// Forces of the corrected mass-tensor as Kim et al. 2012 write them, eq. 33: A_jk = K_jk + 1/(36 V) { … } of area vectors m.
fn mass_tensor_forces(scene: &Scene, (along, across, nu, _): Stated, u: &[Vector]) -> Vec<Vector> {
    let (f, t) = (material(along, nu), material(across, nu));
    let (lambda, mu) = (t.lambda(), t.shear_modulus());
    let (dlam, dmu) = (f.lambda() - lambda, f.shear_modulus() - mu);
    let mut forces = vec![Vector::zeros(); u.len()];
    for (cell, (_, nodes)) in scene.mesh.cells.iter().enumerate() {
        let corners: Vec<Vector> = scene.mesh.corners(cell).collect();
        let (volume, g) = gradients(&[corners[0], corners[1], corners[2], corners[3]]);
        let (m, a) = (g.map(|g| g * (6.0 * volume)), scene.fibres[cell]);
        for j in 0..4 {
            for k in 0..4 {
                let (aj, ak) = (a.dot(&m[j]), a.dot(&m[k]));
                let block = m[j] * m[k].transpose() * lambda
                    + m[k] * m[j].transpose() * mu
                    + Matrix3::identity() * (mu * m[j].dot(&m[k]))
                    + (m[j] * a.transpose() * ak + a * m[k].transpose() * aj) * dlam
                    - a * a.transpose() * ((dlam + 2.0 * dmu) * aj * ak)
                    + (a * m[j].transpose() * ak + m[k] * a.transpose() * aj) * dmu
                    + a * a.transpose() * (dmu * m[j].dot(&m[k]))
                    + Matrix3::identity() * (dmu * aj * ak);
                forces[nodes[j] as usize] += block * u[nodes[k] as usize] / (36.0 * volume);
            }
        }
    }
    forces
}

#[test]
fn the_mass_tensor_with_fibres_is_the_plain_finite_element_and_balances_its_own_forces() {
    let stated = (15.0, 12.0, 0.43, FibreLaw::Kim2012);
    let (mut case, plan) = bent(
        fibred(stated).unwrap(),
        Vector::new(1.0, 0.5, 0.2),
        CellShape::Tet4,
        Rotation3::identity(),
    );
    case.regions = None;
    case.materials = [("*".to_owned(), fibred(stated).unwrap())].into();
    case.fibres = [("*".to_owned(), FibreDirection::Array("course".to_owned()))].into();
    let of = |method, element| {
        let scene = Scene::new(&case, &plan, &Settings { method, element, ..exact() }).unwrap();
        let answer = scene.solve(&Unobserved).unwrap();
        (scene, answer)
    };
    let (scene, tensor) =
        of(Method::MassTensorTransverse(MassTensorSettings::default()), ElementChoice::Auto);
    let (_, plain) = of(Method::FemLinear, ElementChoice::Plain);
    assert!(largest_difference(&tensor.displacement, &plain.displacement) < 1e-10);
    assert_eq!(scene.elements(), ["tet4 plain"]);

    let mut rest = mass_tensor_forces(&scene, stated, &tensor.displacement);
    let scale = tensor.reactions.iter().map(Vector::norm).fold(0.0, f64::max);
    for (constraint, reaction) in scene.conditions.constraints.iter().zip(&tensor.reactions) {
        rest[constraint.node as usize] -= reaction;
    }
    let left = rest.iter().map(Vector::norm).fold(0.0, f64::max);
    assert!(left < 1e-10 * scale, "{left:e} of {scale}");
}

#[test]
fn own_iterations_bring_tissue_with_fibres_to_the_rest_that_the_fast_solver_finds() {
    let stated = (15.0, 12.0, 0.43, FibreLaw::Kim2012);
    let by = Vector::new(1.0, 0.5, 0.2);
    let (mut case, plan) =
        bent(fibred(stated).unwrap(), by, CellShape::Tet4, Rotation3::identity());
    case.regions = None;
    case.materials = [("*".to_owned(), fibred(stated).unwrap())].into();
    case.fibres = [("*".to_owned(), FibreDirection::Array("course".to_owned()))].into();
    let settings = |iterations| Settings {
        method: Method::MassTensorTransverse(MassTensorSettings { iterations }),
        relative_residual: 1e-9,
        ..exact()
    };
    let by_node = |iteration| {
        let own = Stationary { iteration, relative_change: None, most_iterations: 200_000 };
        settings(Iterations::Stationary(own))
    };
    let solved =
        |settings: &Settings| Scene::new(&case, &plan, settings).unwrap().solve(&Unobserved);
    let fast = solved(&settings(Iterations::Fast)).unwrap();
    for iteration in [Iteration::GaussSeidel, Iteration::DampedJacobi] {
        let own = solved(&by_node(iteration)).unwrap();
        assert!(largest_difference(&own.displacement, &fast.displacement) < 1e-6, "{iteration:?}");
        assert!(own.solver.iterations > 10, "{iteration:?}: {}", own.solver.iterations);
    }
    // As printed it diverges with fibres, too.
    assert!(solved(&by_node(Iteration::Jacobi)).is_err());
    let pressing = Settings { contact: ContactKind::Unilateral, ..by_node(Iteration::GaussSeidel) };
    let (code, pointer, _) = refusal(&case, &plan, &pressing);
    assert_eq!((code, pointer.as_str()), ("method-not-available", "/spec/contact"));
}

/// Code, pointer and sentence of the first refusal.
fn refusal(case: &Case, plan: &Plan, settings: &Settings) -> (&'static str, String, String) {
    let errors = Scene::new(case, plan, settings).err().expect("the scene is refused").0;
    (errors[0].code.name(), errors[0].pointer.clone(), errors[0].detail.clone())
}

#[test]
fn a_fibred_cell_without_a_direction_is_named() {
    let (case, plan) =
        bent(fibred(MUSCLE).unwrap(), Vector::x(), CellShape::Tet4, Rotation3::identity());
    let muscle = |cell: &usize| case.volume.cell_labels["layer"][*cell] == 1;
    let other = (0..case.volume.cells.len()).position(|cell| !muscle(&cell)).unwrap();
    let cells: Vec<usize> = (0..case.volume.cells.len()).filter(muscle).collect();
    let with = |wrong: &[usize], vector: Vector| {
        let mut case = case.clone();
        let mut mesh = (*case.volume).clone();
        for &cell in wrong {
            mesh.cell_vectors.get_mut("course").unwrap()[cell] = vector;
        }
        case.volume = mesh.into();
        case
    };
    for vector in [Vector::zeros(), Vector::new(0.0, f64::NAN, 1.0), Vector::x() * f64::INFINITY] {
        let (code, pointer, detail) = refusal(&with(&cells[7..9], vector), &plan, &exact());
        assert_eq!(
            (code, pointer.as_str()),
            ("fibre-direction-zero", "/case/materials/muscle/fibre/array")
        );
        assert!(
            detail.contains(&format!("cell {} ", cells[7])) && detail.contains("(2 such"),
            "{detail}"
        );
        // What no fibred region reads may be anything.
        assert!(Scene::new(&with(&[other], vector), &plan, &exact()).is_ok());
    }
    let course = |course: Option<FibreDirection>| {
        let fibres = course.map(|course| ("*".to_owned(), course)).into_iter().collect();
        refusal(&Case { fibres, ..case.clone() }, &plan, &exact())
    };
    let (code, pointer, detail) = course(Some(FibreDirection::Array("corse".to_owned())));
    assert_eq!((code, pointer.as_str()), ("unknown-array", "/case/materials/muscle/fibre/array"));
    assert!(detail.contains("it has course"), "{detail}");
    let (code, pointer, _) = course(Some(FibreDirection::Uniform(Vector::zeros())));
    assert_eq!(
        (code, pointer.as_str()),
        ("fibre-direction-zero", "/case/materials/muscle/fibre/direction")
    );
    let (code, pointer, _) = course(None);
    assert_eq!((code, pointer.as_str()), ("missing-field", "/case/materials/muscle/fibre"));
}

#[test]
fn the_mass_tensor_is_for_plain_tetrahedra_and_says_when_nothing_has_fibres() {
    let settings = |element| Settings {
        method: Method::MassTensorTransverse(MassTensorSettings::default()),
        element,
        ..exact()
    };
    let of = |shape| bent(fibred(MUSCLE).unwrap(), Vector::x(), shape, Rotation3::identity());
    for shape in [CellShape::Hex8, CellShape::Wedge6] {
        let (case, plan) = of(shape);
        let (code, pointer, detail) = refusal(&case, &plan, &settings(ElementChoice::Auto));
        assert_eq!((code, pointer.as_str()), ("method-not-available", "/case/volume"));
        assert!(detail.contains(shape.name()), "{detail}");
    }
    let (mut case, plan) = of(CellShape::Tet4);
    let (code, pointer, _) = refusal(&case, &plan, &settings(ElementChoice::Quadratic));
    assert_eq!((code, pointer.as_str()), ("method-not-available", "/spec/element"));
    let codes = |case: &Case| -> Vec<&str> {
        let scene = Scene::new(case, &plan, &settings(ElementChoice::Plain)).unwrap();
        scene.warnings.iter().map(|warning| warning.code).collect()
    };
    assert!(!codes(&case).contains(&"fibres-missing"));
    case.materials.insert("muscle".to_owned(), material(15.0, 0.3));
    assert!(codes(&case).contains(&"fibres-missing"));
}

#[test]
fn the_course_of_a_region_wins_over_that_of_all_regions() {
    let (mut case, plan) =
        bent(fibred(MUSCLE).unwrap(), Vector::x(), CellShape::Tet4, Rotation3::identity());
    case.fibres.insert("*".to_owned(), FibreDirection::Uniform(Vector::z()));
    let scene = Scene::new(&case, &plan, &exact()).unwrap();
    let labels = &case.volume.cell_labels["layer"];
    for ((fibre, label), course) in
        scene.fibres.iter().zip(labels).zip(&case.volume.cell_vectors["course"])
    {
        let expected = if *label == 1 { *course } else { Vector::zeros() };
        assert!((fibre - expected).norm() < 1e-15);
    }
}

/// The same scene with its fibres at nodes, each with a sign of its own.
fn at_nodes(shape: CellShape, course: impl Fn(&Vector) -> Vector) -> (Case, Plan) {
    let (mut case, plan) = bent(fibred(MUSCLE).unwrap(), Vector::x(), shape, Rotation3::identity());
    let mesh = std::sync::Arc::make_mut(&mut case.volume);
    let nodes = mesh.nodes.iter().enumerate();
    let signed =
        |(number, x): (usize, &Vector)| course(x) * if number % 3 == 0 { -2.0 } else { 1.0 };
    let vectors = nodes.map(signed).collect();
    mesh.node_vectors.insert("at nodes".to_owned(), vectors);
    case.fibres = [("*".to_owned(), FibreDirection::Array("at nodes".to_owned()))].into();
    (case, plan)
}

#[test]
fn fibres_at_nodes_are_the_mean_axes_of_their_cells_whatever_their_signs() {
    let along = Vector::new(0.6, 0.0, 0.8);
    for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
        let (case, plan) = at_nodes(shape, |_| along);
        let scene = Scene::new(&case, &plan, &exact()).unwrap();
        let labels = &case.volume.cell_labels["layer"];
        for (fibre, label) in scene.fibres.iter().zip(labels) {
            let expected = if *label == 1 { 1.0 } else { 0.0 };
            assert!((fibre.dot(&along).abs() - expected).abs() < 1e-14, "{fibre}");
        }
        assert!(!scene.warnings.iter().any(|warning| warning.code == "fibres-disagree"));
    }
}

#[test]
fn cells_whose_nodes_have_fibres_in_two_ways_are_counted() {
    // Nodes at 4 mm across those at 6 mm: every hexahedron of the lower row of the muscle has four of each.
    let (case, plan) =
        at_nodes(CellShape::Hex8, |x| if x.z > 5.1 { Vector::x() } else { Vector::y() });
    let scene = Scene::new(&case, &plan, &exact()).unwrap();
    let disagree = scene.warnings.iter().find(|warning| warning.code == "fibres-disagree").unwrap();
    assert_eq!(disagree.numbers, [("cells", 15.0), ("of", 30.0)]);
}

#[test]
fn nodes_without_any_direction_are_refused_as_cells_are() {
    let (case, plan) = at_nodes(CellShape::Tet4, |_| Vector::zeros());
    let (code, pointer, _) = refusal(&case, &plan, &exact());
    assert_eq!(
        (code, pointer.as_str()),
        ("fibre-direction-zero", "/case/materials/muscle/fibre/array")
    );
}
