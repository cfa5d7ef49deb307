//! Distance from a scan over swept constants, in a report.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::warning::WarningDocument;
use mechanics::mesh::Warning;
use mechanics::study::constant_map::ConstantMap;
use mechanics::study::sweep::{Constant, SweptAxis};

/// The mean distance between predicted skin and scan for every combination of swept constants, of one model
/// on one plan: D(nu), or D(nu, E).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConstantMapDocument {
    pub scene: String,
    pub plan: String,
    /// The variant.
    pub label: String,
    pub level: u32,
    pub axes: Vec<SweptAxisDocument>,
    /// The solved ones, the last axis fastest.
    pub cells: Vec<ConstantCellDocument>,
    /// The one of least distance, the first of equal ones.
    pub best: ConstantCellDocument,
    /// Error of the registration, which limits the resolution of values; absent if unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub noise_mm: Option<f64>,
    pub warnings: Vec<WarningDocument>,
}

/// A constant that takes several values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SweptAxisDocument {
    /// A region, or a tissue of the image.
    pub region: String,
    pub constant: ConstantName,
    pub values: Vec<f64>,
    /// The values that the scan does not distinguish from the best one: the least distance with them, over all other
    /// constants, is above the least of all by at most `noise_mm`.
    pub as_good: Vec<f64>,
    /// Whether the scan distinguishes any of the values from the best one.
    pub is_determined: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConstantName {
    YoungModulusKpa,
    PoissonRatio,
    VolumeChange,
}

/// The mean distance with one value for each axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConstantCellDocument {
    pub values: Vec<f64>,
    pub mean_mm: f64,
}

impl ConstantMapDocument {
    /// The document of a map; none if nothing was solved.
    pub fn new(map: &ConstantMap) -> Option<Self> {
        let cell = |at: usize| {
            let mean_mm = map.distances[at]?;
            Some(ConstantCellDocument { values: map.values(at), mean_mm })
        };
        let axes = map.axes.iter().enumerate();
        Some(ConstantMapDocument {
            scene: map.scene.clone(),
            plan: map.plan.clone(),
            label: map.label.clone(),
            level: map.level,
            axes: axes.map(|(at, axis)| SweptAxisDocument::new(axis, map, at)).collect(),
            cells: (0..map.distances.len()).filter_map(cell).collect(),
            best: cell(map.best?)?,
            noise_mm: map.noise,
            warnings: warnings(map).iter().map(WarningDocument::from).collect(),
        })
    }
}

impl SweptAxisDocument {
    fn new(axis: &SweptAxis, map: &ConstantMap, at: usize) -> Self {
        SweptAxisDocument {
            region: axis.region.clone(),
            constant: match axis.constant {
                Constant::YoungModulus => ConstantName::YoungModulusKpa,
                Constant::PoissonRatio => ConstantName::PoissonRatio,
                Constant::VolumeChange => ConstantName::VolumeChange,
            },
            values: axis.values.clone(),
            as_good: map.as_good(at),
            is_determined: map.is_determined(at),
        }
    }

    /// Its name in charts and sentences.
    pub fn words(&self) -> String {
        let of = if self.region == "*" { "all" } else { &self.region };
        match self.constant {
            ConstantName::YoungModulusKpa => format!("E of {of}, kPa"),
            ConstantName::PoissonRatio => format!("Poisson's ratio of {of}"),
            ConstantName::VolumeChange => format!("change of volume of {of}"),
        }
    }
}

/// Warnings on a map.
fn warnings(map: &ConstantMap) -> Vec<Warning> {
    let mut found = Vec::new();
    if map.leaves_growth_out() {
        let detail = format!(
            "{}: Poisson's ratio is estimated as if tissue kept its volume, and 5 % of volume may shift it by .3: sweep \
             `volume_change` with it",
            map.label
        );
        found.push(Warning::new("growth-left-out", detail));
    }
    for (at, axis) in map.axes.iter().enumerate() {
        let name = SweptAxisDocument::new(axis, map, at).words();
        let least = map.least().unwrap_or_default();
        if let (false, Some(noise)) = (map.is_determined(at), map.noise) {
            let most = map.profile(at).into_iter().flatten().fold(least, f64::max);
            let detail = format!(
                "{}: over all values of {name} the distance varies by {:.3} mm, and registration has {noise:.3} mm: the \
                 scan does not determine it",
                map.label,
                most - least
            );
            let warning = Warning::new("constant-not-determined", detail);
            found.push(warning.with("varies_mm", most - least).with("noise_mm", noise));
        }
        if map.is_at_end(at) {
            let detail = format!(
                "{}: the best value of {name} is the smallest or the largest of the sweep, and better ones may lie beyond",
                map.label
            );
            found.push(Warning::new("constant-at-end", detail).with("least_mm", least));
        }
    }
    found
}
