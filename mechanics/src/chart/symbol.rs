//! Marks that differ in shape and colour, so that either alone tells them apart.

use super::colour::{FAINT_INK, SERIES, SERIES_INK};
use super::drawing::{Document, Paint};

/// A shape and a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    pub colour: &'static str,
    shape: Shape,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Circle,
    /// Corners, and by how many degrees the first is turned from the top.
    Polygon(u32, u32),
    /// Points, with the valleys at 45 % of the radius.
    Star(u32),
    /// An upright cross.
    Cross,
}

const SHAPES: [Shape; 9] = [
    Shape::Circle,
    Shape::Polygon(4, 45),
    Shape::Polygon(3, 0),
    Shape::Polygon(4, 0),
    Shape::Star(5),
    Shape::Polygon(3, 180),
    Shape::Cross,
    Shape::Polygon(6, 30),
    Shape::Star(4),
];

impl Symbol {
    /// The symbol of a series; 63 are different.
    pub fn of(series: usize) -> Symbol {
        Symbol { colour: SERIES[series % SERIES.len()], shape: SHAPES[series % SHAPES.len()] }
    }

    /// A circle in the colour of words, for what holds of every series.
    pub fn neutral() -> Symbol {
        Symbol { colour: FAINT_INK, shape: Shape::Circle }
    }

    /// The colour of its words.
    pub fn ink(&self) -> &'static str {
        let found = SERIES.iter().position(|colour| *colour == self.colour);
        found.map_or(self.colour, |place| SERIES_INK[place])
    }

    /// Draws it around a point; `filled` from 0, an outline, to 1.
    pub fn draw(&self, document: &mut Document, at: [f64; 2], radius: f64, filled: f64) {
        let steps = self.outline(at, radius);
        document.path(&steps, Paint::line("#ffffff", 4.5));
        document.path(&steps, Paint::inside("#ffffff"));
        let paint =
            Paint { fill: self.colour, fill_opacity: filled, ..Paint::line(self.colour, 1.8) };
        document.path(&steps, paint);
    }

    /// Shapes of the same area as a circle of the radius.
    fn outline(&self, [x, y]: [f64; 2], radius: f64) -> String {
        let corner = |radius: f64, degrees: f64| {
            let angle = degrees.to_radians();
            format!("{:.1} {:.1}", x + radius * angle.sin(), y - radius * angle.cos())
        };
        let closed = |corners: Vec<String>| format!("M{}Z", corners.join("L"));
        match self.shape {
            Shape::Circle => {
                let (left, right) = (x - radius, x + radius);
                format!(
                    "M{left:.1} {y:.1}A{radius:.1} {radius:.1} 0 1 1 {right:.1} {y:.1}A{radius:.1} {radius:.1} 0 1 1 {left:.1} {y:.1}Z"
                )
            }
            Shape::Polygon(corners, turned) => {
                let step = 360.0 / f64::from(corners);
                let area = f64::from(corners) / 2.0 * step.to_radians().sin();
                let radius = radius * (std::f64::consts::PI / area).sqrt();
                let at = |k: u32| corner(radius, f64::from(turned) + step * f64::from(k));
                closed((0..corners).map(at).collect())
            }
            Shape::Star(points) => {
                let step = 180.0 / f64::from(points);
                let at = |k: u32| {
                    let length = if k.is_multiple_of(2) { 1.55 } else { 0.7 };
                    corner(radius * length, step * f64::from(k))
                };
                closed((0..2 * points).map(at).collect())
            }
            Shape::Cross => {
                let (arm, half) = (1.2 * radius, 0.42 * radius);
                let around = [
                    (-half, -arm),
                    (half, -arm),
                    (half, -half),
                    (arm, -half),
                    (arm, half),
                    (half, half),
                    (half, arm),
                    (-half, arm),
                    (-half, half),
                    (-arm, half),
                    (-arm, -half),
                    (-half, -half),
                ];
                let at = |(dx, dy): (f64, f64)| format!("{:.1} {:.1}", x + dx, y + dy);
                closed(around.into_iter().map(at).collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_differ_in_shape_and_in_colour_and_sixty_three_are_different() {
        let symbols: Vec<Symbol> = (0..63).map(Symbol::of).collect();
        for pair in symbols.windows(2) {
            assert!(pair[0].colour != pair[1].colour && pair[0].shape != pair[1].shape);
        }
        for (index, symbol) in symbols.iter().enumerate() {
            assert_eq!(symbols.iter().position(|other| other == symbol), Some(index));
        }
    }
}
