//! Checks of a finished mesh, made before it is handed out.

use rayon::prelude::*;
use robust::{Coord3D, orient3d};

use super::draft::Draft;
use super::error::MeshingError;
use super::pieces::pieces;
use super::rims::{RimFace, boundary_faces, odd_edges, open_faces, unmatched_print};
use crate::mesh::Vector;

/// Fails where a cell is flat or turned over, a place is not finite, a face has other than one partner or bounds the mesh
/// away from the boundary of the body, an edge of the boundary lies between other than two triangles, or, if the mesh is to
/// be one piece, it is several. Returns the triangles of the boundary.
pub(super) fn check(draft: &Draft, one_piece: bool) -> Result<Vec<RimFace>, MeshingError> {
    let place = |node: u32| draft.nodes[node as usize];
    let not_finite = |at: &&Vector| !at.iter().all(|x| x.is_finite());
    if let Some(&at) = draft.nodes.iter().find(not_finite) {
        return Err(MeshingError::NotFinite { what: "node", at });
    }
    let flat: Vec<u32> = (0..draft.tetrahedra.len() as u32)
        .into_par_iter()
        .filter(|&tet| !is_positive(draft, &draft.tetrahedra[tet as usize]))
        .collect();
    let first = flat.first().map(|&tet| place(draft.tetrahedra[tet as usize][0]));
    broken("cells without volume or turned over", flat.len(), first)?;
    let faces = boundary_faces(draft);
    if unmatched_print(draft, &faces) != 0 {
        let open = open_faces(draft);
        let first = open.first().map_or(Vector::zeros(), |face| place(face[0]));
        broken("faces within the tissue without a partner", open.len().max(1), Some(first))?;
    }
    let odd = odd_edges(&faces);
    let first = odd.first().map(|edge| place(edge.nodes[0]));
    broken("edges of the boundary with other than two triangles", odd.len(), first)?;
    if one_piece {
        let (pieces, _) = pieces(draft);
        let others = pieces.get(1..).unwrap_or_default();
        broken("pieces apart from the largest", others.len(), others.first().map(|p| p.centre))?;
    }
    Ok(faces)
}

/// An error if there are any.
fn broken(what: &'static str, count: usize, first: Option<Vector>) -> Result<(), MeshingError> {
    first.map_or(Ok(()), |at| Err(MeshingError::Broken { what, count, at }))
}

/// The sign of the volume, exactly.
fn is_positive(draft: &Draft, tet: &[u32; 4]) -> bool {
    let [a, b, c, d] = draft.corners(tet).map(|at| Coord3D { x: at.x, y: at.y, z: at.z });
    // Positive where the first three are seen counter-clockwise from the side away from the fourth.
    orient3d(a, c, b, d) > 0.0
}
