//! A drawing as an SVG document.

use base64::Engine;

use super::colour::INK;
use super::drawing::{Anchor, Document, Item, OwnPaint, Rectangle, Run, Style};

/// The whole document, under a title.
pub fn svg(document: &Document, title: &str) -> String {
    let Document { items, width, height } = document;
    let body: String = items.iter().map(written).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{body}</svg>\n",
        escaped(title),
    )
}

fn written(item: &Item) -> String {
    match item {
        Item::Rectangle { place, fill, corner } => rectangle(place, fill, *corner),
        Item::Gradient { place, colours } => gradient(place, colours),
        Item::Line { from: [x1, y1], to: [x2, y2] } => format!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{INK}\" stroke-width=\"1.2\"/>\n"
        ),
        Item::Path { steps, paint } => path(steps, paint),
        Item::Stroke { points, colour, width } => stroke(points, colour, *width),
        Item::Text { at, run, style, words } => match run {
            Run::Level => text(*at, *style, words),
            Run::Upwards => format!(
                "<g transform=\"translate({:.1} {:.1}) rotate(-90)\">\n{}</g>\n",
                at[0],
                at[1],
                text([0.0, 0.0], *style, words)
            ),
        },
        Item::Image { place: Rectangle { x, y, width, height }, png } => format!(
            "<image x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" href=\"data:image/png;base64,{}\"/>\n",
            base64::engine::general_purpose::STANDARD.encode(png)
        ),
        Item::Drawing { place: Rectangle { x, y, width, height }, drawing } => format!(
            "<svg x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" viewBox=\"0 0 {:.0} {:.0}\">\n{}</svg>\n",
            drawing.width,
            drawing.height,
            drawing.items.iter().map(written).collect::<String>()
        ),
        Item::Open { class, words, data } => {
            let data: String = data
                .iter()
                .map(|(name, value)| format!(" data-{name}=\"{}\"", escaped(value)))
                .collect();
            format!("<g class=\"{class}\"{data}><title>{}</title>\n", escaped(words))
        }
        Item::Close => "</g>\n".to_owned(),
    }
}

fn rectangle(place: &Rectangle, fill: &str, corner: f64) -> String {
    let Rectangle { x, y, width, height } = place;
    format!(
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"{corner}\" fill=\"{fill}\"/>\n"
    )
}

fn gradient(place: &Rectangle, colours: &[String]) -> String {
    let last = colours.len().saturating_sub(1).max(1) as f64;
    let stops = colours.iter().enumerate().map(|(step, colour)| {
        let offset = step as f64 / last;
        format!("<stop offset=\"{offset:.4}\" stop-color=\"{colour}\"/>")
    });
    let stops: String = stops.collect();
    format!(
        "<linearGradient id=\"sequence\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">{stops}</linearGradient>\n{}",
        rectangle(place, "url(#sequence)", 0.0)
    )
}

fn path(steps: &str, paint: &OwnPaint) -> String {
    let OwnPaint { fill, fill_opacity, stroke, stroke_width, dashes, opacity } = paint;
    let dashes = match dashes.as_str() {
        "" => String::new(),
        dashes => format!(" stroke-dasharray=\"{dashes}\""),
    };
    format!(
        "<path d=\"{steps}\" fill=\"{fill}\" fill-opacity=\"{fill_opacity:.2}\" stroke=\"{stroke}\" stroke-width=\"{stroke_width}\" stroke-linejoin=\"round\" opacity=\"{opacity:.2}\"{dashes}/>\n"
    )
}

fn stroke(points: &[[f64; 2]], colour: &str, width: f64) -> String {
    let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    format!(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>\n",
        points.join(" "),
    )
}

fn text([x, y]: [f64; 2], style: Style, words: &str) -> String {
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
    format!(
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" font-weight=\"{weight}\" text-anchor=\"{anchor}\" fill=\"{fill}\"{edge}>{}</text>\n",
        escaped(words),
    )
}

/// Without what XML reads as markup or does not allow at all.
pub fn escaped(words: &str) -> String {
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
        let text = svg(&document, name);
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
}
