//! DICOM: the slices of a series as one image, whatever their encoding and order, and series that are no image.

use mechanics::format::ReadMesh;
use mechanics::image::Voxels;
use mechanics::mesh::{Frame, Vector};

use super::scans::{image, misplaced};
use crate::samples::scans::{Coding, DicomSlice, Scan, dicom_slices, series, small_scan};
use crate::samples::{error_of, read_default, warning_codes};

/// Eight slices of 5 x 4 pixels, all different.
fn scan() -> Scan {
    let values = (0..160_i32).map(|n| (n * n * 37 % 3000 - 1000) as i16).collect();
    Scan { size: [5, 4, 8], values, ..small_scan() }
}

fn slices() -> Vec<DicomSlice> {
    dicom_slices(&scan(), Coding::Explicit)
}

fn read(slices: &[DicomSlice]) -> ReadMesh {
    read_default(&series(slices))
}

fn refused(change: impl Fn(&mut Vec<DicomSlice>)) -> String {
    let mut slices = slices();
    change(&mut slices);
    error_of(&series(&slices))
}

#[test]
fn every_encoding_gives_the_same_image() {
    let mut codings = vec![Coding::Implicit, Coding::Explicit, Coding::BigEndian, Coding::Rle];
    for predictor in 1..=7 {
        codings.extend([0, 1, 3].map(|rows| Coding::JpegLossless(predictor, rows)));
    }
    for coding in codings {
        let read = read(&dicom_slices(&scan(), coding));
        assert_eq!((read.frame, warning_codes(&read)), (Some(Frame::Lps), vec![]));
        assert_eq!(*image(read.clone()).voxels(), Voxels::I16(scan().values), "{coding:?}");
        assert!(misplaced(read, &scan()) < 1e-12);
    }
}

#[test]
fn all_values_of_16_bits_come_through_jpeg_lossless_and_rle() {
    let wild = |n: i32| (n.wrapping_mul(40_503) ^ n << 7) as u16;
    let stored: Vec<u16> =
        (0..4096).map(wild).chain([0, 0xFFFF, 0x8000, 0, 0x8000, 0xFFFF]).collect();
    for coding in [Coding::Rle, Coding::JpegLossless(1, 0), Coding::JpegLossless(6, 2)] {
        let slice = |z: f64| DicomSlice {
            coding,
            size: [2, stored.len() / 2],
            stored: stored.clone(),
            bits: 16,
            rescale: [1.0, -32768.0],
            position: [0.0, 0.0, z],
            ..slices()[0].clone()
        };
        let image = image(read(&[slice(0.0), slice(1.0)]));
        let wanted: Vec<i16> = stored.iter().map(|&v| (i32::from(v) - 32768) as i16).collect();
        assert_eq!(*image.voxels(), Voxels::I16([wanted.clone(), wanted].concat()), "{coding:?}");
    }
}

#[test]
fn slices_stand_in_the_order_of_their_places() {
    let mut shuffled = slices();
    shuffled.swap(0, 5);
    shuffled.swap(2, 7);
    shuffled.reverse();
    assert_eq!(image(read(&shuffled)), image(read(&slices())));
    // Coronal slices, whose normal is an axis of the patient too.
    let mut coronal = slices();
    for (k, slice) in coronal.iter_mut().enumerate() {
        slice.orientation = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0];
        slice.position = [3.0, 40.0 - 2.0 * k as f64, 7.0];
    }
    // The normal is x cross -z = y, so that the last slice comes first.
    let image = image(read(&coronal));
    assert_eq!(image.placement().origin, Vector::new(3.0, 26.0, 7.0));
    assert_eq!(image.placement().steps[2], Vector::y() * 2.0);
    assert_eq!(image.at(&Vector::new(3.0, 40.0, 7.0)), Some(-1000.0));
}

