//! Mean movement of the skin over the cell sizes of its meshes, with the limit that it goes to.

use super::colour::GRID;
use super::drawing::{Document, Paint, Rectangle, Style, wrapped};
use super::label_column::{ColumnLabel, write_labels};
use super::svg::svg;
use super::symbol::Symbol;

/// Content of the picture.
pub struct CellSizesPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub series: &'a [CellSizesSeries],
    pub notes: &'a [String],
}

/// One model: cell sizes and mean movements in mm, and what fits them.
pub struct CellSizesSeries {
    pub name: String,
    pub points: Vec<[f64; 2]>,
    /// Limit in mm and order.
    pub fit: Option<[f64; 2]>,
    /// How many of the last points it is of.
    pub fitted: usize,
}

const WIDTH: f64 = 900.0;
const MARGIN: f64 = 28.0;
const LINE: f64 = 17.0;
const PLOT: Rectangle = Rectangle { x: 84.0, y: 84.0, width: 570.0, height: 360.0 };

/// Steps between two lines of a grid, times a power of ten.
const STEPS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

/// Points of the curve of a fit.
const CURVE: usize = 60;

impl CellSizesPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> String {
        let room = WIDTH - 2.0 * MARGIN;
        let style = Style::of(12.0).faint();
        let notes: Vec<String> =
            self.notes.iter().flat_map(|note| wrapped(note, room, style)).collect();
        let foot = PLOT.y + PLOT.height + 70.0;
        let mut document = Document::new(WIDTH, foot + LINE * notes.len() as f64 + 8.0);
        document.text([MARGIN, 38.0], room, Style::of(19.0).bold(), self.title);
        document.text([MARGIN, 62.0], room, Style::of(13.0).faint(), self.subtitle);
        self.write_grid(&mut document);
        let mut labels: Vec<ColumnLabel> = Vec::new();
        for (number, series) in self.series.iter().enumerate() {
            let symbol = Symbol::of(number);
            if let Some(curve) = self.curve(series) {
                let paint = Paint { dashes: "5 4", ..Paint::line(symbol.colour, 1.4) };
                document.path(&curve, paint);
            }
            let places: Vec<[f64; 2]> = series.points.iter().map(|at| self.place(*at)).collect();
            document.stroke(&places, symbol.colour, 2.0);
            for (place, [cell, mean]) in places.iter().zip(&series.points) {
                let words = format!("{}: {cell:.2} mm, {mean:.4} mm", series.name);
                document.open("mesh", &words);
                symbol.draw(&mut document, *place, 5.0, 1.0);
                document.close();
            }
            let last = series.points.last().map_or(0.0, |[_, mean]| *mean);
            let words = match series.fit {
                Some([limit, order]) => {
                    format!("{}: limit {limit:.3}, order {order:.2}", series.name)
                }
                None => format!("{}: {last:.3}", series.name),
            };
            let coarsest = places.into_iter().max_by(|a, b| a[0].total_cmp(&b[0]));
            labels.extend(coarsest.map(|at| ColumnLabel { at, symbol: Some(symbol), words }));
        }
        let left = PLOT.x + PLOT.width;
        let ends = [PLOT.y, PLOT.y + PLOT.height];
        write_labels(&mut document, &labels, [left, WIDTH - left - 12.0], ends);
        for (line, words) in notes.iter().enumerate() {
            document.text([MARGIN, foot + LINE * line as f64], room, style, words);
        }
        svg(&document, self.title)
    }

    fn write_grid(&self, document: &mut Document) {
        let [low, high] = self.range();
        let (step, digits) = step(high - low);
        let mut value = (low / step).ceil() * step;
        while value <= high {
            let y = self.place([0.0, value])[1];
            document.stroke(&[[PLOT.x, y], [PLOT.x + PLOT.width, y]], GRID, 1.0);
            let label = format!("{:.digits$}", value + 0.0);
            document.text([PLOT.x - 8.0, y + 4.0], 60.0, Style::of(12.0).end(), &label);
            value += step;
        }
        let (across, digits) = self::step(self.largest());
        for line in 0..=(self.largest() / across) as usize {
            let cell = across * line as f64;
            let at = [self.place([cell, low])[0], PLOT.y + PLOT.height + 20.0];
            let label = format!("{cell:.digits$}");
            document.text(at, 60.0, Style::of(12.0).middle(), &label);
        }
        let middle = [PLOT.x + 0.5 * PLOT.width, PLOT.y + PLOT.height + 44.0];
        document.text(middle, 400.0, Style::of(13.0).middle(), "cell size, mm");
        let upwards = [26.0, PLOT.y + 0.5 * PLOT.height];
        let words = "mean movement of the skin, mm";
        document.text_upwards(upwards, 340.0, Style::of(13.0), words);
    }

    fn largest(&self) -> f64 {
        let cells = self.series.iter().flat_map(|own| own.points.iter().map(|point| point[0]));
        1.05 * cells.fold(1e-6, f64::max)
    }

    /// What is drawn, with a tenth of air on both sides.
    fn range(&self) -> [f64; 2] {
        let means = self.series.iter().flat_map(|own| {
            let limit = own.fit.map(|[limit, _]| limit);
            own.points.iter().map(|point| point[1]).chain(limit)
        });
        let (low, high) =
            means.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), m| (l.min(m), h.max(m)));
        let air = (0.1 * (high - low)).max(1e-6);
        if low.is_finite() { [low - air, high + air] } else { [0.0, 1.0] }
    }

    fn place(&self, [cell, mean]: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.range();
        let share = ((mean - low) / (high - low)).clamp(0.0, 1.0);
        let across = (cell / self.largest()).clamp(0.0, 1.0);
        [PLOT.x + PLOT.width * across, PLOT.y + PLOT.height * (1.0 - share)]
    }

    /// The fit from size 0 to the coarsest mesh that it is of.
    fn curve(&self, series: &CellSizesSeries) -> Option<String> {
        let [limit, order] = series.fit?;
        let left_out = series.points.len().saturating_sub(series.fitted);
        let points = &series.points[left_out..];
        let largest = points.iter().map(|point| point[0]).fold(0.0, f64::max);
        let power = |cell: f64| (cell / largest).powf(order);
        let (both, squares) = points.iter().fold((0.0, 0.0), |(both, squares), point| {
            let x = power(point[0]);
            (both + x * (point[1] - limit), squares + x * x)
        });
        let at = |step: usize| {
            let cell = largest * step as f64 / CURVE as f64;
            let [x, y] = self.place([cell, limit + both / squares * power(cell)]);
            format!("{x:.1} {y:.1}")
        };
        let steps: Vec<String> = (0..=CURVE).map(at).collect();
        Some(format!("M{}", steps.join("L")))
    }
}

