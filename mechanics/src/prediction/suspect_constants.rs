//! Material constants that suggest a wrong unit: they are used, with a warning that has the numbers.
//!
//! What no unit explains is refused where constants are made (`material`). Between the two lie decades in which a
//! number is more likely a mistake of a thousand than a tissue: fat has 1 to 3 kPa, bone 1e7 kPa.

use super::case::{Activation, Case, Growth, Load, Plan};
use super::scene::Scene;
use crate::material::LinearElastic;
use crate::mesh::{Vector, Warning};

/// Pa among kPa: fat and muscle are a factor of a hundred apart, fat and skin of a thousand at most.
const MODULI_APART: f64 = 1e3;

/// Young's modulus of the softest and of the stiffest tissue of a face in kPa: fat has 1 to 3, muscle up to 300, and skin up to
/// some 1000. A case all of whose tissues are beyond is in another unit.
const SOFTEST: f64 = 2000.0;
const STIFFEST: f64 = 0.5;
const THOUSAND: f64 = 1e3;

/// Most warnings of this kind.
const MOST: usize = 20;

/// What a constant is called, its unit, and between which values it is usual.
#[derive(Clone, Copy)]
struct UsualRange {
    what: &'static str,
    unit: &'static str,
    least: f64,
    most: f64,
}

const MODULUS: UsualRange =
    UsualRange { what: "Young's modulus", unit: "kPa", least: 0.1, most: 1e7 };
const FIBRE_MODULUS: UsualRange = UsualRange { what: "Young's modulus along fibres", ..MODULUS };
const FIBRE_SHEAR: UsualRange =
    UsualRange { what: "the shear modulus along fibres", least: 0.03, ..MODULUS };
/// 0 is allowed: without gravity or time no density is of use.
const DENSITY: UsualRange = UsualRange { what: "density", unit: "g/cm3", least: 0.1, most: 10.0 };
/// Skin under tension has 100 to 20 000 kPa.
const SHEET_MODULUS: UsualRange =
    UsualRange { what: "Young's modulus of the membrane", most: 5e4, ..MODULUS };
const SHEET_THICKNESS: UsualRange =
    UsualRange { what: "the thickness of the membrane", unit: "mm", least: 0.05, most: 10.0 };
/// Ulusoy et al. 2010 name 12 to 750 N/m, which are mN/mm.
const LINK: UsualRange =
    UsualRange { what: "the stiffness of a link", unit: "N/m", least: 1.0, most: 1e4 };
/// Per node: a bite exerts up to 1e6 mN on all of a jaw.
const FORCE: UsualRange =
    UsualRange { what: "the force at a node", unit: "mN", least: 1e-6, most: 1e5 };
/// Tongue and lips exert 1 to 50 kPa.
const TRACTION: UsualRange = UsualRange { what: "traction", unit: "kPa", least: 1e-2, most: 500.0 };
const PRESSURE: UsualRange = UsualRange { what: "pressure", ..TRACTION };
/// The earth has 9.81, and 9810 mm/s^2 is no m/s^2.
const GRAVITY: UsualRange = UsualRange { what: "gravity", unit: "m/s2", least: 1e-2, most: 100.0 };
/// Of a scene it is in mm/ms^2.
const M_PER_S2: f64 = 1e3;

/// Of skeletal muscle some 100 to 400 kPa at most (Powell et al. 1984).
const PULL: UsualRange = UsualRange { what: "the stress", unit: "kPa", least: 0.1, most: 1e3 };
/// As a size; small strain does not reach farther either.
const GROWTH: UsualRange =
    UsualRange { what: "the change of volume", unit: "of the volume", least: 1e-4, most: 0.3 };

impl UsualRange {
    /// A warning where a value that does something is outside.
    fn doubt(&self, value: f64, of: &str) -> Option<Warning> {
        let UsualRange { what, unit, least, most } = *self;
        if value == 0.0 || (least..=most).contains(&value) {
            return None;
        }
        let detail = format!(
            "{what}{of} is {value:e} {unit}, and usually between {least:e} and {most:e} {unit}: is it in another unit?"
        );
        let warning = Warning::new("constant-suspect", detail).with("value", value);
        Some(warning.with("usual_least", least).with("usual_most", most))
    }
}

/// A warning for each constant of a scene that is far from what tissue and surgery have.
pub(super) fn suspect_constants(scene: &Scene, plan: &Plan) -> Vec<Warning> {
    let regions = scene.regions.iter().zip(&scene.materials);
    let materials = regions.flat_map(|(name, material)| of_material(name, material));
    let sheet = scene.settings.membrane.iter().flat_map(|membrane| {
        let sheet = &membrane.sheet;
        [
            SHEET_THICKNESS.doubt(sheet.thickness(), ""),
            SHEET_MODULUS.doubt(sheet.young_modulus(), ""),
        ]
    });
    let link = scene.settings.method.link_stiffness();
    let links = link.into_iter().map(|stiffness| LINK.doubt(stiffness, ""));
    let loads = plan.loads.iter().enumerate().map(|(index, load)| of_load(index, load));
    let inner = suspect_growth_and_pull(&plan.growth, &plan.activations);
    let stated = materials.chain(sheet).chain(links).chain(loads).flatten();
    stated.chain(inner).take(MOST).collect()
}

