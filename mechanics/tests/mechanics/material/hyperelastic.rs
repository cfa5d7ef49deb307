//! Hyperelastic laws: printed values (docs/verification.md#printed-values), derivatives against differences, rest and turning.

use mechanics::material::hyperelastic::point::{FibreAtPoint, Point};
use mechanics::material::hyperelastic::{
    Fibres, Fung, Law, MooneyRivlin, NeoHookean, NeoHookeanIsochoric, Ogden, OgdenTerm,
    PolyconvexBarrier, SaintVenantKirchhoff, VerondaWestmann, Volumetric,
};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// E 15 kPa, nu .46.
const MU: f64 = 5.136_986_301;
const LAMBDA: f64 = 59.075_342_466;
const BULK: Volumetric = Volumetric::Barrier(62.5);
pub const FIBRES: Fibres = Fibres { k1: 3.0, k2: 2.0 };

fn mooney_rivlin(c10: f64, c01: f64, c20: f64, volumetric: Volumetric) -> Law {
    Law::MooneyRivlin(MooneyRivlin { c10, c01, c20, c11: 0.0, c02: 0.0, volumetric })
}

pub struct Row {
    pub name: &'static str,
    pub law: Law,
    pub fibres: Option<Vector3<f64>>,
    energy: f64,
    /// Row by row.
    stress: Vec<f64>,
    along_h: f64,
    /// P11 and the lateral stretch at .7, .9, 1.2 and 1.5.
    pub uniaxial: Vec<[f64; 2]>,
    /// P11 and the stretch across the sheet at .9 and 1.2.
    pub equibiaxial: Vec<[f64; 2]>,
    /// Cauchy s12, s11, s22, s33 at a shear of .6.
    pub shear: Vec<f64>,
}

/// The printed numbers.
const TABLE: &str = include_str!("laws.txt");

fn law(name: &str) -> Law {
    match name {
        "Saint Venant-Kirchhoff" => {
            Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda: LAMBDA, mu: MU })
        }
        "neo-Hookean" => Law::NeoHookean(NeoHookean { lambda: LAMBDA, mu: MU }),
        "neo-Hookean, isochoric" | "fibres in neo-Hookean tissue" => {
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric { mu: MU, volumetric: BULK })
        }
        "Mooney-Rivlin" => mooney_rivlin(2.0, 0.568_493_151, 0.0, BULK),
        "Veronda-Westmann" => {
            Law::VerondaWestmann(VerondaWestmann { c1: 2.568_493_151, g: 2.0, volumetric: BULK })
        }
        "Fung" => Law::Fung(Fung { mu: MU, b: 1.0, volumetric: BULK }),
        "Ogden" => {
            let terms = [(2.0, 3.0), (-2.136_986_301, -2.0)];
            let terms = terms.map(|(mu, alpha)| OgdenTerm { mu, alpha });
            Law::Ogden(Ogden::new(&terms, BULK))
        }
        "polyconvex barrier" => {
            Law::PolyconvexBarrier(PolyconvexBarrier { lambda: LAMBDA, mu: MU })
        }
        "the generic face" => mooney_rivlin(2.5, 0.0, 1.175, Volumetric::Logarithmic(25.0)),
        other => panic!("{other}"),
    }
}

pub fn rows() -> Vec<Row> {
    let lines = TABLE.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let mut parts = line.split("; ");
            let name = parts.next().unwrap();
            let numbers: Vec<Vec<f64>> = parts
                .map(|part| part.split(' ').map(|number| number.parse().unwrap()).collect())
                .collect();
            let pairs = |numbers: &[f64]| numbers.chunks(2).map(|two| [two[0], two[1]]).collect();
            Row {
                name,
                law: law(name),
                fibres: name.starts_with("fibres").then(|| Vector3::new(0.6, 0.8, 0.0)),
                energy: numbers[0][0],
                stress: numbers[1].clone(),
                along_h: numbers[2][0],
                uniaxial: pairs(&numbers[3]),
                equibiaxial: pairs(&numbers[4]),
                shear: numbers[5].clone(),
            }
        })
        .collect()
}

fn point(row: &Row, direction: Option<Vector3<f64>>, f: Matrix3<f64>) -> Point {
    Point::new(&row.law, direction.map(|direction| FibreAtPoint { law: &FIBRES, direction }), f)
}

fn sample() -> Matrix3<f64> {
    Matrix3::new(1.2, 0.1, -0.05, 0.05, 0.9, 0.1, 0.02, -0.1, 1.05)
}

/// H : A : H.
fn twice_along(point: &Point, h: &Matrix3<f64>) -> f64 {
    let corners = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| point.corner(&axis));
    let mut sum = 0.0;
    for (a, one) in corners.iter().enumerate() {
        for (b, other) in corners.iter().enumerate() {
            sum += h.column(a).dot(&(point.block(one, other) * h.column(b)));
        }
    }
    sum
}

