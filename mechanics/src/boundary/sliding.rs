//! Constrained directions of sliding nodes: the normals of the faces they lie on.
//!
//! The normal of a wall at a node is the mean of those of its faces, weighted by their areas: the direction of the nodal force of a
//! uniform pressure, so that tissue under uniform stress stays so between walls that meet at an edge. Weights by angle would let a curved
//! wall turn about its axis at its ends too, but push tissue along it there. Source: Engelman, Sani, Gresho, The implementation of normal
//! and/or tangential boundary conditions in finite element codes for incompressible fluid flow, 1982.

use std::collections::HashMap;

use crate::mesh::volume::BoundaryFace;
use crate::mesh::{Vector, VolumeMesh};

/// Faces of a node whose normals differ by more than 45 degrees are two walls that meet in an edge:
/// the node is held across both. Smaller differences are one curved wall and are averaged.
pub const SAME_WALL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Directions of which this is the cosine, 5 degrees apart, are one: an edge thinner than that has one wall on its two sides,
/// and sets whose normals differ by less hold a node once.
pub const SAME_DIRECTION: f64 = 0.9962;

/// What walls end at, by node.
pub struct Beside {
    pub on_bone: Vec<bool>,
    /// On the skin that is stated.
    pub on_skin: Vec<bool>,
}

/// For each of the nodes the unit normals of its walls: at most three, none where no face is near.
///
/// The walls are the boundary faces all of whose nodes are listed, and beside these, less than 45 degrees apart, the faces whose
/// other nodes are on bone: so it makes no difference whether a set has the nodes where its wall ends in bone. Faces of the skin and
/// ears (`ears`) of other surfaces are walls of nodes without other ones. A node without such a face takes all boundary faces that touch it.
pub fn wall_normals(
    mesh: &VolumeMesh,
    boundary: &[BoundaryFace],
    nodes: &[u32],
    Beside { on_bone, on_skin }: &Beside,
) -> Vec<(u32, Vec<Vector>)> {
    let mut listed = vec![false; mesh.nodes.len()];
    for &node in nodes {
        listed[node as usize] = true;
    }
    let all = |face: &BoundaryFace, is: &dyn Fn(usize) -> bool| {
        face.nodes().iter().all(|&node| is(node as usize))
    };
    let in_set: Vec<bool> = boundary.iter().map(|face| all(face, &|node| listed[node])).collect();
    let normals: Vec<Vector> = boundary.iter().map(|face| face.area_vector(&mesh.nodes)).collect();
    let is_ear = ears(boundary, &normals, &in_set);
    let mut on_walls: Vec<Vec<Vector>> = vec![Vec::new(); mesh.nodes.len()];
    let [mut doubtful, mut ending, mut touching] = [(); 3].map(|()| on_walls.clone());
    for (number, face) in boundary.iter().enumerate() {
        let normal = normals[number];
        let whole = in_set[number];
        let ends = all(face, &|node| listed[node] || on_bone[node]);
        let is_doubtful = is_ear[number] || all(face, &|node| on_skin[node]);
        for &node in face.nodes().iter().filter(|&&node| listed[node as usize]) {
            touching[node as usize].push(normal);
            if whole && is_doubtful {
                doubtful[node as usize].push(normal);
            } else if whole {
                on_walls[node as usize].push(normal);
            } else if ends {
                ending[node as usize].push(normal);
            }
        }
    }
    nodes
        .iter()
        .map(|&node| {
            let others = &on_walls[node as usize];
            let walls = if others.is_empty() { &doubtful[node as usize] } else { others };
            let is_of_wall =
                |face: &&Vector| walls.iter().any(|wall| cosine(wall, face) > SAME_WALL);
            let ends = ending[node as usize].iter().filter(is_of_wall);
            let own: Vec<Vector> = walls.iter().chain(ends).copied().collect();
            let faces = if walls.is_empty() { &touching[node as usize] } else { &own };
            (node, group_by_wall(faces))
        })
        .collect()
}

/// Which faces of walls are ears of another surface, as triangles of the top in the corner between two sides: over an edge that surface
/// goes on beside the walls, over none in them, and over an edge lies another wall.
fn ears(boundary: &[BoundaryFace], normals: &[Vector], in_set: &[bool]) -> Vec<bool> {
    let edges = |face: &BoundaryFace| {
        let nodes = face.nodes().to_vec();
        let next = nodes.clone().into_iter().cycle().skip(1);
        nodes.into_iter().zip(next).map(|(from, to)| [from.min(to), from.max(to)])
    };
    let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    for (number, face) in boundary.iter().enumerate().filter(|(number, _)| in_set[*number]) {
        edges(face).for_each(|edge| at_edge.entry(edge).or_default().push(number));
    }
    for (number, face) in boundary.iter().enumerate().filter(|(number, _)| !in_set[*number]) {
        for edge in edges(face) {
            at_edge.entry(edge).and_modify(|faces| faces.push(number));
        }
    }
    let is_ear = |(number, face): (usize, &BoundaryFace)| {
        if !in_set[number] {
            return false;
        }
        let beside = edges(face).filter_map(|edge| at_edge.get(&edge)).flatten().copied();
        let beside: Vec<usize> = beside.filter(|&other| other != number).collect();
        let goes_on = |&other: &usize| cosine(&normals[number], &normals[other]) > SAME_WALL;
        let (on, across): (Vec<usize>, Vec<usize>) = beside.into_iter().partition(goes_on);
        !on.is_empty()
            && !on.iter().any(|&other| in_set[other])
            && across.iter().any(|&other| in_set[other])
    };
    boundary.iter().enumerate().map(is_ear).collect()
}

