//! Plausibility of a plan: nothing moves, metres for millimetres, radians for degrees, movements larger than the face.

use super::RigidMovement;
use crate::mesh::{Vector, Warning};

/// Below this many mm no movement of bone is planned: in metres it would be up to 50 mm.
const METRES_MM: f64 = 0.05;
/// Below this many mm a segment beside others that move was not meant to: in metres it would be up to 0.1 mm.
const STILL_MM: f64 = 1e-4;
/// Below this angle no turn of bone is planned, in degrees: in radians it would be up to 11.5 degrees.
const RADIANS_DEG: f64 = 0.2;
/// Up to this many degrees a matrix is no turn but the rounding of one without.
pub const ROUNDING_DEG: f64 = 1e-3;

/// In mm: the middle of no segment is moved farther.
pub const FARTHEST_MM: f64 = 100.0;

/// The code of the warning of numbers that another unit explains.
pub const PLAN_UNITS_SUSPECT: &str = "plan-units-suspect";
/// The code of the warning of a plan that moves nothing.
pub const NOTHING_MOVES: &str = "nothing-moves";

/// A segment, its movement, and the lowest and the highest corner of the box around its nodes, in mm.
#[derive(Clone, Copy)]
pub struct MovedSegment<'a> {
    pub name: &'a str,
    pub movement: &'a RigidMovement,
    pub corners: [Vector; 2],
}

/// A segment whose middle goes too far; distances in mm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TooFar {
    #[error("segment {name:?} moves by {distance:.3} mm, and the mesh is {diagonal:.3} mm across")]
    BeyondFace { name: String, distance: f64, diagonal: f64 },
    #[error(
        "segment {name:?} moves by {distance:.3} mm in all, at most {FARTHEST_MM} mm are allowed"
    )]
    BeyondLimit { name: String, distance: f64 },
}

impl TooFar {
    /// Of the segment.
    pub fn name(&self) -> &str {
        match self {
            TooFar::BeyondFace { name, .. } | TooFar::BeyondLimit { name, .. } => name,
        }
    }
}

impl MovedSegment<'_> {
    /// How far the middle of the segment goes, in mm.
    fn distance(&self) -> f64 {
        let [low, high] = self.corners;
        self.movement.displacement(&((low + high) * 0.5)).norm()
    }

    fn turn_deg(&self) -> f64 {
        self.movement.angle().to_degrees()
    }

    /// How far the corners of its box go at most, in mm.
    fn farthest(&self) -> f64 {
        farthest_apart(self.movement, &RigidMovement::default(), &self.corners)
    }
}

/// The largest distance in mm between where two movements take a point of a box: that of a corner.
pub fn farthest_apart(
    one: &RigidMovement,
    other: &RigidMovement,
    [low, high]: &[Vector; 2],
) -> f64 {
    let corner = |bits: usize| {
        Vector::from_fn(|axis, _| if bits >> axis & 1 == 0 { low[axis] } else { high[axis] })
    };
    let apart = |point: Vector| (one.displacement(&point) - other.displacement(&point)).norm();
    (0..8).map(corner).map(apart).fold(0.0, f64::max)
}

/// The warning of a plan in which nothing moves and nothing acts.
pub fn nothing_moves() -> Warning {
    Warning::new(NOTHING_MOVES, "the plan moves nothing: no tissue is displaced")
}

/// Warnings where movements are so small that another unit explains them better: turns of all segments, shifts of each by
/// itself. A segment that turns may be shifted by its pivot; what was stated for it is judged by [`suspect_shift`].
pub fn suspect_units(segments: &[MovedSegment]) -> Vec<Warning> {
    let turn = segments.iter().map(MovedSegment::turn_deg).fold(0.0, f64::max);
    let mut warnings = Vec::new();
    if turn > ROUNDING_DEG && turn < RADIANS_DEG {
        let meant = turn.to_degrees();
        let detail = format!(
            "no segment turns by more than {turn:.3e} degrees: are these radians, {meant:.3} degrees?"
        );
        let warning = Warning::new(PLAN_UNITS_SUSPECT, detail).with("rotation_deg", turn);
        warnings.push(warning.with("if_radians_deg", meant));
    }
    let farthest = segments.iter().map(MovedSegment::farthest).fold(0.0, f64::max);
    if turn <= ROUNDING_DEG && farthest > 0.0 && farthest < METRES_MM {
        let said = format!("no segment moves by more than {farthest:.3e} mm");
        warnings.push(in_metres(&said, farthest));
        return warnings;
    }
    let shifted = segments.iter().filter(|segment| segment.turn_deg() <= ROUNDING_DEG);
    warnings.extend(shifted.filter_map(|segment| suspect_shift(segment.name, segment.farthest())));
    warnings
}

/// The warning of a segment that is shifted by so many mm, if metres explain them better.
pub fn suspect_shift(name: &str, shift: f64) -> Option<Warning> {
    let said = format!("segment `{name}` is shifted by no more than {shift:.3e} mm");
    (STILL_MM..METRES_MM).contains(&shift).then(|| in_metres(&said, shift))
}

