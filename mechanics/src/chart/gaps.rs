//! Bones seen from where others come near them, coloured by how near: before a plan and as planned.

use super::Vector;
use super::colour::{GROUND, Rgb, hexadecimal};
use super::drawing::{Document, Rectangle, Style};
use super::facet::Finish;
use super::legend::write_scale_bar;
use super::raster::{ColouredSurface, Panel, PngError, Shot, draw_all};
use super::svg::svg;
use super::view::{Camera, Extent, FaceDirection, coordinates};

/// Content of the picture.
pub struct GapsPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub bones: &'a [GapsOfBone<'a>],
    pub face_direction: FaceDirection,
    pub frame: &'a str,
}

/// A bone twice: as it was scanned, and as planned.
pub struct GapsOfBone<'a> {
    pub name: &'a str,
    pub triangles: &'a [[u32; 3]],
    /// Points in mm, and the signed distance of each from the nearest other bone, negative inside it.
    pub stages: [(&'a [Vector], &'a [f64]); 2],
}

/// Bands of gaps in mm, each up to its edge; what is farther than the last is bone.
const BANDS: [(f64, Rgb, &str); 7] = [
    (-1.0, [103, 0, 31], "deeper than 1"),
    (-0.3, [178, 24, 43], "-1 to -0.3"),
    (0.0, [230, 97, 79], "-0.3 to 0"),
    (0.3, [253, 174, 60], "0 to 0.3: contact"),
    (1.0, [246, 232, 128], "0.3 to 1"),
    (2.0, [150, 205, 160], "1 to 2"),
    (5.0, [158, 202, 225], "2 to 5"),
];
const BONE: Rgb = [222, 216, 205];

const PANEL_WIDTH: f64 = 390.0;
const LEGEND: f64 = 150.0;
const MARGIN: f64 = 28.0;
const GAP: f64 = 10.0;
const HEAD: f64 = 104.0;
const FOOT: f64 = 34.0;
const SHARPNESS: f64 = 1.6;
/// Above the image of a panel, where its name and the scale stand.
const STRIP: f64 = 26.0;
/// Around what lies within the last band, in mm, and as a share of its size as far as there is bone.
const AROUND: f64 = 4.0;
const BONE_AROUND: f64 = 0.5;

impl GapsPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> Result<String, PngError> {
        let cameras: Vec<Camera> = self.bones.iter().map(|bone| self.camera(bone)).collect();
        let extents: Vec<Extent> =
            self.bones.iter().zip(&cameras).map(|(bone, camera)| near(bone, camera)).collect();
        let aspect = extents.iter().map(|e| e.size(1) / e.size(0).max(1e-9)).fold(0.5, f64::max);
        let height = (PANEL_WIDTH * aspect.clamp(0.5, 1.3)).round();
        let width = 2.0 * MARGIN + 2.0 * PANEL_WIDTH + 2.0 * GAP + LEGEND;
        let rows = self.bones.len() as f64;
        let whole = HEAD + rows * (STRIP + height + GAP) + FOOT;
        let mut document = Document::new(width, whole.max(HEAD + 24.0 * 9.0 + FOOT));
        document.text([MARGIN, 40.0], width, Style::of(20.0).bold(), self.title);
        document.text([MARGIN, 64.0], width, Style::of(13.0).faint(), self.subtitle);
        let pixels = [PANEL_WIDTH, height].map(|side| (side * SHARPNESS) as usize);
        let scale = Shot::scale_for(&extents, pixels[0], pixels[1]);
        let colours: Vec<[Vec<Rgb>; 2]> = self.bones.iter().map(colours_of).collect();
        let shot = |number: usize| Shot {
            camera: cameras[number],
            centre: extents[number].centre(),
            millimetres_per_pixel: scale,
            width: pixels[0],
            height: pixels[1],
        };
        let images = draw_all(&self.panels(&colours, shot))?;
        for (number, png) in images.iter().enumerate() {
            let (row, column) = ((number / 2) as f64, (number % 2) as f64);
            let x = MARGIN + column * (PANEL_WIDTH + GAP);
            let y = HEAD + row * (STRIP + height + GAP);
            let place = Rectangle { x, y, width: PANEL_WIDTH, height: STRIP + height };
            document.rectangle(place, GROUND, 6.0);
            document.image(Rectangle { y: y + STRIP, height, ..place }, png);
            if column == 0.0 {
                let name = self.words(&self.bones[number / 2], &cameras[number / 2]);
                document.text([x + 10.0, y + 18.0], 0.6 * PANEL_WIDTH, Style::of(13.0), &name);
                let strip = Rectangle { height: STRIP, ..place };
                write_scale_bar(&mut document, strip, 1.0 / (scale * SHARPNESS));
            }
        }
        for (column, name) in ["Before", "As planned"].into_iter().enumerate() {
            let x = MARGIN + (PANEL_WIDTH + GAP) * column as f64 + PANEL_WIDTH / 2.0;
            document.text([x, 92.0], PANEL_WIDTH, Style::of(14.0).bold().middle(), name);
        }
        write_legend(&mut document, [MARGIN + 2.0 * (PANEL_WIDTH + GAP) + 4.0, HEAD]);
        let foot = format!(
            "Gap to the nearest bone that the plan moves against it, mm; {}. Parallel projection; all panels have one scale.",
            coordinates(self.frame)
        );
        let at = [MARGIN, document.height - 12.0];
        document.text(at, width - 2.0 * MARGIN, Style::of(11.0).faint(), &foot);
        Ok(svg(&document, self.title))
    }

    /// Before and as planned, of each bone.
    fn panels<'s>(
        &'s self,
        colours: &'s [[Vec<Rgb>; 2]],
        shot: impl Fn(usize) -> Shot,
    ) -> Vec<Panel<'s>> {
        let mut panels = Vec::new();
        for (number, bone) in self.bones.iter().enumerate() {
            for ((points, _), colours) in bone.stages.iter().zip(&colours[number]) {
                let finish = Finish::Classes;
                let painted =
                    ColouredSurface { points, triangles: bone.triangles, colours, finish };
                panels.push(Panel { painted, shot: shot(number) });
            }
        }
        panels
    }

    /// From above or from below, whichever shows more of what is near.
    fn camera(&self, bone: &GapsOfBone) -> Camera {
        let up = self.face_direction.up;
        let mut seen = 0.0;
        for (points, gaps) in &bone.stages {
            for triangle in bone.triangles {
                let [a, b, c] = triangle.map(|point| points[point as usize]);
                let nearest = triangle.map(|point| gaps[point as usize]);
                let gap = nearest.into_iter().fold(f64::INFINITY, f64::min);
                let weight = (FARTHEST - gap).clamp(0.0, FARTHEST);
                seen += weight * (b - a).cross(&(c - a)).dot(&up);
            }
        }
        self.face_direction.camera(0.0, if seen < 0.0 { -90.0 } else { 90.0 })
    }

    fn words(&self, bone: &GapsOfBone, camera: &Camera) -> String {
        let is_above = camera.towards.dot(&self.face_direction.up) > 0.0;
        format!("{}, from {}", bone.name, if is_above { "above" } else { "below" })
    }
}

