//! STL, binary and text. Equal corners become one point; the stored normals are not used.
//!
//! Source: StereoLithography Interface Specification, 3D Systems, 1988.

use std::collections::HashMap;

use super::cursor::Cursor;
use super::error::FormatError;
use super::limits::{ReadLimits, room_for};
use super::output::{SurfaceOutput, WriteError};
use super::parsed::Parsed;
use super::scalar::{ByteOrder, Scalar};
use crate::mesh::Vector;

const HEADER_BYTES: u64 = 80;
const TRIANGLE_BYTES: u64 = 50;

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let mut cursor = Cursor::new("STL", bytes);
    if is_text(bytes) { read_text(&mut cursor, limits) } else { read_binary(&mut cursor, limits) }
}

/// Binary files may start with "solid" too; their length, or a zero byte, gives them away.
fn is_text(bytes: &[u8]) -> bool {
    let declared = bytes.get(80..84).map(|count| Scalar::U32.integer(count, ByteOrder::Little));
    let is_exact = declared.is_some_and(|count| {
        count > 0 && bytes.len() as u64 == HEADER_BYTES + 4 + count as u64 * TRIANGLE_BYTES
    });
    let start: Vec<u8> = bytes.trim_ascii_start().iter().take(5).copied().collect();
    let has_zero = bytes.iter().take(4096).any(|&byte| byte == 0);
    !is_exact && !has_zero && start.eq_ignore_ascii_case(b"solid")
}

/// Points without repeats, in the order in which they first appear.
#[derive(Default)]
struct WeldedPoints {
    numbers: HashMap<[u64; 3], u32>,
    points: Vec<Vector>,
}

impl WeldedPoints {
    fn number(&mut self, point: Vector) -> u32 {
        // Adding zero makes one of the two zeros.
        let key = [point.x, point.y, point.z].map(|coordinate| (coordinate + 0.0).to_bits());
        let points = &mut self.points;
        *self.numbers.entry(key).or_insert_with(|| {
            points.push(point);
            points.len() as u32 - 1
        })
    }
}

fn read_binary(cursor: &mut Cursor<'_>, limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let mut parsed = Parsed::default();
    parsed.note_space_mark(&String::from_utf8_lossy(cursor.take(HEADER_BYTES)?));
    let declared = u64::from(u32::from_le_bytes(cursor.take_array()?));
    let (have, beyond) = (
        cursor.remaining() / TRIANGLE_BYTES,
        cursor.remaining().saturating_sub(declared * TRIANGLE_BYTES),
    );
    if declared > have {
        return Err(cursor.bad_bytes(format!("{declared} triangles declared, {have} follow")));
    }
    limits.check_triangles(declared)?;
    let records = cursor.take_records(declared, TRIANGLE_BYTES)?;
    let mut welded = WeldedPoints::default();
    parsed.triangles = room_for(declared as usize)?;
    for record in records.chunks_exact(TRIANGLE_BYTES as usize) {
        let mut corners = [0; 3];
        for (corner, bytes) in corners.iter_mut().zip(record[12..48].chunks_exact(12)) {
            let mut point = Vector::zeros();
            for (coordinate, raw) in point.iter_mut().zip(bytes.chunks_exact(4)) {
                *coordinate = Scalar::F32.real(raw, ByteOrder::Little);
            }
            *corner = welded.number(point);
        }
        parsed.triangles.push(corners);
    }
    parsed.points = welded.points;
    parsed.note_trailing(beyond, &format!("the {declared} triangles declared"));
    Ok(parsed)
}

fn read_text(cursor: &mut Cursor<'_>, limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let mut parsed = Parsed::default();
    let mut welded = WeldedPoints::default();
    let mut is_open = false;
    while let Some(word) = cursor.word() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                parsed.note_space_mark(&cursor.text_line().unwrap_or_default());
                is_open = true;
            }
            b"endsolid" => {
                cursor.line();
                is_open = false;
            }
            b"facet" => {
                let triangle = read_facet(cursor, &mut welded)?;
                parsed.triangles.push(triangle);
                limits.check_triangles(parsed.triangles.len() as u64)?;
            }
            _ => return Err(cursor.bad_line("expected facet or endsolid")),
        }
    }
    if is_open {
        return Err(cursor.bad_line("the file ends before endsolid"));
    }
    parsed.points = welded.points;
    Ok(parsed)
}

fn read_facet(cursor: &mut Cursor<'_>, welded: &mut WeldedPoints) -> Result<[u32; 3], FormatError> {
    expect(cursor, "normal")?;
    for _ in 0..3 {
        cursor.real("a component of the normal")?;
    }
    expect(cursor, "outer")?;
    expect(cursor, "loop")?;
    let mut corners = [0; 3];
    for corner in &mut corners {
        expect(cursor, "vertex")?;
        let mut point = Vector::zeros();
        for coordinate in point.iter_mut() {
            *coordinate = cursor.real("a coordinate")?;
        }
        *corner = welded.number(point);
    }
    expect(cursor, "endloop")?;
    expect(cursor, "endfacet")?;
    Ok(corners)
}

fn expect(cursor: &mut Cursor<'_>, keyword: &str) -> Result<(), FormatError> {
    let word = cursor.expect_word(keyword)?;
    if word.eq_ignore_ascii_case(keyword) {
        return Ok(());
    }
    Err(cursor.bad_line(format!("expected {keyword}")))
}

/// Binary STL with the frame in its header. Positions are rounded to 32 bits.
pub fn write(output: &SurfaceOutput) -> Result<Vec<u8>, WriteError> {
    output.check()?;
    let surface = output.surface;
    let mut header = format!("facies SPACE={}", output.frame).into_bytes();
    header.resize(HEADER_BYTES as usize, 0);
    let mut bytes = header;
    bytes.extend((surface.triangles.len() as u32).to_le_bytes());
    for triangle in 0..surface.triangles.len() {
        let area = surface.area_vector(triangle);
        let normal = area.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        for vector in std::iter::once(normal).chain(surface.corners(triangle)) {
            for component in vector.iter() {
                bytes.extend((*component as f32).to_le_bytes());
            }
        }
        bytes.extend([0, 0]);
    }
    Ok(bytes)
}
