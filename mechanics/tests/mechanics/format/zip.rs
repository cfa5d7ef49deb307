//! Zip archives: what may stand in one, and what is refused before anything is unpacked.

use crate::samples::scans::{Coding, dicom_slices, metaimage, series, small_scan, zip};
use crate::samples::{code_of, error_of, read_default, warning_codes};

fn slices() -> Vec<Vec<u8>> {
    dicom_slices(&small_scan(), Coding::Explicit).iter().map(|slice| slice.file()).collect()
}

fn with(name: &str, bytes: &[u8]) -> Vec<u8> {
    let slices = slices();
    let mut files: Vec<(&str, &[u8])> = vec![("a", &slices[0]), ("b", &slices[1])];
    files.push((name, bytes));
    zip(&files)
}

/// Where the directory has the entry of this number.
fn directory_entry(archive: &[u8], number: usize) -> usize {
    let marks = archive.windows(4).enumerate().filter(|(_, window)| *window == b"PK\x01\x02");
    marks.map(|(at, _)| at).nth(number).unwrap()
}

#[test]
fn files_that_are_no_slices_are_passed_over_and_counted() {
    let read = read_default(&with("Roe_Jane/README.TXT", b"hello"));
    assert_eq!(warning_codes(&read), ["files-passed-over"]);
    assert_eq!(read.warnings[0].numbers, [("files", 1.0)]);
}

#[test]
fn an_archive_without_an_image_is_no_format_that_is_read() {
    for archive in [zip(&[("a.txt", b"hello")]), zip(&[])] {
        assert_eq!(code_of(&archive), "unsupported-format");
        assert!(error_of(&archive).contains("without a DICOM file"), "{}", error_of(&archive));
    }
    assert!(error_of(b"PK\x03\x04abc").contains("ends before its directory"));
    // Nothing of it lies there, and that much there is.
    let mut beyond = b"PK\x03\x04\x14\0PK\x05\x06".to_vec();
    beyond.extend([0; 12]);
    beyond.extend(1091_u32.to_le_bytes());
    beyond.extend([0; 2]);
    assert!(error_of(&beyond).contains("beyond the end"), "{}", error_of(&beyond));
}

#[test]
fn archives_within_archives_and_two_kinds_of_images_are_refused() {
    let inner = series(&dicom_slices(&small_scan(), Coding::Explicit));
    let error = error_of(&with("inner.zip", &inner));
    assert!(error.contains("file 3: an archive within an archive is not read"), "{error}");
    let error = error_of(&with("ct.mha", &metaimage(&small_scan())));
    assert!(error.contains("2 DICOM files and 1 MetaImage headers"), "{error}");
}

#[test]
fn names_that_lead_out_of_the_archive_are_refused_and_not_repeated() {
    for name in ["../../Roe", "/Roe", "a/../../Roe", "a\\Roe", "C:Roe"] {
        let error = error_of(&with(name, b"x"));
        assert!(error.contains("file 3: its name leads out of the archive"), "{name}: {error}");
        assert!(!error.contains("Roe"), "{error}");
    }
}

#[test]
fn two_files_of_one_name_are_refused() {
    for name in ["a", "./a", ".//a"] {
        let error = error_of(&with(name, b"x"));
        assert!(error.contains("file 3: file 1 has the same name"), "{name}: {error}");
    }
    read_default(&with("folder/a", b"x"));
}

#[test]
fn links_encryption_and_other_methods_are_refused() {
    let archive = with("c", b"x");
    let at = directory_entry(&archive, 2);
    let changed = |offset: usize, bytes: &[u8]| {
        let mut archive = archive.clone();
        archive[at + offset..at + offset + bytes.len()].copy_from_slice(bytes);
        error_of(&archive)
    };
    assert!(
        changed(38, &0o120_777_u32.wrapping_shl(16).to_le_bytes()).contains("file 3: it is a link")
    );
    assert!(changed(8, &[1]).contains("file 3: it is encrypted"));
    assert!(changed(10, &[14]).contains("file 3: compression method 14 is not read"));
    assert!(changed(24, &u32::MAX.to_le_bytes()).contains("its size is in zip64"));
}

#[test]
fn sizes_places_and_check_sums_that_lie_are_refused() {
    let archive = with("c", &[7; 1000]);
    let at = directory_entry(&archive, 2);
    let first = directory_entry(&archive, 0);
    let changed = |offset: usize, number: u32| {
        let mut archive = archive.clone();
        archive[offset..offset + 4].copy_from_slice(&number.to_le_bytes());
        error_of(&archive)
    };
    assert!(changed(at + 24, 600 << 20).contains("bytes is the limit"));
    assert!(changed(at + 24, 1 << 20).contains("promises more than its compressed bytes can hold"));
    assert!(changed(at + 20, 1 << 20).contains("reaches beyond the end"));
    assert!(changed(at + 42, 0).contains("shares bytes with another"));
    assert!(changed(first + 16, 0).contains("its bytes are not those that the directory promises"));
}

#[test]
fn more_files_than_a_series_has_are_refused_before_any_is_opened() {
    let names: Vec<String> = (0..4097).map(|n| n.to_string()).collect();
    let files: Vec<(&str, &[u8])> = names.iter().map(|name| (name.as_str(), &b""[..])).collect();
    assert_eq!(error_of(&zip(&files)), "4097 files in an archive, and 4096 is the limit");
}
