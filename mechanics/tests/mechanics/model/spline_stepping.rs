//! docs/verification.md#v21, docs/verification.md#v22: the dynamic volume spline in time.

use std::sync::Arc;

use mechanics::mesh::Vector;
use mechanics::model::spline::stepping::{Clock, Damping, Motion, Scheme};
use mechanics::model::spline::{Stiffness, VolumeSpline};
use mechanics::prediction::{ModelError, Scene, Settings, SolverError, predict};
use mechanics::progress::Unobserved;
use mechanics::solver::element_connectivity::ElementConnectivity;
use mechanics::solver::half_matrix::{HalfMatrix, Pattern};
use mechanics::solver::row_ordering::RowOrdering;
use mechanics::solver::{System, Unknowns};

use crate::model::spline_volume::{bent, largest_difference, spaced, with};
use crate::scenes::solve;

/// V.21. Rest is where the steps to come are below 1e-10 of the displacement.
#[test]
fn time_arrives_at_the_static_limit_whatever_mass_and_damping_are() {
    let (mut case, plan) = bent();
    for stiffness in [Stiffness::Galerkin, Stiffness::Lattice(80.0)] {
        let spline = VolumeSpline { stiffness, ..spaced(12.0) };
        let at_once = solve(&case, &plan, &with(spline.clone()));
        let runs = [
            (1.0, Scheme::BackwardEuler, Damping { mass: 0.0, stiffness: 12.5 }),
            (20.0, Scheme::BackwardEuler, Damping { mass: 0.05, stiffness: 50.0 }),
            (1.0, Scheme::Newmark, Damping { mass: 0.0, stiffness: 12.5 }),
        ];
        for (density, scheme, damping) in runs {
            let heavy = mechanics::material::LinearElastic::new(15.0, 0.3, density).unwrap();
            case.materials.insert("*".to_owned(), heavy);
            let clock = Some(Clock { scheme, step: 10.0, end: 10_000.0 });
            let moved =
                solve(&case, &plan, &with(VolumeSpline { clock, damping, ..spline.clone() }));
            let difference = largest_difference(&moved.displacement, &at_once.displacement);
            println!("{scheme:?} {density}: {} steps, {difference:.1e} mm", moved.solver.steps);
            assert!(difference < 3e-8, "{scheme:?} {density}: {difference} of 3 mm");
            assert!(moved.solver.steps > 16 && moved.solver.steps < 1000);
        }
    }
}

/// A row of three equal unknowns: k in mN/mm, m in mg.
fn single(value: f64) -> System {
    let mut connectivity = ElementConnectivity::default();
    connectivity.push([0]);
    let around = connectivity.inverted(1);
    let mut matrix = HalfMatrix::zeros(Arc::new(Pattern::new(&connectivity, &around, 1)));
    (0..3).for_each(|k| matrix.diagonal[0][k][k] = value);
    System {
        ordering: Arc::new(RowOrdering::new(&connectivity, &around, &[false], 3, 0)),
        matrix,
        partly_constrained: Vec::new(),
        positions: vec![Vector::zeros()],
    }
}

/// V.22: k = 80 N/m, d = 1 N s/m, m = 1.32e-5 kg, a step of 0.01 N. Displacement in mm at a time in ms.
fn one_mass(scheme: Scheme, step: f64, end: f64) -> Result<f64, ModelError> {
    let (stiffness, mass) = (single(80.0), single(13.2).matrix);
    let force: Unknowns = vec![[10.0; 3]];
    let damping = Damping { mass: 0.0, stiffness: 1000.0 / 80.0 };
    let motion = Motion { stiffness: &stiffness, mass: &mass, damping, force: &force };
    let clock = Clock { scheme, step, end };
    let state = motion.run(&clock, 0.0, 100.0, &Unobserved)?;
    Ok(state.displacement[0][0][0])
}

/// The roots of m x² + d x + k in 1/ms, and the answer to a step.
fn exact(time: f64) -> ([f64; 2], f64) {
    let (c, square): (f64, f64) = (1000.0 / 13.2, 80.0 / 13.2);
    let root = (c * c - 4.0 * square).sqrt();
    let fast = -(c + root) / 2.0;
    let slow = square / fast;
    let decay = (fast * (slow * time).exp() - slow * (fast * time).exp()) / (fast - slow);
    ([slow, fast], 0.125 * (1.0 - decay))
}