#[test]
fn a_tilted_gantry_is_reported_and_every_voxel_stands_where_it_was_scanned() {
    let mut scan = scan();
    // 15 degrees: slices go on along z while their normal leans back.
    scan.placement.steps[0] = Vector::x() * 1.5;
    scan.placement.steps[1] =
        Vector::new(0.0, 15_f64.to_radians().cos(), -15_f64.to_radians().sin()) * 2.0;
    let read = read(&dicom_slices(&scan, Coding::Explicit));
    assert_eq!(warning_codes(&read), ["gantry-tilt"]);
    let (name, degrees) = read.warnings[0].numbers[0];
    assert!(name == "degrees" && (degrees - 15.0).abs() < 1e-6, "{degrees}");
    assert!(misplaced(read, &scan) < 1e-9);
}

#[test]
fn one_missing_slice_is_made_of_its_neighbours_and_more_are_refused() {
    let mut one = slices();
    one.remove(3);
    let read = read(&one);
    assert_eq!(warning_codes(&read), ["slice-missing"]);
    let image = image(read);
    assert_eq!(image.size(), [5, 4, 8]);
    let value = |k: usize| image.at(&image.centre([2, 1, k])).unwrap();
    assert!((value(3) - (0.5 * (value(2) + value(4))).round()).abs() < 1e-9);
    let two = refused(|slices| {
        slices.remove(5);
        slices.remove(2);
    });
    assert!(two.contains("2 slices are missing, the first at 8.50 mm"), "{two}");
    let gap = refused(|slices| {
        slices.drain(2..5);
    });
    assert!(gap.contains("3 slices are missing"), "{gap}");
}

#[test]
fn a_slice_that_is_there_twice_is_taken_once_and_two_that_differ_are_refused() {
    let mut doubled = slices();
    doubled.extend([doubled[2].clone(), doubled[6].clone()]);
    let read = read(&doubled);
    assert_eq!(warning_codes(&read), ["slices-doubled"]);
    assert_eq!(read.warnings[0].numbers, [("slices", 2.0)]);
    assert_eq!(*image(read).voxels(), Voxels::I16(scan().values));
    let error = refused(|slices| {
        let mut other = slices[2].clone();
        other.stored[0] += 1;
        slices.push(other);
    });
    assert!(error.contains("two slices that differ stand at one place, 8.50 mm"), "{error}");
}

#[test]
fn two_series_are_refused_and_scout_views_left_out() {
    let error = refused(|slices| slices[4..].iter_mut().for_each(|s| s.series = "9".into()));
    assert!(
        error.contains("2 series in one upload, of 4 and 4 slices: send one of them"),
        "{error}"
    );
    let mut scouts = slices();
    scouts.extend(
        slices()[..2].iter().map(|slice| DicomSlice { series: "9".into(), ..slice.clone() }),
    );
    scouts.push(DicomSlice { kind: "ORIGINAL\\PRIMARY\\LOCALIZER", ..slices()[0].clone() });
    let read = read(&scouts);
    assert_eq!(warning_codes(&read), ["files-passed-over"]);
    assert_eq!(read.warnings[0].numbers, [("files", 3.0)]);
    assert_eq!(*image(read).voxels(), Voxels::I16(scan().values));
}

