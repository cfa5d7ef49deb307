//! NRRD: what is read, where it stands, and what is refused at which line.

use mechanics::format::{FilePosition, FormatError, Mesh, ReadLimits, ReadMesh, nrrd, read};
use mechanics::image::{ImageVolume, Voxels};
use mechanics::mesh::{Frame, Vector};

use crate::samples::{
    NRRD, VOXELS, code_of, error_of, gzip, nrrd as file, read_default, warning_codes,
};

fn image(read: ReadMesh) -> ImageVolume {
    match read.mesh {
        Mesh::Image(image) => image,
        _ => panic!("an image was expected"),
    }
}

fn voxel_bytes() -> Vec<u8> {
    VOXELS.map(i16::to_le_bytes).concat()
}

fn changed(from: &str, to: &str) -> Vec<u8> {
    assert!(NRRD.contains(from), "{from}");
    file(&NRRD.replace(from, to), &voxel_bytes())
}

#[test]
fn an_image_has_the_place_the_frame_and_the_values_of_its_file() {
    let read = read_default(&file(NRRD, &voxel_bytes()));
    assert_eq!(read.frame, Some(Frame::Lps));
    let image = image(read);
    assert_eq!(image.size(), [3, 2, 4]);
    assert_eq!(image.spacing(), [30.0, 40.0, 20.0]);
    assert_eq!(image.centre([2, 1, 3]), Vector::new(61.0, 38.0, 63.5));
    assert_eq!(*image.voxels(), Voxels::I16(VOXELS.to_vec()));
    // The first axis is the fastest.
    assert_eq!(image.at(&image.centre([2, 1, 0])), Some(3000.0));
    assert_eq!(image.range(), (-1000.0, 3000.0));
}

/// Values that every type holds.
const SMALL: [i8; 24] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 127];

