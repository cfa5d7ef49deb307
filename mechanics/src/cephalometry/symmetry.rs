//! Symmetry of a head: how pairs of landmarks and landmarks of the middle lie to its mid-sagittal plane.
//!
//! The plane goes through the mean of the middles of the pairs Po and Or, which no operation on the jaws moves, and across the mean of
//! their differences without its part along the normal of the Frankfort plane; never through single points. A skin without landmarks
//! of bone has a plane of its own, by the pairs of the eyes and the ears, and across the mean of their differences; upwards is then
//! from menton to nasion, without its part across the plane. A pair (l, r) is symmetric where the mirror image of l is r: what lies
//! between them is
//!   left = (l - o).n + (r - o).n,   up = (l - r).u,   forwards = (l - r).f
//! with n to the patient's left, u upwards and f forwards.

use super::landmarks::{Landmarks, SAME_PLACE};
use crate::mesh::Vector;

const BASE: [[&str; 2]; 2] = [["Po_L", "Po_R"], ["Or_L", "Or_R"]];

/// Pairs of the skin above the mouth, which operations on the jaws leave in their places.
const SKIN_BASE: [&str; 5] = ["exocanthion", "endocanthion", "orbitale", "zygion", "tragion"];

/// One pair of the skin says how wide a face is, and not how it is turned.
const FEWEST_PAIRS: usize = 2;

/// How names of pairs end.
const SIDES: [[&str; 2]; 3] = [["_L", "_R"], ["_l", "_r"], ["_left", "_right"]];

/// Landmarks that lie in the middle of a symmetric head.
const MIDDLE: [&str; 22] = [
    "S",
    "N",
    "A",
    "B",
    "Me",
    "ANS",
    "U1",
    "L1",
    "trichion",
    "glabella",
    "nasion",
    "pronasale",
    "columella",
    "subnasale",
    "labrale_superius",
    "stomion_superius",
    "stomion_inferius",
    "labrale_inferius",
    "sulcus_mentolabialis",
    "pogonion",
    "gnathion",
    "menton",
];

/// The plane in the middle of a head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MidSagittal {
    /// On the plane, in mm.
    pub through: Vector,
    pub left: Vector,
    pub up: Vector,
    pub forwards: Vector,
}

/// What lies between a landmark of the left, mirrored, and that of the right, or between a landmark of the middle and the plane, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymmetry {
    /// To the left; of a pair twice what its middle is beside the plane.
    pub left: f64,
    /// How much higher the left one is; 0 of a landmark of the middle.
    pub up: f64,
    /// How much farther in front the left one is; 0 of a landmark of the middle.
    pub forwards: f64,
}

impl Asymmetry {
    /// In mm.
    pub fn length(&self) -> f64 {
        Vector::new(self.left, self.up, self.forwards).norm()
    }
}

/// A landmark of the middle, or the two of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Symmetric {
    /// Of a pair without what says left or right.
    pub name: String,
    names: [String; 2],
}

impl MidSagittal {
    /// None where poria, orbitalia, N or Me are missing.
    pub fn of(landmarks: &Landmarks) -> Option<Self> {
        let up = landmarks.head()?.up;
        let pair = |names: &[&str; 2]| Some([landmarks.at(names[0])?, landmarks.at(names[1])?]);
        let pairs: Vec<[Vector; 2]> = BASE.iter().map(pair).collect::<Option<_>>()?;
        let across = across(&pairs);
        let left = (across - up * across.dot(&up)).try_normalize(SAME_PLACE)?;
        Some(MidSagittal { through: middle(&pairs), left, up, forwards: left.cross(&up) })
    }

    /// By landmarks of the skin alone. None where fewer than two pairs of eyes, cheekbones and ears are there, or nasion or menton
    /// are missing.
    pub fn of_skin(landmarks: &Landmarks) -> Option<Self> {
        let pair = |stem: &&str| {
            let sides = SIDES.iter();
            let pairs = sides.map(|own| own.map(|side| landmarks.at(&format!("{stem}{side}"))));
            pairs.into_iter().find_map(|[left, right]| Some([left?, right?]))
        };
        let pairs: Vec<[Vector; 2]> = SKIN_BASE.iter().filter_map(pair).collect();
        let left = across(&pairs).try_normalize(SAME_PLACE)?;
        let upwards = landmarks.at("nasion")? - landmarks.at("menton")?;
        let up = (upwards - left * upwards.dot(&left)).try_normalize(SAME_PLACE)?;
        let plane = MidSagittal { through: middle(&pairs), left, up, forwards: left.cross(&up) };
        (pairs.len() >= FEWEST_PAIRS).then_some(plane)
    }

    /// None where one of the landmarks is missing.
    pub fn asymmetry(&self, of: &Symmetric, landmarks: &Landmarks) -> Option<Asymmetry> {
        let [one, other] = [landmarks.at(&of.names[0])?, landmarks.at(&of.names[1])?];
        let beside = |at: Vector| (at - self.through).dot(&self.left);
        let apart = one - other;
        Some(match of.names[0] == of.names[1] {
            true => Asymmetry { left: beside(one), up: 0.0, forwards: 0.0 },
            false => Asymmetry {
                left: beside(one) + beside(other),
                up: apart.dot(&self.up),
                forwards: apart.dot(&self.forwards),
            },
        })
    }
}

/// The sum of what leads from the right to the left.
fn across(pairs: &[[Vector; 2]]) -> Vector {
    pairs.iter().map(|[left, right]| left - right).sum()
}

fn middle(pairs: &[[Vector; 2]]) -> Vector {
    let middles = pairs.iter().map(|[left, right]| (left + right) * 0.5);
    middles.sum::<Vector>() / pairs.len() as f64
}

impl Landmarks<'_> {
    /// The pairs among these landmarks and those of the middle, by name.
    pub fn symmetric(&self) -> Vec<Symmetric> {
        let names = self.0.keys();
        names.filter_map(|name| self.middle(name).or_else(|| self.pair(name))).collect()
    }

    fn middle(&self, name: &str) -> Option<Symmetric> {
        let own = name.to_owned();
        MIDDLE.contains(&name).then(|| Symmetric { name: own.clone(), names: [own.clone(), own] })
    }

    /// By the name of its left one.
    fn pair(&self, name: &str) -> Option<Symmetric> {
        SIDES.iter().find_map(|[left, right]| {
            let stem = name.strip_suffix(left)?;
            let other = format!("{stem}{right}");
            let names = [name.to_owned(), other];
            self.0.contains_key(&names[1]).then(|| Symmetric { name: stem.to_owned(), names })
        })
    }
}
