//! Every way of modelling that is built, as the variants of a study; a further one adds its lines here.

use super::variant::Variant;
use crate::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use crate::model::mass_spring::{MassSpringSettings, Search};
use crate::model::spline::{Stiffness, VolumeSpline};
use crate::model::thickness_warp::ThicknessWarp;
use crate::prediction::{ElementChoice, Method, Settings};
use crate::solver::stationary::{Iteration, Stationary};

/// The residual at which the papers' own iterations end: their answer is then within 0.01 mm of rest on the skin
/// (`cargo bench --bench iterations`), and a smaller one would only make them look slower.
const OWN_ITERATIONS_RESIDUAL: f64 = 1e-5;

/// Sweeps after which the papers' own iterations are given up.
const OWN_ITERATIONS: usize = 50_000;

/// Links of the lattice in mN/mm, which is N/m (paper 000).
const PAPER_STIFFNESS: f64 = 80.0;

/// All of them, each with its usual settings.
pub fn available() -> Vec<Variant> {
    let linear = [
        ("plain", ElementChoice::Plain),
        ("stabilised", ElementChoice::Stabilised),
        ("quadratic", ElementChoice::Quadratic),
    ];
    let mut all: Vec<Variant> =
        linear.into_iter().map(|(element, choice)| fem_linear(element, choice)).collect();
    all.push(variant("mtm", "mtm", Method::MassTensor(MassTensorSettings::default())));
    all.extend(
        [
            ("mtm gauss_seidel", Iteration::GaussSeidel),
            ("mtm damped_jacobi", Iteration::DampedJacobi),
            ("mtm jacobi", Iteration::Jacobi),
        ]
        .map(|(label, iteration)| mass_tensor(label, iteration)),
    );
    all.push(variant("mtm_ti", "mtm_ti", Method::MassTensorTransverse));
    all.extend([("msm newton", Search::Newton), ("msm direct", Search::Direct)].map(
        |(label, search)| {
            let settings = MassSpringSettings { search, most_iterations: OWN_ITERATIONS };
            let mut springs = variant("msm", label, Method::MassSpring(settings));
            springs.settings.relative_residual = OWN_ITERATIONS_RESIDUAL;
            // Node by node it needs more sweeps than `OWN_ITERATIONS`, or the time of a row, on fine meshes.
            springs.may_fail = matches!(search, Search::Direct);
            springs
        },
    ));
    let lattice = Stiffness::Lattice(PAPER_STIFFNESS);
    all.extend([("dvs galerkin", Stiffness::Galerkin), ("dvs lattice", lattice)].map(
        |(label, stiffness)| {
            let spline = VolumeSpline { stiffness, ..VolumeSpline::default() };
            variant("dvs", label, Method::VolumeSpline(spline))
        },
    ));
    let warp = Method::ThicknessWarp(ThicknessWarp::default());
    all.push(variant("thickness_warp", "thickness_warp", warp));
    all
}

/// Those of one method by its name in documents; none where it is not built.
pub fn of_method(method: &str) -> Vec<Variant> {
    available().into_iter().filter(|variant| variant.method == method).collect()
}

fn variant(name: &str, label: &str, method: Method) -> Variant {
    Variant {
        method: name.to_owned(),
        label: label.to_owned(),
        settings: Settings { method, ..Settings::default() },
        may_fail: false,
    }
}

fn fem_linear(element: &str, choice: ElementChoice) -> Variant {
    let mut linear = variant("fem_linear", &format!("fem_linear {element}"), Method::FemLinear);
    linear.settings.element = choice;
    linear
}

fn mass_tensor(label: &str, iteration: Iteration) -> Variant {
    let own = Stationary { iteration, relative_change: None, most_iterations: OWN_ITERATIONS };
    let settings = MassTensorSettings { iterations: Iterations::Stationary(own) };
    let mut tensors = variant("mtm", label, Method::MassTensor(settings));
    tensors.settings.relative_residual = OWN_ITERATIONS_RESIDUAL;
    // Plain Jacobi is on the ladder to show that it diverges.
    tensors.may_fail = matches!(iteration, Iteration::Jacobi);
    tensors
}
