//! Landmarks: points of the template whose place on the patient is known, and whether they can be pairs.

use super::affine::Affine;
use super::error::ConformationError;
use crate::mesh::Vector;
use crate::registration::{PointAlignment, align_points};

/// What a similarity may leave of landmarks, as a share of their spread: two faces of the shared data leave 0.1.
const MOST_LEFT: f64 = 0.3;

/// Beyond this share more than a pair of them is wrong.
const NO_PAIRS: f64 = 0.6;

/// Sides are swapped when a mirror image leaves less than this share.
const MIRRORED: f64 = 0.5;

/// Two landmarks are exchanged when that leaves less than this share of what they are apart.
const EXCHANGED: f64 = 0.5;

/// In mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    pub name: String,
    pub template: Vector,
    pub patient: Vector,
}

/// Three determine a similarity.
pub(super) const FEWEST: usize = 3;

/// The similarity of least squares between landmarks, if they can be pairs.
pub(super) fn similarity(landmarks: &[Landmark]) -> Result<Affine, ConformationError> {
    if landmarks.len() < FEWEST {
        let needed = FEWEST;
        return Err(ConformationError::FewLandmarks { landmarks: landmarks.len(), needed });
    }
    let from: Vec<Vector> = landmarks.iter().map(|landmark| landmark.template).collect();
    let to: Vec<Vector> = landmarks.iter().map(|landmark| landmark.patient).collect();
    let [(from_middle, from_size), (to_middle, to_size)] = [&from, &to].map(|x| spread(x));
    let scale = to_size / from_size;
    let scaled: Vec<Vector> = from.iter().map(|x| (x - from_middle) * scale).collect();
    let aligned = align_points(&scaled, &to).map_err(ConformationError::Landmarks)?;
    let matrix = aligned.transform.rotation * scale;
    let map = Affine { matrix, shift: to_middle - matrix * from_middle };
    refuse_scale(scale)?;
    refuse_mirrored(&aligned)?;
    if aligned.rms <= NO_PAIRS * to_size {
        refuse_exchanges(landmarks, &map)?;
    }
    refuse_unlike(landmarks, &map, aligned.rms, to_size)?;
    Ok(map)
}

pub(super) fn refuse_scale(scale: f64) -> Result<(), ConformationError> {
    match (0.5..=2.0).contains(&scale) {
        true => Ok(()),
        false => Err(ConformationError::Scale { scale }),
    }
}

fn refuse_mirrored(aligned: &PointAlignment) -> Result<(), ConformationError> {
    let (rms, mirrored) = (aligned.rms, aligned.mirrored_rms);
    match mirrored < MIRRORED * rms {
        true => Err(ConformationError::Mirrored { rms, mirrored }),
        false => Ok(()),
    }
}

fn refuse_unlike(
    landmarks: &[Landmark],
    map: &Affine,
    rms: f64,
    spread: f64,
) -> Result<(), ConformationError> {
    if rms <= MOST_LEFT * spread {
        return Ok(());
    }
    let left = landmarks.iter().map(|one| (left_of(one, &one.patient, map), one.name.as_str()));
    let (left, worst) = left.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
    let share = 100.0 * rms / spread;
    Err(ConformationError::Unlike { rms, share, spread, worst: worst.to_owned(), left })
}

fn refuse_exchanges(landmarks: &[Landmark], map: &Affine) -> Result<(), ConformationError> {
    for (number, one) in landmarks.iter().enumerate() {
        for other in &landmarks[..number] {
            let apart = left_of(one, &one.patient, map).hypot(left_of(other, &other.patient, map));
            let exchanged =
                left_of(one, &other.patient, map).hypot(left_of(other, &one.patient, map));
            // Landmarks nearer to each other than faces differ could be either.
            let far = (one.patient - other.patient).norm();
            if exchanged < EXCHANGED * apart && apart > far {
                let (one, other) = (other.name.clone(), one.name.clone());
                let half = std::f64::consts::FRAC_1_SQRT_2;
                let (apart, exchanged) = (apart * half, exchanged * half);
                return Err(ConformationError::Exchanged { one, other, apart, exchanged });
            }
        }
    }
    Ok(())
}

fn left_of(landmark: &Landmark, patient: &Vector, map: &Affine) -> f64 {
    (map.apply(&landmark.template) - patient).norm()
}

/// The mean of points and the root of their mean squared distance from it, in mm.
pub(super) fn spread(points: &[Vector]) -> (Vector, f64) {
    let count = points.len().max(1) as f64;
    let middle = points.iter().sum::<Vector>() / count;
    let squares: f64 = points.iter().map(|point| (point - middle).norm_squared()).sum();
    (middle, (squares / count).sqrt().max(f64::MIN_POSITIVE))
}
