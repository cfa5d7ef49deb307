//! Distance from a scan over the grid of swept constants: D(nu), or D(nu, E) (Zachow et al. 2006, section 3.5).
//!
//! Where registration left r mm (root mean square), two D that differ by less than r are the same as far as the scan
//! can tell. For each constant the least D over all others is held against the least of all: values within r of it are
//! as good, and a constant all of whose values are as good is not determined by the scan.

use std::collections::BTreeMap;

use super::report::{Outcome, Report, Row};
use super::sweep::{Constant, SweptAxis};
use super::variant::{Study, StudyScene, Truth};

/// D of one model on one plan.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantMap {
    pub scene: String,
    pub plan: String,
    pub label: String,
    pub level: u32,
    pub axes: Vec<SweptAxis>,
    /// Mean distance in mm at each combination, the last axis fastest; none where the row has no numbers.
    pub distances: Vec<Option<f64>>,
    /// The combination with the least, the first of equal ones.
    pub best: Option<usize>,
    /// Root of the mean squared distance that registration left, in mm, where it is known.
    pub noise: Option<f64>,
}

/// The maps of all scenes that are held against a scan; none without swept constants.
pub fn constant_maps(report: &Report, study: &Study, axes: &[SweptAxis]) -> Vec<ConstantMap> {
    let cells: usize = axes.iter().map(|axis| axis.values.len()).product();
    let mut maps = Vec::new();
    for (place, scene) in study.scenes.iter().enumerate() {
        let is_held = matches!(scene.truth, Truth::Scan(_));
        if !is_held || axes.is_empty() || scene.materials.len() != cells {
            continue;
        }
        let about = report.scenes.iter().find(|about| about.name == scene.name);
        let noise = about.and_then(|about| about.noise_mm);
        for (plan, _) in &scene.plans {
            for &level in &study.levels {
                for variant in study.variants_of(place) {
                    let of = (plan.as_str(), variant.label.as_str(), level);
                    let distances = distances(report, scene, of);
                    if distances.iter().all(Option::is_none) {
                        continue;
                    }
                    maps.push(ConstantMap {
                        scene: scene.name.clone(),
                        plan: plan.clone(),
                        label: variant.label.clone(),
                        level,
                        axes: axes.to_vec(),
                        best: least(&distances),
                        distances,
                        noise,
                    });
                }
            }
        }
    }
    maps
}

/// The mean distance with each of the materials.
fn distances(
    report: &Report,
    scene: &StudyScene,
    (plan, label, level): (&str, &str, u32),
) -> Vec<Option<f64>> {
    let is_own = |row: &&Row| {
        row.scene == scene.name && row.plan == plan && row.label == label && row.level == level
    };
    let mean = |row: &Row| match &row.outcome {
        Outcome::Solved(solved) => Some(solved.error.mean),
        Outcome::Failed { .. } => None,
    };
    let rows = report.rows.iter().filter(is_own);
    let found: BTreeMap<&str, Option<f64>> =
        rows.map(|row| (row.material.as_str(), mean(row))).collect();
    let of = |name: &str| found.get(name).copied().flatten();
    scene.materials.iter().map(|materials| of(&materials.name)).collect()
}

fn least(distances: &[Option<f64>]) -> Option<usize> {
    let found = distances.iter().enumerate().filter_map(|(at, d)| Some((at, (*d)?)));
    found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
}

