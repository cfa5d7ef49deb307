//! Speed and accuracy: wall time and error of each method on each mesh on logarithmic axes. A line joins the Pareto
//! front; runs without an answer are in a band of their own with the reason.

use super::axis::{LogAxis, duration, numbers};
use super::callout::OccupiedAreas;
use super::colour::{FAILED_INK, FRONT, GRID, INK};
use super::drawing::{Document, Paint, Rectangle, Style, estimated_width, wrapped};
use super::ladder_legend::Legend;
use super::series::{MethodSeries, mark_data};
use super::symbol::Symbol;

/// Content of the picture.
pub struct LadderPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    /// The methods of the study, in the order of the legend, which has those with marks or failures.
    pub series: &'a [MethodSeries],
    pub marks: &'a [LadderMark],
    pub failures: &'a [LadderFailure],
    /// Lines for the foot of the picture.
    pub notes: &'a [String],
}

/// One method on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct LadderMark {
    /// Its place in `series`.
    pub series: usize,
    /// How often each edge of the mesh was halved.
    pub level: u32,
    pub wall_s: f64,
    pub error_mm: f64,
    /// Whether no other is both faster and nearer to the truth.
    pub on_front: bool,
    /// Time and error of each run that the mark stands for, if there are several.
    pub runs: Vec<[f64; 2]>,
}

/// One method that gave no answer on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct LadderFailure {
    pub series: usize,
    pub level: u32,
    /// In a few words.
    pub reason: String,
}

const WIDTH: f64 = 1160.0;
const LEFT: f64 = 104.0;
const RIGHT: f64 = 306.0;
const HEAD: f64 = 92.0;
const FAILURE_LINE: f64 = 22.0;
const LEAST_HEIGHT: f64 = 470.0;
const AXIS_FOOT: f64 = 66.0;
const NOTE_LINE: f64 = 17.0;

const FINE: &str = "#eceef1";
const FAILED: &str = "#faeeee";

