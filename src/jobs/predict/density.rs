//! Density of tissue under gravity, if no material states one.

use super::input::PredictInput;
use crate::schema::MaterialDocuments;
use crate::schema::case::hounsfield::HounsfieldDocument;
use crate::schema::case::merged::expanded_materials;
use crate::schema::case::muscle::muscle_materials;
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
    // Without materials of the case nothing of the default tissue is taken for a statement.
    let (none, case) = (MaterialDocuments::new(), input.case.materials.as_ref());
    let of_regions = expanded_materials(Some(case.unwrap_or(&none)), input.spec.materials.as_ref());
    let of_image = input.case.hounsfield.as_ref().map(HounsfieldDocument::expanded);
    let of_muscles = muscle_materials(&input.case.muscles);
    let all = of_regions.iter().chain(of_image.iter().flatten()).chain(&of_muscles);
    let without = all.filter(|(_, material)| material.density_g_per_cm3.is_none());
    let without: Vec<&String> = without.map(|(name, _)| name).collect();
    let detail = format!(
        "gravity acts on tissue without a stated density, and {DEFAULT} g/cm3 is used: `density_g_per_cm3` of {}",
        listed(&without)
    );
    let warning = Warning::new("default-density", detail).with("density_g_per_cm3", DEFAULT);
    (!without.is_empty()).then_some(warning)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// What is told of materials of a case and of a spec.
    fn told(case: &Value, spec: &Value) -> Option<String> {
        let input = json!({
            "case": {"units": "mm", "volume": "v", "skin": {"node_set": "top"}, "segments": [],
                "materials": case},
            "plan": {"loads": [{"gravity_m_per_s2": [0, 0, -10]}]},
            "spec": {"materials": spec}
        });
        default_density(&serde_json::from_value(input).expect("an input")).map(|told| told.detail)
    }

    #[test]
    fn a_region_of_the_spec_has_the_density_of_the_case_but_not_where_it_names_a_preset() {
        let dense = json!({"*": {"young_modulus_kpa": 15, "density_g_per_cm3": 2}});
        assert_eq!(told(&dense, &json!({"a": {"young_modulus_kpa": 3}})), None);
        let preset = told(&dense, &json!({"a": {"preset": "tissue_chabanas_2003"}}));
        assert!(preset.expect("told").ends_with("of a"));
        // An entry of the case stands alone.
        let own = json!({"*": {"density_g_per_cm3": 2}, "a": {"young_modulus_kpa": 3}});
        assert!(told(&own, &Value::Null).expect("told").ends_with("of a"));
        assert!(told(&Value::Null, &json!({"a": {"young_modulus_kpa": 3}})).is_some());
    }
}
