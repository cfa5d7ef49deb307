//! Structures that must not be sawn: nerves and roots of teeth, as lines with a radius or as surfaces.

use crate::mesh::Vector;

/// A structure that cuts have to keep clear of.
#[derive(Clone, Debug, PartialEq)]
pub struct Risk {
    pub name: String,
    /// In mm: of a line in their order, two or more, or the corners of a surface.
    pub points: Vec<Vector>,
    /// Of a surface: three of the points each. Empty: a line.
    pub triangles: Vec<[u32; 3]>,
    /// Around the line or the surface, in mm.
    pub radius: f64,
    /// Cuts nearer than this are warned of, in mm.
    pub clearance: f64,
}

impl Risk {
    /// The straight pieces of a line, or the sides of a surface's triangles, each once.
    pub fn edges(&self) -> Vec<[Vector; 2]> {
        if self.triangles.is_empty() {
            return self.points.windows(2).map(|ends| [ends[0], ends[1]]).collect();
        }
        let sides = self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let mut sides: Vec<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        sides.sort_unstable();
        sides.dedup();
        sides.into_iter().map(|side| side.map(|point| self.points[point as usize])).collect()
    }
}
