//! Estimated against true error: each answer a mark, on the diagonal where the estimate is right, between the dashed lines where
//! it is within a factor of two.

use super::axis::LogAxis;
use super::colour::{FRONT, GRID, INK};
use super::drawing::{Document, Paint, Rectangle, Style, wrapped};
use super::series::{MethodSeries, mark_data};
use super::symbol::Symbol;

/// Content of the picture.
pub struct EstimatesPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    /// The methods of the study, in the order of the legend, which has those with marks.
    pub series: &'a [MethodSeries],
    pub marks: &'a [EstimateMark],
    /// Lines for the foot of the picture.
    pub notes: &'a [String],
}

/// One answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateMark {
    /// Its place in `series`.
    pub series: usize,
    /// How often each edge of the mesh was halved.
    pub level: u32,
    /// Mean errors over the skin in mm.
    pub true_mm: f64,
    pub estimated_mm: f64,
}

const WIDTH: f64 = 1160.0;
const SIDE: f64 = 640.0;
const LEFT: f64 = 104.0;
const HEAD: f64 = 92.0;
const FOOT: f64 = 66.0;
const NOTE_LINE: f64 = 17.0;
const LEGEND_LINE: f64 = 23.0;

impl EstimatesPicture<'_> {
    pub fn to_drawing(&self) -> Document {
        let room = WIDTH - 56.0;
        let small = Style::of(11.5);
        let notes: Vec<String> =
            self.notes.iter().flat_map(|note| wrapped(note, room, small)).collect();
        let height = HEAD + SIDE + FOOT + NOTE_LINE * notes.len() as f64 + 8.0;
        let mut document = Document::new(WIDTH, height);
        document.text([28.0, 40.0], room, Style::of(22.0).bold(), self.title);
        document.text([28.0, 64.0], room, Style::of(13.0).faint(), self.subtitle);
        let across = self.axis([LEFT, LEFT + SIDE]);
        let upwards = LogAxis { from: HEAD + SIDE, to: HEAD, ..across };
        write_grid(&mut document, across, upwards);
        for (ratio, dashes) in [(1.0, ""), (0.5, "6 4"), (2.0, "6 4")] {
            let from = f64::max(across.low, across.low / ratio);
            let to = f64::min(across.high, across.high / ratio);
            let [from, to] = [from, to].map(|x| [across.place(x), upwards.place(ratio * x)]);
            let line = format!("M{:.1} {:.1}L{:.1} {:.1}", from[0], from[1], to[0], to[1]);
            document.path(&line, Paint { dashes, ..Paint::line(FRONT, 1.6) });
        }
        for mark in self.marks {
            let name = self.series.get(mark.series).map_or("?", |series| series.name.as_str());
            let EstimateMark { true_mm, estimated_mm, .. } = mark;
            let words = format!("{name}: estimated {estimated_mm:.4} mm, true {true_mm:.4} mm");
            document.open_with("mark", &words, mark_data(self.series, mark.series, mark.level));
            let at = [across.place(*true_mm), upwards.place(*estimated_mm)];
            Symbol::of(mark.series).draw(&mut document, at, 4.5, 0.5);
            document.close();
        }
        self.write_legend(&mut document, LEFT + SIDE + 40.0);
        for (line, words) in notes.iter().enumerate() {
            let y = height - 14.0 - NOTE_LINE * (notes.len() - 1 - line) as f64;
            document.text([28.0, y], room, small.faint(), words);
        }
        document
    }

    /// The same range on both axes, so that the diagonal is where both are equal.
    fn axis(&self, ends: [f64; 2]) -> LogAxis {
        LogAxis::covering(
            self.marks.iter().flat_map(|mark| [mark.true_mm, mark.estimated_mm]),
            ends,
        )
    }

    fn write_legend(&self, document: &mut Document, x: f64) {
        let room = WIDTH - x - 28.0;
        let mut y = HEAD + 14.0;
        document.text([x, y], room, Style::of(13.0).bold(), "method");
        let words = Style::of(12.5);
        let is_drawn = |place: usize| self.marks.iter().any(|mark| mark.series == place);
        for (place, series) in self.series.iter().enumerate().filter(|(place, _)| is_drawn(*place))
        {
            y += LEGEND_LINE;
            series.write_entry(document, place, [x, y], room);
        }
        for (dashes, name) in
            [("", "estimate and error are equal"), ("6 4", "a factor of two apart")]
        {
            y += 1.3 * LEGEND_LINE;
            let line = format!("M{x:.1} {:.1}h18", y - 4.0);
            document.path(&line, Paint { dashes, ..Paint::line(FRONT, 1.6) });
            document.text([x + 26.0, y], room - 26.0, words, name);
        }
    }
}

