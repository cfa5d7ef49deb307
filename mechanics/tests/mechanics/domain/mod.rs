//! Bodies to mesh, against closed forms.

mod containment;
mod damage;
mod image;
mod left_out;
mod surface;

use mechanics::mesh::{TriangleSurface, Vector};

/// Directions evenly over the sphere (Fibonacci lattice).
fn directions(count: usize) -> impl Iterator<Item = Vector> {
    (0..count).map(move |n| {
        let z = (2 * n + 1) as f64 / count as f64 - 1.0;
        let (sin, cos) = (n as f64 * 2.399_963_229_728_653).sin_cos();
        let across = (1.0 - z * z).sqrt();
        Vector::new(across * cos, across * sin, z)
    })
}

/// A part in [0, 1) for each number, dense for each irrational step.
fn part(n: usize, step: f64) -> f64 {
    ((n + 1) as f64 * step).fract()
}

/// A closed grid of `u` by `v` quads, by a function of two angles as parts of a turn; the second does not close.
fn sphere(centre: Vector, radius: f64, rings: usize) -> TriangleSurface {
    let around = 2 * rings;
    let point = |ring: usize, step: usize| {
        let (polar, turn) = (
            std::f64::consts::PI * ring as f64 / rings as f64,
            std::f64::consts::TAU * step as f64 / around as f64,
        );
        let across = polar.sin();
        centre + Vector::new(across * turn.cos(), across * turn.sin(), polar.cos()) * radius
    };
    let mut points = vec![centre + Vector::z() * radius];
    points.extend(
        (1..rings)
            .flat_map(|ring| (0..around).map(move |step| (ring, step)))
            .map(|(r, s)| point(r, s)),
    );
    points.push(centre - Vector::z() * radius);
    let at = |ring: usize, step: usize| match ring {
        0 => 0,
        _ if ring == rings => (rings - 1) * around + 1,
        _ => 1 + (ring - 1) * around + step % around,
    } as u32;
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for step in 0..around {
            let [a, b, c, d] =
                [at(ring, step), at(ring + 1, step), at(ring + 1, step + 1), at(ring, step + 1)];
            triangles.extend(
                [[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a),
            );
        }
    }
    TriangleSurface { points, triangles, node_ids: None }
}

/// A ring about the z axis.
fn torus(large: f64, small: f64, steps: usize) -> TriangleSurface {
    let turn = |step: usize| (std::f64::consts::TAU * step as f64 / steps as f64).sin_cos();
    let point = |n: usize| {
        let ((sin, cos), (up, out)) = (turn(n / steps), turn(n % steps));
        let across = large + small * out;
        Vector::new(across * cos, across * sin, small * up)
    };
    let points = (0..steps * steps).map(point).collect();
    let at = |i: usize, j: usize| (i % steps * steps + j % steps) as u32;
    let quads = (0..steps * steps).map(|n| (n / steps, n % steps));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    TriangleSurface { points, triangles: triangles.collect(), node_ids: None }
}

/// A box from the origin, each face of two triangles.
fn cuboid(size: Vector) -> TriangleSurface {
    let bit = |n: usize, axis: usize| f64::from((n >> axis & 1) as u8) * size[axis];
    let points = (0..8).map(|n| Vector::new(bit(n, 0), bit(n, 1), bit(n, 2))).collect();
    let quads =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleSurface { points, triangles, node_ids: None }
}
