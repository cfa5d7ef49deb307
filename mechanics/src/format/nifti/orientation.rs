//! Position and orientation of a NIfTI image in RAS: by its rows (sform) or by its quaternion (qform).

use nalgebra::Matrix3;

use super::refusal::bad;
use crate::format::error::FormatError;
use crate::image::Placement;
use crate::mesh::{Vector, Warning};

const IMAGE_PLACE_DOUBTFUL: &str = "image-place-doubtful";

/// What the header says about the place, in its own unit.
pub(super) struct Forms {
    /// The byte at which it says which of both is meant.
    pub codes_at: u64,
    pub by_quaternion: bool,
    pub by_rows: bool,
    /// The sign of the third axis, and the spacings.
    pub pixdim: [f64; 4],
    /// b, c, d of the quaternion.
    pub quaternion: [f64; 3],
    pub offset: [f64; 3],
    pub rows: [[f64; 4]; 3],
    pub unit: i64,
    pub size: [usize; 3],
}

pub(super) struct Orientation {
    pub placement: Placement,
    pub warning: Option<Warning>,
}

impl Forms {
    /// The rows where they are meant, else the quaternion; without either nothing tells left from right.
    pub fn place(&self) -> Result<Orientation, FormatError> {
        let unit = self.unit_in_mm()?;
        let rows = self.by_rows.then(|| self.of_rows(unit));
        let quaternion = match self.by_quaternion {
            true => self.of_quaternion(unit).map(Some),
            false => Ok(None),
        };
        let (placement, warning) = match (rows, quaternion) {
            (Some(rows), Ok(Some(quaternion))) => (rows, self.difference(&rows, &quaternion)),
            (Some(rows), _) => (rows, None),
            (None, quaternion) => {
                (quaternion?.ok_or_else(|| self.nowhere())?, self.negative_spacing())
            }
        };
        placement.check().map_err(|error| bad(self.codes_at, error.to_string()))?;
        Ok(Orientation { placement, warning })
    }

    fn nowhere(&self) -> FormatError {
        let detail =
            "qform_code and sform_code are both 0: the file does not say which way its axes point";
        bad(self.codes_at, detail)
    }

    fn unit_in_mm(&self) -> Result<f64, FormatError> {
        match self.unit {
            0 | 2 => Ok(1.0),
            1 => Ok(1000.0),
            3 => Ok(0.001),
            other => Err(bad(self.codes_at, format!("unit {other} is no length that is known"))),
        }
    }

    fn of_rows(&self, unit: f64) -> Placement {
        let column = |n: usize| Vector::from(self.rows.map(|row| row[n])) * unit;
        Placement { origin: column(3), steps: [column(0), column(1), column(2)] }
    }

    /// nifti1.h has spacings above zero; the sign of an axis is in the quaternion and in pixdim[0] alone.
    fn negative_spacing(&self) -> Option<Warning> {
        let axis = (1..4).find(|&axis| self.pixdim[axis] < 0.0)?;
        let spacing = self.pixdim[axis];
        let detail = format!(
            "pixdim[{axis}] is {spacing}, and the format has spacings above 0: its absolute value is taken, as nifti1_io does, and \
             the directions are those of qform; a program that means a mirrored axis by it writes left for right"
        );
        Some(Warning::new(IMAGE_PLACE_DOUBTFUL, detail).with("spacing", spacing))
    }

    /// nifti1.h, method 2: a rotation by a quaternion whose first component is what is left of its length.
    fn of_quaternion(&self, unit: f64) -> Result<Placement, FormatError> {
        let [mut b, mut c, mut d] = self.quaternion;
        let squared = b * b + c * c + d * d;
        if squared.is_nan() || squared > 1.001 {
            let detail = format!(
                "the quaternion (b, c, d) has the squared length {squared}, at most 1 is possible"
            );
            return Err(bad(self.codes_at, detail));
        }
        let mut a = (1.0 - squared).max(0.0).sqrt();
        if squared > 1.0 - 1e-7 {
            let length = squared.sqrt();
            (a, b, c, d) = (0.0, b / length, c / length, d / length);
        }
        let rotation = Matrix3::new(
            a * a + b * b - c * c - d * d,
            2.0 * (b * c - a * d),
            2.0 * (b * d + a * c),
            2.0 * (b * c + a * d),
            a * a + c * c - b * b - d * d,
            2.0 * (c * d - a * b),
            2.0 * (b * d - a * c),
            2.0 * (c * d + a * b),
            a * a + d * d - b * b - c * c,
        );
        let sign = if self.pixdim[0] < 0.0 { -1.0 } else { 1.0 };
        let [_, x, y, z] = self.pixdim.map(f64::abs);
        let lengths = [x, y, sign * z];
        let step = |axis: usize| rotation.column(axis) * lengths[axis] * unit;
        Ok(Placement {
            origin: Vector::from(self.offset) * unit,
            steps: [step(0), step(1), step(2)],
        })
    }

    /// A warning where both are meant and a corner of the image differs by more than half a voxel.
    fn difference(&self, rows: &Placement, quaternion: &Placement) -> Option<Warning> {
        let ends = self.size.map(|size| (size - 1) as f64);
        let between = |corner: usize| {
            let apart = (0..3).filter(|axis| corner >> axis & 1 == 1);
            let apart = apart.map(|axis| (rows.steps[axis] - quaternion.steps[axis]) * ends[axis]);
            apart.fold(rows.origin - quaternion.origin, |sum, step| sum + step).norm()
        };
        let largest = (0..8).map(between).fold(0.0, f64::max);
        let voxel = rows.steps.iter().map(|step| step.norm()).fold(f64::INFINITY, f64::min);
        let detail = format!(
            "sform and qform place the image up to {largest:.1} mm apart; sform is taken, as most programs do"
        );
        (largest > 0.5 * voxel)
            .then(|| Warning::new(IMAGE_PLACE_DOUBTFUL, detail).with("largest_mm", largest))
    }
}
