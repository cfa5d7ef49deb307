//! The variants of a study: every model that is built, with its usual settings.

use super::variant::Variant;
use crate::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use crate::model::mass_spring::{MassSpringSettings, Search};
use crate::model::spline::{Stiffness, VolumeSpline};
use crate::model::thickness_warp::ThicknessWarp;
use crate::prediction::{
    Accepted, ElementChoice, Method, MethodKind, Settings, USUALLY_ACCEPTED_MM,
};
use crate::solver::stationary::{Iteration, Stationary};

/// The residual at which the papers' own iterations end: their answer is then within 0.01 mm of rest on the skin
/// (`cargo bench --bench iterations`), and a smaller one would only make them look slower.
const OWN_ITERATIONS_RESIDUAL: f64 = 1e-5;

/// Sweeps after which the papers' own iterations are given up.
const OWN_ITERATIONS: usize = 50_000;

/// The method that is chosen by its error, as documents call it.
pub const AUTO: &str = "auto";

/// Links of the lattice in mN/mm, which is N/m (Ulusoy et al. 2010).
const PAPER_STIFFNESS: f64 = 80.0;

/// All of every method, each with its usual settings.
pub fn available() -> Vec<Variant> {
    MethodKind::ALL.iter().flat_map(|method| of_method(*method)).collect()
}

/// The cheapest model whose estimated error is accepted.
pub fn auto() -> Variant {
    let accepted = Accepted { skin_mm: USUALLY_ACCEPTED_MM, ..Accepted::default() };
    Variant {
        method: AUTO.to_owned(),
        accepted: Some(accepted),
        ..variant(AUTO, Method::FemLinear)
    }
}

/// Those of one method.
pub fn of_method(method: MethodKind) -> Vec<Variant> {
    match method {
        MethodKind::FemLinear => vec![
            finite_elements(Method::FemLinear, "plain", ElementChoice::Plain),
            finite_elements(Method::FemLinear, "stabilised", ElementChoice::Stabilised),
            finite_elements(Method::FemLinear, "quadratic", ElementChoice::Quadratic),
        ],
        MethodKind::FemNonlinear => vec![
            finite_elements(Method::FemNonlinear, "plain", ElementChoice::Plain),
            finite_elements(Method::FemNonlinear, "stabilised", ElementChoice::Stabilised),
        ],
        MethodKind::MassTensor => vec![
            variant("mtm", Method::MassTensor(MassTensorSettings::default())),
            mass_tensor("mtm gauss_seidel", Iteration::GaussSeidel),
            mass_tensor("mtm damped_jacobi", Iteration::DampedJacobi),
            mass_tensor("mtm jacobi", Iteration::Jacobi),
        ],
        MethodKind::MassTensorTransverse => {
            vec![variant("mtm_ti", Method::MassTensorTransverse(MassTensorSettings::default()))]
        }
        MethodKind::MassTensorNonlinear => {
            // Saint Venant-Kirchhoff tissue gives way where it is pressed: on the ladder to show that.
            let tensors = variant("mtm_nonlinear", Method::MassTensorNonlinear);
            vec![Variant { may_fail: true, ..tensors }]
        }
        MethodKind::MassSpring => vec![
            mass_spring("msm newton", Search::Newton),
            mass_spring("msm direct", Search::Direct),
        ],
        MethodKind::VolumeSpline => vec![
            volume_spline("dvs galerkin", Stiffness::Galerkin),
            volume_spline("dvs lattice", Stiffness::Lattice(PAPER_STIFFNESS)),
        ],
        MethodKind::ThicknessWarp => {
            vec![variant("thickness_warp", Method::ThicknessWarp(ThicknessWarp::default()))]
        }
    }
}

fn variant(label: &str, method: Method) -> Variant {
    Variant {
        method: method.kind().name().to_owned(),
        label: label.to_owned(),
        settings: Settings { method, ..Settings::default() },
        accepted: None,
        may_fail: false,
    }
}

fn finite_elements(method: Method, element: &str, choice: ElementChoice) -> Variant {
    let mut elements = variant(&format!("{} {element}", method.kind().name()), method);
    elements.settings.element = choice;
    elements
}

fn mass_tensor(label: &str, iteration: Iteration) -> Variant {
    let own = Stationary { iteration, relative_change: None, most_iterations: OWN_ITERATIONS };
    let settings = MassTensorSettings { iterations: Iterations::Stationary(own) };
    let mut tensors = variant(label, Method::MassTensor(settings));
    tensors.settings.relative_residual = OWN_ITERATIONS_RESIDUAL;
    // Plain Jacobi is on the ladder to show that it diverges.
    tensors.may_fail = matches!(iteration, Iteration::Jacobi);
    tensors
}

fn mass_spring(label: &str, search: Search) -> Variant {
    let settings = MassSpringSettings { search, most_iterations: OWN_ITERATIONS };
    let mut springs = variant(label, Method::MassSpring(settings));
    springs.settings.relative_residual = OWN_ITERATIONS_RESIDUAL;
    // Node by node it needs more sweeps than `OWN_ITERATIONS`, or the time of a row, on fine meshes.
    springs.may_fail = matches!(search, Search::Direct);
    springs
}

fn volume_spline(label: &str, stiffness: Stiffness) -> Variant {
    variant(label, Method::VolumeSpline(VolumeSpline { stiffness, ..VolumeSpline::default() }))
}
