//! Surfaces made in code, and measures of them written differently, for tests of distance and registration.

use std::collections::HashMap;

use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::registration::RigidTransform;
use nalgebra::Rotation3;

/// The unit sphere from an icosahedron whose triangles are quartered so many times.
pub fn unit_sphere(levels: usize) -> TriangleSurface {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let corners = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    let mut points: Vec<Vector> = corners.map(|corner| Vector::from(corner).normalize()).to_vec();
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..levels {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    TriangleSurface { points, triangles, node_ids: None }
}

pub fn sphere(radius: f64, centre: Vector, levels: usize) -> TriangleSurface {
    map(&unit_sphere(levels), |point| point * radius + centre)
}

/// A closed head-like shape in mm without any symmetry: an ellipsoid with a nose, brows and a chin.
pub fn head(levels: usize) -> TriangleSurface {
    map(&unit_sphere(levels), |direction| {
        let bump = |x: f64, y: f64, z: f64, height: f64, sharpness: f64| {
            let cosine = direction.dot(&Vector::new(x, y, z).normalize());
            height * ((cosine - 1.0) * sharpness).exp()
        };
        let radius = 1.0
            + bump(0.05, -1.0, 0.0, 0.22, 60.0)
            + bump(0.4, -0.9, 0.35, 0.06, 40.0)
            + bump(-0.45, -0.85, 0.3, 0.05, 30.0)
            + bump(0.1, -0.8, -0.7, 0.1, 20.0)
            + bump(1.0, 0.2, 0.1, 0.09, 25.0)
            + bump(-1.0, 0.1, 0.05, 0.07, 25.0)
            + bump(0.3, 0.5, 0.8, 0.05, 12.0);
        Vector::new(75.0 * direction.x, 95.0 * direction.y, 110.0 * direction.z) * radius
    })
}

/// A square in the plane z = `height`, its normal along z, with `cells` cells along each side.
pub fn square(side: f64, height: f64, cells: u32) -> TriangleSurface {
    let mut surface = TriangleSurface::default();
    for j in 0..=cells {
        for i in 0..=cells {
            let [x, y] = [i, j].map(|n| (f64::from(n) / f64::from(cells) - 0.5) * side);
            surface.points.push(Vector::new(x, y, height));
        }
    }
    for j in 0..cells {
        for i in 0..cells {
            let a = i + j * (cells + 1);
            let (b, c, d) = (a + 1, a + cells + 2, a + cells + 1);
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

pub fn map(surface: &TriangleSurface, place: impl Fn(&Vector) -> Vector) -> TriangleSurface {
    TriangleSurface { points: surface.points.iter().map(place).collect(), ..surface.clone() }
}

/// Degrees about x, then y, then z, and a translation in mm.
pub fn movement(degrees: [f64; 3], translation: [f64; 3]) -> RigidTransform {
    let [x, y, z] = degrees.map(f64::to_radians);
    let rotation = *Rotation3::from_euler_angles(x, y, z).matrix();
    RigidTransform { rotation, translation: Vector::from(translation) }
}

/// Numbers that look random, always the same: uniform between 0 and 1.
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Noise(seed)
    }

    /// splitmix64, Steele, Lea, Flood 2014.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, standard deviation 1: the sum of twelve uniform numbers.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    pub fn vector(&mut self) -> Vector {
        Vector::new(self.normal(), self.normal(), self.normal())
    }
}

/// How far `found` is from `wanted`: degrees, and mm at `place`.
pub fn difference(found: &RigidTransform, wanted: &RigidTransform, place: &Vector) -> (f64, f64) {
    let angle = found.then(&wanted.inverse()).angle().to_degrees();
    (angle, (found.apply(place) - wanted.apply(place)).norm())
}

/// By trying all triangles with a projection written differently: the minimum over the plane, the edges
/// and the corners.
pub fn brute_force_distance(surface: &TriangleSurface, point: &Vector) -> f64 {
    let segment = |a: &Vector, b: &Vector| {
        let along = ((point - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
        (point - (a + (b - a) * along)).norm()
    };
    let mut smallest = f64::INFINITY;
    for triangle in 0..surface.triangles.len() {
        let [a, b, c] = surface.corners(triangle);
        let normal = (b - a).cross(&(c - a)).normalize();
        let foot = point - normal * normal.dot(&(point - a));
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(p, q)| (q - p).cross(&(foot - p)).dot(&normal) >= 0.0);
        if inside {
            smallest = smallest.min((point - foot).norm());
        }
        smallest = smallest.min(segment(&a, &b)).min(segment(&b, &c)).min(segment(&c, &a));
    }
    smallest
}

/// A closed box between two corners.
pub fn solid(low: [f64; 3], high: [f64; 3]) -> TriangleSurface {
    let corner =
        |bits: usize| Vector::from_fn(|k, _| if bits >> k & 1 == 1 { high[k] } else { low[k] });
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    TriangleSurface {
        points: (0..8).map(corner).collect(),
        triangles: triangles.collect(),
        node_ids: None,
    }
}
