//! Measures of a head by its landmarks: angles, lengths and ratios, in space.
//!
//! Landmarks of bone: S sella, N nasion, A and B subspinale and supramentale, ANS the anterior nasal spine, Me menton,
//! Go_L and Go_R gonion, Po_L and Po_R porion, Or_L and Or_R orbitale, U1 and L1 the edges of upper and lower central
//! incisor, Oc a point on the occlusal plane behind U1. Left and right are the patient's. Of skin: glabella, columella,
//! pronasale, subnasale, labrale_superius, stomion_superius, stomion_inferius, labrale_inferius, pogonion, menton.

use super::landmarks::{Landmarks, SAME_PLACE};
use super::symmetry::MidSagittal;

/// The golden ratio.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// Unit of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    Degrees,
    Millimetres,
    Ratio,
}

/// Tissue of the landmarks of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tissue {
    Bone,
    Skin,
}

/// A number by its name in documents, and who defined it.
pub struct Measure {
    pub name: &'static str,
    pub unit: Unit,
    pub tissue: Tissue,
    pub source: &'static str,
    value: fn(&Landmarks) -> Option<f64>,
}

/// Every measure, in the order in which they are reported.
pub const MEASURES: [Measure; 20] = [
    bone("sna", Unit::Degrees, "Riedel 1952", |l| l.angle("S", "N", "A")),
    bone("snb", Unit::Degrees, "Riedel 1952", |l| l.angle("S", "N", "B")),
    // A difference, so that it keeps its sign: positive where the upper jaw is in front.
    bone("anb", Unit::Degrees, "Riedel 1952", |l| {
        Some(l.angle("S", "N", "A")? - l.angle("S", "N", "B")?)
    }),
    bone("fma", Unit::Degrees, "Tweed 1946", |l| {
        l.above_frankfort(l.at("Me")?, (l.at("Go_L")? + l.at("Go_R")?) * 0.5)
    }),
    bone("sn_to_frankfort", Unit::Degrees, "S-N above Frankfort", |l| {
        l.above_frankfort(l.at("S")?, l.at("N")?)
    }),
    bone("wits", Unit::Millimetres, "Jacobson 1975, along U1-Oc", |l| {
        Some((l.at("B")? - l.at("A")?).dot(&l.direction("U1", "Oc")?))
    }),
    bone("overjet", Unit::Millimetres, "along Frankfort", |l| {
        Some((l.at("U1")? - l.at("L1")?).dot(&l.head()?.forwards))
    }),
    bone("overbite", Unit::Millimetres, "across Frankfort", |l| {
        Some((l.at("L1")? - l.at("U1")?).dot(&l.head()?.up))
    }),
    bone("overjet_occlusal", Unit::Millimetres, "along U1-Oc", |l| {
        Some((l.at("L1")? - l.at("U1")?).dot(&l.direction("U1", "Oc")?))
    }),
    bone("overbite_occlusal", Unit::Millimetres, "across U1-Oc", |l| {
        let back = l.direction("U1", "Oc")?;
        let up = l.head()?.up;
        let up = (up - back * up.dot(&back)).try_normalize(SAME_PLACE)?;
        Some((l.at("L1")? - l.at("U1")?).dot(&up))
    }),
    bone("upper_face_height", Unit::Millimetres, "N-ANS, Wylie 1952", |l| l.length("N", "ANS")),
    bone("lower_face_height", Unit::Millimetres, "ANS-Me, Wylie 1952", |l| l.length("ANS", "Me")),
    bone("lower_face_share", Unit::Ratio, "ANS-Me to N-Me, Wylie 1952", |l| {
        Some(l.length("ANS", "Me")? / l.length("N", "Me")?)
    }),
    bone("golden_height_error", Unit::Ratio, "N-Me to ANS-Me less 1.618, Ricketts 1982", |l| {
        Some(l.length("N", "Me")? / l.length("ANS", "Me")? - GOLDEN)
    }),
    skin(
        "facial_convexity",
        Unit::Degrees,
        "Legan, Burstone 1980, positive where convex",
        convexity,
    ),
    skin("nasolabial_angle", Unit::Degrees, "Legan, Burstone 1980", |l| {
        l.angle("columella", "subnasale", "labrale_superius")
    }),
    skin("upper_lip_from_e_line", Unit::Millimetres, "Ricketts 1957, without sign", |l| {
        l.distance_from_line("labrale_superius", "pronasale", "pogonion")
    }),
    skin("lower_lip_from_e_line", Unit::Millimetres, "Ricketts 1957, without sign", |l| {
        l.distance_from_line("labrale_inferius", "pronasale", "pogonion")
    }),
    skin(
        "face_height_ratio",
        Unit::Ratio,
        "G-Sn to Sn-Me, Legan, Burstone 1980, as lengths",
        |l| Some(l.length("glabella", "subnasale")? / l.length("subnasale", "menton")?),
    ),
    skin(
        "lip_chin_ratio",
        Unit::Ratio,
        "Sn-Sts to Sti-Me, Legan, Burstone 1980, as lengths",
        |l| {
            let lip = l.length("subnasale", "stomion_superius")?;
            Some(lip / l.length("stomion_inferius", "menton")?)
        },
    ),
];

/// Between G-Sn and Sn-Pg in the mid-sagittal plane, in degrees: positive where subnasale lies in front of the line from glabella to
/// pogonion. None where neither bone, nor pairs of the skin, nor the tip of the nose say where the front is.
fn convexity(landmarks: &Landmarks) -> Option<f64> {
    let [glabella, subnasale, pogonion] =
        [landmarks.at("glabella")?, landmarks.at("subnasale")?, landmarks.at("pogonion")?];
    let plane = MidSagittal::of(landmarks).or_else(|| MidSagittal::of_skin(landmarks));
    let (forwards, up) = match plane {
        Some(plane) => (plane.forwards, plane.up),
        None => {
            let up = (glabella - subnasale).try_normalize(SAME_PLACE)?;
            let nose = landmarks.at("pronasale")? - subnasale;
            ((nose - up * nose.dot(&up)).try_normalize(SAME_PLACE)?, up)
        }
    };
    let [upper, lower] = [glabella - subnasale, subnasale - pogonion]
        .map(|part| part.dot(&forwards).atan2(part.dot(&up)).to_degrees());
    Some(lower - upper)
}

const fn bone(
    name: &'static str,
    unit: Unit,
    source: &'static str,
    value: fn(&Landmarks) -> Option<f64>,
) -> Measure {
    Measure { name, unit, tissue: Tissue::Bone, source, value }
}

const fn skin(
    name: &'static str,
    unit: Unit,
    source: &'static str,
    value: fn(&Landmarks) -> Option<f64>,
) -> Measure {
    Measure { name, unit, tissue: Tissue::Skin, source, value }
}

impl Measure {
    /// Nothing where a landmark is missing or two of them coincide.
    pub fn of(&self, landmarks: &Landmarks) -> Option<f64> {
        (self.value)(landmarks).filter(|value| value.is_finite())
    }
}

impl Unit {
    pub fn name(self) -> &'static str {
        match self {
            Unit::Degrees => "deg",
            Unit::Millimetres => "mm",
            Unit::Ratio => "1",
        }
    }
}
