//! Common parts of the axes of the map of failures: scenes, reference solutions and values.

use super::scenes::{POISSON_RATIO, YOUNG_MODULUS, halved, layer, on_bone, tissue};
use super::{Probe, Refusal, Truth, Variant};
use crate::material::hyperelastic::{Law, SaintVenantKirchhoff};
use crate::material::{LinearElastic, MaterialError};
use crate::mesh::{CellShape, Vector};
use crate::prediction::{Case, ElementChoice, Laws, Method, Plan, Settings};

/// A tenth of the movement of 2.24 mm that linear axes make.
pub(super) const TENTH_OF_MOVEMENT: f64 = 0.22;

/// The free ring around the patch, in mm.
pub(super) const RING: f64 = 8.0;

pub(super) const FINER: &str = "linear finite elements, quadratic, every edge halved";

/// The same for both kinds of strain.
pub(super) const FINER_OF_ITS_STRAIN: &str = "linear finite elements, quadratic, every edge halved; for methods of finite \
    strain nonlinear ones, stabilised, of the same law, on the same mesh";

pub(super) type ProbeOutcome = Result<Option<Probe>, Refusal>;

pub(super) fn values(list: &[(f64, &str)]) -> Vec<(f64, String)> {
    list.iter().map(|(value, words)| (*value, (*words).to_owned())).collect()
}

pub(super) fn numbers(list: &[f64]) -> Vec<(f64, String)> {
    list.iter().map(|value| (*value, value.to_string())).collect()
}

pub(super) fn moved() -> Vector {
    Vector::new(1.0, 0.0, 2.0)
}

/// A material of a region, or what the documents' check says of it.
pub(crate) fn material(
    young_modulus: f64,
    nu: f64,
    region: &str,
) -> Result<LinearElastic, Refusal> {
    LinearElastic::new(young_modulus, nu, 1.0).map_err(|error| {
        let field = match error {
            MaterialError::PoissonRatio(_) => "poisson_ratio",
            MaterialError::Density(_) => "density_g_per_cm3",
            _ => "young_modulus_kpa",
        };
        let pointer = format!("/case/materials/{region}/{field}");
        Refusal::new(&pointer, "out-of-range", &error.to_string())
    })
}

pub(super) fn found(case: Case, plan: Plan, variant: &Variant) -> ProbeOutcome {
    Ok(Some(Probe { case, plan, settings: variant.settings.clone() }))
}

/// The truth of a case of tetrahedra on a mesh of half the size; impossible where there is no such case.
pub(super) fn finer(case: Result<Case, Refusal>, plan: Plan) -> Truth {
    let settings = Settings { element: ElementChoice::Quadratic, ..Settings::default() };
    halved_by(case, plan, settings)
}

/// The same at finite strain, of the law that a method with such laws solves where none is stated.
pub(super) fn fine_finite_strain_truth(
    case: Result<Case, Refusal>,
    plan: Plan,
    laws: Laws,
) -> Truth {
    let (method, element) = (Method::FemNonlinear, ElementChoice::Stabilised);
    let case = case.and_then(|case| match laws {
        Laws::SaintVenantKirchhoff => of_saint_venant_kirchhoff(case),
        Laws::AtRest | Laws::Any => Ok(case),
    });
    halved_by(case, plan, Settings { method, element, ..Settings::default() })
}

fn of_saint_venant_kirchhoff(mut case: Case) -> Result<Case, Refusal> {
    for material in case.materials.values_mut() {
        let (lambda, mu) = (material.lambda(), material.shear_modulus());
        let law = Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu });
        *material = LinearElastic::of_law(law, material.density())
            .map_err(|error| Refusal::new("/case/materials", "out-of-range", &error.to_string()))?;
    }
    Ok(case)
}

fn halved_by(case: Result<Case, Refusal>, plan: Plan, settings: Settings) -> Truth {
    case.map_or(Truth::Impossible, |case| {
        Truth::Solved(Box::new(Probe { case: halved(case), plan, settings }))
    })
}

pub(super) fn default_case(levels: &[f64], ring: f64, shape: CellShape) -> Result<Case, Refusal> {
    let material = material(YOUNG_MODULUS, POISSON_RATIO, "*")?;
    Ok(on_bone(layer(levels, ring, shape), tissue(material)))
}
