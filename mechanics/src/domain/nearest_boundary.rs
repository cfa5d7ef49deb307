//! The nearest point of a boundary that is the root of a smooth function, by sequential quadratic steps.
//!
//! Each step takes the functions as linear and goes to the point of their common root that is nearest to where the search
//! began: d = (a - x) - Gᵀ λ with G Gᵀ λ = G (a - x) + g. Source: Nocedal, Wright, Numerical Optimization, 2nd edition, 2006,
//! section 18.1, with the identity for the Hessian.

use crate::mesh::Vector;

/// A function's value and gradient at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    pub value: f64,
    pub gradient: Vector,
}

/// The function whose root is wanted, and the least of those that must not be negative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    pub wanted: Slope,
    pub bound: Slope,
}

/// What is near enough, in mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// The longest step.
    pub step: f64,
    /// The farthest the result may be.
    pub far: f64,
}

const MOST_STEPS: usize = 20;
/// A step shorter than this, in mm, is the last: what it leaves is a part of it by the curvature of the function.
const STILL: f64 = 1e-3;
/// How far from the root a result may be before its last step, in mm.
const NEAR: f64 = 1e-3;
/// A place nearer than this part of a step is not doubted.
const SURELY_NEAREST: f64 = 0.5;
/// How many distances a change of sign is looked for at, and how often its place is halved.
const RADII: u32 = 6;
const HALVINGS: u32 = 8;
/// Gradients whose squared sine is less are parallel.
const PARALLEL: f64 = 1e-6;

/// The nearest point to `start` at which the wanted function is zero and the bound is not negative; `None` where none is
/// found. `value` is the wanted function alone.
///
/// Where the function is flat its slope leads nowhere: then a change of sign is looked for in fourteen directions.
pub(super) fn nearest(
    start: &Vector,
    reach: Reach,
    slopes: impl Fn(&Vector) -> Slopes,
    value: impl Fn(&Vector) -> f64,
) -> Option<Vector> {
    let along_slope = nearest_from(*start, start, reach, &slopes);
    let distance = |point: &Vector| (point - start).norm();
    let far = along_slope.as_ref().map_or(reach.far, distance);
    if far <= SURELY_NEAREST * reach.step {
        return along_slope;
    }
    let wider = Reach { far, ..reach };
    let beyond = change_of_sign(start, wider, value);
    let other = beyond.and_then(|beyond| nearest_from(beyond, start, wider, &slopes));
    other.or(along_slope)
}

/// A point near a change of the sign that `value` has at `start`.
fn change_of_sign(start: &Vector, reach: Reach, value: impl Fn(&Vector) -> f64) -> Option<Vector> {
    let sign = value(start) > 0.0;
    let stays = |point: &Vector| (value(point) > 0.0) == sign;
    let mut before = 0.0;
    for number in 1..=RADII {
        let radius = reach.far * f64::from(number) / f64::from(RADII);
        if let Some(way) = ways().find(|way| !stays(&(start + way * radius))) {
            return Some(halved(start, &way, [before, radius], stays));
        }
        before = radius;
    }
    None
}

/// Along the axes and the diagonals of a cube.
fn ways() -> impl Iterator<Item = Vector> {
    let corner = |n: usize| Vector::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64);
    let all = (0..27).map(move |n| corner(n) - Vector::repeat(1.0));
    all.filter(|way| [1.0, 3.0].contains(&way.norm_squared())).map(|way| way.normalize())
}

/// The middle of a bracket on a way, halved some times.
fn halved(
    start: &Vector,
    way: &Vector,
    [mut low, mut high]: [f64; 2],
    is_low: impl Fn(&Vector) -> bool,
) -> Vector {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_low(&(start + way * middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    start + way * (0.5 * (low + high))
}

fn nearest_from(
    mut point: Vector,
    start: &Vector,
    reach: Reach,
    slopes: &impl Fn(&Vector) -> Slopes,
) -> Option<Vector> {
    let mut is_bound = false;
    let mut here = slopes(&point);
    for _ in 0..MOST_STEPS {
        is_bound |= here.bound.value < 0.0;
        let step = if is_bound { both(&here, start - point) } else { None };
        let step = step.or_else(|| one(&here.wanted, start - point))?;
        let length = step.norm();
        point += step * (reach.step / length).min(1.0);
        if length < STILL {
            break;
        }
        here = slopes(&point);
    }
    let is_on = here.wanted.value.abs() <= NEAR * here.wanted.gradient.norm();
    let is_kept = here.bound.value >= -NEAR * here.bound.gradient.norm();
    (is_on && is_kept && (point - start).norm() <= reach.far).then_some(point)
}

fn one(slope: &Slope, back: Vector) -> Option<Vector> {
    let square = slope.gradient.norm_squared();
    let along = (slope.gradient.dot(&back) + slope.value) / square;
    along.is_finite().then(|| back - slope.gradient * along)
}

fn both(slopes: &Slopes, back: Vector) -> Option<Vector> {
    let Slopes { wanted: a, bound: b } = slopes;
    let (aa, bb) = (a.gradient.norm_squared(), b.gradient.norm_squared());
    let ab = a.gradient.dot(&b.gradient);
    let determinant = aa * bb - ab * ab;
    if determinant <= PARALLEL * aa * bb {
        return None;
    }
    let (p, q) = (a.gradient.dot(&back) + a.value, b.gradient.dot(&back) + b.value);
    let step = back
        - a.gradient * ((bb * p - ab * q) / determinant)
        - b.gradient * ((aa * q - ab * p) / determinant);
    step.iter().all(|x| x.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { step: 1.0, far: 5.0 };

    fn sphere(point: &Vector, radius: f64) -> Slope {
        Slope { value: radius * radius - point.norm_squared(), gradient: point * -2.0 }
    }

    #[test]
    fn the_nearest_point_of_a_sphere_lies_under_the_start_and_on_the_crease_where_a_plane_cuts() {
        let slopes = |point: &Vector| Slopes {
            wanted: sphere(point, 10.0),
            bound: Slope { value: point.z, gradient: Vector::z() },
        };
        let value = |point: &Vector| slopes(point).wanted.value;
        let free = Vector::new(4.0, 5.0, 6.0);
        let found = nearest(&free, REACH, slopes, value).unwrap();
        assert!((found - free.normalize() * 10.0).norm() < 1e-4, "{found}");
        let below = Vector::new(6.0, 7.0, -1.0);
        let found = nearest(&below, REACH, slopes, value).unwrap();
        let crease = Vector::new(6.0, 7.0, 0.0).normalize() * 10.0;
        assert!((found - crease).norm() < 1e-3, "{found}");
    }

    #[test]
    fn what_is_too_far_or_has_no_gradient_has_no_nearest_point() {
        let bound = Slope { value: 1.0, gradient: Vector::z() };
        let slopes = |point: &Vector| Slopes { wanted: sphere(point, 10.0), bound };
        let value = |point: &Vector| slopes(point).wanted.value;
        assert_eq!(nearest(&(Vector::x() * 4.0), REACH, slopes, value), None);
        assert_eq!(nearest(&Vector::zeros(), REACH, slopes, value), None);
    }
}
