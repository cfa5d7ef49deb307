//! A report as A4 pages, written as PDF.

use mechanics::chart::colour::{GRID, INK, WARN_INK};
use mechanics::chart::drawing::{Document, Rectangle, Run, Style};
use mechanics::chart::helvetica::lines;
use mechanics::chart::pdf::{PdfMetadata, pdf as written};

use super::content::{Block, Figure, Report, Section, Table};

/// In points.
const WIDTH: f64 = 595.28;
const HEIGHT: f64 = 841.89;
const MARGIN: f64 = 40.0;
pub const ROOM: f64 = WIDTH - 2.0 * MARGIN;
/// The end of a page above its foot.
const END: f64 = HEIGHT - 46.0;
pub const SIZE: f64 = 8.6;
pub const LINE: f64 = 11.2;
/// Share of a table's first column, and of that of facts.
const FIRST: f64 = 0.26;

pub fn pdf(report: Report) -> Vec<u8> {
    let Report { language, title, subtitle, notice, sections } = report;
    let mut pages =
        Pages { done: Vec::new(), page: Document::new(WIDTH, HEIGHT), y: MARGIN + 14.0 };
    pages.page.text([MARGIN, pages.y], ROOM, Style::of(18.0).bold(), &title);
    pages.y += 17.0;
    pages.sentence(&subtitle, Style::of(SIZE).faint(), 0.0);
    pages.sentence(&notice, Style::of(SIZE).bold().coloured(WARN_INK), 0.0);
    sections.into_iter().for_each(|section| pages.section(section));
    let mut all = pages.done;
    all.push(pages.page);
    let count = all.len();
    for (index, page) in all.iter_mut().enumerate() {
        let foot = [MARGIN, HEIGHT - 26.0];
        page.text(foot, ROOM - 40.0, Style::of(7.5).faint(), &format!("{notice} · {title}"));
        let number = format!("{} / {count}", index + 1);
        page.text([WIDTH - MARGIN, foot[1]], 40.0, Style::of(7.5).faint().end(), &number);
    }
    let about = PdfMetadata { title: &title, language: language.tag(), creator: "facies" };
    written(&all, &about)
}

/// Full pages, and the position on the last one.
struct Pages {
    done: Vec<Document>,
    page: Document,
    y: f64,
}

impl Pages {
    fn turn(&mut self) {
        let full = std::mem::replace(&mut self.page, Document::new(WIDTH, HEIGHT));
        self.done.push(full);
        self.y = MARGIN + 6.0;
    }

    /// Begins a new page if this height does not fit.
    fn need(&mut self, height: f64) {
        if self.y + height > END {
            self.turn();
        }
    }

    fn section(&mut self, section: Section) {
        if section.on_new_page {
            self.turn();
        }
        self.need(4.0 * LINE);
        self.y += 9.0;
        self.page.text([MARGIN, self.y], ROOM, Style::of(11.0).bold(), &section.heading);
        self.y += 13.0;
        section.blocks.into_iter().for_each(|block| self.block(block));
    }

    fn block(&mut self, block: Block) {
        match block {
            Block::Paragraph(words) => self.sentence(&words, Style::of(SIZE), 0.0),
            Block::List(entries) => {
                for words in entries {
                    self.need(LINE);
                    self.page.words([MARGIN + 2.0, self.y], Run::Level, Style::of(SIZE), "•");
                    self.sentence(&words, Style::of(SIZE), 11.0);
                }
            }
            Block::Table(table) => self.table(&table),
            Block::Figure(figure) => self.figure(figure),
            Block::Signature(names) => self.signature(&names),
        }
    }

    fn sentence(&mut self, words: &str, style: Style, indent: f64) {
        for line in lines(words, ROOM - indent, style.size, style.bold) {
            self.need(LINE);
            self.page.words([MARGIN + indent, self.y], Run::Level, style, &line);
            self.y += LINE;
        }
    }

    /// Lines side by side, each above its label.
    fn signature(&mut self, names: &[String]) {
        self.need(4.0 * LINE);
        self.y += 2.0 * LINE;
        let width = ROOM / names.len().max(1) as f64;
        for (at, name) in names.iter().enumerate() {
            let x = MARGIN + width * at as f64;
            let place = Rectangle { x, y: self.y - LINE, width: width - 14.0, height: 0.6 };
            self.page.rectangle(place, INK, 0.0);
            self.page.text([x, self.y], width, Style::of(SIZE).faint(), name);
        }
        self.y += LINE;
    }

