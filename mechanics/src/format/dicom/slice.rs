//! One file of a series: a slice with its place, or nothing that is one.

use super::attributes::{self as tag, Attributes, StoredPixels};
use super::bad;
use super::identity::Identity;
use super::padding::{Padding, air};
use super::pixel_layout::PixelLayout;
use super::pixels::decode;
use crate::format::error::FormatError;
use crate::format::limits::ReadLimits;
use crate::format::voxels::{Rescale, VoxelBuilder};
use crate::image::Voxels;
use crate::mesh::Vector;

/// Directions that differ from length 1, or from right angles, by more are none.
const CROOKED: f64 = 1e-3;

/// Kind of a file of a series.
pub(in crate::format) enum Part {
    Slice(Box<Slice>),
    /// A scout view, by which the scan was planned.
    Localiser,
    /// A report, a directory, whatever has no pixels.
    NoImage,
}

/// How the pixels of a slice lie, in LPS and mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// Along a row, and along a column.
    pub directions: [Vector; 2],
    /// From one pixel to the next along a row, and along a column.
    pub spacing: [f64; 2],
    /// Pixels along a row, and along a column.
    pub size: [usize; 2],
}

pub(in crate::format) struct Slice {
    /// Its number in an archive, from 1.
    pub(super) file: usize,
    pub(super) series: String,
    pub(super) identity: Identity,
    pub(super) modality: String,
    pub(super) plane: Plane,
    /// The centre of the first pixel.
    pub(super) position: Vector,
    pub(super) rescale: Rescale,
    /// Rescaled.
    pub(super) voxels: Voxels,
    /// Pixels of padding that count as air in place of their number.
    pub(super) padded: usize,
}

impl Plane {
    pub fn normal(&self) -> Vector {
        self.directions[0].cross(&self.directions[1])
    }

    fn read(attributes: &Attributes<'_>) -> Result<Plane, FormatError> {
        let [rows, columns] = [attributes.count(tag::ROWS)?, attributes.count(tag::COLUMNS)?];
        let [a, b, c, d, e, f] = attributes.needed::<6>(tag::ORIENTATION)?;
        let directions = [Vector::new(a, b, c), Vector::new(d, e, f)];
        let is_long = directions.iter().all(|v| (v.norm() - 1.0).abs() < CROOKED);
        if !is_long || directions[0].dot(&directions[1]).abs() > CROOKED {
            let detail =
                "the directions of Image Orientation (Patient) have not length 1 and a right angle";
            return Err(bad(0, detail));
        }
        let [between_rows, between_columns] = attributes.needed::<2>(tag::PIXEL_SPACING)?;
        if between_rows <= 0.0 || between_columns <= 0.0 {
            let detail = format!("Pixel Spacing is {between_rows} and {between_columns} mm");
            return Err(bad(0, detail));
        }
        Ok(Plane {
            directions,
            spacing: [between_columns, between_rows],
            size: [usize::from(columns), usize::from(rows)],
        })
    }
}

/// Reads one file with all its pixels; `file` is its number in an archive, from 1.
pub(in crate::format) fn read_part(
    bytes: &[u8],
    file: usize,
    limits: &ReadLimits,
) -> Result<Part, FormatError> {
    let attributes = Attributes::read(bytes)?;
    let Some(pixels) = &attributes.pixels else { return Ok(Part::NoImage) };
    if attributes.has_word(tag::IMAGE_TYPE, "LOCALIZER") {
        return Ok(Part::Localiser);
    }
    check_kind(&attributes)?;
    let plane = Plane::read(&attributes)?;
    let count = plane.size[0] as u64 * plane.size[1] as u64;
    limits.check_voxels(count)?;
    let position = Vector::from(attributes.needed::<3>(tag::POSITION)?);
    let rescale = rescale(&attributes)?;
    let (voxels, padded) = voxels(&attributes, pixels, plane.size, rescale)?;
    let word = |tag| attributes.word(tag).unwrap_or_default();
    let (series, modality) = (word(tag::SERIES), word(tag::MODALITY));
    let identity = Identity::read(&attributes);
    Ok(Part::Slice(Box::new(Slice {
        file,
        series,
        identity,
        modality,
        plane,
        position,
        rescale,
        voxels,
        padded,
    })))
}

fn check_kind(attributes: &Attributes<'_>) -> Result<(), FormatError> {
    let frames = attributes.word(tag::FRAMES).unwrap_or_else(|| "1".to_owned());
    if frames != "1" {
        let shown: String = frames.chars().filter(char::is_ascii_digit).take(10).collect();
        let detail = format!(
            "one file holds {shown} frames (enhanced multi-frame), which is not read: export single slices"
        );
        return Err(bad(0, detail));
    }
    let samples = attributes.count(tag::SAMPLES)?;
    if samples != 1 {
        return Err(bad(0, format!("a pixel has {samples} samples: colours are not read")));
    }
    match attributes.word(tag::PHOTOMETRIC) {
        Some(word) if word == "MONOCHROME2" => Ok(()),
        _ => Err(bad(
            0,
            "Photometric Interpretation MONOCHROME2 is read here, this file has another",
        )),
    }
}

fn rescale(attributes: &Attributes<'_>) -> Result<Rescale, FormatError> {
    let number = |found: Option<[f64; 1]>, without: f64| found.map_or(without, |[number]| number);
    let rescale = Rescale {
        slope: number(attributes.reals(tag::SLOPE)?, 1.0),
        intercept: number(attributes.reals(tag::INTERCEPT)?, 0.0),
    };
    match rescale.slope == 0.0 {
        true => Err(bad(0, "Rescale Slope is 0: every pixel would have the same value")),
        false => Ok(rescale),
    }
}

/// The values of a slice, and how many of them are air in place of padding.
fn voxels(
    attributes: &Attributes<'_>,
    pixels: &StoredPixels<'_>,
    size: [usize; 2],
    rescale: Rescale,
) -> Result<(Voxels, usize), FormatError> {
    let layout = PixelLayout {
        size,
        bits_allocated: attributes.count(tag::BITS_ALLOCATED)?,
        bits_stored: attributes.count(tag::BITS_STORED)?,
        high_bit: attributes.count(tag::HIGH_BIT)?,
        is_signed: attributes.count(tag::REPRESENTATION)? == 1,
        at: attributes.pixels_at,
    };
    layout.check()?;
    let stored = decode(pixels, &layout, attributes.syntax)?;
    let mut builder = VoxelBuilder::integers(stored.len())?;
    let Some(padding) = Padding::read(attributes, layout.is_signed)? else {
        for pixel in stored {
            builder.push_integer(layout.number(pixel), rescale)?;
        }
        return Ok((builder.finish(), 0));
    };
    let numbers: Vec<i64> = stored.into_iter().map(|pixel| layout.number(pixel)).collect();
    let is_padding = padding.of(&numbers, size);
    let value = |number: i64| rescale.of(number as f64);
    let measured = numbers.iter().zip(&is_padding).filter(|(_, padded)| !**padded);
    let is_ct = attributes.word(tag::MODALITY).is_none_or(|modality| modality == "CT");
    let air = air(measured.map(|(&number, _)| value(number)), is_ct);
    let mut replaced = 0;
    for (&number, padded) in numbers.iter().zip(is_padding) {
        if padded && value(number) > air {
            builder.push_integer(air as i64, Rescale::NONE)?;
            replaced += 1;
        } else {
            builder.push_integer(number, rescale)?;
        }
    }
    Ok((builder.finish(), replaced))
}
