//! Content of a report: headings, tables, pictures and sentences, independent of HTML and PDF.

use mechanics::chart::drawing::Document;

use crate::schema::Language;

/// A document for people.
pub struct Report {
    pub language: Language,
    pub title: String,
    /// Under the title: subject and date.
    pub subtitle: String,
    /// At the head and at the foot of everything.
    pub notice: String,
    pub sections: Vec<Section>,
}

pub struct Section {
    pub heading: String,
    /// Whether it starts a page.
    pub on_new_page: bool,
    pub blocks: Vec<Block>,
}

pub enum Block {
    Paragraph(String),
    List(Vec<String>),
    Table(Table),
    Figure(Figure),
    /// Lines to be filled in by hand, each with a label.
    Signature(Vec<String>),
}

/// Rows of words under their columns; the first column names the row.
pub struct Table {
    /// Empty for rows without column heads.
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
    /// The number always shown, for any available space.
    pub least: usize,
}

pub struct Figure {
    pub drawing: Document,
    pub title: String,
    pub caption: String,
    /// At most, in points, as printed.
    pub height: f64,
}

impl Figure {
    /// As large as its page permits.
    pub fn new(drawing: Document, title: &str, caption: String) -> Self {
        Figure { drawing, title: title.to_owned(), caption, height: f64::INFINITY }
    }
}

impl Table {
    pub fn new(columns: Vec<String>, rows: Vec<Vec<String>>) -> Self {
        Table { columns, rows, least: 1 }
    }
}

impl Section {
    pub fn new(heading: &str, blocks: Vec<Block>) -> Self {
        Section { heading: heading.to_owned(), on_new_page: false, blocks }
    }
}
