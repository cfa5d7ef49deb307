//! Picture of the boundary conditions, before anything is solved: wrong sets are the commonest mistake.

use super::Vector;
use super::colour::{self, Rgb};
use super::drawing::{Document, Rectangle, Style};
use super::facet::Finish;
use super::raster::{ColouredSurface, Panel, PngError, Shot, draw_all};
use super::svg::svg;
use super::view::{Camera, Extent, FaceDirection, coordinates};

/// Class of a node's boundary condition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ClassKind {
    /// Moves with the segment of this name.
    Joined(String),
    Fixed,
    Sliding,
    Prescribed,
    Free,
}

/// One class of nodes and how many there are in the whole mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeClasses {
    pub kind: ClassKind,
    pub count: usize,
}

/// Content of the picture: the boundary of the volume mesh, points in mm.
pub struct ClassesPicture<'a> {
    pub title: &'a str,
    pub points: &'a [Vector],
    /// Counter-clockwise seen from outside the tissue.
    pub triangles: &'a [[u32; 3]],
    /// For each point its entry in `classes`.
    pub class_of: &'a [usize],
    pub classes: &'a [NodeClasses],
    pub face_direction: FaceDirection,
    pub frame: &'a str,
}

const MARGIN: f64 = 28.0;
const GAP: f64 = 12.0;
const PANEL_WIDTH: f64 = 300.0;
const HEAD: f64 = 84.0;
const SHARPNESS: f64 = 1.5;
/// A view of the boundary.
struct View {
    name: &'static str,
    /// In degrees, around the head and above it.
    around: f64,
    above: f64,
    /// Without faces of free nodes alone: the skin of a whole head hides bone from all sides.
    held_alone: bool,
}

const VIEWS: [View; 3] = [
    View { name: "all, from the front", around: 0.0, above: 0.0, held_alone: false },
    View { name: "what is held, from the front", around: 0.0, above: 0.0, held_alone: true },
    View { name: "what is held, obliquely", around: 50.0, above: 15.0, held_alone: true },
];
const COLUMNS: usize = 3;
const LINE: f64 = 24.0;

impl ClassesPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> Result<String, PngError> {
        let palette = self.palette();
        let colours: Vec<Rgb> = self
            .class_of
            .iter()
            .map(|&class| palette.get(class).copied().unwrap_or(colour::FREE))
            .collect();
        let held = self.held();
        let cameras = VIEWS.map(|view| self.face_direction.camera(view.around, view.above));
        let shown = VIEWS.map(|view| if view.held_alone { &held } else { self.triangles });
        let extents = [0, 1, 2].map(|view| self.extent(&cameras[view], shown[view]));
        let widest = extents.iter().map(|e| e.size(0)).fold(1e-9, f64::max);
        let tallest = extents.iter().map(|e| e.size(1)).fold(1e-9, f64::max);
        let panel_height = (PANEL_WIDTH * (tallest / widest).clamp(0.7, 1.35)).round();
        let [pixels_wide, pixels_high] =
            [PANEL_WIDTH, panel_height].map(|side| (side * SHARPNESS) as usize);
        let width = 2.0 * MARGIN + 3.0 * PANEL_WIDTH + 2.0 * GAP;
        let lines = self.classes.len().div_ceil(COLUMNS);
        let height = HEAD + panel_height + 52.0 + LINE * lines as f64;

