//! The files of a series as one image: which slices belong together, and whether they fit.

use std::collections::BTreeMap;

use super::identity::check_identity;
use super::slice::{Part, Plane, Slice};
use super::stack::{Layer, Stack};
use super::{FORMAT, bad};
use crate::format::arrays::SurfaceArrays;
use crate::format::error::FormatError;
use crate::format::limits::ReadLimits;
use crate::format::voxels::{Rescale, VoxelBuilder};
use crate::format::{Mesh, MeshFormat, ReadMesh};
use crate::image::{ImageVolume, Placement, Voxels};
use crate::mesh::{Frame, IgnoredArrays, Warning};

/// A series of no more slices beside the one that is meant is taken for a scout view.
const SCOUT: usize = 3;
/// Directions of slices of one stack differ by no more.
const TURNED: f64 = 1e-3;
/// Spacings of pixels of slices of one stack differ by no more, as a part of them.
const UNEVEN: f64 = 1e-3;

const NO_HOUNSFIELD: &str = "no-hounsfield";

/// Slices in the order of the archive, and what was said about those that are left out.
struct Sorted {
    slices: Vec<Slice>,
    warnings: Vec<Warning>,
}

/// One image of all slices of a series.
pub(in crate::format) fn assemble(
    parts: Vec<Part>,
    limits: &ReadLimits,
) -> Result<ReadMesh, FormatError> {
    let Sorted { slices, mut warnings } = select_series(parts)?;
    check_identity(slices.iter().map(|slice| (slice.file, &slice.identity)))?;
    let plane = check_alike(&slices)?;
    let [columns, rows] = plane.size;
    limits.check_voxels((columns * rows) as u64 * slices.len() as u64)?;
    if slices[0].modality.is_empty() || slices[0].modality == "CT" {
        warnings.extend(rescaled_otherwise(&slices));
    } else {
        let detail = "the modality of the series is not CT: its values may be no Hounsfield units";
        warnings.push(Warning::new(NO_HOUNSFIELD, detail));
    }
    warnings.extend(padding_replaced(&slices));
    let stack = Stack::of(&slices, &plane)?;
    let [right, down] = [0, 1].map(|axis| plane.directions[axis] * plane.spacing[axis]);
    let placement = Placement { origin: stack.origin, steps: [right, down, stack.step] };
    let size = [columns, rows, stack.layers.len()];
    warnings.extend(stack.warnings);
    let voxels = voxels(&slices, &stack.layers)?;
    let image =
        ImageVolume::new(size, placement, voxels).map_err(|error| bad(0, error.to_string()))?;
    Ok(ReadMesh {
        format: MeshFormat::Dicom,
        mesh: Mesh::Image(image),
        frame: Some(Frame::Lps),
        ignored: IgnoredArrays::default(),
        of_points: SurfaceArrays::default(),
        warnings,
    })
}

/// The slices of the one series that is meant.
fn select_series(parts: Vec<Part>) -> Result<Sorted, FormatError> {
    let files = parts.len();
    let mut left_out = 0;
    let mut by_series: BTreeMap<String, Vec<Slice>> = BTreeMap::new();
    for part in parts {
        match part {
            Part::Slice(slice) => by_series.entry(slice.series.clone()).or_default().push(*slice),
            Part::Localiser | Part::NoImage => left_out += 1,
        }
    }
    // Identifiers of series are not told: they lead to the patient.
    let mut series: Vec<Vec<Slice>> = by_series.into_values().collect();
    series.sort_by_key(|slices| std::cmp::Reverse(slices.len()));
    let mut series = series.into_iter();
    let nothing = || bad(0, format!("none of {files} {FORMAT} files is a slice of an image"));
    let slices = series.next().ok_or_else(nothing)?;
    let others: Vec<usize> = series.map(|slices| slices.len()).collect();
    if others.iter().any(|&others| others > SCOUT || others >= slices.len()) {
        let counts: Vec<String> = others.iter().take(10).map(usize::to_string).collect();
        let detail = format!(
            "{} series in one upload, of {} and {} slices: send one of them",
            others.len() + 1,
            slices.len(),
            counts.join(", ")
        );
        return Err(bad(0, detail));
    }
    left_out += others.iter().sum::<usize>();
    let detail =
        format!("{left_out} {FORMAT} files are scout views or no slices, and are left out");
    let warning = || Warning::new("files-passed-over", detail).with("files", left_out as f64);
    Ok(Sorted { slices, warnings: (left_out > 0).then(warning).into_iter().collect() })
}

