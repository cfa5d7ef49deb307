//! The skin and the bone of the half head as smooth functions, in mm, frame LPS.
//!
//! The base is a sagittal profile swept around the head: at row r of the profile and angle α from
//! the front, with the superellipse |x/w|ⁿ + |y/f|ⁿ = 1 of that row,
//!   x = w (1 − t cos² α) sin α / q,  y = −f cos α / q,  z = h + l (1 − cos α),  q = (|sin α|ⁿ + |cos α|ⁿ)^(1/n),
//! where t narrows the chin and l lets the rows climb along the jaw towards the ears. Bumps and hollows (sums of Gaussians
//! in x and z, pushed towards the front) make nose, eyes, lips and chin. Bone follows a part of them
//! at the tissue thickness of the row. Made to look like a face, not measured on one; thicknesses are
//! in the range that is usual for adults.

use super::Vector;

/// The rows of the profile run from the neck, 0, to the forehead.
pub(super) const TOP_ROW: f64 = 54.0;
/// Where the half head is cut at its sides, in radians from the front: a little behind the ears.
pub(super) const SIDE_ANGLE: f64 = 1.69;
/// Skin is so thick everywhere, in mm.
const SKIN: f64 = 2.0;

/// Row, height h, forward reach f, half width w, taper t, squareness n, climb l, tissue thickness.
const PROFILE: [[f64; 8]; 17] = [
    [0.0, -126.0, 37.0, 52.0, 0.0, 2.0, 3.0, 11.0],
    [3.0, -110.0, 37.5, 51.5, 0.0, 2.0, 11.0, 11.0],
    [5.5, -99.0, 45.0, 53.0, 0.06, 2.0, 20.0, 10.5],
    [9.0, -92.5, 64.0, 55.5, 0.16, 2.0, 29.0, 10.0],
    [12.0, -87.5, 79.0, 57.5, 0.22, 2.0, 33.0, 9.5],
    [15.0, -80.0, 87.0, 60.0, 0.22, 2.0, 32.0, 10.0],
    [18.5, -69.0, 89.0, 62.5, 0.2, 2.0, 28.0, 10.0],
    [23.0, -57.0, 88.5, 65.0, 0.15, 2.0, 22.0, 10.5],
    [27.5, -45.0, 90.0, 67.0, 0.09, 2.05, 16.0, 11.0],
    [33.5, -28.0, 91.5, 69.5, 0.03, 2.1, 8.0, 11.0],
    [37.5, -17.0, 91.5, 70.5, 0.0, 2.2, 4.0, 10.0],
    [41.0, -7.0, 90.0, 71.0, 0.0, 2.25, 1.0, 9.0],
    [44.0, 3.0, 89.0, 71.0, 0.0, 2.25, 0.0, 8.0],
    [47.0, 14.0, 89.5, 70.5, 0.0, 2.25, 0.0, 7.5],
    [49.5, 27.0, 91.0, 70.0, 0.0, 2.25, 0.0, 7.0],
    [51.5, 45.0, 89.5, 69.0, 0.0, 2.2, 0.0, 6.5],
    [54.0, 73.0, 79.0, 62.0, 0.0, 2.1, 0.0, 6.0],
];

/// Height, how far the ridge of the nose rises there, and its half width.
const NOSE: [[f64; 3]; 10] = [
    [-34.0, 0.0, 8.0],
    [-29.5, 1.8, 8.0],
    [-25.0, 10.0, 8.5],
    [-20.5, 19.0, 8.5],
    [-16.0, 23.0, 8.0],
    [-10.0, 20.0, 7.0],
    [-2.0, 14.5, 6.2],
    [8.0, 8.5, 5.6],
    [18.0, 3.0, 5.2],
    [29.0, 0.0, 6.0],
];

/// The five points across the tissue at a row and an angle >= 0 from the front, from bone to skin:
/// deep tissue ends at the second, muscle at the third, fat at the fourth.
pub(super) fn column(row: f64, angle: f64) -> [Vector; 5] {
    let skin = skin(row, angle);
    let bone = base(row, angle) + relief(&base(row, angle), &BONE_SHARE)
        - normal_of(base, row, angle) * thickness(row, angle);
    let across = (normal_of(self::skin, row, angle) + normal_of(base, row, angle)).normalize();
    let below_skin = skin - across * SKIN;
    let between = |share: f64| bone + (below_skin - bone) * share;
    [bone, between(0.36), between(0.68), below_skin, skin]
}

