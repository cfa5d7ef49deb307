//! A generic face made by the program: soft tissue in hexahedra with lips that are parted, its bones, landmarks and muscles.
//!
//! Frame LPS in mm: x to the left, y to the back, z up; the face looks along -y and mirrors at x = 0 to the bit. It has the shape
//! of the half head, and besides: cells that follow the mouth, a gap between the lips, mucosa behind lips and cheeks, and the
//! muscles that move the mouth. It is a plausible adult and nobody's measured anatomy.

mod grid;
mod landmarks;
mod muscles;
mod shape;

use std::collections::BTreeMap;

use super::sample::bone_below;
use super::{CellShape, TriangleSurface, Vector, VolumeMesh};
use grid::Grid;
use shape::FaceShape;

pub use muscles::FaceMuscle;

/// The names of the values in the cell array `layer`. `mucosa` is the inner layer where no bone is behind it.
pub const LAYERS: [&str; 5] = ["deep", "muscle", "fat", "skin", "mucosa"];

/// Whether the lips touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lips {
    /// 0.3 mm apart in the middle, so that two surfaces are there.
    Closed,
    /// 6 mm apart in the middle.
    Open,
}

impl Lips {
    /// In mm, in the middle of the mouth.
    pub fn gap(self) -> f64 {
        match self {
            Lips::Closed => 0.3,
            Lips::Open => 6.0,
        }
    }
}

/// How the face is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceSettings {
    pub lips: Lips,
    /// 1 has 5616 hexahedra; n has n² as many. At least 1.
    pub fineness: usize,
    /// Hexahedra or what they are cut into.
    pub shape: CellShape,
}

/// Soft tissue, the bone below it, the points that surgeons measure, and muscles.
#[derive(Clone, Debug, PartialEq)]
pub struct GenericFace {
    /// Cell array `layer` (see [`LAYERS`]). Node sets: `maxilla`, `mandible` and `skull` on bone; `rim` on the cut faces;
    /// `upper_vestibule` and `lower_vestibule`, the mucosa that lies on teeth and gums; `upper_lip_margin` and
    /// `lower_lip_margin`, which face each other; `skin` without the rim, with its parts `nose`, `upper_lip`, `lower_lip`, `lips`, `chin` and
    /// `cheeks`.
    pub mesh: VolumeMesh,
    /// `maxilla`, `mandible` and `skull`: bone under the tissue, its normals towards the tissue.
    pub bones: BTreeMap<&'static str, TriangleSurface>,
    /// 32 of the skin, in the middle and in pairs that end in `_left` and `_right`.
    pub landmarks: BTreeMap<String, Vector>,
    pub muscles: Vec<FaceMuscle>,
}

/// A generic face.
pub fn generic_face(settings: FaceSettings) -> GenericFace {
    let shape = FaceShape { gap: settings.lips.gap() };
    let grid = Grid::of(settings.fineness.max(1), shape);
    let mesh = grid.mesh(settings.shape);
    GenericFace {
        bones: grid::BONES.into_iter().map(|name| (name, bone_below(&mesh, name))).collect(),
        landmarks: landmarks::of(&shape),
        muscles: muscles::of(&shape),
        mesh,
    }
}

#[cfg(test)]
mod tests;
