//! The header of a PLY file: which elements follow, with which properties.
//!
//! Source: Turk, The PLY Polygon File Format, 1994.

use crate::format::cursor::Cursor;
use crate::format::error::FormatError;
use crate::format::scalar::{ByteOrder, Scalar};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PropertyKind {
    Single(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    pub name: String,
    pub kind: PropertyKind,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    pub fn property(&self, names: &[&str]) -> Option<usize> {
        let mut properties = self.properties.iter();
        properties.position(|property| names.contains(&property.name.as_str()))
    }

    /// The fewest bytes that one row takes in a binary file.
    pub fn bytes_at_least(&self) -> u64 {
        let sizes = self.properties.iter().map(|property| match property.kind {
            PropertyKind::Single(scalar) => scalar.size(),
            PropertyKind::List { count, .. } => count.size(),
        });
        sizes.sum()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    /// `None` for text.
    pub binary: Option<ByteOrder>,
    pub elements: Vec<Element>,
    pub comments: Vec<String>,
}

impl Header {
    pub fn read(cursor: &mut Cursor<'_>) -> Result<Header, FormatError> {
        let mut header = Header { binary: None, elements: Vec::new(), comments: Vec::new() };
        let mut has_format = false;
        cursor.line();
        loop {
            let Some(line) = cursor.text_line() else {
                return Err(cursor.bad_line("the file ends inside the header"));
            };
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words.as_slice() {
                [] => {}
                ["comment" | "obj_info", ..] => header.comments.push(line.to_string()),
                ["format", encoding, "1.0"] => {
                    has_format = true;
                    header.binary = match *encoding {
                        "ascii" => None,
                        "binary_little_endian" => Some(ByteOrder::Little),
                        "binary_big_endian" => Some(ByteOrder::Big),
                        _ => return Err(cursor.bad_line("an unknown encoding")),
                    };
                }
                ["element", name, count] => {
                    let what = "a number of elements";
                    let count = count.parse().map_err(|_| cursor.not_a_number(what, count))?;
                    header.elements.push(Element {
                        name: (*name).into(),
                        count,
                        properties: Vec::new(),
                    });
                }
                ["property", definition @ ..] => {
                    let property = read_property(cursor, definition)?;
                    match header.elements.last_mut() {
                        Some(element) => element.properties.push(property),
                        None => return Err(cursor.bad_line("a property before any element")),
                    }
                }
                ["end_header"] if has_format => return Ok(header),
                _ => return Err(cursor.bad_line("a header line that is not understood")),
            }
        }
    }
}

fn read_property(cursor: &Cursor<'_>, definition: &[&str]) -> Result<Property, FormatError> {
    let scalar = |name: &str| {
        scalar_from_name(name).ok_or_else(|| cursor.bad_line("an unknown property type"))
    };
    match definition {
        ["list", count, item, name] => {
            let (count, item) = (scalar(count)?, scalar(item)?);
            if !count.is_integer() {
                return Err(cursor.bad_line("the length of a list is an integer"));
            }
            Ok(Property { name: (*name).into(), kind: PropertyKind::List { count, item } })
        }
        [kind, name] => {
            Ok(Property { name: (*name).into(), kind: PropertyKind::Single(scalar(kind)?) })
        }
        _ => Err(cursor.bad_line("a property that is not understood")),
    }
}

fn scalar_from_name(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}
