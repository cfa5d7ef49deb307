//! Bodies given by distances, for meshers.

use mechanics::domain::{Boundary, Coverage, Crossing, Domain};
use mechanics::mesh::Vector;

/// A signed distance, positive in tissue, or a bound below it; changes by at most the way between two points.
pub type Distance = Box<dyn Fn(&Vector) -> f64 + Sync + Send>;

/// What lies within several surfaces.
pub struct Body {
    pub parts: Vec<(Boundary, Distance)>,
    pub low: Vector,
    pub high: Vector,
    pub thickness: Option<Distance>,
}

impl Body {
    pub fn new(half: f64, parts: Vec<(Boundary, Distance)>) -> Body {
        let high = Vector::repeat(half);
        Body { parts, low: -high, high, thickness: None }
    }

    pub fn skin(half: f64, distance: impl Fn(&Vector) -> f64 + Sync + Send + 'static) -> Body {
        Body::new(half, vec![(Boundary::Skin, Box::new(distance))])
    }

    fn part(&self, boundary: Boundary) -> Option<&Distance> {
        self.parts.iter().find(|part| part.0 == boundary).map(|part| &part.1)
    }

    fn nearest(&self, point: &Vector) -> Boundary {
        let nearest = self.parts.iter().min_by(|a, b| a.1(point).total_cmp(&b.1(point)));
        nearest.unwrap().0
    }
}

pub fn ball(radius: f64) -> Body {
    Body::skin(radius, move |x| radius - x.norm())
}

/// Tissue between bone and skin.
pub fn shell(inner: f64, outer: f64) -> Body {
    let skin: Distance = Box::new(move |x| outer - x.norm());
    let bone: Distance = Box::new(move |x| x.norm() - inner);
    Body::new(outer, vec![(Boundary::Skin, skin), (Boundary::Bone, bone)])
}

/// A ring about the z axis.
pub fn torus(large: f64, small: f64) -> Body {
    Body::skin(large + small, move |x| small - (x.xy().norm() - large).hypot(x.z))
}

/// A box with skin at the sides, bone below and a cut above.
pub fn block(half: Vector) -> Body {
    let skin: Distance = Box::new(move |x| (half - x.abs()).xy().min());
    let bone: Distance = Box::new(move |x| x.z + half.z);
    let cut: Distance = Box::new(move |x| half.z - x.z);
    let parts = vec![(Boundary::Skin, skin), (Boundary::Bone, bone), (Boundary::Cut, cut)];
    Body { low: -half, high: half, ..Body::new(half.max(), parts) }
}

/// All points of some balls.
pub fn balls(balls: Vec<(Vector, f64)>) -> Body {
    let reach = balls.iter().map(|(centre, radius)| centre.amax() + radius).fold(0.0, f64::max);
    Body::skin(reach, move |x| {
        let within = balls.iter().map(|(centre, radius)| radius - (x - centre).norm());
        within.fold(f64::NEG_INFINITY, f64::max)
    })
}

/// A gap between two parallel planes.
#[derive(Clone, Copy)]
pub struct Slit {
    /// Of length 1.
    pub normal: Vector,
    pub offset: f64,
    pub half_width: f64,
}

/// A ball with gaps in it.
pub fn slit_ball(radius: f64, slits: Vec<Slit>) -> Body {
    Body::skin(radius, move |x| {
        let beside =
            slits.iter().map(|slit| (x.dot(&slit.normal) - slit.offset).abs() - slit.half_width);
        beside.fold(radius - x.norm(), f64::min)
    })
}

impl Domain for Body {
    fn bounds(&self) -> (Vector, Vector) {
        (self.low, self.high)
    }

    fn coverage(&self, centre: &Vector, radius: f64) -> Coverage {
        match self.value(centre) {
            value if value > radius => Coverage::Inside,
            value if value < -radius => Coverage::Outside,
            _ => Coverage::Mixed,
        }
    }

    fn value(&self, point: &Vector) -> f64 {
        // NaN goes through.
        let values = self.parts.iter().map(|part| part.1(point));
        values.fold(
            f64::INFINITY,
            |least, value| if least.is_nan() || value >= least { least } else { value },
        )
    }

    fn crossing(&self, inside: &Vector, outside: &Vector) -> Crossing {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = (low + high) / 2.0;
            if self.value(&inside.lerp(outside, middle)) > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        let point = inside.lerp(outside, (low + high) / 2.0);
        Crossing { point, boundary: self.nearest(&point) }
    }

    fn projection(&self, point: &Vector, boundary: Boundary) -> Vector {
        let Some(distance) = self.part(boundary) else { return *point };
        let mut at = *point;
        for _ in 0..3 {
            let here = distance(&at);
            let step = 1e-5;
            let slope = [Vector::x(), Vector::y(), Vector::z()].map(|axis| {
                (distance(&(at + axis * step)) - distance(&(at - axis * step))) / (2.0 * step)
            });
            let slope = Vector::from(slope);
            if slope.norm_squared() < 0.25 {
                return *point;
            }
            at -= slope * (here / slope.norm_squared());
        }
        at
    }

    fn thickness(&self, point: &Vector) -> f64 {
        self.thickness.as_ref().map_or(f64::INFINITY, |thickness| thickness(point))
    }
}
