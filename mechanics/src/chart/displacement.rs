//! A face before, after, and coloured by how far its skin moved, from the front and obliquely.

use std::collections::HashSet;

use super::Vector;
use super::colour::{self, Rgb};
use super::drawing::{Document, Rectangle, Style, wrapped};
use super::facet::Finish;
use super::legend::write_scale_bar;
use super::raster::{ColouredSurface, Panel, PngError, Shot, draw_all};
use super::svg::svg;
use super::view::{Camera, FaceDirection, coordinates};
use super::views::ViewValues;

/// Content of the picture. Points in mm; `before` and `after` correspond one to one.
pub struct DisplacementPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub triangles: &'a [[u32; 3]],
    pub before: &'a [Vector],
    pub after: &'a [Vector],
    pub face_direction: FaceDirection,
    /// The frame of the coordinates as clients name it, e.g. `LPS`.
    pub frame: &'a str,
    /// At which colours end, in mm: those of reports and of the page.
    pub range_mm: f64,
    /// A line of numbers for the foot of the picture.
    pub statistics: &'a str,
}

const MARGIN: f64 = 28.0;
const GAP: f64 = 12.0;
/// Above the image of a panel, where the name of its row stands.
const STRIP: f64 = 22.0;
const PANEL_WIDTH: f64 = 300.0;
const LEGEND_WIDTH: f64 = 84.0;
const HEAD: f64 = 104.0;
/// Image pixels for a unit of the document.
const SHARPNESS: f64 = 1.5;
/// Degrees around the head and above it, for each row.
const ROWS: [(&str, f64, f64); 2] = [("front", 0.0, 0.0), ("three-quarter", 55.0, 5.0)];

impl DisplacementPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> Result<String, PngError> {
        let moved: Vec<f64> = self
            .before
            .iter()
            .zip(self.after)
            .map(|(before, after)| (after - before).norm())
            .collect();
        let range_mm = self.range_mm;
        let values = ViewValues { values: &moved, range_mm, is_signed: false, name: "moved, mm" };
        let colours: Vec<Rgb> = moved.iter().map(|&length| values.colour(length)).collect();
        let cameras = ROWS.map(|(_, around, above)| self.face_direction.camera(around, above));
        let layout = Layout::of(&cameras, self);
        let width = 2.0 * MARGIN + 3.0 * PANEL_WIDTH + 3.0 * GAP + LEGEND_WIDTH;
        let foot = wrapped(self.statistics, width - 2.0 * MARGIN, Style::of(13.0));
        let notes = wrapped(&self.notes(), width - 2.0 * MARGIN, Style::of(11.0));
        let foot_height = 25.0 + 20.0 * foot.len() as f64 + 15.0 * notes.len() as f64;
        let height = HEAD + 2.0 * (layout.image_height + STRIP) + GAP + foot_height;

        let mut document = Document::new(width, height);
        self.write_head(&mut document, width);
        self.write_panels(&mut document, &layout, &cameras, &colours)?;
        layout.write_scale_bar(&mut document);
        values.write_legend(&mut document, layout.beside());
        for (line, words) in foot.iter().enumerate() {
            let y = height - foot_height + 28.0 + 20.0 * line as f64;
            document.text([MARGIN, y], width, Style::of(13.0), words);
        }
        for (line, words) in notes.iter().enumerate() {
            let y = height - 12.0 - 15.0 * (notes.len() - 1 - line) as f64;
            document.text([MARGIN, y], width, Style::of(11.0).faint(), words);
        }
        Ok(svg(&document, self.title))
    }

    /// In small letters at the foot.
    fn notes(&self) -> String {
        let mut notes = format!(
            "Lengths in mm, {}. Parallel projection; all panels have one scale.",
            coordinates(self.frame)
        );
        if is_open(self.triangles) {
            notes +=
                " Grey is the inner side of the skin, seen through a hole in it or past its edge.";
        }
        notes
    }

    fn write_panels(
        &self,
        document: &mut Document,
        layout: &Layout,
        cameras: &[Camera],
        colours: &[Rgb],
    ) -> Result<(), PngError> {
        let skin = vec![colour::SKIN; colours.len()];
        let columns = [
            (self.before, skin.as_slice(), Finish::Bare),
            (self.after, skin.as_slice(), Finish::Bare),
            (self.after, colours, Finish::Values),
        ];
        let panel = |camera: &Camera, column: usize| {
            let (points, colours, finish) = columns[column];
            let painted = ColouredSurface { points, triangles: self.triangles, colours, finish };
            Panel { painted, shot: layout.shot(*camera, self) }
        };
        let panels: Vec<Panel> = cameras
            .iter()
            .flat_map(|camera| (0..columns.len()).map(move |column| (camera, column)))
            .map(|(camera, column)| panel(camera, column))
            .collect();
        for (number, png) in draw_all(&panels)?.iter().enumerate() {
            let place = layout.panel(number / columns.len(), number % columns.len());
            document.rectangle(place, colour::GROUND, 6.0);
            let below = Rectangle { y: place.y + STRIP, height: layout.image_height, ..place };
            document.image(below, png);
        }
        for (row, (name, _, _)) in ROWS.iter().enumerate() {
            let place = layout.panel(row, 0);
            let corner = [place.x + 12.0, place.y + 18.0];
            document.text(corner, PANEL_WIDTH, Style::of(12.0).faint(), name);
        }
        Ok(())
    }

    fn write_head(&self, document: &mut Document, width: f64) {
        let room = width - 2.0 * MARGIN;
        document.text([MARGIN, 42.0], room, Style::of(22.0).bold(), self.title);
        document.text([MARGIN, 66.0], room, Style::of(13.0).faint(), self.subtitle);
        for (column, name) in ["Before", "After", "Displacement"].into_iter().enumerate() {
            let x = MARGIN + (PANEL_WIDTH + GAP) * column as f64 + PANEL_WIDTH / 2.0;
            let style = Style::of(14.0).bold().middle();
            document.text([x, 95.0], PANEL_WIDTH, style, name);
        }
    }
}

