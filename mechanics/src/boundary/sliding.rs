//! Constrained directions of sliding nodes: the normals of the faces they lie on.

use crate::mesh::volume::BoundaryFace;
use crate::mesh::{Vector, VolumeMesh};

/// Faces of a node whose normals differ by more than 45 degrees are two walls that meet in an edge:
/// the node is held across both. Smaller differences are one curved wall and are averaged.
pub const SAME_WALL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// For each of the nodes the unit normals of its walls: at most three, none where no face is near.
///
/// The walls are the boundary faces all of whose nodes are listed; a node without such a face takes
/// all boundary faces that touch it.
pub fn wall_normals(
    mesh: &VolumeMesh,
    boundary: &[BoundaryFace],
    nodes: &[u32],
) -> Vec<(u32, Vec<Vector>)> {
    let mut listed = vec![false; mesh.nodes.len()];
    for &node in nodes {
        listed[node as usize] = true;
    }
    let mut on_walls: Vec<Vec<Vector>> = vec![Vec::new(); mesh.nodes.len()];
    let mut touching = on_walls.clone();
    for face in boundary {
        let normal = area_vector(mesh, face);
        let whole = face.nodes().iter().all(|&node| listed[node as usize]);
        for &node in face.nodes().iter().filter(|&&node| listed[node as usize]) {
            touching[node as usize].push(normal);
            if whole {
                on_walls[node as usize].push(normal);
            }
        }
    }
    nodes
        .iter()
        .map(|&node| {
            let walls = &on_walls[node as usize];
            let faces = if walls.is_empty() { &touching[node as usize] } else { walls };
            (node, group_by_wall(faces))
        })
        .collect()
}

/// Half the cross product of the diagonals of a quadrilateral or of two edges of a triangle.
pub fn area_vector(mesh: &VolumeMesh, face: &BoundaryFace) -> Vector {
    let corner = |local: usize| mesh.nodes[face.nodes()[local] as usize];
    match face.nodes().len() {
        3 => (corner(1) - corner(0)).cross(&(corner(2) - corner(0))) * 0.5,
        _ => (corner(2) - corner(0)).cross(&(corner(3) - corner(1))) * 0.5,
    }
}

/// Sums area vectors wall by wall and scales the sums to length 1.
fn group_by_wall(faces: &[Vector]) -> Vec<Vector> {
    let mut walls: Vec<Vector> = Vec::new();
    for face in faces.iter().filter(|face| face.norm() > 0.0) {
        let cosine = |wall: &Vector| wall.dot(face) / (wall.norm() * face.norm());
        match walls.iter_mut().find(|wall| cosine(wall).abs() > SAME_WALL) {
            Some(wall) => *wall += face * cosine(wall).signum(),
            None => walls.push(*face),
        }
    }
    walls.truncate(3);
    walls.iter().map(|wall| wall.normalize()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_sides_of_a_thin_edge_are_one_wall() {
        let above = Vector::new(0.1, 0.0, 1.0);
        let below = Vector::new(0.1, 0.0, -1.0);
        let walls = group_by_wall(&[above, below]);
        assert_eq!(walls.len(), 1);
        assert!((walls[0] - Vector::z()).norm() < 1e-15, "{}", walls[0]);
    }

    #[test]
    fn gently_curved_faces_are_one_wall_and_a_corner_is_three() {
        let tilted = |degrees: f64| {
            let angle = degrees.to_radians();
            Vector::new(angle.sin(), 0.0, angle.cos())
        };
        assert_eq!(group_by_wall(&[tilted(-20.0), tilted(0.0), tilted(20.0)]).len(), 1);
        assert_eq!(group_by_wall(&[Vector::x(), Vector::y(), Vector::z(), Vector::x()]).len(), 3);
    }
}
