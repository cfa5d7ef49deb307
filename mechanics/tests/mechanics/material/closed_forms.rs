//! Hyperelastic laws against closed forms of incompressible tissue (docs/verification.md#v17), printed values of
//! compressible tissue (docs/verification.md#v18, docs/verification.md#v19) and of Rubin and Bodner's law
//! (docs/verification.md#printed-values), and what every law has to leave alone.

use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::point::{FibreAtPoint, Point};
use mechanics::material::hyperelastic::{
    Fibres, Fung, Law, MooneyRivlin, NeoHookean, NeoHookeanIsochoric, Ogden, OgdenTerm,
    PolyconvexBarrier, RubinBodner, SaintVenantKirchhoff, VerondaWestmann, Volumetric,
};
use nalgebra::{Matrix3, Rotation3, Vector3};

use super::hyperelastic::{root, rows};

/// A million times the shear moduli.
const BULK: Volumetric = Volumetric::Barrier(5e6);

const MUSCLE: RubinBodner =
    RubinBodner { eps0: 3700.0, p: 25.0, eta1: 595.0, eta2: 0.00216, theta: 1.0 };
const REST: RubinBodner =
    RubinBodner { eps0: 1700.0, p: 36.0, eta1: 1294.0, eta2: 8e-5, theta: 1.0 };

/// Nominal stress in Pa at uniaxial stretches of .8, 1.1, 1.3, 1.5, equibiaxial ones of 1.1 and 1.3, and shears of .1 and .3.
struct Incompressible {
    law: Law,
    stress: [f64; 8],
}

fn incompressible() -> Vec<Incompressible> {
    let row = |law, stress| Incompressible { law, stress };
    let isochoric = NeoHookeanIsochoric { mu: 5.0, volumetric: BULK };
    let polynomial =
        MooneyRivlin { c10: 2.0, c01: 0.5, c20: 0.0, c11: 0.0, c02: 0.0, volumetric: BULK };
    vec![
        row(
            Law::NeoHookeanIsochoric(isochoric),
            [-3812.5, 1367.769, 3541.420, 5277.778, 2395.393, 5153.355, 500.0, 1500.0],
        ),
        row(
            Law::MooneyRivlin(polynomial),
            [-4003.125, 1342.900, 3377.970, 4925.926, 2496.000, 5864.518, 500.0, 1500.0],
        ),
        row(
            Law::Ogden(Ogden::new(&[OgdenTerm { mu: 2.5, alpha: 4.0 }], BULK)),
            [-3602.813, 1449.213, 4354.585, 7696.759, 2267.256, 5256.751, 502.5, 1567.5],
        ),
        row(
            Law::Fung(Fung { mu: 5.0, b: 1.0, volumetric: BULK }),
            [-4385.419, 1406.863, 4450.379, 9457.787, 2655.309, 10694.993, 505.025, 1641.261],
        ),
        row(
            Law::VerondaWestmann(VerondaWestmann { c1: 1.0, g: 2.0, volumetric: BULK }),
            [-2129.296, 660.290, 3384.442, 12151.29, 1195.371, 14272.979, 208.081, 836.661],
        ),
        row(
            Law::RubinBodner(MUSCLE),
            [-6140.144, 2189.571, 5730.873, 8705.964, 3850.155, 8568.373, 799.632, 2409.281],
        ),
    ]
}

fn diagonal(x: f64, y: f64, z: f64) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(x, y, z))
}

/// P11 in Pa of tissue that is pulled along x and free elsewhere.
fn pulled(stress: impl Fn(Matrix3<f64>) -> Matrix3<f64>, stretch: f64) -> [f64; 2] {
    let side = root(0.4, 1.4, |side| stress(diagonal(stretch, side, side))[(1, 1)]);
    [1000.0 * stress(diagonal(stretch, side, side))[(0, 0)], side]
}

/// P11 and P22 in Pa of a sheet that is pulled along x and y.
fn stretched(stress: impl Fn(Matrix3<f64>) -> Matrix3<f64>, stretch: f64) -> [f64; 2] {
    let across = root(0.4, 1.4, |across| stress(diagonal(stretch, stretch, across))[(2, 2)]);
    let stress = stress(diagonal(stretch, stretch, across));
    [0, 1].map(|axis| 1000.0 * stress[(axis, axis)])
}

