//! Every law of finite strain through the whole prediction: affine states, pulled and stretched blocks, turning, Newton's end.

use mechanics::boundary::NodeSelection;
use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::point::{FibreAtPoint, Point};
use mechanics::material::hyperelastic::{Fung, Law, Volumetric};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, FibreDirection, Method, Plan, Prediction, Prescribed,
    Settings,
};
use nalgebra::{Matrix3, Rotation3};

use crate::material::hyperelastic::{FIBRES, Row, rows};
use crate::scenes::{case_of, constraint, largest_error, on_the_boundary, set, solve};

/// Of a block of tetrahedra.
const SIDE: f64 = 9.0;

fn tight() -> Settings {
    let (method, element) = (Method::FemNonlinear, ElementChoice::Plain);
    Settings { method, element, relative_residual: 1e-10, ..Settings::default() }
}

fn tissue(row: &Row) -> LinearElastic {
    let tissue = LinearElastic::of_law(row.law, 1.0).unwrap();
    if row.fibres.is_some() { tissue.with_pulling_fibres(FIBRES) } else { tissue }
}

fn cube(tissue: LinearElastic, along: Option<Vector>) -> Case {
    let mut case = case_of(block(Vector::repeat(SIDE), [3, 3, 3], CellShape::Tet4), tissue);
    case.fibres.extend(along.map(|along| ("*".to_owned(), FibreDirection::Uniform(along))));
    case
}

#[test]
fn an_affine_boundary_moves_the_inside_alike_whatever_the_law() {
    let stretch = Matrix3::new(1.25, 0.3, 0.0, -0.1, 0.9, 0.1, 0.0, 0.2, 1.05);
    let affine = |x: &Vector| stretch * x - x + Vector::new(3.0, 0.0, -2.0);
    for row in rows() {
        let mut case = cube(tissue(&row), row.fibres);
        let mesh = std::sync::Arc::make_mut(&mut case.volume);
        // The nodes inside begin where they do not end.
        let inside = |x: &Vector| x.iter().all(|c| *c > 0.1 && *c < SIDE - 0.1);
        mesh.nodes.iter_mut().filter(|x| inside(x)).for_each(|x| *x += Vector::new(0.4, -0.3, 0.2));
        let plan = on_the_boundary(mesh, affine);
        let moved = solve(&case, &plan, &tight());
        let error = largest_error(&case.volume, &moved.displacement, affine);
        assert!(error < 1e-7, "{}: {error}", row.name);
    }
}

/// A block between planes of symmetry whose far ends are moved.
fn pulled(case: &Case, ends: &[(&str, usize)], stretch: f64) -> Prediction {
    let plane = |name: &str, axis: usize, by: f64| {
        let mut displacement = [None; 3];
        displacement[axis] = Some(by);
        constraint(name, displacement)
    };
    let by = (stretch - 1.0) * SIDE;
    let mut prescribed: Vec<Prescribed> =
        vec![plane("x_min", 0, 0.0), plane("y_min", 1, 0.0), plane("z_min", 2, 0.0)];
    prescribed.extend(ends.iter().map(|(name, axis)| plane(name, *axis, by)));
    solve(case, &Plan { prescribed, ..Plan::default() }, &tight())
}

/// The stress on the first end that is moved, and the stretch along z.
fn found(case: &Case, moved: &Prediction) -> [f64; 2] {
    let force = moved.condition_reactions[3].force.x;
    let corner = case.volume.node_set("z_max").unwrap()[0];
    [force / (SIDE * SIDE), 1.0 + moved.displacement[corner as usize].z / SIDE]
}

#[test]
fn a_block_is_pulled_and_pressed_as_printed_whatever_the_law() {
    for row in rows() {
        let case = cube(tissue(&row), row.fibres.map(|_| Vector::x()));
        for (stretch, printed) in [0.7, 0.9, 1.2, 1.5].into_iter().zip(&row.uniaxial) {
            let [stress, side] = found(&case, &pulled(&case, &[("x_max", 0)], stretch));
            assert!((stress / printed[0] - 1.0).abs() < 2e-6, "{} {stretch}: {stress}", row.name);
            assert!((side - printed[1]).abs() < 2e-6, "{} {stretch}: {side}", row.name);
        }
        for (stretch, printed) in [0.9, 1.2].into_iter().zip(&row.equibiaxial) {
            let ends = [("x_max", 0), ("y_max", 1)];
            let [stress, across] = found(&case, &pulled(&case, &ends, stretch));
            assert!((stress / printed[0] - 1.0).abs() < 2e-6, "{} {stretch}: {stress}", row.name);
            assert!((across - printed[1]).abs() < 2e-6, "{} {stretch}: {across}", row.name);
        }
    }
}

