//! Learning curves: error by the number of cases that were learned from, beside levels that need none.

use super::colour::{FAINT_INK, GRID};
use super::drawing::{Document, Paint, Rectangle, Style};
use super::label_column::{ColumnLabel, write_labels};
use super::svg::svg;
use super::symbol::Symbol;

/// Content of the picture.
pub struct LearningPicture<'a> {
    pub title: &'a str,
    /// Names and errors in mm of what is not learned.
    pub levels: &'a [(String, f64)],
    pub series: &'a [LearningSeries],
}

/// A method: numbers of cases and errors in mm.
pub struct LearningSeries {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

const SIZE: [f64; 2] = [900.0, 520.0];
const PLOT: Rectangle = Rectangle { x: 76.0, y: 64.0, width: 560.0, height: 380.0 };

/// Errors between two lines of the grid, as far as these are no more than ten.
const STEPS: [f64; 5] = [0.1, 0.2, 0.5, 1.0, 5.0];

impl LearningPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> String {
        let mut document = Document::new(SIZE[0], SIZE[1]);
        document.text([28.0, 38.0], SIZE[0] - 56.0, Style::of(19.0).bold(), self.title);
        self.write_grid(&mut document);
        let mut labels: Vec<ColumnLabel> = Vec::new();
        for (name, error) in self.levels {
            let y = self.place(1.0, *error)[1];
            let steps = format!("M{:.1} {y:.1}L{:.1} {y:.1}", PLOT.x, PLOT.x + PLOT.width);
            document.path(&steps, Paint { dashes: "5 4", ..Paint::line(FAINT_INK, 1.3) });
            let (at, words) = ([PLOT.x + PLOT.width, y], format!("{name} {error:.2}"));
            labels.push(ColumnLabel { at, symbol: None, words });
        }
        for (number, series) in self.series.iter().enumerate() {
            let places: Vec<[f64; 2]> =
                series.points.iter().map(|&(cases, error)| self.place(cases, error)).collect();
            let symbol = Symbol::of(number);
            document.stroke(&places, symbol.colour, 2.2);
            for (place, (cases, error)) in places.iter().zip(&series.points) {
                document.open("learned", &format!("{}: {cases} cases, {error:.3} mm", series.name));
                symbol.draw(&mut document, *place, 5.0, 1.0);
                document.close();
            }
            if let (Some(&at), Some((_, error))) = (places.last(), series.points.last()) {
                let words = format!("{} {error:.2}", series.name);
                labels.push(ColumnLabel { at, symbol: Some(symbol), words });
            }
        }
        let left = PLOT.x + PLOT.width;
        let ends = [PLOT.y - 12.0, PLOT.y + PLOT.height + 12.0];
        write_labels(&mut document, &labels, [left, SIZE[0] - left - 12.0], ends);
        svg(&document, self.title)
    }

    fn write_grid(&self, document: &mut Document) {
        let (most, step) = (self.most_error(), self.step());
        for line in 0..=(most / step) as usize {
            let error = step * line as f64;
            let y = self.place(1.0, error)[1];
            document.stroke(&[[PLOT.x, y], [PLOT.x + PLOT.width, y]], GRID, 1.0);
            let label = format!("{error:.1}");
            document.text([PLOT.x - 8.0, y + 4.0], 60.0, Style::of(12.0).end(), &label);
        }
        let mut all: Vec<f64> =
            self.series.iter().flat_map(|own| own.points.iter().map(|point| point.0)).collect();
        all.sort_unstable_by(f64::total_cmp);
        all.dedup();
        for cases in all {
            let at = [self.place(cases, 0.0)[0], PLOT.y + PLOT.height + 20.0];
            document.text(at, 60.0, Style::of(12.0).middle(), &format!("{cases}"));
        }
        let middle = PLOT.x + 0.5 * PLOT.width;
        let words = "cases learned from";
        document.text([middle, SIZE[1] - 22.0], 400.0, Style::of(13.0).middle(), words);
        let upwards = [26.0, PLOT.y + 0.5 * PLOT.height];
        document.text_upwards(upwards, 300.0, Style::of(13.0), "mean error, mm");
    }

    fn most_error(&self) -> f64 {
        let learned = self.series.iter().flat_map(|own| own.points.iter().map(|point| point.1));
        let levels = self.levels.iter().map(|level| level.1);
        1.06 * learned.chain(levels).fold(1e-3, f64::max)
    }

    fn step(&self) -> f64 {
        let most = self.most_error();
        STEPS.into_iter().find(|step| most / step <= 10.0).unwrap_or(most)
    }

    /// Cases along a logarithmic axis.
    fn place(&self, cases: f64, error: f64) -> [f64; 2] {
        let points = || self.series.iter().flat_map(|own| own.points.iter().map(|point| point.0));
        let least = points().fold(f64::INFINITY, f64::min).max(1.0);
        let most = points().fold(least, f64::max).max(least + 1.0);
        let share = (cases.max(least) / least).ln() / (most / least).ln();
        let height = (error / self.most_error()).clamp(0.0, 1.0);
        let x = PLOT.x + 14.0 + share.min(1.0) * (PLOT.width - 28.0);
        [x, PLOT.y + PLOT.height * (1.0 - height)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_and_level_is_drawn_within_the_picture() {
        let levels = [("linear".to_owned(), 0.6)];
        let points = vec![(3.0, 1.8), (10.0, 0.9), (59.0, 0.5)];
        let series = [LearningSeries { name: "GRNN".to_owned(), points }];
        let picture = LearningPicture { title: "errors", levels: &levels, series: &series };
        let text = picture.to_svg();
        assert_eq!(text.matches("class=\"learned\"").count(), 3);
        assert!(text.contains("linear 0.60") && text.contains("GRNN 0.50"));
        for (cases, error) in [(3.0, 1.8), (59.0, 0.0), (1.0, 9.0)] {
            let [x, y] = picture.place(cases, error);
            assert!((PLOT.x..=PLOT.x + PLOT.width).contains(&x), "{x}");
            assert!((PLOT.y..=PLOT.y + PLOT.height).contains(&y), "{y}");
        }
    }
}
