//! Bones whose surface has an outer and an inner wall, as those with marrow and a closed skull have.

use std::f64::consts::PI;

use mechanics::anatomy::surfaces::{hollow, part_by_cuts, take_as_segments};
use mechanics::anatomy::{Anatomy, AnatomyRules, PartedBone, build};
use mechanics::domain::SurfaceDomain;
use mechanics::mesh::{TriangleSurface, Vector, Warning};
use mechanics::meshing::{MeshingSettings, SizeField};
use mechanics::osteotomy::{Osteotomy, SegmentRule};
use mechanics::progress::Unobserved;

use crate::surfaces::sphere;

const SKIN: f64 = 50.0;
const OUTER: f64 = 25.0;
const INNER: f64 = 23.5;

fn volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

fn skin() -> TriangleSurface {
    sphere(SKIN, Vector::zeros(), 4)
}

/// A ball of bone with walls of 1.5 mm.
fn hollow_ball() -> TriangleSurface {
    let mut bone = sphere(OUTER, Vector::zeros(), 4);
    let inner = sphere(INNER, Vector::zeros(), 4);
    let first = bone.points.len() as u32;
    bone.points.extend(inner.points);
    bone.triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|n| n + first)));
    bone
}

fn jaw() -> Osteotomy {
    let rule = SegmentRule { name: "jaw".to_owned(), ..SegmentRule::default() };
    Osteotomy::new(Vec::new(), vec![rule]).unwrap()
}

fn meshed(domain: &SurfaceDomain, parted: PartedBone) -> Anatomy {
    let meshing = MeshingSettings { size: SizeField::uniform(8.0), ..MeshingSettings::default() };
    let rules = AnatomyRules { meshing, ..AnatomyRules::default() };
    build(domain, parted, &rules, &Unobserved).unwrap()
}

fn number(warning: &Warning, wanted: &str) -> f64 {
    warning.numbers.iter().find(|(name, _)| *name == wanted).unwrap().1
}

#[test]
fn marrow_behind_a_wall_thinner_than_a_cell_does_not_become_tissue() {
    let bone = hollow_ball();
    let domain = SurfaceDomain::new(&skin(), &[&bone], &[]).unwrap();
    let parted = take_as_segments(&domain, &[&bone], &jaw()).unwrap();
    let wall = volume(OUTER) - volume(INNER);
    // A wall of 1.5 voxels is counted to a twentieth.
    assert!((parted.labelled.segments[0].volume_mm3 / wall - 1.0).abs() < 0.05);
    let made = meshed(&domain, parted);
    let wanted = volume(SKIN) - volume(OUTER);
    // Cells of 8 mm meet the volume of balls within 1 %; the marrow is 12 % of it.
    assert!((made.meshing.volume / wanted - 1.0).abs() < 0.01, "{}", made.meshing.volume / wanted);
    for node in &made.volume.nodes {
        assert!(node.norm() > OUTER - 0.5, "{node}");
    }
    assert_eq!(made.classes.without_bone, 0);
}

#[test]
fn hollows_are_told_with_their_volume_and_belong_to_bone_where_that_is_asked_for() {
    let bone = hollow_ball();
    let of = |domain: SurfaceDomain, what: &str| {
        let [told] = &hollow(&domain)[..] else { panic!("one warning") };
        assert_eq!(told.code, "bone-hollow");
        assert!(
            (number(told, "volume_ml") * 1000.0 / volume(INNER) - 1.0).abs() < 0.01,
            "{told:?}"
        );
        assert_eq!(number(told, "hollows"), 1.0);
        assert!(told.detail.contains(what) && told.detail.contains("0) mm"), "{told:?}");
        part_by_cuts(&domain, &jaw()).unwrap().labelled.segments[0].volume_mm3
    };
    let domain = SurfaceDomain::new(&skin(), &[&bone], &[]).unwrap();
    let filled = of(domain.clone().solid(), "are bone of it");
    assert!((filled / volume(OUTER) - 1.0).abs() < 0.02, "{filled}");
    let given = of(domain, "hold no tissue");
    assert!(given < 0.25 * volume(OUTER), "{given}");
    let whole = SurfaceDomain::new(&skin(), &[&sphere(OUTER, Vector::zeros(), 4)], &[]).unwrap();
    assert_eq!(hollow(&whole), []);
}
