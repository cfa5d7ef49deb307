//! Bounds of unknown growth and tissue constants.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::plan::document::GrowthDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::vector::Interval;
use mechanics::optimisation::ConstantKind;
use mechanics::prediction::VOLUME_CHANGE;

/// As for materials; Poisson's ratio is below 0.5.
const POISSON_RATIO: RangeInclusive<f64> = 0.0..=0.5_f64.next_down();
const YOUNG_MODULUS_KPA: RangeInclusive<f64> = 1e-9..=1e9;

/// Bounds of growth and constants of a region. Equal bounds fix a value; omitted members keep theirs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TissueBoundsDocument {
    /// Volume gain of unconstrained tissue, as a share, in [-0.5, 1]; a region has it here or in `growth`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub volume_change: Option<Interval>,
    /// In [0, 0.5).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub poisson_ratio: Option<Interval>,
    /// In [1e-9, 1e9]. If only bone moves tissue, only ratios of moduli matter: estimate that of one region, and
    /// fix that of another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub young_modulus_kpa: Option<Interval>,
}

impl TissueBoundsDocument {
    pub(super) fn is_free(&self) -> bool {
        let all = [self.volume_change, self.poisson_ratio, self.young_modulus_kpa];
        all.into_iter().flatten().any(|Interval([low, high])| low < high)
    }

    /// The unknown constants of the material.
    pub fn constants(&self) -> Vec<(ConstantKind, [f64; 2])> {
        let both = [
            (ConstantKind::YoungModulus, self.young_modulus_kpa),
            (ConstantKind::PoissonRatio, self.poisson_ratio),
        ];
        both.into_iter().filter_map(|(kind, own)| Some((kind, own?.0))).collect()
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

/// Adds the faults of the bounds of tissue, except those that need the mesh.
pub(super) fn check_tissue(
    bounds: &BTreeMap<String, TissueBoundsDocument>,
    growth: &[GrowthDocument],
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) {
    faults.check_length(at, bounds.len(), limits.map_entries as usize);
    for (region, own) in bounds {
        let place = at.key(region);
        faults.check_name(&place, region, limits.name_characters as usize);
        own.check(&place, faults);
        let is_stated = growth.iter().any(|other| other.region.trim() == region.trim());
        if own.volume_change.is_some() && is_stated {
            let detail = format!("the growth of region {region:?} is stated in `growth` too");
            faults.add(&place.key("volume_change"), ErrorCode::DuplicateName, detail);
        }
    }
}
