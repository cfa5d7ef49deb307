//! VTK legacy files, text and binary: unstructured grids and poly data.
//!
//! Binary numbers are big-endian and start right behind the line that announces them. Up to
//! version 4.2 cells are lists that start with their length; from 5.0 on there are offsets.
//!
//! Source: VTK File Formats, docs.vtk.org, section "Simple Legacy Formats", and vtkDataReader.cxx.

use super::cells::{CellTable, as_vectors, split_counted_lists};
use crate::format::cursor::Cursor;
use crate::format::error::FormatError;
use crate::format::limits::{ReadLimits, room_for};
use crate::format::parsed::Parsed;
use crate::format::scalar::{ByteOrder, Scalar, node_number};

/// What the attributes that follow belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    Dataset,
    Points,
    Cells,
}

pub(super) struct LegacyReader<'a, 'l> {
    pub cursor: Cursor<'a>,
    pub limits: &'l ReadLimits,
    pub is_binary: bool,
    pub owner: Owner,
    /// How many points or cells the attributes are declared for.
    pub tuples: u64,
    pub parsed: Parsed,
    has_offsets: bool,
    types: Vec<u32>,
    ends: Vec<u32>,
    nodes: Vec<u32>,
    polygons: Option<(Vec<u32>, Vec<u32>)>,
}

pub(in crate::format) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let mut cursor = Cursor::new("VTK legacy", bytes);
    let mut parsed = Parsed::default();
    let version = cursor.text_line().unwrap_or_default();
    let major = version.rsplit(' ').next().and_then(|v| v.split('.').next());
    let has_offsets = major.and_then(|v| v.trim().parse().ok()) >= Some(5_u32);
    parsed.note_space_mark(&cursor.text_line().unwrap_or_default());
    let is_binary = match cursor.expect_word("ASCII or BINARY")? {
        word if word.eq_ignore_ascii_case("ASCII") => false,
        word if word.eq_ignore_ascii_case("BINARY") => true,
        _ => return Err(cursor.bad_line("expected ASCII or BINARY")),
    };
    let mut reader = LegacyReader {
        cursor,
        limits,
        is_binary,
        owner: Owner::Dataset,
        tuples: 0,
        parsed,
        has_offsets,
        types: Vec::new(),
        ends: Vec::new(),
        nodes: Vec::new(),
        polygons: None,
    };
    while let Some(word) = reader.cursor.word() {
        let keyword = String::from_utf8_lossy(word).to_ascii_uppercase();
        reader.read_section(&keyword)?;
    }
    reader.finish()
}

impl LegacyReader<'_, '_> {
    fn read_section(&mut self, keyword: &str) -> Result<(), FormatError> {
        match keyword {
            "DATASET" => {
                let kind = self.cursor.expect_word("a dataset")?.to_ascii_uppercase();
                if kind != "UNSTRUCTURED_GRID" && kind != "POLYDATA" {
                    let detail = "only UNSTRUCTURED_GRID and POLYDATA are read";
                    return Err(self.cursor.bad_line(detail));
                }
                Ok(())
            }
            "POINTS" => self.read_points(),
            "CELLS" => {
                (self.ends, self.nodes) = self.read_cell_lists()?;
                Ok(())
            }
            "CELL_TYPES" => self.read_cell_types(),
            "POLYGONS" => {
                self.polygons = Some(self.read_cell_lists()?);
                Ok(())
            }
            "VERTICES" => self.skip_cells("points"),
            "LINES" => self.skip_cells("lines"),
            "TRIANGLE_STRIPS" => self.skip_cells("triangle strips"),
            "POINT_DATA" => self.start_attributes(Owner::Points),
            "CELL_DATA" => self.start_attributes(Owner::Cells),
            _ => self.read_attribute(keyword),
        }
    }

    fn read_points(&mut self) -> Result<(), FormatError> {
        let count = self.cursor.unsigned("a number of points")?;
        self.limits.check_nodes(count)?;
        let scalar = self.scalar_type()?;
        self.parsed.points = as_vectors(&self.reals(scalar, count * 3)?);
        Ok(())
    }

    fn read_cell_types(&mut self) -> Result<(), FormatError> {
        let count = self.cursor.unsigned("a number of cells")?;
        self.limits.check_elements(count)?;
        self.types = self.integers(Scalar::I32, count, node_number)?;
        Ok(())
    }

    /// Where each cell ends, and the nodes of all.
    fn read_cell_lists(&mut self) -> Result<(Vec<u32>, Vec<u32>), FormatError> {
        let first = self.cursor.unsigned("a number of cells")?;
        let numbers = self.cursor.unsigned("a number of indices")?;
        if !self.has_offsets {
            self.limits.check_elements(first)?;
            let lists = self.integers(Scalar::I32, numbers, node_number)?;
            return split_counted_lists(&lists, first).map_err(|e| self.cursor.bad_line(e));
        }
        self.limits.check_elements(first.saturating_sub(1))?;
        self.expect_keyword("OFFSETS")?;
        let scalar = self.scalar_type()?;
        let mut ends = self.integers(scalar, first, node_number)?;
        if !ends.is_empty() {
            ends.remove(0);
        }
        self.expect_keyword("CONNECTIVITY")?;
        let scalar = self.scalar_type()?;
        let nodes = self.integers(scalar, numbers, node_number)?;
        Ok((ends, nodes))
    }

