//! The elements of a VTK XML file, in one pass and without decoding any array.
//!
//! Entities and document type declarations are refused, nesting is bounded, and nothing outside
//! the file is ever read.
//!
//! Source: VTK File Formats, docs.vtk.org, section "XML File Formats".

use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::format::cursor::{Cursor, find};
use crate::format::error::{FilePosition, FormatError};
use crate::format::scalar::{ByteOrder, Scalar};

const DEEPEST: usize = 32;
const MOST_ARRAYS: usize = 10_000;

/// The element that an array stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    FieldData,
    PointData,
    CellData,
    Points,
    Cells,
    Verts,
    Lines,
    Strips,
    Polys,
}

impl Section {
    fn from_name(name: &str) -> Option<Section> {
        Some(match name {
            "FieldData" => Section::FieldData,
            "PointData" => Section::PointData,
            "CellData" => Section::CellData,
            "Points" => Section::Points,
            "Cells" => Section::Cells,
            "Verts" => Section::Verts,
            "Lines" => Section::Lines,
            "Strips" => Section::Strips,
            "Polys" => Section::Polys,
            _ => return None,
        })
    }
}

#[derive(Clone, Debug)]
pub(super) enum Content<'a> {
    Ascii(&'a str),
    Inline(&'a str),
    Appended(u64),
}

/// An array that has not been decoded.
#[derive(Clone, Debug)]
pub(super) struct DataArray<'a> {
    pub section: Section,
    pub name: String,
    /// `None` for text and for types that VTK may add.
    pub scalar: Option<Scalar>,
    pub components: u64,
    pub content: Content<'a>,
    /// Where its text starts in the file.
    pub offset: u64,
}

#[derive(Clone, Debug)]
pub(super) enum Appended<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

pub(super) struct Document<'a> {
    pub format: &'static str,
    pub order: ByteOrder,
    /// Size of the numbers in the header of a binary array, 4 or 8.
    pub header: Scalar,
    pub compressed: bool,
    pub points: u64,
    /// Cells of an unstructured grid; polygons of poly data.
    pub cells: u64,
    pub arrays: Vec<DataArray<'a>>,
    pub appended: Option<Appended<'a>>,
    /// What follows the end of a document without appended data, from the first that is neither white space nor a comment.
    pub after: &'a [u8],
}

impl<'a> Document<'a> {
    pub fn parse(format: &'static str, bytes: &'a [u8]) -> Result<Document<'a>, FormatError> {
        let (head, tail) = split_at_appended(bytes);
        let head = std::str::from_utf8(head).map_err(|error| FormatError::Parse {
            format,
            place: FilePosition::Offset(error.valid_up_to() as u64),
            detail: "the text is not UTF-8".into(),
        })?;
        let mut parser = Parser {
            reader: Reader::from_str(head),
            open: Vec::new(),
            is_closed: false,
            pieces: 0,
            is_appended_base64: false,
            document: Document {
                format,
                order: ByteOrder::Little,
                header: Scalar::U32,
                compressed: false,
                points: 0,
                cells: 0,
                arrays: Vec::new(),
                appended: None,
                after: &[],
            },
        };
        if let Some(end) = parser.run(tail.is_some())? {
            parser.document.after = head.as_bytes().get(end as usize..).unwrap_or_default();
        }
        if let Some(tail) = tail {
            parser.document.appended = Some(parser.appended(tail)?);
        }
        Ok(parser.document)
    }

    /// The arrays of one section.
    pub fn arrays_in(&self, section: Section) -> impl Iterator<Item = &DataArray<'a>> {
        let arrays = self.arrays.iter();
        arrays.filter(move |array| array.section == section)
    }

    /// The array of a section by its name.
    pub fn array(&self, section: Section, name: &str) -> Result<&DataArray<'a>, FormatError> {
        self.arrays_in(section).find(|array| array.name.eq_ignore_ascii_case(name)).ok_or_else(
            || FormatError::Parse {
                format: self.format,
                place: FilePosition::Offset(0),
                detail: format!("{section:?} has no array {name:?}"),
            },
        )
    }
}

