//! PLY, text and binary of both byte orders. Properties are found by name.

mod header;

use super::arrays::{NamedArray, Values};
use super::cursor::Cursor;
use super::error::FormatError;
use super::limits::{ReadLimits, room_for};
use super::output::{ArrayValues, NamedValues, SurfaceOutput, TENSOR_COMPONENTS, WriteError};
use super::parsed::Parsed;
use super::scalar::{ByteOrder, Scalar, node_number};
use crate::mesh::{ValuesOf, Vector};
use header::{Element, Header, PropertyKind};

struct PlyReader<'a, 'l> {
    cursor: Cursor<'a>,
    binary: Option<ByteOrder>,
    limits: &'l ReadLimits,
    parsed: Parsed,
}

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let mut cursor = Cursor::new("PLY", bytes);
    cursor.skip_space();
    let header = Header::read(&mut cursor)?;
    let mut reader = PlyReader { cursor, binary: header.binary, limits, parsed: Parsed::default() };
    for comment in &header.comments {
        reader.parsed.note_space_mark(comment);
    }
    for element in &header.elements {
        reader.check_count(element)?;
        match element.name.as_str() {
            "vertex" => reader.read_vertices(element)?,
            "face" => reader.read_faces(element)?,
            _ => reader.skip_element(element)?,
        }
    }
    if reader.binary.is_none() {
        reader.cursor.skip_space();
    }
    reader.parsed.note_trailing(reader.cursor.remaining(), "the last element declared");
    Ok(reader.parsed)
}

impl PlyReader<'_, '_> {
    fn bad(&self, detail: impl Into<String>) -> FormatError {
        match self.binary {
            Some(_) => self.cursor.bad_bytes(detail),
            None => self.cursor.bad_line(detail),
        }
    }

    fn check_count(&self, element: &Element) -> Result<(), FormatError> {
        match element.name.as_str() {
            "vertex" => self.limits.check_nodes(element.count)?,
            "face" => self.limits.check_triangles(element.count)?,
            _ => {}
        }
        if element.properties.is_empty() && element.count > 0 {
            return Err(FormatError::Limits {
                what: "rows of an element without properties",
                declared: element.count,
                limit: 0,
            });
        }
        if self.binary.is_none() {
            let words = element.properties.len() as u64;
            return self.cursor.expect_words(element.count.saturating_mul(words));
        }
        let mut ahead = self.cursor.clone();
        let rows = ahead.take_records(element.count, element.bytes_at_least());
        rows.map(|_| ())
    }

    fn real(&mut self, scalar: Scalar) -> Result<f64, FormatError> {
        match self.binary {
            Some(order) => Ok(scalar.real(self.cursor.take(scalar.size())?, order)),
            None => self.cursor.real("a number"),
        }
    }

    fn integer(&mut self, scalar: Scalar) -> Result<i64, FormatError> {
        match self.binary {
            Some(order) => Ok(scalar.integer(self.cursor.take(scalar.size())?, order)),
            None => self.cursor.integer("an integer"),
        }
    }

    fn list_length(&mut self, count: Scalar) -> Result<u64, FormatError> {
        let length = self.integer(count)?;
        u64::try_from(length).map_err(|_| self.bad(format!("a list of length {length}")))
    }

    fn skip_list(&mut self, count: Scalar, item: Scalar) -> Result<(), FormatError> {
        let length = self.list_length(count)?;
        if self.binary.is_some() {
            return self.cursor.take_records(length, item.size()).map(|_| ());
        }
        for _ in 0..length {
            self.cursor.expect_word("a value")?;
        }
        Ok(())
    }