impl LadderPicture<'_> {
    /// The picture without its title, which stands over every form of it.
    pub fn to_drawing(&self) -> Document {
        let layout = Layout::of(self);
        let mut document = Document::new(WIDTH, layout.height);
        let room = WIDTH - 2.0 * 28.0;
        document.text([28.0, 40.0], room, Style::of(22.0).bold(), self.title);
        document.text([28.0, 64.0], room, Style::of(13.0).faint(), self.subtitle);
        self.write_failures(&mut document, &layout);
        layout.write_grid(&mut document);
        let front = self.write_front(&mut document, &layout);
        self.write_marks(&mut document, &layout);
        self.write_names(&mut document, &layout, &front);
        let legend = Legend {
            series: self.series,
            shown: &self.shown(),
            levels: &self.levels(),
            has_failures: !self.failures.is_empty(),
            has_runs: self.marks.iter().any(|mark| mark.runs.len() > 1),
        };
        legend.write(&mut document, [WIDTH - RIGHT + 22.0, HEAD]);
        for (line, words) in layout.notes.iter().enumerate() {
            let y = layout.height - 14.0 - NOTE_LINE * (layout.notes.len() - 1 - line) as f64;
            document.text([28.0, y], room, Style::of(11.5).faint(), words);
        }
        document
    }

    /// Mesh levels that are drawn, ascending.
    fn levels(&self) -> Vec<u32> {
        let failed = self.failures.iter().map(|failure| failure.level);
        let mut levels: Vec<u32> = self.marks.iter().map(|mark| mark.level).chain(failed).collect();
        levels.sort_unstable();
        levels.dedup();
        levels
    }

    /// The places of the methods that are drawn.
    fn shown(&self) -> Vec<usize> {
        let failed = self.failures.iter().map(|failure| failure.series);
        let mut shown: Vec<usize> =
            self.marks.iter().map(|mark| mark.series).chain(failed).collect();
        shown.sort_unstable();
        shown.dedup();
        shown
    }

    fn name(&self, series: usize) -> &str {
        self.series.get(series).map_or("?", |series| series.name.as_str())
    }

    /// A name with its mesh level, where there are several.
    fn full_name(&self, series: usize, level: u32) -> String {
        match self.levels().len() {
            0 | 1 => self.name(series).to_owned(),
            _ => format!("{}, level {level}", self.name(series)),
        }
    }

    /// How large and how full a mark of a mesh level is.
    fn size(&self, level: u32) -> (f64, f64) {
        let levels = self.levels();
        let place = levels.iter().position(|other| *other == level).unwrap_or_default() as f64;
        match levels.len() {
            0 | 1 => (7.5, 1.0),
            count => (6.2 + 1.3 * place, place / (count - 1) as f64),
        }
    }

    fn write_failures(&self, document: &mut Document, layout: &Layout) {
        if self.failures.is_empty() {
            return;
        }
        let band = layout.band;
        document.rectangle(band, FAILED, 4.0);
        let title = [band.x + 12.0, band.y + 19.0];
        let heading = "no answer: refused, diverged or out of budget";
        document.text(title, band.width - 24.0, Style::of(12.0).bold(), heading);
        let column = band.width / layout.columns as f64;
        for (index, failure) in self.failures.iter().enumerate() {
            let (row, across) = (index / layout.columns, index % layout.columns);
            let x = band.x + 22.0 + column * across as f64;
            let y = band.y + 40.0 + FAILURE_LINE * row as f64;
            let name = self.full_name(failure.series, failure.level);
            let data = mark_data(self.series, failure.series, failure.level);
            document.open_with("failure", &format!("{name}: {}", failure.reason), data);
            let (radius, filled) = self.size(failure.level);
            Symbol::of(failure.series).draw(document, [x, y], radius * 0.85, filled);
            let s = 8.0;
            let cross = format!(
                "M{:.1} {:.1}L{:.1} {:.1}M{:.1} {:.1}L{:.1} {:.1}",
                x - s,
                y - s,
                x + s,
                y + s,
                x - s,
                y + s,
                x + s,
                y - s
            );
            document.path(&cross, Paint::line(FAILED_INK, 1.8));
            let style = Style::of(12.0);
            document.text([x + 16.0, y + 4.0], column - 40.0, style.bold(), &name);
            let after = estimated_width(&name, style.bold()) * 0.9 + 24.0;
            let room = column - 40.0 - after;
            if room > 30.0 {
                document.text([x + 8.0 + after, y + 4.0], room, style.faint(), &failure.reason);
            }
            document.close();
        }
    }

    /// The steps below which nothing lies, and their corners.
    fn write_front(&self, document: &mut Document, layout: &Layout) -> Vec<[f64; 2]> {
        let mut front: Vec<[f64; 2]> = self
            .marks
            .iter()
            .filter(|mark| mark.on_front)
            .map(|mark| layout.place(mark.wall_s, mark.error_mm))
            .collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let Some(first) = front.first().copied() else { return Vec::new() };
        let plot = layout.plot;
        let mut corners = vec![[first[0], plot.y]];
        for point in &front {
            if let Some(last) = corners.last().copied()
                && last[1] != point[1]
                && last[0] != point[0]
            {
                corners.push([point[0], last[1]]);
            }
            corners.push(*point);
        }
        let level = corners.last().map_or(plot.y, |last| last[1]);
        corners.push([plot.x + plot.width, level]);
        let words: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
        let steps = format!("M{}", words.join("L"));
        document.open("front", "no other method is both faster and nearer to the truth");
        let (right, top) = (plot.x + plot.width, plot.y);
        let closed = format!("{steps}L{right:.1} {top:.1}Z");
        document.path(&closed, Paint { fill_opacity: 0.035, ..Paint::inside(FRONT) });
        document.path(&steps, Paint { opacity: 0.85, ..Paint::line(FRONT, 2.0) });
        document.close();
        corners
    }

    fn write_marks(&self, document: &mut Document, layout: &Layout) {
        for series in 0..self.series.len() {
            let own = self.marks.iter().filter(|mark| mark.series == series);
            let mut places: Vec<(u32, [f64; 2])> = own
                .clone()
                .map(|mark| (mark.level, layout.place(mark.wall_s, mark.error_mm)))
                .collect();
            places.sort_by_key(|(level, _)| *level);
            let colour = Symbol::of(series).colour;
            let words: Vec<String> =
                places.iter().map(|(_, [x, y])| format!("{x:.1} {y:.1}")).collect();
            if words.len() > 1 {
                let steps = format!("M{}", words.join("L"));
                document.path(&steps, Paint { opacity: 0.45, ..Paint::line(colour, 1.6) });
            }
            let several = own.filter(|mark| mark.runs.len() > 1);
            for (level, run) in
                several.flat_map(|mark| mark.runs.iter().map(|run| (mark.level, run)))
            {
                let [x, y] = layout.place(run[0], run[1]);
                let words = format!("{}: {}", self.name(series), numbers(*run));
                document.open_with("run", &words, mark_data(self.series, series, level));
                let dot = format!("M{:.1} {y:.1}a2 2 0 1 1 4 0a2 2 0 1 1 -4 0Z", x - 2.0);
                document.path(&dot, Paint { opacity: 0.4, ..Paint::inside(colour) });
                document.close();
            }
        }
        // What is on the front is drawn last, over what it beats.
        let (front, others): (Vec<_>, Vec<_>) = self.marks.iter().partition(|mark| mark.on_front);
        for mark in others.into_iter().chain(front) {
            let name = self.full_name(mark.series, mark.level);
            let [x, y] = layout.place(mark.wall_s, mark.error_mm);
            let (radius, filled) = self.size(mark.level);
            let words = format!("{name}: {}", numbers([mark.wall_s, mark.error_mm]));
            document.open_with("mark", &words, mark_data(self.series, mark.series, mark.level));
            Symbol::of(mark.series).draw(document, [x, y], radius, filled);
            document.close();
        }
    }

    /// Names beside the marks of the front, and beside the best of each other method while there is room.
    fn write_names(&self, document: &mut Document, layout: &Layout, front: &[[f64; 2]]) {
        let mut taken = OccupiedAreas::within(layout.plot);
        for mark in self.marks {
            let (radius, _) = self.size(mark.level);
            taken.add_mark(layout.place(mark.wall_s, mark.error_mm), radius + 2.0);
        }
        for corner in front.windows(2) {
            taken.add_line(corner[0], corner[1]);
        }
        let mut wanted: Vec<&LadderMark> = self.marks.iter().filter(|mark| mark.on_front).collect();
        wanted.sort_by(|a, b| a.wall_s.total_cmp(&b.wall_s));
        let on_front: Vec<usize> = wanted.iter().map(|mark| mark.series).collect();
        for series in (0..self.series.len()).filter(|series| !on_front.contains(series)) {
            let own = self.marks.iter().filter(|mark| mark.series == series);
            wanted.extend(own.min_by(|a, b| a.error_mm.total_cmp(&b.error_mm)));
        }
        for mark in wanted {
            let words = match mark.on_front {
                true => self.full_name(mark.series, mark.level),
                false => self.name(mark.series).to_owned(),
            };
            let style =
                if mark.on_front { Style::of(13.0).bold() } else { Style::of(12.0).faint() };
            let at = layout.place(mark.wall_s, mark.error_mm);
            let (radius, _) = self.size(mark.level);
            if let Some(place) = taken.find(at, radius, style, &words) {
                let middle = [place.x + place.width / 2.0, place.y + place.height * 0.76];
                let room = estimated_width(&words, style) + 1.0;
                document.text(middle, room, style.middle().edged(), &words);
            }
        }
    }
}

