//! A small z-buffer with more samples than pixels: it finds what each sample shows, then shades once for
//! each triangle in a pixel. Hollows are darkened by how far the neighbours of a point rise above its
//! tangent plane, which stands in for lost skylight.

use super::Vector;
use super::colour::{Rgb, to_stored};
use super::facet::{Corner, Facet, Finish, group, linear};
use super::view::{Camera, Extent};
use rayon::prelude::*;

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;
/// Free pixels around what is drawn.
const MARGIN: f64 = 0.04;

/// Pixels from the top left, red, green, blue and opacity.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[u8; 4]>,
}

/// Why an image could not be written as PNG.
#[derive(Debug, thiserror::Error)]
#[error("a picture of {width} x {height} pixels could not be written as png: {source}")]
pub struct PngError {
    width: usize,
    height: usize,
    source: png::EncodingError,
}

/// A surface with a colour for each point.
pub struct ColouredSurface<'a> {
    pub points: &'a [Vector],
    pub triangles: &'a [[u32; 3]],
    pub colours: &'a [Rgb],
    pub finish: Finish,
}

/// Where a picture is taken from, and how large.
pub struct Shot {
    pub camera: Camera,
    /// The middle of the image in the camera's plane, in mm.
    pub centre: [f64; 2],
    pub millimetres_per_pixel: f64,
    pub width: usize,
    pub height: usize,
}

impl Shot {
    /// The smallest scale at which all extents fit into the pixels.
    pub fn scale_for(extents: &[Extent], width: usize, height: usize) -> f64 {
        let room = 1.0 - 2.0 * MARGIN;
        let scale = extents.iter().fold(0.0f64, |scale, extent| {
            scale
                .max(extent.size(0) / (width as f64 * room))
                .max(extent.size(1) / (height as f64 * room))
        });
        if scale > 0.0 { scale } else { 1.0 }
    }
}

impl Image {
    /// The bytes of a PNG file.
    pub fn to_png(&self) -> Result<Vec<u8>, PngError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let wrap = |source| PngError { width: self.width, height: self.height, source };
        let mut writer = encoder.write_header().map_err(wrap)?;
        writer.write_image_data(self.pixels.as_flattened()).map_err(wrap)?;
        writer.finish().map_err(wrap)?;
        Ok(bytes)
    }
}

/// One image of a document.
pub struct Panel<'a> {
    pub painted: ColouredSurface<'a>,
    pub shot: Shot,
}

/// The images as PNG files, in the order of the panels.
pub fn draw_all(panels: &[Panel]) -> Result<Vec<Vec<u8>>, PngError> {
    panels.par_iter().map(|panel| draw(&panel.painted, &panel.shot).to_png()).collect()
}

/// Draws a surface; where there is none the image is transparent.
pub fn draw(surface: &ColouredSurface, shot: &Shot) -> Image {
    let corners = corners(surface, shot);
    let facets: Vec<Facet> = surface
        .triangles
        .iter()
        .filter_map(|triangle| Facet::new(triangle.map(|point| &corners[point as usize])))
        .collect();
    let mut samples = Samples::new(shot.width * SAMPLES, shot.height * SAMPLES);
    for (index, facet) in facets.iter().enumerate() {
        samples.fill(index as u32, facet);
    }
    samples.resolve(&facets, surface.finish)
}

/// The points of a surface on the screen, in samples.
fn corners(surface: &ColouredSurface, shot: &Shot) -> Vec<Corner> {
    let scale = SAMPLES as f64 / shot.millimetres_per_pixel;
    let middle = [shot.width, shot.height].map(|side| (side * SAMPLES) as f64 / 2.0);
    let normals = point_normals(surface);
    let sky_visibility = sky_visibility(surface, &normals);
    let relief = surface.finish.relief();
    let points = surface.points.iter().zip(&normals).enumerate();
    points
        .map(|(point, (position, normal))| {
            let [right, up, towards] = shot.camera.project(position);
            Corner {
                x: (right - shot.centre[0]) * scale + middle[0],
                y: (shot.centre[1] - up) * scale + middle[1],
                depth: towards,
                normal: Vector::from(shot.camera.project(normal)),
                albedo: linear(surface.colours[point])
                    * (1.0 - relief * (1.0 - sky_visibility[point])),
            }
        })
        .collect()
}

