//! Grid of swept constants on a picture: where its values stand, distances between them, and lines of one distance.

use super::axis::LogAxis;
use super::colour::sequential;
use super::drawing::{Document, Paint, Rectangle};
use super::raster::Image;

/// Where the grid is drawn.
pub(super) const PLOT: Rectangle = Rectangle { x: 96.0, y: 92.0, width: 620.0, height: 400.0 };
/// Bands of one colour.
pub(super) const BANDS: f64 = 10.0;
/// Pixels of the filled part for each unit of the drawing.
const SHARPNESS: f64 = 2.0;
/// An axis whose ends are this many times apart has equal steps for equal factors.
const WIDE: f64 = 8.0;

/// A constant and the values it takes, ascending.
#[derive(Clone, Debug)]
pub struct ContourAxis {
    pub name: String,
    pub values: Vec<f64>,
}

/// Room between the ends of an axis and the edge of the plot.
pub(super) const INSET: f64 = 18.0;

/// Where a value of an axis is drawn.
pub(super) fn position(axis: &ContourAxis, value: f64, [from, to]: [f64; 2]) -> f64 {
    let (low, high) = ends_of(axis);
    if high <= low {
        return 0.5 * (from + to);
    }
    if is_wide(axis) {
        return LogAxis { low, high, from, to }.place(value);
    }
    from + (to - from) * (value - low) / (high - low)
}

fn ends_of(axis: &ContourAxis) -> (f64, f64) {
    let values = || axis.values.iter().copied();
    (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
}

fn is_wide(axis: &ContourAxis) -> bool {
    let (low, high) = ends_of(axis);
    low > 0.0 && high / low > WIDE
}

/// The values that are labelled: those of the axis, without any that would stand too near to the one before.
pub(super) fn labelled(axis: &ContourAxis, ends: [f64; 2]) -> Vec<f64> {
    let mut told: Vec<f64> = Vec::new();
    for &value in &axis.values {
        let here = position(axis, value, ends);
        if told.iter().all(|&other| (position(axis, other, ends) - here).abs() > 34.0) {
            told.push(value);
        }
    }
    told
}

/// The band of a distance as a part of the range, in the middle of the band.
fn band([low, high]: [f64; 2], distance: f64) -> f64 {
    let share = ((distance - low) / (high - low)).clamp(0.0, 1.0);
    ((share * BANDS).floor().min(BANDS - 1.0) + 0.5) / BANDS
}

/// Distances at the places of two axes, linear between them as they are drawn.
pub(super) struct Grid<'a> {
    pub across: &'a ContourAxis,
    pub upwards: &'a ContourAxis,
    /// `upwards` fastest.
    pub distances: &'a [Option<f64>],
}

