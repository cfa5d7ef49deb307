//! Filled contours of the distance over two swept constants, or a curve over one: the minimum, and the range that
//! cannot be distinguished from it.

use super::colour::{GRID, GROUND, INK, SERIES, hexadecimal, sequential};
use super::contour_grid::{BANDS, ContourAxis, Grid, INSET, PLOT, labelled, position};
use super::drawing::{Document, Paint, Rectangle, Style, wrapped};
use super::legend::Scale;
use super::raster::PngError;
use super::svg::svg;

/// Content of the picture. Distances in mm.
pub struct ContourPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub across: &'a ContourAxis,
    /// None where one constant varies.
    pub upwards: Option<&'a ContourAxis>,
    /// At each place, `upwards` fastest; none where nothing was solved.
    pub distances: &'a [Option<f64>],
    /// The place of the least.
    pub best: usize,
    /// What registration left, in mm.
    pub noise: Option<f64>,
    pub notes: &'a [String],
}

const WIDTH: f64 = 900.0;
const MARGIN: f64 = 28.0;
const LINE: f64 = 17.0;

impl ContourPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> Result<String, PngError> {
        let room = WIDTH - 2.0 * MARGIN;
        let style = Style::of(12.0).faint();
        let notes: Vec<String> =
            self.notes.iter().flat_map(|note| wrapped(note, room, style)).collect();
        let foot = PLOT.y + PLOT.height + 64.0;
        let mut document = Document::new(WIDTH, foot + LINE * notes.len() as f64 + 12.0);
        document.text([MARGIN, 38.0], room, Style::of(19.0).bold(), self.title);
        document.text([MARGIN, 62.0], room, Style::of(13.0).faint(), self.subtitle);
        match self.upwards {
            Some(upwards) => self.write_contours(&mut document, upwards)?,
            None => self.write_curve(&mut document),
        }
        for (line, words) in notes.iter().enumerate() {
            document.text([MARGIN, foot + LINE * line as f64], room, style, words);
        }
        Ok(svg(&document, self.title))
    }

    /// The distances lie between these.
    fn range(&self) -> [f64; 2] {
        let found = || self.distances.iter().flatten().copied();
        let (low, high) = (found().fold(f64::INFINITY, f64::min), found().fold(0.0, f64::max));
        if low.is_finite() && high > low { [low, high] } else { [0.0, high.max(1e-6)] }
    }

    fn write_contours(
        &self,
        document: &mut Document,
        upwards: &ContourAxis,
    ) -> Result<(), PngError> {
        let grid = Grid { across: self.across, upwards, distances: self.distances };
        let range = self.range();
        document.rectangle(PLOT, GROUND, 0.0);
        document.image(PLOT, &grid.image(range).to_png()?);
        for level in levels(range) {
            let words = format!("D {level:.3} mm");
            grid.write_level(document, level, (1.0, INK, &words));
        }
        if let (Some(noise), Some(least)) = (self.noise, self.distances[self.best]) {
            let words = "as good as the best, by what registration left";
            grid.write_level(document, least + noise, (2.6, SERIES[0], words));
        }
        for (place, distance) in self.distances.iter().enumerate() {
            let at = grid.place_of(place);
            let Some(distance) = distance else {
                document.text([at[0], at[1] + 4.0], 20.0, Style::of(12.0).middle(), "×");
                continue;
            };
            document.open("cell", &format!("{}: D {distance:.4} mm", grid.words(place)));
            write_dot(document, at, (2.4, INK));
            document.close();
        }
        let best = grid.place_of(self.best);
        document.open("best", &grid.words(self.best));
        write_dot(document, best, (6.5, SERIES[0]));
        document.close();
        write_across(document, self.across);
        let ends = [PLOT.y + PLOT.height - INSET, PLOT.y + INSET];
        for value in labelled(upwards, ends) {
            let y = position(upwards, value, ends);
            let at = [PLOT.x - 8.0, y + 4.0];
            document.text(at, 60.0, Style::of(12.0).end(), &format!("{value}"));
        }
        let upwards_at = [26.0, PLOT.y + 0.5 * PLOT.height];
        document.text_upwards(upwards_at, PLOT.height, Style::of(13.0), &upwards.name);
        write_legend(document, range, self.noise.is_some());
        Ok(())
    }

    fn write_curve(&self, document: &mut Document) {
        let [_, high] = self.range();
        let scale = Scale::covering(high + self.noise.unwrap_or(0.0));
        let height = |d: f64| PLOT.y + PLOT.height * (1.0 - (d / scale.maximum()).clamp(0.0, 1.0));
        for &tick in &scale.ticks {
            let y = height(tick);
            document.stroke(&[[PLOT.x, y], [PLOT.x + PLOT.width, y]], GRID, 1.0);
            document.text([PLOT.x - 8.0, y + 4.0], 60.0, Style::of(12.0).end(), &scale.label(tick));
        }
        if let (Some(noise), Some(least)) = (self.noise, self.distances[self.best]) {
            let (top, foot) = (height(least + noise), height(least));
            let band = Rectangle { y: top, height: foot - top, ..PLOT };
            document.rectangle(band, "#cfe3f1", 0.0);
            let at = [PLOT.x + PLOT.width + 10.0, 0.5 * (top + foot) + 4.0];
            document.text(at, WIDTH - at[0] - 8.0, Style::of(12.0), "as good as the best");
        }
        let ends = [PLOT.x + INSET, PLOT.x + PLOT.width - INSET];
        let at = |place: usize, d: f64| {
            [position(self.across, self.across.values[place], ends), height(d)]
        };
        let places: Vec<(usize, f64)> =
            self.distances.iter().enumerate().filter_map(|(k, d)| Some((k, (*d)?))).collect();
        let points: Vec<[f64; 2]> = places.iter().map(|&(k, d)| at(k, d)).collect();
        document.stroke(&points, INK, 1.8);
        for (&(place, distance), point) in places.iter().zip(&points) {
            let words =
                format!("{} {}: D {distance:.4} mm", self.across.name, self.across.values[place]);
            let (class, dot) =
                if place == self.best { ("best", (6.5, SERIES[0])) } else { ("cell", (3.4, INK)) };
            document.open(class, &words);
            write_dot(document, *point, dot);
            document.close();
        }
        write_across(document, self.across);
        let upwards_at = [26.0, PLOT.y + 0.5 * PLOT.height];
        document.text_upwards(upwards_at, PLOT.height, Style::of(13.0), "mean distance D, mm");
    }
}

