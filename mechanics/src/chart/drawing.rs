//! A drawing: rectangles, lines, words that fit, and images, as a list that is written as SVG or as PDF.

/// Words are estimated with these widths, in font sizes: those of DejaVu Sans, the widest of the
/// fonts asked for, so that a viewer that has another one needs less room.
const WIDTH_NARROW: f64 = 0.40;
const WIDTH_NORMAL: f64 = 0.635;
const WIDTH_WIDE: f64 = 1.0;

use super::colour::{FAINT_INK, INK};

/// How words are set.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    /// Font size in units of the document.
    pub size: f64,
    pub bold: bool,
    /// The colour of the letters.
    pub ink: &'static str,
    /// A white edge around the letters, for words over lines.
    pub edge: bool,
    pub anchor: Anchor,
}

#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// How a path is drawn.
#[derive(Clone, Copy)]
pub struct Paint<'a> {
    /// A colour or `none`.
    pub fill: &'a str,
    pub fill_opacity: f64,
    /// A colour or `none`.
    pub stroke: &'a str,
    pub stroke_width: f64,
    /// Lengths of dashes and gaps; empty for an unbroken line.
    pub dashes: &'a str,
    pub opacity: f64,
}

impl<'a> Paint<'a> {
    /// An unbroken line without an inside.
    pub fn line(stroke: &'a str, stroke_width: f64) -> Self {
        Paint { fill: "none", stroke, stroke_width, ..Paint::inside("none") }
    }

    /// An inside without a line around it.
    pub fn inside(fill: &'a str) -> Self {
        let (stroke, stroke_width) = ("none", 0.0);
        Paint { fill, fill_opacity: 1.0, stroke, stroke_width, dashes: "", opacity: 1.0 }
    }
}

impl Style {
    pub fn of(size: f64) -> Self {
        Style { size, bold: false, ink: INK, edge: false, anchor: Anchor::Start }
    }

    pub fn bold(self) -> Self {
        Style { bold: true, ..self }
    }

    pub fn faint(self) -> Self {
        self.coloured(FAINT_INK)
    }

    pub fn coloured(self, ink: &'static str) -> Self {
        Style { ink, ..self }
    }

    pub fn edged(self) -> Self {
        Style { edge: true, ..self }
    }

    pub fn middle(self) -> Self {
        Style { anchor: Anchor::Middle, ..self }
    }

    pub fn end(self) -> Self {
        Style { anchor: Anchor::End, ..self }
    }
}

/// A rectangle from its top left.
#[derive(Clone, Copy)]
pub struct Rectangle {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

/// Which way words run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Run {
    Level,
    /// Upwards, with their middle at the point.
    Upwards,
}

/// How the path of an item is drawn, as [`Paint`].
#[derive(Clone, Debug)]
pub struct OwnPaint {
    pub fill: String,
    pub fill_opacity: f64,
    pub stroke: String,
    pub stroke_width: f64,
    pub dashes: String,
    pub opacity: f64,
}

/// One thing of a drawing; later ones lie over earlier ones.
pub enum Item {
    Rectangle {
        place: Rectangle,
        fill: String,
        corner: f64,
    },
    /// Evenly spaced colours, the first at the foot.
    Gradient {
        place: Rectangle,
        colours: Vec<String>,
    },
    Line {
        from: [f64; 2],
        to: [f64; 2],
    },
    Path {
        steps: String,
        paint: OwnPaint,
    },
    Stroke {
        points: Vec<[f64; 2]>,
        colour: String,
        width: f64,
    },
    Text {
        at: [f64; 2],
        run: Run,
        style: Style,
        words: String,
    },
    /// The bytes of a PNG file.
    Image {
        place: Rectangle,
        png: Vec<u8>,
    },
    /// Another drawing, as large as its place.
    Drawing {
        place: Rectangle,
        drawing: Document,
    },
    /// What follows until [`Item::Close`] belongs together, and has a name.
    Open {
        class: String,
        words: String,
        /// Of what it is, for programs: attributes `data-NAME` of an SVG.
        data: Vec<(&'static str, String)>,
    },
    Close,
}

/// A drawing in the making; lengths in its own units, one for a pixel at 100 %.
pub struct Document {
    pub items: Vec<Item>,
    pub width: f64,
    pub height: f64,
}

impl Document {
    pub fn new(width: f64, height: f64) -> Self {
        Document { items: Vec::new(), width, height }
    }

    pub fn rectangle(&mut self, place: Rectangle, fill: &str, corner: f64) {
        self.items.push(Item::Rectangle { place, fill: fill.to_owned(), corner });
    }

    /// A rectangle that runs through evenly spaced colours, the first at its foot.
    pub fn gradient(&mut self, place: Rectangle, colours: &[String]) {
        self.items.push(Item::Gradient { place, colours: colours.to_vec() });
    }

