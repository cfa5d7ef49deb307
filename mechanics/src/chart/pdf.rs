//! Drawings as the pages of a PDF (ISO 32000-1): words in Helvetica, which every reader has, and images without loss.
//!
//! Units of a page are points, 1/72 inch, from its top left.

use std::collections::HashMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};

use super::colour::INK;
use super::drawing::{Anchor, Document, Item, OwnPaint, Rectangle, Run, Style};
use super::helvetica::{encoded, width};
use super::path_steps::{Step, steps};

/// What a PDF says of itself.
pub struct PdfMetadata<'a> {
    pub title: &'a str,
    /// As of HTML, e.g. `de`.
    pub language: &'a str,
    pub creator: &'a str,
}

/// Images and degrees of opacity that a page uses, and what has been given numbers so far.
struct Writer {
    pdf: Pdf,
    next: i32,
    images: Vec<Ref>,
    /// In percent.
    opacities: HashMap<u8, Ref>,
}

const PLAIN: Ref = Ref::new(3);
const BOLD: Ref = Ref::new(4);

/// The file; a picture that is no PNG is left out.
pub fn pdf(pages: &[Document], about: &PdfMetadata) -> Vec<u8> {
    let (catalog, tree, info) = (Ref::new(1), Ref::new(2), Ref::new(5));
    let mut writer =
        Writer { pdf: Pdf::new(), next: 6, images: Vec::new(), opacities: HashMap::new() };
    let places: Vec<Ref> = pages.iter().map(|_| writer.number()).collect();
    writer.pdf.catalog(catalog).pages(tree).lang(TextStr(about.language));
    writer.pdf.pages(tree).kids(places.iter().copied()).count(pages.len() as i32);
    for (font, name) in [(PLAIN, "Helvetica"), (BOLD, "Helvetica-Bold")] {
        let mut font = writer.pdf.type1_font(font);
        font.base_font(Name(name.as_bytes())).encoding_predefined(Name(b"WinAnsiEncoding"));
    }
    let mut told = writer.pdf.document_info(info);
    told.title(TextStr(about.title)).creator(TextStr(about.creator));
    told.finish();
    for (page, place) in pages.iter().zip(places) {
        writer.page(page, place, tree);
    }
    writer.pdf.finish()
}

impl Writer {
    fn number(&mut self) -> Ref {
        self.next += 1;
        Ref::new(self.next - 1)
    }

    fn page(&mut self, page: &Document, place: Ref, tree: Ref) {
        let content_at = self.number();
        let mut content = Content::new();
        content.transform([1.0, 0.0, 0.0, -1.0, 0.0, page.height as f32]);
        page.items.iter().for_each(|item| self.draw(item, &mut content));
        let packed = packed(&content.finish());
        self.pdf.stream(content_at, &packed).filter(Filter::FlateDecode);
        let opacities: Vec<(u8, Ref)> = self.opacities.iter().map(|(&p, &at)| (p, at)).collect();
        let mut written = self.pdf.page(place);
        written.parent(tree).contents(content_at);
        written.media_box(Rect::new(0.0, 0.0, page.width as f32, page.height as f32));
        let mut resources = written.resources();
        resources.fonts().pair(Name(b"F0"), PLAIN).pair(Name(b"F1"), BOLD);
        let mut images = resources.x_objects();
        for (index, image) in self.images.iter().enumerate() {
            images.pair(Name(format!("I{index}").as_bytes()), image);
        }
        images.finish();
        let mut states = resources.ext_g_states();
        for (percent, at) in opacities {
            states.pair(Name(format!("G{percent}").as_bytes()), at);
        }
    }

    fn draw(&mut self, item: &Item, content: &mut Content) {
        match item {
            Item::Rectangle { place, fill, .. } => {
                filled(content, fill);
                content.rect(
                    place.x as f32,
                    place.y as f32,
                    place.width as f32,
                    place.height as f32,
                );
                content.fill_nonzero();
            }
            Item::Gradient { place, colours } => gradient(content, place, colours),
            Item::Line { from, to } => line(content, &[*from, *to], INK, 1.2),
            Item::Stroke { points, colour, width } => line(content, points, colour, *width),
            Item::Path { steps, paint } => self.path(steps, paint, content),
            Item::Text { at, run, style, words } => text(content, *at, *run, *style, words),
            Item::Image { place, png } => self.image(place, png, content),
            Item::Drawing { place, drawing } => self.nested(place, drawing, content),
            Item::Open { .. } | Item::Close => {}
        }
    }

