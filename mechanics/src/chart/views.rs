//! A face from the front, between and from the side, in rows: as it is, as it becomes, and coloured by values.

use super::Vector;
use super::colour::{self, Rgb, sequential, signed};
use super::drawing::{Document, Rectangle, Style, wrapped};
use super::facet::Finish;
use super::raster::{ColouredSurface, Image, PngError, Shot, draw};
use super::view::{Camera, FaceDirection};
use rayon::prelude::*;

/// Content of the picture. Points in mm; all rows have the same triangles.
pub struct ViewsPicture<'a> {
    pub triangles: &'a [[u32; 3]],
    pub rows: &'a [ViewRow<'a>],
    pub face_direction: FaceDirection,
    /// Front, between, side.
    pub columns: [&'a str; 3],
}

/// A face in three views.
pub struct ViewRow<'a> {
    pub name: &'a str,
    pub points: &'a [Vector],
    pub values: Option<ViewValues<'a>>,
    /// The outline of this is drawn over it.
    pub outline_of: Option<ViewOutline<'a>>,
}

/// Another surface, or another state of the same.
#[derive(Clone, Copy)]
pub struct ViewOutline<'a> {
    pub points: &'a [Vector],
    pub triangles: &'a [[u32; 3]],
}

/// A value in mm for each point, and its fixed range.
pub struct ViewValues<'a> {
    pub values: &'a [f64],
    pub range_mm: f64,
    /// From minus the range; else from 0.
    pub is_signed: bool,
    /// Above the legend.
    pub name: &'a str,
}

const WIDTH: f64 = 1000.0;
const LEGEND: f64 = 88.0;
const GAP: f64 = 8.0;
const HEAD: f64 = 24.0;
const PANEL: f64 = (WIDTH - LEGEND - 3.0 * GAP) / 3.0;
/// Height of a panel to its width.
const ASPECTS: [f64; 2] = [0.6, 0.92];
/// Image pixels for a unit of the drawing.
const SHARPNESS: f64 = 1.6;
/// Degrees around the head to its right side, and above it.
const VIEWS: [[f64; 2]; 3] = [[0.0, 0.0], [-45.0, 0.0], [-90.0, 0.0]];
/// Of the name over a legend.
const NAME_LINE: f64 = 15.0;
/// Bands of a legend, and of its colours.
const BANDS: usize = 10;

impl ViewsPicture<'_> {
    pub fn to_drawing(&self) -> Result<Document, PngError> {
        let side = if self.shows_left() { -1.0 } else { 1.0 };
        let cameras = VIEWS.map(|[around, above]| self.face_direction.camera(side * around, above));
        let layout = Layout::of(&cameras, self);
        let height = HEAD + (layout.height + GAP) * self.rows.len() as f64;
        let mut document = Document::new(WIDTH, height);
        for (column, name) in self.columns.iter().enumerate() {
            let x = (PANEL + GAP) * column as f64 + PANEL / 2.0;
            document.text([x, 16.0], PANEL, Style::of(15.0).bold().middle(), name);
        }
        for (place, png) in self.panels(&cameras, &layout)? {
            document.rectangle(place, colour::GROUND, 6.0);
            document.image(place, &png);
        }
        for (index, row) in self.rows.iter().enumerate() {
            let place = layout.panel(index, 0);
            let corner = [place.x + 10.0, place.y + 20.0];
            document.text(corner, PANEL, Style::of(14.0).faint(), row.name);
            if let Some(values) = &row.values {
                values.write_legend(&mut document, layout.panel(index, 2));
            }
        }
        Ok(document)
    }

    /// Whether its left side shows more of the skin, as that of a left half does.
    fn shows_left(&self) -> bool {
        let Some(row) = self.rows.first() else { return false };
        let [right, left] = [-90.0, 90.0].map(|around| {
            let towards = self.face_direction.camera(around, 0.0).towards;
            let areas = self.triangles.iter().map(|triangle| {
                let [a, b, c] = triangle.map(|point| row.points[point as usize]);
                (b - a).cross(&(c - a)).dot(&towards).max(0.0)
            });
            areas.sum::<f64>()
        });
        left > 1.25 * right
    }

    fn panels(
        &self,
        cameras: &[Camera; 3],
        layout: &Layout,
    ) -> Result<Vec<(Rectangle, Vec<u8>)>, PngError> {
        let all: Vec<[usize; 2]> =
            (0..self.rows.len()).flat_map(|row| (0..3).map(move |column| [row, column])).collect();
        let drawn = all.par_iter().map(|&[row, column]| {
            let shot = layout.shot(cameras[column], self);
            let image = self.image(&self.rows[row], &shot).to_png()?;
            Ok((layout.panel(row, column), image))
        });
        drawn.collect()
    }

    fn image(&self, row: &ViewRow, shot: &Shot) -> Image {
        let bare = |points: &[Vector], triangles, finish| {
            let colours = vec![colour::SKIN; points.len()];
            draw(&ColouredSurface { points, triangles, colours: &colours, finish }, shot)
        };
        let mut image = match &row.values {
            None => bare(row.points, self.triangles, Finish::Bare),
            Some(values) => {
                let colours: Vec<Rgb> =
                    values.values.iter().map(|&value| values.colour(value)).collect();
                let (points, triangles) = (row.points, self.triangles);
                draw(
                    &ColouredSurface {
                        points,
                        triangles,
                        colours: &colours,
                        finish: Finish::Values,
                    },
                    shot,
                )
            }
        };
        if let Some(ViewOutline { points, triangles }) = row.outline_of {
            outline(&mut image, &bare(points, triangles, Finish::Flat));
        }
        image
    }
}