/// The XML up to and with the start tag of the appended data, and what follows it.
fn split_at_appended(bytes: &[u8]) -> (&[u8], Option<&[u8]>) {
    let Some(start) = find(bytes, b"<AppendedData") else {
        return (bytes, None);
    };
    match find(&bytes[start..], b">") {
        Some(length) => {
            let (head, tail) = bytes.split_at(start + length + 1);
            (head, Some(tail))
        }
        None => (bytes, None),
    }
}

struct Parser<'a> {
    reader: Reader<&'a [u8]>,
    /// Names of the open elements, and whether each is an array.
    open: Vec<(Option<Section>, bool)>,
    /// Whether the element that holds all others has ended.
    is_closed: bool,
    pieces: usize,
    is_appended_base64: bool,
    document: Document<'a>,
}

impl<'a> Parser<'a> {
    fn bad(&self, detail: impl Into<String>) -> FormatError {
        FormatError::Parse {
            format: self.document.format,
            place: FilePosition::Offset(self.reader.buffer_position()),
            detail: detail.into(),
        }
    }

    /// Where something follows the end of the document, if anything does.
    fn run(&mut self, has_appended: bool) -> Result<Option<u64>, FormatError> {
        let mut after = None;
        loop {
            let at = self.reader.buffer_position();
            let event = self.reader.read_event().map_err(|error| self.bad(error.to_string()))?;
            if self.is_closed && !may_follow(&event) {
                after = after.or(Some(at));
            }
            match event {
                Event::Start(tag) => {
                    self.start(&tag)?;
                    if tag.name().as_ref() == "AppendedData" && has_appended {
                        return Ok(None);
                    }
                }
                Event::Empty(tag) => {
                    self.start(&tag)?;
                    self.end();
                }
                Event::End(_) => self.end(),
                Event::Text(text) => self.text(text.into_inner()),
                Event::DocType(_) => return Err(self.bad("document types are refused")),
                Event::GeneralRef(_) | Event::CData(_) if self.is_in_array() => {
                    return Err(self.bad("entities and CDATA are refused in arrays"));
                }
                Event::Eof if self.open.is_empty() => return Ok(after),
                Event::Eof => return Err(self.bad("the file ends inside an element")),
                _ => {}
            }
        }
    }

    fn end(&mut self) {
        self.open.pop();
        self.is_closed |= self.open.is_empty();
    }

    fn is_in_array(&self) -> bool {
        self.open.last().is_some_and(|(_, is_array)| *is_array)
    }

    fn start(&mut self, tag: &BytesStart<'_>) -> Result<(), FormatError> {
        if self.open.len() >= DEEPEST {
            return Err(self.bad(format!("elements are nested deeper than {DEEPEST}")));
        }
        let name = tag.name();
        let name: &str = name.as_ref();
        let parent = self.open.last().and_then(|(section, _)| *section);
        let is_array = matches!(name, "DataArray" | "Array") && parent.is_some();
        match name {
            "VTKFile" => self.read_file_attributes(tag)?,
            "Piece" => self.read_piece(tag)?,
            "AppendedData" => {
                self.is_appended_base64 =
                    self.attribute(tag, "encoding")?.as_deref() == Some("base64");
            }
            _ => {}
        }
        if is_array && let Some(section) = parent {
            self.read_array(tag, section)?;
        }
        self.open.push((Section::from_name(name), is_array));
        Ok(())
    }