    fn nested(&mut self, place: &Rectangle, drawing: &Document, content: &mut Content) {
        let scale = (place.width / drawing.width).min(place.height / drawing.height) as f32;
        content.save_state();
        content.transform([scale, 0.0, 0.0, scale, place.x as f32, place.y as f32]);
        drawing.items.iter().for_each(|item| self.draw(item, content));
        content.restore_state();
    }

    fn path(&mut self, words: &str, paint: &OwnPaint, content: &mut Content) {
        let opacity = paint.opacity * if paint.fill == "none" { 1.0 } else { paint.fill_opacity };
        if opacity <= 0.0 && paint.stroke == "none" {
            return;
        }
        content.save_state();
        let state = self.opacity(opacity);
        content.set_parameters(Name(state.as_bytes()));
        for step in steps(words) {
            match step.map(|value| value as f32) {
                Step::Move([x, y]) => content.move_to(x, y),
                Step::Line([x, y]) => content.line_to(x, y),
                Step::Curve([a, b, c, d, e, f]) => content.cubic_to(a, b, c, d, e, f),
                Step::Close => content.close_path(),
            };
        }
        if paint.stroke != "none" {
            stroked(content, &paint.stroke, paint.stroke_width);
            let dashes = paint.dashes.split_whitespace().filter_map(|length| length.parse().ok());
            content.set_dash_pattern(dashes.collect::<Vec<f32>>(), 0.0);
        }
        match (paint.fill.as_str(), paint.stroke.as_str()) {
            ("none", "none") => content.end_path(),
            ("none", _) => content.stroke(),
            (fill, "none") => {
                filled(content, fill);
                content.fill_nonzero()
            }
            (fill, _) => {
                filled(content, fill);
                content.fill_nonzero_and_stroke()
            }
        };
        content.restore_state();
    }

    /// The name of a degree of opacity.
    fn opacity(&mut self, opacity: f64) -> String {
        let percent = (opacity * 100.0).round().clamp(0.0, 100.0) as u8;
        if !self.opacities.contains_key(&percent) {
            let at = self.number();
            let alpha = f32::from(percent) / 100.0;
            self.pdf.ext_graphics(at).non_stroking_alpha(alpha).stroking_alpha(alpha);
            self.opacities.insert(percent, at);
        }
        format!("G{percent}")
    }

    fn image(&mut self, place: &Rectangle, png: &[u8], content: &mut Content) {
        let Some(pixels) = Pixels::decoded(png) else { return };
        let (at, mask_at) = (self.number(), self.number());
        let (colour, mask) = (packed(&pixels.colour), packed(&pixels.opacity));
        let mut image = self.pdf.image_xobject(at, &colour);
        image.width(pixels.width).height(pixels.height).color_space().device_rgb();
        image.bits_per_component(8).s_mask(mask_at).filter(Filter::FlateDecode);
        image.finish();
        let mut image = self.pdf.image_xobject(mask_at, &mask);
        image.width(pixels.width).height(pixels.height).color_space().device_gray();
        image.bits_per_component(8).filter(Filter::FlateDecode);
        image.finish();
        let name = format!("I{}", self.images.len());
        self.images.push(at);
        let Rectangle { x, y, width, height } = *place;
        content.save_state();
        content.transform([width, 0.0, 0.0, -height, x, y + height].map(|value| value as f32));
        content.x_object(Name(name.as_bytes()));
        content.restore_state();
    }
}

/// An image in its parts.
struct Pixels {
    width: i32,
    height: i32,
    colour: Vec<u8>,
    opacity: Vec<u8>,
}

