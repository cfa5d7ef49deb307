//! Labels beside marks: near their mark and never over each other, with a thin line where they do not touch it.

use super::drawing::{Rectangle, Style, estimated_width};

/// A straight line between two points.
pub type Segment = [[f64; 2]; 2];

/// Where the words of a mark stand.
#[derive(Clone, Copy)]
pub struct Callout {
    pub place: Rectangle,
    /// From the mark to the words, where they do not stand right beside it.
    pub leader: Option<Segment>,
}

/// Occupied areas.
pub struct OccupiedAreas {
    inside: Rectangle,
    /// Words and marks: nothing may lie over them.
    solid: Vec<Rectangle>,
    /// Lines that lead to words: words may not lie over them.
    leaders: Vec<Segment>,
    /// Lines that words had better not lie over, and how bad that is.
    lines: Vec<(Segment, f64)>,
}

/// Directions around a mark, and how far words may stand off it; nearer places are tried first.
const DIRECTIONS: u32 = 24;
const REACHES: [f64; 8] = [0.0, 9.0, 18.0, 30.0, 44.0, 60.0, 80.0, 104.0];
/// Between a mark and words that touch it.
const BESIDE: f64 = 4.0;
/// What a place costs, in units of the document that it is farther: to the left rather than to the right; beside another
/// mark, whose name it then seems to be; and a leader across another or across words' lines.
const LEFT: f64 = 4.0;
const BESIDE_OTHER: f64 = 16.0;
const CROSSED: f64 = 14.0;

impl OccupiedAreas {
    pub fn within(inside: Rectangle) -> Self {
        OccupiedAreas { inside, solid: Vec::new(), leaders: Vec::new(), lines: Vec::new() }
    }

    /// A mark around a point.
    pub fn add_mark(&mut self, [x, y]: [f64; 2], radius: f64) {
        let (x, y, side) = (x - radius, y - radius, 2.0 * radius);
        self.solid.push(Rectangle { x, y, width: side, height: side });
    }

    /// A line, and how much nearer words would have to be over it.
    pub fn add_line(&mut self, line: Segment, weight: f64) {
        self.lines.push((line, weight));
    }

    /// Room for words beside a mark; none where they would cover something. Takes it.
    pub fn find(
        &mut self,
        at: [f64; 2],
        radius: f64,
        style: Style,
        words: &str,
    ) -> Option<Callout> {
        let (width, height) = (estimated_width(words, style) * 0.93, style.size * 1.25);
        let mut best: Option<(f64, Callout)> = None;
        for (reach, turn) in REACHES.into_iter().flat_map(|r| (0..DIRECTIONS).map(move |d| (r, d)))
        {
            let (down, right) =
                (f64::from(turn) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
            let off = radius + BESIDE + reach;
            let middle = [at[0] + right * (off + width / 2.0), at[1] + down * (off + height / 2.0)];
            let (x, y) = (middle[0] - width / 2.0, middle[1] - height / 2.0);
            let place = Rectangle { x, y, width, height };
            let leader = (reach > 0.0).then(|| leader(at, radius, &place));
            let callout = Callout { place, leader };
            if self.is_free(at, &callout) {
                let cost = reach + LEFT * (1.0 - right) + self.cost(at, &callout);
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, callout));
                }
            }
        }
        let (_, callout) = best?;
        self.solid.push(callout.place);
        self.leaders.extend(callout.leader);
        Some(callout)
    }

    fn is_free(&self, at: [f64; 2], callout: &Callout) -> bool {
        let place = &callout.place;
        let others = self.solid.iter().filter(|solid| !holds(solid, at));
        contains(&self.inside, place)
            && !self.solid.iter().any(|solid| meet(solid, place))
            && !self.leaders.iter().any(|line| crosses(line, place))
            && callout
                .leader
                .is_none_or(|own| others.into_iter().all(|solid| !crosses(&own, solid)))
    }

    fn cost(&self, at: [f64; 2], Callout { place, leader }: &Callout) -> f64 {
        let over = self.lines.iter().filter(|(line, _)| crosses(line, place));
        let covered: f64 = over.map(|(_, weight)| weight).sum();
        let around = grown(place, BESIDE);
        let beside = self.solid.iter().any(|solid| !holds(solid, at) && meet(solid, &around));
        let crossed =
            self.leaders.iter().filter(|other| leader.is_some_and(|own| cross(&own, other)));
        let seems = if beside && leader.is_none() { BESIDE_OTHER } else { 0.0 };
        covered + seems + CROSSED * crossed.count() as f64
    }
}

