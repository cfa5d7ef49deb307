//! A small z-buffer: triangles, smooth normals, two lights, and more samples than pixels.
//!
//! Intensity = albedo (ambient + Σ lights · max(0, n·l)) + a narrow highlight (Phong, Illumination
//! for computer generated pictures, 1975), computed in linear light. Hollows are darkened by how
//! far the neighbours of a point rise above its tangent plane, which stands in for lost skylight.

use super::Vector;
use super::colour::{BACK, Rgb, to_linear, to_stored};
use super::view::{Camera, Extent};

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
pub struct Painted<'a> {
    pub points: &'a [Vector],
    pub triangles: &'a [[u32; 3]],
    pub colours: &'a [Rgb],
    pub finish: Finish,
}

/// How colours and light meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Full light and shade.
    Bare,
    /// Colours run into each other, and are shaded so little that a legend still holds.
    Values,
    /// As values, but each point has the part of a triangle that is nearest to it to itself.
    Classes,
}

impl Finish {
    /// How much of light and shade reaches the colour.
    fn relief(self) -> f64 {
        if self == Finish::Bare { 1.0 } else { 0.5 }
    }
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
        let wrap = |source| PngError { width: self.width, height: self.height, source };
        let mut writer = encoder.write_header().map_err(wrap)?;
        writer.write_image_data(self.pixels.as_flattened()).map_err(wrap)?;
        writer.finish().map_err(wrap)?;
        Ok(bytes)
    }
}

/// Draws a surface; where there is none the image is transparent.
pub fn draw(surface: &Painted, shot: &Shot) -> Image {
    let mut samples = Samples::new(shot.width * SAMPLES, shot.height * SAMPLES);
    let scale = SAMPLES as f64 / shot.millimetres_per_pixel;
    let normals = point_normals(surface);
    let openness = openness(surface, &normals);
    let relief = surface.finish.relief();
    let corners: Vec<Corner> = surface
        .points
        .iter()
        .zip(&normals)
        .enumerate()
        .map(|(point, (position, normal))| {
            let [right, up, towards] = shot.camera.project(position);
            Corner {
                x: (right - shot.centre[0]) * scale + samples.width as f64 / 2.0,
                y: (shot.centre[1] - up) * scale + samples.height as f64 / 2.0,
                depth: towards,
                normal: Vector::from(shot.camera.project(normal)),
                albedo: linear(surface.colours[point]) * (1.0 - relief * (1.0 - openness[point])),
            }
        })
        .collect();
    for triangle in surface.triangles {
        let [a, b, c] = triangle.map(|point| &corners[point as usize]);
        samples.fill([a, b, c], surface.finish);
    }
    samples.resolve()
}

fn linear(colour: Rgb) -> Vector {
    Vector::from(colour.map(|value| to_linear(f64::from(value) / 255.0)))
}

fn point_normals(surface: &Painted) -> Vec<Vector> {
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

/// For each point the share of skylight that its neighbours leave it, in [0.55, 1].
fn openness(surface: &Painted, normals: &[Vector]) -> Vec<f64> {
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

/// A point of the surface on the way to the screen.
struct Corner {
    /// In samples from the left and from the top.
    x: f64,
    y: f64,
    /// Towards the viewer, in mm.
    depth: f64,
    /// In the axes of the camera.
    normal: Vector,
    albedo: Vector,
}

struct Samples {
    width: usize,
    height: usize,
    depth: Vec<f64>,
    intensity: Vec<[f32; 3]>,
}

impl Samples {
    fn new(width: usize, height: usize) -> Self {
        Samples {
            width,
            height,
            depth: vec![f64::NEG_INFINITY; width * height],
            intensity: vec![[0.0; 3]; width * height],
        }
    }

    fn fill(&mut self, corners: [&Corner; 3], finish: Finish) {
        let [a, b, c] = corners;
        let twice_area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if !twice_area.is_finite() || twice_area.abs() < 1e-12 {
            return;
        }
        // The image's y points down, so a triangle seen from its front has a negative area here.
        let from_front = twice_area < 0.0;
        let range = |low: f64, high: f64, size: usize| {
            let first = (low - 0.5).ceil().clamp(0.0, size as f64) as usize;
            let end = ((high - 0.5).floor() + 1.0).clamp(0.0, size as f64) as usize;
            first..end
        };
        let columns = range(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), self.width);
        for row in range(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), self.height) {
            for column in columns.clone() {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let weight_b = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / twice_area;
                let weight_c = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / twice_area;
                let weights = [1.0 - weight_b - weight_c, weight_b, weight_c];
                if weights.iter().any(|&weight| weight < 0.0) {
                    continue;
                }
                let sample = row * self.width + column;
                let depth = a.depth * weights[0] + b.depth * weights[1] + c.depth * weights[2];
                if depth > self.depth[sample] {
                    self.depth[sample] = depth;
                    let light = shade(corners, weights, from_front, finish);
                    self.intensity[sample] = [light.x as f32, light.y as f32, light.z as f32];
                }
            }
        }
    }

    /// Averages the samples of each pixel.
    fn resolve(&self) -> Image {
        let (width, height) = (self.width / SAMPLES, self.height / SAMPLES);
        let mut pixels = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let mut sum = [0.0; 3];
                let mut covered = 0;
                for dy in 0..SAMPLES {
                    for dx in 0..SAMPLES {
                        let sample = (row * SAMPLES + dy) * self.width + column * SAMPLES + dx;
                        if self.depth[sample] > f64::NEG_INFINITY {
                            covered += 1;
                            for (total, value) in sum.iter_mut().zip(self.intensity[sample]) {
                                *total += f64::from(value);
                            }
                        }
                    }
                }
                let of_covered = 1.0 / f64::max(f64::from(covered), 1.0);
                let [r, g, b] = sum.map(|total| (to_stored(total * of_covered) * 255.0).round());
                let opacity = 255 * covered / (SAMPLES * SAMPLES) as u32;
                pixels.push([r as u8, g as u8, b as u8, opacity as u8]);
            }
        }
        Image { width, height, pixels }
    }
}

