//! Growth and constants that are looked for: their bounds, and what is doubtful about what was found.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::document::OptimiseDocument;
use super::result::{OptimisationDocument, ParameterName};
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::vector::Interval;
use mechanics::mesh::Warning;
use mechanics::optimisation::ConstantKind;
use mechanics::prediction::VOLUME_CHANGE;

/// As for materials; Poisson's ratio is below 0.5.
const POISSON_RATIO: RangeInclusive<f64> = 0.0..=0.5_f64.next_down();
const YOUNG_MODULUS_KPA: RangeInclusive<f64> = 1e-9..=1e9;

/// Between which values growth and constants of a region may be. Equal ends hold a value; what is left out stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TissueBoundsDocument {
    /// What free tissue would gain as a share of its volume, in [-0.5, 1]; a region has it here or in `growth`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub volume_change: Option<Interval>,
    /// In [0, 0.5).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub poisson_ratio: Option<Interval>,
    /// In [1e-9, 1e9]. Where nothing but bone moves tissue only ratios of moduli matter: that of one region is looked for, and
    /// that of another stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub young_modulus_kpa: Option<Interval>,
}

impl TissueBoundsDocument {
    pub(super) fn is_free(&self) -> bool {
        let all = [self.volume_change, self.poisson_ratio, self.young_modulus_kpa];
        all.into_iter().flatten().any(|Interval([low, high])| low < high)
    }

    /// The constants of the material that are looked for.
    pub fn constants(&self) -> Vec<(ConstantKind, [f64; 2])> {
        let both = [
            (ConstantKind::YoungModulus, self.young_modulus_kpa),
            (ConstantKind::PoissonRatio, self.poisson_ratio),
        ];
        both.into_iter().filter_map(|(kind, own)| Some((kind, own?.0))).collect()
    }

    fn of(&self, name: ParameterName) -> Option<Interval> {
        match name {
            ParameterName::VolumeChange => self.volume_change,
            ParameterName::PoissonRatio => self.poisson_ratio,
            ParameterName::YoungModulus => self.young_modulus_kpa,
            ParameterName::TranslationX
            | ParameterName::TranslationY
            | ParameterName::TranslationZ
            | ParameterName::RotationX
            | ParameterName::RotationY
            | ParameterName::RotationZ => None,
        }
    }

    fn check(&self, at: &Pointer, faults: &mut Faults) {
        for (name, interval, range, unit) in [
            ("volume_change", self.volume_change, VOLUME_CHANGE, "of the volume"),
            ("poisson_ratio", self.poisson_ratio, POISSON_RATIO, ""),
            ("young_modulus_kpa", self.young_modulus_kpa, YOUNG_MODULUS_KPA, "kPa"),
        ] {
            let Some(Interval([low, high])) = interval else { continue };
            let place = at.key(name);
            let inside = faults.check_range(&place.index(0), low, range.clone(), unit)
                && faults.check_range(&place.index(1), high, range, unit);
            if inside && low > high {
                let detail = format!("the lowest value {low} is above the highest {high}");
                faults.add(&place, ErrorCode::OutOfRange, detail);
            }
        }
    }
}

/// Adds what is wrong with the bounds of tissue, but for what only the mesh can tell.
pub(super) fn check_tissue(
    spec: &OptimiseDocument,
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) {
    faults.check_length(at, spec.tissue_bounds.len(), limits.map_entries as usize);
    for (region, own) in &spec.tissue_bounds {
        let place = at.key(region);
        faults.check_name(&place, region, limits.name_characters as usize);
        own.check(&place, faults);
        let is_stated = spec.growth.iter().any(|other| other.region.trim() == region.trim());
        if own.volume_change.is_some() && is_stated {
            let detail = format!("the growth of region {region:?} is stated in `growth` too");
            faults.add(&place.key("volume_change"), ErrorCode::DuplicateName, detail);
        }
    }
}

impl OptimiseDocument {
    /// The bounds of a region.
    pub fn tissue_bounds_of(&self, region: &str) -> TissueBoundsDocument {
        let mut all = self.tissue_bounds.iter();
        let own = all.find(|(name, _)| name.trim() == region.trim());
        own.map(|(_, own)| *own).unwrap_or_default()
    }

    /// What a reader of growth and constants that were found has to know.
    pub fn doubts(&self, found: &OptimisationDocument) -> Vec<Warning> {
        let mut doubts = Vec::new();
        let is_free = |own: Option<Interval>| own.is_some_and(|Interval([low, high])| low < high);
        let all = || self.tissue_bounds.values();
        if all().any(|own| is_free(own.poisson_ratio))
            && !all().any(|own| is_free(own.volume_change))
        {
            let detail = "Poisson's ratio is looked for as if no tissue gained volume or lost it, and 5 % of volume may shift it \
                          by .3: look for `volume_change` with it";
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
            let Some(Interval([low, high])) = self.tissue_bounds_of(region).of(parameter.name)
            else {
                continue;
            };
            let guess = (high - low) / 12_f64.sqrt();
            if error > guess {
                let detail = format!(
                    "the standard error of {} of {region:?} is {error:.3}, and that of a guess between its bounds {guess:.3}",
                    parameter.name.words()
                );
                let warning = Warning::new("constant-not-determined", detail);
                doubts.push(warning.with("standard_error", error).with("guess", guess));
            }
        }
        for stopped in &found.at_bound {
            let Some(region) = &stopped.region else { continue };
            let detail = format!(
                "{} of {region:?} is stopped by its bound: better values may lie beyond",
                stopped.name.words()
            );
            doubts.push(Warning::new("constant-at-end", detail).with("value", stopped.value));
        }
        doubts
    }
}
