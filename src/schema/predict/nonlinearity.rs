//! Linearisation error of a prediction in its result.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::{Nonlinearity, Skin};
use mechanics::validation::{Statistics, StatisticsError};

/// The estimated linearisation error in mm: the second-order term of the same equilibrium at finite
/// strain, with neo-Hookean tissue of the same constants at zero strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NonlinearityDocument {
    /// Over the nodes of the skin.
    pub skin: EstimateDocument,
    /// By the names of `skin_regions`.
    pub regions: BTreeMap<String, EstimateDocument>,
    /// At each landmark.
    pub landmarks: BTreeMap<String, f64>,
}

/// An estimated length in mm over nodes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EstimateDocument {
    pub mean: f64,
    pub p95: f64,
    pub max: f64,
}

impl NonlinearityDocument {
    pub fn new(skin: &Skin, nonlinearity: &Nonlinearity) -> Result<Self, StatisticsError> {
        let lengths = skin_lengths(skin, nonlinearity);
        let regions = skin.regions.iter().map(|(name, points)| {
            let of: Vec<f64> = points.iter().map(|&point| lengths[point as usize]).collect();
            Ok((name.clone(), EstimateDocument::new(&of)?))
        });
        let landmarks = nonlinearity.landmarks.iter();
        Ok(NonlinearityDocument {
            skin: EstimateDocument::new(&lengths)?,
            regions: regions.collect::<Result<_, StatisticsError>>()?,
            landmarks: landmarks.map(|(name, left)| (name.clone(), left.norm())).collect(),
        })
    }
}

/// The length in mm at each point of the skin.
pub fn skin_lengths(skin: &Skin, nonlinearity: &Nonlinearity) -> Vec<f64> {
    skin.lengths(&nonlinearity.left_out)
}

impl EstimateDocument {
    fn new(lengths: &[f64]) -> Result<Self, StatisticsError> {
        let Statistics { mean, p95, max, .. } = Statistics::plain(lengths)?;
        Ok(EstimateDocument { mean, p95, max })
    }
}
