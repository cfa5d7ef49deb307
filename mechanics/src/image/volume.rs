//! A scalar image on a regular grid that may stand obliquely.
//!
//! x(i) = origin + D diag(spacing) i, where i counts voxels along each axis, the columns of D are the
//! directions of the axes, and the value of a voxel stands at its centre. Between eight centres the value
//! is trilinear; beyond the outermost centres there is none, and none is made up.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Matrix3;

use crate::mesh::{Frame, Vector};

/// A point this far outside, in voxels, is on the border: rounding of a mesh that ends where the image does.
const BORDER: f64 = 1e-6;
/// Axes that span less than this part of the box of their lengths lie in a plane.
const FLAT: f64 = 1e-6;
/// Distances of voxels, in mm.
const SPACING: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
/// Farthest coordinate of the first voxel, in mm.
const FARTHEST: f64 = 1e9;

/// The values of all voxels, the first axis fastest.
#[derive(Clone, Debug, PartialEq)]
pub enum Voxels {
    I16(Vec<i16>),
    F32(Vec<f32>),
}

impl Voxels {
    pub fn len(&self) -> usize {
        match self {
            Voxels::I16(values) => values.len(),
            Voxels::F32(values) => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// About what they take in memory.
    pub fn bytes(&self) -> usize {
        match self {
            Voxels::I16(values) => 2 * values.len(),
            Voxels::F32(values) => 4 * values.len(),
        }
    }

    fn range(&self) -> (f64, f64) {
        let wider = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        let none = (f64::INFINITY, f64::NEG_INFINITY);
        match self {
            Voxels::I16(values) => values.iter().map(|&v| f64::from(v)).fold(none, wider),
            Voxels::F32(values) => values.iter().map(|&v| f64::from(v)).fold(none, wider),
        }
    }
}

/// Where the voxels are, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The centre of the first voxel.
    pub origin: Vector,
    /// For each axis the way from one voxel to the next: direction times spacing.
    pub steps: [Vector; 3],
}

/// Why voxels are no image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageError {
    #[error("{size} voxels along axis {axis}: two or more have an inside")]
    Thin { axis: usize, size: usize },
    #[error("{have} voxels where the sizes ask for {wanted}")]
    Count { have: usize, wanted: usize },
    #[error("{count} voxels are not finite numbers, the first is voxel {first}")]
    NonFinite { count: usize, first: usize },
    #[error("voxels are {spacing} mm apart along axis {axis}; 1e-6 to 1e6 mm are possible")]
    Spacing { axis: usize, spacing: f64 },
    #[error("the three directions lie in one plane")]
    Flat,
    #[error("the origin is farther than 1e9 mm away or no number")]
    Origin,
}

/// Hounsfield units, or any other scalar, in space. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageVolume {
    size: [usize; 3],
    placement: Placement,
    to_index: Matrix3<f64>,
    voxels: Arc<Voxels>,
    label_names: Arc<BTreeMap<u16, String>>,
}

impl Placement {
    /// Refuses axes that a point cannot be found along.
    pub fn check(&self) -> Result<(), ImageError> {
        self.to_index().map(|_| ())
    }

    fn to_index(self) -> Result<Matrix3<f64>, ImageError> {
        if !self.origin.iter().all(|coordinate| coordinate.abs() <= FARTHEST) {
            return Err(ImageError::Origin);
        }
        for (axis, step) in self.steps.iter().enumerate() {
            let spacing = step.norm();
            if !SPACING.contains(&spacing) {
                // A length that overflows is told by its largest part.
                let spacing = if spacing.is_finite() { spacing } else { step.amax() };
                return Err(ImageError::Spacing { axis, spacing });
            }
        }
        let directions = Matrix3::from_columns(&self.steps.map(|step| step.normalize()));
        if directions.determinant().abs() < FLAT {
            return Err(ImageError::Flat);
        }
        Matrix3::from_columns(&self.steps).try_inverse().ok_or(ImageError::Flat)
    }

    /// The same place in the words of another frame. Where one of the frames is not known, coordinates are
    /// taken as they stand.
    pub fn turned(&self, from: Frame, to: Frame) -> Placement {
        match (from, to) {
            (Frame::Lps, Frame::Ras) | (Frame::Ras, Frame::Lps) => {
                let turn = |v: Vector| Vector::new(-v.x, -v.y, v.z);
                Placement { origin: turn(self.origin), steps: self.steps.map(turn) }
            }
            _ => *self,
        }
    }
}

