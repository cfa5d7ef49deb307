//! Legend of a chart of speed and accuracy.

use super::colour::{FAILED_INK, FAINT_INK, FRONT};
use super::drawing::{Document, Paint, Style};
use super::series::MethodSeries;
use super::symbol::Symbol;

/// The legend beside the plot.
pub struct Legend<'a> {
    pub series: &'a [MethodSeries],
    /// The places of those that are drawn.
    pub shown: &'a [usize],
    /// Mesh levels that are drawn, ascending.
    pub levels: &'a [u32],
    pub has_failures: bool,
    /// Whether a mark stands out around another.
    pub has_rings: bool,
    pub has_runs: bool,
}

const LINE: f64 = 23.0;
const ROOM: f64 = 264.0;
/// For the levels, the front, rings, failures and runs below the methods.
const KEYS: f64 = 265.0;

impl Legend<'_> {
    /// How much height a legend of so many methods needs at most.
    pub fn height(series: usize) -> f64 {
        LINE * series as f64 + KEYS
    }

    pub fn write(&self, document: &mut Document, [x, y]: [f64; 2]) {
        let heading = Style::of(13.0).bold();
        let words = Style::of(12.5);
        let mut y = y + 14.0;
        document.text([x, y], ROOM, heading, "method");
        for (place, series) in self.shown.iter().filter_map(|&at| Some((at, self.series.get(at)?)))
        {
            y += LINE;
            series.write_entry(document, place, [x, y], ROOM);
        }
        y += LINE * 1.6;
        if self.levels.len() > 1 {
            y = self.write_levels(document, [x, y]) + LINE * 1.4;
        }
        let line = format!("M{x:.1} {:.1}h9v8h9", y - 8.0);
        document.path(&line, Paint { opacity: 0.85, ..Paint::line(FRONT, 2.0) });
        document.text([x + 26.0, y], ROOM - 26.0, words, "best compromises:");
        y += 16.0;
        document.text([x + 26.0, y], ROOM - 26.0, words, "none is better in both");
        if self.has_rings {
            y += LINE;
            let at = [x + 9.0, y - 4.0];
            Symbol::neutral().draw(document, at, 9.0, 0.35);
            Symbol::neutral().draw(document, at, 4.4, 1.0);
            document.text([x + 26.0, y], ROOM - 26.0, words, "several in nearly the same place");
        }
        if self.has_runs {
            y += LINE;
            let dot = format!("M{:.1} {:.1}a2 2 0 1 1 4 0a2 2 0 1 1 -4 0Z", x + 7.0, y - 4.0);
            document.path(&dot, Paint { opacity: 0.6, ..Paint::inside(FAINT_INK) });
            document.text([x + 26.0, y], ROOM - 26.0, words, "single run of a median");
        }
        if self.has_failures {
            y += LINE;
            let cross = format!("M{:.1} {:.1}l12 12m0 -12l-12 12", x + 3.0, y - 10.0);
            document.path(&cross, Paint::line(FAILED_INK, 1.8));
            document.text([x + 26.0, y], ROOM - 26.0, words, "gave no answer");
        }
    }

    /// From a height on; where the last line stands.
    fn write_levels(&self, document: &mut Document, [x, mut y]: [f64; 2]) -> f64 {
        document.text([x, y], ROOM, Style::of(13.0).bold(), "mesh");
        let last = (self.levels.len() - 1) as f64;
        for (place, level) in self.levels.iter().take(4).enumerate() {
            y += LINE;
            let neutral = Symbol::neutral();
            let place = place as f64;
            neutral.draw(document, [x + 9.0, y - 4.0], 6.2 + 1.3 * place, place / last);
            let words_of = match level {
                0 => "level 0: as given".to_owned(),
                1 => "level 1: halved once".to_owned(),
                2 => "level 2: halved twice".to_owned(),
                level => format!("level {level}: halved {level} times"),
            };
            document.text([x + 26.0, y], ROOM - 26.0, Style::of(12.5), &words_of);
        }
        y
    }
}
