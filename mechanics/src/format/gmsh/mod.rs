//! Gmsh meshes of version 2.2 and 4.1, text and binary, with physical groups.
//!
//! Node numbers may be sparse; they are mapped, never used as indices.
//!
//! Source: Gmsh Reference Manual, sections "MSH file format" and "Legacy formats".

mod elements;
mod groups;

use std::collections::HashMap;

use super::cursor::Cursor;
use super::error::FormatError;
use super::limits::{ReadLimits, room_for};
use super::parsed::Parsed;
use super::scalar::{ByteOrder, Scalar};
use crate::mesh::Vector;
use groups::Groups;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    Two,
    Four,
}

pub(super) struct GmshReader<'a, 'l> {
    pub cursor: Cursor<'a>,
    pub limits: &'l ReadLimits,
    pub version: Version,
    pub binary: Option<ByteOrder>,
    pub node_numbers: NodeNumbers,
    pub groups: Groups,
    pub parsed: Parsed,
}

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<Parsed, FormatError> {
    let mut reader = GmshReader {
        cursor: Cursor::new("Gmsh", bytes),
        limits,
        version: Version::Two,
        binary: None,
        node_numbers: NodeNumbers::default(),
        groups: Groups::default(),
        parsed: Parsed::default(),
    };
    while let Some(word) = reader.cursor.word() {
        let section = String::from_utf8_lossy(word).into_owned();
        let Some(name) = section.strip_prefix('$') else {
            return Err(reader.cursor.bad_line("expected a section like $Nodes"));
        };
        reader.cursor.line();
        reader.read_section(name)?;
        if !reader.cursor.skip_past_line(&format!("$End{name}")) {
            return Err(reader.bad(format!("section ${name} has no end")));
        }
    }
    let GmshReader { groups, mut parsed, .. } = reader;
    groups.move_to(&mut parsed);
    Ok(parsed)
}

impl GmshReader<'_, '_> {
    /// An error placed by byte in a binary file and by line otherwise.
    pub fn bad(&self, detail: impl Into<String>) -> FormatError {
        match self.binary {
            Some(_) => self.cursor.bad_bytes(detail),
            None => self.cursor.bad_line(detail),
        }
    }

    fn read_section(&mut self, name: &str) -> Result<(), FormatError> {
        match (name, self.version) {
            ("MeshFormat", _) => self.read_format(),
            ("PhysicalNames", _) => self.groups.read_names(&mut self.cursor),
            ("Entities", _) => self.read_entities(),
            ("ParametricNodes", Version::Two) => {
                Err(self.bad("parametric nodes are not read; save without them, or as version 4.1"))
            }
            ("Nodes", Version::Two) => self.read_nodes_2(),
            ("Nodes", Version::Four) => self.read_nodes_4(),
            ("Elements", Version::Two) => self.read_elements_2(),
            ("Elements", Version::Four) => self.read_elements_4(),
            _ => Ok(()),
        }
    }

    fn read_format(&mut self) -> Result<(), FormatError> {
        let version = self.cursor.expect_word("a version")?;
        self.version = match version {
            "2" | "2.1" | "2.2" => Version::Two,
            "4.1" => Version::Four,
            _ => {
                let shown: String = version.chars().take(10).collect();
                let detail = format!("version {shown:?}; 2.2 and 4.1 are read");
                return Err(self.cursor.bad_line(detail));
            }
        };
        let kind = self.cursor.unsigned("a file type")?;
        let size = self.cursor.unsigned("a data size")?;
        if kind > 1 || size != 8 {
            let detail = format!("file type {kind} with numbers of {size} bytes");
            return Err(self.cursor.bad_line(detail));
        }
        if kind == 1 {
            self.cursor.line();
            self.binary = match self.cursor.take_array()? {
                [1, 0, 0, 0] => Some(ByteOrder::Little),
                [0, 0, 0, 1] => Some(ByteOrder::Big),
                _ => return Err(self.cursor.bad_bytes("the byte order mark is not 1")),
            };
        }
        Ok(())
    }

    // Single values, as words or as bytes.

    pub fn int(&mut self) -> Result<i64, FormatError> {
        self.value(Scalar::I32)
    }

    pub fn size(&mut self) -> Result<u64, FormatError> {
        let value = self.value(Scalar::I64)?;
        u64::try_from(value).map_err(|_| self.bad(format!("{value} is not a count")))
    }

    fn value(&mut self, scalar: Scalar) -> Result<i64, FormatError> {
        match self.binary {
            Some(order) => Ok(scalar.integer(self.cursor.take(scalar.size())?, order)),
            None => self.cursor.integer("an integer"),
        }
    }

    pub fn real(&mut self) -> Result<f64, FormatError> {
        match self.binary {
            Some(order) => Ok(Scalar::F64.real(self.cursor.take(8)?, order)),
            None => self.cursor.real("a number"),
        }
    }

