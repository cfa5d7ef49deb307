//! The tissue of the generic face as a smooth function of row, angle and depth, in mm, frame LPS.
//!
//! Base, nose, eyes, chin and the bone under them are those of the half head ([`face_shape`](super::super::face_shape)). The
//! mouth is its own: everything in it is measured from the line on which the lips meet, which is a row of the mesh, so that the
//! tissue can be parted there. Open lips are shifted up and down, the lower one by more, from full at the middle to nothing at the
//! corners, and fade with the distance from the line.
//!
//! Tissue is 6 to 15 mm thick, as textbooks of facial reconstruction have it for adults: thinnest at the forehead, thickest in
//! the cheek; skin is 2 mm of it.

use super::super::Vector;
use super::super::face_shape::{Relief, base, bell, flat_bell, normal_of, relief, thickness};

/// The row of the profile on which the lips meet.
pub(super) const LIP_ROW: f64 = 27.5;
/// Where the lips end, in radians from the front: 25 mm from the middle of the closed mouth.
pub(super) const CORNER_ANGLE: f64 = 0.4;
/// Skin is so thick everywhere, in mm.
const SKIN: f64 = 2.0;
/// The lips rise above their line as one opens, and fall below it, by these parts of the gap.
const RISE: [f64; 2] = [0.4, 0.6];
/// Rows over which the shift of open lips fades to 1/e.
const FADE: f64 = 5.0;

/// The depths between the layers, from the bone, 0, to the surface of the skin, 1; below the skin as shares of what lies below it.
pub(super) const DEPTHS: [f64; 4] = [0.0, 0.36, 0.68, 1.0];

/// Which of two points of the line of the lips is meant; elsewhere it makes no difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lip {
    Upper,
    Lower,
}

/// A face whose lips are so far apart in the middle, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FaceShape {
    pub gap: f64,
}

impl FaceShape {
    /// The five points across the tissue at a row and an angle >= 0 from the front, from bone to skin: mucosa or deep tissue ends
    /// at the second, muscle at the third, fat at the fourth.
    pub(super) fn column(&self, row: f64, angle: f64, lip: Lip) -> [Vector; 5] {
        let [bone, below_skin, skin] = self.ends(row, angle, lip);
        let [_, first, second, _] = DEPTHS.map(|share| bone + (below_skin - bone) * share);
        [bone, first, second, below_skin, skin]
    }

    /// A point below the skin: its share of the way from the bone to the lower side of the skin.
    pub(super) fn inside(&self, row: f64, angle: f64, depth: f64) -> Vector {
        let lip = if row < LIP_ROW { Lip::Lower } else { Lip::Upper };
        let [bone, below_skin, _] = self.ends(row, angle.abs(), lip);
        let mut point = bone + (below_skin - bone) * depth;
        point.x = point.x.copysign(angle);
        point
    }

    /// A point of the skin.
    pub(super) fn on_skin(&self, row: f64, angle: f64, lip: Lip) -> Vector {
        let [.., mut skin] = self.ends(row, angle.abs(), lip);
        skin.x = skin.x.abs().copysign(angle);
        skin
    }

    /// Bone, lower side of the skin, and its surface.
    fn ends(&self, row: f64, angle: f64, lip: Lip) -> [Vector; 3] {
        let surface = skin(row, angle);
        let bone = base(row, angle) + relief(&base(row, angle), &BONE) + mouth(row, angle) * 0.1
            - normal_of(base, row, angle) * thickness(row, angle);
        let across = (normal_of(skin, row, angle) + normal_of(base, row, angle)).normalize();
        let shift = Vector::z() * self.shift(row, angle, lip);
        [bone, surface - across * SKIN, surface].map(|point| point + shift)
    }

    fn shift(&self, row: f64, angle: f64, lip: Lip) -> f64 {
        let share = (1.0 - (angle / CORNER_ANGLE).powi(2)).max(0.0);
        let fade = (-((row - LIP_ROW) / FADE).powi(2)).exp();
        let [up, down] = RISE;
        let is_upper = row > LIP_ROW || (row == LIP_ROW && lip == Lip::Upper);
        self.gap * share * fade * if is_upper { up } else { -down }
    }
}

/// Of the groups of the relief the bone takes these shares, and the skin all but the mouth.
const BONE: Relief = Relief { nose: 0.7, brow: 0.75, hollow: 0.8, lips: 0.0, chin: 0.55 };
const ALL: Relief = Relief { nose: 1.0, brow: 1.0, hollow: 1.0, lips: 0.0, chin: 1.0 };

fn skin(row: f64, angle: f64) -> Vector {
    let base = base(row, angle);
    base + relief(&base, &ALL) + mouth(row, angle) + nostrils(&base)
}

/// Lips, philtrum and folds.
fn mouth(row: f64, angle: f64) -> Vector {
    let here = base(row, angle);
    let (x, z) = (here.x, here.z);
    let above = z - base(LIP_ROW, angle).z;
    let bow = 1.8 * bell(x - 5.5, 3.5);
    let fold = 15.0 + 0.55 * (-20.0 - z);
    let forward = 2.5 * bell(x, 22.0) * bell(above - 4.0, 12.0)
        + 3.4 * bell(above - 4.2 - bow, 2.6) * flat_bell(x, 19.0)
        - 5.0 * bell(above, 1.9) * flat_bell(x, 23.0)
        + 4.6 * bell(above + 5.4, 3.0) * flat_bell(x, 17.0)
        - 2.0 * bell(x - 27.0, 3.5) * bell(above + 1.0, 4.0)
        - 1.3 * bell(x, 2.6) * bell(above - 12.0, 4.0)
        + 0.7 * bell(x - 5.0, 2.2) * bell(above - 12.0, 4.0)
        - 1.5 * bell(x - fold, 3.4) * bell(z + 33.0, 9.0);
    -Vector::y() * forward
}

/// Hollows below the tip of the nose.
fn nostrils(base: &Vector) -> Vector {
    Vector::y() * (2.0 * bell(base.x - 6.5, 2.3) * bell(base.z + 26.5, 2.2))
}
