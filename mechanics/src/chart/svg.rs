//! An SVG document: rectangles, words that fit, and images inside.

use base64::Engine;

/// Words are estimated with these widths, in font sizes: those of DejaVu Sans, the widest of the
/// fonts asked for, so that a viewer that has another one needs less room.
const WIDTH_NARROW: f64 = 0.40;
const WIDTH_NORMAL: f64 = 0.635;
const WIDTH_WIDE: f64 = 1.0;

const INK: &str = "#22262b";
const FAINT_INK: &str = "#5b636d";

/// How words are set.
#[derive(Clone, Copy)]
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

#[derive(Clone, Copy)]
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
pub struct Place {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

/// A document in the making; lengths in its own units, one for a pixel at 100 %.
pub struct Document {
    body: String,
    width: f64,
    height: f64,
}

impl Document {
    pub fn new(width: f64, height: f64) -> Self {
        Document { body: String::new(), width, height }
    }

    pub fn rectangle(&mut self, place: Place, fill: &str, corner: f64) {
        let Place { x, y, width, height } = place;
        self.body += &format!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"{corner}\" fill=\"{fill}\"/>\n"
        );
    }

    /// A rectangle that runs through evenly spaced colours, the first at its foot.
    pub fn gradient(&mut self, place: Place, colours: &[String]) {
        let last = colours.len().saturating_sub(1).max(1) as f64;
        self.body += "<linearGradient id=\"sequence\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">";
        for (step, colour) in colours.iter().enumerate() {
            let offset = step as f64 / last;
            self.body += &format!("<stop offset=\"{offset:.4}\" stop-color=\"{colour}\"/>");
        }
        self.body += "</linearGradient>\n";
        self.rectangle(place, "url(#sequence)", 0.0);
    }

    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
        self.body += &format!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{INK}\" stroke-width=\"1.2\"/>\n"
        );
    }

    /// A path in the words of SVG (moves, lines, arcs), with coordinates of the document.
    pub fn path(&mut self, steps: &str, paint: Paint) {
        let Paint { fill, fill_opacity, stroke, stroke_width, dashes, opacity } = paint;
        let dashes = match dashes {
            "" => String::new(),
            dashes => format!(" stroke-dasharray=\"{dashes}\""),
        };
        self.body += &format!(
            "<path d=\"{steps}\" fill=\"{fill}\" fill-opacity=\"{fill_opacity:.2}\" stroke=\"{stroke}\" stroke-width=\"{stroke_width}\" stroke-linejoin=\"round\" opacity=\"{opacity:.2}\"{dashes}/>\n"
        );
    }

    /// What follows until [`Document::close`] belongs together; a viewer shows the words beside the pointer.
    pub fn open(&mut self, class: &str, words: &str) {
        let words = escaped(words);
        self.body += &format!("<g class=\"{class}\"><title>{words}</title>\n");
    }

    pub fn close(&mut self) {
        self.body += "</g>\n";
    }

    /// Words that run upwards, their middle at the point.
    pub fn text_upwards(&mut self, [x, y]: [f64; 2], room: f64, style: Style, words: &str) {
        self.body += &format!("<g transform=\"translate({x:.1} {y:.1}) rotate(-90)\">\n");
        self.text([0.0, 0.0], room, style.middle(), words);
        self.close();
    }

    /// A line through several points in a colour of its own.
    pub fn stroke(&mut self, points: &[[f64; 2]], colour: &str, width: f64) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.body += &format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>\n",
            points.join(" "),
        );
    }

    /// Words that rise by this many degrees from where they begin.
    pub fn rising_text(&mut self, at: [f64; 2], degrees: f64, style: Style, words: &str) {
        let [x, y] = at;
        self.body += &format!("<g transform=\"rotate({:.1} {x:.1} {y:.1})\">", -degrees);
        self.text(at, f64::INFINITY, style, words);
        self.body += "</g>\n";
    }

    /// Words on one line, at most `room` wide: what does not fit is cut and marked by an ellipsis.
    pub fn text(&mut self, [x, y]: [f64; 2], room: f64, style: Style, words: &str) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if style.bold { "600" } else { "400" };
        let (size, fill) = (style.size, style.ink);
        let edge = match style.edge {
            true => {
                " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            }
            false => "",
        };
        self.body += &format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" font-weight=\"{weight}\" text-anchor=\"{anchor}\" fill=\"{fill}\"{edge}>{}</text>\n",
            escaped(&fitting(words, room, style)),
        );
    }

    /// An image in the bytes of a PNG file.
    pub fn image(&mut self, place: Place, png: &[u8]) {
        let Place { x, y, width, height } = place;
        let encoded = base64::engine::general_purpose::STANDARD.encode(png);
        self.body += &format!(
            "<image x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" href=\"data:image/png;base64,{encoded}\"/>\n"
        );
    }

    /// The whole document.
    pub fn finish(self, title: &str) -> String {
        let Document { body, width, height } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{body}</svg>\n",
            escaped(title),
        )
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

/// Without what XML reads as markup or does not allow at all.
fn escaped(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for letter in words.chars() {
        match letter {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            '\t' | '\n' | '\r' => text.push(' '),
            letter if letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}') => {
                text.push('\u{fffd}');
            }
            letter => text.push(letter),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_words_and_never_markup() {
        let mut document = Document::new(100.0, 50.0);
        let name = "a<script>\"&'\u{0}\n]]>";
        document.text([1.0, 2.0], 1000.0, Style::of(10.0), name);
        let text = document.finish(name);
        let mut reader = quick_xml::Reader::from_str(&text);
        let mut elements = Vec::new();
        loop {
            match reader.read_event() {
                Ok(quick_xml::events::Event::Start(start)) => {
                    elements.push(start.name().as_ref().as_bytes().to_vec());
                }
                Ok(quick_xml::events::Event::Eof) => break,
                Ok(_) => {}
                Err(error) => panic!("{error}"),
            }
        }
        assert_eq!(elements, [&b"svg"[..], b"title", b"text"]);
        assert!(!text.contains('\0') && text.contains("a&lt;script&gt;"));
    }

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
