//! Bones whose surface has an outer and an inner wall, as those with marrow and a closed skull have.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use mechanics::anatomy::surfaces::{hollow, overlapping, part_by_cuts, take_as_segments};
use mechanics::anatomy::{Anatomy, AnatomyRules, PartedBone, build};
use mechanics::domain::{SurfaceDomain, SurfaceDomainError};
use mechanics::mesh::{TriangleSurface, Vector, Warning};
use mechanics::meshing::{MeshingSettings, SizeField};
use mechanics::osteotomy::{Osteotomy, SegmentRule};
use mechanics::progress::Unobserved;

use crate::surfaces::{map, movement, sphere};

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
    let mut inner = sphere(INNER, Vector::zeros(), 4);
    inner.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    both(sphere(OUTER, Vector::zeros(), 4), &inner)
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

/// One surface of two.
fn both(one: TriangleSurface, other: &TriangleSurface) -> TriangleSurface {
    let first = one.points.len() as u32;
    let mut both = one;
    both.points.extend(&other.points);
    both.triangles.extend(other.triangles.iter().map(|corners| corners.map(|n| n + first)));
    both
}

#[test]
fn bone_in_the_order_in_which_it_is_given_has_the_same_segments() {
    let jaw = sphere(9.0, Vector::x() * 20.0, 4);
    let all = both(sphere(12.0, Vector::x() * -18.0, 4), &jaw);
    let volumes = |bones: [&TriangleSurface; 2], names: [&str; 2]| {
        let domain = SurfaceDomain::new(&skin(), &bones, &[]).unwrap();
        let rule = |name: &str| SegmentRule { name: name.to_owned(), ..SegmentRule::default() };
        let rules = Osteotomy::new(Vec::new(), names.map(rule).to_vec()).unwrap();
        let parted = take_as_segments(&domain, &bones, &rules).unwrap();
        let [overlap] = &overlapping(&domain)[..] else { panic!("one overlap") };
        assert_eq!(overlap.code, "surfaces-overlap");
        assert!((number(overlap, "volume_ml") * 1000.0 / volume(9.0) - 1.0).abs() < 0.03);
        let found = parted.labelled.segments.into_iter();
        found.map(|segment| (segment.name, segment.voxels)).collect::<BTreeMap<_, _>>()
    };
    let found = volumes([&all, &jaw], ["all", "jaw"]);
    assert_eq!(found, volumes([&jaw, &all], ["jaw", "all"]));
    let ratio = found["jaw"] as f64 / found["all"] as f64;
    assert!((ratio / (9.0_f64 / 12.0).powi(3) - 1.0).abs() < 0.05, "{found:?}");
    let apart = [&jaw, &sphere(12.0, Vector::x() * -18.0, 4)];
    assert_eq!(overlapping(&SurfaceDomain::new(&skin(), &apart, &[]).unwrap()), []);
}

#[test]
fn a_skin_with_an_inner_wall_is_refused_for_its_walls() {
    let mut inner = sphere(47.0, Vector::zeros(), 4);
    inner.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let skin = both(skin(), &inner);
    let refused = SurfaceDomain::new(&skin, &[&sphere(OUTER, Vector::zeros(), 4)], &[]);
    let SurfaceDomainError::TwoWalls { percent, .. } = refused.unwrap_err() else { panic!() };
    // The volume of a wall of 3 mm by points is good to some per cent.
    let wanted = 100.0 * volume(47.0) / volume(SKIN);
    assert!((percent - wanted).abs() < 1.0, "{percent} {wanted}");
}

#[test]
fn thin_bone_and_thin_tissue_that_cells_miss_are_told_with_volume_and_place() {
    // A plate of bone of 1.2 mm in cells of 8 mm, and a flap of tissue of 3 mm.
    let slab = |half: Vector, centre: Vector| {
        // Askew, so that the planes of the lattice do not meet all of it at once.
        let turn = movement([23.0, 31.0, 17.0], centre.into());
        map(&sphere(1.0, Vector::zeros(), 5), |x| turn.apply(&(x / x.amax()).component_mul(&half)))
    };
    let plate = slab(Vector::new(0.6, 25.0, 25.0), Vector::new(3.0, 1.0, 2.0));
    let flap = slab(Vector::new(60.0, 60.0, 1.5), Vector::new(70.0, 0.0, 3.3));
    let skin = both(skin(), &flap);
    let domain = SurfaceDomain::new(&skin, &[&plate], &[]).unwrap();
    let made = meshed(&domain, take_as_segments(&domain, &[&plate], &jaw()).unwrap());
    let told = |code: &str| {
        let of = made.warnings.iter().find(|warning| warning.code == code);
        of.unwrap_or_else(|| panic!("{:?}", made.warnings))
    };
    let bone = number(told("thin-bone-lost"), "volume_ml");
    // Voxels of the plate in cells of tissue.
    assert!((0.5..1.1).contains(&(bone / 3.0)), "{bone}");
    let tissue = number(told("thin-tissue-lost"), "volume_ml");
    println!("{tissue} ml of tissue, {bone} ml of bone");
    // 39 ml of the flap lie outside the ball.
    assert!((33.0..45.0).contains(&tissue), "{tissue}");
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
