//! Page budget of a report: tables and lists of a page share its lines, and a figure has the remainder.
//!
//! Heights are in points, each the larger one of the HTML printed on A4 by a browser and of the PDF.

use mechanics::chart::helvetica::lines;

use super::content::{Block, Figure, Section, Table};
use super::pages::{LINE, ROOM, SIZE, column_rooms};
use super::words::{Words, filled};

/// Between title and foot.
const FIRST_PAGE: f64 = 672.0;
const NEXT_PAGE: f64 = 705.0;
const HEADING: f64 = 23.5;
const BESIDE_ROW: f64 = 2.0;
const BESIDE_BLOCK: f64 = 4.0;
const AROUND_FIGURE: f64 = 16.0;
const SIGNATURE: f64 = 44.0;
/// The least height of a figure, unless it is alone.
const FIGURE: f64 = 300.0;
/// Longer entries of a list are cut.
const LONGEST: usize = 600;

/// The sections with as many rows, entries and as large figures as fit, and the numbers of omitted ones.
pub fn fitted(mut sections: Vec<Section>, words: &Words) -> Vec<Section> {
    let mut first = 0;
    while first < sections.len() {
        let next = sections[first + 1..].iter().position(|section| section.on_new_page);
        let end = next.map_or(sections.len(), |next| first + 1 + next);
        let room = if first == 0 { FIRST_PAGE } else { NEXT_PAGE };
        fit(&mut sections[first..end], room, words);
        first = end;
    }
    sections
}

fn fit(page: &mut [Section], room: f64, words: &Words) {
    let headings = HEADING * page.len() as f64;
    let mut blocks: Vec<&mut Block> =
        page.iter_mut().flat_map(|section| &mut section.blocks).collect();
    for block in &mut blocks {
        if let Block::List(entries) = block {
            entries.iter_mut().for_each(|entry| *entry = clipped(entry, LONGEST));
        }
    }
    let fixed: f64 = blocks.iter().map(|block| fixed(block)).sum();
    let mut parts: Vec<Part> = blocks.iter().filter_map(|block| Part::of(block)).collect();
    let more = text(&filled(words.more, &["000".to_owned()]), ROOM, false) + BESIDE_ROW;
    let mut left = share(&mut parts, room - headings - fixed, more);
    let mut parts = parts.into_iter();
    for block in blocks {
        match block {
            Block::Table(Table { rows, .. }) => {
                let part = parts.next().unwrap_or_default();
                shorten(rows, part.shown, words, |told| vec![told]);
            }
            Block::List(entries) => {
                let part = parts.next().unwrap_or_default();
                shorten(entries, part.shown, words, |told| told);
            }
            Block::Figure(figure) => {
                let height = natural(figure).min(least(figure) + left.max(0.0));
                left -= height - least(figure);
                figure.height = height;
            }
            Block::Paragraph(_) | Block::Signature(_) => {}
        }
    }
}

fn shorten<Row>(rows: &mut Vec<Row>, shown: usize, words: &Words, told: impl Fn(String) -> Row) {
    if shown < rows.len() {
        let left = rows.len() - shown;
        rows.truncate(shown);
        rows.push(told(filled(words.more, &[left.to_string()])));
    }
}

/// A table or list: heights of its rows, and the number of shown ones.
#[derive(Default)]
struct Part {
    heights: Vec<f64>,
    shown: usize,
}

impl Part {
    fn of(block: &Block) -> Option<Self> {
        match block {
            Block::Table(table) => {
                let heights = table.rows.iter().map(|row| row_height(table, row, false)).collect();
                Some(Part { heights, shown: table.least.min(table.rows.len()) })
            }
            Block::List(entries) => {
                let height = |entry: &String| text(entry, ROOM - 13.0, false);
                Some(Part { heights: entries.iter().map(height).collect(), shown: 0 })
            }
            Block::Paragraph(_) | Block::Figure(_) | Block::Signature(_) => None,
        }
    }

    /// The height of one row more: the last one needs no line with the number of omitted ones.
    fn next(&self, more: f64) -> Option<f64> {
        let height = self.heights.get(self.shown)?;
        Some(if self.shown + 1 == self.heights.len() { height - more } else { *height })
    }
}

/// Shows one row more of the part with the fewest, as long as there is space; returns the remaining space. If there is not
/// even space for the least rows of each part, the tallest ones are dropped.
fn share(parts: &mut [Part], room: f64, more: f64) -> f64 {
    let taken = parts.iter().map(|part| {
        let is_cut = part.shown < part.heights.len();
        part.heights[..part.shown].iter().sum::<f64>() + if is_cut { more } else { 0.0 }
    });
    let mut left = room - taken.sum::<f64>();
    while left < 0.0 {
        let height = |part: &Part| part.shown.checked_sub(1).map_or(0.0, |last| part.heights[last]);
        let tallest = parts.iter_mut().max_by(|a, b| height(a).total_cmp(&height(b)));
        let Some(part) = tallest.filter(|part| part.shown > 0) else { return left };
        let is_whole = part.shown == part.heights.len();
        left += height(part) - if is_whole { more } else { 0.0 };
        part.shown -= 1;
    }
    loop {
        let fitting = parts.iter_mut().filter_map(|part| {
            let height = part.next(more)?;
            (height <= left).then_some((part, height))
        });
        let Some((part, height)) = fitting.min_by_key(|(part, _)| part.shown) else { return left };
        part.shown += 1;
        left -= height;
    }
}

