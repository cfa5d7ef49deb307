//! Content of a report: headings, tables, pictures and sentences, before they are HTML or pages.

use mechanics::chart::drawing::Document;

use crate::schema::Language;

/// A document for people.
pub struct Report {
    pub language: Language,
    pub title: String,
    /// Under the title: what of, when.
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
}

/// Rows of words under their columns; the first column names the row.
pub struct Table {
    /// Empty for rows that say all themselves.
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

pub struct Figure {
    pub drawing: Document,
    pub title: String,
    pub caption: String,
}

impl Section {
    pub fn new(heading: &str, blocks: Vec<Block>) -> Self {
        Section { heading: heading.to_owned(), on_new_page: false, blocks }
    }
}