/// Light towards the viewer: a key light from the upper left, a fill light from the right.
fn shade(corners: [&Corner; 3], weights: [f64; 3], from_front: bool, finish: Finish) -> Vector {
    const KEY: [f64; 3] = [-0.45, 0.62, 0.64];
    const FILL: [f64; 3] = [0.77, 0.05, 0.64];
    let mix = |part: fn(&Corner) -> Vector| {
        part(corners[0]) * weights[0]
            + part(corners[1]) * weights[1]
            + part(corners[2]) * weights[2]
    };
    let mut normal = mix(|corner| corner.normal).try_normalize(1e-12).unwrap_or_else(Vector::z);
    if !from_front {
        normal = -normal;
    }
    let albedo = if !from_front {
        linear(BACK)
    } else if finish == Finish::Classes {
        let nearest = (1..3).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
        corners[nearest].albedo
    } else {
        mix(|corner| corner.albedo)
    };
    let [key, fill] = [KEY, FILL].map(|light| normal.dot(&Vector::from(light)).max(0.0));
    let skylight = 0.26 + 0.10 * normal.y;
    let halfway = Vector::new(KEY[0], KEY[1], KEY[2] + 1.0).normalize();
    let highlight = 0.05 * normal.dot(&halfway).max(0.0).powi(24);
    let light = skylight + 0.72 * key + 0.22 * fill;
    let relief = finish.relief();
    albedo * (1.0 - relief * (1.0 - light)) + Vector::repeat(highlight * relief)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::view::Outlook;

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

    fn shot(outlook: Outlook, size: usize) -> Shot {
        Shot {
            camera: outlook.camera(30.0, 20.0),
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
        let surface = Painted {
            points: &points,
            triangles: &triangles,
            colours: &colours,
            finish: Finish::Bare,
        };
        let image = draw(&surface, &shot(Outlook::lps(), 100));
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
        let surface = Painted {
            points: &points,
            triangles: &triangles,
            colours: &colours,
            finish: Finish::Classes,
        };
        let mut view = shot(Outlook::lps(), 101);
        for (around, red_wins) in [(0.0, true), (180.0, false)] {
            view.camera = Outlook::lps().camera(around, 0.0);
            let [red, _, blue, opacity] = draw(&surface, &view).pixels[50 * 101 + 50];
            assert_eq!((red > blue, opacity), (red_wins, 255));
        }
    }

    #[test]
    fn broken_points_leave_the_rest_of_the_picture() {
        let (mut points, triangles) = sphere(40.0, 20);
        points[100].x = f64::NAN;
        let colours = vec![[200, 180, 160]; points.len()];
        let surface = Painted {
            points: &points,
            triangles: &triangles,
            colours: &colours,
            finish: Finish::Bare,
        };
        let image = draw(&surface, &shot(Outlook::lps(), 100));
        assert!(image.pixels.iter().filter(|pixel| pixel[3] > 0).count() > 4000);
    }
}