#[test]
fn every_law_has_the_printed_energy_stress_and_tangent() {
    let h = Matrix3::new(0.1, 0.2, 0.0, 0.0, -0.1, 0.3, 0.1, 0.0, 0.2);
    for row in rows() {
        let point = point(&row, row.fibres, sample());
        assert!((point.energy() - row.energy).abs() < 2e-10, "{}", row.name);
        let printed = Matrix3::from_row_slice(&row.stress);
        assert!((point.stress() - printed).amax() < 1e-8, "{}", row.name);
        assert!((twice_along(&point, &h) - row.along_h).abs() < 1e-8, "{}", row.name);
    }
}

#[test]
fn stress_is_the_slope_of_the_energy_and_the_tangent_that_of_the_stress() {
    let step = 1e-5;
    for row in rows() {
        for turn in [0.0, 0.7, 2.0] {
            let f = Rotation3::from_axis_angle(&Vector3::y_axis(), turn) * sample();
            let here = point(&row, row.fibres, f);
            for entry in 0..9 {
                let mut d = Matrix3::zeros();
                d[entry] = step;
                let [back, ahead] = [f - d, f + d].map(|f| point(&row, row.fibres, f));
                let slope = (ahead.energy() - back.energy()) / (2.0 * step);
                assert!((slope - here.stress()[entry]).abs() < 1e-7, "{}", row.name);
                let bend = (ahead.stress() - back.stress()) / (2.0 * step);
                let [i, j] = [entry % 3, entry / 3];
                let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                let own = here.corner(&axes[j]);
                for (k, axis) in axes.iter().enumerate() {
                    let column = here.block(&here.corner(axis), &own).column(i).into_owned();
                    assert!((column - bend.column(k)).amax() < 2e-5, "{} {entry} {k}", row.name);
                }
            }
        }
    }
}

#[test]
fn tissue_at_rest_has_no_stress_and_the_constants_of_the_linear_law() {
    for row in rows().iter().filter(|row| row.name != "the generic face") {
        let rest = point(row, row.fibres, Matrix3::identity());
        assert!(rest.energy().abs() < 1e-12 && rest.stress().amax() < 1e-12, "{}", row.name);
        let (lambda, mu) = row.law.at_rest();
        assert!((mu - MU).abs() < 1e-8, "{}: {mu}", row.name);
        assert!((lambda + 2.0 / 3.0 * mu - 62.5).abs() < 1e-7, "{}: {lambda}", row.name);
    }
}

/// The positive root of a rising function in an interval.
pub fn root(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        *(if value(middle) < 0.0 { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

#[test]
fn every_law_is_pulled_and_pressed_as_printed() {
    for row in rows() {
        let x = row.fibres.map(|_| Vector3::x());
        let stress = |along: f64, side: f64, across: f64| {
            point(&row, x, Matrix3::from_diagonal(&Vector3::new(along, side, across))).stress()
        };
        for (stretch, [force, side]) in [0.7, 0.9, 1.2, 1.5].into_iter().zip(row.uniaxial.clone()) {
            let found = root(0.6, 1.4, |side| stress(stretch, side, side)[(1, 1)]);
            assert!((found - side).abs() < 1e-6, "{} {stretch}: {found}", row.name);
            let found = stress(stretch, found, found)[(0, 0)];
            assert!((found - force).abs() < 2e-6, "{} {stretch}: {found}", row.name);
        }
        for (stretch, [force, across]) in [0.9, 1.2].into_iter().zip(row.equibiaxial.clone()) {
            let found = root(0.45, 1.4, |across| stress(stretch, stretch, across)[(2, 2)]);
            assert!((found - across).abs() < 1e-6, "{} {stretch}: {found}", row.name);
            let found = stress(stretch, stretch, found)[(0, 0)];
            assert!((found - force).abs() < 2e-6, "{} {stretch}: {found}", row.name);
        }
        let mut f = Matrix3::identity();
        f[(0, 1)] = 0.6;
        let cauchy = point(&row, x, f).stress() * f.transpose();
        let found = [(0, 1), (0, 0), (1, 1), (2, 2)].map(|at| cauchy[at]);
        for (found, printed) in found.into_iter().zip(&row.shear) {
            assert!((found - printed).abs() < 2e-6, "{}: {found} {printed}", row.name);
        }
    }
}

#[test]
fn an_exponential_law_goes_on_without_a_jump_where_its_exponent_is_bounded() {
    let law = Law::Fung(Fung { mu: MU, b: 40.0, volumetric: BULK });
    let stretched = |stretch: f64| {
        let side = 1.0 / f64::sqrt(stretch);
        let f = Matrix3::from_diagonal(&Vector3::new(stretch, side, side));
        Point::new(&law, None, f)
    };
    // Ibar1 - 3 = .75.
    let edge = root(1.3, 1.9, |l| l * l + 2.0 / l - 3.75);
    let [below, above] = [edge - 1e-9, edge + 1e-9].map(stretched);
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-5;
    assert!(near(below.energy(), above.energy()));
    assert!(near(below.stress()[(0, 0)], above.stress()[(0, 0)]));
    let h = Matrix3::from_diagonal(&Vector3::x());
    assert!(near(twice_along(&below, &h), twice_along(&above, &h)));
    assert!(stretched(50.0).energy().is_finite());
}