impl Pixels {
    fn decoded(png: &[u8]) -> Option<Self> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().ok()?;
        let mut bytes = vec![0; reader.output_buffer_size()?];
        let info = reader.next_frame(&mut bytes).ok()?;
        if (info.color_type, info.bit_depth) != (png::ColorType::Rgba, png::BitDepth::Eight) {
            return None;
        }
        let (pixels, _) = bytes.as_chunks::<4>();
        Some(Pixels {
            width: info.width as i32,
            height: info.height as i32,
            colour: pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect(),
            opacity: pixels.iter().map(|[.., opacity]| *opacity).collect(),
        })
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Into memory nothing fails.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

/// Red, green and blue of `#rrggbb`, 0 to 1; other words are black.
fn colour(words: &str) -> [f32; 3] {
    let channel = |at: usize| {
        let digits = words.get(at..at + 2).unwrap_or("00");
        f32::from(u8::from_str_radix(digits, 16).unwrap_or(0)) / 255.0
    };
    [1, 3, 5].map(channel)
}

fn filled(content: &mut Content, fill: &str) {
    let [red, green, blue] = colour(fill);
    content.set_fill_rgb(red, green, blue);
}

fn stroked(content: &mut Content, stroke: &str, width: f64) {
    let [red, green, blue] = colour(stroke);
    content.set_stroke_rgb(red, green, blue);
    content.set_line_width(width as f32);
    content.set_line_join(LineJoinStyle::RoundJoin);
}

fn line(content: &mut Content, points: &[[f64; 2]], ink: &str, width: f64) {
    stroked(content, ink, width);
    content.set_line_cap(LineCapStyle::RoundCap);
    for (index, point) in points.iter().enumerate() {
        let [x, y] = point.map(|value| value as f32);
        if index == 0 {
            content.move_to(x, y)
        } else {
            content.line_to(x, y)
        };
    }
    content.stroke();
}

/// As bands, one for each colour.
fn gradient(content: &mut Content, place: &Rectangle, colours: &[String]) {
    let height = place.height / colours.len().max(1) as f64;
    for (index, colour) in colours.iter().enumerate() {
        let y = place.y + place.height - height * (index + 1) as f64;
        filled(content, colour);
        content.rect(place.x as f32, y as f32, place.width as f32, height as f32);
        content.fill_nonzero();
    }
}

fn text(content: &mut Content, [x, y]: [f64; 2], run: Run, style: Style, words: &str) {
    let long = width(words, style.size, style.bold);
    let back = match style.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => long / 2.0,
        Anchor::End => long,
    };
    let turned = match run {
        Run::Level => 0.0,
        Run::Upwards => 90.0,
    };
    let (sin, cos) = f64::to_radians(turned).sin_cos();
    let matrix = [cos, -sin, -sin, -cos, x - back * cos, y + back * sin].map(|value| value as f32);
    let codes = encoded(words);
    content.begin_text();
    content.set_font(Name(if style.bold { b"F1" } else { b"F0" }), style.size as f32);
    if style.edge {
        stroked(content, "#ffffff", 3.0);
        content.set_text_rendering_mode(pdf_writer::types::TextRenderingMode::Stroke);
        content.set_text_matrix(matrix).show(Str(&codes));
        content.set_text_rendering_mode(pdf_writer::types::TextRenderingMode::Fill);
    }
    filled(content, style.ink);
    content.set_text_matrix(matrix).show(Str(&codes));
    content.end_text();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_its_size_its_words_and_its_picture() {
        let mut page = Document::new(595.0, 842.0);
        page.words([30.0, 40.0], Run::Level, Style::of(12.0), "Größe (mm)");
        let png =
            crate::chart::Image { width: 2, height: 1, pixels: vec![[255, 0, 0, 255], [0; 4]] };
        let place = Rectangle { x: 30.0, y: 60.0, width: 100.0, height: 50.0 };
        page.image(place, &png.to_png().unwrap());
        let about = PdfMetadata { title: "T", language: "de", creator: "facies" };
        let bytes = pdf(&[page], &about);
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("%PDF-") && text.trim_end().ends_with("%%EOF"));
        for word in [
            "/MediaBox [0 0 595 842]",
            "/Count 1",
            "/Helvetica-Bold",
            "/SMask",
            "/Width 2",
            "/Lang",
        ] {
            assert!(text.contains(word), "{word} in {text}");
        }
    }

    #[test]
    fn a_colour_is_read_from_its_six_digits() {
        assert_eq!(colour("#ff8000").map(|value| (value * 255.0).round()), [255.0, 128.0, 0.0]);
        assert_eq!(colour("none"), [0.0; 3]);
    }
}
