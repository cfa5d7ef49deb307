//! Labels beside marks: near their mark and never over each other.

use super::drawing::{Rectangle, Style, estimated_width};

/// Occupied areas.
pub struct OccupiedAreas {
    inside: Rectangle,
    /// Words and marks: nothing may lie over them.
    solid: Vec<Rectangle>,
    /// Lines: words had better not lie over them.
    lines: Vec<Rectangle>,
}

/// Directions from the mark in which words may stand, the best first: right, left, then up and down.
const DIRECTIONS: [(f64, f64); 10] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (1.0, -0.8),
    (1.0, 0.8),
    (-1.0, -0.8),
    (-1.0, 0.8),
    (0.0, -1.0),
    (0.0, 1.0),
    (1.0, -1.8),
    (1.0, 1.8),
];
/// How far words may stand off, in heights of a line.
const DISTANCES: [f64; 4] = [0.0, 0.9, 1.9, 3.2];

impl OccupiedAreas {
    pub fn within(inside: Rectangle) -> Self {
        OccupiedAreas { inside, solid: Vec::new(), lines: Vec::new() }
    }

    /// A mark around a point.
    pub fn add_mark(&mut self, [x, y]: [f64; 2], radius: f64) {
        let (x, y, side) = (x - radius, y - radius, 2.0 * radius);
        self.solid.push(Rectangle { x, y, width: side, height: side });
    }

    /// A line between two points, upright or level.
    pub fn add_line(&mut self, a: [f64; 2], b: [f64; 2]) {
        let (x, y) = (a[0].min(b[0]) - 1.5, a[1].min(b[1]) - 1.5);
        let (width, height) = ((a[0] - b[0]).abs() + 3.0, (a[1] - b[1]).abs() + 3.0);
        self.lines.push(Rectangle { x, y, width, height });
    }

    /// Room for words beside a mark; none where they would cover something. Takes it.
    pub fn find(
        &mut self,
        at: [f64; 2],
        radius: f64,
        style: Style,
        words: &str,
    ) -> Option<Rectangle> {
        let (width, height) = (estimated_width(words, style) * 0.93, style.size * 1.25);
        let mut best: Option<(f64, Rectangle)> = None;
        for (far, distance) in DISTANCES.into_iter().enumerate() {
            for (rank, (right, down)) in DIRECTIONS.into_iter().enumerate() {
                let reach = radius + 5.0 + distance * height;
                let middle = [
                    at[0] + right * (radius + 6.0 + 0.4 * distance * height + width / 2.0),
                    at[1] + down * (reach * 0.8 + height / 2.0),
                ];
                let (x, y) = (middle[0] - width / 2.0, middle[1] - height / 2.0);
                let place = Rectangle { x, y, width, height };
                if !contains(&self.inside, &place) || self.solid.iter().any(|o| meet(o, &place)) {
                    continue;
                }
                let crossed = self.lines.iter().filter(|line| meet(line, &place)).count();
                let cost = crossed as f64 * 12.0 + far as f64 * 8.0 + rank as f64 * 0.5;
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, place));
                }
            }
        }
        let (_, place) = best?;
        self.solid.push(place);
        Some(place)
    }
}

fn meet(a: &Rectangle, b: &Rectangle) -> bool {
    a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height
}

fn contains(outer: &Rectangle, inner: &Rectangle) -> bool {
    let (right, foot) = (outer.x + outer.width, outer.y + outer.height);
    inner.x >= outer.x
        && inner.y >= outer.y
        && inner.x + inner.width <= right
        && inner.y + inner.height <= foot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_never_lie_over_words_and_give_up_where_there_is_no_room() {
        let inside = Rectangle { x: 0.0, y: 0.0, width: 300.0, height: 120.0 };
        let mut taken = OccupiedAreas::within(inside);
        let mark = [150.0, 60.0];
        taken.add_mark(mark, 6.0);
        let mut found = Vec::new();
        while let Some(place) = taken.find(mark, 6.0, Style::of(12.0), "fem_linear") {
            assert!(contains(&inside, &place));
            assert!(found.iter().all(|other| !meet(other, &place)));
            found.push(place);
        }
        assert!(found.len() > 4 && found[0].x > mark[0], "{}", found.len());
    }

    #[test]
    fn a_line_is_kept_free_where_there_is_another_place() {
        let mut taken =
            OccupiedAreas::within(Rectangle { x: 0.0, y: 0.0, width: 400.0, height: 200.0 });
        taken.add_line([200.0, 100.0], [400.0, 100.0]);
        let place = taken.find([200.0, 100.0], 6.0, Style::of(12.0), "msm").unwrap();
        assert!(place.x + place.width < 200.0);
    }
}
