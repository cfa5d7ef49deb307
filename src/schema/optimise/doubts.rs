//! Plausibility of estimated growth and constants.

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

    /// Warnings on estimated growth and constants.
    pub fn doubts(&self, found: &OptimisationDocument) -> Vec<Warning> {
        let mut doubts = Vec::new();
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
