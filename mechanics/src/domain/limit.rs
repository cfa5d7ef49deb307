//! Limits at which a body is cut off on purpose: half-spaces and a region of interest.

use crate::image::ImageVolume;
use crate::mesh::Vector;

/// A ball, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    pub centre: Vector,
    pub radius: f64,
}

/// What tissue must lie in to be kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// Where (x - point) . normal > 0, the normal of any length but zero.
    HalfSpace { point: Vector, normal: Vector },
    /// In one of these balls.
    Balls(Vec<Ball>),
}

/// Why something cannot be cut off.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitError {
    #[error("limit {limit}: the normal has no direction or a number is not finite")]
    HalfSpace { limit: usize },
    #[error(
        "limit {limit}: ball {ball} needs a finite centre and a radius above 0 mm, not {radius}"
    )]
    Ball { limit: usize, ball: usize, radius: f64 },
    #[error("limit {limit} has no balls, which leaves nothing")]
    NoBalls { limit: usize },
}

/// A signed distance, positive inside, with the unit vector along which it grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitValue {
    pub value: f64,
    pub gradient: Vector,
}

impl LimitValue {
    const NONE: LimitValue =
        LimitValue { value: f64::INFINITY, gradient: Vector::new(0.0, 0.0, 0.0) };
}

/// All limits of a body at once; tissue lies inside each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    planes: Vec<Plane>,
    unions: Vec<Vec<Ball>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane {
    point: Vector,
    normal: Vector,
}

impl Limits {
    pub fn new(limits: &[Limit]) -> Result<Self, LimitError> {
        let mut all = Limits::default();
        for (limit, what) in limits.iter().enumerate() {
            match what {
                Limit::HalfSpace { point, normal } => {
                    let normal = normal.try_normalize(f64::MIN_POSITIVE).filter(is_finite);
                    let normal = normal.filter(|_| is_finite(point));
                    let normal = normal.ok_or(LimitError::HalfSpace { limit })?;
                    all.planes.push(Plane { point: *point, normal });
                }
                Limit::Balls(balls) => all.unions.push(checked(limit, balls)?),
            }
        }
        Ok(all)
    }

    /// The faces of the box through the outermost voxel centres.
    pub(super) fn push_border(&mut self, image: &ImageVolume) {
        let last = image.size().map(|size| size - 1);
        for axis in 0..3 {
            let normal: Vector = image.to_index().row(axis).transpose().normalize();
            self.planes.push(Plane { point: image.centre([0; 3]), normal });
            self.planes.push(Plane { point: image.centre(last), normal: -normal });
        }
    }

    /// The least of the signed distances to the limits; infinite without any. It changes by at most 1 mm for each mm.
    pub fn value(&self, point: &Vector) -> f64 {
        let deepest = |balls: &Vec<Ball>| {
            balls.iter().map(|ball| ball.value(point)).fold(f64::NEG_INFINITY, f64::max)
        };
        let planes = self.planes.iter().map(|plane| plane.value(point));
        planes.chain(self.unions.iter().map(deepest)).fold(f64::INFINITY, f64::min)
    }

    pub fn with_gradient(&self, point: &Vector) -> LimitValue {
        let planes = self.planes.iter().map(|plane| plane.at(point));
        let unions = self.unions.iter().map(|balls| deepest(balls, point));
        planes.chain(unions).fold(LimitValue::NONE, |least, one| match one.value < least.value {
            true => one,
            false => least,
        })
    }
}

impl Plane {
    fn value(&self, point: &Vector) -> f64 {
        (point - self.point).dot(&self.normal)
    }

    fn at(&self, point: &Vector) -> LimitValue {
        LimitValue { value: self.value(point), gradient: self.normal }
    }
}

fn deepest(balls: &[Ball], point: &Vector) -> LimitValue {
    let none = LimitValue { value: f64::NEG_INFINITY, ..LimitValue::NONE };
    balls.iter().map(|ball| ball.at(point)).fold(none, |most, one| match one.value > most.value {
        true => one,
        false => most,
    })
}

impl Ball {
    fn value(&self, point: &Vector) -> f64 {
        self.radius - (self.centre - point).norm()
    }

    fn at(&self, point: &Vector) -> LimitValue {
        let inward = self.centre - point;
        let gradient = inward.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector::x);
        LimitValue { value: self.value(point), gradient }
    }
}

fn checked(limit: usize, balls: &[Ball]) -> Result<Vec<Ball>, LimitError> {
    let is_sound =
        |ball: &Ball| is_finite(&ball.centre) && ball.radius > 0.0 && ball.radius.is_finite();
    match balls.iter().position(|ball| !is_sound(ball)) {
        Some(ball) => Err(LimitError::Ball { limit, ball, radius: balls[ball].radius }),
        None if balls.is_empty() => Err(LimitError::NoBalls { limit }),
        None => Ok(balls.to_vec()),
    }
}

fn is_finite(vector: &Vector) -> bool {
    vector.iter().all(|coordinate| coordinate.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_distance_to_planes_and_to_the_union_of_balls_counts() {
        let limits = Limits::new(&[
            Limit::HalfSpace { point: Vector::x() * -3.0, normal: Vector::x() * 20.0 },
            Limit::Balls(vec![
                Ball { centre: Vector::zeros(), radius: 5.0 },
                Ball { centre: Vector::y() * 8.0, radius: 5.0 },
            ]),
        ])
        .unwrap();
        for (point, value, gradient) in [
            (Vector::new(-2.0, 0.0, 0.0), 1.0, Vector::x()),
            (Vector::new(-4.0, 0.0, 0.0), -1.0, Vector::x()),
            (Vector::new(0.0, 12.0, 0.0), 1.0, -Vector::y()),
            (Vector::new(0.0, -6.0, 0.0), -1.0, Vector::y()),
            (Vector::new(3.0, 4.0, 0.0), 0.0, Vector::new(-0.6, -0.8, 0.0)),
        ] {
            let found = limits.with_gradient(&point);
            assert!((found.value - value).abs() < 1e-12, "{point}: {found:?}");
            assert_eq!(limits.value(&point), found.value);
            if point.x != 3.0 {
                assert!((found.gradient - gradient).norm() < 1e-12, "{point}: {found:?}");
            }
        }
        assert_eq!(Limits::default().value(&Vector::zeros()), f64::INFINITY);
    }

    #[test]
    fn limits_without_direction_radius_or_balls_are_refused() {
        let flat = Limit::HalfSpace { point: Vector::zeros(), normal: Vector::zeros() };
        assert_eq!(Limits::new(&[flat]), Err(LimitError::HalfSpace { limit: 0 }));
        let endless = Limit::HalfSpace { point: Vector::x() * f64::NAN, normal: Vector::x() };
        assert_eq!(Limits::new(&[endless]), Err(LimitError::HalfSpace { limit: 0 }));
        let empty = Limit::Balls(vec![Ball { centre: Vector::zeros(), radius: 0.0 }]);
        assert_eq!(Limits::new(&[empty]), Err(LimitError::Ball { limit: 0, ball: 0, radius: 0.0 }));
        assert_eq!(Limits::new(&[Limit::Balls(vec![])]), Err(LimitError::NoBalls { limit: 0 }));
    }
}