/// Whether a surface has an edge of one triangle alone.
fn is_open(triangles: &[[u32; 3]]) -> bool {
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let all: HashSet<[u32; 2]> = triangles.iter().flat_map(sides).collect();
    all.iter().any(|&[from, to]| !all.contains(&[to, from]))
}

/// Where things stand; one scale for all panels.
struct Layout {
    image_height: f64,
    millimetres_per_pixel: f64,
}

impl Layout {
    fn of(cameras: &[Camera], picture: &DisplacementPicture) -> Self {
        let extents: Vec<_> = cameras
            .iter()
            .map(|camera| camera.extent(picture.before.iter().chain(picture.after)))
            .collect();
        let tallest = extents.iter().map(|e| e.size(1)).fold(0.0, f64::max);
        let widest = extents.iter().map(|e| e.size(0)).fold(0.0, f64::max);
        let aspect = if widest > 0.0 { tallest / widest } else { 1.0 };
        let image_height = (PANEL_WIDTH * aspect.clamp(0.7, 1.35)).round();
        let pixels = [PANEL_WIDTH, image_height].map(|side| (side * SHARPNESS) as usize);
        Layout {
            image_height,
            millimetres_per_pixel: Shot::scale_for(&extents, pixels[0], pixels[1]),
        }
    }

    fn shot(&self, camera: Camera, picture: &DisplacementPicture) -> Shot {
        let extent = camera.extent(picture.before.iter().chain(picture.after));
        Shot {
            camera,
            centre: extent.centre(),
            millimetres_per_pixel: self.millimetres_per_pixel,
            width: (PANEL_WIDTH * SHARPNESS) as usize,
            height: (self.image_height * SHARPNESS) as usize,
        }
    }

    fn panel(&self, row: usize, column: usize) -> Rectangle {
        Rectangle {
            x: MARGIN + (PANEL_WIDTH + GAP) * column as f64,
            y: HEAD + (self.image_height + STRIP + GAP) * row as f64,
            width: PANEL_WIDTH,
            height: self.image_height + STRIP,
        }
    }

    /// Over the first panel, where it lies over no face.
    fn write_scale_bar(&self, document: &mut Document) {
        let strip = Rectangle { height: STRIP, ..self.panel(0, 0) };
        write_scale_bar(document, strip, 1.0 / (self.millimetres_per_pixel * SHARPNESS));
    }

    /// Both panels of the last column, beside which the legend stands.
    fn beside(&self) -> Rectangle {
        let [top, bottom] = [self.panel(0, 2), self.panel(1, 2)];
        Rectangle { height: bottom.y + bottom.height - top.y, ..top }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_names_its_numbers_and_its_frame() {
        let before = [[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [0.0, 0.0, 60.0]].map(Vector::from);
        let after = before.map(|point| point + Vector::new(0.0, 2.3, 0.0));
        let picture = DisplacementPicture {
            title: "Case <7>",
            subtitle: "chin 2.3 mm back",
            triangles: &[[0, 1, 2]],
            before: &before,
            after: &after,
            face_direction: FaceDirection::lps(),
            frame: "LPS",
            range_mm: 5.0,
            statistics: "mean 2.30 mm",
        };
        let svg = picture.to_svg().unwrap();
        assert!(!is_open(&[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]));
        let unnamed = DisplacementPicture { frame: "unspecified", ..picture };
        assert!(unnamed.notes().contains("which names no frame"));
        assert_eq!(svg.matches("data:image/png;base64,").count(), 6);
        for words in
            ["Case &lt;7&gt;", ">5<", ">0<", "frame LPS", "Grey is", "mean 2.30 mm", ">10 mm<"]
        {
            assert!(svg.contains(words), "{words}");
        }
    }
}
