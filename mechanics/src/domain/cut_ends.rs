//! Flat ends of a skin where the scan ended: planar parts of the surface on the faces of its box.
//!
//! A spike or an island beyond an end takes the face of the box with it. Where a face has no flat end, the outermost plane
//! that has one is looked for, with next to nothing beyond it.

use super::triangle_tree::Facet;
use crate::mesh::Vector;

/// How far from the face of the box a corner may be, of the box's diagonal: ends of smoothed surfaces are not quite flat.
const THICKNESS: f64 = 3e-3;
/// The cosine of the angle to the face's normal that a triangle may have.
const LEAST_COSINE: f64 = 0.9;
/// The part of a face of the box that a flat end covers at least; a nose that touches the face covers less.
const LEAST_COVER: f64 = 0.2;
/// The surface beyond an end that lies within the box covers less of the face.
const MOST_BEYOND: f64 = 0.05;
/// How deep in the box an end may lie, of its diagonal.
const DEEPEST: f64 = 0.05;

/// How often an end is looked for about the middle of what was found.
const CENTRINGS: usize = 5;

/// Where a scan ended.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CutEnds {
    /// The numbers of the triangles on flat ends, ascending.
    pub triangles: Vec<u32>,
    /// For each axis whether the surface has a flat end at its low and at its high face.
    pub faces: [[bool; 2]; 3],
    /// The box, with the places of flat ends in the place of its faces.
    pub bounds: (Vector, Vector),
}

/// The flat ends of a surface in its box, of which so much is left as its level says, 1 for a whole one.
pub(super) fn cut_ends(facets: &[Facet], bounds: (Vector, Vector), level: f64) -> CutEnds {
    let (low, high) = bounds;
    let mut ends = CutEnds { triangles: Vec::new(), faces: [[false; 2]; 3], bounds };
    let thickness = (high - low).norm() * THICKNESS;
    for axis in 0..3 {
        for (end, place) in [low, high].into_iter().enumerate() {
            let size = high - low;
            let face = Face {
                axis,
                place: place[axis],
                outward: if end == 0 { -1.0 } else { 1.0 },
                thickness,
                area: level.min(1.0) * size[(axis + 1) % 3] * size[(axis + 2) % 3],
            };
            let Some(face) = face.with_end(facets) else { continue };
            ends.faces[axis][end] = true;
            ends.triangles.extend(face.triangles(facets).map(|facet| facet.number));
            let to = if end == 0 { &mut ends.bounds.0 } else { &mut ends.bounds.1 };
            to[axis] = face.place;
        }
    }
    ends.triangles.sort_unstable();
    ends.triangles.dedup();
    ends
}

/// A face of the box, or a plane beside it.
#[derive(Clone, Copy)]
struct Face {
    axis: usize,
    place: f64,
    outward: f64,
    /// How far from it corners may be.
    thickness: f64,
    /// Of the face of the box, as much of it as is left of the surface.
    area: f64,
}

impl Face {
    /// This face if the surface has a flat end on it, else the outermost plane that has one.
    fn with_end(self, facets: &[Facet]) -> Option<Face> {
        if self.has_end(facets) {
            return Some(self);
        }
        let outer = |facet: &Facet| {
            let heights = facet.corners.0.map(|corner| self.height(&corner));
            heights.into_iter().fold(f64::NEG_INFINITY, f64::max)
        };
        let looks_out = facets.iter().filter(|facet| self.looks_out(facet));
        let mut flat: Vec<(f64, f64)> =
            looks_out.map(|facet| (outer(facet), facet.corners.area_vector().norm())).collect();
        flat.sort_by(|a, b| b.0.total_cmp(&a.0));
        let deepest = -DEEPEST / THICKNESS * self.thickness;
        // The plane within whose thickness most lies, from outside inwards.
        let mut last = 0;
        let mut sum = 0.0;
        for first in 0..flat.len() {
            while last < flat.len() && flat[last].0 >= flat[first].0 - self.thickness {
                sum += flat[last].1;
                last += 1;
            }
            let there = Face { place: self.place + self.outward * flat[first].0, ..self };
            if flat[first].0 < deepest {
                return None;
            }
            if sum >= LEAST_COVER * self.area && there.has_end(facets) {
                let there = there.centred(facets);
                return (there.beyond(facets) <= MOST_BEYOND * self.area).then_some(there);
            }
            sum -= flat[first].1;
        }
        None
    }

    /// In the middle of what looks outwards within reach.
    fn centred(self, facets: &[Facet]) -> Face {
        let mut face = self;
        for _ in 0..CENTRINGS {
            let (mut area, mut moment) = (0.0, 0.0);
            for facet in face.triangles(facets) {
                let own = facet.corners.area_vector().norm();
                area += own;
                moment += own * facet.corners.middle()[face.axis];
            }
            face.place = moment / area;
        }
        face
    }

    fn has_end(&self, facets: &[Facet]) -> bool {
        let area: f64 =
            self.triangles(facets).map(|facet| facet.corners.area_vector().norm()).sum();
        area >= LEAST_COVER * self.area
    }

    /// Outwards from the face, in mm.
    fn height(&self, place: &Vector) -> f64 {
        self.outward * (place[self.axis] - self.place)
    }

    fn looks_out(&self, facet: &Facet) -> bool {
        let area_vector = facet.corners.area_vector();
        self.outward * area_vector[self.axis] >= LEAST_COSINE * area_vector.norm()
    }

    /// The area of what lies beyond the face.
    fn beyond(&self, facets: &[Facet]) -> f64 {
        let is_beyond = |corner: &Vector| self.height(corner) > self.thickness;
        let beyond = facets.iter().filter(|facet| facet.corners.0.iter().all(is_beyond));
        beyond.map(|facet| facet.corners.area_vector().norm()).sum()
    }

    /// Those on the face that look outward.
    fn triangles<'a>(&self, facets: &'a [Facet]) -> impl Iterator<Item = &'a Facet> {
        let face = *self;
        let is_near = move |corner: &Vector| face.height(corner).abs() <= face.thickness;
        let lies_on =
            move |facet: &&Facet| facet.corners.0.iter().all(is_near) && face.looks_out(facet);
        facets.iter().filter(lies_on)
    }
}