    /// Refuses a count of records for which the rest of the file is too short.
    pub fn expect_records(
        &self,
        count: u64,
        bytes_each: u64,
        words_each: u64,
    ) -> Result<(), FormatError> {
        if self.binary.is_none() {
            return self.cursor.expect_words(count.saturating_mul(words_each));
        }
        self.cursor.clone().take_records(count, bytes_each).map(|_| ())
    }

    fn point(&mut self) -> Result<Vector, FormatError> {
        Ok(Vector::new(self.real()?, self.real()?, self.real()?))
    }

    fn read_nodes_2(&mut self) -> Result<(), FormatError> {
        let count = self.cursor.unsigned("a number of nodes")?;
        self.limits.check_nodes(count)?;
        self.start_binary();
        self.expect_records(count, 28, 4)?;
        let mut numbers = room_for(count as usize)?;
        self.parsed.points = room_for(count as usize)?;
        for _ in 0..count {
            numbers.push(self.int()?);
            let point = self.point()?;
            self.parsed.points.push(point);
        }
        self.node_numbers = NodeNumbers::new(numbers).map_err(|e| self.bad(e))?;
        Ok(())
    }

    fn read_nodes_4(&mut self) -> Result<(), FormatError> {
        let (blocks, count) = (self.size()?, self.size()?);
        self.limits.check_nodes(count)?;
        self.expect_records(count, 32, 4)?;
        let (_lowest, _highest) = (self.size()?, self.size()?);
        let mut numbers = room_for(count as usize)?;
        self.parsed.points = room_for(count as usize)?;
        for _ in 0..blocks {
            let dimension = self.int()?;
            let (_entity, parametric) = (self.int()?, self.int()?);
            let in_block = self.size()?;
            if numbers.len() as u64 + in_block > count {
                return Err(self.bad(format!("more nodes than the {count} declared")));
            }
            for _ in 0..in_block {
                numbers.push(self.value(Scalar::I64)?);
            }
            let parameters = if parametric == 1 { dimension } else { 0 };
            for _ in 0..in_block {
                let point = self.point()?;
                self.parsed.points.push(point);
                for _ in 0..parameters.clamp(0, 3) {
                    self.real()?;
                }
            }
        }
        if (numbers.len() as u64) < count {
            let detail = format!("{count} nodes declared, {} found", numbers.len());
            return Err(self.bad(detail));
        }
        self.node_numbers = NodeNumbers::new(numbers).map_err(|e| self.bad(e))?;
        Ok(())
    }

    /// In version 2 a count stands as text on its own line before the binary values.
    pub fn start_binary(&mut self) {
        if self.binary.is_some() {
            self.cursor.line();
        }
    }

    fn read_entities(&mut self) -> Result<(), FormatError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = self.size()?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag = self.int()?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    self.real()?;
                }
                let groups = self.size()?;
                self.expect_records(groups, 4, 1)?;
                for _ in 0..groups {
                    let group = self.int()?;
                    self.groups.add_entity(dimension as u8, tag, group)?;
                }
                let bounding = if dimension == 0 { 0 } else { self.size()? };
                self.expect_records(bounding, 4, 1)?;
                for _ in 0..bounding {
                    self.int()?;
                }
            }
        }
        Ok(())
    }
}

/// The index of each node by the number that the file gives it.
#[derive(Debug)]
pub(super) enum NodeNumbers {
    /// Numbered without gaps from the first.
    Consecutive {
        first: i64,
        count: i64,
    },
    Sparse(HashMap<i64, u32>),
}

impl Default for NodeNumbers {
    fn default() -> Self {
        NodeNumbers::Consecutive { first: 1, count: 0 }
    }
}

impl NodeNumbers {
    fn new(numbers: Vec<i64>) -> Result<Self, String> {
        let first = numbers.first().copied().unwrap_or(1);
        let mut expected = numbers.iter().zip(0_i64..);
        if expected.all(|(&number, index)| first.checked_add(index) == Some(number)) {
            let count = numbers.len() as i64;
            return Ok(NodeNumbers::Consecutive { first, count });
        }
        let mut indices = HashMap::with_capacity(numbers.len());
        for (index, number) in numbers.into_iter().enumerate() {
            if indices.insert(number, index as u32).is_some() {
                return Err(format!("two nodes have the number {number}"));
            }
        }
        Ok(NodeNumbers::Sparse(indices))
    }

    /// The index of a node; `u32::MAX`, which the check of all indices finds, for an unknown one.
    pub fn index(&self, number: i64) -> u32 {
        match self {
            NodeNumbers::Consecutive { first, count } => match number.checked_sub(*first) {
                Some(index) if (0..*count).contains(&index) => index as u32,
                _ => u32::MAX,
            },
            NodeNumbers::Sparse(indices) => indices.get(&number).copied().unwrap_or(u32::MAX),
        }
    }
}