/// The outward normal of a surface over rows and angles, by central differences.
pub(super) fn normal_of(surface: fn(f64, f64) -> Vector, row: f64, angle: f64) -> Vector {
    const STEP: f64 = 1e-3;
    let around = surface(row, angle + STEP) - surface(row, angle - STEP);
    let upwards = surface(row + STEP, angle) - surface(row - STEP, angle);
    around.cross(&upwards).normalize()
}

fn skin(row: f64, angle: f64) -> Vector {
    let base = base(row, angle);
    base + relief(&base, &WHOLE)
}

pub(super) fn base(row: f64, angle: f64) -> Vector {
    let [height, forward, half_width, taper, squareness, climb, _] = interpolated(&PROFILE, row);
    let (sin, cos) = angle.sin_cos();
    let q = (sin.abs().powf(squareness) + cos.abs().powf(squareness)).powf(1.0 / squareness);
    Vector::new(
        half_width * sin / q * (1.0 - taper * cos * cos),
        -forward * cos / q,
        height + climb * (1.0 - cos),
    )
}

/// Tissue over the bone without the relief: more in the cheek, where the fat pad lies.
pub(super) fn thickness(row: f64, angle: f64) -> f64 {
    let [.., thickness] = interpolated::<8, 7>(&PROFILE, row);
    thickness + 4.0 * bell(row - 27.0, 8.0) * bell(angle.abs() - 0.85, 0.35)
}

/// How much of each group of bumps and hollows a surface takes part in.
pub(super) struct Relief {
    pub nose: f64,
    /// And the cheek.
    pub brow: f64,
    /// Of the eyes.
    pub hollow: f64,
    pub lips: f64,
    pub chin: f64,
}

const BONE_SHARE: Relief = Relief { nose: 0.7, brow: 0.75, hollow: 0.8, lips: 0.1, chin: 0.55 };
const WHOLE: Relief = Relief { nose: 1.0, brow: 1.0, hollow: 1.0, lips: 1.0, chin: 1.0 };

/// What stands out of the base at a point of it, by the shares of the five groups.
pub(super) fn relief(base: &Vector, share: &Relief) -> Vector {
    let Relief { nose, brow, hollow, lips, chin } = share;
    let (x, z) = (base.x.abs(), base.z);
    let ridge = nose_ridge(x, z);
    let forward = nose * (ridge + nose_wings(x, z))
        + brow * brow_and_cheek(x, z)
        + hollow * eye(x, z)
        + lips * mouth(x, z)
        + chin * jaw(x, z);
    // The tip hangs a little, which opens the angle between nose and lip.
    Vector::new(0.0, -forward, -0.2 * nose * ridge)
}

fn nose_ridge(x: f64, z: f64) -> f64 {
    let [lowest, highest] = [NOSE[0][0], NOSE[NOSE.len() - 1][0]];
    if z <= lowest || z >= highest {
        return 0.0;
    }
    let [rise, half_width] = interpolated(&NOSE, z);
    rise.max(0.0) * (-0.5 * (x / half_width).powf(2.4)).exp()
}

fn nose_wings(x: f64, z: f64) -> f64 {
    8.5 * bell(x - 12.5, 3.8) * bell(z + 20.0, 4.6) - 3.0 * bell(x - 6.0, 2.6) * bell(z + 26.0, 2.2)
}

fn brow_and_cheek(x: f64, z: f64) -> f64 {
    let arch = 26.0 - 0.006 * (x - 27.0).powi(2);
    4.0 * bell(z - arch, 4.6) * bell(x - 28.0, 15.0)
        + 1.2 * bell(x, 10.0) * bell(z - 31.0, 8.0)
        + 4.0 * bell(x - 42.0, 14.0) * bell(z + 9.0, 12.0)
        - 2.5 * bell(x - 50.0, 12.0) * bell(z + 42.0, 15.0)
        - 2.5 * bell(x - 66.0, 11.0) * bell(z - 32.0, 14.0)
}

