//! Camera of a picture: the direction from which a face is seen.

use super::Vector;

/// What a picture says of the coordinates that it is drawn in, for a frame as clients name it.
pub(super) fn coordinates(frame: &str) -> String {
    match frame {
        "unspecified" => "coordinates as the mesh has them, which names no frame".to_owned(),
        frame => format!("coordinates in frame {frame}"),
    }
}

/// Which way a face looks and which way its head points; neither has to have length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceDirection {
    /// Out of the face, towards a viewer in front of it.
    pub front: Vector,
    pub up: Vector,
}

impl FaceDirection {
    /// Left, posterior, superior: the face looks along -y.
    pub fn lps() -> Self {
        FaceDirection { front: -Vector::y(), up: Vector::z() }
    }

    /// Right, anterior, superior: the face looks along +y.
    pub fn ras() -> Self {
        FaceDirection { front: Vector::y(), up: Vector::z() }
    }

    /// The camera of somebody who has walked `around` degrees to the right of the person in front
    /// of him (who sees more of the face's left side) and looks down by `above` degrees.
    pub(super) fn camera(&self, around: f64, above: f64) -> Camera {
        let up = self.up.try_normalize(1e-12).unwrap_or_else(Vector::z);
        let across = up.cross(&self.front);
        let right = across
            .try_normalize(1e-12)
            .unwrap_or_else(|| up.cross(&least_aligned(&up)).normalize());
        let front = right.cross(&up);
        let (sin, cos) = around.to_radians().sin_cos();
        let level = front * cos + right * sin;
        let (sin_above, cos_above) = above.to_radians().sin_cos();
        let towards = level * cos_above + up * sin_above;
        Camera { right: up.cross(&level), up: up * cos_above - level * sin_above, towards }
    }
}

/// The axis that makes the largest angle with a direction.
fn least_aligned(direction: &Vector) -> Vector {
    let mut axis = Vector::zeros();
    axis[direction.iamin()] = 1.0;
    axis
}

/// Parallel projection: image axes and the direction towards the viewer, orthonormal.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    pub right: Vector,
    pub up: Vector,
    pub towards: Vector,
}

/// The rectangle that some points cover in an image, in mm.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Camera {
    /// Right, up and towards the viewer, in mm.
    pub fn project(&self, point: &Vector) -> [f64; 3] {
        [self.right.dot(point), self.up.dot(point), self.towards.dot(point)]
    }

    /// What all the points cover; the unit square when there are none.
    pub fn extent<'a>(&self, points: impl Iterator<Item = &'a Vector>) -> Extent {
        let mut extent = Extent { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        for point in points {
            let [right, up, _] = self.project(point);
            extent.low = [extent.low[0].min(right), extent.low[1].min(up)];
            extent.high = [extent.high[0].max(right), extent.high[1].max(up)];
        }
        if (0..2).all(|axis| extent.low[axis].is_finite() && extent.high[axis].is_finite()) {
            extent
        } else {
            Extent { low: [0.0; 2], high: [1.0; 2] }
        }
    }
}

impl Extent {
    /// Width or height in mm.
    pub fn size(&self, axis: usize) -> f64 {
        self.high[axis] - self.low[axis]
    }

    pub fn centre(&self) -> [f64; 2] {
        [0, 1].map(|axis| (self.low[axis] + self.high[axis]) / 2.0)
    }
}

/// Share of a surface that has to be visible from a direction, in projection.
const LEAST_SEEN: f64 = 0.05;

impl FaceDirection {
    /// The same, or where a skin would be seen edge-on, as that of a plate that lies on its back, one that faces it.
    pub fn facing(self, points: &[Vector], triangles: &[[u32; 3]]) -> FaceDirection {
        let front = self.front.try_normalize(1e-12).unwrap_or_else(Vector::zeros);
        let (mut area, mut seen, mut sum) = (0.0, 0.0, Vector::zeros());
        for triangle in triangles {
            let [a, b, c] = triangle.map(|point| points[point as usize]);
            let normal = (b - a).cross(&(c - a));
            area += normal.norm();
            seen += normal.dot(&front).max(0.0);
            sum += normal;
        }
        if seen > LEAST_SEEN * area {
            return self;
        }
        match sum.try_normalize(LEAST_SEEN * area) {
            None => self,
            Some(turned) if turned.dot(&self.up).abs() > 0.9 * self.up.norm() => {
                FaceDirection { front: turned, up: -self.front }
            }
            Some(turned) => FaceDirection { front: turned, up: self.up },
        }
    }
}

