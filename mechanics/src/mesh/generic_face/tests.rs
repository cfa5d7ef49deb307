use std::collections::BTreeSet;

use super::*;
use crate::mesh::quality::quality;

const SHAPES: [CellShape; 3] = [CellShape::Hex8, CellShape::Wedge6, CellShape::Tet4];

fn made(lips: Lips, fineness: usize, shape: CellShape) -> GenericFace {
    generic_face(FaceSettings { lips, fineness, shape })
}

#[test]
fn every_cell_of_both_faces_is_proven_valid() {
    for lips in [Lips::Closed, Lips::Open] {
        for (fineness, shape) in
            [(1, SHAPES[0]), (1, SHAPES[1]), (1, SHAPES[2]), (2, SHAPES[0]), (3, SHAPES[0])]
        {
            let report = quality(&made(lips, fineness, shape).mesh);
            assert_eq!((report.inverted, report.undecided), (0, 0), "{lips:?} {shape:?}");
            if shape == CellShape::Hex8 {
                assert_eq!(report.cells, 5616 * fineness * fineness);
                // Worst at the nostrils: 0.156 with 5616 cells.
                assert!(report.smallest_scaled_jacobian > 0.1, "{report:?}");
            }
        }
    }
}

#[test]
fn the_face_its_landmarks_and_its_muscles_mirror_to_the_bit() {
    let bits = |p: &Vector| [p.x + 0.0, p.y, p.z].map(f64::to_bits);
    let mirrored = |p: &Vector| bits(&Vector::new(-p.x, p.y, p.z));
    for lips in [Lips::Closed, Lips::Open] {
        let face = made(lips, 1, CellShape::Tet4);
        let number = |p: [u64; 3]| face.mesh.nodes.iter().position(|node| bits(node) == p);
        let numbers: Vec<u32> =
            face.mesh.nodes.iter().map(|p| number(mirrored(p)).unwrap() as u32).collect();
        let sorted = |nodes: &[u32]| {
            let mut nodes = nodes.to_vec();
            nodes.sort_unstable();
            nodes
        };
        let cells: BTreeSet<Vec<u32>> =
            face.mesh.cells.iter().map(|(_, nodes)| sorted(nodes)).collect();
        let images = face.mesh.cells.iter().map(|(_, nodes)| {
            sorted(&nodes.iter().map(|&node| numbers[node as usize]).collect::<Vec<_>>())
        });
        assert!(images.into_iter().all(|image| cells.contains(&image)));
        for (name, set) in &face.mesh.node_sets {
            let image: Vec<u32> = set.iter().map(|&node| numbers[node as usize]).collect();
            assert_eq!(sorted(&image), *set, "{name}");
        }
        for (name, point) in &face.landmarks {
            match name.strip_suffix("_left") {
                Some(name) => {
                    assert_eq!(mirrored(point), bits(&face.landmarks[&format!("{name}_right")]));
                }
                None => assert!(name.ends_with("_right") || point.x == 0.0, "{name}"),
            }
        }
        for left in face.muscles.iter().filter(|muscle| muscle.name.ends_with("_left")) {
            let name = left.name.replace("_left", "_right");
            let right = face.muscles.iter().find(|muscle| muscle.name == name).unwrap();
            for (one, other) in left.lines.iter().flatten().zip(right.lines.iter().flatten()) {
                assert_eq!(mirrored(one), bits(other), "{name}");
            }
        }
    }
}

#[test]
fn the_mouth_is_a_hole_through_the_tissue_from_corner_to_corner() {
    for (lips, gap) in [(Lips::Closed, 0.3), (Lips::Open, 6.0)] {
        let face = made(lips, 2, CellShape::Hex8);
        let outside = face.mesh.surface_of(&face.mesh.boundary_faces());
        // A closed surface of Euler characteristic 0, a torus: 3 edges for 2 triangles.
        assert_eq!(2 * outside.points.len(), outside.triangles.len());
        let [upper, lower] =
            ["upper_lip_margin", "lower_lip_margin"].map(|set| face.mesh.node_set(set).unwrap());
        let both: Vec<&u32> = upper.iter().filter(|node| lower.contains(node)).collect();
        assert_eq!(both.len(), 2 * 5, "five nodes across the tissue in each corner");
        let parted = face.landmarks["stomion_superius"] - face.landmarks["stomion_inferius"];
        assert!((parted - Vector::z() * gap).norm() < 1e-12);
    }
}

