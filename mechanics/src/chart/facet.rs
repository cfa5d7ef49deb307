//! A triangle on the screen and the light that it sends to the viewer.
//!
//! Intensity = albedo (ambient + Σ lights · max(0, n·l)) + a narrow highlight (Phong, Illumination
//! for computer generated pictures, 1975), computed in linear light.

use super::Vector;
use super::colour::{BACK, Rgb, to_linear};

/// Of the colour of a class, where it is seen from its back.
const DARKENED: f64 = 0.7;

/// How colours and light meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Full light and shade.
    Bare,
    /// Colours run into each other, and are shaded so little that a legend still holds.
    Values,
    /// As values, but each point has the part of a triangle that is nearest to it to itself.
    Classes,
    /// The colours as they are, without light.
    Flat,
}

impl Finish {
    /// How much of light and shade reaches the colour.
    pub fn relief(self) -> f64 {
        match self {
            Finish::Bare => 1.0,
            Finish::Values | Finish::Classes => 0.5,
            Finish::Flat => 0.0,
        }
    }
}

pub fn linear(colour: Rgb) -> Vector {
    Vector::from(colour.map(|value| to_linear(f64::from(value) / 255.0)))
}

/// A point of the surface on the way to the screen.
pub struct Corner {
    /// In samples from the left and from the top.
    pub x: f64,
    pub y: f64,
    /// Towards the viewer, in mm.
    pub depth: f64,
    /// In the axes of the camera.
    pub normal: Vector,
    pub albedo: Vector,
}

/// A triangle on the screen.
pub struct Facet<'a> {
    pub corners: [&'a Corner; 3],
    /// The image's y points down, so a triangle seen from its front has a negative area here.
    twice_area: f64,
}

impl<'a> Facet<'a> {
    /// Nothing where a corner is not finite, or where the triangle is seen from its edge.
    pub fn new(corners: [&'a Corner; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let twice_area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        (twice_area.is_finite() && twice_area.abs() >= 1e-12)
            .then_some(Facet { corners, twice_area })
    }

    /// Barycentric coordinates of a point of the screen.
    pub fn weights(&self, x: f64, y: f64) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let weight_b = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / self.twice_area;
        let weight_c = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / self.twice_area;
        [1.0 - weight_b - weight_c, weight_b, weight_c]
    }

    /// How barycentric coordinates change from a sample to the one on its right.
    pub fn step(&self) -> [f64; 3] {
        let [a, b, c] = self.corners;
        [(b.y - c.y), (c.y - a.y), (a.y - b.y)].map(|height| height / self.twice_area)
    }

    pub fn bounds(&self, coordinate: fn(&Corner) -> f64) -> [f64; 2] {
        let [a, b, c] = self.corners.map(coordinate);
        [a.min(b).min(c), a.max(b).max(c)]
    }

    fn mix(&self, weights: [f64; 3], part: fn(&Corner) -> Vector) -> Vector {
        let [a, b, c] = self.corners.map(part);
        a * weights[0] + b * weights[1] + c * weights[2]
    }

    /// The colour before light falls on it.
    fn albedo(&self, weights: [f64; 3], finish: Finish) -> Vector {
        let is_back = self.twice_area > 0.0;
        if finish != Finish::Classes {
            return if is_back { linear(BACK) } else { self.mix(weights, |corner| corner.albedo) };
        }
        // What is held is mostly seen from its back.
        let nearest = (1..3).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
        self.corners[nearest].albedo * if is_back { DARKENED } else { 1.0 }
    }

    /// Light towards the viewer: a key light from the upper left, a fill light from the right.
    fn shade(&self, weights: [f64; 3], albedo: Vector, finish: Finish) -> Vector {
        const KEY: [f64; 3] = [-0.45, 0.62, 0.64];
        const FILL: [f64; 3] = [0.77, 0.05, 0.64];
        let mixed = self.mix(weights, |corner| corner.normal);
        let mut normal = mixed.try_normalize(1e-12).unwrap_or_else(Vector::z);
        if self.twice_area > 0.0 {
            normal = -normal;
        }
        let [key, fill] = [KEY, FILL].map(|light| normal.dot(&Vector::from(light)).max(0.0));
        let skylight = 0.26 + 0.10 * normal.y;
        let halfway = Vector::new(KEY[0], KEY[1], KEY[2] + 1.0).normalize();
        let highlight = 0.05 * normal.dot(&halfway).max(0.0).powi(24);
        let light = skylight + 0.72 * key + 0.22 * fill;
        let relief = finish.relief();
        albedo * (1.0 - relief * (1.0 - light)) + Vector::repeat(highlight * relief)
    }
}

/// The sum of the light of some samples of one triangle.
pub fn group<'a>(
    facet: &Facet,
    samples: impl Iterator<Item = &'a [usize; 2]>,
    finish: Finish,
) -> Vector {
    let (mut count, mut weights, mut albedo) = (0.0, [0.0; 3], Vector::zeros());
    for &[x, y] in samples {
        let here = facet.weights(x as f64 + 0.5, y as f64 + 0.5);
        albedo += facet.albedo(here, finish);
        weights = [0, 1, 2].map(|corner| weights[corner] + here[corner]);
        count += 1.0;
    }
    facet.shade(weights.map(|sum| sum / count), albedo / count, finish) * count
}
