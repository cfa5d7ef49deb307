//! Mean errors over the skin that a plan moves and over its parts, and those that are accepted.

use std::collections::BTreeMap;

use crate::mesh::{Vector, Warning};
use crate::prediction::skin::Skin;
use crate::progress::Progress;

/// Progress, and the time in s since some moment.
#[derive(Clone, Copy)]
pub struct TimedProgress<'a> {
    pub stopwatch: &'a dyn Fn() -> f64,
    pub progress: &'a dyn Progress,
}

/// The mean error over the skin that is accepted where nothing else is said, in mm.
pub const USUALLY_ACCEPTED_MM: f64 = 0.1;

/// Errors that the caller accepts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accepted {
    /// The mean error over the skin that moves (`moving_points`), in mm.
    pub skin_mm: f64,
    /// The same over parts of the skin, by name.
    pub regions_mm: BTreeMap<String, f64>,
    /// For all rungs together, in s.
    pub time_s: f64,
    /// Why finite strain is out of the question, where it is.
    pub no_finite_strain: Option<String>,
}

/// Mean errors in mm over the skin that moves, and over the parts of it that an error is accepted for.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanErrors {
    pub skin_mm: f64,
    pub regions_mm: BTreeMap<String, f64>,
}

impl MeanErrors {
    /// Of vectors of nodes, with the points of the skin that move.
    pub(super) fn of(skin: &Skin, moving: &[u32], accepted: &Accepted, values: &[Vector]) -> Self {
        let asked = skin.regions.iter().filter(|(name, _)| accepted.regions_mm.contains_key(*name));
        let over = |points: &[u32]| skin.mean_length(points, values);
        MeanErrors {
            skin_mm: over(moving),
            regions_mm: asked.map(|(name, points)| (name.clone(), over(points))).collect(),
        }
    }

    /// Each of them by a function.
    pub(super) fn map(&self, change: impl Fn(f64) -> f64) -> Self {
        let regions = self.regions_mm.iter();
        MeanErrors {
            skin_mm: change(self.skin_mm),
            regions_mm: regions.map(|(name, error)| (name.clone(), change(*error))).collect(),
        }
    }

    /// The sums, part by part.
    pub(super) fn plus(&self, other: &MeanErrors) -> Self {
        let regions = self.regions_mm.iter();
        let sum = |(name, error): (&String, &f64)| {
            (name.clone(), error + other.regions_mm.get(name).copied().unwrap_or(f64::NAN))
        };
        MeanErrors { skin_mm: self.skin_mm + other.skin_mm, regions_mm: regions.map(sum).collect() }
    }
}

impl Accepted {
    /// The largest error as a share of the accepted one: at most 1 where all are accepted.
    pub(super) fn share(&self, errors: Option<&MeanErrors>) -> f64 {
        let Some(errors) = errors else { return f64::INFINITY };
        let regions = self.regions_mm.iter().map(|(name, accepted)| {
            errors.regions_mm.get(name).map_or(f64::INFINITY, |error| error / accepted)
        });
        let largest = regions.fold(errors.skin_mm / self.skin_mm, f64::max);
        if largest.is_nan() { f64::INFINITY } else { largest }
    }
}

/// What may help.
const CURE: &str = "refine the mesh, allow more time or accept a larger error";

/// The warning where expected errors are not within those that are accepted, or not known.
pub(super) fn not_met(error: Option<&MeanErrors>, accepted: &Accepted) -> Warning {
    let wanted = accepted.skin_mm;
    let Some(error) = error else {
        let detail = "the error of the skin is unknown".to_owned();
        return Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    };
    let skin = error.skin_mm;
    let detail = match accepted
        .regions_mm
        .iter()
        .find(|(name, accepted)| error.regions_mm.get(*name).is_none_or(|error| error > *accepted))
    {
        Some((name, wanted)) if skin <= accepted.skin_mm => {
            let own = error.regions_mm.get(name).copied().unwrap_or(f64::NAN);
            format!(
                "expected mean error {own:.3} mm over {name:?} exceeds the accepted {wanted:.3} mm; {CURE}"
            )
        }
        Some(_) | None => format!(
            "expected mean error {skin:.3} mm over the skin that moves exceeds the accepted {wanted:.3} mm; {CURE}"
        ),
    };
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    warning.with("expected_mm", skin)
}
