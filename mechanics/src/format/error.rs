//! Errors in the bytes of a mesh.

use std::fmt;

/// Where in a file: text formats count lines from 1, binary ones bytes from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePosition {
    Line(u64),
    Offset(u64),
}

impl fmt::Display for FilePosition {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FilePosition::Line(line) => write!(formatter, "line {line}"),
            FilePosition::Offset(offset) => write!(formatter, "byte {offset}"),
        }
    }
}

/// Why a file was refused. Lists of nodes or cells are 0-based and hold the first ten.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FormatError {
    #[error("{format} file, {place}: {detail}")]
    Parse { format: &'static str, place: FilePosition, detail: String },
    #[error("the file holds cells that are not supported: {}", types.join(", "))]
    UnsupportedCells { types: Vec<String> },
    #[error("a name is refused: {detail}")]
    Name { detail: String },
    #[error("{declared} {what}, and {limit} is the limit")]
    Limits { what: &'static str, declared: u64, limit: u64 },
    #[error("a coordinate is {coordinate:e}, and {limit:e} is the limit")]
    Far { coordinate: f64, limit: f64 },
    #[error("memory does not hold {values} values")]
    Memory { values: u64 },
    #[error("{count} nodes have a coordinate that is not a finite number")]
    NonFinite { count: u64, first: Vec<u64> },
    #[error("{count} cells or triangles name a node that does not exist; there are {nodes} nodes")]
    IndexOutOfRange { count: u64, first: Vec<u64>, nodes: u64 },
    #[error("the mesh is empty: {detail}")]
    Empty { detail: String },
    #[error("all {count} {what} are degenerate: they enclose nothing")]
    Degenerate { what: &'static str, count: u64 },
    #[error("{count} of {of} {shape} cells are inverted or flat")]
    InvertedElements { shape: &'static str, count: u64, of: u64, first: Vec<u64> },
    #[error("the arrays decode to {declared} bytes or more, and {limit} bytes is the limit")]
    DecompressionLimit { declared: u64, limit: u64 },
    #[error("not a mesh file that is read here: {detail}")]
    UnsupportedFormat { detail: &'static str },
}

/// One named detail of an error, for a problem document.
#[derive(Clone, Debug, PartialEq)]
pub enum Member {
    Text(String),
    Count(u64),
    Number(f64),
    Counts(Vec<u64>),
    Texts(Vec<String>),
}

impl FormatError {
    /// The stable code of the error catalogue.
    pub fn code(&self) -> &'static str {
        match self {
            FormatError::Parse { .. }
            | FormatError::UnsupportedCells { .. }
            | FormatError::Name { .. } => "mesh-parse",
            FormatError::Limits { .. } | FormatError::Far { .. } | FormatError::Memory { .. } => {
                "mesh-limits"
            }
            FormatError::NonFinite { .. } => "mesh-nonfinite",
            FormatError::IndexOutOfRange { .. } => "mesh-index-out-of-range",
            FormatError::Empty { .. } => "mesh-empty",
            FormatError::Degenerate { .. } => "mesh-degenerate",
            FormatError::InvertedElements { .. } => "mesh-inverted-elements",
            FormatError::DecompressionLimit { .. } => "decompression-limit",
            FormatError::UnsupportedFormat { .. } => "unsupported-format",
        }
    }

    /// The numbers behind the sentence, by the names of the error catalogue.
    pub fn members(&self) -> Vec<(&'static str, Member)> {
        use Member::{Count, Counts, Number, Text, Texts};
        match self {
            FormatError::Parse { format, place, detail } => vec![
                ("format", Text((*format).into())),
                match place {
                    FilePosition::Line(line) => ("line", Count(*line)),
                    FilePosition::Offset(offset) => ("offset", Count(*offset)),
                },
                ("detail", Text(detail.clone())),
            ],
            FormatError::UnsupportedCells { types } => vec![("types", Texts(types.clone()))],
            FormatError::Name { detail } => vec![("detail", Text(detail.clone()))],
            FormatError::Limits { what, declared, limit } => vec![
                ("what", Text((*what).into())),
                ("declared", Count(*declared)),
                ("limit", Count(*limit)),
            ],
            FormatError::Far { coordinate, limit } => {
                vec![("declared", Number(*coordinate)), ("limit", Number(*limit))]
            }
            FormatError::Memory { values } => vec![("declared", Count(*values))],
            FormatError::NonFinite { count, first } => {
                vec![("count", Count(*count)), ("first", Counts(first.clone()))]
            }
            FormatError::IndexOutOfRange { count, first, nodes } => vec![
                ("count", Count(*count)),
                ("first", Counts(first.clone())),
                ("nodes", Count(*nodes)),
            ],
            FormatError::Empty { detail } => vec![("detail", Text(detail.clone()))],
            FormatError::Degenerate { what, count } => {
                vec![("what", Text((*what).into())), ("count", Count(*count))]
            }
            FormatError::InvertedElements { shape, count, of, first } => vec![
                ("shape", Text((*shape).into())),
                ("count", Count(*count)),
                ("of", Count(*of)),
                ("first", Counts(first.clone())),
            ],
            FormatError::DecompressionLimit { declared, limit } => {
                vec![("declared", Count(*declared)), ("limit", Count(*limit))]
            }
            FormatError::UnsupportedFormat { detail } => vec![("detail", Text((*detail).into()))],
        }
    }
}

/// Counts every offender and remembers the first ten.
#[derive(Default)]
pub(super) struct Offenders {
    pub count: u64,
    pub first: Vec<u64>,
}

impl Offenders {
    pub fn add(&mut self, number: usize) {
        self.count += 1;
        if self.first.len() < 10 {
            self.first.push(number as u64);
        }
    }
}