impl ImageVolume {
    /// `size` voxels along each axis, at least two; every value is a finite number.
    pub fn new(
        size: [usize; 3],
        placement: Placement,
        voxels: Voxels,
    ) -> Result<ImageVolume, ImageError> {
        if let Some(axis) = size.iter().position(|&size| size < 2) {
            return Err(ImageError::Thin { axis, size: size[axis] });
        }
        let (have, wanted) =
            (voxels.len(), size.iter().fold(1, |n: usize, &m| n.saturating_mul(m)));
        if have != wanted {
            return Err(ImageError::Count { have, wanted });
        }
        if let Voxels::F32(values) = &voxels
            && let Some(first) = values.iter().position(|value| !value.is_finite())
        {
            let count = values.iter().filter(|value| !value.is_finite()).count();
            return Err(ImageError::NonFinite { count, first });
        }
        let to_index = placement.to_index()?;
        let (voxels, label_names) = (Arc::new(voxels), Arc::default());
        Ok(ImageVolume { size, placement, to_index, voxels, label_names })
    }

    /// The same image, whose values are labels with these names.
    pub fn with_label_names(self, names: BTreeMap<u16, String>) -> ImageVolume {
        ImageVolume { label_names: Arc::new(names), ..self }
    }

    /// What the file calls values of an image that are labels; empty for a scan.
    pub fn label_names(&self) -> &BTreeMap<u16, String> {
        &self.label_names
    }

    /// Voxels along each axis.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Turns the way from the first voxel's centre, in mm, into voxels.
    pub(crate) fn to_index(&self) -> &Matrix3<f64> {
        &self.to_index
    }

    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// The distance of voxels along each axis, in mm.
    pub fn spacing(&self) -> [f64; 3] {
        self.placement.steps.map(|step| step.norm())
    }

    /// The direction of each axis, of length 1.
    pub fn directions(&self) -> [Vector; 3] {
        self.placement.steps.map(|step| step.normalize())
    }

    /// Volume of one voxel, in mm³.
    pub fn voxel_volume(&self) -> f64 {
        Matrix3::from_columns(&self.placement.steps).determinant().abs()
    }

    /// The lowest and the highest value.
    pub fn range(&self) -> (f64, f64) {
        self.voxels.range()
    }

    /// The box around all centres of voxels.
    pub fn bounds(&self) -> (Vector, Vector) {
        let ends = self.size.map(|size| (size - 1) as f64);
        let corner = |number: usize| {
            (0..3).fold(self.placement.origin, |corner, axis| match number >> axis & 1 {
                0 => corner,
                _ => corner + self.placement.steps[axis] * ends[axis],
            })
        };
        (1..8)
            .map(corner)
            .fold((corner(0), corner(0)), |(low, high), x| (low.inf(&x), high.sup(&x)))
    }

    /// The same image with its values limited to a range, and how many were below and above it.
    pub fn limited(&self, [low, high]: [f64; 2]) -> (ImageVolume, [usize; 2]) {
        let (least, most) = self.range();
        let mut counts = [0; 2];
        if least >= low && most <= high {
            return (self.clone(), counts);
        }
        let mut limit = |value: f64| {
            counts[0] += usize::from(value < low);
            counts[1] += usize::from(value > high);
            value.clamp(low, high)
        };
        let voxels = match &*self.voxels {
            Voxels::I16(values) => {
                let limited = values.iter().map(|&value| limit(f64::from(value)).round() as i16);
                Voxels::I16(limited.collect())
            }
            Voxels::F32(values) => {
                let limited = values.iter().map(|&value| limit(f64::from(value)) as f32);
                Voxels::F32(limited.collect())
            }
        };
        (ImageVolume { voxels: Arc::new(voxels), ..self.clone() }, counts)
    }

    /// The centre of a voxel.
    pub fn centre(&self, index: [usize; 3]) -> Vector {
        let steps = self.placement.steps.iter().zip(index);
        steps.fold(self.placement.origin, |sum, (step, count)| sum + step * count as f64)
    }

    /// The same image in the words of another frame, sharing its voxels.
    pub fn turned(&self, from: Frame, to: Frame) -> ImageVolume {
        let placement = self.placement.turned(from, to);
        let to_index = placement.to_index().unwrap_or(self.to_index);
        ImageVolume { placement, to_index, ..self.clone() }
    }