fn write_across(document: &mut Document, axis: &ContourAxis) {
    let ends = [PLOT.x + INSET, PLOT.x + PLOT.width - INSET];
    let foot = PLOT.y + PLOT.height;
    for value in labelled(axis, ends) {
        let x = position(axis, value, ends);
        document.stroke(&[[x, foot], [x, foot + 5.0]], INK, 1.0);
        document.text([x, foot + 19.0], 60.0, Style::of(12.0).middle(), &format!("{value}"));
    }
    let middle = [PLOT.x + 0.5 * PLOT.width, foot + 40.0];
    document.text(middle, PLOT.width, Style::of(13.0).middle(), &axis.name);
}

fn write_dot(document: &mut Document, [x, y]: [f64; 2], (radius, colour): (f64, &str)) {
    let [left, right] = [x - radius, x + radius];
    let steps = format!(
        "M{left:.1} {y:.1}A{radius} {radius} 0 1 1 {right:.1} {y:.1}A{radius} {radius} 0 1 1 {left:.1} {y:.1}Z"
    );
    document.path(&steps, Paint { stroke: "#ffffff", stroke_width: 1.0, ..Paint::inside(colour) });
}

fn levels([low, high]: [f64; 2]) -> Vec<f64> {
    let step = (high - low) / BANDS;
    (1..BANDS as usize).map(|k| low + step * k as f64).collect()
}

