//! The profile of a face on its mid-plane, and the landmarks at which it turns.
//!
//! From below, the profile comes forward to the pogonion, back to the sublabiale, forward to the lips, back to the
//! subnasale and forward to the pronasale. Turns by less than 1.5 mm do not count. Closed lips may turn once between
//! themselves, at the stomion.
//!
//! Where the fold between chin and lower lip is shallower, the two are one turn, and the stomion would pass for the sublabiale.
//! Turns of .4 mm below it tell the fold; without any, a "fold" farther from the chin than from the nose is the stomion, and the sublabiale
//! is set between it and the chin.

use std::ops::RangeInclusive;

use super::mid_plane::MidPlane;
use crate::mesh::{TriangleSurface, Vector};

/// Heights of a profile are so far apart, in mm.
const STEP: f64 = 1.0;
/// A profile that turns back by less has not turned, in mm.
const LEAST_TURN: f64 = 1.5;
/// Below the upper fold, a fold of the lower lip is told from this depth on, in mm.
const LEAST_FOLD: f64 = 0.4;
/// From lower lip to chin it is this part of an upper lip at least: the two are alike in adults, some 21 mm.
const LEAST_CHIN: f64 = 0.5;
/// A chin is no farther behind the lower lip, in mm; a throat is.
const MOST_BEHIND: f64 = 8.0;
/// From the stomion a sublabiale lies at this share of the way to the pogonion: 17 of 30 mm in adults.
const FOLD_SHARE: f64 = 0.57;
/// What lies farther behind the foremost point is no face but a neck, or the back of a head whose front has a gap, in mm.
const FRONT: f64 = 90.0;
/// Landmarks have the skin between them, but for so much of it, in mm.
const LARGEST_GAP: f64 = 6.0;
/// The tip of a nose is no higher above its base, in mm.
const HIGHEST_TIP: f64 = 30.0;

/// The tip of a nose is no farther in front of its base, in mm.
const LONGEST_NOSE: f64 = 40.0;

/// Why a skin has no landmarks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    #[error("the mid-plane does not meet the skin")]
    Empty,
    #[error(
        "no face profile recognised: from the chin to its foremost point it turns forward {forward} times and backward {back} times, \
         a face forward 3 or 4 times; give landmarks"
    )]
    NoFace { forward: usize, back: usize },
    #[error(
        "the foremost point lies {above_mm:.0} mm above the base of the nose, 30 at most are a nose: is the face covered?"
    )]
    NoNose { above_mm: f64 },
    #[error(
        "the foremost point lies {behind_mm:.0} mm before the base of the nose, 40 at most are a nose"
    )]
    NoBase { behind_mm: f64 },
    #[error("the skin has a gap of {mm:.0} mm on the mid-plane of the face")]
    Gap { mm: f64 },
}

/// How far in front the skin is at heights of its mid-plane, from below.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    points: Vec<ProfilePoint>,
}

/// A point of a profile; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    pub height: f64,
    pub advance: f64,
}

/// Landmarks of the skin on the mid-plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileLandmarks {
    pub pogonion: ProfilePoint,
    /// The fold between chin and lower lip.
    pub sublabiale: ProfilePoint,
    pub subnasale: ProfilePoint,
    /// The tip of the nose, where it is seen.
    pub pronasale: Option<ProfilePoint>,
    /// How deep the fold at the sublabiale is, in mm, if that is too little for a turn: the border of chin and lips is doubtful. 0 where there
    /// is none.
    pub shallow_fold: Option<f64>,
}

impl Profile {
    pub fn of(skin: &TriangleSurface, plane: &MidPlane) -> Profile {
        let mut foremost: Vec<ProfilePoint> = Vec::new();
        let segments: Vec<[ProfilePoint; 2]> = (0..skin.triangles.len())
            .filter_map(|triangle| crossing(&skin.corners(triangle), plane))
            .collect();
        let low = segments.iter().flatten().map(|point| point.height).fold(f64::INFINITY, f64::min);
        let high =
            segments.iter().flatten().map(|point| point.height).fold(f64::NEG_INFINITY, f64::max);
        let count = if low <= high { ((high - low) / STEP) as usize + 1 } else { 0 };
        let height = |number: usize| low + number as f64 * STEP;
        foremost.extend(
            (0..count)
                .map(|number| ProfilePoint { height: height(number), advance: f64::NEG_INFINITY }),
        );
        for [lower, upper] in segments {
            let first = ((lower.height - low) / STEP).ceil() as usize;
            for number in (first..count).take_while(|&number| height(number) <= upper.height) {
                let share =
                    (height(number) - lower.height) / (upper.height - lower.height).max(1e-12);
                let advance = lower.advance + (upper.advance - lower.advance) * share;
                foremost[number].advance = foremost[number].advance.max(advance);
            }
        }
        let most = foremost.iter().map(|point| point.advance).fold(f64::NEG_INFINITY, f64::max);
        foremost.retain(|point| point.advance >= most - FRONT);
        Profile { points: foremost }
    }

    pub fn points(&self) -> &[ProfilePoint] {
        &self.points
    }

