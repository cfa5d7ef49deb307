//! The octant of a thick sphere whose inner wall moves outwards (docs/verification.md#v7), with its closed form.
//!
//! u = (A r + B / r^2) e_r        3 K A - 4 mu B / b^3 = 0 at the free wall r = b        A a + B / a^2 = d at r = a
//!
//! K, mu: bulk and shear modulus; a = 60, b = 72, d = 2 mm. From sigma_rr = 3 K A - 4 mu B / r^3, Timoshenko, Goodier,
//! Theory of Elasticity, 3rd ed., section 136. Holds for one linear elastic material.

use std::sync::Arc;

use super::materials;
use crate::boundary::NodeSelection;
use crate::mesh::sample::{ThickSphere, thick_sphere_octant};
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::prediction::{Case, Plan, Prescribed, Sliding, SlidingNormal};
use crate::study::variant::{ClosedForm, Materials, StudyScene, Truth};

/// a, b and d in mm.
const INNER: f64 = 60.0;
const OUTER: f64 = 72.0;
const MOVED: f64 = 2.0;

/// Arrays of the mesh: the movement of the inner wall, and for each node its radius in the first component. Means
/// of vectors are taken of both where edges are halved.
const MOVEMENT: &str = "radial_mm";
const RADIUS: &str = "radius_mm";

/// With cells of 6 mm: 1536 hexahedra cut into six tetrahedra each.
pub fn sphere() -> StudyScene {
    sphere_of(2, 8, CellShape::Tet4)
}

/// With that many cells between the walls, and along half a quarter of a circle.
pub fn sphere_of(cells_radial: usize, cells_along: usize, shape: CellShape) -> StudyScene {
    let sphere =
        ThickSphere { inner_radius: INNER, outer_radius: OUTER, cells_radial, cells_along };
    let mut mesh = thick_sphere_octant(sphere, shape);
    let radii = mesh.nodes.iter().map(|x| Vector::new(x.norm(), 0.0, 0.0)).collect();
    mesh.node_vectors.insert(RADIUS.to_owned(), radii);
    onto_walls(&mut mesh);
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let plane = |name: &str, normal: Vector| Sliding {
        nodes: set(name),
        normal: SlidingNormal::Direction(normal),
        segment: None,
    };
    let prescribed =
        vec![Prescribed::FromArray { nodes: set("inner"), array: MOVEMENT.to_owned() }];
    let soft = materials("nu 0.46", &[("*", 15.0, 0.46)]);
    StudyScene {
        name: "sphere".to_owned(),
        case: Case {
            volume: Arc::new(mesh),
            skin: Some(set("outer")),
            sliding: vec![
                plane("x_min", Vector::x()),
                plane("y_min", Vector::y()),
                plane("z_min", Vector::z()),
            ],
            materials: soft.by_region.clone(),
            ..Case::default()
        },
        plans: vec![("inner wall 2 mm".to_owned(), Plan { prescribed, ..Plan::default() })],
        materials: vec![soft],
        truth: Truth::ClosedForm(ClosedForm { displacement, walls: onto_walls }),
    }
}

/// Moves every node to its radius, and the inner wall radially.
fn onto_walls(mesh: &mut VolumeMesh) {
    if let Some(radii) = mesh.node_vectors.get(RADIUS) {
        for (node, radius) in mesh.nodes.iter_mut().zip(radii) {
            *node = node.normalize() * radius.x;
        }
    }
    let movement = mesh.nodes.iter().map(|x| x.normalize() * MOVED).collect();
    mesh.node_vectors.insert(MOVEMENT.to_owned(), movement);
}

fn displacement(point: &Vector, _: &Plan, materials: &Materials) -> Vector {
    let (r, e_r) = (point.norm(), point.normalize());
    let material = materials.by_region.values().next();
    let Some(material) = material else { return Vector::repeat(f64::NAN) };
    // B = s A from the free wall, and A from the moved one.
    let s = 3.0 * material.bulk_modulus() * OUTER.powi(3) / (4.0 * material.shear_modulus());
    let a = MOVED / (INNER + s / (INNER * INNER));
    e_r * (a * r + s * a / (r * r))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_has_the_published_displacements() {
        let at = |r: f64, nu: f64| {
            let materials = materials("", &[("*", 15.0, nu)]);
            displacement(
                &(Vector::new(1.0, -2.0, 3.0).normalize() * r),
                &Plan::default(),
                &materials,
            )
        };
        for (nu, outer, middle) in
            [(0.0, 1.93133, 1.94641), (0.46, 1.44919, 1.68552), (0.4999, 1.38904, 1.65298)]
        {
            // The table has five digits.
            assert!((at(72.0, nu).norm() - outer).abs() < 1e-5, "nu {nu}");
            assert!((at(66.0, nu).norm() - middle).abs() < 1e-5, "nu {nu}");
            assert!((at(60.0, nu).norm() - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_nodes_of_a_refined_sphere_lie_between_its_walls_in_even_layers() {
        let scene = sphere_of(1, 2, CellShape::Tet4);
        let mut finer = crate::mesh::refinement::refine(&scene.case.volume);
        onto_walls(&mut finer);
        for x in &finer.nodes {
            let layer = (x.norm() - INNER) / 6.0;
            // Rounding only.
            assert!((layer - layer.round()).abs() < 1e-12, "{x}");
        }
        let inner = finer.node_set("inner").expect("the set is refined");
        assert!(inner.iter().all(|&n| (finer.nodes[n as usize].norm() - INNER).abs() < 1e-12));
    }
}