    fn figure(&mut self, Figure { drawing, caption, height, .. }: Figure) {
        let most = height.min(END - MARGIN - 3.0 * LINE);
        let height = (ROOM * drawing.height / drawing.width).min(most);
        self.need(height + LINE);
        let width = height * drawing.width / drawing.height;
        let x = MARGIN + (ROOM - width) / 2.0;
        self.page.drawing(Rectangle { x, y: self.y - 6.0, width, height }, drawing);
        self.y += height + 6.0;
        self.sentence(&caption, Style::of(SIZE).faint(), 0.0);
    }

    fn table(&mut self, table: &Table) {
        let layout = Columns::of(table);
        if !table.columns.is_empty() {
            self.row(&table.columns, &layout, Style::of(SIZE).bold());
        }
        for row in &table.rows {
            self.row(row, &layout, Style::of(SIZE));
        }
        self.y += 3.0;
    }

    fn row(&mut self, cells: &[String], layout: &Columns, style: Style) {
        let cells: Vec<Vec<String>> = cells
            .iter()
            .enumerate()
            .map(|(column, words)| lines(words, layout.room(column), style.size, style.bold))
            .collect();
        let height = LINE * cells.iter().map(Vec::len).max().unwrap_or(1).max(1) as f64;
        self.need(height);
        for (column, cell) in cells.iter().enumerate() {
            let style = if layout.starts(column) { style } else { style.end() };
            for (line, words) in cell.iter().enumerate() {
                let at = [layout.place(column), self.y + LINE * line as f64];
                self.page.words(at, Run::Level, style, words);
            }
        }
        self.y += height;
        let rule = self.y - LINE + 3.0;
        let place = Rectangle { x: MARGIN, y: rule, width: ROOM, height: 0.5 };
        self.page.rectangle(place, GRID, 0.0);
        self.y += 1.4;
    }
}

/// The positions of the columns of a table, in points.
struct Columns {
    first: f64,
    other: f64,
    are_words: bool,
}

/// The text width of each column of a table, in points.
pub fn column_rooms(table: &Table) -> impl Fn(usize) -> f64 {
    let layout = Columns::of(table);
    move |column| layout.room(column)
}

impl Columns {
    fn of(table: &Table) -> Self {
        let columns = table.rows.iter().map(Vec::len).chain([table.columns.len()]).max();
        let others = columns.unwrap_or(1).saturating_sub(1).max(1) as f64;
        Columns {
            first: ROOM * FIRST,
            other: ROOM * (1.0 - FIRST) / others,
            are_words: table.columns.is_empty(),
        }
    }

    fn starts(&self, column: usize) -> bool {
        column == 0 || self.are_words
    }

    fn room(&self, column: usize) -> f64 {
        if column == 0 { self.first - 6.0 } else { self.other - 4.0 }
    }

    /// The left end of a column of words, the right end of one of numbers.
    fn place(&self, column: usize) -> f64 {
        match (column, self.are_words) {
            (0, _) => MARGIN,
            (column, true) => MARGIN + self.first + self.other * (column - 1) as f64,
            (column, false) => MARGIN + self.first + self.other * column as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::Language;

    fn report(rows: usize) -> Report {
        let rows = (0..rows).map(|row| vec![format!("row {row}"), "1.0".to_owned()]).collect();
        let table = Table::new(vec!["a".to_owned(), "b".to_owned()], rows);
        let mut second = Section::new("Second", vec![Block::Paragraph("words".to_owned())]);
        second.on_new_page = true;
        Report {
            language: Language::De,
            title: "T".to_owned(),
            subtitle: String::new(),
            notice: "not a medical device".to_owned(),
            sections: vec![Section::new("First", vec![Block::Table(table)]), second],
        }
    }

    #[test]
    fn a_section_may_start_a_page_and_a_long_table_goes_on_on_the_next() {
        for (rows, pages) in [(3, 2), (100, 3)] {
            let bytes = pdf(report(rows));
            let text = String::from_utf8_lossy(&bytes);
            assert!(text.contains(&format!("/Count {pages}")), "{rows} rows");
        }
    }
}
