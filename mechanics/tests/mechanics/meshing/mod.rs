//! Meshes of bodies whose volume, surface and folds are known.

mod damage;
mod held;
mod refused;
mod regions;
mod scenes;
mod shapes;
mod sizes;

use std::collections::HashMap;

use mechanics::domain::{Boundary, Domain};
use mechanics::mesh::quality::{DihedralAngles, quality};
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::meshing::{MeshingSettings, SizeField, TissueMesh, mesh};
use mechanics::progress::Unobserved;

use crate::domains;

fn uniform(size: f64) -> MeshingSettings {
    MeshingSettings { size: SizeField::uniform(size), ..MeshingSettings::default() }
}

fn meshed(domain: &dyn Domain, settings: &MeshingSettings) -> TissueMesh {
    mesh(domain, settings, &Unobserved).unwrap()
}

/// What every mesh is held against, found with other means than the mesher's; its smallest and largest angle.
fn assert_sound(tissue: &TissueMesh) -> [f64; 2] {
    let report = &tissue.report;
    let quality = quality(&tissue.volume);
    assert!(quality.smallest_volume > 0.0 && quality.inverted == 0 && quality.undecided == 0);
    assert!((quality.total_volume / report.volume - 1.0).abs() < 1e-12);
    assert_eq!([report.nodes, report.tetrahedra], [tissue.volume.nodes.len(), quality.cells]);
    let skin = surface(tissue);
    assert_eq!(skin.triangles.len(), report.boundary_triangles);
    let mut edges: HashMap<[u32; 2], [usize; 2]> = HashMap::new();
    for [a, b, c] in &skin.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.entry([*from.min(to), *from.max(to)]).or_default()[usize::from(from < to)] += 1;
        }
    }
    assert!(edges.values().all(|&both_ways| both_ways == [1, 1]));
    let mut bounds = vec![false; tissue.volume.nodes.len()];
    skin.node_ids.iter().flatten().for_each(|&node| bounds[node as usize] = true);
    for (node, bounds) in bounds.into_iter().enumerate() {
        assert_eq!(tissue.boundaries[node].is_empty(), !bounds, "{node}");
    }
    let angles = DihedralAngles::of(&tissue.volume).unwrap();
    let angles = [angles.smallest, angles.largest].map(f64::to_degrees);
    assert!((angles[0] - report.angles.smallest).abs() < 1e-9);
    assert!((angles[1] - report.angles.largest).abs() < 1e-9);
    angles
}

fn surface(tissue: &TissueMesh) -> TriangleSurface {
    tissue.volume.surface_of(&tissue.volume.boundary_faces())
}

/// Points spread evenly over a sphere about the origin.
fn on_sphere(radius: f64, count: usize) -> impl Iterator<Item = Vector> {
    let golden = std::f64::consts::PI * (5.0_f64.sqrt() - 1.0);
    (0..count).map(move |i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (sine, cosine) = (golden * i as f64).sin_cos();
        Vector::new(cosine * (1.0 - z * z).sqrt(), sine * (1.0 - z * z).sqrt(), z) * radius
    })
}

/// The nodes on a boundary and how far they are from a sphere at most.
fn off_sphere(tissue: &TissueMesh, boundary: Boundary, radius: f64) -> f64 {
    let nodes = tissue.nodes_on(boundary);
    assert!(!nodes.is_empty());
    let off = nodes.iter().map(|&node| (tissue.volume.nodes[node as usize].norm() - radius).abs());
    off.fold(0.0, f64::max)
}
