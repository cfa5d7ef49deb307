//! The mid-plane of a face: where the front of the skin is most like its mirror image.

use std::collections::BTreeMap;

use crate::mesh::{Frame, TriangleSurface, Vector};

/// Side of the cells in which the front of the skin is held against its mirror image, in mm.
const CELL: f64 = 3.0;
/// What lies farther behind the foremost point is no longer front, in mm.
const FRONT: f64 = 60.0;
/// Fewer pairs of cells than this share of them all compare too little of a face.
const LEAST_SHARE: f64 = 0.5;

/// Which way a face looks; directions of length 1, at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceAxes {
    pub anterior: Vector,
    pub up: Vector,
}

/// The plane that a face is symmetric to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MidPlane {
    pub axes: FaceAxes,
    /// How far the plane is from the origin along [`FaceAxes::lateral`], in mm.
    pub offset: f64,
}

impl FaceAxes {
    /// The axes of an upright head; `None` where the frame does not say how it stands.
    pub fn of(frame: Frame) -> Option<FaceAxes> {
        match frame {
            Frame::Lps => Some(FaceAxes { anterior: -Vector::y(), up: Vector::z() }),
            Frame::Ras => Some(FaceAxes { anterior: Vector::y(), up: Vector::z() }),
            Frame::Unspecified => None,
        }
    }

    pub fn lateral(&self) -> Vector {
        self.anterior.cross(&self.up)
    }
}

impl MidPlane {
    /// Lateral distance from the plane, height, and how far in front, in mm.
    pub fn coordinates(&self, point: &Vector) -> [f64; 3] {
        let lateral = point.dot(&self.axes.lateral()) - self.offset;
        [lateral, point.dot(&self.axes.up), point.dot(&self.axes.anterior)]
    }

    /// The plane, in steps of 1 mm and to 1.5 mm, across which the front of the skin differs least from its mirror image;
    /// `None` for a surface without a front.
    pub fn of(skin: &TriangleSurface, axes: FaceAxes) -> Option<MidPlane> {
        let origin = MidPlane { axes, offset: 0.0 };
        let front = Front::new(skin, &origin)?;
        let steps = (front.high - front.low).ceil() as usize;
        let offsets = (0..=steps).map(|step| front.low + step as f64);
        let judged = offsets.filter_map(|offset| Some((front.asymmetry(offset)?, offset)));
        let (_, offset) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(MidPlane { axes, offset })
    }
}

/// How far in front the skin is at cells of its view from the front.
struct Front {
    cells: BTreeMap<[i64; 2], f64>,
    low: f64,
    high: f64,
}

impl Front {
    fn new(skin: &TriangleSurface, origin: &MidPlane) -> Option<Front> {
        let places: Vec<[f64; 3]> = (0..skin.triangles.len())
            .flat_map(|triangle| {
                let [a, b, c] = skin.corners(triangle);
                [a, b, c, (a + b + c) / 3.0]
            })
            .map(|point| origin.coordinates(&point))
            .collect();
        let foremost = places.iter().map(|place| place[2]).reduce(f64::max)?;
        let mut front =
            Front { cells: BTreeMap::new(), low: f64::INFINITY, high: f64::NEG_INFINITY };
        for [lateral, height, advance] in places {
            if advance > foremost - FRONT {
                let cell = [lateral, height].map(|x| (x / CELL).floor() as i64);
                let deepest = front.cells.entry(cell).or_insert(advance);
                *deepest = deepest.max(advance);
                (front.low, front.high) = (front.low.min(lateral), front.high.max(lateral));
            }
        }
        Some(front)
    }

    /// The mean difference of cells and their mirror images in mm; `None` where too few have one.
    fn asymmetry(&self, offset: f64) -> Option<f64> {
        let (mut sum, mut pairs) = (0.0, 0);
        for ([lateral, height], advance) in &self.cells {
            let middle = (*lateral as f64 + 0.5) * CELL;
            let mirrored = ((2.0 * offset - middle) / CELL).floor() as i64;
            if let Some(other) = self.cells.get(&[mirrored, *height]) {
                sum += (advance - other).abs();
                pairs += 1;
            }
        }
        let enough = pairs as f64 >= LEAST_SHARE * self.cells.len() as f64 && pairs > 0;
        enough.then(|| sum / f64::from(pairs))
    }
}
