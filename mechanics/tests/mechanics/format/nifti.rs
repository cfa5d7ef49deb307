//! NIfTI: where an image stands, what its numbers mean, and what is refused at which byte.

use mechanics::format::{FormatError, ReadLimits, read};
use mechanics::image::Voxels;
use mechanics::mesh::{Frame, Vector};

use super::scans::{image, misplaced};
use crate::samples::scans::{Ends, nifti_1, nifti_2, small_scan};
use crate::samples::{error_of, gzip, read_default, warning_codes};

fn file() -> Vec<u8> {
    nifti_1(&small_scan(), Ends::Little)
}

fn changed(changes: &[(usize, &[u8])]) -> Vec<u8> {
    let mut bytes = file();
    for (at, new) in changes {
        bytes[*at..*at + new.len()].copy_from_slice(new);
    }
    bytes
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

#[test]
fn both_versions_in_both_byte_orders_stand_in_ras_where_their_rows_say() {
    let scan = small_scan();
    for ends in [Ends::Little, Ends::Big] {
        for (bytes, close) in [(nifti_1(&scan, ends), 1e-5), (nifti_2(&scan, ends), 1e-12)] {
            let read = read_default(&bytes);
            assert_eq!(read.frame, Some(Frame::Ras));
            assert_eq!(*image(read.clone()).voxels(), Voxels::I16(scan.values.clone()));
            let off = misplaced(read, &scan);
            assert!(off < close, "{off}");
        }
    }
}

#[test]
fn a_quaternion_places_an_image_by_its_rotation_and_the_sign_of_its_third_axis() {
    // 90 degrees about z: (a, b, c, d) = (cos 45, 0, 0, sin 45); x goes to y, y to -x.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let quaternion = floats(&[0.0, 0.0, half, 10.0, 20.0, 30.0]);
    for (sign, z) in [(1.0_f32, 2.5), (-1.0, -2.5), (0.0, 2.5)] {
        let bytes = changed(&[(76, &sign.to_le_bytes()), (252, &[1, 0, 0, 0]), (256, &quaternion)]);
        let read = read_default(&bytes);
        assert_eq!(read.frame, Some(Frame::Ras));
        let placement = *image(read).placement();
        let wanted = [Vector::y() * 1.5, Vector::x() * -2.0, Vector::z() * z];
        for (step, wanted) in placement.steps.iter().zip(wanted) {
            assert!((step - wanted).norm() < 1e-6, "{sign}: {step} {wanted}");
        }
        assert_eq!(placement.origin, Vector::new(10.0, 20.0, 30.0));
    }
}

#[test]
fn a_negative_spacing_beside_a_quaternion_mirrors_nothing_and_is_told() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let quaternion = floats(&[0.0, 0.0, half, 10.0, 20.0, 30.0]);
    let read = |spacing: f32| {
        let own = [(80, &spacing.to_le_bytes()[..]), (252, &[1, 0, 0, 0]), (256, &quaternion)];
        read_default(&changed(&own))
    };
    let (right, left) = (read(1.5), read(-1.5));
    assert_eq!(
        (warning_codes(&right), warning_codes(&left)),
        (vec![], vec!["image-place-doubtful"])
    );
    assert_eq!(left.warnings[0].numbers, [("spacing", -1.5)]);
    assert_eq!(image(left).placement(), image(right).placement());
}

#[test]
fn rows_have_the_last_word_and_a_quaternion_that_differs_is_reported() {
    let bytes = changed(&[(252, &[1, 0]), (268, &floats(&[10.0, -20.25, 3.5]))]);
    let read = read_default(&bytes);
    assert_eq!(warning_codes(&read), ["image-place-doubtful"]);
    let off = misplaced(read, &small_scan());
    assert!(off < 1e-5, "{off}");
}

#[test]
fn units_of_length_are_honoured() {
    for (unit, factor) in [(0_u8, 1.0), (1, 1000.0), (2, 1.0), (3, 1e-3), (2 | 8, 1.0)] {
        let spacing = image(read_default(&changed(&[(123, &[unit])]))).spacing();
        assert!((spacing[0] / (1.5 * factor) - 1.0).abs() < 1e-6, "{unit}: {spacing:?}");
    }
}