fn point_normals(surface: &ColouredSurface) -> Vec<Vector> {
    let mut normals = vec![Vector::zeros(); surface.points.len()];
    for triangle in surface.triangles {
        let [a, b, c] = triangle.map(|point| surface.points[point as usize]);
        let normal = (b - a).cross(&(c - a));
        for &corner in triangle {
            normals[corner as usize] += normal;
        }
    }
    for normal in &mut normals {
        *normal = normal.try_normalize(1e-300).unwrap_or_else(Vector::zeros);
    }
    normals
}

/// Ambient occlusion: for each point the share of skylight that its neighbours leave it, in [0.55, 1].
fn sky_visibility(surface: &ColouredSurface, normals: &[Vector]) -> Vec<f64> {
    let mut rise = vec![(0.0, 0.0); surface.points.len()];
    for triangle in surface.triangles {
        for (&from, &to) in triangle.iter().zip(triangle.iter().cycle().skip(1)) {
            let [from, to] = [from as usize, to as usize];
            let edge = surface.points[to] - surface.points[from];
            if let Some(direction) = edge.try_normalize(1e-12) {
                for (point, slope) in
                    [(from, normals[from].dot(&direction)), (to, -normals[to].dot(&direction))]
                {
                    rise[point].0 += slope;
                    rise[point].1 += 1.0;
                }
            }
        }
    }
    rise.into_iter()
        .map(|(sum, count)| (1.0 - 0.9 * sum / f64::max(count, 1.0)).clamp(0.55, 1.0))
        .collect()
}

/// Which triangle each sample shows.
struct Samples {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    facet: Vec<u32>,
}

/// The number of a triangle that there is not.
const NONE: u32 = u32::MAX;

impl Samples {
    fn new(width: usize, height: usize) -> Self {
        let count = width * height;
        Samples { width, height, depth: vec![f32::NEG_INFINITY; count], facet: vec![NONE; count] }
    }

    fn fill(&mut self, index: u32, facet: &Facet) {
        let range = |[low, high]: [f64; 2], size: usize| {
            let first = (low - 0.5).ceil().clamp(0.0, size as f64) as usize;
            let end = ((high - 0.5).floor() + 1.0).clamp(0.0, size as f64) as usize;
            first..end
        };
        let columns = range(facet.bounds(|corner| corner.x), self.width);
        let (first, step) = (columns.start as f64 + 0.5, facet.step());
        let depths = facet.corners.map(|corner| corner.depth);
        for row in range(facet.bounds(|corner| corner.y), self.height) {
            let start = facet.weights(first, row as f64 + 0.5);
            let line = row * self.width + columns.start..row * self.width + columns.end;
            let shown = self.depth[line.clone()].iter_mut().zip(&mut self.facet[line]);
            for (column, (nearest, shown)) in shown.enumerate() {
                let [a, b, c] = [0, 1, 2].map(|k| start[k] + column as f64 * step[k]);
                let depth = (a * depths[0] + b * depths[1] + c * depths[2]) as f32;
                if a >= 0.0 && b >= 0.0 && c >= 0.0 && depth > *nearest {
                    *nearest = depth;
                    *shown = index;
                }
            }
        }
    }

