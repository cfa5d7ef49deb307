//! Axes that only some methods have: fibres, and the time that a spline takes to come to rest. The others get no probe.

use std::collections::BTreeMap;

use super::axis::{
    FINER, ProbeOutcome, RING, TENTH_OF_MOVEMENT, default_case, finer, found, moved, numbers,
    values,
};
use super::scenes::{LEVELS, POISSON_RATIO, YOUNG_MODULUS, jaw, shape_for, shift, with_region};
use super::{Axis, Probe, Refusal, Truth, Variant};
use crate::material::{Fibre, FibreLaw, LinearElastic, MaterialError};
use crate::mesh::{CellShape, Vector};
use crate::model::spline::stepping::{Clock, Damping, Scheme};
use crate::model::spline::{ControlPoints, Stiffness, VolumeSpline};
use crate::prediction::{Case, FibreDirection, Method, Settings};

pub fn every() -> Vec<Axis> {
    vec![fibre_ratio(), fibre_ratio_of_kim(), time_step(), explicit_time_step()]
}

// Fibres.

fn fibre_ratio() -> Axis {
    Axis {
        name: "fibre_ratio",
        title: "Fibre ratio",
        unit: "E along / E across",
        scene: "the layer of `poisson_ratio`, nu 0.43, its middle third with fibres along x; engineering constants",
        reference: FINER,
        bound_mm: TENTH_OF_MOVEMENT,
        values: numbers(&[0.2, 0.5, 1.0, 2.0, 10.0, 100.0, 1e3, 1e5]),
        probe: |ratio, variant| fibred_probe(ratio, FibreLaw::Engineering, variant),
        truth: |ratio| {
            finer(fibred(ratio, FibreLaw::Engineering, CellShape::Tet4), jaw(shift(moved())))
        },
        finite_truth: None,
    }
}

fn fibre_ratio_of_kim() -> Axis {
    Axis {
        name: "fibre_ratio_kim_2012",
        title: "Fibres, Kim et al.",
        unit: "E along / E across",
        scene: "the same with the stiffness of Kim et al. 2012",
        reference: FINER,
        bound_mm: TENTH_OF_MOVEMENT,
        values: numbers(&[0.2, 0.5, 1.0, 1.2, 1.5, 2.0, 3.0, 10.0]),
        probe: |ratio, variant| fibred_probe(ratio, FibreLaw::Kim2012, variant),
        truth: |ratio| {
            finer(fibred(ratio, FibreLaw::Kim2012, CellShape::Tet4), jaw(shift(moved())))
        },
        finite_truth: None,
    }
}

fn fibred_probe(ratio: f64, law: FibreLaw, variant: &Variant) -> ProbeOutcome {
    if !variant.settings.method.properties().knows_fibres {
        return Ok(None);
    }
    found(fibred(ratio, law, shape_for(&variant.settings))?, jaw(shift(moved())), variant)
}

/// The layer whose middle third is a muscle.
fn fibred(ratio: f64, law: FibreLaw, shape: CellShape) -> Result<Case, Refusal> {
    let refused = |error: MaterialError| {
        Refusal::new("/case/materials/muscle/fibre", "out-of-range", &error.to_string())
    };
    let mut case = with_region(default_case(&LEVELS, RING, shape)?, 1, "muscle");
    let young_modulus = YOUNG_MODULUS * ratio;
    let across = LinearElastic::new(YOUNG_MODULUS, POISSON_RATIO, 1.0).map_err(refused)?;
    let fibre = Fibre { young_modulus, shear_modulus: None, law };
    let muscle = across.with_fibre(&fibre).map_err(refused)?;
    case.materials.insert("muscle".to_owned(), muscle);
    case.fibres = BTreeMap::from([("muscle".to_owned(), FibreDirection::Uniform(Vector::x()))]);
    Ok(case)
}

// Time.

/// Control points in mm that leave a step of the explicit scheme that can be taken.
const SPACING: f64 = 12.0;
/// Damping with which explicit steps come to rest soon, in 1/ms and ms.
const DAMPING: Damping = Damping { mass: 0.2, stiffness: 0.2 };
/// When the tissue has to be at rest, in ms.
const END: f64 = 4000.0;
/// A thousandth of what the patch moves by.
const AT_REST: f64 = 0.0022;

fn time_step() -> Axis {
    Axis {
        name: "time_step",
        title: "Implicit time step",
        unit: "ms",
        scene: "the layer of `poisson_ratio`, nu 0.43, a spline of 12 mm, backward Euler",
        reference: "the same spline at rest at once",
        bound_mm: AT_REST,
        values: numbers(&[0.1, 1.0, 10.0, 100.0, 1000.0, 3000.0]),
        probe: |step, variant| stepped(step, Scheme::BackwardEuler, variant),
        truth: |_| at_once(),
        finite_truth: None,
    }
}

fn explicit_time_step() -> Axis {
    Axis {
        name: "explicit_time_step",
        title: "Explicit time step",
        unit: "ms",
        scene: "the same, explicit steps",
        reference: "the same spline at rest at once",
        bound_mm: AT_REST,
        values: values(&[
            (0.01, "0.01"),
            (0.03, "0.03"),
            (0.1, "0.1"),
            (0.3, "0.3"),
            (1.0, "1"),
            (10.0, "10"),
        ]),
        probe: |step, variant| stepped(step, Scheme::Explicit, variant),
        truth: |_| at_once(),
        finite_truth: None,
    }
}

/// None for what is no spline of the tissue's own elasticity.
fn stepped(step: f64, scheme: Scheme, variant: &Variant) -> ProbeOutcome {
    let is_galerkin = matches!(
        &variant.settings.method,
        Method::VolumeSpline(spline) if spline.stiffness == Stiffness::Galerkin
    );
    if !is_galerkin {
        return Ok(None);
    }
    spline(Some(Clock { scheme, step, end: END })).map(Some)
}

fn at_once() -> Truth {
    spline(None).map_or(Truth::Impossible, |probe| Truth::Solved(Box::new(probe)))
}

fn spline(clock: Option<Clock>) -> Result<Probe, Refusal> {
    let spline = VolumeSpline {
        control: ControlPoints::Spaced(SPACING),
        damping: DAMPING,
        clock,
        ..VolumeSpline::default()
    };
    let settings = Settings {
        method: Method::VolumeSpline(spline),
        relative_residual: 1e-6,
        ..Settings::default()
    };
    Ok(Probe {
        case: default_case(&LEVELS, RING, CellShape::Tet4)?,
        plan: jaw(shift(moved())),
        settings,
    })
}