#[test]
fn slope_and_intercept_are_applied_and_16_bits_are_kept_where_they_hold_the_result() {
    let scan = small_scan();
    let rescaled = |slope: f32, intercept: f32| {
        let bytes = changed(&[(112, &floats(&[slope, intercept]))]);
        image(read_default(&bytes)).voxels().clone()
    };
    let wanted = |slope: f32, intercept: f32| {
        scan.values.iter().map(move |&v| slope * f32::from(v) + intercept)
    };
    assert_eq!(rescaled(2.0, -24.0), Voxels::I16(wanted(2.0, -24.0).map(|v| v as i16).collect()));
    assert_eq!(rescaled(0.5, 1.0), Voxels::F32(wanted(0.5, 1.0).collect()));
    assert_eq!(rescaled(20.0, 0.0), Voxels::F32(wanted(20.0, 0.0).collect()));
    for slope in [0.0, f32::NAN] {
        assert_eq!(rescaled(slope, 7.0), Voxels::I16(scan.values.clone()));
    }
}

#[test]
fn every_type_of_single_numbers_is_read() {
    macro_rules! bytes {
        ($type:ty) => {
            (0..24).flat_map(|value| (value as $type).to_le_bytes()).collect::<Vec<u8>>()
        };
    }
    let types = [
        (2_u8, 0_u8, bytes!(u8)),
        (4, 0, bytes!(i16)),
        (8, 0, bytes!(i32)),
        (16, 0, bytes!(f32)),
        (64, 0, bytes!(f64)),
        (0, 1, bytes!(i8)),
        (0, 2, bytes!(u16)),
        (0, 3, bytes!(u32)),
        (0, 4, bytes!(i64)),
        (0, 5, bytes!(u64)),
    ];
    for (low, high, values) in types {
        let bits = (values.len() / 24 * 8) as u8;
        let mut bytes = changed(&[(70, &[low, high, bits, 0])])[..352].to_vec();
        bytes.extend(values);
        let is_float = low == 16 || low == 64;
        let wanted = match is_float {
            true => Voxels::F32((0..24).map(|v| v as f32).collect()),
            false => Voxels::I16((0..24).collect()),
        };
        for bytes in [bytes.clone(), gzip(&bytes)] {
            assert_eq!(*image(read_default(&bytes)).voxels(), wanted, "type {low} {high}");
        }
    }
}

/// Bytes of a header by their place, the place that is told, and words of what is told.
type WrongHeader = (&'static [(usize, &'static [u8])], u64, &'static str);

#[test]
fn a_header_that_is_wrong_is_refused_with_its_byte() {
    let cases: [WrongHeader; 13] = [
        (
            &[(40, &[4]), (48, &[5])],
            40,
            "has 4 of sizes 3 x 2 x 4 x 5: times and vectors are not read",
        ),
        (&[(40, &[2])], 40, "has 2 of sizes 3 x 2"),
        (&[(40, &[0])], 40, "0 dimensions; 3 are read here"),
        (&[(42, &[1])], 40, "1 x 2 x 4 voxels"),
        (&[(42, &[0xFF, 0xFF])], 40, "-1 x 2 x 4 voxels"),
        (&[(70, &[128])], 70, "type 128 is colours"),
        (&[(70, &[32])], 70, "type 32 is complex numbers"),
        (&[(72, &[8])], 72, "type 4 has 16 bits, the header says 8"),
        (&[(108, &[0, 0, 0x80, 0x7F])], 108, "the voxels cannot begin at byte inf"),
        (&[(254, &[0])], 252, "qform_code and sform_code are both 0"),
        (&[(280, &[0; 12])], 252, "lie in one plane"),
        (&[(123, &[5])], 252, "unit 5 is no length"),
        (&[(344, b"ni1")], 344, "the voxels are in another file"),
    ];
    for (changes, at, detail) in cases {
        let error = error_of(&changed(changes));
        assert!(error.starts_with(&format!("NIfTI file, byte {at}: ")), "{detail}: {error}");
        assert!(error.contains(detail), "{detail}: {error}");
    }
    // One volume in a file that could hold more is an image.
    assert_eq!(image(read_default(&changed(&[(40, &[4])]))).size(), [3, 2, 4]);
}