#[test]
fn one_mass_moves_as_the_closed_form_at_the_order_of_its_scheme() {
    let ([slow, fast], _) = exact(0.0);
    // Per second, as published with seven and eight digits.
    assert!((slow * 1e3 + 80.08466).abs() < 1e-5 && (fast * 1e3 + 75_677.491).abs() < 1e-3);
    let ratio = 1000.0 / 13.2 / (2.0 * (80.0_f64 / 13.2).sqrt());
    assert!((ratio - 15.4).abs() < 0.05, "damping ratio {ratio}");
    for (time, micrometres) in
        [(5.0, 41.1567), (12.5, 79.0150), (50.0, 122.7178), (100.0, 124.9584)]
    {
        assert!((exact(time).1 * 1e3 - micrometres).abs() < 1e-4, "{time}: {}", exact(time).1);
    }
    let error = |scheme, step: f64| (one_mass(scheme, step, 12.5).unwrap() - exact(12.5).1).abs();
    for (scheme, factor) in [(Scheme::BackwardEuler, 2.0), (Scheme::Newmark, 4.0)] {
        for step in [0.625, 0.3125] {
            let found = error(scheme, step) / error(scheme, step / 2.0);
            // The next order adds a share of the step over the relaxation time, some 5 %.
            assert!((found / factor - 1.0).abs() < 0.1, "{scheme:?} {step}: {found}");
        }
    }
    for scheme in [Scheme::BackwardEuler, Scheme::Newmark] {
        assert!((one_mass(scheme, 10.0, 2000.0).unwrap() - 0.125).abs() < 1e-12, "{scheme:?}");
    }
}

#[test]
fn explicit_steps_above_their_limit_are_refused_with_it_and_below_they_run() {
    for step_s in [2.65e-5, 2.64e-5, 1e-2] {
        let refused = one_mass(Scheme::Explicit, step_s * 1e3, 50.0);
        let Err(ModelError::StepAboveLimit { step_s: found, limit_s }) = refused else {
            panic!("{step_s}: {refused:?}");
        };
        // 4 / (c + sqrt(c^2 + 4 omega^2)) = 26.37 us.
        assert!((found / step_s - 1.0).abs() < 1e-12 && (limit_s - 2.637_2e-5).abs() < 1e-9);
    }
    // Steps of 2.63e-5 s: first order, and 5 ms are 0.4 of the relaxation time.
    let found = one_mass(Scheme::Explicit, 2.63e-2, 2.63e-2 * 190.0).unwrap();
    let error = found / exact(2.63e-2 * 190.0).1 - 1.0;
    assert!(error.abs() < 0.01, "{error}");

    let (case, plan) = bent();
    let damping = Damping { mass: 0.2, stiffness: 0.2 };
    let run = |step| {
        let clock = Some(Clock { scheme: Scheme::Explicit, step, end: 2000.0 });
        let spline = VolumeSpline { clock, damping, ..spaced(20.0) };
        let settings = Settings { relative_residual: 1e-6, ..with(spline) };
        predict(&Scene::new(&case, &plan, &settings).unwrap(), &Unobserved)
    };
    let Err(ModelError::StepAboveLimit { limit_s, .. }) = run(1000.0) else {
        panic!("a step of a second");
    };
    let moved = run(limit_s * 1e3 * 0.9).unwrap();
    let at_once = solve(&case, &plan, &with(spaced(20.0)));
    let difference = largest_difference(&moved.displacement, &at_once.displacement);
    println!("limit {limit_s} s, {} steps, {difference} mm", moved.solver.steps);
    assert!(difference < 1e-4, "{difference} of 3 mm, at rest to 1e-6 by its own estimate");
}

#[test]
fn a_motion_that_is_not_at_rest_in_time_has_not_converged() {
    let (case, plan) = bent();
    let clock = Some(Clock { scheme: Scheme::BackwardEuler, step: 1.0, end: 20.0 });
    let settings = with(VolumeSpline { clock, ..spaced(20.0) });
    let ended = predict(&Scene::new(&case, &plan, &settings).unwrap(), &Unobserved);
    let Err(ModelError::Solver(SolverError::NotConverged { iterations, history, .. })) = ended
    else {
        panic!("{ended:?}");
    };
    assert_eq!((iterations, history.len()), (20, 20));
}
