//! MetaImage: what is read, where it stands, and what is refused at which line.

use mechanics::format::{FormatError, ReadLimits, read};
use mechanics::image::Voxels;

use super::scans::{image, misplaced};
use crate::samples::scans::{metaimage, metaimage_header, metaimage_pair, small_scan, zip, zlib};
use crate::samples::{error_of, read_default, warning_codes};

fn changed(from: &str, to: &str) -> Vec<u8> {
    let header = metaimage_header(&small_scan()) + "ElementDataFile = LOCAL\n";
    assert!(header.contains(from), "{from}");
    let voxels = &metaimage(&small_scan())[header.len()..];
    [header.replace(from, to).as_bytes(), voxels].concat()
}

#[test]
fn every_type_is_read_in_both_byte_orders_raw_and_compressed() {
    macro_rules! bytes {
        ($type:ty) => {
            [
                (0..24).flat_map(|value| (value as $type).to_le_bytes()).collect::<Vec<u8>>(),
                (0..24).flat_map(|value| (value as $type).to_be_bytes()).collect::<Vec<u8>>(),
            ]
        };
    }
    for (name, both) in [
        ("MET_CHAR", bytes!(i8)),
        ("MET_UCHAR", bytes!(u8)),
        ("MET_SHORT", bytes!(i16)),
        ("MET_USHORT", bytes!(u16)),
        ("MET_INT", bytes!(i32)),
        ("MET_UINT", bytes!(u32)),
        ("MET_LONG_LONG", bytes!(i64)),
        ("MET_ULONG_LONG", bytes!(u64)),
        ("MET_FLOAT", bytes!(f32)),
        ("MET_DOUBLE", bytes!(f64)),
    ] {
        for (order, bytes) in ["False", "True"].iter().zip(both) {
            let header = metaimage_header(&small_scan())
                .replace("MET_SHORT", name)
                .replace("MSB = False", &format!("MSB = {order}"))
                + "ElementDataFile = LOCAL\n";
            let packed = header.replace("CompressedData = False", "CompressedData = True");
            let wanted = match name {
                "MET_FLOAT" | "MET_DOUBLE" => Voxels::F32((0..24).map(|v| v as f32).collect()),
                _ => Voxels::I16((0..24).collect()),
            };
            for file in
                [[header.as_bytes(), &bytes].concat(), [packed.as_bytes(), &zlib(&bytes)].concat()]
            {
                assert_eq!(*image(read_default(&file)).voxels(), wanted, "{name} {order}");
            }
        }
    }
}

#[test]
fn a_header_without_its_voxels_is_refused_and_read_with_them_beside_it() {
    let error = error_of(&changed("LOCAL", "ct.raw"));
    assert!(error.contains("the voxels are in another file, which is never opened"), "{error}");
    let pair = metaimage_pair(&small_scan());
    assert!(misplaced(read_default(&pair), &small_scan()) < 1e-12);
    let header = changed("LOCAL", "../ct.raw");
    let error = error_of(&zip(&[("a/ct.mhd", &header), ("ct.raw", &[0; 48])]));
    assert!(error.contains("is not beside it in the archive"), "{error}");
}

#[test]
fn letters_that_contradict_the_matrix_are_reported() {
    // Axes that grow to the left, to the back and upwards come from right, anterior, inferior.
    let read = |letters: &str| {
        let line = format!("AnatomicalOrientation = {letters}\nElementType");
        read_default(&changed("ElementType", &line))
    };
    assert_eq!(warning_codes(&read("RAI")), [""; 0]);
    assert_eq!(warning_codes(&read("???")), [""; 0]);
    let doubtful = read("LPI");
    assert_eq!(warning_codes(&doubtful), ["image-place-doubtful"]);
    assert!(doubtful.warnings[0].detail.contains("says LPI and TransformMatrix RAI"));
    assert!(misplaced(doubtful, &small_scan()) < 1e-12);
}

#[test]
fn a_header_that_is_wrong_is_refused_with_its_line() {
    for (from, to, line, detail) in [
        ("ObjectType = Image", "ObjectType = Tube", 1, "an Image is read here, not \"Tube\""),
        ("NDims = 3", "NDims = 4", 2, "a scalar image has NDims = 3, this file 4"),
        ("BinaryData = True", "BinaryData = False", 4, "voxels as text are not read"),
        ("MSB = False", "MSB = perhaps", 5, "is True or False"),
        ("Offset = ", "Offset = 1 ", 8, "expected 3 numbers"),
        ("Offset = -10", "Offset = nan", 8, "is not finite"),
        ("ElementSpacing = 1.5", "ElementSpacing = -1.5", 10, "voxels cannot be -1.5 mm apart"),
        ("DimSize = 3 2 4", "DimSize = 3 2", 11, "expected 3 numbers"),
        ("DimSize = 3 2 4", "DimSize = 3 -2 4", 11, "expected 3 numbers"),
        ("DimSize = 3 2 4", "DimSize = 24 1 1", 11, "two or more voxels"),
        ("MET_SHORT", "MET_STRING", 12, "type \"MET_STRING\" holds no single numbers"),
        ("MET_SHORT\n", "MET_SHORT\nElementNumberOfChannels = 3\n", 13, "one channel is read here"),
        ("MET_SHORT\n", "MET_SHORT\nHeaderSize = -1\n", 13, "a HeaderSize of 0 is read here"),
        ("MET_SHORT\n", "MET_SHORT\nNDims = 3\n", 13, "`NDims` is given twice"),
        ("MET_SHORT\n", "MET_SHORT\nwords\n", 13, "expected a key"),
        ("NDims = 3\n", "", 12, "the header ends without `NDims`"),
        ("LOCAL", "LIST", 13, "in several files"),
    ] {
        let error = error_of(&changed(from, to));
        assert!(error.starts_with(&format!("MetaImage file, line {line}: ")), "{to}: {error}");
        assert!(error.contains(detail), "{to}: {error}");
    }
}

#[test]
fn slope_and_intercept_are_applied() {
    let lines =
        "ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -5\nElementType";
    let wanted = small_scan().values.iter().map(|v| 2 * v - 5).collect();
    assert_eq!(*image(read_default(&changed("ElementType", lines))).voxels(), Voxels::I16(wanted));
}

#[test]
fn compressed_voxels_that_are_too_few_or_lie_about_their_length_are_refused() {
    let short =
        changed("CompressedData = False", "CompressedData = True\nCompressedDataSize = 4000");
    assert!(error_of(&short).contains("4000 bytes declared, 48 left"));
    let header =
        metaimage_header(&small_scan()).replace("CompressedData = False", "CompressedData = True");
    let header = header + "ElementDataFile = LOCAL\n";
    let few = [header.as_bytes(), &zlib(&[0; 40])].concat();
    assert!(error_of(&few).ends_with("48 bytes declared, 40 are there"));
    let bomb = header.replace("3 2 4", "512 512 512");
    let bomb = [bomb.as_bytes(), &zlib(&vec![0; 1 << 20])].concat();
    let refused = read(&bomb, &ReadLimits::default());
    assert!(matches!(refused, Err(FormatError::DecompressionLimit { .. })), "{refused:?}");
}