#[test]
fn bytes_behind_the_last_voxel_are_reported() {
    let more = [file(), vec![0; 5]].concat();
    for bytes in [more.clone(), gzip(&more)] {
        let read = read_default(&bytes);
        assert_eq!(warning_codes(&read), ["trailing-bytes"]);
        assert_eq!(read.warnings[0].numbers, [("bytes", 5.0)]);
    }
}

#[test]
fn zeros_behind_the_compressed_bytes_are_no_part_of_the_image() {
    let plain = read_default(&file());
    let filled = [gzip(&file()), vec![0; 1000]].concat();
    let read = read_default(&filled);
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    assert_eq!(image(read), image(plain));
    let error = error_of(&[&filled[..], b"x"].concat());
    assert!(error.contains("1001 bytes follow the compressed ones"), "{error}");
}

#[test]
fn the_check_sum_behind_megabytes_of_trailing_bytes_is_verified() {
    let more = [file(), vec![0; 2 << 20]].concat();
    let whole = gzip(&more);
    let read = read_default(&whole);
    assert_eq!(read.warnings[0].numbers, [("bytes", f64::from(2 << 20))]);
    // The check sum stands in the last eight bytes, before the length.
    let mut damaged = whole.clone();
    let at = damaged.len() - 8;
    damaged[at] ^= 1;
    let error = error_of(&damaged);
    assert!(error.contains("corrupt gzip stream"), "{error}");
}

#[test]
fn trailing_bytes_beyond_what_a_file_may_decode_to_are_refused() {
    let limits = ReadLimits { image_floor_bytes: 1 << 20, ..ReadLimits::default() };
    let within = [file(), vec![0; 1 << 19]].concat();
    assert!(read(&gzip(&within), &limits).is_ok());
    let beyond = [file(), vec![0; 3 << 20]].concat();
    let refused = read(&gzip(&beyond), &limits);
    assert!(matches!(refused, Err(FormatError::DecompressionLimit { .. })), "{refused:?}");
    // Stored as they are they take no memory.
    assert!(read(&beyond, &limits).is_ok());
}

#[test]
fn the_labels_of_a_segmentation_keep_their_names() {
    let table = "<?xml version=\"1.0\"?> <CaretExtension><VolumeInformation Index=\"0\"><LabelTable>\
        <Label Key=\"1\" Red=\"1\" Alpha=\"1\"><![CDATA[mandible]]></Label>\n\
        <Label Key=\"117\" Red=\"1\"><![CDATA[skull]]></Label></LabelTable></VolumeInformation></CaretExtension>";
    let mut extension = vec![1, 0, 0, 0];
    extension.extend((table.len() as u32 + 8).to_le_bytes());
    extension.extend([0; 4]);
    extension.extend(table.as_bytes());
    let voxels_at = (348 + extension.len()) as f32;
    let bytes = changed(&[(108, &voxels_at.to_le_bytes())]);
    let bytes = [&bytes[..348], &extension, &bytes[352..]].concat();
    let image = image(read_default(&gzip(&bytes)));
    assert_eq!(format!("{:?}", image.label_names()), r#"{1: "mandible", 117: "skull"}"#);
}

#[test]
fn a_bomb_is_refused_by_what_it_promises() {
    let size: Vec<u8> = [512_i16, 512, 511].iter().flat_map(|n| n.to_le_bytes()).collect();
    let mut bomb = changed(&[(42, &size), (70, &[16, 0, 32])]);
    bomb.resize(1 << 20, 0);
    let error = error_of(&gzip(&bomb));
    assert!(error.ends_with("and 134217728 bytes is the limit"), "{error}");
    assert!(error_of(&bomb).contains("bytes declared, 1048576 left"));
}