fn near(found: f64, printed: f64) -> bool {
    (found / printed - 1.0).abs() < 1e-3
}

#[test]
fn incompressible_tissue_is_pulled_stretched_and_sheared_as_printed() {
    for Incompressible { law, stress } in incompressible() {
        let at = |f: Matrix3<f64>| Point::new(&law, None, f).stress();
        let mut found: Vec<f64> = [0.8, 1.1, 1.3, 1.5].map(|stretch| pulled(at, stretch)[0]).into();
        found.extend([1.1, 1.3].map(|stretch| stretched(at, stretch)[0]));
        found.extend([0.1, 0.3].map(|shear| {
            let mut f = Matrix3::identity();
            f[(0, 1)] = shear;
            1000.0 * at(f)[(0, 1)]
        }));
        for (found, printed) in found.iter().zip(stress) {
            assert!(near(*found, printed), "{law:?}: {found} {printed}");
        }
    }
}

#[test]
fn incompressible_tissue_with_fibres_is_pulled_along_and_across_as_printed() {
    let law = Law::NeoHookeanIsochoric(NeoHookeanIsochoric { mu: 5.0, volumetric: BULK });
    let fibres = Fibres { k1: 3.0, k2: 2.0 };
    let along = Some(FibreAtPoint { law: &fibres, direction: Vector3::x() });
    let at = |f: Matrix3<f64>| Point::new(&law, along, f).stress();
    for (stretch, printed) in [(0.8, -3812.5), (1.1, 2881.567), (1.3, 17488.359), (1.5, 261_326.6)]
    {
        let [found, _] = pulled(at, stretch);
        // Fibres of 261 kPa swell tissue whose bulk modulus is twenty thousand times as large.
        assert!(near(found, printed), "{stretch}: {found}");
    }
    for (stretch, printed) in [(1.1, [3909.192, 2395.393]), (1.3, [19100.294, 5153.355])] {
        for (found, printed) in stretched(at, stretch).into_iter().zip(printed) {
            assert!(near(found, printed), "{stretch}: {found}");
        }
    }
}

#[test]
fn compressible_tissue_is_pulled_and_pressed_as_printed() {
    let (lambda, mu) = (59.075_342_466, 5.136_986_301);
    let table = [
        (
            Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu }),
            [(0.8, -2160.0, 1.079630), (1.1, 1732.5, 0.950474), (1.3, 6727.5, 0.826196)],
        ),
        (
            Law::NeoHookean(NeoHookean { lambda, mu }),
            [(0.8, -3760.954, 1.107116), (1.1, 1374.034, 0.956961), (1.3, 3580.767, 0.885340)],
        ),
        (
            Law::PolyconvexBarrier(PolyconvexBarrier { lambda, mu }),
            [(0.8, -4137.832, 1.104730), (1.1, 1318.586, 0.956627), (1.3, 3200.486, 0.883129)],
        ),
    ];
    for (law, rows) in table {
        let at = |f: Matrix3<f64>| Point::new(&law, None, f).stress();
        for (stretch, force, side) in rows {
            let [found, beside] = pulled(at, stretch);
            assert!((found / force - 1.0).abs() < 1e-6, "{law:?} {stretch}: {found}");
            assert!((beside - side).abs() < 1e-6, "{law:?} {stretch}: {beside}");
        }
    }
}

#[test]
fn rubin_and_bodner_have_the_printed_energy_and_stress() {
    let sample = Matrix3::new(1.2, 0.1, -0.05, 0.05, 0.9, 0.1, 0.02, -0.1, 1.05);
    let f = sample * f64::cbrt(1.001 / sample.determinant());
    let point = |law| Point::new(&Law::RubinBodner(law), None, f);
    let relative = |found: f64, printed: f64| (found / printed - 1.0).abs() < 1e-8;
    let muscle = point(MUSCLE);
    assert!(relative(muscle.energy(), 1.517_810_461), "{}", muscle.energy());
    let stress = muscle.stress();
    let printed = [(0, 0, 1965.01852), (1, 1, 2589.30838), (2, 2, 2209.58572), (0, 1, -102.634406)];
    for (row, column, printed) in printed {
        assert!(relative(stress[(row, column)], printed), "{}", stress[(row, column)]);
    }
    let weaker = point(RubinBodner { theta: 0.9, ..MUSCLE });
    assert!(relative(weaker.energy(), 1.476_752_438), "{}", weaker.energy());
    assert!(relative(weaker.stress()[(0, 0)], 1963.75082), "{}", weaker.stress()[(0, 0)]);
    let rest = point(REST);
    assert!(relative(rest.energy(), 1.132_329_383), "{}", rest.energy());
    assert!(relative(rest.stress()[(0, 0)], 2014.29759), "{}", rest.stress()[(0, 0)]);
}