    /// Shades the pixels.
    fn resolve(&self, facets: &[Facet], finish: Finish) -> Image {
        let (width, height) = (self.width / SAMPLES, self.height / SAMPLES);
        let mut pixels = vec![[0; 4]; width * height];
        pixels.par_chunks_mut(width.max(1)).enumerate().for_each(|(row, pixels)| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                *pixel = self.pixel(row, column, facets, finish);
            }
        });
        Image { width, height, pixels }
    }

    /// The mean of a pixel's samples; those of one triangle get the light of their middle.
    fn pixel(&self, row: usize, column: usize, facets: &[Facet], finish: Finish) -> [u8; 4] {
        let places: [[usize; 2]; SAMPLES * SAMPLES] = std::array::from_fn(|sample| {
            [column * SAMPLES + sample % SAMPLES, row * SAMPLES + sample / SAMPLES]
        });
        let shown = places.map(|[x, y]| self.facet[y * self.width + x]);
        let mut sum = Vector::zeros();
        for (first, &facet) in shown.iter().enumerate() {
            if facet == NONE || shown[..first].contains(&facet) {
                continue;
            }
            let of_facet = places.iter().zip(&shown).filter(|(_, other)| **other == facet);
            sum += group(&facets[facet as usize], of_facet.map(|(place, _)| place), finish);
        }
        let covered = shown.iter().filter(|facet| **facet != NONE).count();
        let of_covered = 1.0 / f64::max(covered as f64, 1.0);
        let [r, g, b] = [0, 1, 2].map(|channel| to_stored(sum[channel] * of_covered));
        [r, g, b, (255 * covered / (SAMPLES * SAMPLES)) as u8]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::view::FaceDirection;

    /// Rings of latitude around z.
    fn sphere(radius: f64, rings: u32) -> (Vec<Vector>, Vec<[u32; 3]>) {
        let around = 2 * rings;
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for ring in 0..=rings {
            for step in 0..around {
                let latitude = std::f64::consts::PI * (f64::from(ring) / f64::from(rings) - 0.5);
                let longitude = std::f64::consts::TAU * f64::from(step) / f64::from(around);
                let (sin, cos) = longitude.sin_cos();
                let level = latitude.cos();
                points.push(Vector::new(level * cos, level * sin, latitude.sin()) * radius);
                if ring < rings {
                    let next = (step + 1) % around;
                    let [a, b] = [step, next].map(|s| ring * around + s);
                    triangles.push([a, b, b + around]);
                    triangles.push([a, b + around, a + around]);
                }
            }
        }
        (points, triangles)
    }

    fn shot(face_direction: FaceDirection, size: usize) -> Shot {
        Shot {
            camera: face_direction.camera(30.0, 20.0),
            centre: [0.0; 2],
            millimetres_per_pixel: 1.0,
            width: size,
            height: size,
        }
    }

    #[test]
    fn a_sphere_covers_the_pixels_of_its_disc() {
        let (points, triangles) = sphere(40.0, 60);
        let colours = vec![[200, 180, 160]; points.len()];
        let surface = ColouredSurface {
            points: &points,
            triangles: &triangles,
            colours: &colours,
            finish: Finish::Bare,
        };
        let image = draw(&surface, &shot(FaceDirection::lps(), 100));
        let covered: f64 = image.pixels.iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum();
        let disc = std::f64::consts::PI * 40.0 * 40.0;
        // The polyhedron's outline lies inside the circle by 0.2 % of its area.
        assert!((covered / disc - 1.0).abs() < 0.01, "{covered} of {disc}");
        assert_eq!(image.pixels[0], [0, 0, 0, 0]);
    }

    #[test]
    fn the_nearer_surface_hides_the_farther_one() {
        let (mut points, mut triangles) = sphere(40.0, 20);
        let count = points.len() as u32;
        let (small, more) = sphere(10.0, 20);
        // In front of the face in LPS, towards -y.
        points.extend(small.iter().map(|p| p + Vector::new(0.0, -60.0, 0.0)));
        triangles.extend(more.iter().map(|t| t.map(|p| p + count)));
        let mut colours = vec![[0, 0, 255]; count as usize];
        colours.resize(points.len(), [255, 0, 0]);
        let surface = ColouredSurface {
            points: &points,
            triangles: &triangles,
            colours: &colours,
            finish: Finish::Classes,
        };
        let mut view = shot(FaceDirection::lps(), 101);
        for (around, red_wins) in [(0.0, true), (180.0, false)] {
            view.camera = FaceDirection::lps().camera(around, 0.0);
            let [red, _, blue, opacity] = draw(&surface, &view).pixels[50 * 101 + 50];
            assert_eq!((red > blue, opacity), (red_wins, 255));
        }
    }

    #[test]
    fn broken_points_leave_the_rest_of_the_picture() {
        let (mut points, triangles) = sphere(40.0, 20);
        points[100].x = f64::NAN;
        let colours = vec![[200, 180, 160]; points.len()];
        let surface = ColouredSurface {
            points: &points,
            triangles: &triangles,
            colours: &colours,
            finish: Finish::Bare,
        };
        let image = draw(&surface, &shot(FaceDirection::lps(), 100));
        assert!(image.pixels.iter().filter(|pixel| pixel[3] > 0).count() > 4000);
    }
}