#[test]
fn tissue_on_one_bone_turns_with_it_whatever_the_law() {
    let axis = nalgebra::Unit::new_normalize(Vector::new(1.0, 2.0, 3.0));
    let turn = Rotation3::from_axis_angle(&axis, 37_f64.to_radians()).into_inner();
    let movement = RigidMovement::new(turn, Vector::new(4.0, -2.0, 1.0)).unwrap();
    for row in rows() {
        let mut case = cube(tissue(&row), row.fibres);
        let nodes: NodeSelection = set("z_min");
        case.segments = vec![CaseSegment { name: "jaw".to_owned(), nodes }];
        case.allow_unfixed = true;
        let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
        let moved = solve(&case, &Plan { segments, ..Plan::default() }, &tight());
        let error = largest_error(&case.volume, &moved.displacement, |x| movement.displacement(x));
        assert!(error < 1e-6, "{}: {error}", row.name);
    }
}

#[test]
fn newton_ends_by_orders_of_magnitude_in_a_step_whatever_the_law() {
    for row in rows().iter().filter(|row| row.name != "Saint Venant-Kirchhoff") {
        let mut case = cube(tissue(row), row.fibres);
        case.fixed.push(set("z_min"));
        let plan = Plan {
            prescribed: vec![constraint("z_max", [Some(2.0), Some(0.5), Some(1.0)])],
            ..Plan::default()
        };
        let moved = solve(&case, &plan, &tight());
        let history = &moved.solver.history;
        let [.., before, last] = history.as_slice() else { panic!("{history:?}") };
        assert!(last / before < 0.02, "{}: {history:?}", row.name);
        assert!(*last <= 1e-10 && history.len() < 25, "{}: {history:?}", row.name);
        assert!(moved.deformation.iter().all(|cell| cell.det_f > 0.0), "{}", row.name);
    }
}

/// Half of a block has fibres: the law of each region is its own.
#[test]
fn fibres_stiffen_the_region_that_has_them_and_only_along() {
    let plain = || rows().into_iter().find(|row| row.name == "neo-Hookean, isochoric").unwrap();
    let fibred = tissue(&plain()).with_pulling_fibres(FIBRES);
    let pull = |tissue, along: Vector| {
        let case = cube(tissue, Some(along));
        found(&case, &pulled(&case, &[("x_max", 0)], 1.2))[0]
    };
    let without = pull(tissue(&plain()), Vector::x());
    assert!((pull(fibred, Vector::x()) / 7.179424 - 1.0).abs() < 2e-6);
    // Fibres across are pressed, and do nothing.
    assert!((pull(fibred, Vector::y()) / without - 1.0).abs() < 1e-8);
    let direction = Vector::new(0.6, 0.8, 0.0);
    let oblique = pull(fibred, direction);
    assert!(oblique > 1.02 * without, "{oblique} {without}");
    let point = Point::new(
        &plain().law,
        Some(FibreAtPoint { law: &FIBRES, direction }),
        Matrix3::from_diagonal(&Vector::new(1.2, 1.0, 1.0)),
    );
    assert!(point.energy() > 0.0);
}

fn fung(b: f64, bulk: f64) -> Case {
    let law = Law::Fung(Fung { mu: 5.0, b, volumetric: Volumetric::Barrier(bulk) });
    cube(LinearElastic::of_law(law, 1.0).unwrap(), None)
}

/// Held all around: what is free to swell never comes that far.
#[test]
fn stretch_beyond_the_range_of_an_exponential_is_named_with_its_cells() {
    let bounded = |stretch: f64| {
        let mut case = fung(40.0, 1e5);
        let side = 1.0 / stretch.sqrt();
        let plan = on_the_boundary(std::sync::Arc::make_mut(&mut case.volume), |x| {
            Vector::new(stretch * x.x, side * x.y, side * x.z) - x
        });
        let moved = solve(&case, &plan, &Settings { relative_residual: 1e-6, ..tight() });
        let cells = case.volume.cells.len() as f64;
        let warnings = moved.warnings.into_iter();
        (warnings.into_iter().find(|warning| warning.code == "exponent-bounded"), cells)
    };
    let (told, cells) = bounded(1.9);
    let told = told.expect("b (Ibar1 - 3) is 66");
    assert!(told.detail.contains("cell 0"), "{}", told.detail);
    let number = |name: &str| {
        told.numbers.iter().find(|(own, _)| *own == name).map(|(_, value)| *value).unwrap()
    };
    assert_eq!(number("cells"), cells);
    assert!((60.0..70.0).contains(&number("largest_exponent")));
    assert_eq!(bounded(1.1).0, None);
}

#[test]
fn tissue_that_escapes_its_stiffness_by_swelling_is_reported_with_its_volume() {
    let swollen = |stretch: f64| {
        let moved = pulled(&fung(40.0, 100.0), &[("x_max", 0)], stretch);
        moved.warnings.into_iter().find(|warning| warning.code == "volume-not-kept")
    };
    assert_eq!(swollen(1.01), None);
    let told = swollen(1.5).expect("the bulk modulus is twenty times the shear modulus at rest");
    let most = told.numbers.iter().find(|(name, _)| *name == "most_volume_ratio").unwrap().1;
    assert!(most > 1.2, "{most}");
}
