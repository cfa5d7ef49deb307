//! Shares of area over signed values of a fixed range, in the colours of that range.

use super::colour::{GRID, INK, hexadecimal};
use super::drawing::{Document, Rectangle, Style};
use super::legend::Scale;
use super::views::ViewValues;

/// Content of the picture.
pub struct HistogramPicture<'a> {
    /// The values and the fixed range in mm; what lies beyond counts in the last bins.
    pub values: ViewValues<'a>,
    /// Area of each value.
    pub weights: &'a [f64],
}

const SIZE: [f64; 2] = [1000.0, 270.0];
const PLOT: Rectangle = Rectangle { x: 70.0, y: 30.0, width: 900.0, height: 180.0 };
/// Two for each band of the colours.
const BINS: usize = 20;

impl HistogramPicture<'_> {
    /// The share of the area in each bin of the range, and below and above it.
    pub fn shares(&self) -> ([f64; BINS], [f64; 2]) {
        let (mut bins, mut beyond, mut all) = ([0.0; BINS], [0.0; 2], 0.0);
        let range = self.values.range_mm;
        for (value, weight) in self.values.values.iter().zip(self.weights) {
            all += weight;
            let share = (value / range + 1.0) / 2.0;
            let bin = (share * BINS as f64).floor();
            match share {
                share if share < 0.0 => beyond[0] += weight,
                share if share > 1.0 => beyond[1] += weight,
                _ => bins[(bin.max(0.0) as usize).min(BINS - 1)] += weight,
            }
        }
        let all = if all > 0.0 { all } else { 1.0 };
        (bins.map(|bin| bin / all), beyond.map(|side| side / all))
    }

    pub fn to_drawing(&self) -> Document {
        let (bins, beyond) = self.shares();
        let mut document = Document::new(SIZE[0], SIZE[1]);
        let scale = Scale::covering(100.0 * bins.iter().copied().fold(0.0, f64::max));
        let place = |percent: f64| PLOT.y + PLOT.height * (1.0 - percent / scale.maximum());
        for &tick in &scale.ticks {
            let y = place(tick);
            document.stroke(&[[PLOT.x, y], [PLOT.x + PLOT.width, y]], GRID, 1.0);
            let label = format!("{} %", scale.label(tick));
            document.text([PLOT.x - 8.0, y + 4.0], 60.0, Style::of(12.0).end(), &label);
        }
        let range = self.values.range_mm;
        let width = PLOT.width / BINS as f64;
        for (bin, share) in bins.into_iter().enumerate() {
            let value = range * (2.0 * (bin as f64 + 0.5) / BINS as f64 - 1.0);
            let (y, foot) = (place(100.0 * share), PLOT.y + PLOT.height);
            let x = PLOT.x + width * bin as f64 + 1.0;
            let bar = Rectangle { x, y, width: width - 2.0, height: foot - y };
            document.open("bin", &format!("{value:.2} mm: {:.1} %", 100.0 * share));
            document.rectangle(bar, &hexadecimal(self.values.colour(value)), 0.0);
            let outline = [[x, foot], [x, y], [x + width - 2.0, y], [x + width - 2.0, foot]];
            document.stroke(&outline, INK, 0.7);
            document.close();
        }
        for tick in 0..=4 {
            let share = f64::from(tick) / 4.0;
            let at = [PLOT.x + PLOT.width * share, PLOT.y + PLOT.height + 20.0];
            let label = format!("{}", range * (2.0 * share - 1.0) + 0.0);
            document.text(at, 80.0, Style::of(12.5).middle(), &label);
        }
        let words = ["below the range", "above the range"];
        let ends = [
            ([PLOT.x, 18.0], Style::of(12.0).faint()),
            ([PLOT.x + PLOT.width, 18.0], Style::of(12.0).faint().end()),
        ];
        for ((side, words), (at, style)) in beyond.into_iter().zip(words).zip(ends) {
            document.text(at, 300.0, style, &format!("{:.1} % {words}", 100.0 * side));
        }
        let middle = [PLOT.x + 0.5 * PLOT.width, PLOT.y + PLOT.height + 46.0];
        document.text(middle, SIZE[0], Style::of(13.0).middle(), self.values.name);
        document
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_area_is_in_one_bin_or_beyond_the_range() {
        let values = [-3.0, -2.0, -0.01, 0.0, 0.19, 2.0, 2.1, 5.0];
        let weights = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        let values =
            ViewValues { values: &values, range_mm: 2.0, is_signed: true, name: "distance" };
        let picture = HistogramPicture { values, weights: &weights };
        let (bins, beyond) = picture.shares();
        let near = |found: f64, area: f64| (found - area / 36.0).abs() < 1e-12;
        assert!(near(beyond[0], 1.0) && near(beyond[1], 15.0), "{beyond:?}");
        assert!(near(bins[0], 2.0) && near(bins[9], 3.0) && near(bins[10], 9.0), "{bins:?}");
        assert!(near(bins[19], 6.0) && near(bins.iter().sum(), 20.0), "{bins:?}");
    }
}
