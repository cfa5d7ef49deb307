//! Surfaces damaged at random, in sixteen ways.

use mechanics::mesh::{TriangleSurface, Vector};

use super::surfaces::{Noise, map, sphere};

/// What is done to a surface. The seed decides how much.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Damage {
    None,
    /// Up to a fifth of the triangles gone.
    Holes,
    /// One of up to 25 mm radius.
    RoundHole,
    /// Up to 3 of 10 triangles turned.
    Flips,
    /// Half of the triangles gone.
    HalfGone,
    Islands,
    /// Parts pushed through the rest.
    SelfIntersections,
    Noise,
    /// A second sheet, up to half a mm inside.
    DoubledSheet,
    /// A gap of .3 mm.
    ThinGap,
    /// Each triangle with corners of its own, up to .3 mm away.
    Soup,
    Inverted,
    /// Triangles twice, and without an area.
    Degenerate,
    /// A coordinate that is none, or 1e30.
    NoPlace,
    /// All that lies beyond a plane gone: an open half.
    Cropped,
    /// Holes, flips, islands, noise, a second sheet and soup.
    Together,
}

impl Damage {
    pub const ALL: [Damage; 16] = [
        Damage::None,
        Damage::Holes,
        Damage::RoundHole,
        Damage::Flips,
        Damage::HalfGone,
        Damage::Islands,
        Damage::SelfIntersections,
        Damage::Noise,
        Damage::DoubledSheet,
        Damage::ThinGap,
        Damage::Soup,
        Damage::Inverted,
        Damage::Degenerate,
        Damage::NoPlace,
        Damage::Cropped,
        Damage::Together,
    ];

    /// Whether somebody has to be told of it: the rest changes no triangle, or only where it lies.
    pub fn is_told(self) -> bool {
        match self {
            Damage::None | Damage::Noise | Damage::SelfIntersections | Damage::ThinGap => false,
            // A piece of its own is no damage: what of it is tissue is left out, and told.
            Damage::Islands => false,
            Damage::Holes
            | Damage::RoundHole
            | Damage::Flips
            | Damage::HalfGone
            | Damage::DoubledSheet
            | Damage::Soup
            | Damage::Inverted
            | Damage::Degenerate
            | Damage::NoPlace
            | Damage::Cropped
            | Damage::Together => true,
        }
    }

    pub fn of(self, surface: &TriangleSurface, seed: u64) -> TriangleSurface {
        let mut random = Noise::new(seed.wrapping_mul(7919).wrapping_add(self as u64));
        let mut damaged = surface.clone();
        let all = [
            Damage::Holes,
            Damage::Noise,
            Damage::Islands,
            Damage::DoubledSheet,
            Damage::Soup,
            Damage::Flips,
        ];
        match self {
            Damage::Together => all.into_iter().for_each(|one| one.add(&mut damaged, &mut random)),
            one => one.add(&mut damaged, &mut random),
        }
        damaged
    }

    fn add(self, surface: &mut TriangleSurface, random: &mut Noise) {
        match self {
            Damage::None | Damage::Together => {}
            Damage::Holes => leave_out(surface, 0.2 * random.uniform(), random),
            Damage::RoundHole => {
                let (at, radius) = (corner(surface, random), 5.0 + 20.0 * random.uniform());
                keep(surface, |corners| (corners[0] - at).norm() > radius);
            }
            Damage::Flips => flip(surface, 0.3 * random.uniform(), random),
            Damage::HalfGone => leave_out(surface, 0.5, random),
            Damage::Islands => islands(surface, random),
            Damage::SelfIntersections => {
                for _ in 0..6 {
                    push(surface, random);
                }
            }
            Damage::Noise => {
                let size = 0.3 * random.uniform();
                surface.points.iter_mut().for_each(|point| *point += random.vector() * size);
            }
            Damage::DoubledSheet => doubled(surface, 0.05 + 0.45 * random.uniform()),
            Damage::ThinGap => gap(surface, random),
            Damage::Soup => soup(surface, 0.3 * random.uniform(), random),
            Damage::Inverted => flip(surface, 2.0, random),
            Damage::Degenerate => {
                let triangles = surface.triangles.clone();
                surface.triangles.extend(triangles.iter().step_by(3));
                surface.triangles.extend(triangles.iter().step_by(7).map(|[a, b, _]| [*a, *b, *a]));
            }
            Damage::NoPlace => {
                let point = (random.uniform() * surface.points.len() as f64) as usize;
                surface.points[point].y = if random.uniform() < 0.5 { f64::NAN } else { 1e30 };
            }
            Damage::Cropped => {
                let (low, high) = surface.bounds();
                let beyond = low.y + (high.y - low.y) * (0.3 + 0.4 * random.uniform());
                keep(surface, |corners| corners[0].y < beyond);
            }
        }
    }
}