/// Where the last band ends.
const FARTHEST: f64 = BANDS[BANDS.len() - 1].0;

fn colours_of(bone: &GapsOfBone) -> [Vec<Rgb>; 2] {
    bone.stages.map(|(_, gaps)| gaps.iter().map(|gap| colour_of(*gap)).collect())
}

fn colour_of(gap: f64) -> Rgb {
    BANDS.iter().find(|(edge, ..)| gap < *edge).map_or(BONE, |(_, colour, _)| *colour)
}

/// What lies within the last band at either stage, with so much of the bone around it as has room; all of the bone where nothing
/// does.
fn near(bone: &GapsOfBone, camera: &Camera) -> Extent {
    let of = |within: f64| {
        let stages = bone.stages.iter();
        let points = stages.flat_map(|(points, gaps)| points.iter().zip(gaps.iter()));
        let close: Vec<&Vector> =
            points.filter(|(_, gap)| **gap < within).map(|(point, _)| point).collect();
        (!close.is_empty()).then(|| camera.extent(close.into_iter()))
    };
    let unit = Extent { low: [0.0; 2], high: [1.0; 2] };
    let whole = of(f64::INFINITY).unwrap_or(unit);
    let close = of(FARTHEST).unwrap_or(whole);
    let around = BONE_AROUND * f64::max(close.size(0), close.size(1));
    Extent {
        low: [0, 1].map(|k| whole.low[k].max(close.low[k] - around) - AROUND),
        high: [0, 1].map(|k| whole.high[k].min(close.high[k] + around) + AROUND),
    }
}

fn write_legend(document: &mut Document, [x, y]: [f64; 2]) {
    document.text([x, y + 10.0], LEGEND, Style::of(12.0).bold(), "gap, mm");
    let beyond = [(BONE, "5 and more")];
    let bands = BANDS.iter().map(|(_, colour, words)| (*colour, *words));
    for (line, (colour, words)) in bands.chain(beyond).enumerate() {
        let y = y + 22.0 + 24.0 * line as f64;
        let patch = Rectangle { x, y, width: 18.0, height: 18.0 };
        document.rectangle(patch, &hexadecimal(colour), 3.0);
        document.text([x + 26.0, y + 14.0], LEGEND - 26.0, Style::of(12.0), words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bone_is_shown_twice_from_where_others_are_near_with_its_legend() {
        let points = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 20.0, 0.0]].map(Vector::from);
        let lower = points.map(|point| point - Vector::z());
        let gaps = [0.1, 0.8, 7.0];
        let stage = |points| (points, &gaps[..]);
        let bones = [
            // Its outside is up, so that it is seen from above, and the other from below.
            GapsOfBone {
                name: "mandible",
                triangles: &[[0, 1, 2]],
                stages: [stage(&lower[..]), stage(&points[..])],
            },
            GapsOfBone {
                name: "maxilla",
                triangles: &[[0, 2, 1]],
                stages: [stage(&points[..]), stage(&points[..])],
            },
        ];
        let (title, subtitle) = ("Gaps", "jaw 1 mm up");
        let face_direction = FaceDirection::lps();
        let picture = GapsPicture { title, subtitle, bones: &bones, face_direction, frame: "LPS" };
        let text = picture.to_svg().expect("a picture");
        assert_eq!(text.matches("data:image/png;base64,").count(), 4);
        for words in [
            "mandible, from above",
            "maxilla, from below",
            "0 to 0.3: contact",
            "Before",
            ">10 mm<",
        ] {
            assert!(text.contains(words), "{words}");
        }
    }

    #[test]
    fn bands_have_their_edges() {
        assert_eq!(colour_of(-0.1), BANDS[2].1);
        assert_eq!(colour_of(0.0), BANDS[3].1);
        assert_eq!(colour_of(5.0), BONE);
        assert_eq!(colour_of(-9.0), BANDS[0].1);
    }
}