/// Where things stand.
struct Layout {
    height: f64,
    /// Failures are written in so many columns.
    columns: usize,
    band: Rectangle,
    plot: Rectangle,
    time: LogAxis,
    error: LogAxis,
    notes: Vec<String>,
}

impl Layout {
    fn of(picture: &LadderPicture) -> Self {
        let width = WIDTH - LEFT - RIGHT;
        let columns = if picture.failures.len() > 8 { 2 } else { 1 };
        let lines = picture.failures.len().div_ceil(columns);
        let band_height = if lines == 0 { 0.0 } else { 34.0 + FAILURE_LINE * lines as f64 };
        let band = Rectangle { x: LEFT, y: HEAD, width, height: band_height };
        let below = if lines == 0 { 0.0 } else { 10.0 };
        let top = HEAD + band_height + below;
        let legend = Legend::height(picture.shown().len()) - band_height - below;
        let plot = Rectangle { x: LEFT, y: top, width, height: LEAST_HEIGHT.max(legend) };
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
        Layout { height, columns, band, plot, time, error, notes }
    }

    fn place(&self, wall_s: f64, error_mm: f64) -> [f64; 2] {
        [self.time.place(wall_s), self.error.place(error_mm)]
    }

    fn write_grid(&self, document: &mut Document) {
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

#[cfg(test)]
#[path = "ladder_tests.rs"]
mod tests;
