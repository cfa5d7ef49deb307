//! Images of every format: the same place and values from each, and an answer to whatever is damaged.

use mechanics::format::{FormatError, Mesh, ReadLimits, ReadMesh, read};
use mechanics::image::{ImageVolume, Voxels};
use mechanics::mesh::Frame;

use crate::samples::scans::{Coding, Scan, dicom_slices, one_of_each, series, small_scan};
use crate::samples::{error_of, read_default, warning_codes};

pub fn image(read: ReadMesh) -> ImageVolume {
    match read.mesh {
        Mesh::Image(image) => image,
        _ => panic!("an image was expected"),
    }
}

/// How far the corners of an image are from where they belong, in mm.
pub fn misplaced(read: ReadMesh, scan: &Scan) -> f64 {
    let frame = read.frame.unwrap();
    let image = image(read).turned(frame, Frame::Lps);
    let corners = (0..8).map(|n| [n & 1, n >> 1 & 1, n >> 2 & 1]);
    let off = corners.map(|corner| {
        let index = [0, 1, 2].map(|axis| corner[axis] * (scan.size[axis] - 1));
        let steps = scan.placement.steps.iter().zip(index);
        let wanted = steps.fold(scan.placement.origin, |sum, (step, n)| sum + step * n as f64);
        (image.centre(index) - wanted).norm()
    });
    off.fold(0.0, f64::max)
}

#[test]
fn every_format_gives_the_same_place_and_the_same_values() {
    let scan = small_scan();
    for (name, bytes) in one_of_each() {
        let read = read_default(&bytes);
        assert_eq!(warning_codes(&read), [""; 0], "{name}");
        let image = image(read.clone());
        let slices = image.size()[2];
        assert_eq!(image.size(), [3, 2, if name.starts_with("dicom") { slices } else { 4 }]);
        assert_eq!(*image.voxels(), Voxels::I16(scan.values[..6 * slices].to_vec()), "{name}");
        let part = Scan { size: image.size(), ..scan.clone() };
        // NIfTI-1 has single precision.
        let off = misplaced(read, &part);
        assert!(off < if name.starts_with("nifti") { 1e-5 } else { 1e-12 }, "{name}: {off}");
    }
}

#[test]
fn an_image_that_is_cut_anywhere_is_refused() {
    for (name, bytes) in one_of_each() {
        for length in 0..bytes.len() {
            let refused = read(&bytes[..length], &ReadLimits::default());
            assert!(refused.is_err(), "{name}: {length} of {}", bytes.len());
        }
    }
}

/// A generator of Marsaglia (2003), so that every run is the same.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }
}

#[test]
fn an_image_with_wrong_bits_is_answered_without_more_memory_than_allowed() {
    let limits = ReadLimits { voxels: 1000, image_floor_bytes: 1 << 16, ..ReadLimits::default() };
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for (name, bytes) in one_of_each() {
        for _ in 0..2000 {
            let mut changed = bytes.clone();
            for _ in 0..=random.below(4) {
                changed[random.below(bytes.len())] ^= 1 << random.below(8);
            }
            match read(&changed, &limits) {
                Ok(read) => assert!(image(read).voxels().len() <= 1000, "{name}"),
                Err(FormatError::Memory { values }) => panic!("{name} asked for {values} values"),
                Err(error) => assert!(!error.to_string().contains("Roe"), "{name}: {error}"),
            }
        }
    }
}

#[test]
fn every_image_is_refused_beyond_the_limit_of_voxels() {
    let limits = ReadLimits { voxels: 11, ..ReadLimits::default() };
    for (name, bytes) in one_of_each() {
        let error = read(&bytes, &limits).unwrap_err().to_string();
        assert!(error.ends_with(" voxels, and 11 is the limit"), "{name}: {error}");
    }
}

#[test]
fn no_image_and_no_refusal_tells_the_name_of_a_patient() {
    let scan = small_scan();
    let mut slices = dicom_slices(&scan, Coding::Explicit);
    slices[1].series = "1.2.840.Roe".into();
    slices[2].series = "1.2.840.Roe".into();
    let error = error_of(&series(&slices));
    assert!(error.contains("2 series in one upload, of 2 and 2 slices"), "{error}");
    assert!(!error.contains("Roe") && !error.contains("1.2.8"), "{error}");
    for (name, bytes) in one_of_each() {
        let said = format!("{:?}", read_default(&bytes));
        assert!(!said.contains("Roe") && !said.contains("Jane"), "{name}");
    }
}
