//! Bodies and settings of which no mesh is made, and why.

use std::sync::atomic::{AtomicUsize, Ordering};

use mechanics::domain::{Boundary, Coverage, Crossing, Domain};
use mechanics::mesh::Vector;
use mechanics::meshing::{MeshingError, MeshingSettings, SizeField, mesh};
use mechanics::progress::{Phase, Progress, Unobserved};

use super::domains::{Body, ball, balls, shell};
use super::uniform;

fn refusal(domain: &dyn Domain, settings: &MeshingSettings) -> MeshingError {
    mesh(domain, settings, &Unobserved).unwrap_err()
}

#[test]
fn a_body_without_tissue_is_refused_by_name() {
    let nothing = Body::skin(10.0, |_| -1e3);
    assert!(matches!(refusal(&nothing, &uniform(2.0)), MeshingError::Empty { .. }));
    // 0.5 mm of tissue fall between the nodes of a lattice of 8 mm.
    let thin = shell(39.5, 40.0);
    assert!(matches!(refusal(&thin, &uniform(20.0)), MeshingError::Empty { .. }));
}

#[test]
fn more_tetrahedra_than_allowed_are_refused_before_they_are_made() {
    for finest in [0.5, 1e-2] {
        let refused = refusal(&ball(40.0), &uniform(finest));
        let MeshingError::TooMany { estimated, allowed, .. } = refused else { panic!("{refused}") };
        assert!(allowed == 4_000_000 && estimated > allowed, "{refused}");
    }
    let refused = refusal(&ball(40.0), &uniform(1e-7));
    assert!(matches!(refused, MeshingError::TooFine { .. }), "{refused}");
}

#[test]
fn settings_that_mean_nothing_are_refused_with_their_value() {
    let sizes = [
        SizeField::uniform(0.0),
        SizeField::uniform(f64::NAN),
        SizeField { coarsest: 1.0, ..SizeField::uniform(2.0) },
        SizeField { grading: -1.0, ..SizeField::uniform(2.0) },
        SizeField { at_boundary: Some(f64::INFINITY), ..SizeField::uniform(2.0) },
    ];
    for size in sizes {
        let settings = MeshingSettings { size, ..MeshingSettings::default() };
        let refused = refusal(&ball(10.0), &settings);
        assert!(matches!(refused, MeshingError::Setting { .. }), "{refused}");
    }
}

#[test]
fn bounds_that_are_no_box_are_refused() {
    for (low, high) in [(1.0, -1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let body = Body { low: Vector::repeat(low), high: Vector::repeat(high), ..ball(10.0) };
        let refused = refusal(&body, &uniform(2.0));
        assert!(matches!(refused, MeshingError::Bounds { .. }), "{refused}");
    }
}

#[test]
fn values_that_are_not_finite_are_refused_with_their_place() {
    let body = Body::skin(10.0, |x| if x.norm() > 9.0 { f64::NAN } else { 10.0 - x.norm() });
    let refused = refusal(&body, &uniform(2.0));
    let MeshingError::NotFinite { at, .. } = refused else { panic!("{refused}") };
    assert!(at.norm() > 9.0);
}

/// A ball that says that it is smaller than it is.
struct Larger(Body);

impl Domain for Larger {
    fn bounds(&self) -> (Vector, Vector) {
        (Vector::repeat(-5.0), Vector::repeat(5.0))
    }

    fn coverage(&self, centre: &Vector, radius: f64) -> Coverage {
        self.0.coverage(centre, radius)
    }

    fn value(&self, point: &Vector) -> f64 {
        self.0.value(point)
    }

    fn crossing(&self, inside: &Vector, outside: &Vector) -> Crossing {
        self.0.crossing(inside, outside)
    }

    fn projection(&self, point: &Vector, boundary: Boundary) -> Vector {
        self.0.projection(point, boundary)
    }

    fn thickness(&self, point: &Vector) -> f64 {
        self.0.thickness(point)
    }
}

#[test]
fn tissue_beyond_its_bounds_is_never_a_mesh_with_a_false_boundary() {
    let refused = refusal(&Larger(ball(10.0)), &uniform(2.0));
    let MeshingError::Broken { count, at, .. } = refused else { panic!("{refused}") };
    assert!(count > 0 && at.amax() > 5.0, "{refused}");
}

/// Stops at a question; counts them.
struct StopAt {
    question: usize,
    asked: AtomicUsize,
}

impl Progress for StopAt {
    fn phase(&self, phase: Phase) {
        assert_eq!(phase, Phase::Mesh);
    }

    fn iteration(&self, _: usize, _: f64, _: f64) {}

    fn is_cancelled(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.question
    }
}

#[test]
fn cancelling_ends_at_any_question() {
    let stop_at = |question| StopAt { question, asked: AtomicUsize::new(0) };
    let whole = stop_at(usize::MAX);
    mesh(&ball(20.0), &uniform(4.0), &whole).unwrap();
    let questions = whole.asked.into_inner();
    assert!(questions > 20, "{questions}");
    for question in 0..questions {
        let ended = mesh(&ball(20.0), &uniform(4.0), &stop_at(question));
        assert_eq!(ended.unwrap_err(), MeshingError::Cancelled);
    }
}

#[test]
fn tissue_of_which_a_small_part_would_be_kept_is_refused() {
    let ball = |x: f64| (Vector::x() * x, 12.0);
    let four = balls(vec![ball(-60.0), ball(-20.0), ball(20.0), ball(60.0)]);
    let refused = refusal(&four, &uniform(4.0));
    let MeshingError::Scattered { pieces: 4, all, kept } = refused else { panic!("{refused}") };
    assert!((all / kept - 4.0).abs() < 0.1, "{refused}");
    // Noise: tissue and none change within a fraction of a cell.
    let noise = Body::skin(40.0, |x| {
        let waves = (x * 37.0).map(f64::sin);
        (40.0 - x.norm()).min(0.01 * (waves.sum() - 1.3))
    });
    let refused = refusal(&noise, &MeshingSettings { target: Some(5000), ..uniform(4.0) });
    println!("{refused}");
    let is_none = matches!(
        refused,
        MeshingError::Scattered { .. } | MeshingError::TooFew { target: 5000, .. }
    );
    assert!(is_none, "{refused}");
}

#[test]
fn where_nothing_is_dropped_the_volume_of_that_is_no_negative_zero() {
    let made = mesh(&ball(20.0), &uniform(4.0), &Unobserved).unwrap();
    assert_eq!(made.report.dropped_volume().to_bits(), 0.0_f64.to_bits());
}