/// The least height of a block.
fn fixed(block: &Block) -> f64 {
    BESIDE_BLOCK
        + match block {
            Block::Paragraph(words) => text(words, ROOM, false),
            Block::List(_) => 0.0,
            Block::Table(table) if table.columns.is_empty() => 0.0,
            Block::Table(table) => row_height(table, &table.columns, true),
            Block::Figure(figure) => {
                least(figure) + AROUND_FIGURE + text(&figure.caption, ROOM, false)
            }
            Block::Signature(_) => SIGNATURE,
        }
}

fn natural(figure: &Figure) -> f64 {
    ROOM * figure.drawing.height / figure.drawing.width
}

fn least(figure: &Figure) -> f64 {
    natural(figure).min(FIGURE)
}

fn text(words: &str, room: f64, bold: bool) -> f64 {
    LINE * lines(words, room, SIZE, bold).len().max(1) as f64
}

fn row_height(table: &Table, row: &[String], bold: bool) -> f64 {
    let rooms = column_rooms(table);
    let cells = row.iter().enumerate().map(|(column, words)| text(words, rooms(column), bold));
    cells.fold(LINE, f64::max) + BESIDE_ROW
}

/// A text of at most this many letters.
pub fn clipped(words: &str, most: usize) -> String {
    match words.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", &words[..end]),
        None => words.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::pages::pdf;
    use super::super::tables::{report, texts};
    use super::super::words::words;
    use super::*;
    use crate::schema::Language;
    use mechanics::chart::drawing::Document;

    fn table(rows: usize) -> Block {
        let rows = (0..rows).map(|row| vec![row.to_string(), "1.0".to_owned()]).collect();
        Block::Table(Table { columns: vec!["a".to_owned(), "b".to_owned()], rows, least: 1 })
    }

    fn rows(section: &Section) -> usize {
        match &section.blocks[0] {
            Block::Table(table) => table.rows.len(),
            Block::List(entries) => entries.len(),
            Block::Paragraph(_) | Block::Figure(_) | Block::Signature(_) => 0,
        }
    }

    #[test]
    fn long_tables_share_what_short_ones_leave() {
        let page = |counts: [usize; 3]| {
            let sections = counts.map(|count| Section::new("S", vec![table(count)]));
            fitted(sections.into(), words(Language::En))
        };
        let all = page([3, 5, 4]);
        assert_eq!([0, 1, 2].map(|at| rows(&all[at])), [3, 5, 4], "what fits is shown");
        let short = page([200, 4, 200]);
        let [first, second, third] = [0, 1, 2].map(|at| rows(&short[at]));
        assert!(second == 4 && first.abs_diff(third) <= 1, "{first} {second} {third}");
        assert!(first > 15 && first + third < 50, "{first} {third}");
        let Block::Table(own) = &short[0].blocks[0] else { panic!("a table") };
        let told = format!("and {} more, in result.json", 200 - (first - 1));
        assert_eq!(*own.rows.last().unwrap(), [told]);
    }

    #[test]
    fn rows_that_must_be_shown_are_shown_before_any_other() {
        let mut kept = table(12);
        if let Block::Table(own) = &mut kept {
            own.least = 12;
        }
        let sections = vec![Section::new("S", vec![table(300)]), Section::new("T", vec![kept])];
        let page = fitted(sections, words(Language::En));
        assert_eq!(rows(&page[1]), 12);
    }

    #[test]
    fn a_report_of_everything_has_two_pages() {
        let long = "a name that is rather long and goes on and on ".repeat(3);
        let wide = |rows: usize, columns: usize| {
            let row = [vec![long.clone()], vec!["12.3 front to the left".to_owned(); columns]];
            let head = vec!["a head of it".to_owned(); columns + 1];
            Block::Table(Table::new(head, vec![row.concat(); rows]))
        };
        let sentence = || Block::Paragraph("It says how sure the numbers are. ".repeat(20));
        let facts = (0..40).map(|row| vec![format!("SHA-256 of {row}"), "9f".repeat(32)]).collect();
        let facts = Block::Table(Table { columns: Vec::new(), rows: facts, least: 6 });
        let picture = Figure::new(Document::new(1000.0, 820.0), "Views", "Green line. ".repeat(20));
        let mut numbers = Section::new("Displacement", vec![wide(90, 6)]);
        numbers.on_new_page = true;
        let sections = vec![
            Section::new("Plan", vec![wide(60, 6), sentence()]),
            Section::new("Views", vec![Block::Figure(picture)]),
            numbers,
            Section::new("Landmarks", vec![wide(200, 6)]),
            Section::new("Measures", vec![wide(30, 3)]),
            Section::new("Comparison", vec![wide(50, 7)]),
            Section::new("How sure", vec![sentence()]),
            Section::new("Warnings", vec![Block::List(vec![long.repeat(30); 40])]),
            Section::new("Method", vec![sentence()]),
            Section::new("Provenance", vec![facts]),
        ];
        let bytes = pdf(report(Language::De, "Everything", texts([&*long]).concat(), sections));
        let text = String::from_utf8_lossy(&bytes);
        let pages = text
            .split("/Count ")
            .nth(1)
            .unwrap()
            .split(|letter: char| !letter.is_ascii_digit())
            .next();
        assert_eq!(pages, Some("2"));
    }
}