    /// The value at a point; `None` outside the centres of the outermost voxels.
    pub fn at(&self, point: &Vector) -> Option<f64> {
        let place = self.to_index * (point - self.placement.origin);
        let mut base = [0; 3];
        let mut part = [0.0; 3];
        for axis in 0..3 {
            let last = (self.size[axis] - 1) as f64;
            if !(-BORDER..=last + BORDER).contains(&place[axis]) {
                return None;
            }
            let inside = place[axis].clamp(0.0, last);
            base[axis] = (inside as usize).min(self.size[axis] - 2);
            part[axis] = inside - base[axis] as f64;
        }
        let [rows, slices] = [self.size[0], self.size[0] * self.size[1]];
        let first = base[0] + rows * base[1] + slices * base[2];
        let corners = [0, rows, slices, slices + rows];
        Some(match &*self.voxels {
            Voxels::I16(values) => {
                trilinear(corners.map(|corner| pair(&values[first + corner..])), part)
            }
            Voxels::F32(values) => {
                trilinear(corners.map(|corner| pair(&values[first + corner..])), part)
            }
        })
    }
}

/// Two neighbours along the first axis.
fn pair<T: Copy + Into<f64>>(values: &[T]) -> [f64; 2] {
    [values[0].into(), values[1].into()]
}

/// Along the first axis, then the second, then the third.
fn trilinear(corners: [[f64; 2]; 4], [x, y, z]: [f64; 3]) -> f64 {
    let between = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let [near, far, above, beyond] = corners.map(|[a, b]| between(a, b, x));
    between(between(near, far, y), between(above, beyond, y), z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(steps: [Vector; 3]) -> Result<ImageVolume, ImageError> {
        let placement = Placement { origin: Vector::new(1.0, 2.0, 3.0), steps };
        let values = (0..24).map(|value| value as i16).collect();
        ImageVolume::new([2, 3, 4], placement, Voxels::I16(values))
    }

    fn upright() -> [Vector; 3] {
        [Vector::x() * 0.5, Vector::y() * -2.0, Vector::z() * 3.0]
    }

    #[test]
    fn a_voxel_has_its_own_value_at_its_centre() {
        let image = image(upright()).unwrap();
        for (k, j, i) in (0..24).map(|n| (n / 6, n / 2 % 3, n % 2)) {
            let value = image.at(&image.centre([i, j, k])).unwrap();
            assert_eq!(value, (i + 2 * j + 6 * k) as f64);
        }
        assert_eq!(image.range(), (0.0, 23.0));
        assert_eq!(image.spacing(), [0.5, 2.0, 3.0]);
        assert_eq!(image.voxel_volume(), 3.0);
    }

    #[test]
    fn beyond_the_outermost_centres_there_is_no_value() {
        let image = image(upright()).unwrap();
        let (low, high) = image.bounds();
        assert_eq!((low, high), (Vector::new(1.0, -2.0, 3.0), Vector::new(1.5, 2.0, 12.0)));
        for axis in 0..3 {
            for (corner, sign) in [(low, -1.0), (high, 1.0)] {
                assert!(image.at(&corner).is_some());
                let mut outside = corner;
                outside[axis] += sign * 1e-4;
                assert!(image.at(&outside).is_none(), "axis {axis}");
            }
        }
        assert!(image.at(&Vector::repeat(f64::NAN)).is_none());
    }

    #[test]
    fn axes_in_a_plane_are_no_image() {
        let flat = [Vector::x(), Vector::y(), Vector::x() + Vector::y()];
        assert_eq!(image(flat).unwrap_err(), ImageError::Flat);
        let short = [Vector::x(), Vector::y(), Vector::zeros()];
        assert!(matches!(image(short).unwrap_err(), ImageError::Spacing { axis: 2, .. }));
        let endless = [Vector::x(), Vector::y() * f64::INFINITY, Vector::z()];
        assert!(matches!(image(endless).unwrap_err(), ImageError::Spacing { axis: 1, .. }));
    }

    #[test]
    fn turning_the_frame_moves_the_place_and_not_the_value() {
        let image =
            image([Vector::new(0.4, 0.3, 0.0), Vector::y() * -2.0, Vector::z() * 3.0]).unwrap();
        let point = image.centre([0, 1, 2]) * 0.3 + image.centre([1, 2, 3]) * 0.7;
        let turned = image.turned(Frame::Lps, Frame::Ras);
        let there = Vector::new(-point.x, -point.y, point.z);
        let (here, there) = (image.at(&point).unwrap(), turned.at(&there).unwrap());
        // Two inverses of mirrored matrices, rounded apart.
        assert!((here - there).abs() < 1e-12);
        assert_eq!(image.turned(Frame::Unspecified, Frame::Ras).placement(), image.placement());
    }
}
