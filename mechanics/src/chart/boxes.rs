//! Groups of numbers side by side: a box of quartiles with whiskers to the ends, a dot for each number, and what tests of
//! pairs of groups say.

use super::colour::{FAINT_INK, GRID, INK};
use super::drawing::{Document, Paint, Rectangle, Style, wrapped};
use super::legend::Scale;
use super::svg::svg;
use super::symbol::Symbol;

/// Content of the picture. Values are not negative.
pub struct BoxesPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    /// Beside the axis of the values.
    pub value_name: &'a str,
    pub groups: &'a [BoxesGroup],
    /// Brackets over two groups by their numbers, with words such as `p = 0.02`.
    pub pairs: &'a [([usize; 2], String)],
    /// Below the plot.
    pub notes: &'a [String],
}

/// A group of numbers.
pub struct BoxesGroup {
    pub name: String,
    /// Smallest, lower quartile, median, upper quartile, largest.
    pub five: [f64; 5],
    /// What a dot is called, and its value.
    pub values: Vec<(String, f64)>,
}

const WIDTH: f64 = 900.0;
const MARGIN: f64 = 28.0;
const LINE: f64 = 17.0;
const HEIGHT: f64 = 340.0;
const LEFT: f64 = 84.0;
const BRACKET: f64 = 26.0;
const WIDEST_BOX: f64 = 74.0;

/// Dots beside each other: multiples of the golden ratio never fall into columns.
const GOLDEN: f64 = 0.618_033_988_75;

