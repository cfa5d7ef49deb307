//! Landmark errors: distances between the landmarks of both surfaces.

use std::collections::BTreeMap;

use super::alignment::LandmarkPair;
use crate::mesh::Vector;
use crate::registration::RigidTransform;

/// One landmark on the prediction and on the aligned actual surface, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandmarkError {
    /// From the actual to the predicted landmark.
    pub difference: Vector,
    pub distance: f64,
}

/// Of each pair; `transform` takes the actual surface onto the prediction.
pub(super) fn landmark_errors(
    pairs: &BTreeMap<String, LandmarkPair>,
    transform: &RigidTransform,
) -> BTreeMap<String, LandmarkError> {
    let error = |pair: &LandmarkPair| {
        let difference = pair.prediction - transform.apply(&pair.actual);
        LandmarkError { difference, distance: difference.norm() }
    };
    pairs.iter().map(|(name, pair)| (name.clone(), error(pair))).collect()
}