/// A warning for each growth and each pull of a plan that is far from what tissue has.
pub fn suspect_growth_and_pull(growth: &[Growth], activations: &[Activation]) -> Vec<Warning> {
    let growth = growth
        .iter()
        .map(|own| GROWTH.doubt(own.volume_change.abs(), &format!(" of region {:?}", own.region)));
    let pulls = activations.iter();
    let pulls = pulls.map(|own| PULL.doubt(own.stress, &format!(" of muscle {:?}", own.muscle)));
    growth.chain(pulls).flatten().take(MOST).collect()
}

/// The warning of a case whose tissues are all stiffer than skin or softer than fat: a thousand times another unit.
pub(super) fn no_soft_tissue(case: &Case, scene: &Scene) -> Option<Warning> {
    let moduli = moduli(case, scene);
    let ((softest, soft), (stiffest, stiff)) = (moduli.first()?, moduli.last()?);
    let (value, name, unit, meant) = if *softest > SOFTEST {
        (*softest, soft, "Pa", softest / THOUSAND)
    } else if *stiffest < STIFFEST {
        (*stiffest, stiff, "MPa", stiffest * THOUSAND)
    } else {
        return None;
    };
    // Beyond that `suspect_constants` tells it.
    if !(MODULUS.least..=MODULUS.most).contains(&value) {
        return None;
    }
    let end = if value > SOFTEST { "softest" } else { "stiffest" };
    let detail = format!(
        "Young's modulus of {name:?}, the {end} tissue of the case, is {value} kPa, and soft tissue has {STIFFEST} to {SOFTEST} kPa: \
         is it in {unit}, {meant} kPa?"
    );
    let warning = Warning::new("constant-suspect", detail).with("value", value);
    let warning = warning.with("usual_least", STIFFEST).with("usual_most", SOFTEST);
    Some(warning.with("if_other_unit_kpa", meant))
}

/// Young's moduli of regions and windows in kPa with their names, rising.
fn moduli(case: &Case, scene: &Scene) -> Vec<(f64, String)> {
    let regions = scene.regions.iter().zip(&scene.materials);
    let windows = case.hounsfield.iter().flat_map(|image| &image.tissues);
    let windows = windows.map(|window| (&window.name, &window.material));
    let modulus =
        |(name, material): (&String, &LinearElastic)| (material.young_modulus(), name.clone());
    let mut moduli: Vec<(f64, String)> = regions.chain(windows).map(modulus).collect();
    moduli.sort_by(|one, other| one.0.total_cmp(&other.0));
    moduli
}

/// The warning of tissues of which one is a thousand times as stiff as another or more.
pub(super) fn moduli_apart(case: &Case, scene: &Scene) -> Option<Warning> {
    let moduli = moduli(case, scene);
    let [(softest, soft), .., (stiffest, stiff)] = moduli.as_slice() else { return None };
    let ratio = stiffest / softest;
    let detail = format!(
        "Young's modulus of {stiff:?} is {stiffest} kPa and that of {soft:?} {softest} kPa, {ratio:.0} times less: \
         is one of them in another unit?"
    );
    let warning = Warning::new("moduli-far-apart", detail).with("ratio", ratio);
    let warning = warning.with("stiffest_kpa", *stiffest).with("softest_kpa", *softest);
    (ratio >= MODULI_APART).then_some(warning)
}

fn of_material(name: &str, material: &LinearElastic) -> [Option<Warning>; 4] {
    let of = format!(" of {name:?}");
    let fibre =
        |usual: UsualRange, value: Option<f64>| value.and_then(|value| usual.doubt(value, &of));
    [
        MODULUS.doubt(material.young_modulus(), &of),
        DENSITY.doubt(material.density(), &of),
        fibre(FIBRE_MODULUS, material.fibre_modulus()),
        fibre(FIBRE_SHEAR, material.fibre_shear_modulus()),
    ]
}

fn of_load(index: usize, load: &Load) -> Option<Warning> {
    let of = format!(" of load {index}");
    let size = |vector: &Vector| vector.norm();
    match load {
        Load::Force { force, .. } => FORCE.doubt(size(force), &of),
        Load::Traction { traction, .. } => TRACTION.doubt(size(traction), &of),
        Load::Pressure { pressure, .. } => PRESSURE.doubt(pressure.abs(), &of),
        Load::Gravity { acceleration } => GRAVITY.doubt(M_PER_S2 * size(acceleration), &of),
    }
}