fn write_legend(document: &mut Document, [low, high]: [f64; 2], has_noise: bool) {
    let x = PLOT.x + PLOT.width + 22.0;
    let bar = Rectangle { x, y: PLOT.y + 24.0, width: 18.0, height: 240.0 };
    document.text([x, PLOT.y + 12.0], 150.0, Style::of(13.0), "mean D, mm");
    let height = bar.height / BANDS;
    for number in 0..BANDS as usize {
        let y = bar.y + bar.height - height * (number + 1) as f64;
        let colour = hexadecimal(sequential((number as f64 + 0.5) / BANDS));
        document.rectangle(Rectangle { y, height: height + 0.5, ..bar }, &colour, 0.0);
    }
    for number in [0, 2, 4, 6, 8, 10] {
        let share = f64::from(number) / BANDS;
        let y = bar.y + bar.height * (1.0 - share) + 4.0;
        let words = format!("{:.3}", low + (high - low) * share);
        document.text([x + 26.0, y], 100.0, Style::of(12.0), &words);
    }
    let y = bar.y + bar.height + 30.0;
    write_dot(document, [x + 9.0, y - 4.0], (6.5, SERIES[0]));
    document.text([x + 26.0, y], 120.0, Style::of(12.0), "least");
    if has_noise {
        document.stroke(&[[x, y + 18.0], [x + 18.0, y + 18.0]], SERIES[0], 2.6);
        document.text([x + 26.0, y + 22.0], 130.0, Style::of(12.0), "as good inside");
    }
}

#[cfg(test)]
mod tests {
    use super::super::contour_grid::crossing;
    use super::*;

    fn axis(name: &str, values: &[f64]) -> ContourAxis {
        ContourAxis { name: name.to_owned(), values: values.to_vec() }
    }

    #[test]
    fn contours_cross_where_the_distance_is_theirs_and_the_least_is_marked() {
        let (across, upwards) = (axis("E", &[10.0, 100.0, 1000.0]), axis("nu", &[0.3, 0.4, 0.49]));
        // Linear along the logarithm of E: D = 1, 2, 3.
        let distances: Vec<Option<f64>> =
            [1.0, 2.0, 3.0].iter().flat_map(|&d| [Some(d); 3]).collect();
        let grid = Grid { across: &across, upwards: &upwards, distances: &distances };
        let (xs, ys) = (grid.xs(), grid.ys());
        let halfway = [0.5 * (xs[0] + xs[1]), ys[1]];
        assert!((grid.between(halfway, &xs, &ys).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(grid.between([xs[0] - 5.0, ys[1]], &xs, &ys), None);
        let triangle = [([0.0, 0.0], 1.0), ([4.0, 0.0], 3.0), ([0.0, 4.0], 1.0)];
        assert_eq!(crossing(&triangle, 2.0), Some([[2.0, 0.0], [2.0, 2.0]]));
        assert_eq!(crossing(&triangle, 4.0), None);
        let picture = ContourPicture {
            title: "D",
            subtitle: "",
            across: &across,
            upwards: Some(&upwards),
            distances: &distances,
            best: 1,
            noise: Some(0.5),
            notes: &["a note".to_owned()],
        };
        let text = picture.to_svg().unwrap();
        assert_eq!(text.matches("class=\"cell\"").count(), 9);
        assert_eq!(text.matches("class=\"contour\"").count(), 10);
        assert!(text.contains("E 10, nu 0.4") && text.contains("a note"));
    }

    #[test]
    fn one_constant_is_a_curve_and_what_was_not_solved_is_left_out() {
        let across = axis("nu", &[0.3, 0.4, 0.45, 0.49]);
        let distances = [Some(0.4), None, Some(0.1), Some(0.2)];
        let picture = ContourPicture {
            title: "D",
            subtitle: "",
            across: &across,
            upwards: None,
            distances: &distances,
            best: 2,
            noise: None,
            notes: &[],
        };
        let text = picture.to_svg().unwrap();
        assert_eq!(text.matches("class=\"cell\"").count(), 2);
        assert_eq!(text.matches("class=\"best\"").count(), 1);
        assert!(text.contains("nu 0.45: D 0.1000 mm"));
    }
}
