//! Hexahedra that take volume as a mean, pulled between smooth walls: where they crease it is reported.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Method, Plan, Prediction, Settings, Sliding, SlidingNormal,
};

use crate::scenes::{case_of, largest_error, material, set, solve};

const SIZE: [f64; 3] = [40.0, 30.0, 12.0];

/// A block between smooth walls on a fixed bottom, its top raised by a part of its height, and how far nodes are from even strain
/// in mm.
fn pulled(element: ElementChoice, by: f64) -> (Prediction, f64) {
    let wall =
        |name: &str| Sliding { nodes: set(name), normal: SlidingNormal::Surface, segment: None };
    let mesh = block(Vector::from(SIZE), [8, 6, 4], CellShape::Hex8);
    let case = Case {
        fixed: vec![set("z_min")],
        segments: vec![CaseSegment { name: "top".to_owned(), nodes: set("z_max") }],
        sliding: ["x_min", "x_max", "y_min", "y_max"].map(wall).to_vec(),
        ..case_of(mesh, material(15.0, 0.49))
    };
    let up = Vector::z() * (by * SIZE[2]);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), up);
    let segments = vec![PlannedSegment { name: "top".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let settings = Settings { method: Method::FemNonlinear, element, ..Settings::default() };
    let found = solve(&case, &plan, &settings);
    let error = largest_error(&case.volume, &found.displacement, |x| Vector::z() * (by * x.z));
    (found, error)
}

fn is_told(found: &Prediction) -> bool {
    found.warnings.iter().any(|warning| warning.code == "hexahedra-crease")
}

#[test]
fn hexahedra_that_crease_where_tissue_would_not_are_reported() {
    let (found, error) = pulled(ElementChoice::Auto, 0.05);
    assert!(error > 0.1 && is_told(&found), "{error} mm, {:?}", found.warnings);
    for (element, by) in [(ElementChoice::Plain, 0.05), (ElementChoice::Auto, 0.01)] {
        let (found, error) = pulled(element, by);
        assert!(error < 1e-5 && !is_told(&found), "{element:?}: {error} mm");
    }
}