fn write_grid(document: &mut Document, across: LogAxis, upwards: LogAxis) {
    let Rectangle { x, y, width, height } =
        Rectangle { x: LEFT, y: HEAD, width: SIDE, height: SIDE };
    let (right, foot) = (x + width, y + height);
    for tick in across.ticks().into_iter().filter(|tick| tick.labelled) {
        let at = [across.place(tick.value), upwards.place(tick.value)];
        let words = format!("{} mm", tick.value);
        document.path(&format!("M{:.1} {y:.1}V{foot:.1}", at[0]), Paint::line(GRID, 1.0));
        document.path(&format!("M{x:.1} {:.1}H{right:.1}", at[1]), Paint::line(GRID, 1.0));
        document.text([at[0], foot + 20.0], 80.0, Style::of(12.5).middle(), &words);
        document.text([x - 8.0, at[1] + 4.5], 80.0, Style::of(12.5).end(), &words);
    }
    let frame = format!("M{x:.1} {y:.1}H{right:.1}V{foot:.1}H{x:.1}Z");
    document.path(&frame, Paint::line(INK, 1.2));
    let axis = Style::of(13.0).bold();
    let (below, beside) = ([x + width / 2.0, foot + 46.0], [24.0, y + height / 2.0]);
    document.text(below, width, axis.middle(), "true mean error of the skin");
    document.text_upwards(beside, height, axis, "estimated mean error of the skin");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing::Item;

    #[test]
    fn equal_errors_lie_on_the_diagonal_and_twice_the_error_on_a_dashed_line() {
        let series = ["linear FEM", "fem", "fem_linear"].map(str::to_owned);
        let [name, label, method] = series;
        let series = [MethodSeries { name, label, method }];
        let marks = [(0.1, 0.1), (0.2, 0.4)].map(|(true_mm, estimated_mm)| EstimateMark {
            series: 0,
            level: 0,
            true_mm,
            estimated_mm,
        });
        let picture = EstimatesPicture {
            title: "",
            subtitle: "",
            series: &series,
            marks: &marks,
            notes: &[],
        };
        let across = picture.axis([LEFT, LEFT + SIDE]);
        let upwards = LogAxis { from: HEAD + SIDE, to: HEAD, ..across };
        let [equal, twice] =
            marks.map(|mark| [across.place(mark.true_mm), upwards.place(mark.estimated_mm)]);
        // The plot is a square.
        assert!((equal[0] - LEFT - (HEAD + SIDE - equal[1])).abs() < 1e-9);
        let lines: Vec<(Vec<f64>, String)> = picture
            .to_drawing()
            .items
            .into_iter()
            .filter_map(|item| match item {
                Item::Path { steps, paint } if paint.stroke == FRONT && steps.contains('L') => {
                    let numbers = steps[1..].split(['L', ' ']).map(|n| n.parse().unwrap());
                    Some((numbers.collect(), paint.dashes))
                }
                _ => None,
            })
            .collect();
        let above = lines.iter().filter(|(_, dashes)| !dashes.is_empty()).map(|(ends, _)| {
            let [x0, y0, x1, y1] = ends.as_slice() else { panic!("{ends:?}") };
            (y0 + (y1 - y0) * (twice[0] - x0) / (x1 - x0) - twice[1]).abs()
        });
        // Places are written to a tenth.
        assert!(above.fold(f64::INFINITY, f64::min) < 0.2);
    }
}