#[test]
fn rubin_and_bodner_have_the_printed_moduli_at_rest() {
    for (law, bulk, mu, young) in [(MUSCLE, 2.2015e6, 7.992, 23.98), (REST, 2.1998e6, 0.136, 0.408)]
    {
        let tissue = LinearElastic::of_law(Law::RubinBodner(law), 1.0).unwrap();
        assert!((tissue.bulk_modulus() / bulk - 1.0).abs() < 1e-6, "{}", tissue.bulk_modulus());
        assert!((tissue.shear_modulus() - mu).abs() < 1e-6, "{}", tissue.shear_modulus());
        assert!((tissue.young_modulus() / young - 1.0).abs() < 1e-3, "{}", tissue.young_modulus());
    }
}

#[test]
fn a_law_that_is_softer_than_nothing_at_rest_is_refused_with_its_moduli() {
    let law = MooneyRivlin {
        c10: -1.0,
        c01: 0.5,
        c20: 0.0,
        c11: 0.0,
        c02: 0.0,
        volumetric: Volumetric::Barrier(10.0),
    };
    let refused = LinearElastic::of_law(Law::MooneyRivlin(law), 1.0).unwrap_err().to_string();
    assert!(refused.contains("Young's modulus of -3.1"), "{refused}");
}

/// V.19: W(RF) = W(F), and S of turned tissue is turned.
#[test]
fn turning_costs_no_energy_and_turns_the_stress() {
    let f = Matrix3::new(1.2, 0.1, -0.05, 0.05, 0.9, 0.1, 0.02, -0.1, 1.05);
    let axis = nalgebra::Unit::new_normalize(Vector3::new(1.0, 2.0, 3.0));
    let turn = Rotation3::from_axis_angle(&axis, 37_f64.to_radians()).into_inner();
    for row in rows() {
        let fibres = Fibres { k1: 3.0, k2: 2.0 };
        let along = row.fibres.map(|direction| FibreAtPoint { law: &fibres, direction });
        let [at, turned] = [f, turn * f].map(|f| Point::new(&row.law, along, f));
        assert!((at.energy() - turned.energy()).abs() < 1e-12 * at.energy(), "{}", row.name);
        let apart = (turn * at.stress() - turned.stress()).amax();
        assert!(apart < 1e-12 * at.stress().amax(), "{}: {apart}", row.name);
    }
}

#[test]
fn equal_stretches_and_nearly_equal_ones_have_the_same_tangent() {
    let law = Law::Ogden(Ogden::new(
        &[OgdenTerm { mu: 2.0, alpha: 3.0 }, OgdenTerm { mu: -2.1, alpha: -2.0 }],
        Volumetric::Barrier(62.5),
    ));
    let block = |f: Matrix3<f64>| {
        let point = Point::new(&law, None, f);
        let [a, b] = [Vector3::new(0.3, 0.5, -0.2), Vector3::new(-0.1, 0.4, 0.6)];
        point.block(&point.corner(&a), &point.corner(&b))
    };
    for stretch in [0.6, 1.0, 1.7] {
        let equal = block(diagonal(stretch, stretch, stretch));
        // Both sides of the distance from which on a quotient is taken.
        for apart in [1e-8, 3e-6, 3e-5] {
            let nearly = block(diagonal(stretch, stretch * (1.0 + apart), stretch * (1.0 - apart)));
            let change = (nearly - equal).amax() / equal.amax();
            assert!(change < 20.0 * apart + 1e-9, "{stretch} {apart}: {change:e}");
        }
    }
}

#[test]
fn a_barrier_grows_as_volume_goes_and_stays_a_number() {
    let law = PolyconvexBarrier { lambda: 59.0, mu: 5.1 };
    let energy =
        |j: f64| Point::new(&Law::PolyconvexBarrier(law), None, diagonal(j, 1.0, 1.0)).energy();
    assert!(energy(1e-6).is_finite() && energy(1e-6) > energy(1e-3) && energy(1e-3) > energy(0.1));
}
