//! Band of the runs without an answer over a chart of speed and accuracy, each with its reason in full.

use super::colour::FAILED_INK;
use super::drawing::{Document, Paint, Rectangle, Style, estimated_width, wrapped};
use super::ladder_content::LadderPicture;
use super::series::mark_data;
use super::symbol::Symbol;

/// Where it stands, and the lines of each reason.
pub struct FailureBand {
    place: Rectangle,
    /// From its left to the reasons.
    names: f64,
    reasons: Vec<Vec<String>>,
}

const LINE: f64 = 16.0;
/// Between two failures.
const GAP: f64 = 8.0;
/// Above the first failure, and below the band.
const HEAD: f64 = 28.0;
const BELOW: f64 = 10.0;
/// For the symbol.
const SYMBOL: f64 = 38.0;

const GROUND: &str = "#faeeee";

impl FailureBand {
    pub fn of(picture: &LadderPicture, [x, y]: [f64; 2], width: f64) -> Self {
        let (bold, style) = (Style::of(12.0).bold(), Style::of(12.0));
        let widths = picture.failures.iter().map(|failure| {
            estimated_width(&picture.full_name(failure.series, failure.level), bold)
        });
        let names = SYMBOL + (widths.fold(0.0, f64::max) + 14.0).min(0.5 * width);
        let room = width - names - 12.0;
        let reasons: Vec<Vec<String>> =
            picture.failures.iter().map(|failure| wrapped(&failure.reason, room, style)).collect();
        let lines: usize = reasons.iter().map(|lines| lines.len().max(1)).sum();
        let height = HEAD + LINE * lines as f64 + GAP * reasons.len() as f64;
        FailureBand { place: Rectangle { x, y, width, height }, names, reasons }
    }

    /// With the gap below it; nothing without failures.
    pub fn height(&self) -> f64 {
        if self.reasons.is_empty() { 0.0 } else { self.place.height + BELOW }
    }

    pub fn write(&self, document: &mut Document, picture: &LadderPicture) {
        if self.reasons.is_empty() {
            return;
        }
        let Rectangle { x, y, width, .. } = self.place;
        document.rectangle(self.place, GROUND, 4.0);
        let heading = "no answer: refused, diverged or out of budget";
        document.text([x + 12.0, y + 19.0], width - 24.0, Style::of(12.0).bold(), heading);
        let mut y = y + HEAD + LINE;
        for (failure, lines) in picture.failures.iter().zip(&self.reasons) {
            let name = picture.full_name(failure.series, failure.level);
            let data = mark_data(picture.series, failure.series, failure.level);
            document.open_with("failure", &format!("{name}: {}", failure.reason), data);
            let (radius, filled) = picture.size(failure.level);
            let at = [x + 22.0, y - 4.0];
            Symbol::of(failure.series).draw(document, at, radius * 0.85, filled);
            write_cross(document, at);
            let style = Style::of(12.0);
            document.text([x + SYMBOL, y], self.names - SYMBOL - 4.0, style.bold(), &name);
            for (line, words) in lines.iter().enumerate() {
                let at = [x + self.names, y + LINE * line as f64];
                document.text(at, width - self.names, style.faint(), words);
            }
            document.close();
            y += LINE * lines.len().max(1) as f64 + GAP;
        }
    }
}

fn write_cross(document: &mut Document, [x, y]: [f64; 2]) {
    let (left, top, size) = (x - 8.0, y - 8.0, 16.0);
    let steps = format!("M{left:.1} {top:.1}l{size} {size}m0 -{size}l-{size} {size}");
    document.path(&steps, Paint::line(FAILED_INK, 1.8));
}
