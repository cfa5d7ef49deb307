//! Speed and accuracy: wall time and error of each method on each mesh on logarithmic axes. A line joins the Pareto
//! front; runs without an answer are in a band of their own with the reason.

use super::axis::numbers;
use super::callout::{Callout, OccupiedAreas};
use super::colour::FRONT;
use super::drawing::{Document, Paint, Style, estimated_width};
use super::ladder_content::{LadderMark, LadderPicture};
use super::ladder_layout::{HEAD, Layout, NOTE_LINE, RIGHT, WIDTH};
use super::ladder_legend::Legend;
use super::series::mark_data;
use super::symbol::Symbol;

/// Marks nearer to each other than this hide each other, and by how much the lower one is then larger.
const HIDES: f64 = 8.0;
const RING: f64 = 4.6;
/// Around a mark.
const AIR: f64 = 2.0;
/// How much nearer a name would have to stand over a run, the line of a method, and the front.
const OVER_RUN: f64 = 2.0;
const OVER_SERIES: f64 = 6.0;
const OVER_FRONT: f64 = 14.0;

impl LadderPicture<'_> {
    /// The picture without its title, which stands over every form of it.
    pub fn to_drawing(&self) -> Document {
        let layout = Layout::of(self);
        let mut document = Document::new(WIDTH, layout.height);
        let room = WIDTH - 2.0 * 28.0;
        document.text([28.0, 40.0], room, Style::of(22.0).bold(), self.title);
        document.text([28.0, 64.0], room, Style::of(13.0).faint(), self.subtitle);
        layout.failures.write(&mut document, self);
        layout.write_grid(&mut document);
        let front = self.write_front(&mut document, &layout);
        self.write_marks(&mut document, &layout);
        self.write_names(&mut document, &layout, &front);
        let legend = Legend {
            series: self.series,
            shown: &self.shown(),
            levels: &self.levels(),
            has_failures: !self.failures.is_empty(),
            has_rings: self.has_rings(&layout),
            has_runs: self.marks.iter().any(|mark| mark.runs.len() > 1),
        };
        legend.write(&mut document, [WIDTH - RIGHT + 22.0, HEAD]);
        for (line, words) in layout.notes.iter().enumerate() {
            let y = layout.height - 14.0 - NOTE_LINE * (layout.notes.len() - 1 - line) as f64;
            document.text([28.0, y], room, Style::of(11.5).faint(), words);
        }
        document
    }

    /// Whether a mark stands out around another.
    fn has_rings(&self, layout: &Layout) -> bool {
        let marks = self.drawn_marks().into_iter().zip(self.radii(layout));
        marks.into_iter().any(|(mark, radius)| radius > self.size(mark.level).0)
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
            let places = self.places(series, layout);
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
        let radii = self.radii(layout);
        for (mark, radius) in self.drawn_marks().into_iter().zip(radii) {
            let name = self.full_name(mark.series, mark.level);
            let (_, filled) = self.size(mark.level);
            let words = format!("{name}: {}", numbers([mark.wall_s, mark.error_mm]));
            document.open_with("mark", &words, mark_data(self.series, mark.series, mark.level));
            let at = layout.place(mark.wall_s, mark.error_mm);
            Symbol::of(mark.series).draw(document, at, radius, filled);
            document.close();
        }
    }

    /// In the order in which they are drawn: what is on the front last, over what it beats.
    fn drawn_marks(&self) -> Vec<&LadderMark> {
        let (front, others): (Vec<_>, Vec<_>) = self.marks.iter().partition(|mark| mark.on_front);
        others.into_iter().chain(front).collect()
    }

    /// The radii of marks in the order in which they are drawn. One that others would hide is so large that it stands out
    /// around them.
    fn radii(&self, layout: &Layout) -> Vec<f64> {
        let marks = self.drawn_marks();
        let mut radii: Vec<f64> = marks.iter().map(|mark| self.size(mark.level).0).collect();
        let place = |mark: &LadderMark| layout.place(mark.wall_s, mark.error_mm);
        for below in (0..marks.len()).rev() {
            let [x, y] = place(marks[below]);
            for above in below + 1..marks.len() {
                let [over_x, over_y] = place(marks[above]);
                if (over_x - x).hypot(over_y - y) < HIDES {
                    radii[below] = radii[below].max(radii[above] + RING);
                }
            }
        }
        radii
    }

    /// Names beside the marks of the front, and beside the best of each other method.
    fn write_names(&self, document: &mut Document, layout: &Layout, front: &[[f64; 2]]) {
        let (mut taken, radii) = self.occupied(layout, front);
        for mark in self.named() {
            let words = match mark.on_front {
                true => self.full_name(mark.series, mark.level),
                false => self.name(mark.series).to_owned(),
            };
            let symbol = Symbol::of(mark.series);
            let style = Style::of(12.0).coloured(symbol.ink());
            let style = if mark.on_front { style.bold() } else { style };
            let at = layout.place(mark.wall_s, mark.error_mm);
            let own = self.drawn_marks().iter().position(|other| std::ptr::eq(*other, mark));
            let radius = own.map_or(0.0, |place| radii[place]);
            let Some(Callout { place, leader }) = taken.find(at, radius + AIR, style, &words)
            else {
                continue;
            };
            if let Some(leader) = leader {
                document.stroke(&leader, symbol.colour, 1.0);
            }
            let middle = [place.x + place.width / 2.0, place.y + place.height * 0.76];
            let room = estimated_width(&words, style) + 1.0;
            document.text(middle, room, style.middle().edged(), &words);
        }
    }

    /// What names may not lie over, and had better not, with the radii of marks in the order in which they are drawn.
    fn occupied(&self, layout: &Layout, front: &[[f64; 2]]) -> (OccupiedAreas, Vec<f64>) {
        let mut taken = OccupiedAreas::within(layout.plot);
        let (marks, radii) = (self.drawn_marks(), self.radii(layout));
        for (mark, radius) in marks.iter().zip(&radii) {
            taken.add_mark(layout.place(mark.wall_s, mark.error_mm), radius + AIR);
            for run in mark.runs.iter().filter(|_| mark.runs.len() > 1) {
                taken.add_line([layout.place(run[0], run[1]); 2], OVER_RUN);
            }
        }
        for series in 0..self.series.len() {
            for pair in self.places(series, layout).windows(2) {
                taken.add_line([pair[0].1, pair[1].1], OVER_SERIES);
            }
        }
        for corner in front.windows(2) {
            taken.add_line([corner[0], corner[1]], OVER_FRONT);
        }
        (taken, radii)
    }

    /// The marks that have a name beside them, in the order in which names get their room.
    fn named(&self) -> Vec<&LadderMark> {
        let mut named: Vec<&LadderMark> = self.marks.iter().filter(|mark| mark.on_front).collect();
        named.sort_by(|a, b| a.wall_s.total_cmp(&b.wall_s));
        let on_front: Vec<usize> = named.iter().map(|mark| mark.series).collect();
        for series in (0..self.series.len()).filter(|series| !on_front.contains(series)) {
            let own = self.marks.iter().filter(|mark| mark.series == series);
            named.extend(own.min_by(|a, b| a.error_mm.total_cmp(&b.error_mm)));
        }
        named
    }

    /// The levels of a method and where their marks are, ascending.
    fn places(&self, series: usize, layout: &Layout) -> Vec<(u32, [f64; 2])> {
        let own = self.marks.iter().filter(|mark| mark.series == series);
        let mut places: Vec<(u32, [f64; 2])> =
            own.map(|mark| (mark.level, layout.place(mark.wall_s, mark.error_mm))).collect();
        places.sort_by_key(|(level, _)| *level);
        places
    }
}

#[cfg(test)]
#[path = "ladder_tests.rs"]
mod tests;