    fn attribute(&self, tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, FormatError> {
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|error| self.bad(error.to_string()))?;
            if attribute.key.as_ref() == name {
                let value = attribute
                    .normalized_value(quick_xml::XmlVersion::Explicit1_0)
                    .map_err(|error| self.bad(error.to_string()))?;
                return Ok(Some(value.into_owned()));
            }
        }
        Ok(None)
    }

    fn number(&self, tag: &BytesStart<'_>, name: &str) -> Result<Option<u64>, FormatError> {
        let Some(text) = self.attribute(tag, name)? else {
            return Ok(None);
        };
        let parsed = text.trim().parse();
        parsed
            .map(Some)
            .map_err(|_| self.bad(format!("{name} is not a count: {:?}", shortened(&text))))
    }

    fn read_file_attributes(&mut self, tag: &BytesStart<'_>) -> Result<(), FormatError> {
        self.document.order = match self.attribute(tag, "byte_order")?.as_deref() {
            None | Some("LittleEndian") => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(other) => return Err(self.bad(format!("byte order {:?}", shortened(other)))),
        };
        self.document.header = match self.attribute(tag, "header_type")?.as_deref() {
            None | Some("UInt32") => Scalar::U32,
            Some("UInt64") => Scalar::U64,
            Some(other) => return Err(self.bad(format!("header type {:?}", shortened(other)))),
        };
        self.document.compressed = match self.attribute(tag, "compressor")?.as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                let detail = format!("compressor {:?}; only zlib is read", shortened(other));
                return Err(self.bad(detail));
            }
        };
        Ok(())
    }

    fn read_piece(&mut self, tag: &BytesStart<'_>) -> Result<(), FormatError> {
        self.pieces += 1;
        if self.pieces > 1 {
            return Err(self.bad("the file has several pieces; merge them into one"));
        }
        self.document.points = self.number(tag, "NumberOfPoints")?.unwrap_or(0);
        let cells = self.number(tag, "NumberOfCells")?;
        let polygons = self.number(tag, "NumberOfPolys")?;
        self.document.cells = cells.or(polygons).unwrap_or(0);
        Ok(())
    }

    fn read_array(&mut self, tag: &BytesStart<'_>, section: Section) -> Result<(), FormatError> {
        if self.document.arrays.len() >= MOST_ARRAYS {
            return Err(self.bad(format!("more than {MOST_ARRAYS} arrays")));
        }
        let type_name = self.attribute(tag, "type")?.unwrap_or_default();
        let content = match self.attribute(tag, "format")?.as_deref() {
            Some("ascii") | None => Content::Ascii(""),
            Some("binary") => Content::Inline(""),
            Some("appended") => match self.number(tag, "offset")? {
                Some(offset) => Content::Appended(offset),
                None => return Err(self.bad("an appended array has no offset")),
            },
            Some(other) => return Err(self.bad(format!("array format {:?}", shortened(other)))),
        };
        let array = DataArray {
            section,
            name: self.attribute(tag, "Name")?.unwrap_or_default(),
            scalar: scalar_from_name(&type_name),
            components: self.number(tag, "NumberOfComponents")?.unwrap_or(1).max(1),
            content,
            offset: self.reader.buffer_position(),
        };
        self.document.arrays.push(array);
        Ok(())
    }

    /// Gives the text that stands directly in an array to it.
    fn text(&mut self, text: std::borrow::Cow<'a, str>) {
        let std::borrow::Cow::Borrowed(text) = text else {
            return;
        };
        if !self.is_in_array() || text.trim_ascii().is_empty() {
            return;
        }
        if let Some(array) = self.document.arrays.last_mut() {
            match &mut array.content {
                Content::Ascii(content) | Content::Inline(content) if content.is_empty() => {
                    *content = text;
                }
                _ => {}
            }
        }
    }

    fn appended(&self, tail: &'a [u8]) -> Result<Appended<'a>, FormatError> {
        let mut cursor = Cursor::new(self.document.format, tail);
        cursor.skip_space();
        if cursor.take(1)? != b"_" {
            return Err(self.bad("appended data starts with an underscore"));
        }
        Ok(match self.is_appended_base64 {
            true => Appended::Base64(cursor.rest()),
            false => Appended::Raw(cursor.rest()),
        })
    }
}

/// Whether this may follow the end of a document.
fn may_follow(event: &Event<'_>) -> bool {
    match event {
        Event::Text(text) => text.trim_ascii().is_empty(),
        Event::Comment(_) | Event::PI(_) | Event::Eof => true,
        _ => false,
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

fn scalar_from_name(name: &str) -> Option<Scalar> {
    Some(match name {
        "Int8" => Scalar::I8,
        "UInt8" => Scalar::U8,
        "Int16" => Scalar::I16,
        "UInt16" => Scalar::U16,
        "Int32" => Scalar::I32,
        "UInt32" => Scalar::U32,
        "Int64" => Scalar::I64,
        "UInt64" => Scalar::U64,
        "Float32" => Scalar::F32,
        "Float64" => Scalar::F64,
        _ => return None,
    })
}
