//! Plausibility of plans that were found, and of estimated growth and constants.

use super::document::OptimiseDocument;
use super::result::{OptimisationDocument, ParameterName};
use super::tissue::TissueBoundsDocument;
use crate::schema::wire::vector::Interval;
use mechanics::mesh::Warning;

impl OptimiseDocument {
    /// The bounds of a region.
    pub fn tissue_bounds_of(&self, region: &str) -> TissueBoundsDocument {
        let mut all = self.tissue_bounds.iter();
        let own = all.find(|(name, _)| name.trim() == region.trim());
        own.map(|(_, own)| *own).unwrap_or_default()
    }

    /// Warnings on the plan, and on estimated growth and constants.
    pub fn doubts(&self, found: &OptimisationDocument) -> Vec<Warning> {
        let mut doubts: Vec<Warning> = found.another_minimum().into_iter().collect();
        let is_free = |own: Option<Interval>| own.is_some_and(|Interval([low, high])| low < high);
        let all = || self.tissue_bounds.values();
        if all().any(|own| is_free(own.poisson_ratio))
            && !all().any(|own| is_free(own.volume_change))
        {
            let detail = "Poisson's ratio is estimated as if tissue kept its volume, and 5 % of volume may shift it \
                          by .3: estimate `volume_change` with it";
            doubts.push(Warning::new("growth-left-out", detail));
        }
        for parts in &found.undetermined {
            let tissue = parts.iter().filter_map(|part| Some((part.region.as_ref()?, part.name)));
            for (region, name) in tissue {
                let detail = format!("the targets do not determine {} of {region:?}", name.words());
                doubts.push(Warning::new("constant-not-determined", detail));
            }
        }
        for (parameter, &error) in found.parameters.iter().zip(&found.standard_error) {
            let Some(region) = &parameter.region else { continue };
            let Some(Interval([low, high])) =
                interval_of(&self.tissue_bounds_of(region), parameter.name)
            else {
                continue;
            };
            let guess = (high - low) / 12_f64.sqrt();
            if error > guess {
                let detail = format!(
                    "the standard error of {} of {region:?} is {error:.3}, and that of a guess within its bounds {guess:.3}",
                    parameter.name.words()
                );
                let warning = Warning::new("constant-not-determined", detail);
                doubts.push(warning.with("standard_error", error).with("guess", guess));
            }
        }
        for stopped in &found.at_bound {
            let Some(region) = &stopped.region else { continue };
            let detail = format!(
                "{} of {region:?} is at its bound: better values may lie beyond",
                stopped.name.words()
            );
            doubts.push(Warning::new("constant-at-end", detail).with("value", stopped.value));
        }
        doubts
    }
}

impl OptimisationDocument {
    /// The warning where another plan explains the targets nearly as well: its chi squared is higher by at most 1, that of one standard
    /// error, or by what one degree of freedom has left.
    pub fn another_minimum(&self) -> Option<Warning> {
        let next = *self.other_chi_squared.first()?;
        let own = self.chi_squared;
        let as_good = own + self.residual_factor.map_or(1.0, |factor| factor.powi(2).max(1.0));
        let detail = format!(
            "a search from another start ended in another plan that is nearly as good, of chi squared {next:.3} beside {own:.3}: narrow the \
             bounds to the one that is meant, or state more targets"
        );
        let warning = Warning::new("another-minimum", detail).with("chi_squared", own);
        (next <= as_good).then(|| warning.with("other_chi_squared", next))
    }
}

/// The bounds of a parameter of tissue.
fn interval_of(own: &TissueBoundsDocument, name: ParameterName) -> Option<Interval> {
    match name {
        ParameterName::VolumeChange => own.volume_change,
        ParameterName::PoissonRatio => own.poisson_ratio,
        ParameterName::YoungModulus => own.young_modulus_kpa,
        ParameterName::TranslationX
        | ParameterName::TranslationY
        | ParameterName::TranslationZ
        | ParameterName::RotationX
        | ParameterName::RotationY
        | ParameterName::RotationZ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(chi_squared: f64, degrees_of_freedom: u64, others: &[f64]) -> bool {
        let document = serde_json::json!({
            "plan": {}, "targets": [], "parameters": [], "standard_error": [], "covariance": [], "correlation": [],
            "at_bound": [], "undetermined": [], "iterations": 5, "starts": 13, "chi_squared": chi_squared,
            "degrees_of_freedom": degrees_of_freedom, "other_chi_squared": others,
            "residual_factor": (chi_squared / degrees_of_freedom as f64).sqrt(),
        });
        let found: OptimisationDocument = serde_json::from_value(document).unwrap();
        found.another_minimum().is_some()
    }

    #[test]
    fn another_plan_is_told_where_it_is_as_good_within_a_standard_error() {
        assert!(!told(10.0, 10, &[]) && !told(10.0, 10, &[11.1, 10.5e3]));
        assert!(told(10.0, 10, &[10.9, 50.0]) && told(1e-9, 10, &[0.9]));
        // Of errors four times as large as stated.
        assert!(told(160.0, 10, &[175.0]) && !told(160.0, 10, &[177.0]));
    }
}