    fn skip_cells(&mut self, what: &str) -> Result<(), FormatError> {
        let (ends, _) = self.read_cell_lists()?;
        self.parsed.note_skipped(ends.len() as u64, what);
        Ok(())
    }

    pub fn expect_keyword(&mut self, keyword: &str) -> Result<(), FormatError> {
        let word = self.cursor.expect_word(keyword)?;
        if word.eq_ignore_ascii_case(keyword) {
            return Ok(());
        }
        Err(self.cursor.bad_line(format!("expected {keyword}")))
    }

    fn start_attributes(&mut self, owner: Owner) -> Result<(), FormatError> {
        let declared = self.cursor.unsigned("a number of values")?;
        let have = match owner {
            Owner::Points => self.parsed.points.len(),
            _ => self.types.len(),
        } as u64;
        if declared != have && (owner == Owner::Points || self.keeps_cell_arrays()) {
            let detail = format!("attributes for {declared}, but there are {have}");
            return Err(self.cursor.bad_line(detail));
        }
        self.limits.check_elements(declared)?;
        self.owner = owner;
        self.tuples = declared;
        Ok(())
    }

    /// Attributes of poly data belong to points, lines and polygons alike and are skipped.
    pub fn keeps_cell_arrays(&self) -> bool {
        !self.types.is_empty()
    }

    /// The type that a word names.
    pub fn scalar_type(&mut self) -> Result<Scalar, FormatError> {
        let word = self.cursor.expect_word("a data type")?;
        match word.to_ascii_lowercase().as_str() {
            "char" | "signed_char" | "vtktypeint8" => Ok(Scalar::I8),
            "unsigned_char" | "vtktypeuint8" => Ok(Scalar::U8),
            "short" | "vtktypeint16" => Ok(Scalar::I16),
            "unsigned_short" | "vtktypeuint16" => Ok(Scalar::U16),
            // VTK writes vtkIdType with four bytes, whatever it is in memory.
            "int" | "vtkidtype" | "vtktypeint32" => Ok(Scalar::I32),
            "unsigned_int" | "vtktypeuint32" => Ok(Scalar::U32),
            "long" | "long_long" | "vtktypeint64" => Ok(Scalar::I64),
            "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => Ok(Scalar::U64),
            "float" => Ok(Scalar::F32),
            "double" => Ok(Scalar::F64),
            _ => Err(self.cursor.bad_line("a data type that is not supported")),
        }
    }

    /// `count` values behind this line as real numbers.
    pub fn reals(&mut self, scalar: Scalar, count: u64) -> Result<Vec<f64>, FormatError> {
        if self.is_binary {
            return scalar.reals(self.binary(scalar, count)?, ByteOrder::Big);
        }
        self.cursor.expect_words(count)?;
        let mut values = room_for(count as usize)?;
        for _ in 0..count {
            values.push(self.cursor.real("a number")?);
        }
        Ok(values)
    }

    /// `count` values behind this line as integers.
    pub fn integers<T>(
        &mut self,
        scalar: Scalar,
        count: u64,
        convert: impl Fn(i64) -> T,
    ) -> Result<Vec<T>, FormatError> {
        if self.is_binary {
            return scalar.integers(self.binary(scalar, count)?, ByteOrder::Big, convert);
        }
        self.cursor.expect_words(count)?;
        let mut values = room_for(count as usize)?;
        for _ in 0..count {
            let value = self.cursor.integer("an integer")?;
            if !scalar.holds(value) {
                return Err(self.cursor.bad_line(format!("not a value of its type: {value}")));
            }
            values.push(convert(value));
        }
        Ok(values)
    }

    /// Moves past `count` values.
    pub fn skip(&mut self, scalar: Scalar, count: u64) -> Result<(), FormatError> {
        if self.is_binary {
            return self.binary(scalar, count).map(|_| ());
        }
        self.cursor.expect_words(count)?;
        for _ in 0..count {
            self.cursor.expect_word("a value")?;
        }
        Ok(())
    }

    fn binary(&mut self, scalar: Scalar, count: u64) -> Result<&[u8], FormatError> {
        self.cursor.line();
        self.cursor.take_records(count, scalar.size())
    }

    fn finish(mut self) -> Result<Parsed, FormatError> {
        if let Some((ends, nodes)) = self.polygons.take() {
            self.types = vec![7; ends.len()];
            (self.ends, self.nodes) = (ends, nodes);
        }
        if self.types.len() != self.ends.len() {
            let (types, cells) = (self.types.len(), self.ends.len());
            let detail = format!("{cells} cells, but {types} cell types");
            return Err(self.cursor.bad_line(detail));
        }
        let table = CellTable { types: self.types, ends: self.ends, nodes: self.nodes };
        let cursor = &self.cursor;
        table.move_to(&mut self.parsed, self.limits, |e| cursor.bad_line(e))?;
        Ok(self.parsed)
    }
}
