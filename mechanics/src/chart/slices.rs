//! Slices through a tetrahedral mesh, its cells coloured by their size and by their smallest dihedral angle.

use super::Vector;
use super::colour::{self, Rgb, sequential};
use super::drawing::{Document, Rectangle, Style};
use super::facet::Finish;
use super::legend::Scale;
use super::raster::{ColouredSurface, Panel, PngError, Shot, draw_all};
use super::svg::svg;
use super::view::{Camera, Extent, FaceDirection, coordinates};

/// Content of the picture. Points in mm.
pub struct SlicesPicture<'a> {
    pub title: &'a str,
    /// A line of numbers below the title.
    pub subtitle: &'a str,
    pub points: &'a [Vector],
    pub tetrahedra: &'a [[u32; 4]],
    /// A point of all three planes.
    pub middle: Vector,
    pub face_direction: FaceDirection,
    /// The frame of the coordinates as clients name it, e.g. `LPS`.
    pub frame: &'a str,
}

const MARGIN: f64 = 28.0;
const GAP: f64 = 12.0;
const PANEL: f64 = 330.0;
const LEGEND_WIDTH: f64 = 84.0;
const HEAD: f64 = 100.0;
const SHARPNESS: f64 = 2.0;
/// Degrees around the head and above it, for each column.
const COLUMNS: [(&str, f64, f64); 3] =
    [("from the side", 90.0, 0.0), ("from the front", 0.0, 0.0), ("from above", 0.0, 90.0)];
/// Cells are drawn so much smaller than they are, so that their edges are seen.
const SHRUNK: f64 = 0.9;
/// The dihedral angle of a regular tetrahedron, in degrees: no smallest angle is larger.
const REGULAR: f64 = 70.53;

/// The pieces of cells that lie in a plane: corners of their own for each.
#[derive(Default)]
struct Cut {
    points: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
    /// The cell of each point.
    cells: Vec<usize>,
}