#[test]
fn every_type_is_read_in_both_byte_orders_raw_and_compressed() {
    macro_rules! bytes {
        ($type:ty) => {
            (
                SMALL.map(|value| (value as $type).to_le_bytes()).concat(),
                SMALL.map(|value| (value as $type).to_be_bytes()).concat(),
            )
        };
    }
    let types = [
        ("int8", bytes!(i8)),
        ("unsigned char", bytes!(u8)),
        ("signed short int", bytes!(i16)),
        ("uint16_t", bytes!(u16)),
        ("int", bytes!(i32)),
        ("unsigned int", bytes!(u32)),
        ("long long", bytes!(i64)),
        ("uint64", bytes!(u64)),
        ("float", bytes!(f32)),
        ("double", bytes!(f64)),
    ];
    let mut seen = 0;
    for (name, (little, big)) in types {
        let wanted = match name {
            "float" | "double" => Voxels::F32(SMALL.map(f32::from).to_vec()),
            _ => Voxels::I16(SMALL.map(i16::from).to_vec()),
        };
        for (order, bytes) in [("little", &little), ("big", &big)] {
            let header =
                NRRD.replace("short", name).replace("endian: little", &format!("endian: {order}"));
            let compressed = file(&header.replace("raw", "gzip"), &gzip(bytes));
            for bytes in [file(&header, bytes), compressed] {
                assert_eq!(*image(read_default(&bytes)).voxels(), wanted, "{name} {order}");
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 40);
    // What 16 bits do not hold is kept in single precision.
    let large: Vec<u8> = VOXELS.iter().flat_map(|&v| (i32::from(v) * 100).to_be_bytes()).collect();
    let header = NRRD.replace("short", "int32").replace("little", "big");
    let wanted = Voxels::F32(VOXELS.iter().map(|&v| f32::from(v) * 100.0).collect());
    assert_eq!(*image(read_default(&file(&header, &large))).voxels(), wanted);
}

#[test]
fn the_largest_unsigned_voxel_keeps_its_value() {
    let mut values = [7_u64; 24];
    values[3] = u64::MAX;
    let bytes = values.map(u64::to_le_bytes).concat();
    let image = image(read_default(&file(&NRRD.replace("short", "uint64"), &bytes)));
    assert_eq!(image.range(), (7.0, f64::from(u64::MAX as f32)));
}

#[test]
fn what_is_written_is_read_again_and_names_nobody() {
    let singles: Vec<u8> =
        VOXELS.iter().flat_map(|&v| (f32::from(v) / 3.0).to_le_bytes()).collect();
    let oblique = NRRD.replace("(30,0,0) (0,40,0)", "(30,0.1,1e-3) (-0.3,-40.000000000000007,0)");
    for (bytes, frame) in [
        (file(NRRD, &voxel_bytes()), Frame::Lps),
        (file(&oblique.replace("short", "float"), &singles), Frame::Ras),
        (file(&oblique, &voxel_bytes()), Frame::Unspecified),
    ] {
        let original = image(read_default(&bytes));
        let written = nrrd::write(&original, frame);
        assert!(!String::from_utf8_lossy(&written).contains("Jane"));
        let again = read_default(&written);
        let stated = Some(frame).filter(|frame| *frame != Frame::Unspecified);
        assert_eq!(again.frame, stated);
        assert_eq!(image(again), original);
    }
}

#[test]
fn spaces_and_units_are_honoured() {
    let at = |bytes: &[u8]| {
        let read = read_default(bytes);
        let frame = read.frame;
        (frame, image(read).centre([1, 0, 0]))
    };
    for (space, frame) in [
        ("RAS", Some(Frame::Ras)),
        ("Right-Anterior-Superior", Some(Frame::Ras)),
        ("LPS", Some(Frame::Lps)),
        ("scanner-xyz", None),
        ("3D-right-handed", None),
    ] {
        let read = at(&changed("left-posterior-superior", space));
        assert_eq!(read, (frame, Vector::new(31.0, -2.0, 3.5)), "{space}");
    }
    // Left, anterior, superior is RAS with x the other way.
    let las = at(&changed("left-posterior-superior", "LAS"));
    assert_eq!(las, (Some(Frame::Ras), Vector::new(-31.0, -2.0, 3.5)));
    let unit = |unit: &str| {
        at(&changed("endian", &format!("space units: \"{unit}\" \"{unit}\" \"{unit}\"\nendian"))).1
    };
    assert_eq!(unit("mm"), Vector::new(31.0, -2.0, 3.5));
    assert_eq!(unit("cm"), Vector::new(310.0, -20.0, 35.0));
    let without = at(&changed("space: left-posterior-superior", "space dimension: 3"));
    assert_eq!(without, (None, Vector::new(31.0, -2.0, 3.5)));
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table with one line for each mistake")]
fn a_header_that_is_wrong_is_refused_with_its_line() {
    for (from, to, line, detail) in [
        ("type: short", "type: block", 3, "type \"block\" holds no single numbers"),
        ("dimension: 3", "dimension: 4", 4, "colours, vectors and times are not read"),
        ("sizes: 3 2 4", "sizes: 3 2", 6, "three sizes are expected"),
        ("sizes: 3 2 4", "sizes: 3 2 4 1", 6, "three sizes are expected"),
        ("sizes: 3 2 4", "sizes: 3 -2 4", 6, "expected a number of voxels, found \"-2\""),
        ("sizes: 3 2 4", "sizes: 3 2.5 4", 6, "found \"2.5\""),
        ("sizes: 3 2 4", "sizes: 24 1 1", 6, "two or more voxels"),
        ("sizes: 3 2 4", "sizes: 0 2 4", 6, "two or more voxels"),
        ("(30,0,0)", "(nan,0,0)", 7, "three finite numbers"),
        ("(30,0,0)", "(inf,0,0)", 7, "three finite numbers"),
        ("(30,0,0)", "none", 7, "three finite numbers"),
        ("(30,0,0)", "(30,0)", 7, "three finite numbers"),
        ("(30,0,0)", "(30,0,0,0)", 7, "three finite numbers"),
        ("(30,0,0)", "(0,0,0)", 7, "voxels are 0 mm apart along axis 0"),
        ("(30,0,0)", "(1e300,0,0)", 7, "00 mm apart along axis 0"),
        ("(30,0,0)", "(0,30,0)", 7, "the three directions lie in one plane"),
        ("endian: little", "endian: middle", 9, "endian is little or big, not \"middle\""),
        ("encoding: raw", "encoding: bzip2", 10, "raw and gzip are read here, \"bzip2\" is asked"),
        ("(1, -2, 3.5)", "(1, -2, 1e12)", 11, "the origin is farther than 1e9 mm away"),
        ("(1, -2, 3.5)", "(1, -2, NaN)", 11, "three finite numbers"),
        ("posterior", "sideways", 5, "is not read; RAS, LPS, LAS"),
        (
            "kinds: domain",
            "data file: x.raw\nkinds: domain",
            8,
            "in another file, which is never opened",
        ),
        (
            "kinds: domain",
            "datafile: LIST\nkinds: domain",
            8,
            "in another file, which is never opened",
        ),
        (
            "kinds: domain",
            "byte skip: -1\nkinds: domain",
            8,
            "a byte skip of 0 is read here, -1 is asked",
        ),
        ("kinds: domain", "sizes: 3 2 4\nkinds: domain", 8, "the field `sizes` is given twice"),
        (
            "kinds: domain",
            "space units: \"mm\" \"m\" \"mm\"\nkinds: domain",
            8,
            "one unit for all axes",
        ),
        (
            "kinds: domain",
            "space units: \"ft\" \"ft\" \"ft\"\nkinds: domain",
            8,
            "\"ft\" is not known",
        ),
        (
            "kinds: domain",
            "kinds domain",
            8,
            "neither a field, a key with its value, nor a comment",
        ),
        ("type: short\n", "", 12, "the header ends without `type`"),
        ("space origin: (1, -2, 3.5)\n", "", 12, "the header ends without `space origin`"),
        ("endian: little\n", "", 12, "the header ends without `endian`"),
        ("space: left-posterior-superior\n", "", 12, "the header ends without `space dimension`"),
    ] {
        let error = error_of(&changed(from, to));
        assert!(error.starts_with(&format!("NRRD file, line {line}: ")), "{to}: {error}");
        assert!(error.contains(detail), "{to}: {error}");
    }
    let open = error_of(NRRD.trim_end().as_bytes());
    assert_eq!(open, "NRRD file, line 13: the file ends inside the header");
    let version = error_of(b"NRRD1\n");
    assert!(
        version.ends_with("it is an NRRD file of a version that is not read here"),
        "{version}"
    );
}

#[test]
fn sizes_beyond_the_limit_are_refused_before_memory_is_taken() {
    for sizes in ["1000 1000 1000", "4294967295 4294967295 2", "18446744073709551615 2 2"] {
        assert_eq!(code_of(&changed("3 2 4", sizes)), "mesh-limits", "{sizes}");
    }
    let small = ReadLimits { voxels: 23, ..ReadLimits::default() };
    let refused = read(&file(NRRD, &voxel_bytes()), &small).unwrap_err();
    assert_eq!(refused.to_string(), "24 voxels, and 23 is the limit");
}

#[test]
fn voxels_that_are_missing_or_too_many_are_counted() {
    let data = NRRD.len() as u64;
    let cut = file(NRRD, &voxel_bytes()[..47]);
    let wanted = format!("NRRD file, byte {data}: 48 bytes declared, 47 left");
    assert_eq!(error_of(&cut), wanted);
    let more = file(NRRD, &[voxel_bytes(), vec![0; 3]].concat());
    assert_eq!(warning_codes(&read_default(&more)), ["trailing-bytes"]);
    let gzipped = NRRD.replace("raw", "gz");
    let (short, long) = (gzip(&voxel_bytes()[..40]), gzip(&[0; 64]));
    assert!(error_of(&file(&gzipped, &short)).ends_with("48 bytes declared, 40 are there"));
    assert!(error_of(&file(&gzipped, &long)).ends_with("48 bytes declared, more are there"));
    let whole = gzip(&voxel_bytes());
    let error = read(&file(&gzipped, &whole[..whole.len() / 2]), &ReadLimits::default());
    let place = FilePosition::Offset(data - 1);
    assert!(matches!(error, Err(FormatError::Parse { place: at, .. }) if at == place), "{error:?}");
}

#[test]
fn a_bomb_is_refused_by_what_it_promises() {
    // 256 MiB of zeros are promised in 130 kB: more than ten times the file and more than the floor.
    let header = NRRD.replace("raw", "gzip").replace("3 2 4", "512 512 512");
    let bomb = file(&header, &gzip(&vec![0; 1 << 27]));
    assert_eq!(
        error_of(&bomb),
        "the arrays decode to 268435456 bytes or more, and 134217728 bytes is the limit"
    );
    // A small promise is kept to, whatever follows.
    let lie = file(&NRRD.replace("raw", "gzip"), &gzip(&vec![0; 1 << 24]));
    assert!(error_of(&lie).ends_with("48 bytes declared, more are there"));
}

#[test]
fn the_segments_of_a_label_map_keep_their_names() {
    let lines = "Segment0_ID:=a\nSegment0_LabelValue:=3\nSegment0_Name:=Mandible\n\
                 Segment12_Name:=Skull\nSegment12_LabelValue:=7\nSegment2_Name:=no label\nkinds";
    let image = image(read_default(&changed("kinds", lines)));
    let named = |image: &ImageVolume| format!("{:?}", image.label_names());
    assert_eq!(named(&image), r#"{3: "Mandible", 7: "Skull"}"#);
    let Mesh::Image(again) = read_default(&nrrd::write(&image, Frame::Lps)).mesh else { panic!() };
    assert_eq!(again, image);
}

#[test]
fn voxels_that_are_no_numbers_are_refused() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut values = [1.0_f32; 24];
        values[7] = bad;
        let bytes = file(&NRRD.replace("short", "float"), &values.map(f32::to_le_bytes).concat());
        let error = error_of(&bytes);
        assert!(
            error.ends_with("1 voxels are not finite numbers, the first is voxel 7"),
            "{error}"
        );
    }
    let bytes = [1e300_f64; 24].map(f64::to_le_bytes).concat();
    let error = error_of(&file(&NRRD.replace("short", "double"), &bytes));
    assert!(error.ends_with("24 voxels are not finite numbers, the first is voxel 0"), "{error}");
}