impl ViewValues<'_> {
    /// The colour of the band in which a value lies.
    pub(super) fn colour(&self, value: f64) -> Rgb {
        let share = value / self.range_mm;
        let share = if self.is_signed { (share + 1.0) / 2.0 } else { share };
        let band = (share * BANDS as f64).floor().clamp(0.0, (BANDS - 1) as f64);
        let share = band / (BANDS - 1) as f64;
        if self.is_signed { signed(share) } else { sequential(share) }
    }

    /// Bands as high as a panel, beside it, under the name in as many lines as it needs.
    pub(super) fn write_legend(&self, document: &mut Document, panel: Rectangle) {
        let x = panel.x + panel.width + GAP;
        let heading = Style::of(12.5).bold();
        let lines = wrapped(self.name, LEGEND, heading);
        for (number, line) in lines.iter().enumerate() {
            let at = [x, panel.y + 14.0 + NAME_LINE * number as f64];
            document.text(at, LEGEND, heading, line);
        }
        let above = 28.0 + NAME_LINE * lines.len().saturating_sub(1) as f64;
        let (top, height) = (panel.y + above, panel.height - above - 12.0);
        let low = if self.is_signed { -self.range_mm } else { 0.0 };
        let span = self.range_mm - low;
        for band in 0..BANDS {
            let y = top + height * (BANDS - 1 - band) as f64 / BANDS as f64;
            let place = Rectangle { x, y, width: 16.0, height: height / BANDS as f64 + 0.3 };
            let middle = low + span * (band as f64 + 0.5) / BANDS as f64;
            document.rectangle(place, &colour::hexadecimal(self.colour(middle)), 0.0);
        }
        for tick in (0..=BANDS).step_by(2) {
            let y = top + height * (BANDS - tick) as f64 / BANDS as f64;
            document.line([x + 16.0, y], [x + 20.0, y]);
            let words = short(low + span * tick as f64 / BANDS as f64);
            document.text([x + 24.0, y + 4.0], LEGEND - 24.0, Style::of(12.5), &words);
        }
    }
}

/// With as many decimals as it needs, two at most.
fn short(value: f64) -> String {
    let words = format!("{:.2}", value + 0.0);
    words.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Draws the edge of what a mask covers into an image of the same size, two pixels wide.
fn outline(image: &mut Image, mask: &Image) {
    let (width, height) = (image.width, image.height);
    let covered = |x: usize, y: usize| mask.pixels[y * width + x][3] >= 128;
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let around = [[x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]];
            if covered(x, y) && around.iter().any(|&[x, y]| !covered(x, y)) {
                let [r, g, b] = colour::OUTLINE;
                for [x, y] in [[x, y], [x, y - 1], [x - 1, y]] {
                    image.pixels[y * width + x] = [r, g, b, 255];
                }
            }
        }
    }
}

/// Where things stand; one scale for all panels.
struct Layout {
    height: f64,
    millimetres_per_pixel: f64,
}