fn in_metres(said: &str, shift: f64) -> Warning {
    let meant = shift * 1000.0;
    let detail = format!("{said}: are these metres, {meant:.3} mm?");
    let warning = Warning::new(PLAN_UNITS_SUSPECT, detail).with("translation_mm", shift);
    warning.with("if_metres_mm", meant)
}

/// The first segment whose middle the total movement takes farther than the mesh is across, or than [`FARTHEST_MM`]. The translation of
/// a movement is no measure of that: a rotation about a far pivot has a long one.
pub fn too_far(segments: &[MovedSegment], diagonal: f64) -> Option<TooFar> {
    segments.iter().find_map(|segment| {
        let (name, distance) = (segment.name.to_owned(), segment.distance());
        if distance > diagonal {
            return Some(TooFar::BeyondFace { name, distance, diagonal });
        }
        // The distance carries rounding of the composed movement in its last digits.
        (distance > FARTHEST_MM * (1.0 + 1e-9)).then_some(TooFar::BeyondLimit { name, distance })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(movement: &RigidMovement) -> [MovedSegment<'_>; 1] {
        let corners = [Vector::new(-20.0, -10.0, 0.0), Vector::new(20.0, 10.0, 30.0)];
        [MovedSegment { name: "jaw", movement, corners }]
    }

    fn shifted(x: f64) -> RigidMovement {
        RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::new(x, 0.0, 0.0))
    }

    fn turned(degrees: f64) -> RigidMovement {
        let angles = Vector::new(0.0, degrees.to_radians(), 0.0);
        RigidMovement::about_pivot(angles, Vector::zeros(), Vector::zeros())
    }

    #[test]
    fn metres_and_radians_are_reported_with_what_they_would_mean() {
        let metres = suspect_units(&moved(&shifted(0.005))).remove(0);
        assert_eq!(metres.numbers[1].0, "if_metres_mm");
        assert!((metres.numbers[1].1 - 5.0).abs() < 1e-12, "{metres:?}");
        let radians = suspect_units(&moved(&turned(0.1))).remove(0);
        assert_eq!(radians.numbers[1].0, "if_radians_deg");
        // 0.1 rad.
        assert!((radians.numbers[1].1 - 5.729577951).abs() < 1e-6, "{radians:?}");
    }

    #[test]
    fn usual_movements_and_rest_are_not_suspect() {
        for movement in [
            shifted(0.06),
            shifted(5.0),
            turned(0.25),
            turned(12.0),
            shifted(0.0),
            turned(1e-5).then(&shifted(5.0)),
        ] {
            assert_eq!(suspect_units(&moved(&movement)), []);
        }
    }

    #[test]
    fn a_segment_in_metres_is_reported_beside_segments_in_millimetres() {
        let told = |movement: &RigidMovement| {
            let (far, turn) = (shifted(5.0), turned(3.0));
            let [jaw] = moved(movement);
            let beside = [("maxilla", &far), ("chin", &turn)];
            let beside = beside.map(|(name, movement)| MovedSegment { name, movement, ..jaw });
            suspect_units(&[jaw, beside[0], beside[1]])
        };
        let [metres] = &told(&shifted(0.005))[..] else { panic!("one warning") };
        assert!(metres.detail.contains("segment `jaw`"), "{metres:?}");
        assert!((metres.numbers[1].1 - 5.0).abs() < 1e-12, "{metres:?}");
        for usual in [shifted(0.5), shifted(0.0), shifted(1e-5), shifted(-3.0)] {
            assert_eq!(told(&usual), []);
        }
    }

    #[test]
    fn a_movement_beyond_the_size_of_the_face_is_reported_with_both_lengths() {
        let (near, far) = (shifted(59.0), shifted(61.0));
        assert_eq!(too_far(&moved(&near), 60.0), None);
        let name = "jaw".to_owned();
        let beyond = TooFar::BeyondFace { name, distance: 61.0, diagonal: 60.0 };
        assert_eq!(too_far(&moved(&far), 60.0), Some(beyond));
    }

    #[test]
    fn a_total_movement_is_limited_however_it_is_composed_and_wherever_its_pivot_is() {
        let twice = shifted(75.0).then(&shifted(75.0));
        let refused = too_far(&moved(&twice), 300.0);
        let Some(TooFar::BeyondLimit { distance, .. }) = refused else { panic!("{refused:?}") };
        assert!((distance - 150.0).abs() < 1e-9, "{distance}");
        // There and back, the full length, and a turn of 5 degrees about a pivot 1 m away, whose shift of the origin is 122 mm.
        let angles = Vector::new(0.0, 0.0, 5_f64.to_radians());
        let pivot = Vector::new(0.0, 1000.0, 0.0);
        let far_pivot = RigidMovement::about_pivot(angles, pivot, Vector::zeros());
        let back = shifted(75.0).then(&shifted(-60.0));
        for movement in [back, shifted(100.0), far_pivot] {
            assert_eq!(too_far(&moved(&movement), 300.0), None, "{movement:?}");
        }
    }
}