/// Sums area vectors wall by wall and scales the sums to length 1.
fn group_by_wall(faces: &[Vector]) -> Vec<Vector> {
    let mut walls: Vec<Vector> = Vec::new();
    for face in faces.iter().filter(|face| face.norm() > 0.0) {
        match walls.iter_mut().find(|wall| is_same_wall(cosine(wall, face))) {
            Some(wall) => *wall += face * cosine(wall, face).signum(),
            None => walls.push(*face),
        }
    }
    walls.truncate(3);
    walls.iter().map(|wall| wall.normalize()).collect()
}

/// Whether two area vectors that point out of the tissue are of one wall, from their cosine.
fn is_same_wall(cosine: f64) -> bool {
    !(-SAME_DIRECTION..=SAME_WALL).contains(&cosine)
}

/// Of the angle between two area vectors.
fn cosine(one: &Vector, other: &Vector) -> f64 {
    one.dot(other) / (one.norm() * other.norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::CellShape;
    use crate::mesh::sample::block;

    #[test]
    fn the_two_sides_of_an_edge_are_two_walls_unless_it_is_thinner_than_five_degrees() {
        let sides = |slope: f64| [Vector::new(slope, 0.0, 1.0), Vector::new(slope, 0.0, -1.0)];
        // Edges of 40, 20, 10 and 4 degrees.
        for (degrees, expected) in [(40.0_f64, 2), (20.0, 2), (10.0, 2), (4.0, 1)] {
            let walls = group_by_wall(&sides((degrees / 2.0).to_radians().tan()));
            assert_eq!(walls.len(), expected, "{degrees} degrees: {walls:?}");
        }
        let one = group_by_wall(&sides(0.01));
        assert!((one[0] - Vector::z()).norm() < 1e-15, "{}", one[0]);
    }

    /// A curved floor that ends in bone at x = 0.
    #[test]
    fn a_wall_that_ends_in_bone_has_the_same_normals_with_and_without_the_nodes_on_bone() {
        let mut mesh = block(Vector::new(3.0, 1.0, 1.0), [3, 1, 1], CellShape::Hex8);
        mesh.nodes.iter_mut().for_each(|node| node.z -= 0.1 * node.x * node.x);
        let floor = mesh.node_sets["z_min"].clone();
        let is_on_bone: Vec<bool> = mesh.nodes.iter().map(|node| node.x < 0.5).collect();
        let (beside, _): (Vec<u32>, Vec<u32>) =
            floor.iter().partition(|&&node| !is_on_bone[node as usize]);
        let boundary = mesh.boundary_faces();
        let nowhere = vec![false; mesh.nodes.len()];
        let normals = |nodes: &[u32], on_bone: &[bool]| -> Vec<(u32, Vec<Vector>)> {
            let beside = Beside { on_bone: on_bone.to_vec(), on_skin: nowhere.clone() };
            let found = wall_normals(&mesh, &boundary, nodes, &beside).into_iter();
            found.filter(|(node, _)| !is_on_bone[*node as usize]).collect()
        };
        let whole = normals(&floor, &nowhere);
        assert_eq!(normals(&beside, &is_on_bone), whole);
        assert_ne!(normals(&beside, &nowhere), whole);
    }

    /// In corners of a block of tetrahedra triangles of its top have all their nodes on its sides; of a strip one cell wide all have.
    #[test]
    fn ears_between_two_walls_are_no_wall_nor_is_skin_unless_it_is_one_alone() {
        let block = |across: usize| {
            block(Vector::new(4.0, across as f64, 2.0), [4, across, 2], CellShape::Tet4)
        };
        let set = |mesh: &VolumeMesh, name: &str| mesh.node_sets[name].clone();
        let beside = |mesh: &VolumeMesh, [skin, bone]: [&[u32]; 2]| {
            let [on_skin, on_bone] = [skin, bone].map(|nodes| {
                let mut is_there = vec![false; mesh.nodes.len()];
                nodes.iter().for_each(|&node| is_there[node as usize] = true);
                is_there
            });
            Beside { on_bone, on_skin }
        };
        let upright = |mesh: &VolumeMesh, nodes: [&[u32]; 2]| {
            let mut sides =
                ["x_min", "x_max", "y_min", "y_max"].map(|name| set(mesh, name)).concat();
            sides.sort_unstable();
            sides.dedup();
            let found = wall_normals(mesh, &mesh.boundary_faces(), &sides, &beside(mesh, nodes));
            assert!(found.iter().all(|(_, walls)| !walls.is_empty()));
            found.iter().flat_map(|(_, walls)| walls).filter(|wall| wall.z > 0.9).count()
        };
        let (wide, strip) = (block(4), block(1));
        let is_inner = |node: &u32| {
            let x = wide.nodes[*node as usize];
            (0.5..3.5).contains(&x.x) && (0.5..3.5).contains(&x.y)
        };
        let inner: Vec<u32> = set(&wide, "z_max").into_iter().filter(is_inner).collect();
        assert_eq!(upright(&wide, [&[], &[]]), 0);
        assert_eq!(upright(&wide, [&[], &inner]), 0);
        assert!(upright(&strip, [&[], &[]]) > 0);
        assert_eq!(upright(&strip, [&set(&strip, "z_max"), &[]]), 0);
        let (top, all): (Vec<u32>, Vec<u32>) =
            (set(&wide, "z_max"), (0..wide.nodes.len() as u32).collect());
        let top = wall_normals(&wide, &wide.boundary_faces(), &top, &beside(&wide, [&all, &[]]));
        assert!(top.iter().all(|(_, walls)| walls[..] == [Vector::z()]));
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
