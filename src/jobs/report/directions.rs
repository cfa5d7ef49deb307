//! Directions of the head in the frame of a case, and movements in a surgeon's terms.
//!
//! LPS: x to the patient's left, y to the back, z up. RAS: x to the right, y to the front, z up. Angles are those of
//! R = Rz Ry Rx about fixed axes. Pitch lifts the front, roll lifts the left side, yaw turns the front to the left, as the
//! page (`web/src/frame.ts`) does. If the frame is not stated the numbers are those of its axes.

use mechanics::mesh::{Frame, Vector};
use mechanics::plan::RigidMovement;

/// Forward, up and left.
pub fn directions(vector: &Vector, frame: Frame) -> [f64; 3] {
    match frame {
        Frame::Lps => [-vector.y, vector.z, vector.x],
        Frame::Ras => [vector.y, vector.z, -vector.x],
        Frame::Unspecified => [vector.y, vector.z, vector.x],
    }
}

/// Forward, up and left in mm of a point, then pitch, roll and yaw in degrees.
pub fn motion(movement: &RigidMovement, of: &Vector, frame: Frame) -> [f64; 6] {
    let rotation = movement.rotation();
    let about_x = rotation[(2, 1)].atan2(rotation[(2, 2)]);
    let about_y = -rotation[(2, 0)].clamp(-1.0, 1.0).asin();
    let about_z = rotation[(1, 0)].atan2(rotation[(0, 0)]);
    let turn = if frame == Frame::Lps { -1.0 } else { 1.0 };
    let [forward, up, left] = directions(&movement.displacement(of), frame);
    let [pitch, roll, yaw] = [turn * about_x, turn * about_y, about_z].map(f64::to_degrees);
    [forward, up, left, pitch, roll, yaw]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_rises_with_pitch_the_left_side_with_roll_and_the_front_goes_left_with_yaw() {
        for (frame, front, left) in
            [(Frame::Lps, -Vector::y(), Vector::x()), (Frame::Ras, Vector::y(), -Vector::x())]
        {
            for axis in 0..3 {
                let mut angles = Vector::zeros();
                angles[axis] = 0.1;
                let movement = RigidMovement::about_pivot(angles, Vector::zeros(), Vector::zeros());
                let [.., pitch, roll, yaw] = motion(&movement, &Vector::zeros(), frame);
                let rises = |point: &Vector| movement.displacement(point).z.signum();
                match axis {
                    0 => assert_eq!(pitch.signum(), rises(&front)),
                    1 => assert_eq!(roll.signum(), rises(&left)),
                    _ => {
                        assert_eq!(yaw.signum(), movement.displacement(&front).dot(&left).signum())
                    }
                }
                let turned = [pitch, roll, yaw].map(f64::abs);
                assert!((turned[axis] - 0.1f64.to_degrees()).abs() < 1e-9, "{turned:?}");
            }
        }
    }

    #[test]
    fn the_centre_moves_forward_up_and_left() {
        let shift = Vector::new(1.0, -5.0, 2.0);
        let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), shift);
        let at = |frame| motion(&movement, &Vector::new(3.0, 3.0, 3.0), frame);
        assert_eq!(at(Frame::Lps)[..3], [5.0, 2.0, 1.0]);
        assert_eq!(at(Frame::Ras)[..3], [-5.0, 2.0, -1.0]);
    }
}