/// That slices of a CT are rescaled otherwise than most: scanners write one slope and one intercept.
fn rescaled_otherwise(slices: &[Slice]) -> Option<Warning> {
    let mut counts: Vec<(Rescale, usize)> = Vec::new();
    for slice in slices {
        match counts.iter_mut().find(|(rescale, _)| *rescale == slice.rescale) {
            Some((_, count)) => *count += 1,
            None => counts.push((slice.rescale, 1)),
        }
    }
    // Of as many the one that comes first.
    let (usual, _) = counts.iter().rev().max_by_key(|(_, count)| *count)?;
    let others = || slices.iter().filter(|slice| slice.rescale != *usual);
    let Slice { file, rescale: own, .. } = others().min_by_key(|slice| slice.file)?;
    let count = others().count();
    let detail = format!(
        "{count} of {} slices have another Rescale Slope or Intercept than the others, the first in file {file} of the archive: {} and {}, \
         else {} and {}; a CT has one, and where its pixels are stored as those of the others these slices are no Hounsfield units",
        slices.len(),
        own.slope,
        own.intercept,
        usual.slope,
        usual.intercept
    );
    let warning = Warning::new(NO_HOUNSFIELD, detail).with("slices", count as f64);
    let warning = warning.with("file", *file as f64).with("slope", own.slope);
    Some(warning.with("intercept", own.intercept))
}

/// That padding counts as air; nothing where its number says so itself.
fn padding_replaced(slices: &[Slice]) -> Option<Warning> {
    let of = slices.iter().filter(|slice| slice.padded > 0).count();
    let pixels: usize = slices.iter().map(|slice| slice.padded).sum();
    let detail = format!(
        "{pixels} pixels at the border of {of} of {} slices are declared as padding (Pixel Padding Value) and have values above air: \
         they are taken as air, no measurement of the scanner is changed",
        slices.len()
    );
    let warning = || Warning::new("padding-replaced", detail).with("pixels", pixels as f64);
    (pixels > 0).then(|| warning().with("slices", of as f64))
}

/// The plane of all slices, which differ in their place only.
fn check_alike(slices: &[Slice]) -> Result<Plane, FormatError> {
    let first = slices[0].plane;
    for slice in slices {
        let Plane { directions, spacing, size } = slice.plane;
        if size != first.size {
            let detail = format!(
                "slices of {} x {} and of {} x {} pixels are no one image",
                first.size[0], first.size[1], size[0], size[1]
            );
            return Err(bad(0, detail));
        }
        let uneven = (0..2).find(|&axis| {
            (spacing[axis] - first.spacing[axis]).abs() > UNEVEN * first.spacing[axis]
        });
        if let Some(axis) = uneven {
            let (one, other) = (first.spacing[axis], spacing[axis]);
            return Err(bad(
                0,
                format!("the pixels of one slice are {one} mm apart, of another {other} mm"),
            ));
        }
        if (0..2).any(|axis| (directions[axis] - first.directions[axis]).norm() > TURNED) {
            return Err(bad(0, "the slices are not parallel: Image Orientation (Patient) differs"));
        }
    }
    Ok(first)
}

fn voxels(slices: &[Slice], layers: &[Layer]) -> Result<Voxels, FormatError> {
    let of_one = slices[0].voxels.len();
    let mut builder = VoxelBuilder::integers(of_one * layers.len())?;
    for layer in layers {
        match *layer {
            Layer::Slice(slice) => push(&mut builder, &slices[slice].voxels)?,
            Layer::Between(below, above) => {
                push(&mut builder, &mean(&slices[below].voxels, &slices[above].voxels))?;
            }
        }
    }
    Ok(builder.finish())
}

fn push(builder: &mut VoxelBuilder, voxels: &Voxels) -> Result<(), FormatError> {
    match voxels {
        Voxels::I16(values) => {
            values.iter().try_for_each(|&v| builder.push_integer(i64::from(v), Rescale::NONE))
        }
        Voxels::F32(values) => values.iter().try_for_each(|&v| builder.push_single(v)),
    }
}

/// The slice between two others; of integers, rounded to one.
fn mean(below: &Voxels, above: &Voxels) -> Voxels {
    let value = |voxels: &Voxels, at: usize| match voxels {
        Voxels::I16(values) => f32::from(values[at]),
        Voxels::F32(values) => values[at],
    };
    let means = (0..below.len()).map(|at| 0.5 * (value(below, at) + value(above, at)));
    match (below, above) {
        (Voxels::I16(_), Voxels::I16(_)) => {
            Voxels::I16(means.map(|mean| mean.round() as i16).collect())
        }
        (Voxels::F32(_), _) | (_, Voxels::F32(_)) => Voxels::F32(means.collect()),
    }
}
