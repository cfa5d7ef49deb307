//! A skin that follows two segments, plans, targets and noise for the tests of inverse planning.

use std::f64::consts::TAU;

use mechanics::mesh::Vector;
use mechanics::optimisation::{Goal, Optimum, SegmentBounds, SkinPoint, Target};
use mechanics::plan::RigidMovement;
use mechanics::response::{COLUMNS_PER_SEGMENT, Response, ResponseSegment};

/// splitmix64 (Steele, Lea, Flood, OOPSLA 2014): the same numbers everywhere.
pub struct Random(pub u64);

impl Random {
    /// In (0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        ((bits >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Mean 0, standard deviation 1 (Box, Muller 1958).
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

const CENTRES: [[f64; 3]; 2] = [[0.0, -30.0, -40.0], [5.0, -35.0, 10.0]];
pub const PIVOTS: [[f64; 3]; 2] = [[0.0, 40.0, -10.0], [0.0, 20.0, 20.0]];
pub const SIDE: i32 = 10;

/// A bent sheet in front of two segments.
pub fn skin() -> Vec<Vector> {
    let row = |k: i32| (0..SIDE).map(move |j| (f64::from(j), f64::from(k)));
    let point = |(j, k): (f64, f64)| {
        let (x, z) = (12.0 * j - 54.0, 12.0 * k - 70.0);
        Vector::new(x, -60.0 + 0.006 * x * x, z)
    };
    (0..SIDE).flat_map(row).map(point).collect()
}

/// Skin that follows each of two segments by a share that falls with the distance.
pub fn response(skin: &[Vector]) -> Response {
    let mut columns = Vec::new();
    for centre in CENTRES.map(Vector::from) {
        for k in 0..COLUMNS_PER_SEGMENT {
            for point in skin {
                let arm = point - centre;
                let share = 0.9 * (-arm.norm_squared() / 3000.0).exp() + 0.02;
                let by = if k % 4 == 3 { share } else { share * arm[k % 4] };
                columns.extend((0..3).map(|axis| if axis == k / 4 { by as f32 } else { 0.0 }));
            }
        }
    }
    let segment = |(name, centre): (&str, [f64; 3])| ResponseSegment {
        name: name.to_owned(),
        centre: centre.into(),
    };
    let segments = ["mandible", "maxilla"].into_iter().zip(CENTRES).map(segment).collect();
    Response { segments, inner: Vec::new(), nodes: (0..skin.len() as u32).collect(), columns }
}

pub fn movement(segment: usize, q: &[f64; 6]) -> RigidMovement {
    let angles = Vector::new(q[3], q[4], q[5]);
    RigidMovement::about_pivot(angles, PIVOTS[segment].into(), Vector::new(q[0], q[1], q[2]))
}

/// Translations in mm, then angles in degrees.
pub fn planted(numbers: [[f64; 6]; 2]) -> [[f64; 6]; 2] {
    numbers.map(|q| std::array::from_fn(|k| if k < 3 { q[k] } else { q[k].to_radians() }))
}

pub fn moved_skin(response: &Response, plan: &[[f64; 6]; 2]) -> Vec<Vector> {
    response.apply(&[movement(0, &plan[0]), movement(1, &plan[1])])
}

pub fn every_node(wanted: &[Vector], sigma: f64) -> Target {
    let goal = |(place, u): (usize, &Vector)| Goal {
        point: SkinPoint::node(place as u32),
        displacement: [u.x, u.y, u.z].map(Some),
    };
    Target { goals: wanted.iter().enumerate().map(goal).collect(), sigma }
}

pub fn bounds(mm: f64, degrees: f64) -> Vec<SegmentBounds> {
    let interval = |k: usize| {
        let end = if k < 3 { mm } else { degrees.to_radians() };
        (-end, end)
    };
    let of = |pivot: [f64; 3]| SegmentBounds {
        intervals: std::array::from_fn(interval),
        pivot: pivot.into(),
    };
    PIVOTS.map(of).to_vec()
}

/// Everything that must hold for any optimum.
pub fn check(optimum: &Optimum, bounds: &[SegmentBounds]) {
    for (q, bounds) in optimum.parameters.iter().zip(bounds) {
        for (value, (low, high)) in q.iter().zip(bounds.intervals) {
            assert!(*value >= low - 1e-12 && *value <= high + 1e-12, "{value} {low} {high}");
        }
    }
    assert!(optimum.certainty.covariance.iter().all(|value| value.is_finite()));
    let errors = optimum.certainty.standard_errors();
    assert!(errors.iter().all(|error| *error > 0.0), "{errors:?}");
}

/// The largest difference in mm and in degrees.
pub fn difference(found: &[[f64; 6]], plan: &[[f64; 6]]) -> (f64, f64) {
    let mut largest = (0.0_f64, 0.0_f64);
    for (found, plan) in found.iter().zip(plan) {
        for k in 0..6 {
            let left = (found[k] - plan[k]).abs();
            match k {
                0..3 => largest.0 = largest.0.max(left),
                _ => largest.1 = largest.1.max(left.to_degrees()),
            }
        }
    }
    largest
}
