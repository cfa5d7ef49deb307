//! Columns of two layers with the same constants, of which one pulls, grows or has other fibres: the pressure jumps between them.

use std::sync::Arc;

use mechanics::material::{Fibre, FibreLaw};
use mechanics::mesh::{CellShape, TriangleSurface, Vector};
use mechanics::muscle::strap::box_surface;
use mechanics::prediction::{
    Activation, BodyFibres, Case, ElementChoice, FibreDirection, Growth, Method, Muscle,
    MuscleCourse, Plan, RegionNames, Settings,
};

use super::muscles::in_region;
use crate::scenes::{
    askew_column, case_of, confined, constraint, exact, largest_error, material, solve,
};

const HEIGHT: f64 = 15.0;
const NU: f64 = 0.49;

/// 10 x 10 x 30 mm of askew tetrahedra; the interface is flat.
fn column() -> Case {
    let size = Vector::new(10.0, 10.0, 2.0 * HEIGHT);
    let is_interface = |z: f64| (z - HEIGHT).abs() < 0.1;
    let mut mesh = askew_column(size, [4, 4, 12], CellShape::Tet4, is_interface);
    let upper = |cell: usize| mesh.corners(cell).map(|x| x.z).sum::<f64>() > 4.0 * HEIGHT;
    let labels = (0..mesh.cells.len()).map(|cell| u16::from(upper(cell)).into()).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    let names = [(0, "lower".to_owned()), (1, "upper".to_owned())].into();
    Case {
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        ..case_of(mesh, material(15.0, NU))
    }
}

/// Smooth walls all around, and a top that is moved.
fn walled(top: f64) -> Plan {
    let bottom = constraint("z_min", [None, None, Some(0.0)]);
    Plan { prescribed: [vec![bottom], confined(top)].concat(), ..Plan::default() }
}

/// The displacement along z where the interface moves by so much.
fn tent(at_interface: f64, top: f64) -> impl Fn(&Vector) -> Vector {
    move |x| {
        let up = match x.z < HEIGHT {
            true => at_interface * x.z / HEIGHT,
            false => at_interface + (top - at_interface) * (x.z / HEIGHT - 1.0),
        };
        Vector::z() * up
    }
}

fn elements() -> [ElementChoice; 2] {
    [ElementChoice::Stabilised, ElementChoice::Plain]
}

#[test]
fn a_layer_that_pulls_shortens_by_the_closed_form_whether_it_is_a_region_or_a_body() {
    let surface: TriangleSurface = box_surface(
        Vector::new(5.0, 5.0, 0.5 * HEIGHT),
        [Vector::x() * 6.0, Vector::y() * 6.0, Vector::z() * 0.5 * HEIGHT],
    );
    let along = BodyFibres::Course(FibreDirection::Uniform(Vector::z()));
    let body = Muscle {
        course: MuscleCourse::Body { surface: Arc::new(surface), fibres: along },
        ..in_region("levator", "lower", Vector::z())
    };
    // T H / (2 (lambda + 2 mu)).
    let tissue = material(15.0, NU);
    let stiffness = tissue.lambda() + 2.0 * tissue.shear_modulus();
    let exact_mm = -8.0 * HEIGHT / (2.0 * stiffness);
    for muscle in [in_region("levator", "lower", Vector::z()), body] {
        let case = Case { muscles: vec![muscle.clone()], ..column() };
        let activations = vec![Activation { muscle: "levator".to_owned(), stress: 8.0 }];
        let plan = Plan { activations, ..walled(0.0) };
        for element in elements() {
            let found = solve(&case, &plan, &Settings { element, ..exact() });
            let error = largest_error(&case.volume, &found.displacement, tent(exact_mm, 0.0));
            assert!(error < 1e-7, "{:?} {element:?}: {error} of {exact_mm} mm", muscle.course);
        }
        // At finite strain both elements have the same answer, which is even in each layer.
        let at_finite_strain = |element| {
            let settings = Settings { element, method: Method::FemNonlinear, ..exact() };
            solve(&case, &plan, &settings).displacement
        };
        let [stabilised, plain] = elements().map(at_finite_strain);
        let pairs = stabilised.iter().zip(&plain);
        let apart = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-6, "{apart} mm");
    }
}

#[test]
fn a_layer_that_grows_and_one_with_other_fibres_move_by_the_closed_form() {
    let case = column();
    let volume_change = 0.15;
    let growth = vec![Growth { region: "lower".to_owned(), volume_change }];
    let plan = Plan { growth, ..walled(0.0) };
    // 3 K eps_g H / (2 (lambda + 2 mu)).
    let tissue = material(15.0, NU);
    let stiffness = tissue.lambda() + 2.0 * tissue.shear_modulus();
    let bulk = tissue.lambda() + 2.0 / 3.0 * tissue.shear_modulus();
    let eigenstrain = (1.0_f64 + volume_change).cbrt() - 1.0;
    let at_interface = 3.0 * bulk * eigenstrain * HEIGHT / (2.0 * stiffness);
    for element in elements() {
        let found = solve(&case, &plan, &Settings { element, ..exact() });
        let error = largest_error(&case.volume, &found.displacement, tent(at_interface, 0.0));
        assert!(error < 1e-7, "{element:?}: {error} of {at_interface} mm");
    }

    // Fibres up in the lower layer and across in the upper one, the same constants: the lower one gives way less.
    let mut case = column();
    let fibre = Fibre { young_modulus: 110.0, shear_modulus: None, law: FibreLaw::Engineering };
    case.materials = [("*".to_owned(), tissue.with_fibre(&fibre).unwrap())].into();
    let directions = [("lower", Vector::z()), ("upper", Vector::x())];
    let directions = directions.map(|(name, way)| (name.to_owned(), FibreDirection::Uniform(way)));
    case.fibres = directions.into();
    let answers = elements()
        .map(|element| solve(&case, &walled(-2.0), &Settings { element, ..exact() }).displacement);
    let [stabilised, plain] = &answers;
    let apart = stabilised.iter().zip(plain).map(|(one, other)| (one - other).norm());
    let farthest = apart.fold(0.0, f64::max);
    assert!(farthest < 1e-7, "{farthest} mm");
}

#[test]
fn regions_may_be_named_and_nothing_else_changes_but_the_pressures_between_them() {
    // Of a plan that bends the column the answers differ by less than what the mesh leaves out.
    let named = column();
    let whole = Case { regions: None, ..column() };
    let prescribed = vec![
        constraint("z_min", [Some(0.0); 3]),
        constraint("z_max", [Some(3.0), Some(0.0), Some(-1.0)]),
    ];
    let plan = Plan { prescribed, ..Plan::default() };
    let answers = [&named, &whole].map(|case| solve(case, &plan, &exact()));
    let pairs = answers[0].displacement.iter().zip(&answers[1].displacement);
    let apart = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    assert!(apart > 0.0 && apart < 0.1, "{apart} mm");
}
