//! Regions of tissue of a label map, against balls of known volume, and bone and teeth by their labels.

use std::f64::consts::PI;

use mechanics::anatomy::label_bone::part_labels;
use mechanics::anatomy::{AnatomyRules, build};
use mechanics::domain::{Boundary, LabelBody, LabelClass};
use mechanics::image::{ImageVolume, LabelMap, Placement, Voxels};
use mechanics::mesh::Vector;
use mechanics::meshing::{REGIONS, TissueMesh};
use mechanics::osteotomy::{Osteotomy, SegmentRule};
use mechanics::progress::Unobserved;

use super::{assert_sound, meshed, off_sphere, uniform};

const OUTER: f64 = 40.0;
const BETWEEN: f64 = 28.0;
const BONE: f64 = 16.0;
/// Labels of the balls: fat around muscle around bone, with a tooth in its front.
const FAT: u16 = 7;
const MUSCLE: u16 = 9;
const JAW: u16 = 117;
const TOOTH: u16 = 118;

fn place(number: usize) -> Vector {
    let index = [number % 48, number / 48 % 48, number / (48 * 48)];
    Vector::from(index.map(|i| 2.0 * i as f64 - 47.0))
}

fn label(at: &Vector) -> u16 {
    match at.norm() {
        r if r > OUTER => 0,
        r if r > BETWEEN => FAT,
        r if r > BONE => MUSCLE,
        r if r > 10.0 && at.y < -8.0 => TOOTH,
        _ => JAW,
    }
}

/// Voxels of 2 mm.
fn body() -> LabelBody {
    body_with(|number| label(&place(number)))
}

fn body_with(label: impl Fn(usize) -> u16) -> LabelBody {
    let steps = [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * 2.0);
    let placement = Placement { origin: Vector::repeat(-47.0), steps };
    let voxels = (0..48 * 48 * 48).map(|number| label(number) as i16);
    let image = ImageVolume::new([48; 3], placement, Voxels::I16(voxels.collect())).unwrap();
    let map = LabelMap::of(&image).unwrap();
    LabelBody::new(image, map, 2, |label| match label {
        FAT => LabelClass::Tissue(0),
        MUSCLE => LabelClass::Tissue(1),
        JAW => LabelClass::Bone { segment: Some(0), is_tooth: false },
        TOOTH => LabelClass::Bone { segment: Some(0), is_tooth: true },
        0 => LabelClass::Air,
        // Further labels of the jaw.
        _ => LabelClass::Bone { segment: Some(0), is_tooth: false },
    })
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// The volume of the cells of each region, in mm³.
fn volumes(tissue: &TissueMesh) -> [f64; 2] {
    let mut volumes = [0.0; 2];
    for (cell, &region) in tissue.volume.cell_labels[REGIONS].iter().enumerate() {
        let corners: Vec<Vector> = tissue.volume.corners(cell).collect();
        let [a, b, c] = [1, 2, 3].map(|n| corners[n] - corners[0]);
        volumes[region as usize] += a.cross(&b).dot(&c) / 6.0;
    }
    volumes
}

/// How far the nodes that cells of both regions share are from the sphere between these, ascending.
fn off_interface(tissue: &TissueMesh) -> Vec<f64> {
    let mut seen = vec![[false; 2]; tissue.volume.nodes.len()];
    let regions = &tissue.volume.cell_labels[REGIONS];
    for ((_, nodes), &region) in tissue.volume.cells.iter().zip(regions) {
        nodes.iter().for_each(|&node| seen[node as usize][region as usize] = true);
    }
    let shared = seen.iter().zip(&tissue.volume.nodes).filter(|(seen, _)| **seen == [true; 2]);
    let mut off: Vec<f64> = shared.map(|(_, at)| (at.norm() - BETWEEN).abs()).collect();
    off.sort_by(f64::total_cmp);
    off
}

#[test]
fn regions_of_a_label_map_have_their_volumes_and_meet_where_the_labels_do() {
    let domain = body().domain(&[]).unwrap();
    for edge in [5.0, 3.0] {
        let tissue = meshed(&domain, &uniform(edge));
        let [smallest, _] = assert_sound(&tissue);
        assert!(smallest > 12.0, "{smallest}");
        let [fat, muscle] = volumes(&tissue);
        let exact = [ball(OUTER) - ball(BETWEEN), ball(BETWEEN) - ball(BONE)];
        let off = off_interface(&tissue);
        let quantile = |part: f64| off[(part * (off.len() - 1) as f64) as usize];
        println!(
            "{edge} mm: fat {:+.2} %, muscle {:+.2} %, angle {smallest:.1}, {} nodes off by {:.2}, {:.2}, {:.2} mm",
            100.0 * (fat / exact[0] - 1.0),
            100.0 * (muscle / exact[1] - 1.0),
            off.len(),
            quantile(0.5),
            quantile(0.95),
            quantile(1.0)
        );
        assert!((fat / exact[0] - 1.0).abs() < 0.01 && (muscle / exact[1] - 1.0).abs() < 0.01);
        assert!(quantile(0.5) < 0.08 * edge && quantile(0.95) < 0.25 * edge);
        // Less than half a voxel: there are no stairs.
        assert!(off_sphere(&tissue, Boundary::Skin, OUTER) < 0.95);
        assert!(off_sphere(&tissue, Boundary::Bone, BONE) < 0.95);
    }
}

#[test]
fn bone_of_two_hundred_labels_is_meshed_as_bone_of_one() {
    let few = meshed(&body().domain(&[]).unwrap(), &uniform(5.0));
    let many = body_with(|number| match label(&place(number)) {
        JAW => 200 + (number % 200) as u16,
        other => other,
    });
    let many = meshed(&many.domain(&[]).unwrap(), &uniform(5.0));
    assert_eq!(many.volume.nodes, few.volume.nodes);
    assert_eq!(many.volume.cell_labels, few.volume.cell_labels);
}

#[test]
fn bone_goes_with_the_segment_of_its_label_and_tissue_slides_on_its_teeth() {
    let body = body();
    let jaw = SegmentRule { name: "jaw".to_owned(), ..SegmentRule::default() };
    let rules = AnatomyRules {
        osteotomy: Osteotomy::new(Vec::new(), vec![jaw]).unwrap(),
        meshing: uniform(5.0),
        teeth_slide: true,
        ..AnatomyRules::default()
    };
    let domain = body.domain(&[]).unwrap();
    let bone = part_labels(&body, &domain, &rules).unwrap();
    let found = &bone.labelled.segments[0];
    assert!((found.volume_mm3 / ball(BONE) - 1.0).abs() < 0.03, "{found:?}");
    assert_eq!(bone.labelled.loose.pieces, 0);
    let anatomy = build(&domain, bone, &rules, &Unobserved).unwrap();
    let sets = &anatomy.volume.node_sets;
    assert!(sets["jaw"].len() > 100, "{}", sets["jaw"].len());
    let sliding = &sets["sliding_jaw"];
    // Of mucosa, which reaches 4 mm around the teeth.
    let near = |node: &u32| anatomy.volume.nodes[*node as usize].y < -3.5;
    assert!(sliding.len() > 10 && sliding.iter().all(near), "{}", sliding.len());
}