#[test]
fn what_bone_holds_is_apart_and_what_lies_on_teeth_is_free() {
    let face = made(Lips::Open, 1, CellShape::Hex8);
    let names =
        ["maxilla", "mandible", "skull", "rim", "upper_vestibule", "lower_vestibule", "skin"];
    let mut seen = BTreeSet::new();
    for name in names {
        let set = face.mesh.node_set(name).unwrap();
        assert!(set.len() > 50 && set.iter().all(|node| seen.insert(*node)), "{name}");
    }
    for (name, surface) in &face.bones {
        assert!(surface.triangles.len() > 100, "{name}");
    }
    let mut labels = face.mesh.cell_labels["layer"].clone();
    labels.sort_unstable();
    labels.dedup();
    assert_eq!(labels, [0, 1, 2, 3, 4]);
}

#[test]
fn the_tissue_is_as_thick_as_faces_are() {
    let mesh = made(Lips::Closed, 2, CellShape::Hex8).mesh;
    let sheet = mesh.nodes.len() / 5;
    let thickness = (0..sheet).map(|p| (mesh.nodes[p + 4 * sheet] - mesh.nodes[p]).norm());
    let (least, most) = thickness.fold((f64::INFINITY, 0.0f64), |(l, m), t| (l.min(t), m.max(t)));
    assert!(least > 5.0 && most < 20.0, "{least} to {most} mm");
}

#[test]
fn landmarks_stand_in_the_order_of_a_face() {
    let landmarks = made(Lips::Closed, 1, CellShape::Hex8).landmarks;
    assert_eq!(landmarks.len(), 32);
    let down = [
        "trichion",
        "glabella",
        "nasion",
        "pronasale",
        "subnasale",
        "labrale_superius",
        "stomion_superius",
        "stomion_inferius",
        "labrale_inferius",
        "sulcus_mentolabialis",
        "pogonion",
        "menton",
    ];
    let heights: Vec<f64> = down.iter().map(|name| landmarks[*name].z).collect();
    assert!(heights.is_sorted_by(|a, b| a > b), "{heights:?}");
    let width = |name: &str| 2.0 * landmarks[&format!("{name}_left")].x;
    // Adults: mouth some 50 mm, inner and outer corners of the eyes 33 and 90, nose 33 (Farkas 1994, from memory).
    let usual =
        [("cheilion", 50.0), ("endocanthion", 33.0), ("exocanthion", 85.0), ("alare", 32.0)];
    for (name, usual) in usual {
        assert!((width(name) / usual - 1.0).abs() < 0.15, "{name}: {}", width(name));
    }
}

#[test]
fn muscles_run_inside_the_tissue_and_the_orbicularis_closes_on_itself() {
    for lips in [Lips::Closed, Lips::Open] {
        let face = made(lips, 2, CellShape::Hex8);
        let middles: Vec<Vector> = (0..face.mesh.cells.len())
            .map(|cell| face.mesh.corners(cell).sum::<Vector>() / 8.0)
            .collect();
        for muscle in &face.muscles {
            for line in &muscle.lines {
                for point in line {
                    let far = middles.iter().map(|middle| (middle - point).norm());
                    let nearest = far.fold(f64::INFINITY, f64::min);
                    assert!(nearest < 4.0, "{}: {nearest} mm from any cell", muscle.name);
                }
            }
        }
        let ring = face.muscles.iter().find(|muscle| muscle.name == "orbicularis_oris").unwrap();
        assert!(ring.lines.iter().all(|line| line.first() == line.last() && line.len() == 33));
    }
}