impl ConstantMap {
    /// The place of a combination on each axis.
    pub fn places(&self, cell: usize) -> Vec<usize> {
        let mut rest = cell;
        let mut places: Vec<usize> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let place = rest % axis.values.len();
                rest /= axis.values.len();
                place
            })
            .collect();
        places.reverse();
        places
    }

    /// The values of a combination, one for each axis.
    pub fn values(&self, cell: usize) -> Vec<f64> {
        let places = self.places(cell);
        self.axes.iter().zip(places).map(|(axis, place)| axis.values[place]).collect()
    }

    /// The least D.
    pub fn least(&self) -> Option<f64> {
        self.distances[self.best?]
    }

    /// The least D for each value of an axis, over all values of the others.
    pub fn profile(&self, axis: usize) -> Vec<Option<f64>> {
        let mut profile = vec![None; self.axes[axis].values.len()];
        for (cell, distance) in self.distances.iter().enumerate() {
            let Some(distance) = *distance else { continue };
            let least: &mut Option<f64> = &mut profile[self.places(cell)[axis]];
            *least = Some(least.map_or(distance, |least| least.min(distance)));
        }
        profile
    }

    /// The values of an axis that the scan cannot tell from the best: their least D lies above the least of all by no
    /// more than registration left. The best alone where that is not known.
    pub fn as_good(&self, axis: usize) -> Vec<f64> {
        let Some(least) = self.least() else { return Vec::new() };
        let bound = least + self.noise.unwrap_or(0.0);
        let values = self.axes[axis].values.iter().zip(self.profile(axis));
        let is_as_good = |d: Option<f64>| d.is_some_and(|d| d <= bound);
        values.filter(|(_, d)| is_as_good(*d)).map(|(value, _)| *value).collect()
    }

    /// Whether the scan tells some value of an axis from the best one; an axis of one value has nothing to tell.
    pub fn is_determined(&self, axis: usize) -> bool {
        let solved = self.profile(axis).iter().flatten().count();
        solved < 2 || self.as_good(axis).len() < solved
    }

    /// Whether Poisson's ratio is looked for and no change of volume with it, which moves the skin as much.
    pub fn leaves_growth_out(&self) -> bool {
        let varies = |constant: Constant| {
            self.axes.iter().any(|axis| axis.constant == constant && axis.values.len() > 1)
        };
        varies(Constant::PoissonRatio) && !varies(Constant::VolumeChange)
    }

    /// Whether the best value of an axis is the smallest or the largest of three or more, so that better ones may lie
    /// beyond.
    pub fn is_at_end(&self, axis: usize) -> bool {
        let Some(best) = self.best else { return false };
        let values = &self.axes[axis].values;
        let value = values[self.places(best)[axis]];
        let is_end = values.iter().all(|v| *v >= value) || values.iter().all(|v| *v <= value);
        values.len() > 2 && is_end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(distances: [f64; 6], noise: Option<f64>) -> ConstantMap {
        let axis = |constant, values: &[f64]| SweptAxis {
            region: "*".to_owned(),
            constant,
            values: values.to_vec(),
        };
        let axes = vec![
            axis(Constant::YoungModulus, &[10.0, 20.0]),
            axis(Constant::PoissonRatio, &[0.3, 0.4, 0.45]),
        ];
        let distances: Vec<Option<f64>> =
            distances.into_iter().map(|d| Some(d).filter(|d: &f64| d.is_finite())).collect();
        let best = least(&distances);
        let [scene, plan, label] = [(); 3].map(|()| String::new());
        ConstantMap { scene, plan, label, level: 0, axes, distances, best, noise }
    }

    #[test]
    fn constants_are_distinguished_only_beyond_what_registration_left() {
        let found = map([0.5, 0.30, 0.4, 0.6, 0.35, f64::NAN], Some(0.06));
        assert_eq!((found.best, found.values(1)), (Some(1), vec![10.0, 0.4]));
        assert_eq!(found.profile(0), [Some(0.30), Some(0.35)]);
        assert_eq!(found.profile(1), [Some(0.5), Some(0.30), Some(0.4)]);
        assert_eq!((found.as_good(0), found.is_determined(0)), (vec![10.0, 20.0], false));
        assert_eq!((found.as_good(1), found.is_determined(1)), (vec![0.4], true));
        assert_eq!((found.is_at_end(0), found.is_at_end(1)), (false, false));
        let sharp = ConstantMap { noise: Some(0.04), ..found.clone() };
        assert!(sharp.is_determined(0));
        assert!(found.leaves_growth_out());
        let mut with_growth = found.clone();
        with_growth.axes[0].constant = Constant::VolumeChange;
        assert!(!with_growth.leaves_growth_out());
        let unknown = ConstantMap { noise: None, ..found };
        assert_eq!((unknown.as_good(0), unknown.is_determined(0)), (vec![10.0], true));
    }

    #[test]
    fn a_best_value_at_an_end_is_reported_and_a_map_without_numbers_has_none() {
        assert!(map([0.2, 0.3, 0.4, 0.5, 0.5, 0.5], None).is_at_end(1));
        let nothing = map([f64::NAN; 6], Some(0.1));
        assert_eq!((nothing.best, nothing.least(), nothing.as_good(0)), (None, None, Vec::new()));
        assert!(nothing.is_determined(0) && !nothing.is_at_end(1));
    }
}
