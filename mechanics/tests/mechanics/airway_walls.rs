//! Nodes beside bone of a scan, where an airway and a wall thinner than voxels lie between tissue and bone.

use std::f64::consts::PI;

use mechanics::anatomy::{Anatomy, AnatomyRules, build, part_bone};
use mechanics::domain::ImageDomain;
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::Vector;
use mechanics::meshing::{MeshingSettings, SizeField};
use mechanics::progress::Unobserved;

const EDGE: f64 = 2.0;
const SIZE: usize = 50;
const BONE: f64 = 18.0;
const CENTRE: Vector = Vector::new(41.0, 49.0, 49.0);

/// A ball of tissue with one of bone in it, and one of air beside that.
fn head(air_radius: f64) -> Anatomy {
    let place = |voxel: usize| {
        let index = [voxel % SIZE, voxel / SIZE % SIZE, voxel / (SIZE * SIZE)];
        Vector::from(index.map(|n| n as f64 * EDGE))
    };
    let value = |voxel: usize| {
        let at = place(voxel);
        let air = CENTRE + Vector::x() * (BONE + 0.6 * air_radius);
        let off = (at - Vector::repeat(49.0)).norm();
        match () {
            () if (at - CENTRE).norm() < BONE => 1000.0,
            () if off > 44.0 || (at - air).norm() < air_radius => -1000.0,
            () => 40.0,
        }
    };
    let steps = [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * EDGE);
    let placement = Placement { origin: Vector::zeros(), steps };
    let values = (0..SIZE.pow(3)).map(value).collect();
    let scan = ImageVolume::new([SIZE; 3], placement, Voxels::F32(values)).unwrap();
    let meshing = MeshingSettings { size: SizeField::uniform(4.0), ..MeshingSettings::default() };
    let rules = AnatomyRules { meshing, ..AnatomyRules::default() };
    let bone = part_bone(&scan, &rules).unwrap();
    let domain = ImageDomain::new(&scan, &rules.image).unwrap();
    build(&domain, bone, &rules, &Unobserved).unwrap()
}

fn told(made: &Anatomy) -> f64 {
    let of = made.warnings.iter().find(|warning| warning.code == "nodes-off-bone");
    of.map_or(0.0, |warning| warning.numbers[0].1)
}

#[test]
fn nodes_on_the_wall_of_an_airway_beside_bone_are_not_joined_to_it() {
    let made = head(10.0);
    let fixed = &made.volume.node_sets["fixed"];
    let off = |node: &u32| (made.volume.nodes[*node as usize] - CENTRE).norm() - BONE;
    let farthest = fixed.iter().map(off).fold(0.0, f64::max);
    println!(
        "{} nodes on bone, the farthest {farthest:.2} mm off, {} told",
        fixed.len(),
        told(&made)
    );
    // A voxel, and the stairs of voxels of a ball.
    assert!(farthest < 2.0 * EDGE, "{farthest}");
    assert!(told(&made) > 0.0);
    assert_eq!(told(&made), made.classes.without_bone as f64);
}

#[test]
fn all_nodes_of_bone_without_an_airway_beside_it_are_joined_to_it() {
    let made = head(0.0);
    assert_eq!(told(&made), 0.0);
    let area = 4.0 * PI * BONE * BONE;
    // About one node for each 4 mm by 4 mm.
    let nodes = made.volume.node_sets["fixed"].len() as f64;
    assert!((0.5..2.5).contains(&(nodes * 16.0 / area)), "{nodes}");
}