        let mut document = Document::new(width, height);
        let room = width - 2.0 * MARGIN;
        document.text([MARGIN, 42.0], room, Style::of(22.0).bold(), self.title);
        let panels: Vec<Panel> = cameras
            .into_iter()
            .zip(&extents)
            .zip(shown)
            .map(|((camera, extent), triangles)| Panel {
                painted: ColouredSurface {
                    points: self.points,
                    triangles,
                    colours: &colours,
                    finish: Finish::Classes,
                },
                shot: Shot {
                    camera,
                    centre: extent.centre(),
                    millimetres_per_pixel: Shot::scale_for(&extents, pixels_wide, pixels_high),
                    width: pixels_wide,
                    height: pixels_high,
                },
            })
            .collect();
        for (panel, png) in draw_all(&panels)?.iter().enumerate() {
            let x = MARGIN + (PANEL_WIDTH + GAP) * panel as f64;
            let place = Rectangle { x, y: HEAD, width: PANEL_WIDTH, height: panel_height };
            document.rectangle(place, colour::GROUND, 6.0);
            document.image(place, png);
            let middle = [place.x + PANEL_WIDTH / 2.0, HEAD - 10.0];
            let style = Style::of(13.0).bold().middle();
            document.text(middle, PANEL_WIDTH, style, VIEWS[panel].name);
        }
        self.write_legend(&mut document, HEAD + panel_height + 30.0, &palette);
        let frame = format!("Nodes of the whole mesh, {}.", coordinates(self.frame));
        document.text([MARGIN, height - 10.0], room, Style::of(11.0).faint(), &frame);
        Ok(svg(&document, self.title))
    }

    /// What a panel shows, or the whole mesh where it shows nothing.
    fn extent(&self, camera: &Camera, triangles: &[[u32; 3]]) -> Extent {
        let shown = triangles.iter().flatten().map(|&point| &self.points[point as usize]);
        match triangles {
            [] => camera.extent(self.points.iter()),
            _ => camera.extent(shown),
        }
    }

    /// The triangles with a node that something holds.
    fn held(&self) -> Vec<[u32; 3]> {
        let is_free =
            |class: usize| self.classes.get(class).is_none_or(|c| c.kind == ClassKind::Free);
        let is_held = |point: &u32| !is_free(self.class_of[*point as usize]);
        self.triangles.iter().filter(|corners| corners.iter().any(is_held)).copied().collect()
    }

    /// A colour for each class; segments beyond the fifth begin again at the first colour.
    fn palette(&self) -> Vec<Rgb> {
        let mut segments = colour::SEGMENTS.into_iter().cycle();
        self.classes
            .iter()
            .map(|class| match class.kind {
                ClassKind::Joined(_) => segments.next().unwrap_or(colour::FREE),
                ClassKind::Fixed => colour::FIXED,
                ClassKind::Sliding => colour::SLIDING,
                ClassKind::Prescribed => colour::PRESCRIBED,
                ClassKind::Free => colour::FREE,
            })
            .collect()
    }

    fn write_legend(&self, document: &mut Document, top: f64, palette: &[Rgb]) {
        for (entry, class) in self.classes.iter().enumerate() {
            let x = MARGIN + (PANEL_WIDTH + GAP) * (entry % COLUMNS) as f64;
            let y = top + LINE * (entry / COLUMNS) as f64;
            let patch = Rectangle { x, y: y - 12.0, width: 16.0, height: 16.0 };
            document.rectangle(patch, &colour::hexadecimal(palette[entry]), 3.0);
            let name = match &class.kind {
                ClassKind::Joined(segment) => format!("joined to {segment}"),
                ClassKind::Fixed => "fixed".to_owned(),
                ClassKind::Sliding => "sliding".to_owned(),
                ClassKind::Prescribed => "prescribed".to_owned(),
                ClassKind::Free => "free".to_owned(),
            };
            let count = format!("{} nodes", grouped(class.count));
            document.text([x + 24.0, y + 1.0], 164.0, Style::of(13.0), &name);
            document.text([x + 196.0, y + 1.0], 100.0, Style::of(13.0).faint(), &count);
        }
    }
}

/// A number with a narrow space between thousands.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_is_named_with_its_count_and_a_colour_of_its_own() {
        let points = [[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [0.0, 0.0, 60.0]].map(Vector::from);
        let classes = [
            (ClassKind::Joined("maxilla & nose".into()), 12_345),
            (ClassKind::Joined("mandible".into()), 7),
            (ClassKind::Fixed, 3),
            (ClassKind::Sliding, 2),
            (ClassKind::Prescribed, 1),
            (ClassKind::Free, 0),
        ]
        .map(|(kind, count)| NodeClasses { kind, count });
        let picture = ClassesPicture {
            title: "Conditions",
            points: &points,
            triangles: &[[0, 1, 2]],
            class_of: &[0, 1, 5],
            classes: &classes,
            face_direction: FaceDirection::ras(),
            frame: "RAS",
        };
        let mut palette = picture.palette();
        palette.sort_unstable();
        palette.dedup();
        assert_eq!(palette.len(), 6);
        // A face of free nodes alone hides what lies behind it.
        let covered = ClassesPicture { triangles: &[[0, 1, 2], [2, 2, 2]], ..picture };
        assert_eq!(covered.held(), [[0, 1, 2]]);
        let svg = covered.to_svg().unwrap();
        assert_eq!(svg.matches("data:image/png;base64,").count(), 3);
        for words in ["joined to maxilla &amp;", "12\u{202f}345 nodes", ">0 nodes<", "frame RAS"] {
            assert!(svg.contains(words), "{words}");
        }
    }
}