    /// The landmarks, from the turns of the profile below its foremost point.
    pub fn landmarks(&self) -> Result<ProfileLandmarks, ProfileError> {
        let foremost = self
            .points
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.advance.total_cmp(&b.1.advance))
            .ok_or(ProfileError::Empty)?;
        let below = &self.points[..=foremost.0];
        let turns = turns(below, LEAST_TURN);
        match turns[..] {
            [chin, fold, _, subnasale, pronasale] => {
                let chin = Chin::of(below, chin, fold, &subnasale);
                self.checked(chin, subnasale, pronasale)
            }
            [pogonion, sublabiale, _, _, _, subnasale, pronasale] => self.checked(
                Chin { pogonion, sublabiale, shallow_fold: None },
                subnasale,
                pronasale,
            ),
            _ => {
                let (forward, back) = (turns.len().div_ceil(2), turns.len() / 2);
                Err(ProfileError::NoFace { forward, back })
            }
        }
    }
}

/// What bounds a chin.
struct Chin {
    pogonion: ProfilePoint,
    sublabiale: ProfilePoint,
    shallow_fold: Option<f64>,
}

impl Chin {
    /// Of the first two turns of a profile, of which the second is the sublabiale or, where its fold is shallow, the stomion.
    fn of(
        profile: &[ProfilePoint],
        chin: ProfilePoint,
        fold: ProfilePoint,
        subnasale: &ProfilePoint,
    ) -> Chin {
        let lower: Vec<ProfilePoint> =
            profile.iter().filter(|point| point.height <= fold.height).copied().collect();
        let fine = turns(&lower, LEAST_FOLD);
        let upper_lip = subnasale.height - fold.height;
        if let [.., pogonion, sublabiale, lip] = fine[..] {
            let far = lip.height - pogonion.height >= LEAST_CHIN * upper_lip;
            if far && lip.advance - pogonion.advance <= MOST_BEHIND {
                let depth = lip.advance.min(pogonion.advance) - sublabiale.advance;
                return Chin { pogonion, sublabiale, shallow_fold: Some(depth) };
            }
        }
        if fold.height - chin.height <= upper_lip {
            return Chin { pogonion: chin, sublabiale: fold, shallow_fold: None };
        }
        let height = fold.height + FOLD_SHARE * (chin.height - fold.height);
        let off = |point: &&ProfilePoint| (point.height - height).abs();
        let nearest = lower.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        let sublabiale = nearest.copied().unwrap_or(fold);
        Chin { pogonion: chin, sublabiale, shallow_fold: Some(0.0) }
    }
}

impl Profile {
    /// Landmarks that are those of a face.
    fn checked(
        &self,
        chin: Chin,
        subnasale: ProfilePoint,
        pronasale: ProfilePoint,
    ) -> Result<ProfileLandmarks, ProfileError> {
        let Chin { pogonion, sublabiale, shallow_fold } = chin;
        let above_mm = pronasale.height - subnasale.height;
        if above_mm > HIGHEST_TIP {
            return Err(ProfileError::NoNose { above_mm });
        }
        let behind_mm = pronasale.advance - subnasale.advance;
        if behind_mm > LONGEST_NOSE {
            return Err(ProfileError::NoBase { behind_mm });
        }
        self.check_gaps(pogonion.height..=pronasale.height)?;
        let pronasale = Some(pronasale);
        Ok(ProfileLandmarks { pogonion, sublabiale, subnasale, pronasale, shallow_fold })
    }

    /// Between these heights the profile is whole.
    fn check_gaps(&self, heights: RangeInclusive<f64>) -> Result<(), ProfileError> {
        let inside: Vec<f64> = self
            .points
            .iter()
            .map(|point| point.height)
            .filter(|height| heights.contains(height))
            .collect();
        let mm = inside.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        if mm > LARGEST_GAP { Err(ProfileError::Gap { mm }) } else { Ok(()) }
    }
}

/// Where a triangle crosses the mid-plane, the lower end first.
fn crossing(corners: &[Vector; 3], plane: &MidPlane) -> Option<[ProfilePoint; 2]> {
    let places = corners.map(|corner| plane.coordinates(&corner));
    let mut ends = Vec::with_capacity(2);
    for (one, other) in [(0, 1), (1, 2), (2, 0)] {
        let [a, b] = [places[one], places[other]];
        if (a[0] > 0.0) != (b[0] > 0.0) {
            let share = a[0] / (a[0] - b[0]);
            let between = |axis: usize| a[axis] + (b[axis] - a[axis]) * share;
            ends.push(ProfilePoint { height: between(1), advance: between(2) });
        }
    }
    match ends[..] {
        [a, b] if a.height <= b.height => Some([a, b]),
        [a, b] => Some([b, a]),
        _ => None,
    }
}

/// Foremost and hindmost points by turns of at least so many mm, from the first foremost one to the last.
fn turns(points: &[ProfilePoint], least: f64) -> Vec<ProfilePoint> {
    let mut turns = Vec::new();
    let Some(&first) = points.first() else { return turns };
    let (mut best, mut seeks_front) = (first, true);
    for &point in points {
        let sign = if seeks_front { 1.0 } else { -1.0 };
        if sign * (point.advance - best.advance) >= 0.0 {
            best = point;
        } else if sign * (best.advance - point.advance) >= least {
            turns.push(best);
            (best, seeks_front) = (point, !seeks_front);
        }
    }
    if seeks_front {
        turns.push(best);
    }
    turns
}
