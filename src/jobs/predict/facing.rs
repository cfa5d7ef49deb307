//! Orientation of a face: whether it faces the anterior direction of its frame.

use mechanics::chart::{FaceDirection, clear_front};
use mechanics::mesh::{Frame, TriangleSurface, Vector, Warning};

/// Tolerated angle between a face and the anterior axis of its frame, in degrees: half a face looks 45 degrees to its side.
const MOST_BESIDE_DEG: f64 = 65.0;

/// A warning if the skin clearly does not face the anterior direction of the stated frame: in LPS along -y, in RAS
/// along +y, upright along +z in both.
pub(super) fn frame_mismatch(frame: Frame, skin: &TriangleSurface) -> Option<Warning> {
    let stated = match frame {
        Frame::Lps => FaceDirection::lps(),
        Frame::Ras => FaceDirection::ras(),
        Frame::Unspecified => return None,
    };
    let front = clear_front(&skin.points, &skin.triangles, stated.up)?;
    let beside = stated.front.angle(&front).to_degrees();
    let detail = format!(
        "the frame is {frame}, where a face looks along {}, and this skin looks along {}, {beside:.0} degrees beside \
         it: are the axes different?",
        shown(&stated.front),
        shown(&front)
    );
    let warning = Warning::new("frame-suspect", detail)
        .with("angle_deg", beside)
        .with("stated_front_x", stated.front.x)
        .with("stated_front_y", stated.front.y)
        .with("front_x", front.x)
        .with("front_y", front.y);
    (beside > MOST_BESIDE_DEG).then_some(warning)
}

fn shown(direction: &Vector) -> String {
    // Adding zero turns -0 into 0.
    let [x, y, z] = [direction.x, direction.y, direction.z].map(|c| c + 0.0);
    format!("({x:.2}, {y:.2}, {z:.2})")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tent that looks along +y, and a little to both sides.
    fn tent() -> TriangleSurface {
        let points = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 2.0], [1.0, 0.0, 0.0]];
        let points = points.map(Vector::from).to_vec();
        TriangleSurface { points, triangles: vec![[1, 0, 2], [3, 1, 2]], node_ids: None }
    }

    #[test]
    fn a_face_that_looks_to_the_back_of_its_frame_is_reported_with_both_directions() {
        assert_eq!(frame_mismatch(Frame::Ras, &tent()), None);
        assert_eq!(frame_mismatch(Frame::Unspecified, &tent()), None);
        let told = frame_mismatch(Frame::Lps, &tent()).expect("LPS looks along -y");
        assert_eq!(told.code, "frame-suspect");
        let angle = told.numbers.iter().find(|(name, _)| *name == "angle_deg").expect("an angle").1;
        assert!((angle - 180.0).abs() < 1e-6, "{told:?}");
        assert!(told.detail.contains("(0.00, -1.00, 0.00)"), "{}", told.detail);
        assert!(told.detail.contains("along (0.00, 1.00, 0.00)"), "{}", told.detail);
    }

    #[test]
    fn a_closed_surface_and_one_that_looks_up_have_no_front_to_doubt() {
        let mut closed = tent();
        closed.triangles.extend([[0, 1, 2], [1, 3, 2]]);
        assert_eq!(frame_mismatch(Frame::Lps, &closed), None);
        let up = TriangleSurface { triangles: vec![[0, 3, 1]], ..tent() };
        assert_eq!(frame_mismatch(Frame::Lps, &up), None);
    }
}
