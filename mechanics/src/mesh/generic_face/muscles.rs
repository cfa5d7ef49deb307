//! The muscles of the generic face as polylines through its tissue.
//!
//! Courses by row, degrees and depth, after textbook anatomy and Fig. 1 of Chabanas et al. 2003: an origin on bone and an
//! insertion at the corner of the mouth or in a lip; the orbicularis oris closes on itself.

use super::super::Vector;
use super::shape::{FaceShape, LIP_ROW};

/// A muscle as a case states it: lines in mm, and the distance from them at which its pull has fallen to nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceMuscle {
    pub name: String,
    pub lines: Vec<Vec<Vector>>,
    pub within: f64,
}

/// Row, degrees from the front, depth from the bone (0) to the lower side of the skin (1).
type Stop = [f64; 3];

/// A muscle of one side, from its origin on.
struct Course {
    name: &'static str,
    within: f64,
    lines: &'static [&'static [Stop]],
}

const COURSES: [Course; 7] = [
    Course {
        name: "zygomaticus_major",
        within: 5.0,
        lines: &[&[[39.5, 52.0, 0.2], [36.0, 45.0, 0.5], [32.0, 35.0, 0.6], [28.6, 25.5, 0.6]]],
    },
    Course {
        name: "levator_labii",
        within: 4.0,
        lines: &[
            &[[42.0, 22.0, 0.15], [38.5, 20.0, 0.5], [34.5, 17.0, 0.6], [30.8, 13.0, 0.65]],
            &[[42.0, 27.0, 0.15], [38.0, 25.0, 0.5], [33.5, 21.0, 0.6], [30.0, 17.0, 0.65]],
        ],
    },
    Course {
        name: "depressor_anguli_oris",
        within: 5.0,
        lines: &[
            &[[13.5, 24.0, 0.2], [18.0, 26.0, 0.5], [22.5, 26.0, 0.6], [26.4, 25.0, 0.6]],
            &[[13.5, 32.0, 0.2], [18.0, 31.0, 0.5], [22.5, 28.5, 0.6], [26.6, 26.0, 0.6]],
        ],
    },
    Course {
        name: "buccinator",
        within: 5.0,
        lines: &[
            &[[30.5, 68.0, 0.25], [30.3, 50.0, 0.3], [29.5, 36.0, 0.35], [28.2, 25.5, 0.5]],
            &[[26.0, 68.0, 0.25], [26.3, 50.0, 0.3], [26.6, 36.0, 0.35], [27.0, 25.5, 0.5]],
        ],
    },
    Course {
        name: "mentalis",
        within: 4.0,
        lines: &[&[[21.5, 4.5, 0.2], [19.5, 4.8, 0.5], [17.0, 5.0, 0.9]]],
    },
    Course {
        name: "masseter",
        within: 7.0,
        lines: &[
            &[[38.5, 62.0, 0.15], [31.0, 66.0, 0.35], [24.0, 70.0, 0.3], [18.0, 72.0, 0.15]],
            &[[38.5, 70.0, 0.15], [31.0, 74.0, 0.35], [24.0, 77.0, 0.3], [18.5, 79.0, 0.15]],
        ],
    },
    Course {
        name: "depressor_labii",
        within: 4.0,
        lines: &[&[[14.0, 17.0, 0.2], [18.0, 15.0, 0.5], [21.5, 12.0, 0.6], [24.6, 9.0, 0.65]]],
    },
];

/// Rings of the orbicularis oris: half their height in rows, half their width in degrees, and their depth.
const RINGS: [[f64; 3]; 3] = [[1.3, 22.0, 0.7], [2.6, 25.0, 0.6], [4.2, 28.5, 0.55]];
const RING_REACH: f64 = 3.0;
/// Points of a quarter of a ring.
const QUARTER: usize = 8;
/// Pieces between two stops.
const PIECES: usize = 4;

pub(super) fn of(shape: &FaceShape) -> Vec<FaceMuscle> {
    let mut muscles = Vec::new();
    for course in &COURSES {
        for (side, sign) in [("left", 1.0), ("right", -1.0)] {
            muscles.push(FaceMuscle {
                name: format!("{}_{side}", course.name),
                lines: course.lines.iter().map(|stops| line(shape, stops, sign)).collect(),
                within: course.within,
            });
        }
    }
    let rings = RINGS.iter().map(|ring| orbicularis(shape, ring)).collect();
    muscles.push(FaceMuscle { name: "orbicularis_oris".into(), lines: rings, within: RING_REACH });
    muscles
}

/// The stops and points between them, on one side.
fn line(shape: &FaceShape, stops: &[Stop], sign: f64) -> Vec<Vector> {
    let mut points = Vec::new();
    let place = |[row, degrees, depth]: Stop| {
        let left = shape.inside(row, degrees.to_radians(), depth);
        Vector::new(left.x * sign, left.y, left.z)
    };
    for pair in stops.windows(2) {
        for piece in 0..PIECES {
            let share = piece as f64 / PIECES as f64;
            let mix = |k: usize| pair[0][k] + (pair[1][k] - pair[0][k]) * share;
            points.push(place([mix(0), mix(1), mix(2)]));
        }
    }
    points.extend(stops.last().map(|&stop| place(stop)));
    points
}

/// A ring around the mouth, from the left corner over the upper lip; it ends where it begins.
fn orbicularis(shape: &FaceShape, [rows, degrees, depth]: &[f64; 3]) -> Vec<Vector> {
    let quarter = |step: usize| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * step as f64 / QUARTER as f64).sin_cos();
        let angle = if step == QUARTER { 0.0 } else { degrees.to_radians() * cos };
        (if step == 0 { 0.0 } else { rows * sin }, angle)
    };
    let at = |step: usize, up: f64, left: f64| {
        let (above, angle) = quarter(step);
        let mut point = shape.inside(LIP_ROW + up * above, angle, *depth);
        point.x *= left;
        point
    };
    let upper = (0..=QUARTER).map(|step| at(step, 1.0, 1.0));
    let upper_right = (0..QUARTER).rev().map(|step| at(step, 1.0, -1.0));
    let lower_right = (1..=QUARTER).map(|step| at(step, -1.0, -1.0));
    let lower = (0..QUARTER).rev().map(|step| at(step, -1.0, 1.0));
    upper.chain(upper_right).chain(lower_right).chain(lower).collect()
}