fn keep(surface: &mut TriangleSurface, mut wanted: impl FnMut(&[Vector; 3]) -> bool) {
    let kept = (0..surface.triangles.len()).filter(|&n| wanted(&surface.corners(n)));
    surface.triangles = kept.map(|n| surface.triangles[n]).collect();
}

fn leave_out(surface: &mut TriangleSurface, share: f64, random: &mut Noise) {
    surface.triangles.retain(|_| random.uniform() >= share);
}

fn flip(surface: &mut TriangleSurface, share: f64, random: &mut Noise) {
    for triangle in &mut surface.triangles {
        if random.uniform() < share {
            triangle.swap(1, 2);
        }
    }
}

/// A corner of the surface, anywhere.
fn corner(surface: &TriangleSurface, random: &mut Noise) -> Vector {
    let triangle = (random.uniform() * surface.triangles.len() as f64) as usize;
    surface.corners(triangle)[0]
}

fn add(surface: &mut TriangleSurface, other: TriangleSurface) {
    let first = surface.points.len() as u32;
    surface.points.extend(other.points);
    let shifted = other.triangles.iter().map(|corners| corners.map(|point| point + first));
    surface.triangles.extend(shifted);
}

fn islands(surface: &mut TriangleSurface, random: &mut Noise) {
    let (low, high) = surface.bounds();
    for _ in 0..20 {
        let part = Vector::new(random.uniform(), random.uniform(), random.uniform());
        let centre = low + (high - low).component_mul(&part);
        add(surface, sphere(0.5 + 1.5 * random.uniform(), centre, 1));
    }
}

/// Pushes what lies within 6 mm of a corner up to 6 mm aside.
fn push(surface: &mut TriangleSurface, random: &mut Noise) {
    let (at, way) = (corner(surface, random), random.vector().normalize() * 6.0 * random.uniform());
    for point in &mut surface.points {
        let share = 1.0 - (*point - at).norm() / 6.0;
        *point += way * share.max(0.0);
    }
}

fn doubled(surface: &mut TriangleSurface, depth: f64) {
    let (low, high) = surface.bounds();
    let middle = (low + high) * 0.5;
    let inner = map(surface, |point| point - (point - middle).normalize() * depth);
    add(surface, inner);
}

/// A cavity of 20 x 20 x .3 mm on the way from a corner to the middle.
fn gap(surface: &mut TriangleSurface, random: &mut Noise) {
    let (low, high) = surface.bounds();
    let at = corner(surface, random);
    let centre = at + ((low + high) * 0.5 - at) * 0.1;
    let mut cavity = sphere(1.0, Vector::zeros(), 2);
    cavity.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let size = Vector::new(10.0, 10.0, 0.15);
    add(surface, map(&cavity, |point| centre + point.component_mul(&size)));
}

fn soup(surface: &mut TriangleSurface, size: f64, random: &mut Noise) {
    let corners = (0..surface.triangles.len()).flat_map(|n| surface.corners(n));
    let mut shift = || Vector::new(random.uniform(), random.uniform(), random.uniform());
    let points: Vec<Vector> =
        corners.map(|corner| corner + (shift().map(|x| 2.0 * x - 1.0)) * size).collect();
    let triangles = (0..points.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    *surface = TriangleSurface { points, triangles, node_ids: None };
}
