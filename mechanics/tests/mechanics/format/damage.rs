//! Damaged files: whatever is cut off or changed, a reader answers and does not panic.

use mechanics::format::{FormatError, ReadLimits, read};

use crate::samples::one_of_each;

/// Limits small enough that a reader which trusts a changed count would show.
fn limits() -> ReadLimits {
    ReadLimits {
        nodes: 1000,
        triangles: 1000,
        cells: 1000,
        voxels: 1000,
        decoded_floor_bytes: 1 << 16,
        image_floor_bytes: 1 << 16,
        ..ReadLimits::default()
    }
}

#[test]
fn a_file_cut_anywhere_is_answered() {
    for (name, bytes) in one_of_each() {
        let mut refused = 0;
        for length in 0..bytes.len() {
            refused += usize::from(read(&bytes[..length], &limits()).is_err());
        }
        // What may be missing: a last line end, the arrays behind a complete mesh, skipped parts.
        assert!(refused * 2 > bytes.len(), "{name}: {refused} of {}", bytes.len());
    }
}

#[test]
fn a_file_with_any_byte_changed_is_answered() {
    for (name, bytes) in one_of_each() {
        let mut changed = bytes.clone();
        for at in 0..bytes.len() {
            for value in [bytes[at] ^ 1, bytes[at] ^ 0x80, 0, 0xff, b'9', b' '] {
                changed[at] = value;
                if let Err(FormatError::Memory { values }) = read(&changed, &limits()) {
                    panic!("{name}: byte {at} as {value} asked memory for {values} values");
                }
            }
            changed[at] = bytes[at];
        }
    }
}

#[test]
fn numbers_replaced_by_huge_ones_are_answered() {
    for (name, bytes) in one_of_each() {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let starts = text.char_indices().zip(text.chars().skip(1));
        let digits = starts
            .filter(|((_, before), digit)| !before.is_ascii_digit() && digit.is_ascii_digit());
        for ((at, before), _) in digits {
            let at = at + before.len_utf8();
            for huge in
                ["4294967295", "18446744073709551615", "-1", "99999999999999999999", "1e400"]
            {
                let rest = text[at..].trim_start_matches(|c: char| c.is_ascii_digit());
                let changed = format!("{}{huge}{rest}", &text[..at]);
                if let Err(FormatError::Memory { values }) = read(changed.as_bytes(), &limits()) {
                    panic!("{name}: {huge} at {at} asked memory for {values} values");
                }
            }
        }
    }
}