impl Layout {
    fn of(cameras: &[Camera; 3], picture: &ViewsPicture) -> Self {
        let points = || picture.rows.iter().flat_map(|row| row.points);
        let extents = cameras.map(|camera| camera.extent(points()));
        let most = |axis: usize| extents.iter().map(|e| e.size(axis)).fold(0.0, f64::max);
        let (widest, tallest) = (most(0), most(1));
        let aspect = if widest > 0.0 { tallest / widest } else { 1.0 };
        let height = (PANEL * aspect.clamp(ASPECTS[0], ASPECTS[1])).round();
        let pixels = [PANEL, height].map(|side| (side * SHARPNESS) as usize);
        Layout { height, millimetres_per_pixel: Shot::scale_for(&extents, pixels[0], pixels[1]) }
    }

    fn shot(&self, camera: Camera, picture: &ViewsPicture) -> Shot {
        let extent = camera.extent(picture.rows.iter().flat_map(|row| row.points));
        Shot {
            camera,
            centre: extent.centre(),
            millimetres_per_pixel: self.millimetres_per_pixel,
            width: (PANEL * SHARPNESS) as usize,
            height: (self.height * SHARPNESS) as usize,
        }
    }

    fn panel(&self, row: usize, column: usize) -> Rectangle {
        Rectangle {
            x: (PANEL + GAP) * column as f64,
            y: HEAD + (self.height + GAP) * row as f64,
            width: PANEL,
            height: self.height,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Item;
    use super::*;

    fn wedge() -> [Vector; 4] {
        [[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [0.0, 0.0, 60.0], [0.0, 40.0, 0.0]].map(Vector::from)
    }

    const TRIANGLES: &[[u32; 3]] = &[[0, 1, 2], [0, 2, 3]];

    fn row<'a>(points: &'a [Vector], outline_of: Option<&'a [Vector]>) -> ViewRow<'a> {
        let outline = |points| ViewOutline { points, triangles: TRIANGLES };
        ViewRow { name: "After", points, values: None, outline_of: outline_of.map(outline) }
    }

    #[test]
    fn a_legend_is_that_of_its_range_whatever_the_values_are() {
        let points = wedge();
        let values = [0.3, 99.0, 0.0, 0.1];
        let shown =
            ViewValues { values: &values, range_mm: 10.0, is_signed: false, name: "distance, mm" };
        assert_eq!(shown.colour(9.5), shown.colour(99.0));
        assert_ne!(shown.colour(8.9), shown.colour(9.1));
        let rows = [ViewRow { values: Some(shown), ..row(&points, None) }];
        let columns = ["front", "three-quarter", "lateral"];
        let picture = ViewsPicture {
            triangles: TRIANGLES,
            rows: &rows,
            face_direction: FaceDirection::lps(),
            columns,
        };
        let drawing = picture.to_drawing().unwrap();
        let words: Vec<&str> = drawing
            .items
            .iter()
            .filter_map(
                |item| if let Item::Text { words, .. } = item { Some(&**words) } else { None },
            )
            .collect();
        assert_eq!(
            words,
            [
                "front",
                "three-quarter",
                "lateral",
                "After",
                "distance,",
                "mm",
                "0",
                "2",
                "4",
                "6",
                "8",
                "10"
            ]
        );
        let images = drawing.items.iter().filter(|item| matches!(item, Item::Image { .. }));
        assert_eq!(images.count(), 3);
    }

    #[test]
    fn the_outline_of_what_was_lies_beside_what_became_of_it() {
        let before = wedge();
        let after = before.map(|point| point + Vector::new(0.0, 0.0, 5.0));
        let count = |outline_of| {
            let rows = [row(&after, outline_of)];
            let triangles = TRIANGLES;
            let (face_direction, columns) = (FaceDirection::lps(), [""; 3]);
            let picture = ViewsPicture { triangles, rows: &rows, face_direction, columns };
            let camera = face_direction.camera(0.0, 0.0);
            let cameras = [camera; 3];
            let layout = Layout::of(&cameras, &picture);
            let image = picture.image(&rows[0], &layout.shot(camera, &picture));
            let [r, g, b] = colour::OUTLINE;
            image.pixels.iter().filter(|pixel| **pixel == [r, g, b, 255]).count()
        };
        assert_eq!(count(None), 0);
        assert!(count(Some(&before)) > 500);
    }
}