/// Sockets, and the closed lids over the eyeballs in them.
fn eye(x: f64, z: f64) -> f64 {
    let lash_line = 7.0 + 0.016 * (x - 31.0).powi(2);
    -12.5 * bell(x - 31.0, 12.5) * bell(z - 11.0, 8.5)
        - 4.0 * bell(x - 16.0, 4.5) * bell(z - 12.0, 6.0)
        + 9.0 * bell(x - 31.0, 8.5) * bell(z - 9.5, 6.0)
        - 2.2 * bell(z - lash_line, 1.8) * bell(x - 31.0, 9.0)
        - 1.0 * bell(z - 17.0 + 0.012 * (x - 31.0).powi(2), 1.8) * bell(x - 31.0, 10.0)
}

fn mouth(x: f64, z: f64) -> f64 {
    let bow = 1.6 * bell(x - 5.0, 3.5);
    let parting = -45.2 - 0.002 * x * x;
    let fold = 15.0 + 0.55 * (-20.0 - z);
    2.5 * bell(x, 22.0) * bell(z + 41.0, 12.0)
        + 3.0 * bell(z + 40.8 - bow, 2.7) * flat_bell(x, 19.0)
        - 3.8 * bell(z - parting, 1.7) * flat_bell(x, 23.0)
        + 4.0 * bell(z + 50.5, 3.2) * flat_bell(x, 16.0)
        - 1.6 * bell(x - 25.0, 3.5) * bell(z + 46.5, 4.0)
        - 1.1 * bell(x, 2.6) * bell(z + 33.0, 4.0)
        + 0.5 * bell(x - 5.0, 2.2) * bell(z + 33.0, 4.0)
        - 1.3 * bell(x - fold, 3.2) * bell(z + 33.0, 9.0)
}

fn jaw(x: f64, z: f64) -> f64 {
    -3.8 * bell(z + 60.0, 4.2) * bell(x, 17.0) + 4.5 * bell(z + 75.0, 8.5) * bell(x, 15.0)
}

pub(super) fn bell(distance: f64, width: f64) -> f64 {
    (-0.5 * (distance / width).powi(2)).exp()
}

/// Near 1 up to about `half_width`, then falling quickly.
pub(super) fn flat_bell(distance: f64, half_width: f64) -> f64 {
    (-(distance / half_width).powi(4)).exp()
}

/// A table at a value of its first column: cubic Hermite, tangents from the neighbours on both sides
/// (Catmull, Rom, A class of local interpolating splines, 1974, for uneven knots).
pub(super) fn interpolated<const N: usize, const M: usize>(
    table: &[[f64; N]],
    at: f64,
) -> [f64; M] {
    let last = table.len() - 1;
    let low = table[1..last].iter().filter(|knot| knot[0] <= at).count();
    let [from, to] = [&table[low], &table[low + 1]];
    let span = to[0] - from[0];
    let t = (at - from[0]) / span;
    let slope = |knot: usize, column: usize| {
        let [before, after] = [&table[knot.saturating_sub(1)], &table[(knot + 1).min(last)]];
        (after[column] - before[column]) / (after[0] - before[0])
    };
    std::array::from_fn(|value| {
        let column = value + 1;
        let [start, end] = [slope(low, column), slope(low + 1, column)].map(|s| s * span);
        let (p, q) = (from[column], to[column]);
        let bend = t * (t - 1.0);
        p + (q - p) * t * t * (3.0 - 2.0 * t) + bend * ((t - 1.0) * start + t * end)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_met_at_its_knots_and_linear_where_it_is_linear() {
        for knot in PROFILE {
            let values: [f64; 7] = interpolated(&PROFILE, knot[0]);
            for (value, expected) in values.iter().zip(&knot[1..]) {
                assert!((value - expected).abs() < 1e-12);
            }
        }
        let line = [0.0, 1.0, 4.0, 6.0].map(|t| [t, 3.0 * t - 1.0]);
        for t in [-0.5, 0.3, 2.0, 5.5, 6.5] {
            let [value] = interpolated(&line, t);
            assert!((value - (3.0 * t - 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_skin_is_smooth_across_every_knot() {
        for row in PROFILE[1..16].iter().map(|knot| knot[0]) {
            for angle in [0.0, 0.4, 1.2] {
                let [a, b, c] = [-1e-4, 0.0, 1e-4].map(|step| skin(row + step, angle));
                // A kink would leave a difference of the first order, 1e-4 times the slope's jump.
                assert!((a - 2.0 * b + c).norm() < 1e-6, "row {row}");
            }
        }
    }
}
