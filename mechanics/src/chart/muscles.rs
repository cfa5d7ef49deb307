//! Picture of the muscles of a face: the cells that they lie in, on bone, without skin.

use super::Vector;
use super::colour::{FIXED, GROUND, PRESCRIBED, Rgb, SEGMENTS, SLIDING, hexadecimal};
use super::drawing::{Document, Rectangle, Style};
use super::facet::Finish;
use super::raster::{ColouredSurface, Panel, PngError, Shot, draw_all};
use super::svg::svg;
use super::view::{FaceDirection, coordinates};

/// Content of the picture.
pub struct MusclesPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub muscles: &'a [MuscleGroup],
    /// Points in mm and triangles, counter-clockwise seen from outside.
    pub bones: &'a [(&'a [Vector], &'a [[u32; 3]])],
    pub face_direction: FaceDirection,
    pub frame: &'a str,
}

/// Muscles of one colour, such as those of both sides: the surface around their cells.
pub struct MuscleGroup {
    pub name: String,
    /// Such as volumes and what they pull with.
    pub numbers: String,
    pub points: Vec<Vector>,
    pub triangles: Vec<[u32; 3]>,
}

const BONE: Rgb = [222, 216, 205];
/// Okabe and Ito (2008) without black; groups beyond the eighth begin again.
const PALETTE: [Rgb; 8] =
    [PRESCRIBED, SEGMENTS[1], SEGMENTS[2], SEGMENTS[3], SEGMENTS[4], SLIDING, SEGMENTS[0], FIXED];

const VIEWS: [(&str, f64); 3] =
    [("from the front", 0.0), ("from the front and left", 45.0), ("from the left", 90.0)];
const MARGIN: f64 = 28.0;
const GAP: f64 = 12.0;
const PANEL_WIDTH: f64 = 300.0;
const HEAD: f64 = 104.0;
const SHARPNESS: f64 = 1.5;
const COLUMNS: usize = 2;
const LINE: f64 = 24.0;

impl MusclesPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> Result<String, PngError> {
        let (points, triangles, colours) = self.painted();
        let cameras = VIEWS.map(|(_, around)| self.face_direction.camera(around, 0.0));
        let extents = cameras.map(|camera| camera.extent(points.iter()));
        let [widest, tallest] =
            [0, 1].map(|axis| extents.iter().map(|e| e.size(axis)).fold(1e-9, f64::max));
        let panel_height = (PANEL_WIDTH * (tallest / widest).clamp(0.7, 1.35)).round();
        let pixels = [PANEL_WIDTH, panel_height].map(|side| (side * SHARPNESS) as usize);
        let panels: Vec<Panel> = cameras
            .into_iter()
            .zip(&extents)
            .map(|(camera, extent)| Panel {
                painted: ColouredSurface {
                    points: &points,
                    triangles: &triangles,
                    colours: &colours,
                    finish: Finish::Classes,
                },
                shot: Shot {
                    camera,
                    centre: extent.centre(),
                    millimetres_per_pixel: Shot::scale_for(&extents, pixels[0], pixels[1]),
                    width: pixels[0],
                    height: pixels[1],
                },
            })
            .collect();

        let width = 2.0 * MARGIN + 3.0 * PANEL_WIDTH + 2.0 * GAP;
        let lines = self.muscles.len().div_ceil(COLUMNS) as f64;
        let mut document = Document::new(width, HEAD + panel_height + 52.0 + LINE * lines);
        let room = width - 2.0 * MARGIN;
        document.text([MARGIN, 40.0], room, Style::of(20.0).bold(), self.title);
        document.text([MARGIN, 64.0], room, Style::of(13.0).faint(), self.subtitle);
        for (number, png) in draw_all(&panels)?.iter().enumerate() {
            let x = MARGIN + (PANEL_WIDTH + GAP) * number as f64;
            let place = Rectangle { x, y: HEAD, width: PANEL_WIDTH, height: panel_height };
            document.rectangle(place, GROUND, 6.0);
            document.image(place, png);
            let style = Style::of(13.0).bold().middle();
            document.text(
                [x + PANEL_WIDTH / 2.0, HEAD - 10.0],
                PANEL_WIDTH,
                style,
                VIEWS[number].0,
            );
        }
        self.write_legend(&mut document, HEAD + panel_height + 30.0);
        let foot = [MARGIN, HEAD + panel_height + 42.0 + LINE * lines];
        let frame = format!("Points in mm, {}.", coordinates(self.frame));
        document.text(foot, room, Style::of(11.0).faint(), &frame);
        Ok(svg(&document, self.title))
    }

    /// Bones and muscles as one surface.
    fn painted(&self) -> (Vec<Vector>, Vec<[u32; 3]>, Vec<Rgb>) {
        let bones = self.bones.iter().map(|(points, triangles)| (*points, *triangles, BONE));
        let palette = PALETTE.into_iter().cycle();
        let muscles = self.muscles.iter().zip(palette);
        let muscles = muscles.map(|(own, colour)| (&own.points[..], &own.triangles[..], colour));
        let (mut points, mut triangles, mut colours) = (Vec::new(), Vec::new(), Vec::new());
        for (own_points, own_triangles, colour) in bones.chain(muscles) {
            let first = points.len() as u32;
            points.extend_from_slice(own_points);
            triangles
                .extend(own_triangles.iter().map(|corners| corners.map(|point| point + first)));
            colours.resize(points.len(), colour);
        }
        (points, triangles, colours)
    }

    fn write_legend(&self, document: &mut Document, top: f64) {
        let column = (3.0 * PANEL_WIDTH + 2.0 * GAP) / COLUMNS as f64;
        for (entry, (own, colour)) in
            self.muscles.iter().zip(PALETTE.into_iter().cycle()).enumerate()
        {
            let x = MARGIN + column * (entry % COLUMNS) as f64;
            let y = top + LINE * (entry / COLUMNS) as f64;
            let patch = Rectangle { x, y: y - 12.0, width: 16.0, height: 16.0 };
            document.rectangle(patch, &hexadecimal(colour), 3.0);
            document.text([x + 24.0, y + 1.0], 180.0, Style::of(13.0), &own.name);
            let numbers = [x + 210.0, y + 1.0];
            document.text(numbers, column - 220.0, Style::of(13.0).faint(), &own.numbers);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn muscles_hide_the_bone_behind_them_and_are_named_with_their_numbers() {
        let square = |depth: f64| {
            let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
            corners.map(|[x, z]| Vector::new(x, depth, z)).to_vec()
        };
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let bone = square(0.0);
        let muscle = |name: &str, depth: f64| MuscleGroup {
            name: name.to_owned(),
            numbers: "3 cells".to_owned(),
            points: square(depth),
            triangles: triangles.to_vec(),
        };
        let picture = MusclesPicture {
            title: "Muscles",
            subtitle: "",
            muscles: &[muscle("buccinator", -2.0), muscle("levator <labii>", -4.0)],
            bones: &[(&bone, &triangles)],
            face_direction: FaceDirection::lps(),
            frame: "LPS",
        };
        let (points, all, colours) = picture.painted();
        assert_eq!((points.len(), all.len()), (12, 6));
        assert_eq!(all[4], [8, 9, 10]);
        assert_eq!([colours[0], colours[4], colours[8]], [BONE, PALETTE[0], PALETTE[1]]);
        let svg = picture.to_svg().unwrap();
        assert_eq!(svg.matches("data:image/png;base64,").count(), 3);
        for words in ["buccinator", "levator &lt;labii", "3 cells", "from the left", "frame LPS"] {
            assert!(svg.contains(words), "{words}");
        }
    }
}
