//! Bone that is part of the mesh: cells all of whose nodes are held do not change what tissue beside them does.

use mechanics::mesh::{CellShape, Vector};
use mechanics::prediction::{Case, ElementChoice, Method, Plan, Settings};

use crate::scenes::{
    SHAPES, askew_column, case_of, confined, exact, largest_error, material, set, solve,
};

const BONE: f64 = 4.0;
const TOP: f64 = 20.0;
const DOWN: f64 = -0.5;
const NU: f64 = 0.49;

/// A column of 12 x 12 mm between smooth walls, the lowest layer of which is bone and whose top goes down.
fn column(shape: CellShape) -> (Case, Plan) {
    let size = Vector::new(12.0, 12.0, TOP);
    let is_bone = |z: f64| z < BONE + 0.1;
    let mut mesh = askew_column(size, [3, 3, 5], shape, is_bone);
    let bone = (0_u32..).zip(&mesh.nodes).filter(|(_, x)| is_bone(x.z)).map(|(node, _)| node);
    mesh.node_sets.insert("bone".to_owned(), bone.collect());
    let case = Case { fixed: vec![set("bone")], ..case_of(mesh, material(15.0, NU)) };
    (case, Plan { prescribed: confined(DOWN), ..Plan::default() })
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
