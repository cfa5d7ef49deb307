//! Density of tissue under gravity, if no material states one.

use std::collections::BTreeSet;

use super::input::PredictInput;
use crate::schema::MaterialDocument;
use mechanics::mesh::Warning;
use mechanics::mesh::ignored::listed;

/// Of water, in g/cm³: the default of materials.
const DEFAULT: f64 = 1.0;

/// The warning if gravity acts on tissue without a stated density. A case without materials has another warning for
/// it.
pub(super) fn default_density(input: &PredictInput) -> Option<Warning> {
    if !input.plan.loads.iter().any(|load| load.gravity_m_per_s2.is_some()) {
        return None;
    }
    let materials = [input.case.materials.as_ref(), input.spec.materials.as_ref()];
    let entries = || materials.into_iter().flatten().flatten();
    let stated: BTreeSet<&String> = entries()
        .filter(|(_, material)| material.density_g_per_cm3.is_some())
        .map(|(name, _)| name)
        .collect();
    let of_regions: BTreeSet<&String> =
        entries().map(|(name, _)| name).filter(|name| !stated.contains(name)).collect();
    let tissues = input.case.hounsfield.iter().flat_map(|image| &image.tissues);
    let of_image = tissues.map(|tissue| (&tissue.name, Some(&tissue.material)));
    let of_muscles =
        input.case.muscles.iter().map(|muscle| (&muscle.name, muscle.material.as_ref()));
    let is_without = |(_, material): &(&String, Option<&MaterialDocument>)| {
        material.is_some_and(|material| material.density_g_per_cm3.is_none())
    };
    let others = of_image.chain(of_muscles).filter(is_without).map(|(name, _)| name);
    let without: Vec<&String> = of_regions.into_iter().chain(others).collect();
    let detail = format!(
        "gravity acts on tissue without a stated density, and {DEFAULT} g/cm3 is used: `density_g_per_cm3` of {}",
        listed(&without)
    );
    let warning = Warning::new("default-density", detail).with("density_g_per_cm3", DEFAULT);
    (!without.is_empty()).then_some(warning)
}
