//! Hexahedra that take volume as a mean, pulled between smooth walls: they stay even, as tissue does.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, Method, Plan, Prediction, Settings, Sliding, SlidingNormal,
};

use crate::scenes::{case_of, largest_error, material, set, solve};

const SIZE: [f64; 3] = [40.0, 30.0, 12.0];

/// A block between smooth walls on a fixed bottom, its top raised by a part of its height, and how far nodes are from even strain
/// in mm.
fn pulled(shape: CellShape, nu: f64, by: f64) -> (Prediction, f64) {
    let wall =
        |name: &str| Sliding { nodes: set(name), normal: SlidingNormal::Surface, segment: None };
    let mesh = block(Vector::from(SIZE), [8, 6, 4], shape);
    let case = Case {
        fixed: vec![set("z_min")],
        segments: vec![CaseSegment { name: "top".to_owned(), nodes: set("z_max") }],
        sliding: ["x_min", "x_max", "y_min", "y_max"].map(wall).to_vec(),
        ..case_of(mesh, material(15.0, nu))
    };
    let up = Vector::z() * (by * SIZE[2]);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), up);
    let segments = vec![PlannedSegment { name: "top".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let found = solve(&case, &plan, &settings);
    let error = largest_error(&case.volume, &found.displacement, |x| Vector::z() * (by * x.z));
    (found, error)
}

#[test]
fn hexahedra_and_wedges_that_are_pulled_on_all_sides_stay_even() {
    for shape in [CellShape::Hex8, CellShape::Wedge6] {
        for (nu, by) in [(0.45, 0.2), (0.49, 0.05), (0.49, 0.3), (0.499, 0.02), (0.499, 0.2)] {
            let (found, error) = pulled(shape, nu, by);
            assert!(error < 1e-5, "{shape:?}, nu {nu}, {by}: {error} mm, {:?}", found.warnings);
            let newton = found.solver.newton.as_ref().unwrap();
            assert_ne!(newton.is_stable, Some(false), "{shape:?}, nu {nu}, {by}");
        }
    }
}
