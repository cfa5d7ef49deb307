//! Landmarks that lie far from where the other landmarks and the surfaces put them.
//!
//! Each is left out of a coarse fit once (cross-validation), and how far it lies from its place in that fit is compared with the
//! median over all landmarks.

use rayon::prelude::*;

use super::error::ConformationError;
use super::landmark::Landmark;
use super::schedule::coarse_levels;
use super::start::Start;
use super::surfaces::{Patient, Surfaces};
use crate::progress::{Inner, Progress};

/// Fits of a cross-validation: each leaves out every eighth landmark.
const PARTS: usize = 8;

/// Fewer landmarks do not tell which of them is wrong.
pub const FEWEST_CHECKED: usize = 6;

/// In medians: two faces of the shared data have correct landmarks, at the rim of the skin, of up to 5.7.
const LEFT_OUT: f64 = 8.0;
const DOUBTFUL: f64 = 4.0;

/// In mm: nearer than this, a landmark is as near as landmarks are picked.
const AS_PICKED: f64 = 3.0;

/// At most every so manieth landmark is left out: beyond, no majority tells what is right.
const MOST_LEFT_OUT: usize = 4;

/// A landmark far from where a fit without it puts it.
#[derive(Clone, Debug, PartialEq)]
pub struct DoubtfulLandmark {
    pub name: String,
    /// From its place in that fit, in mm.
    pub distance: f64,
    /// Of all landmarks' distances, in mm.
    pub median: f64,
    pub is_left_out: bool,
}

/// The landmarks in doubt, and those that are used.
pub(super) fn doubtful(
    surfaces: &Surfaces,
    patient: &Patient,
    start: Start,
    progress: &dyn Progress,
) -> Result<(Vec<DoubtfulLandmark>, Vec<Landmark>), ConformationError> {
    let mut kept = patient.landmarks.to_vec();
    let mut doubtful = Vec::new();
    while kept.len() >= FEWEST_CHECKED {
        let rest = Patient { landmarks: &kept, ..*patient };
        let Some(distances) = distances_left_out(surfaces, &rest, start, progress)? else { break };
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[sorted.len() / 2];
        let limit = |medians: f64| (medians * median).max(AS_PICKED);
        let in_doubt = |at: usize, is_left_out: bool| DoubtfulLandmark {
            name: kept[at].name.clone(),
            distance: distances[at],
            median,
            is_left_out,
        };
        let all = 0..kept.len();
        let worst = all.clone().max_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        let may_go = |&at: &usize| {
            distances[at] > limit(LEFT_OUT)
                && MOST_LEFT_OUT * (doubtful.len() + 1) <= patient.landmarks.len()
        };
        match worst.filter(may_go) {
            Some(worst) => {
                doubtful.push(in_doubt(worst, true));
                kept.remove(worst);
            }
            None => {
                let far = all.filter(|&at| distances[at] > limit(DOUBTFUL));
                doubtful.extend(far.map(|at| in_doubt(at, false)));
                break;
            }
        }
    }
    Ok((doubtful, kept))
}

/// How far each landmark lies from where a coarse fit without it puts it, in mm; nothing where there is no such fit.
fn distances_left_out(
    surfaces: &Surfaces,
    patient: &Patient,
    start: Start,
    progress: &dyn Progress,
) -> Result<Option<Vec<f64>>, ConformationError> {
    let landmarks = patient.landmarks;
    let parts = PARTS.min(landmarks.len());
    let fits = (0..parts).into_par_iter().map(|part| {
        let all = landmarks.iter().enumerate();
        let (out, kept): (Vec<_>, Vec<_>) = all.partition(|(at, _)| at % parts == part);
        let kept: Vec<Landmark> = kept.into_iter().map(|(_, landmark)| landmark.clone()).collect();
        let rest = Patient { landmarks: &kept, ..*patient };
        let map = surfaces.fitted(&rest, start, &coarse_levels(), &Inner(progress))?;
        let distance =
            |landmark: &Landmark| (map.apply(&landmark.template) - landmark.patient).norm();
        Ok(out.into_iter().map(|(at, landmark)| (at, distance(landmark))).collect::<Vec<_>>())
    });
    let mut distances = vec![0.0; landmarks.len()];
    for fit in fits.collect::<Vec<_>>() {
        match fit {
            Ok(part) => part.into_iter().for_each(|(at, distance)| distances[at] = distance),
            Err(error @ ConformationError::Cancelled { .. }) => return Err(error),
            Err(_) => return Ok(None),
        }
    }
    Ok(Some(distances))
}
