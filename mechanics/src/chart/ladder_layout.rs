//! Layout of a chart of speed and accuracy: its axes, and where its parts stand.

use super::axis::{LogAxis, duration};
use super::colour::{GRID, INK};
use super::drawing::{Document, Paint, Rectangle, Style, wrapped};
use super::ladder_content::LadderPicture;
use super::ladder_failures::FailureBand;
use super::ladder_legend::Legend;

pub const WIDTH: f64 = 1160.0;
const LEFT: f64 = 104.0;
pub const RIGHT: f64 = 306.0;
pub const HEAD: f64 = 92.0;
const LEAST_HEIGHT: f64 = 540.0;
const AXIS_FOOT: f64 = 66.0;
pub const NOTE_LINE: f64 = 17.0;

const FINE: &str = "#eceef1";

/// Where things stand.
pub struct Layout {
    pub height: f64,
    pub failures: FailureBand,
    pub plot: Rectangle,
    pub time: LogAxis,
    pub error: LogAxis,
    pub notes: Vec<String>,
}

impl Layout {
    pub fn of(picture: &LadderPicture) -> Self {
        let width = WIDTH - LEFT - RIGHT;
        let failures = FailureBand::of(picture, [LEFT, HEAD], width);
        let taken = failures.height();
        let legend = Legend::height(picture.shown().len()) - taken;
        let plot = Rectangle { x: LEFT, y: HEAD + taken, width, height: LEAST_HEIGHT.max(legend) };
        let foot = plot.y + plot.height;
        let runs = || picture.marks.iter().flat_map(|mark| mark.runs.iter().copied());
        let own = || picture.marks.iter().map(|mark| [mark.wall_s, mark.error_mm]);
        let all = || runs().chain(own());
        let time = LogAxis::covering(all().map(|run| run[0]), [plot.x, plot.x + plot.width]);
        let error = LogAxis::covering(all().map(|run| run[1]), [foot, plot.y]);
        let notes: Vec<String> = picture
            .notes
            .iter()
            .flat_map(|note| wrapped(note, WIDTH - 56.0, Style::of(11.5)))
            .collect();
        let height = foot + AXIS_FOOT + NOTE_LINE * notes.len() as f64 + 8.0;
        Layout { height, failures, plot, time, error, notes }
    }

    pub fn place(&self, wall_s: f64, error_mm: f64) -> [f64; 2] {
        [self.time.place(wall_s), self.error.place(error_mm)]
    }

    pub fn write_grid(&self, document: &mut Document) {
        let Rectangle { x, y, width, height } = self.plot;
        let (right, foot) = (x + width, y + height);
        for tick in self.time.ticks() {
            let at = self.time.place(tick.value);
            let ink = if tick.labelled { GRID } else { FINE };
            document.path(&format!("M{at:.1} {y:.1}L{at:.1} {foot:.1}"), Paint::line(ink, 1.0));
            if tick.labelled {
                let style = Style::of(12.5).middle();
                document.text([at, foot + 20.0], 80.0, style, &duration(tick.value));
            }
        }
        for tick in self.error.ticks() {
            let at = self.error.place(tick.value);
            let ink = if tick.labelled { GRID } else { FINE };
            document.path(&format!("M{x:.1} {at:.1}L{right:.1} {at:.1}"), Paint::line(ink, 1.0));
            if tick.labelled {
                let words = format!("{} mm", tick.value);
                document.text([x - 8.0, at + 4.5], 70.0, Style::of(12.5).end(), &words);
            }
        }
        let frame = format!("M{x:.1} {y:.1}H{right:.1}V{foot:.1}H{x:.1}Z");
        document.path(&frame, Paint::line(INK, 1.2));
        let axis = Style::of(13.0).bold();
        let below = foot + 46.0;
        let words = "wall time of one prediction on one thread";
        document.text([x + width / 2.0, below], width, axis.middle(), words);
        document.text([x, below], 120.0, Style::of(12.5).faint(), "← faster");
        document.text([right, below], 120.0, Style::of(12.5).faint().end(), "slower →");
        let words = "error of the skin, 95th percentile by area: lower is better";
        document.text_upwards([24.0, y + height / 2.0], height, axis, words);
    }
}
