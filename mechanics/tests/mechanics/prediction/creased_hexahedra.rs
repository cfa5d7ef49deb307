//! Hexahedra and wedges that take volume as a mean, pulled between smooth walls: where they crease it is reported.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::prediction::{Case, ElementChoice, Method, Plan, Prediction, Settings};

use crate::scenes::{case_of, confined, exact, largest_error, material, set, solve};

const SIDE: f64 = 12.0;

/// A cube between smooth walls on a fixed bottom, pulled by a part of its height, and how far nodes are from even strain in mm.
fn pulled(shape: CellShape, element: ElementChoice, by: f64) -> (Prediction, f64) {
    let mesh = block(Vector::repeat(SIDE), [3, 3, 4], shape);
    let case = Case { fixed: vec![set("z_min")], ..case_of(mesh, material(15.0, 0.49)) };
    let plan = Plan { prescribed: confined(by * SIDE), ..Plan::default() };
    let settings = Settings { method: Method::FemNonlinear, element, ..exact() };
    let found = solve(&case, &plan, &settings);
    let error = largest_error(&case.volume, &found.displacement, |x| Vector::z() * (by * x.z));
    (found, error)
}

fn is_told(found: &Prediction) -> bool {
    found.warnings.iter().any(|warning| warning.code == "hexahedra-crease")
}

#[test]
fn hexahedra_and_wedges_that_crease_where_tissue_would_not_are_reported() {
    for (shape, by) in [(CellShape::Hex8, 0.05), (CellShape::Wedge6, 0.1)] {
        let (found, error) = pulled(shape, ElementChoice::Auto, by);
        assert!(error > 0.1 && is_told(&found), "{shape:?}: {error} mm, {:?}", found.warnings);
        let (found, error) = pulled(shape, ElementChoice::Plain, by);
        assert!(error < 1e-6 && !is_told(&found), "{shape:?}: {error} mm");
        let (found, error) = pulled(shape, ElementChoice::Auto, 0.01);
        assert!(error < 1e-6 && !is_told(&found), "{shape:?}: {error} mm");
    }
}
