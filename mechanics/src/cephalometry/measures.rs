//! Measures of a head by its landmarks: angles, lengths and ratios, in space.
//!
//! Landmarks of bone: S sella, N nasion, A and B subspinale and supramentale, ANS the anterior nasal spine, Me menton,
//! Go_L and Go_R gonion, Po_L and Po_R porion, Or_L and Or_R orbitale, U1 and L1 the edges of upper and lower central
//! incisor, Oc a point on the occlusal plane behind U1. Left and right are the patient's. Of skin: glabella, columella,
//! pronasale, subnasale, labrale_superius, stomion_superius, stomion_inferius, labrale_inferius, pogonion, menton.
//!
//! The Frankfort plane is the one nearest to both poria and both orbitalia in the sense of least squares, its normal n
//! upwards. Left is the mean of the differences of the pairs, without its part along n, never a single point; forwards
//! is left x n. So nothing depends on how the head lies in the scanner. An angle between a line and the plane is
//! asin(d . n / |d|).

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::Matrix3;

use crate::mesh::{Frame, Vector};

/// Landmarks nearer to each other than this, in mm, have no direction.
const SAME_PLACE: f64 = 1e-6;

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

/// Landmarks in mm by their names.
pub struct Landmarks<'a>(pub &'a BTreeMap<String, Vector>);

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
    bone("sn_to_frankfort", Unit::Degrees, "Steiner 1953", |l| {
        l.above_frankfort(l.at("S")?, l.at("N")?)
    }),
    bone("wits", Unit::Millimetres, "Jacobson 1975", |l| {
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
    skin("facial_convexity", Unit::Degrees, "Legan, Burstone 1980", |l| {
        Some(180.0 - l.angle("glabella", "subnasale", "pogonion")?)
    }),
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

/// The directions of a head, each of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadAxes {
    pub up: Vector,
    pub left: Vector,
    pub forwards: Vector,
}

/// Why landmarks are doubted.
#[derive(Clone, Debug, PartialEq)]
pub struct SwappedSides {
    pub left: String,
    pub right: String,
    /// How far the left one lies to the right of the right one, in mm.
    pub by: f64,
}

impl fmt::Display for SwappedSides {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let SwappedSides { left, right, by } = self;
        write!(f, "landmark {left} lies {by:.1} mm to the right of {right}: are the sides swapped?")
    }
}

const PAIRS: [[&str; 2]; 3] = [["Po_L", "Po_R"], ["Or_L", "Or_R"], ["Go_L", "Go_R"]];

impl Landmarks<'_> {
    pub(super) fn at(&self, name: &str) -> Option<Vector> {
        self.0.get(name).copied()
    }

    fn direction(&self, from: &str, to: &str) -> Option<Vector> {
        (self.at(to)? - self.at(from)?).try_normalize(SAME_PLACE)
    }

    fn length(&self, from: &str, to: &str) -> Option<f64> {
        Some((self.at(to)? - self.at(from)?).norm())
    }

    /// At the middle one of three landmarks, in degrees.
    fn angle(&self, one: &str, at: &str, other: &str) -> Option<f64> {
        let (a, b) = (self.direction(at, one)?, self.direction(at, other)?);
        Some(a.cross(&b).norm().atan2(a.dot(&b)).to_degrees())
    }

    fn distance_from_line(&self, point: &str, from: &str, to: &str) -> Option<f64> {
        let along = self.direction(from, to)?;
        Some((self.at(point)? - self.at(from)?).cross(&along).norm())
    }

    /// Of the line between two places, in degrees; positive where the second is higher.
    fn above_frankfort(&self, from: Vector, to: Vector) -> Option<f64> {
        let direction = (to - from).try_normalize(SAME_PLACE)?;
        Some(direction.dot(&self.head()?.up).clamp(-1.0, 1.0).asin().to_degrees())
    }

    /// The directions of the head; nothing where poria, orbitalia, N or Me are missing.
    pub fn head(&self) -> Option<HeadAxes> {
        let plane = [self.at("Po_L")?, self.at("Po_R")?, self.at("Or_L")?, self.at("Or_R")?];
        let middle = plane.iter().sum::<Vector>() / 4.0;
        let moments = plane.iter().map(|p| (p - middle) * (p - middle).transpose());
        let modes = moments.sum::<Matrix3<f64>>().symmetric_eigen();
        let normal = modes.eigenvectors.column(modes.eigenvalues.imin()).into_owned();
        let upwards = self.at("N")? - self.at("Me")?;
        let up = if normal.dot(&upwards) < 0.0 { -normal } else { normal };
        let pairs = PAIRS.iter().filter_map(|[left, right]| Some(self.at(left)? - self.at(right)?));
        let across = pairs.sum::<Vector>();
        let left = (across - up * across.dot(&up)).try_normalize(SAME_PLACE)?;
        Some(HeadAxes { up, left, forwards: left.cross(&up) })
    }

    /// Pairs whose left one lies on the right, by the frame: x points to the left in LPS, to the right in RAS.
    pub fn swapped_sides(&self, frame: Frame) -> Vec<SwappedSides> {
        let sign = match frame {
            Frame::Lps => 1.0,
            Frame::Ras => -1.0,
            Frame::Unspecified => return Vec::new(),
        };
        let swapped = |[left, right]: &[&str; 2]| {
            let by = sign * (self.at(right)?.x - self.at(left)?.x);
            let (left, right) = ((*left).to_owned(), (*right).to_owned());
            (by > 0.0).then_some(SwappedSides { left, right, by })
        };
        PAIRS.iter().filter_map(swapped).collect()
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
