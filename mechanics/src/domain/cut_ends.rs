//! Flat ends of a skin where the scan ended: planar parts of the surface on the faces of its box.

use super::triangle_tree::Facet;
use crate::mesh::Vector;

/// How far from the face of the box a corner may be, of the box's diagonal: ends of smoothed surfaces are not quite flat.
const THICKNESS: f64 = 3e-3;
/// The cosine of the angle to the face's normal that a triangle may have.
const LEAST_COSINE: f64 = 0.9;
/// The part of a face of the box that a flat end covers at least; a nose that touches the face covers less.
const LEAST_COVER: f64 = 0.2;

/// Where a scan ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CutEnds {
    /// The numbers of the triangles on flat ends, ascending.
    pub triangles: Vec<u32>,
    /// For each axis whether its lowest and its highest face of the box is one.
    pub faces: [[bool; 2]; 3],
}

/// The flat ends of a surface in its box.
pub(super) fn cut_ends(facets: &[Facet], (low, high): (Vector, Vector)) -> CutEnds {
    let mut ends = CutEnds::default();
    for axis in 0..3 {
        for (end, place) in [low, high].into_iter().enumerate() {
            let face =
                Face { axis, place: place[axis], outward: if end == 0 { -1.0 } else { 1.0 } };
            let on = face.triangles(facets, (high - low).norm() * THICKNESS);
            let area: f64 = on.iter().map(|facet| facet.corners.area_vector().norm()).sum();
            let size = high - low;
            if area >= LEAST_COVER * size[(axis + 1) % 3] * size[(axis + 2) % 3] {
                ends.faces[axis][end] = true;
                ends.triangles.extend(on.iter().map(|facet| facet.number));
            }
        }
    }
    ends.triangles.sort_unstable();
    ends
}

/// A face of the box.
struct Face {
    axis: usize,
    place: f64,
    outward: f64,
}

impl Face {
    /// Those on the face that look outward.
    fn triangles<'a>(&self, facets: &'a [Facet], thickness: f64) -> Vec<&'a Facet> {
        let is_near = |corner: &Vector| (corner[self.axis] - self.place).abs() <= thickness;
        let lies_on = |facet: &&Facet| {
            let area_vector = facet.corners.area_vector();
            let cosine = self.outward * area_vector[self.axis] / area_vector.norm();
            facet.corners.0.iter().all(is_near) && cosine >= LEAST_COSINE
        };
        facets.iter().filter(lies_on).collect()
    }
}
