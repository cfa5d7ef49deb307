//! Distances by thin-plate spline and closest point.
//!
//! The predicted surface P is warped by the spline that takes its landmarks to those of the actual surface Q,
//! P' = f(P). The partner of a point P_i is the point c_i of Q that is closest to P'_i, and the error is
//! |P_i - c_i|: measured from where P_i was predicted, to what the landmarks say it has become.
//! Source: Kim et al. 2012, section 2.6 (docs/methods.md#distances-and-statistics).

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::alignment::LandmarkPair;
use super::both_ways::Pair;
use super::error::ComparisonError;
use super::statistics::Statistics;
use crate::mesh::{ClosestPoint, SurfaceSearch, Vector, Warning};
use crate::registration::thin_plate_spline::FEWEST;
use crate::registration::{AlignmentError, RigidTransform, ThinPlateSpline};

/// Distances in mm of the points of a prediction from their partners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarpedStatistics {
    pub landmarks: usize,
    /// Four landmarks give an affine map only.
    pub is_affine: bool,
    /// Every point counts the same.
    pub nodes: Statistics,
    /// Every point counts by its area on the prediction.
    pub area: Statistics,
    /// By area; positive where the prediction lies outside the actual surface.
    pub signed: Statistics,
}

/// None without landmarks, and with a warning where they do not determine a spline.
pub(super) fn warped(
    pair: &Pair,
    landmarks: &BTreeMap<String, LandmarkPair>,
    transform: &RigidTransform,
    warnings: &mut Vec<Warning>,
) -> Result<Option<WarpedStatistics>, ComparisonError> {
    if landmarks.is_empty() {
        return Ok(None);
    }
    let from: Vec<Vector> = landmarks.values().map(|landmark| landmark.prediction).collect();
    let to: Vec<Vector> = landmarks.values().map(|l| transform.apply(&l.actual)).collect();
    let spline = match ThinPlateSpline::new(&from, &to, 0.0) {
        Ok(spline) => spline,
        Err(AlignmentError::SamePlace { one, other, .. }) => {
            let name = |number| landmarks.keys().nth(number).map_or("", String::as_str);
            let why = format!("{} and {} are at one place", name(one), name(other));
            warnings.push(insufficient(landmarks.len(), &why));
            return Ok(None);
        }
        Err(error @ (AlignmentError::FewLandmarks { .. } | AlignmentError::Coplanar { .. })) => {
            warnings.push(insufficient(landmarks.len(), &error.to_string()));
            return Ok(None);
        }
        Err(error) => return Err(error.into()),
    };
    let areas = pair.prediction.point_areas();
    let points = pair.prediction.points.par_iter().with_min_len(256);
    let errors = points.map(|point| error(point, &spline, &pair.actual_search));
    let signed: Vec<f64> = errors.collect();
    let unsigned: Vec<f64> = signed.iter().map(|error| error.abs()).collect();
    Ok(Some(WarpedStatistics {
        landmarks: landmarks.len(),
        is_affine: landmarks.len() == FEWEST,
        nodes: Statistics::plain(&unsigned)?,
        area: Statistics::weighted(&unsigned, &areas)?,
        signed: Statistics::weighted(&signed, &areas)?,
    }))
}

fn insufficient(landmarks: usize, why: &str) -> Warning {
    let detail = format!("no distances by thin-plate spline: {why}");
    Warning::new("landmarks-insufficient", detail).with("count", landmarks as f64)
}

/// The same for points of a prediction, without a sign: `pairs` has their landmarks, the actual ones where the actual surface
/// lies. `None` of a point whose partner lies on an open border of that.
pub fn warped_distances(
    points: &[Vector],
    pairs: &[LandmarkPair],
    actual: &SurfaceSearch,
) -> Result<Vec<Option<f64>>, AlignmentError> {
    let from: Vec<Vector> = pairs.iter().map(|pair| pair.prediction).collect();
    let to: Vec<Vector> = pairs.iter().map(|pair| pair.actual).collect();
    let spline = ThinPlateSpline::new(&from, &to, 0.0)?;
    let distance = |point: &Vector| {
        let partner = partner(point, &spline, actual);
        (!actual.is_on_open_border(&partner)).then(|| (point - partner.point).norm())
    };
    Ok(points.par_iter().with_min_len(256).map(distance).collect())
}

fn partner(point: &Vector, spline: &ThinPlateSpline, actual: &SurfaceSearch) -> ClosestPoint {
    actual.closest(&spline.apply(point))
}

fn error(point: &Vector, spline: &ThinPlateSpline, actual: &SurfaceSearch) -> f64 {
    let closest = partner(point, spline, actual);
    let between = point - closest.point;
    let length = between.norm();
    if between.dot(&actual.pseudo_normal(&closest)) < 0.0 { -length } else { length }
}