#[test]
fn slices_that_do_not_fit_are_refused_with_their_numbers() {
    let uneven = refused(|slices| slices[7].position[2] += 0.9);
    assert!(
        uneven.contains(
            "not evenly spaced: 3.400 mm apart at 18.50 mm along the normal, else 2.500 mm"
        ),
        "{uneven}"
    );
    let aside = refused(|slices| slices[3].position[0] += 1.0);
    assert!(aside.contains("layer 3 is displaced by 1.00 mm within its plane"), "{aside}");
    let two = refused(|slices| {
        slices[2].position[0] += 0.3;
        slices[4].position[0] += 1.0;
    });
    assert!(two.contains("layer 4 is displaced by 1.00 mm within its plane"), "{two}");
    let size = refused(|slices| slices[3].size = [4, 5]);
    assert!(size.contains("slices of 5 x 4 and of 4 x 5 pixels are no one image"), "{size}");
    let spacing = refused(|slices| slices[3].spacing = [2.0, 1.4]);
    assert!(spacing.contains("1.5 mm apart, of another 1.4 mm"), "{spacing}");
    let turned = refused(|slices| slices[3].orientation = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert!(turned.contains("the slices are not parallel"), "{turned}");
    let crooked = refused(|slices| slices[3].orientation = [1.0, 0.0, 0.0, 0.7, 0.7, 0.0]);
    assert!(crooked.contains("length 1 and a right angle"), "{crooked}");
    assert!(crooked.ends_with("(file 4 of the archive)"), "{crooked}");
    let frames = refused(|slices| slices[0].frames = Some(120));
    assert!(
        frames.contains("one file holds 120 frames (enhanced multi-frame), which is not read"),
        "{frames}"
    );
    let few = refused(|slices| slices[1].stored.truncate(19));
    assert!(few.contains("40 bytes of pixels declared, 38 are there"), "{few}");
}

#[test]
fn encodings_that_are_not_read_are_refused_by_their_names() {
    for (syntax, name) in [
        ("1.2.840.10008.1.2.4.90", "JPEG 2000 Lossless"),
        ("1.2.840.10008.1.2.4.80", "JPEG-LS Lossless"),
        ("1.2.840.10008.1.2.4.50", "JPEG Baseline"),
        ("1.2.840.10008.1.2.1.99", "Deflated Explicit VR Little Endian"),
        ("1.2.3", "of this file"),
    ] {
        let error = refused(|slices| slices[0].syntax = Some(syntax));
        assert!(
            error.contains(&format!("the transfer syntax {name} ({syntax}) is not read")),
            "{error}"
        );
    }
    let error = refused(|slices| slices[0].syntax = Some("1.2.840.10008.1.2.5"));
    assert!(error.contains("not encoded as the transfer syntax says"), "{error}");
}

#[test]
fn one_file_alone_is_no_image_in_space() {
    let error = error_of(&slices()[0].file());
    assert!(error.contains("send all slices of the series in one zip archive"), "{error}");
}

#[test]
fn the_bits_that_count_are_rescaled_slice_by_slice() {
    let mut signed = slices();
    for slice in &mut signed {
        slice.is_signed = true;
        slice.rescale = [0.5, 1.0];
        // Twelve bits in two's complement, and something else in the four above.
        slice.stored = [0xF7FF, 0x0800, 0x0FFF, 0x5000].repeat(5);
    }
    let wanted = [1024.5, -1023.0, 0.5, 1.0].repeat(5 * 8);
    assert_eq!(*image(read(&signed)).voxels(), Voxels::F32(wanted));
    let mut each = slices();
    each[1].rescale = [2.0, -1024.0];
    let image = image(read(&each));
    let stored = f64::from(each[1].stored[0]);
    assert_eq!(image.at(&image.centre([0, 0, 1])), Some(2.0 * stored - 1024.0));
}

#[test]
fn slices_of_a_ct_that_are_rescaled_otherwise_are_told_and_a_slope_of_zero_is_refused() {
    let mut one = slices();
    one[5].rescale = [1.0, 0.0];
    let found = read(&one);
    assert_eq!(warning_codes(&found), ["no-hounsfield"]);
    let wanted = [("slices", 1.0), ("file", 6.0), ("slope", 1.0), ("intercept", 0.0)];
    assert_eq!(found.warnings[0].numbers, wanted);
    assert!(found.warnings[0].detail.contains("else 1 and -1024"), "{:?}", found.warnings);
    // Slices of other modalities have slopes of their own.
    one.iter_mut().for_each(|slice| slice.modality = "PT");
    let found = read(&one);
    assert_eq!(warning_codes(&found), ["no-hounsfield"]);
    assert!(found.warnings[0].detail.contains("not CT"), "{:?}", found.warnings);
    let flat = refused(|slices| slices[2].rescale[0] = 0.0);
    assert!(flat.contains("Rescale Slope is 0"), "{flat}");
}

#[test]
fn a_series_of_another_modality_says_that_its_values_may_be_no_hounsfield_units() {
    let mut other = slices();
    other.iter_mut().for_each(|slice| slice.modality = "MR");
    assert_eq!(warning_codes(&read(&other)), ["no-hounsfield"]);
}

#[test]
fn slices_of_two_patients_studies_or_frames_of_reference_are_refused_without_their_names() {
    for (number, name) in
        ["Patient ID", "Study Instance UID", "Frame of Reference UID"].into_iter().enumerate()
    {
        let error = refused(|slices| {
            slices.iter_mut().for_each(|slice| slice.identity[number] = "1.77");
            slices[5..].iter_mut().for_each(|slice| slice.identity[number] = "1.88");
        });
        let found = format!("{name} has 2 values in one series");
        assert!(error.contains(&found), "{error}");
        assert!(error.contains("5 (first file 1), 3 (first file 6)"), "{error}");
        assert!(!error.contains("1.77") && !error.contains("1.88"), "{error}");
    }
    // A file that says nothing may be of the same patient.
    let mut partly = slices();
    partly[2..].iter_mut().for_each(|slice| slice.identity = ["7", "1.2", "1.3"]);
    assert_eq!(*image(read(&partly)).voxels(), Voxels::I16(scan().values));
}

#[test]
fn padding_around_the_circle_of_the_scanner_is_air_whatever_its_number() {
    // The first row, the pixel below its middle, and one within that only has the number of padding.
    let [row, below, within] = [0..5, 7..8, 11..12];
    let padded = |value: u16, is_signed: bool, padding: &[u16]| {
        let mut slices = slices();
        for slice in &mut slices {
            slice.is_signed = is_signed;
            slice.bits = 16;
            slice.rescale = [1.0, if is_signed { 0.0 } else { -1024.0 }];
            slice.stored = vec![if is_signed { 40 } else { 1064 }; 20];
            [&row, &below, &within].into_iter().for_each(|at| slice.stored[at.clone()].fill(value));
            slice.padding = padding.to_vec();
        }
        let read = read(&slices);
        let told = read.warnings.iter().find(|own| own.code == "padding-replaced");
        let told = told.map_or(0.0, |own| own.numbers[0].1);
        let values = match image(read).voxels() {
            Voxels::I16(values) => values[..20].to_vec(),
            Voxels::F32(values) => values[..20].iter().map(|&value| value as i16).collect(),
        };
        (values, told)
    };
    let wanted = |around: i16, alone: i16| {
        let mut values = vec![40; 20];
        [&row, &below].into_iter().for_each(|at| values[at.clone()].fill(around));
        values[within.clone()].fill(alone);
        values
    };
    // Six pixels in each of eight slices.
    assert_eq!(padded(3000, true, &[3000]), (wanted(-1000, 3000), 48.0));
    assert_eq!(padded(4095, false, &[4095]), (wanted(-1000, 3071), 48.0));
    assert_eq!(padded(3000, true, &[3100, 2900]), (wanted(-1000, 3000), 48.0));
    // Below air it is left as it is, and without a declaration nothing is padding.
    assert_eq!(padded(-2000_i16 as u16, true, &[-2000_i16 as u16]), (wanted(-2000, -2000), 0.0));
    assert_eq!(padded(3000, true, &[]), (wanted(3000, 3000), 0.0));
}

#[test]
fn padding_of_another_modality_has_the_smallest_value_of_its_slice() {
    let mut other = slices();
    for slice in &mut other {
        slice.modality = "MR";
        slice.rescale = [1.0, 0.0];
        slice.stored = [[900; 5], [30; 5], [60; 5], [900; 5]].concat();
        slice.padding = vec![900];
    }
    let wanted = [[30_i16; 5], [30; 5], [60; 5], [30; 5]].concat();
    assert_eq!(*image(read(&other)).voxels(), Voxels::I16(wanted.repeat(8)));
}