/// The front of an open skin surface: its mean outward normal without the part along `up`.
/// Where that vanishes, as on a closed surface, the axis least along `up`.
pub fn front_of(points: &[Vector], triangles: &[[u32; 3]], up: Vector) -> Vector {
    let up = up.try_normalize(1e-12).unwrap_or_else(Vector::z);
    let mean = mean_normal(points, triangles);
    let level = mean - up * up.dot(&mean);
    level.try_normalize(1e-6).unwrap_or_else(|| least_aligned(&up))
}

/// The front where it is beyond doubt: most of the surface looks one way, and that is neither up nor down.
pub fn clear_front(points: &[Vector], triangles: &[[u32; 3]], up: Vector) -> Option<Vector> {
    let up = up.try_normalize(1e-12)?;
    let mean = mean_normal(points, triangles);
    let level = mean - up * up.dot(&mean);
    (level.norm() > CLEAR && level.norm() > mean.dot(&up).abs()).then(|| level.normalize())
}

/// The length of the mean normal of a half sphere is 0.5, of a plane 1.
const CLEAR: f64 = 0.35;

/// The mean of the normals by area; of length 1 where all are alike, zero on a closed surface.
fn mean_normal(points: &[Vector], triangles: &[[u32; 3]]) -> Vector {
    let mut area = 0.0;
    let mut sum = Vector::zeros();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|point| points[point as usize]);
        let normal = (b - a).cross(&(c - a));
        area += normal.norm();
        sum += normal;
    }
    sum / area.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_that_lies_on_its_back_is_seen_from_above_and_a_face_from_the_front() {
        let plate = [Vector::zeros(), Vector::x(), Vector::y()];
        let face_direction = FaceDirection::lps().facing(&plate, &[[0, 1, 2]]);
        assert!((face_direction.front - Vector::z()).norm() < 1e-12, "{:?}", face_direction.front);
        assert!((face_direction.up - Vector::y()).norm() < 1e-12, "{:?}", face_direction.up);
        let face = [Vector::zeros(), Vector::x(), Vector::z()];
        assert!(
            (FaceDirection::lps().facing(&face, &[[0, 1, 2]]).front + Vector::y()).norm() < 1e-12
        );
    }

    #[test]
    fn the_viewer_in_front_sees_the_left_side_of_the_face_on_his_right() {
        // In LPS the person's left is +x.
        let camera = FaceDirection::lps().camera(0.0, 0.0);
        assert!((camera.right - Vector::x()).norm() < 1e-12);
        assert!((camera.towards + Vector::y()).norm() < 1e-12);
        let camera = FaceDirection::ras().camera(0.0, 0.0);
        assert!((camera.right + Vector::x()).norm() < 1e-12);
        let beside = FaceDirection::lps().camera(90.0, 0.0);
        assert!((beside.towards - Vector::x()).norm() < 1e-12);
    }

    #[test]
    fn a_camera_is_orthonormal_and_right_handed() {
        let odd =
            FaceDirection { front: Vector::new(-3.0, 1.0, 2.0), up: Vector::new(0.1, 0.0, 4.0) };
        let blind = FaceDirection { front: Vector::z(), up: Vector::z() };
        for camera in [odd.camera(40.0, 15.0), blind.camera(-170.0, -20.0)] {
            assert!((camera.right.cross(&camera.up) - camera.towards).norm() < 1e-12);
            assert!((camera.up.norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_front_is_where_the_mean_normal_points() {
        // A tent that looks along -x and a little down.
        let points =
            [Vector::new(0.0, -1.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::new(0.3, 0.0, -2.0)];
        let front = front_of(&points, &[[0, 1, 2]], Vector::z());
        assert!((front + Vector::x()).norm() < 1e-12);
        let closed = front_of(&points, &[[0, 1, 2], [0, 2, 1]], Vector::z());
        assert_eq!(closed.z, 0.0);
        let clear = clear_front(&points, &[[0, 1, 2]], Vector::z()).expect("one plane");
        assert!((clear - front).norm() < 1e-12);
        assert_eq!(clear_front(&points, &[[0, 1, 2], [0, 2, 1]], Vector::z()), None);
        assert_eq!(clear_front(&points, &[[0, 1, 2]], Vector::x()), None, "it looks down");
    }
}