    pub fn line(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.items.push(Item::Line { from, to });
    }

    /// A path in the words of SVG (moves, lines, arcs), with coordinates of the document.
    pub fn path(&mut self, steps: &str, paint: Paint) {
        let Paint { fill, fill_opacity, stroke, stroke_width, dashes, opacity } = paint;
        let [fill, stroke, dashes] = [fill, stroke, dashes].map(str::to_owned);
        let paint = OwnPaint { fill, fill_opacity, stroke, stroke_width, dashes, opacity };
        self.items.push(Item::Path { steps: steps.to_owned(), paint });
    }

    /// What follows until [`Document::close`] belongs together; a viewer shows the words beside the pointer.
    pub fn open(&mut self, class: &str, words: &str) {
        self.open_with(class, words, Vec::new());
    }

    /// The same with what it is of, for programs: names and values.
    pub fn open_with(&mut self, class: &str, words: &str, data: Vec<(&'static str, String)>) {
        self.items.push(Item::Open { class: class.to_owned(), words: words.to_owned(), data });
    }

    pub fn close(&mut self) {
        self.items.push(Item::Close);
    }

    /// Words that run upwards, their middle at the point.
    pub fn text_upwards(&mut self, at: [f64; 2], room: f64, style: Style, words: &str) {
        self.words(at, Run::Upwards, style.middle(), &fitting(words, room, style.middle()));
    }

    /// A line through several points in a colour of its own.
    pub fn stroke(&mut self, points: &[[f64; 2]], colour: &str, width: f64) {
        let (points, colour) = (points.to_vec(), colour.to_owned());
        self.items.push(Item::Stroke { points, colour, width });
    }

    /// Words on one line, at most `room` wide: what does not fit is cut and marked by an ellipsis.
    pub fn text(&mut self, at: [f64; 2], room: f64, style: Style, words: &str) {
        self.words(at, Run::Level, style, &fitting(words, room, style));
    }

    /// Words as they are, on one line.
    pub fn words(&mut self, at: [f64; 2], run: Run, style: Style, words: &str) {
        self.items.push(Item::Text { at, run, style, words: words.to_owned() });
    }

    /// An image in the bytes of a PNG file.
    pub fn image(&mut self, place: Rectangle, png: &[u8]) {
        self.items.push(Item::Image { place, png: png.to_vec() });
    }

    /// Another drawing, as large as the place.
    pub fn drawing(&mut self, place: Rectangle, drawing: Document) {
        self.items.push(Item::Drawing { place, drawing });
    }
}

/// How wide words come out at most, in units of the document.
pub fn estimated_width(words: &str, style: Style) -> f64 {
    let of_bold = if style.bold { 1.1 } else { 1.0 };
    let widths = words.chars().map(|letter| match letter {
        ' ' | '.' | ',' | ':' | ';' | '-' | '\'' | '|' | '(' | ')' | 'i' | 'j' | 'l' | 't'
        | 'f' | 'r' | 'I' => WIDTH_NARROW,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '\u{2014}' => WIDTH_WIDE,
        letter if letter.is_ascii() || ('\u{80}'..'\u{2100}').contains(&letter) => WIDTH_NORMAL,
        _ => 1.1,
    });
    widths.sum::<f64>() * style.size * of_bold
}

fn fitting(words: &str, room: f64, style: Style) -> String {
    if estimated_width(words, style) <= room {
        return words.to_owned();
    }
    let mut kept = String::new();
    for letter in words.chars() {
        kept.push(letter);
        if estimated_width(&format!("{kept}…"), style) > room {
            kept.pop();
            break;
        }
    }
    format!("{}…", kept.trim_end())
}

/// Breaks words at spaces into lines of at most `room`.
pub fn wrapped(words: &str, room: f64, style: Style) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        match lines.last_mut() {
            Some(line) if estimated_width(&format!("{line} {word}"), style) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_too_long_are_cut_to_their_room() {
        let style = Style::of(12.0).bold();
        let cut = fitting(&"mandibula ".repeat(30), 120.0, style);
        assert!(cut.ends_with("a…") || cut.ends_with('…'));
        assert!(estimated_width(&cut, style) <= 120.0 && cut.len() > 8);
        assert_eq!(fitting("jaw", 120.0, style), "jaw");
    }

    #[test]
    fn lines_are_broken_between_words() {
        let style = Style::of(12.0);
        let lines = wrapped("mean 1.2 mm, median 0.8 mm, largest 6.1 mm", 130.0, style);
        assert!(lines.len() > 1);
        assert!(lines.iter().all(|line| estimated_width(line, style) <= 130.0));
        assert_eq!(lines.join(" "), "mean 1.2 mm, median 0.8 mm, largest 6.1 mm");
    }
}