/// From the edge of a mark to the nearest point of the words.
fn leader(at: [f64; 2], radius: f64, place: &Rectangle) -> Segment {
    let end =
        [at[0].clamp(place.x, place.x + place.width), at[1].clamp(place.y, place.y + place.height)];
    let far = (end[0] - at[0]).hypot(end[1] - at[1]).max(1e-9);
    let start = [0, 1].map(|k| at[k] + (end[k] - at[k]) * (radius / far).min(1.0));
    [start, end]
}

fn holds(area: &Rectangle, [x, y]: [f64; 2]) -> bool {
    (area.x..=area.x + area.width).contains(&x) && (area.y..=area.y + area.height).contains(&y)
}

fn grown(area: &Rectangle, by: f64) -> Rectangle {
    let (x, y) = (area.x - by, area.y - by);
    Rectangle { x, y, width: area.width + 2.0 * by, height: area.height + 2.0 * by }
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

/// Whether a part of a line lies in an area (Liang and Barsky, A new concept and method for line clipping, 1984).
fn crosses([from, to]: &Segment, area: &Rectangle) -> bool {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (axis, low, size) in [(0, area.x, area.width), (1, area.y, area.height)] {
        let along = to[axis] - from[axis];
        let [enters, leaves] = [low, low + size].map(|edge| (edge - from[axis]) / along);
        if along == 0.0 {
            if from[axis] < low || from[axis] > low + size {
                return false;
            }
            continue;
        }
        first = first.max(enters.min(leaves));
        last = last.min(enters.max(leaves));
    }
    first < last
}

/// Whether two lines cross.
fn cross(a: &Segment, b: &Segment) -> bool {
    let side = |[from, to]: &Segment, [x, y]: [f64; 2]| {
        (to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0])
    };
    side(a, b[0]) * side(a, b[1]) < 0.0 && side(b, a[0]) * side(b, a[1]) < 0.0
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
        let mut found: Vec<Callout> = Vec::new();
        while let Some(callout) = taken.find(mark, 6.0, Style::of(12.0), "fem_linear") {
            assert!(contains(&inside, &callout.place));
            assert!(found.iter().all(|other| !meet(&other.place, &callout.place)));
            let leaders = found.iter().filter_map(|other| other.leader);
            assert!(leaders.into_iter().all(|leader| !crosses(&leader, &callout.place)));
            found.push(callout);
        }
        assert!(found.len() > 4 && found[0].place.x > mark[0], "{}", found.len());
        assert!(found[0].leader.is_none() && found[found.len() - 1].leader.is_some());
    }

    #[test]
    fn a_line_is_kept_free_where_there_is_another_place() {
        let mut taken =
            OccupiedAreas::within(Rectangle { x: 0.0, y: 0.0, width: 400.0, height: 200.0 });
        taken.add_line([[200.0, 100.0], [400.0, 100.0]], 12.0);
        let Callout { place, .. } =
            taken.find([200.0, 100.0], 6.0, Style::of(12.0), "msm").unwrap();
        assert!(!crosses(&[[200.0, 100.0], [400.0, 100.0]], &place));
    }

    #[test]
    fn words_do_not_stand_where_they_seem_to_be_those_of_another_mark() {
        let mut taken =
            OccupiedAreas::within(Rectangle { x: 0.0, y: 0.0, width: 400.0, height: 200.0 });
        let marks = [[100.0, 100.0], [160.0, 100.0]];
        marks.into_iter().for_each(|mark| taken.add_mark(mark, 6.0));
        let Callout { place, .. } = taken.find(marks[0], 6.0, Style::of(12.0), "spline").unwrap();
        assert!(!meet(&grown(&place, BESIDE), &taken.solid[1]));
    }

    #[test]
    fn a_line_crosses_an_area_where_a_part_of_it_lies_inside() {
        let area = Rectangle { x: 10.0, y: 10.0, width: 10.0, height: 10.0 };
        for (line, is_across) in [
            ([[0.0, 0.0], [30.0, 30.0]], true),
            ([[12.0, 12.0], [13.0, 13.0]], true),
            ([[15.0, 0.0], [15.0, 30.0]], true),
            ([[0.0, 0.0], [9.0, 30.0]], false),
            ([[5.0, 0.0], [5.0, 30.0]], false),
            ([[0.0, 15.0], [9.0, 15.0]], false),
        ] {
            assert_eq!(crosses(&line, &area), is_across, "{line:?}");
        }
        assert!(cross(&[[0.0, 0.0], [2.0, 2.0]], &[[0.0, 2.0], [2.0, 0.0]]));
        assert!(!cross(&[[0.0, 0.0], [2.0, 2.0]], &[[3.0, 2.0], [5.0, 0.0]]));
    }
}
