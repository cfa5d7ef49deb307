//! Slices in their order along the normal: evenly spaced, with at most one that is missing.

use super::bad;
use super::slice::{Plane, Slice};
use crate::format::error::FormatError;
use crate::mesh::{Vector, Warning};

/// Slices closer than this part of their spacing stand at one place.
const SAME_PLACE: f64 = 0.01;
/// A slice stands off its even place by no more than this part of the spacing.
const OFF_PLACE: f64 = 0.1;
/// Slices are displaced against each other, beyond an even shear, by no more, in mm.
const OFF_LINE_MM: f64 = 0.1;
/// A smaller angle between the normal and the way from slice to slice is none, in degrees.
const UPRIGHT_DEG: f64 = 0.1;

/// What one layer of voxels is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layer {
    Slice(usize),
    /// The mean of both, where the slice between them is missing.
    Between(usize, usize),
}

pub(super) struct Stack {
    pub layers: Vec<Layer>,
    pub origin: Vector,
    /// From one layer to the next.
    pub step: Vector,
    pub warnings: Vec<Warning>,
}

/// A slice and how high it stands along the normal, in mm.
#[derive(Clone, Copy)]
struct PositionedSlice {
    slice: usize,
    height: f64,
}

impl Stack {
    pub fn of(slices: &[Slice], plane: &Plane) -> Result<Stack, FormatError> {
        let normal = plane.normal();
        let height = |slice: usize| slices[slice].position.dot(&normal);
        let mut placed: Vec<PositionedSlice> = (0..slices.len())
            .map(|slice| PositionedSlice { slice, height: height(slice) })
            .collect();
        placed.sort_by(|a, b| a.height.total_cmp(&b.height));
        let mut warnings = Vec::new();
        let spacing = spacing(&placed)?;
        warnings.extend(drop_doubled(&mut placed, slices, spacing)?);
        let layers = layers(&placed, spacing, &mut warnings)?;
        let [first, last] = [placed[0], placed[placed.len() - 1]];
        let way = slices[last.slice].position - slices[first.slice].position;
        let (origin, step) = (slices[first.slice].position, way / (layers.len() - 1) as f64);
        let stack = Stack { layers, origin, step, warnings: Vec::new() };
        stack.check_places(slices, &normal)?;
        warnings.extend(tilt(&step, &normal));
        Ok(Stack { warnings, ..stack })
    }

    /// Every slice stands where an even stack has it.
    fn check_places(&self, slices: &[Slice], normal: &Vector) -> Result<(), FormatError> {
        let spacing = self.step.dot(normal);
        let mut farthest = (0, 0.0);
        for (number, layer) in self.layers.iter().enumerate() {
            let Layer::Slice(slice) = *layer else { continue };
            let off = slices[slice].position - (self.origin + self.step * number as f64);
            let along = off.dot(normal);
            if along.abs() > OFF_PLACE * spacing {
                let detail = format!(
                    "the slices are not evenly spaced: layer {number} stands {along:.3} mm off an even spacing \
                     of {spacing:.3} mm"
                );
                return Err(bad(0, detail));
            }
            let aside = (off - normal * along).norm();
            if aside > farthest.1 {
                farthest = (number, aside);
            }
        }
        let (number, aside) = farthest;
        if aside > OFF_LINE_MM {
            let detail = format!(
                "the slices do not stand in a row: farthest, layer {number} is displaced by {aside:.2} mm within its plane"
            );
            return Err(bad(0, detail));
        }
        Ok(())
    }
}

/// The middle of all distances that are any.
fn spacing(placed: &[PositionedSlice]) -> Result<f64, FormatError> {
    let apart = placed.windows(2).map(|pair| pair[1].height - pair[0].height);
    let largest = apart.clone().fold(0.0, f64::max);
    let mut apart: Vec<f64> = apart.filter(|&apart| apart > SAME_PLACE * largest).collect();
    apart.sort_by(f64::total_cmp);
    let none = || {
        let slices = placed.len();
        let detail = format!(
            "{slices} slices at one place are no image in space: send all slices of the series in one zip archive"
        );
        bad(0, detail)
    };
    apart.get(apart.len() / 2).copied().ok_or_else(none)
}

/// Of slices at one place all but one go where they are the same, or nobody knows which is meant.
fn drop_doubled(
    placed: &mut Vec<PositionedSlice>,
    slices: &[Slice],
    spacing: f64,
) -> Result<Option<Warning>, FormatError> {
    let mut kept: Vec<PositionedSlice> = Vec::with_capacity(placed.len());
    let mut doubled = 0;
    for next in placed.iter() {
        match kept.last() {
            Some(last) if next.height - last.height < SAME_PLACE * spacing => {
                if slices[last.slice].voxels != slices[next.slice].voxels {
                    let height = next.height;
                    let detail = format!(
                        "two slices that differ stand at one place, {height:.2} mm along the normal"
                    );
                    return Err(bad(0, detail));
                }
                doubled += 1;
            }
            _ => kept.push(*next),
        }
    }
    *placed = kept;
    let detail =
        format!("{doubled} slices are there twice with the same pixels, and are taken once");
    let warning = || Warning::new("slices-doubled", detail).with("slices", f64::from(doubled));
    Ok((doubled > 0).then(warning))
}

/// The layers of an even stack, one of which may be made up.
fn layers(
    placed: &[PositionedSlice],
    spacing: f64,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Layer>, FormatError> {
    let mut layers = vec![Layer::Slice(placed[0].slice)];
    let (mut missing, mut first) = (0.0, None);
    for pair in placed.windows(2) {
        let steps = (pair[1].height - pair[0].height) / spacing;
        if (steps - steps.round()).abs() > OFF_PLACE || steps < 0.5 {
            let detail = format!(
                "the slices are not evenly spaced: {:.3} mm apart at {:.2} mm along the normal, else {spacing:.3} mm",
                pair[1].height - pair[0].height,
                pair[0].height
            );
            return Err(bad(0, detail));
        }
        if steps.round() > 1.0 {
            missing += steps.round() - 1.0;
            first.get_or_insert(pair[0].height + spacing);
            layers.push(Layer::Between(pair[0].slice, pair[1].slice));
        }
        layers.push(Layer::Slice(pair[1].slice));
    }
    let Some(height) = first else { return Ok(layers) };
    if missing > 1.0 {
        let detail = format!(
            "{missing} slices are missing, the first at {height:.2} mm along the normal; one is made up, more are not"
        );
        return Err(bad(0, detail));
    }
    let detail = format!(
        "a slice is missing at {height:.2} mm along the normal; the mean of its neighbours stands for it"
    );
    warnings.push(Warning::new("slice-missing", detail).with("height_mm", height));
    Ok(layers)
}

/// A gantry that was tilted shears the stack. The image keeps the shear, which is exact.
fn tilt(step: &Vector, normal: &Vector) -> Option<Warning> {
    let degrees = step.angle(normal).to_degrees();
    let detail = format!(
        "the gantry was tilted by {degrees:.1} degrees; the image keeps its sheared axes, so that every voxel \
         stands where it was scanned"
    );
    (degrees > UPRIGHT_DEG).then(|| Warning::new("gantry-tilt", detail).with("degrees", degrees))
}
