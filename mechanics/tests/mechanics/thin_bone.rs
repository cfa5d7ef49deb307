//! Bone thinner than cells: what lies beside it goes with it all the same.

use mechanics::anatomy::{Anatomy, AnatomyRules, build, part_bone};
use mechanics::domain::{Boundary, ImageDomain};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::{Vector, Warning};
use mechanics::meshing::{MeshingSettings, SizeField};
use mechanics::osteotomy::classes::{Role, TissueBoundary};
use mechanics::osteotomy::coverage::coverage;
use mechanics::osteotomy::voxel_cells::VoxelCells;
use mechanics::osteotomy::{Osteotomy, SegmentRule};
use mechanics::progress::Unobserved;

const EDGE: f64 = 1.5;
const SIZE: usize = 60;
const MIDDLE: f64 = 44.0;
/// Half the plate of bone, in its own axes.
const PLATE: Vector = Vector::new(20.0, 1.2, 16.0);

/// A place in the axes of the plate, which is tilted about x.
fn in_plate(at: &Vector) -> Vector {
    let off = at - Vector::repeat(MIDDLE);
    let (sine, cosine) = 0.6_f64.sin_cos();
    Vector::new(off.x, cosine * off.y + sine * off.z, cosine * off.z - sine * off.y)
}

fn off_plate(at: &Vector) -> f64 {
    let beyond = in_plate(at).abs() - PLATE;
    beyond.sup(&Vector::zeros()).norm() + beyond.max().min(0.0)
}

/// A ball of tissue with a plate of bone of 2.4 mm in cells of 9 mm, and a slit of air in its upper face.
fn made(slit: f64) -> Anatomy {
    let value = |voxel: usize| {
        let index = [voxel % SIZE, voxel / SIZE % SIZE, voxel / (SIZE * SIZE)];
        let at = Vector::from(index.map(|n| n as f64 * EDGE));
        let off = at - Vector::repeat(MIDDLE);
        let is_air =
            off.norm() > 41.0 || off.x.abs() < 0.5 * slit && off.z > 28.0 && off.y.abs() < 15.0;
        let bone = (0.5 - off_plate(&at) / EDGE).clamp(0.0, 1.0);
        if is_air { -1000.0 } else { 40.0 + 960.0 * bone as f32 }
    };
    let steps = [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * EDGE);
    let placement = Placement { origin: Vector::zeros(), steps };
    let values = (0..SIZE.pow(3)).map(value).collect();
    let scan = ImageVolume::new([SIZE; 3], placement, Voxels::F32(values)).unwrap();
    let plate = SegmentRule {
        name: "plate".to_owned(),
        seeds: vec![Vector::repeat(MIDDLE)],
        ..SegmentRule::default()
    };
    let meshing = MeshingSettings { size: SizeField::uniform(9.0), ..MeshingSettings::default() };
    let osteotomy = Osteotomy::new(Vec::new(), vec![plate]).unwrap();
    let rules = AnatomyRules { meshing, osteotomy, ..AnatomyRules::default() };
    let bone = part_bone(&scan, &rules).unwrap();
    let domain = ImageDomain::new(&scan, &rules.image).unwrap();
    build(&domain, bone, &rules, &Unobserved).unwrap()
}

fn told<'a>(made: &'a Anatomy, code: &str) -> Option<&'a Warning> {
    made.warnings.iter().find(|warning| warning.code == code)
}

#[test]
fn nodes_beside_bone_that_no_cell_resolved_are_joined_to_it() {
    let made = made(0.0);
    let joined: Vec<Vector> =
        made.volume.node_sets["plate"].iter().map(|&n| made.volume.nodes[n as usize]).collect();
    let mut bare = 0;
    for x in -4..=4 {
        for z in -3..=3 {
            let at = Vector::new(f64::from(x) * 4.5, 0.0, f64::from(z) * 4.5);
            let near = |node: &Vector| (in_plate(node) - at).norm() < 9.0;
            bare += usize::from(!joined.iter().any(near));
        }
    }
    let farthest = joined.iter().map(off_plate).fold(0.0, f64::max);
    println!(
        "{} nodes, the farthest {farthest:.1} mm off, {bare} of 63 places without",
        joined.len()
    );
    assert!(bare <= 3, "{bare} of 63 places have no node within a cell");
    // Three quarters of the edge of a cube, and half a voxel.
    assert!(farthest < 0.75 * 9.0 + 0.75, "{farthest}");
    for node in &made.volume.node_sets["skin"] {
        assert!(!made.volume.node_sets["plate"].contains(node));
    }
    let lost = told(&made, "thin-bone-lost").unwrap();
    // All of it, and all of its surface has nodes.
    let share = lost.numbers[0].1 * 1000.0 / made.bone.segments[0].volume_mm3;
    assert!((0.9..=1.0 + 1e-9).contains(&share), "{lost:?}");
    assert!(lost.numbers[2].1 < 0.1, "{lost:?}");
}

#[test]
fn surface_of_bone_without_nodes_is_told_with_the_place_of_its_largest_patch() {
    let mut made = made(0.0);
    let marks: Vec<Option<Boundary>> = vec![None; made.volume.nodes.len()];
    let tissue = TissueBoundary { mesh: &made.volume, marks: &marks };
    let cells = VoxelCells::new(&made.volume, &made.bone.labels);
    let labels = &made.bone.labels;
    let whole = coverage(tissue, (labels, &cells), &|_| false, (&made.classes, 1))[0];
    // Both sides of 40 x 32 mm, and the rim.
    assert!((2400.0..3400.0).contains(&whole.area), "{whole:?}");
    assert!(whole.bare < 0.05 * whole.area, "{whole:?}");
    for (role, node) in made.classes.roles.iter_mut().zip(&made.volume.nodes) {
        if node.x > MIDDLE {
            *role = Role::Free;
        }
    }
    let half = coverage(tissue, (labels, &cells), &|_| false, (&made.classes, 1))[0];
    assert_eq!(half.area, whole.area);
    // All but what lies within one and a half cells of the other half.
    assert!((0.05..0.4).contains(&(half.bare / half.area)), "{half:?}");
    assert!(half.patch > 0.9 * half.bare, "{half:?}");
    let at = in_plate(&half.patch_at);
    assert!(at.x > 8.0 && off_plate(&half.patch_at).abs() < 2.0, "{half:?}");
}

#[test]
fn a_slit_of_the_skin_that_cells_close_is_told_with_its_place() {
    assert!(told(&made(0.0), "gaps-closed").is_none());
    let open = made(2.0);
    let told = told(&open, "gaps-closed").unwrap_or_else(|| panic!("{:?}", open.warnings));
    assert_eq!(told.numbers, [("gaps", 1.0)]);
    let gap = open.meshing.gaps_closed.iter().find(|gap| gap.at_skin).unwrap();
    assert!((gap.centre.x - MIDDLE).abs() < 2.0 && gap.centre.z > MIDDLE + 26.0, "{gap:?}");
}