impl Grid<'_> {
    fn at(&self, column: usize, row: usize) -> Option<f64> {
        self.distances[column * self.upwards.values.len() + row]
    }

    pub(super) fn xs(&self) -> Vec<f64> {
        let ends = [PLOT.x + INSET, PLOT.x + PLOT.width - INSET];
        self.across.values.iter().map(|&value| position(self.across, value, ends)).collect()
    }

    pub(super) fn ys(&self) -> Vec<f64> {
        let ends = [PLOT.y + PLOT.height - INSET, PLOT.y + INSET];
        self.upwards.values.iter().map(|&value| position(self.upwards, value, ends)).collect()
    }

    pub(super) fn place_of(&self, cell: usize) -> [f64; 2] {
        let rows = self.upwards.values.len();
        [self.xs()[cell / rows], self.ys()[cell % rows]]
    }

    pub(super) fn words(&self, cell: usize) -> String {
        let rows = self.upwards.values.len();
        let (across, upwards) = (self.across.values[cell / rows], self.upwards.values[cell % rows]);
        format!("{} {across}, {} {upwards}", self.across.name, self.upwards.name)
    }

    /// The distance at a place of the drawing; none outside of the grid and beside what was not solved.
    pub(super) fn between(&self, [x, y]: [f64; 2], xs: &[f64], ys: &[f64]) -> Option<f64> {
        let (column, s) = interval(xs, x)?;
        let (row, t) = interval(ys, y)?;
        let (right, above) = ((column + 1).min(xs.len() - 1), (row + 1).min(ys.len() - 1));
        let low = self.at(column, row)? * (1.0 - s) + self.at(right, row)? * s;
        let high = self.at(column, above)? * (1.0 - s) + self.at(right, above)? * s;
        Some(low * (1.0 - t) + high * t)
    }

    pub(super) fn image(&self, range: [f64; 2]) -> Image {
        let [width, height] = [PLOT.width, PLOT.height].map(|side| (side * SHARPNESS) as usize);
        let (xs, ys) = (self.xs(), self.ys());
        let mut pixels = Vec::with_capacity(width * height);
        for line in 0..height {
            for column in 0..width {
                let [x, y] = [column, line].map(|place| (place as f64 + 0.5) / SHARPNESS);
                let found = self.between([PLOT.x + x, PLOT.y + y], &xs, &ys);
                pixels.push(match found {
                    Some(distance) => {
                        let [red, green, blue] = sequential(band(range, distance));
                        [red, green, blue, 255]
                    }
                    None => [0; 4],
                });
            }
        }
        Image { width, height, pixels }
    }

    /// The line of one distance: through each triangle of each field of the grid, its corners and its middle.
    pub(super) fn write_level(
        &self,
        document: &mut Document,
        level: f64,
        (width, colour, words): (f64, &str, &str),
    ) {
        let (xs, ys) = (self.xs(), self.ys());
        let mut steps = String::new();
        for column in 1..xs.len() {
            for row in 1..ys.len() {
                let corner = |c: usize, r: usize| Some(([xs[c], ys[r]], self.at(c, r)?));
                let ring =
                    [(column - 1, row - 1), (column, row - 1), (column, row), (column - 1, row)];
                let Some(ring) =
                    ring.map(|(c, r)| corner(c, r)).into_iter().collect::<Option<Vec<_>>>()
                else {
                    continue;
                };
                let (mut place, mut value) = ([0.0; 2], 0.0);
                for (at, own) in &ring {
                    place = [place[0] + at[0] / 4.0, place[1] + at[1] / 4.0];
                    value += own / 4.0;
                }
                let middle = (place, value);
                for side in 0..4 {
                    let triangle = [ring[side], ring[(side + 1) % 4], middle];
                    if let Some([from, to]) = crossing(&triangle, level) {
                        steps +=
                            &format!("M{:.1} {:.1}L{:.1} {:.1}", from[0], from[1], to[0], to[1]);
                    }
                }
            }
        }
        if !steps.is_empty() {
            document.open("contour", words);
            document.path(&steps, Paint::line(colour, width));
            document.close();
        }
    }
}

/// Where a level crosses two sides of a triangle.
pub(super) fn crossing(triangle: &[([f64; 2], f64); 3], level: f64) -> Option<[[f64; 2]; 2]> {
    let mut ends = Vec::new();
    for side in 0..3 {
        let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
        if (from.1 < level) != (to.1 < level) {
            let share = (level - from.1) / (to.1 - from.1);
            ends.push([0, 1].map(|k| from.0[k] + share * (to.0[k] - from.0[k])));
        }
    }
    <[[f64; 2]; 2]>::try_from(ends).ok()
}

/// The interval of monotone places that holds one, and how far into it; none outside of all. A single place holds all.
fn interval(places: &[f64], at: f64) -> Option<(usize, f64)> {
    if places.len() < 2 {
        return Some((0, 0.0));
    }
    let holds = |pair: &[f64]| (pair[0].min(pair[1])..=pair[0].max(pair[1])).contains(&at);
    let found = places.windows(2).position(holds)?;
    let (from, to) = (places[found], places[found + 1]);
    Some((found, if to == from { 0.0 } else { (at - from) / (to - from) }))
}
