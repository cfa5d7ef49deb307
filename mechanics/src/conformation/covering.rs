//! What covers the skin of a scan: sheets of dressings, straps and tubes, behind which there are air and then skin.

use rayon::prelude::*;

use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};

/// Skin lies so far behind what covers it, in mm: nearer is noise or a second sheet, farther is another part of the body.
const BEHIND_MM: [f64; 2] = [1.0, 100.0];

/// Connected triangles of less area cover nothing that a template would be pulled to: folds of ears and nostrils have such.
const LEAST_MM2: f64 = 25.0;

/// What covers more than this share of a surface is none: that surface is not skin that faces out.
const MOST: f64 = 0.5;

/// Triangles that cover other ones, which no template is fitted to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Covering {
    pub area_mm2: f64,
    /// The mean of their middles by area, in mm.
    pub middle: Vector,
}

/// A surface, prepared for its search, without the triangles whose back faces the front of another one across air, and what these
/// are; nothing where there are none.
pub(super) fn uncovered(
    search: &SurfaceSearch,
    surface: &TriangleSurface,
) -> Option<(TriangleSurface, Covering)> {
    let covers = |triangle: usize| {
        let Some(normal) = surface.area_vector(triangle).try_normalize(f64::MIN_POSITIVE) else {
            return false;
        };
        let behind = search.first_hit(&surface.middle(triangle), &-normal, triangle, BEHIND_MM[1]);
        behind.is_some_and(|(other, distance)| {
            distance > BEHIND_MM[0] && surface.area_vector(other).dot(&normal) > 0.0
        })
    };
    let triangles = 0..surface.triangles.len();
    let is_covering: Vec<bool> = triangles.into_par_iter().with_min_len(64).map(covers).collect();
    let is_covering = in_large_pieces(surface, &is_covering);
    let mut covering = Covering::default();
    for triangle in (0..is_covering.len()).filter(|&triangle| is_covering[triangle]) {
        let area = surface.area_vector(triangle).norm();
        covering.area_mm2 += area;
        covering.middle += surface.middle(triangle) * area;
    }
    if covering.area_mm2 == 0.0 || covering.area_mm2 > MOST * surface.area() {
        return None;
    }
    covering.middle /= covering.area_mm2;
    let others = surface.triangles.iter().zip(&is_covering).filter(|(_, covers)| !**covers);
    let triangles = others.map(|(triangle, _)| *triangle).collect();
    Some((TriangleSurface { triangles, ..surface.clone() }, covering))
}

/// Which of some triangles lie in pieces of at least [`LEAST_MM2`], connected by their points.
fn in_large_pieces(surface: &TriangleSurface, chosen: &[bool]) -> Vec<bool> {
    let mut pieces = DisjointSets::new(surface.points.len());
    let own = || (0..chosen.len()).filter(|&triangle| chosen[triangle]);
    for triangle in own() {
        let [a, b, c] = surface.triangles[triangle];
        pieces.join(a, b);
        pieces.join(b, c);
    }
    let mut piece = |triangle: usize| pieces.root(surface.triangles[triangle][0]) as usize;
    let mut areas = vec![0.0; surface.points.len()];
    own().for_each(|triangle| areas[piece(triangle)] += surface.area_vector(triangle).norm());
    let mut large = vec![false; chosen.len()];
    own().for_each(|triangle| large[triangle] = areas[piece(triangle)] >= LEAST_MM2);
    large
}