impl SlicesPicture<'_> {
    /// The picture as one SVG document.
    pub fn to_svg(&self) -> Result<String, PngError> {
        let cameras = COLUMNS.map(|(_, around, above)| self.face_direction.camera(around, above));
        let cuts = cameras.map(|camera| self.cut(&camera));
        let extents = [0, 1, 2].map(|column| cameras[column].extent(cuts[column].points.iter()));
        let sizes: Vec<f64> = self.tetrahedra.iter().map(|cell| self.longest_edge(*cell)).collect();
        let seen = cuts.iter().flat_map(|cut| &cut.cells).map(|&cell| sizes[cell]);
        let size_scale = Scale::covering(seen.fold(0.0, f64::max));
        let angle_scale = Scale::covering(REGULAR);
        let size = |cell: usize| sequential(sizes[cell] / size_scale.maximum());
        let angle =
            |cell: usize| sequential(1.0 - self.smallest_angle(self.tetrahedra[cell]) / REGULAR);
        let width = 2.0 * MARGIN + 3.0 * PANEL + 3.0 * GAP + LEGEND_WIDTH;
        let height = HEAD + 2.0 * PANEL + GAP + 40.0;

        let mut document = Document::new(width, height);
        let room = width - 2.0 * MARGIN;
        document.text([MARGIN, 42.0], room, Style::of(22.0).bold(), self.title);
        document.text([MARGIN, 66.0], room, Style::of(13.0), self.subtitle);
        let of_size: Vec<Vec<Rgb>> = cuts.iter().map(|cut| cut.coloured(&size)).collect();
        let of_angle: Vec<Vec<Rgb>> = cuts.iter().map(|cut| cut.coloured(&angle)).collect();
        let mut panels = Vec::new();
        for colours in [&of_size, &of_angle] {
            for column in 0..3 {
                panels.push(panel(
                    &cuts[column],
                    &colours[column],
                    cameras[column],
                    &extents,
                    column,
                ));
            }
        }
        for (index, png) in draw_all(&panels)?.iter().enumerate() {
            let place = place_of(index);
            document.rectangle(place, colour::GROUND, 6.0);
            document.image(place, png);
            if index < 3 {
                let above = [place.x + PANEL / 2.0, HEAD - 8.0];
                document.text(above, PANEL, Style::of(13.0).bold().middle(), COLUMNS[index].0);
            }
        }
        write_legend(&mut document, 0, ["longest", "edge, mm"], &size_scale, false);
        write_legend(&mut document, 1, ["smallest", "angle, °"], &angle_scale, true);
        let [x, y, z] = self.middle.into();
        let foot = format!(
            "Planes through ({x:.1}, {y:.1}, {z:.1}) mm, {}. Cells are drawn smaller than they are.",
            coordinates(self.frame)
        );
        document.text([MARGIN, height - 12.0], room, Style::of(11.0).faint(), &foot);
        Ok(svg(&document, self.title))
    }

    fn corners(&self, cell: [u32; 4]) -> [Vector; 4] {
        cell.map(|node| self.points[node as usize])
    }

    fn longest_edge(&self, cell: [u32; 4]) -> f64 {
        let corners = self.corners(cell);
        pairs().map(|[a, b]| (corners[b] - corners[a]).norm()).fold(0.0, f64::max)
    }

    /// In degrees.
    fn smallest_angle(&self, cell: [u32; 4]) -> f64 {
        let corners = self.corners(cell);
        let normal = |[a, b, c]: [usize; 3]| {
            (corners[b] - corners[a]).cross(&(corners[c] - corners[a])).normalize()
        };
        let normals = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]].map(normal);
        let cosine = |[a, b]: [usize; 2]| -normals[a].dot(&normals[b]);
        let largest = pairs().map(cosine).fold(-1.0, f64::max);
        largest.clamp(-1.0, 1.0).acos().to_degrees()
    }

    /// The cells in the plane through the middle that faces a camera.
    fn cut(&self, camera: &Camera) -> Cut {
        let height: Vec<f64> =
            self.points.iter().map(|point| camera.towards.dot(&(point - self.middle))).collect();
        let mut cut = Cut::default();
        for (index, &cell) in self.tetrahedra.iter().enumerate() {
            let above = cell.iter().filter(|&&node| height[node as usize] > 0.0).count();
            if (1..4).contains(&above) {
                cut.add(index, self.polygon(cell, &height, camera));
            }
        }
        cut
    }

    /// Where a plane meets a cell, counter-clockwise for the camera.
    fn polygon(&self, cell: [u32; 4], height: &[f64], camera: &Camera) -> Vec<Vector> {
        let mut corners: Vec<Vector> = pairs()
            .filter_map(|[a, b]| {
                let [a, b] = [cell[a] as usize, cell[b] as usize];
                let crosses = (height[a] > 0.0) != (height[b] > 0.0);
                let share = height[a] / (height[a] - height[b]);
                crosses.then(|| self.points[a] + (self.points[b] - self.points[a]) * share)
            })
            .collect();
        let middle = corners.iter().sum::<Vector>() / corners.len() as f64;
        let bearing = |corner: &Vector| {
            let from = corner - middle;
            camera.up.dot(&from).atan2(camera.right.dot(&from))
        };
        corners.sort_by(|a, b| bearing(a).total_cmp(&bearing(b)));
        corners.into_iter().map(|corner| middle + (corner - middle) * SHRUNK).collect()
    }
}

impl Cut {
    fn add(&mut self, cell: usize, corners: Vec<Vector>) {
        let first = self.points.len() as u32;
        for second in 1..corners.len() as u32 - 1 {
            self.triangles.push([first, first + second, first + second + 1]);
        }
        self.cells.extend(corners.iter().map(|_| cell));
        self.points.extend(corners);
    }

    fn coloured(&self, colour: &dyn Fn(usize) -> Rgb) -> Vec<Rgb> {
        self.cells.iter().map(|&cell| colour(cell)).collect()
    }
}

/// The six edges of a tetrahedron, or pairs of its faces.
fn pairs() -> impl Iterator<Item = [usize; 2]> {
    [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].into_iter()
}

fn panel<'a>(
    cut: &'a Cut,
    colours: &'a [Rgb],
    camera: Camera,
    extents: &[Extent; 3],
    column: usize,
) -> Panel<'a> {
    let pixels = (PANEL * SHARPNESS) as usize;
    Panel {
        painted: ColouredSurface {
            points: &cut.points,
            triangles: &cut.triangles,
            colours,
            finish: Finish::Flat,
        },
        shot: Shot {
            camera,
            centre: extents[column].centre(),
            millimetres_per_pixel: Shot::scale_for(extents, pixels, pixels),
            width: pixels,
            height: pixels,
        },
    }
}