impl BoxesPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> String {
        let room = WIDTH - 2.0 * MARGIN;
        let style = Style::of(12.0).faint();
        let notes: Vec<String> =
            self.notes.iter().flat_map(|note| wrapped(note, room, style)).collect();
        let plot = self.plot();
        let foot = plot.y + plot.height + 56.0;
        let mut document = Document::new(WIDTH, foot + LINE * notes.len() as f64 + 8.0);
        document.text([MARGIN, 38.0], room, Style::of(19.0).bold(), self.title);
        document.text([MARGIN, 62.0], room, Style::of(13.0).faint(), self.subtitle);
        self.write_grid(&mut document);
        for number in 0..self.groups.len() {
            self.write_group(&mut document, number);
        }
        self.write_brackets(&mut document);
        for (line, words) in notes.iter().enumerate() {
            document.text([MARGIN, foot + LINE * line as f64], room, style, words);
        }
        svg(&document, self.title)
    }

    /// Below the brackets.
    fn plot(&self) -> Rectangle {
        let y = 84.0 + BRACKET * self.pairs.len() as f64;
        Rectangle { x: LEFT, y, width: WIDTH - LEFT - MARGIN, height: HEIGHT }
    }

    fn scale(&self) -> Scale {
        let largest = self.groups.iter().map(|group| group.five[4]);
        Scale::covering(largest.fold(0.0, f64::max))
    }

    fn height_of(&self, value: f64) -> f64 {
        let (plot, most) = (self.plot(), self.scale().maximum());
        plot.y + plot.height * (1.0 - (value / most).clamp(0.0, 1.0))
    }

    /// The width of a group.
    fn column(&self) -> f64 {
        self.plot().width / self.groups.len().max(1) as f64
    }

    fn middle_of(&self, number: usize) -> f64 {
        LEFT + self.column() * (number as f64 + 0.5)
    }

    fn write_grid(&self, document: &mut Document) {
        let (plot, scale) = (self.plot(), self.scale());
        for &tick in &scale.ticks {
            let y = self.height_of(tick);
            document.stroke(&[[plot.x, y], [plot.x + plot.width, y]], GRID, 1.0);
            let label = scale.label(tick);
            document.text([plot.x - 8.0, y + 4.0], 60.0, Style::of(12.0).end(), &label);
        }
        let upwards = [26.0, plot.y + 0.5 * plot.height];
        document.text_upwards(upwards, plot.height, Style::of(13.0), self.value_name);
    }

    fn write_group(&self, document: &mut Document, number: usize) {
        let group = &self.groups[number];
        let symbol = Symbol::of(number);
        let (x, half) = (self.middle_of(number), (0.25 * self.column()).min(0.5 * WIDEST_BOX));
        let [least, lower, median, upper, most] = group.five.map(|value| self.height_of(value));
        let words =
            format!("{}: median {:.3}, {} in all", group.name, group.five[2], group.values.len());
        document.open("group", &words);
        for [from, to] in [[most, upper], [lower, least]] {
            document.stroke(&[[x, from], [x, to]], INK, 1.3);
        }
        for end in [most, least] {
            document.stroke(&[[x - 0.5 * half, end], [x + 0.5 * half, end]], INK, 1.3);
        }
        let (left, right) = (x - half, x + half);
        let steps = format!(
            "M{left:.1} {upper:.1}L{right:.1} {upper:.1}L{right:.1} {lower:.1}L{left:.1} {lower:.1}Z"
        );
        let paint = Paint { fill: symbol.colour, fill_opacity: 0.18, ..Paint::line(INK, 1.3) };
        document.path(&steps, paint);
        document.stroke(&[[left, median], [right, median]], INK, 2.6);
        document.close();
        for (place, (name, value)) in group.values.iter().enumerate() {
            let beside = ((place + 1) as f64 * GOLDEN).fract() - 0.5;
            let at = [x + 1.3 * half * beside, self.height_of(*value)];
            document.open("subject", &format!("{}, {name}: {value:.3}", group.name));
            symbol.draw(document, at, 3.4, 0.75);
            document.close();
        }
        let plot = self.plot();
        let below = [x, plot.y + plot.height + 22.0];
        document.text(below, self.column() - 6.0, Style::of(13.0).middle(), &group.name);
    }

    /// Those of near groups lowest.
    fn write_brackets(&self, document: &mut Document) {
        let mut pairs: Vec<&([usize; 2], String)> = self.pairs.iter().collect();
        pairs.sort_by_key(|([from, to], _)| from.abs_diff(*to));
        for (level, ([from, to], words)) in pairs.into_iter().enumerate() {
            let y = self.plot().y - 8.0 - BRACKET * level as f64;
            let [left, right] = [from, to].map(|&number| self.middle_of(number));
            let path = [[left, y + 5.0], [left, y], [right, y], [right, y + 5.0]];
            document.stroke(&path, FAINT_INK, 1.1);
            let middle = [0.5 * (left + right), y - 4.0];
            document.text(middle, 220.0, Style::of(12.0).middle(), words);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_dots_and_brackets_stand_where_their_values_are() {
        let group = |name: &str, five: [f64; 5]| BoxesGroup {
            name: name.to_owned(),
            five,
            values: vec![("first".to_owned(), five[0]), ("last".to_owned(), five[4])],
        };
        let groups = [group("a", [0.2, 0.4, 0.5, 0.8, 1.0]), group("b", [0.1, 0.1, 0.3, 0.3, 0.6])];
        let picture = BoxesPicture {
            title: "t",
            subtitle: "s",
            value_name: "mm",
            groups: &groups,
            pairs: &[([0, 1], "p = 0.02".to_owned())],
            notes: &[],
        };
        assert_eq!((picture.height_of(0.0), picture.height_of(1.0)), (450.0, 110.0));
        assert_eq!((picture.middle_of(0), picture.middle_of(1)), (281.0, 675.0));
        let text = picture.to_svg();
        assert_eq!(text.matches("class=\"subject\"").count(), 4);
        assert_eq!(text.matches("class=\"group\"").count(), 2);
        assert!(text.contains("p = 0.02"));
        // The box of the first from .8 to .4.
        assert!(text.contains("M244.0 178.0L318.0 178.0L318.0 314.0L244.0 314.0Z"), "{text}");
    }
}
