//! Wavefront OBJ: vertices and faces. Materials and textures are never opened.
//!
//! Source: Wavefront Advanced Visualizer manual, appendix B1, "Object Files".

use super::cursor::Cursor;
use super::error::FormatError;
use super::limits::ReadLimits;
use super::parsed::Parsed;
use super::scalar::node_number;
use crate::mesh::Vector;

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let mut cursor = Cursor::new("OBJ", bytes);
    let mut parsed = Parsed::default();
    let mut skipped = 0;
    let mut corners = Vec::new();
    loop {
        // The place of an error is the line that is being read, so that the cursor moves later.
        let mut after = cursor.clone();
        let Some(line) = after.line() else { break };
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                parsed.points.push(vertex(&cursor, words)?);
                limits.check_nodes(parsed.points.len() as u64)?;
            }
            Some(b"f") => {
                face(&cursor, words, parsed.points.len(), &mut corners, limits)?;
                parsed.push_polygon(&corners, limits)?;
            }
            Some(b"l" | b"p" | b"curv" | b"curv2" | b"surf") => skipped += 1,
            Some(word) if word.starts_with(b"#") => {
                parsed.note_space_mark(&String::from_utf8_lossy(line));
            }
            _ => {}
        }
        cursor = after;
    }
    parsed.note_skipped(skipped, "lines, points and free-form curves and surfaces");
    Ok(parsed)
}

fn vertex<'a>(
    cursor: &Cursor<'_>,
    mut words: impl Iterator<Item = &'a [u8]>,
) -> Result<Vector, FormatError> {
    let mut point = Vector::zeros();
    for coordinate in point.iter_mut() {
        let word = words.next().map(String::from_utf8_lossy);
        let word = word.ok_or_else(|| cursor.bad_line("a vertex has three coordinates"))?;
        let value = word.parse();
        *coordinate = value.map_err(|_| cursor.not_a_number("a coordinate", &word))?;
    }
    Ok(point)
}

/// Corners as `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 1, or from the end if negative.
fn face<'a>(
    cursor: &Cursor<'_>,
    words: impl Iterator<Item = &'a [u8]>,
    vertices: usize,
    corners: &mut Vec<u32>,
    limits: &ReadLimits,
) -> Result<(), FormatError> {
    corners.clear();
    let mut count = 0;
    for word in words {
        count += 1;
        if count > limits.polygon_corners {
            continue;
        }
        let first = word.split(|&byte| byte == b'/').next().unwrap_or(word);
        let number: i64 = std::str::from_utf8(first)
            .ok()
            .and_then(|number| number.parse().ok())
            .ok_or_else(|| cursor.not_a_number("a vertex", &String::from_utf8_lossy(word)))?;
        let index = if number < 0 { number.saturating_add(vertices as i64) } else { number - 1 };
        corners.push(node_number(index));
    }
    limits.check_corners(count)?;
    if count < 3 {
        return Err(cursor.bad_line("a face has at least three corners"));
    }
    Ok(())
}