fn place_of(panel: usize) -> Rectangle {
    let (row, column) = ((panel / 3) as f64, (panel % 3) as f64);
    let (x, y) = (MARGIN + (PANEL + GAP) * column, HEAD + (PANEL + GAP) * row);
    Rectangle { x, y, width: PANEL, height: PANEL }
}

/// A bar of colours beside a row; where large is good, the dark end is at its foot.
fn write_legend(
    document: &mut Document,
    row: usize,
    words: [&str; 2],
    scale: &Scale,
    falling: bool,
) {
    let beside = place_of(3 * row + 2);
    let x = beside.x + PANEL + GAP + 6.0;
    let (y, height) = (beside.y + 40.0, PANEL - 60.0);
    let steps = 24;
    for step in 0..steps {
        let share = (f64::from(step) + 0.5) / f64::from(steps);
        let colour = colour::hexadecimal(sequential(if falling { 1.0 - share } else { share }));
        let strip = height / f64::from(steps);
        let top = y + height - strip * f64::from(step + 1);
        document.rectangle(Rectangle { x, y: top, width: 16.0, height: strip + 0.5 }, &colour, 0.0);
    }
    let top = if falling { REGULAR } else { scale.maximum() };
    for &tick in scale.ticks.iter().filter(|&&tick| tick <= top) {
        let level = y + height * (1.0 - tick / top);
        document.line([x + 16.0, level], [x + 21.0, level]);
        let room = LEGEND_WIDTH - 25.0;
        document.text([x + 25.0, level + 4.0], room, Style::of(12.0), &scale.label(tick));
    }
    for (line, words) in words.into_iter().enumerate() {
        let at = [x, y - 28.0 + 14.0 * line as f64];
        document.text(at, LEGEND_WIDTH + MARGIN - 6.0, Style::of(12.0).bold(), words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture<'a>(points: &'a [Vector], tetrahedra: &'a [[u32; 4]]) -> SlicesPicture<'a> {
        SlicesPicture {
            title: "mesh",
            subtitle: "one cell",
            points,
            tetrahedra,
            middle: Vector::new(0.1, 0.1, 0.1),
            face_direction: FaceDirection::lps(),
            frame: "LPS",
        }
    }

    #[test]
    fn a_plane_cuts_a_cell_where_it_lies() {
        let points = [Vector::zeros(), Vector::x(), Vector::y(), Vector::z()];
        let cells = [[0, 1, 2, 3]];
        let picture = picture(&points, &cells);
        // z = .1 cuts the right angle off at .9 and .9.
        let cut = picture.cut(&FaceDirection::lps().camera(0.0, 90.0));
        let area: f64 = cut
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|point| cut.points[point as usize]);
                (b - a).cross(&(c - a)).z / 2.0
            })
            .sum();
        assert!((area - 0.405 * SHRUNK * SHRUNK).abs() < 1e-12, "{area}");
        assert!(cut.points.iter().all(|point| (point.z - 0.1).abs() < 1e-12));
    }

    #[test]
    fn angles_are_those_of_the_cell() {
        let regular = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]
            .map(Vector::from);
        let angle = picture(&regular, &[]).smallest_angle([0, 1, 2, 3]);
        assert!((angle - (1.0f64 / 3.0).acos().to_degrees()).abs() < 1e-9, "{angle}");
        let corner = [Vector::zeros(), Vector::x(), Vector::y(), Vector::z()];
        let angle = picture(&corner, &[]).smallest_angle([0, 1, 2, 3]);
        assert!((angle - (1.0 / 3f64.sqrt()).acos().to_degrees()).abs() < 1e-9, "{angle}");
    }

    #[test]
    fn the_picture_names_its_numbers_and_its_frame() {
        let points = [Vector::zeros(), Vector::x(), Vector::y(), Vector::z()];
        let svg = picture(&points, &[[0, 1, 2, 3]]).to_svg().unwrap_or_default();
        assert_eq!(svg.matches("<image").count(), 6);
        for words in ["one cell", "frame LPS", "edge, mm", "(0.1, 0.1, 0.1)"] {
            assert!(svg.contains(words), "{words}");
        }
    }
}
