//! Segments of closed surfaces of bone: clipped by their cuts, and in one piece with their seeds.

use super::clip::{ClipError, split, welded};
use super::cut::Side;
use super::rule::Osteotomy;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::{SearchError, SurfaceSearch, TriangleSurface, Vector};

/// Why a surface has no such segment.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SegmentError {
    #[error("cut `{cut}`: {error}")]
    Clip { cut: String, error: ClipError },
    #[error("{error}")]
    Surface { error: ClipError },
    #[error("cut `{cut}` has an extent; surfaces are cut by whole planes")]
    Bounded { cut: String },
    #[error("no bone lies on the sides of segment `{segment}`")]
    NoBone { segment: String },
    #[error("what lies on the sides of segment `{segment}` cannot be searched: {error}")]
    Search { segment: String, error: SearchError },
}

/// A segment of a surface of bone.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceSegment {
    pub surface: TriangleSurface,
    pub volume_mm3: f64,
    /// Solid pieces on the sides of the segment, itself among them.
    pub pieces: usize,
}

/// The piece of a closed surface of bone on the sides of a segment: the one nearest to its seeds, the largest where it
/// has none. Cavities within it belong to it.
pub fn surface_segment(
    bone: &TriangleSurface,
    osteotomy: &Osteotomy,
    segment: usize,
) -> Result<SurfaceSegment, SegmentError> {
    let rule = &osteotomy.segments()[segment];
    let mut part = welded(bone).map_err(|error| SegmentError::Surface { error })?;
    for side in &rule.sides {
        let cut = &osteotomy.cuts()[side.cut];
        let name = || cut.name.clone();
        if cut.is_bounded() {
            return Err(SegmentError::Bounded { cut: name() });
        }
        let half_kerf = match side.side {
            Side::Below => -cut.kerf() / 2.0,
            Side::Above => cut.kerf() / 2.0,
        };
        let halves = split(&part, &cut.plane().raised(half_kerf))
            .map_err(|error| SegmentError::Clip { cut: name(), error })?;
        part = match side.side {
            Side::Below => halves.below,
            Side::Above => halves.above,
        };
    }
    let shells = Shells::new(&part);
    let chosen = shells.chosen(&part, &rule.seeds, &rule.name)?;
    let pieces = shells.volumes.iter().filter(|volume| **volume > 0.0).count();
    let surface = shells.with_cavities(&part, &chosen);
    Ok(SurfaceSegment { volume_mm3: surface.signed_volume(), surface, pieces })
}

/// The shells of a surface: triangles that hang together at corners.
struct Shells {
    /// For each triangle its shell.
    of: Vec<usize>,
    /// Negative for a cavity, in mm³.
    volumes: Vec<f64>,
}

impl Shells {
    fn new(surface: &TriangleSurface) -> Shells {
        let mut sets = DisjointSets::new(surface.points.len());
        for &[a, b, c] in &surface.triangles {
            sets.join(a, b);
            sets.join(b, c);
        }
        let mut number_of = vec![usize::MAX; surface.points.len()];
        let (mut of, mut volumes) = (Vec::new(), Vec::new());
        for (triangle, &[a, ..]) in surface.triangles.iter().enumerate() {
            let number = &mut number_of[sets.root(a) as usize];
            if *number == usize::MAX {
                *number = volumes.len();
                volumes.push(0.0);
            }
            volumes[*number] += surface.tetrahedron_on(triangle).1 / 6.0;
            of.push(*number);
        }
        Shells { of, volumes }
    }

    /// The solid shells that are meant, ascending.
    fn chosen(
        &self,
        surface: &TriangleSurface,
        seeds: &[Vector],
        name: &str,
    ) -> Result<Vec<usize>, SegmentError> {
        let segment = || name.to_owned();
        let solid = |shell: &usize| self.volumes[*shell] > 0.0;
        let largest = (0..self.volumes.len())
            .filter(solid)
            .max_by(|&a, &b| self.volumes[a].total_cmp(&self.volumes[b]));
        let largest = largest.ok_or_else(|| SegmentError::NoBone { segment: segment() })?;
        if seeds.is_empty() {
            return Ok(vec![largest]);
        }
        let search = SurfaceSearch::new(surface)
            .map_err(|error| SegmentError::Search { segment: segment(), error })?;
        let nearest = |seed: &Vector| {
            let solid = |triangle: usize| solid(&self.of[triangle]);
            search.closest_where(seed, solid).map_or(largest, |found| self.of[found.triangle])
        };
        let mut chosen: Vec<usize> = seeds.iter().map(nearest).collect();
        chosen.sort_unstable();
        chosen.dedup();
        Ok(chosen)
    }

    /// The chosen shells, and the cavities that lie within them.
    fn with_cavities(&self, surface: &TriangleSurface, chosen: &[usize]) -> TriangleSurface {
        let solid = self.triangles(surface, |shell| chosen.contains(&shell));
        let is_within = |shell: usize| {
            let first = self.of.iter().position(|other| *other == shell);
            first.is_some_and(|triangle| {
                surface.winding_number(solid.iter().copied(), &surface.corners(triangle)[0]) > 0.5
            })
        };
        let cavities: Vec<bool> = (0..self.volumes.len())
            .map(|shell| self.volumes[shell] < 0.0 && is_within(shell))
            .collect();
        let kept = self.triangles(surface, |shell| chosen.contains(&shell) || cavities[shell]);
        let mut number_of = vec![u32::MAX; surface.points.len()];
        let mut part = TriangleSurface::default();
        for triangle in kept {
            let corners = surface.triangles[triangle].map(|corner| {
                let number = &mut number_of[corner as usize];
                if *number == u32::MAX {
                    *number = part.points.len() as u32;
                    part.points.push(surface.points[corner as usize]);
                }
                *number
            });
            part.triangles.push(corners);
        }
        part
    }

    fn triangles(&self, surface: &TriangleSurface, counts: impl Fn(usize) -> bool) -> Vec<usize> {
        (0..surface.triangles.len()).filter(|&triangle| counts(self.of[triangle])).collect()
    }
}