    fn read_vertices(&mut self, element: &Element) -> Result<(), FormatError> {
        let mut axes = [0; 3];
        for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
            let found = element.property(&[name]);
            *axis = found.ok_or_else(|| self.bad(format!("vertices have no {name}")))?;
        }
        let is_integer = |property: &usize| {
            let kind = element.properties[*property].kind;
            matches!(kind, PropertyKind::Single(scalar) if scalar.is_integer())
        };
        let node_id = element.property(&["node_id"]).filter(is_integer);
        let mut node_ids = room_for(node_id.map_or(0, |_| element.count as usize))?;
        self.parsed.points = room_for(element.count as usize)?;
        for _ in 0..element.count {
            let mut point = Vector::zeros();
            for (number, property) in element.properties.iter().enumerate() {
                let scalar = match property.kind {
                    PropertyKind::Single(scalar) => scalar,
                    PropertyKind::List { count, item } => {
                        self.skip_list(count, item)?;
                        continue;
                    }
                };
                let value = self.real(scalar)?;
                if let Some(axis) = axes.iter().position(|&axis| axis == number) {
                    point[axis] = value;
                } else if node_id == Some(number) {
                    node_ids.push(value as i64);
                }
            }
            self.parsed.points.push(point);
        }
        let others = element.properties.iter().enumerate();
        let others =
            others.filter(|(number, _)| !axes.contains(number) && node_id != Some(*number));
        for (_, property) in others {
            self.parsed.arrays.ignore_of_surface(ValuesOf::Points, &property.name);
        }
        if node_id.is_some() {
            self.parsed
                .arrays
                .points
                .push(NamedArray { name: "node_id".into(), values: Values::Integers(node_ids) });
        }
        Ok(())
    }

    fn read_faces(&mut self, element: &Element) -> Result<(), FormatError> {
        let indices = element.property(&["vertex_indices", "vertex_index"]);
        let Some(indices) = indices else {
            return Err(self.bad("faces have no vertex_indices"));
        };
        self.parsed.triangles = room_for(element.count as usize)?;
        let mut corners = Vec::new();
        for _ in 0..element.count {
            for (number, property) in element.properties.iter().enumerate() {
                match property.kind {
                    PropertyKind::List { count, item } if number == indices => {
                        let length = self.list_length(count)?;
                        self.limits.check_corners(length)?;
                        corners.clear();
                        for _ in 0..length {
                            corners.push(node_number(self.integer(item)?));
                        }
                        self.parsed.push_polygon(&corners, self.limits)?;
                    }
                    PropertyKind::List { count, item } => self.skip_list(count, item)?,
                    PropertyKind::Single(scalar) => {
                        self.real(scalar)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn skip_element(&mut self, element: &Element) -> Result<(), FormatError> {
        for _ in 0..element.count {
            for property in &element.properties {
                match property.kind {
                    PropertyKind::List { count, item } => self.skip_list(count, item)?,
                    PropertyKind::Single(scalar) => {
                        self.real(scalar)?;
                    }
                }
            }
        }
        let what = format!("rows of element {:.40}", element.name);
        self.parsed.note_skipped(element.count, &what);
        Ok(())
    }
}

/// Binary little-endian PLY with f64 positions, all arrays as properties, and the frame as a
/// comment. A vector array NAME becomes NAME_x, NAME_y, NAME_z.
pub fn write(output: &SurfaceOutput) -> Result<Vec<u8>, WriteError> {
    output.check()?;
    let surface = output.surface;
    let mut bytes = header(output).into_bytes();
    for (number, point) in surface.points.iter().enumerate() {
        put_reals(&mut bytes, point.as_slice());
        if let Some(node_ids) = &surface.node_ids {
            bytes.extend((node_ids[number] as i32).to_le_bytes());
        }
        for array in &output.point_arrays {
            match array.values {
                ArrayValues::Vectors(values) => put_reals(&mut bytes, values[number].as_slice()),
                ArrayValues::Tensors(values) => put_reals(&mut bytes, &values[number]),
                ArrayValues::Reals(values) => put_reals(&mut bytes, &values[number..=number]),
                ArrayValues::Integers(values) if fits_32_bits(values) => {
                    bytes.extend((values[number] as i32).to_le_bytes());
                }
                ArrayValues::Integers(values) => put_reals(&mut bytes, &[values[number] as f64]),
            }
        }
        if let Some(colours) = output.colours {
            bytes.extend(colours[number]);
        }
    }
    for triangle in &surface.triangles {
        bytes.push(3);
        for &corner in triangle {
            bytes.extend((corner as i32).to_le_bytes());
        }
    }
    Ok(bytes)
}

fn put_reals(bytes: &mut Vec<u8>, values: &[f64]) {
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

/// PLY has no integers of 64 bits; larger ones are written as doubles.
fn fits_32_bits(values: &[i64]) -> bool {
    values.iter().all(|&value| i32::try_from(value).is_ok())
}

fn header(output: &SurfaceOutput) -> String {
    let mut lines = vec![
        "ply".to_string(),
        "format binary_little_endian 1.0".into(),
        format!("comment SPACE={}", output.frame),
        "comment lengths in mm".into(),
    ];
    lines.extend(output.colour_scale.map(|scale| {
        format!("comment colours from {} to {} of {}", scale.low, scale.high, scale.array)
    }));
    lines.push(format!("element vertex {}", output.surface.points.len()));
    let mut property = |kind: &str, name: &str| lines.push(format!("property {kind} {name}"));
    for axis in ["x", "y", "z"] {
        property("double", axis);
    }
    if output.surface.node_ids.is_some() {
        property("int", "node_id");
    }
    for NamedValues { name, values } in &output.point_arrays {
        let name: String = name.split_whitespace().collect::<Vec<_>>().join("_");
        match values {
            ArrayValues::Vectors(_) => {
                for axis in ["x", "y", "z"] {
                    property("double", &format!("{name}_{axis}"));
                }
            }
            ArrayValues::Tensors(_) => {
                for of in TENSOR_COMPONENTS {
                    property("double", &format!("{name}_{of}"));
                }
            }
            ArrayValues::Integers(values) if fits_32_bits(values) => property("int", &name),
            ArrayValues::Reals(_) | ArrayValues::Integers(_) => property("double", &name),
        }
    }
    if output.colours.is_some() {
        for colour in ["red", "green", "blue"] {
            property("uchar", colour);
        }
    }
    lines.push(format!("element face {}", output.surface.triangles.len()));
    lines.push("property list uchar int vertex_indices".into());
    lines.push("end_header\n".into());
    lines.join("\n")
}