/// A step of which at most ten make a length, and the digits that tell its multiples apart.
fn step(length: f64) -> (f64, usize) {
    let power = (length.max(1e-9) / 10.0).log10().floor();
    let steps = STEPS.map(|step| step * 10f64.powf(power));
    let step: f64 = steps.into_iter().find(|step| length / step <= 10.0).unwrap_or(length);
    (step, (-step.log10().floor()).clamp(0.0, 6.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mesh_is_drawn_within_the_picture_and_the_limit_is_reported() {
        let points = vec![[8.0, 3.9], [4.0, 4.2], [2.0, 4.28]];
        let series = [
            CellSizesSeries { name: "plain".to_owned(), points, fit: Some([4.31, 1.9]), fitted: 3 },
            CellSizesSeries {
                name: "noise".to_owned(),
                points: vec![[4.0, 4.0]],
                fit: None,
                fitted: 0,
            },
        ];
        let notes = ["What it says.".to_owned()];
        let picture =
            CellSizesPicture { title: "sizes", subtitle: "a plan", series: &series, notes: &notes };
        let text = picture.to_svg();
        assert_eq!(text.matches("class=\"mesh\"").count(), 4);
        for words in ["plain: limit 4.310", "noise: 4.000", "cell size, mm", "What it says."] {
            assert!(text.contains(words), "{words}");
        }
        for point in [[8.0, 3.9], [0.0, 4.31], [9.0, 9.0]] {
            let [x, y] = picture.place(point);
            assert!((PLOT.x..=PLOT.x + PLOT.width).contains(&x), "{x}");
            assert!((PLOT.y..=PLOT.y + PLOT.height).contains(&y), "{y}");
        }
    }

    #[test]
    fn steps_are_round_and_ten_at_most() {
        assert_eq!(step(8.4), (1.0, 0));
        assert_eq!(step(0.5), (0.05, 2));
        assert_eq!(step(19.0), (2.0, 0));
    }
}
