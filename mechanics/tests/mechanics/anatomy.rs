//! Bone between surfaces in its segments, against balls of known volume, and what is told of surfaces that are not whole.

use std::f64::consts::PI;

use mechanics::anatomy::surfaces::{mended, part_by_cuts, take_as_segments};
use mechanics::anatomy::{AnatomyError, AnatomyRules, build};
use mechanics::domain::SurfaceDomain;
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::meshing::{MeshingSettings, SizeField};
use mechanics::osteotomy::{Cut, CutSide, LabelError, Osteotomy, Plane, SegmentRule, Side};
use mechanics::progress::Unobserved;

use crate::surfaces::{solid, sphere};

const BONE: f64 = 25.0;
/// The height of a cut, in mm.
const CUT: f64 = 0.5;

fn ball(radius: f64, centre: Vector) -> TriangleSurface {
    sphere(radius, centre, 4)
}

fn skin() -> TriangleSurface {
    ball(50.0, Vector::zeros())
}

fn volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// What lies below a plane across z at that height.
fn below(height: f64) -> Osteotomy {
    let plane = Plane::new(Vector::z() * height, Vector::z()).unwrap();
    let sides = vec![CutSide { cut: 0, side: Side::Below }];
    let jaw = SegmentRule { name: "jaw".to_owned(), sides, ..SegmentRule::default() };
    Osteotomy::new(vec![Cut::unbounded("across", plane)], vec![jaw]).unwrap()
}

fn named(names: &[&str]) -> Osteotomy {
    let rule = |name: &&str| SegmentRule { name: (*name).to_owned(), ..SegmentRule::default() };
    Osteotomy::new(Vec::new(), names.iter().map(rule).collect()).unwrap()
}

#[test]
fn depths_of_bone_are_those_of_a_ball_within_half_a_voxel() {
    let domain = SurfaceDomain::new(&skin(), &[&ball(BONE, Vector::x())], &[]).unwrap();
    let image = domain.bone_depths().image;
    let edge = image.spacing()[0];
    let [nx, ny, nz] = image.size();
    for number in (0..nx * ny * nz).step_by(37) {
        let centre = image.centre([number % nx, number / nx % ny, number / (nx * ny)]);
        let depth = BONE - (centre - Vector::x()).norm();
        let found = image.at(&centre).unwrap();
        // The faces of the ball lie within it by .2 % of its radius.
        let off = (found - depth.max(-2.0 * edge)).abs();
        assert!(off < 0.5 * edge, "{centre}: {found} {depth}");
        assert!(depth > -2.0 * edge || found == -2.0 * edge, "{found}");
    }
}

#[test]
fn bone_between_surfaces_is_cut_like_that_of_a_scan_even_with_a_hole() {
    let whole = ball(BONE, Vector::zeros());
    let mut open = whole.clone();
    open.triangles.drain(700..704);
    for bone in [whole, open] {
        let domain = SurfaceDomain::new(&skin(), &[&bone], &[]).unwrap();
        let parted = part_by_cuts(&domain, &below(CUT)).unwrap();
        let found = &parted.labelled.segments[0];
        // Of a ball below a height h: pi (2/3 r³ + r² h - h³ / 3).
        let lower = volume(BONE) / 2.0 + PI * (BONE * BONE * CUT - CUT.powi(3) / 3.0);
        assert!((found.volume_mm3 / lower - 1.0).abs() < 0.02, "{found:?}");
        assert!((parted.surfaces[0].signed_volume() / lower - 1.0).abs() < 0.02);
        let highest = parted.surfaces[0].points.iter().fold(-BONE, |most, x| most.max(x.z));
        assert!((highest - CUT).abs() < 1e-6, "{highest}");
    }
}

#[test]
fn bones_that_are_segments_keep_their_surfaces_and_hold_the_tissue_on_them() {
    let bones = [ball(12.0, Vector::x() * 18.0), ball(14.0, Vector::x() * -18.0)];
    let bones: Vec<&TriangleSurface> = bones.iter().collect();
    let domain = SurfaceDomain::new(&skin(), &bones, &[]).unwrap();
    let parted = take_as_segments(&domain, &bones, &named(&["left", "right"])).unwrap();
    for (segment, radius) in parted.labelled.segments.iter().zip([12.0, 14.0]) {
        assert!((segment.volume_mm3 / volume(radius) - 1.0).abs() < 0.02, "{segment:?}");
    }
    assert_eq!(parted.surfaces, [bones[0].clone(), bones[1].clone()]);
    let meshing = MeshingSettings { size: SizeField::uniform(4.0), ..MeshingSettings::default() };
    let rules = AnatomyRules { meshing, ..AnatomyRules::default() };
    let made = build(&domain, parted, &rules, &Unobserved).unwrap();
    for (name, centre, radius) in [("left", 18.0, 12.0), ("right", -18.0, 14.0)] {
        let nodes = &made.volume.node_sets[name];
        assert!(nodes.len() > 50, "{name}: {}", nodes.len());
        for &node in nodes {
            let from = made.volume.nodes[node as usize] - Vector::x() * centre;
            assert!((from.norm() - radius).abs() < 1.0, "{name}: {from}");
        }
    }
    assert_eq!(made.classes.without_bone, 0);
}

#[test]
fn volumes_of_bones_are_those_of_their_surfaces_wherever_faces_lie_between_voxels_and_where_bones_touch()
 {
    for off in [0.0, 0.13, 0.5, 0.77] {
        let below = ([-20.0 + off, -10.0 + off, -8.0 + off], [20.0 + off, 10.0 + off, 8.0 + off]);
        let above = ([-10.0, -5.0, 8.0 + off], [10.0, 5.0, 18.0 + off]);
        let bones = [below, above].map(|(low, high)| solid(low, high));
        let bones: Vec<&TriangleSurface> = bones.iter().collect();
        let domain = SurfaceDomain::new(&skin(), &bones, &[]).unwrap();
        let parted = take_as_segments(&domain, &bones, &named(&["below", "above"])).unwrap();
        let wanted = [(12_800.0, Vector::repeat(off)), (2000.0, Vector::z() * (13.0 + off))];
        for (solid, (volume, centre)) in parted.solids().iter().zip(wanted) {
            // Voxels on a straight edge count half, where a quarter of them lies within: two hundredths of the smaller body.
            assert!((solid.volume_mm3 / volume - 1.0).abs() < 0.021, "{off}: {solid:?}");
            assert!((solid.centre - centre).norm() < 0.1, "{off}: {solid:?}");
        }
    }
    // What lies in both belongs to the bone that lies within the other.
    let bones = [ball(20.0, Vector::zeros()), ball(10.0, Vector::x() * 3.0)];
    let bones: Vec<&TriangleSurface> = bones.iter().collect();
    let domain = SurfaceDomain::new(&skin(), &bones, &[]).unwrap();
    let parted = take_as_segments(&domain, &bones, &named(&["around", "within"])).unwrap();
    let wanted = [volume(20.0) - volume(10.0), volume(10.0)];
    for (solid, volume) in parted.solids().iter().zip(wanted) {
        assert!((solid.volume_mm3 / volume - 1.0).abs() < 0.02, "{volume}: {solid:?}");
    }
}

#[test]
fn a_bone_smaller_than_a_voxel_is_refused_by_its_name() {
    let bones = [ball(BONE, Vector::zeros()), ball(0.3, Vector::new(35.5, 0.5, 0.5))];
    let bones: Vec<&TriangleSurface> = bones.iter().collect();
    let domain = SurfaceDomain::new(&skin(), &bones, &[]).unwrap();
    let refused = take_as_segments(&domain, &bones, &named(&["skull", "splinter"])).unwrap_err();
    let wanted = LabelError::NoBone { segment: "splinter".to_owned() };
    assert_eq!(refused, AnatomyError::Bone(wanted));
}

#[test]
fn what_was_mended_is_reported_by_name_and_number_and_a_whole_surface_is_not() {
    let whole = ball(BONE, Vector::zeros());
    let told = |skin: &TriangleSurface, bone: &TriangleSurface| {
        mended(&SurfaceDomain::new(skin, &[bone], &[]).unwrap())
    };
    assert_eq!(told(&skin(), &whole), []);
    let mut bone = whole.clone();
    bone.triangles.swap_remove(5);
    bone.triangles.push(bone.triangles[40]);
    bone.triangles[80].swap(1, 2);
    let warnings = told(&skin(), &bone);
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    assert_eq!(warning.code, "surface-mended");
    assert_eq!(
        warning.detail,
        "bone 1: 1 triangles left out that stood there before, 1 triangles turned to the side of those around them, \
         1 holes closed by lids as curved as what is around them"
    );
    let mut inverted = skin();
    inverted.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let warnings = told(&inverted, &whole);
    assert_eq!(warnings[0].detail, "skin: all of it was inside out");
}

#[test]
fn bone_that_nothing_cuts_is_reported_because_no_plan_can_move_it() {
    let (skin, bone) = (skin(), ball(BONE, Vector::zeros()));
    let domain = SurfaceDomain::new(&skin, &[&bone], &[]).unwrap();
    let meshing = MeshingSettings { size: SizeField::uniform(8.0), ..MeshingSettings::default() };
    let rules = AnatomyRules { meshing, teeth_slide: false, ..AnatomyRules::default() };
    let told = |osteotomy: &Osteotomy| {
        let made =
            build(&domain, part_by_cuts(&domain, osteotomy).unwrap(), &rules, &Unobserved).unwrap();
        made.warnings.iter().filter(|warning| warning.code == "no-cuts").count()
    };
    assert_eq!(told(&Osteotomy::default()), 1);
    assert_eq!(told(&below(CUT)), 0);
}

#[test]
fn a_second_skin_that_is_not_meshed_and_teeth_that_do_not_slide_are_reported() {
    let mut skin = skin();
    let other = ball(27.0, Vector::x() * 120.0);
    let first = skin.points.len() as u32;
    skin.points.extend(other.points);
    skin.triangles.extend(other.triangles.iter().map(|corners| corners.map(|c| c + first)));
    let bone = ball(BONE, Vector::zeros());
    let domain = SurfaceDomain::new(&skin, &[&bone], &[]).unwrap();
    let parted = take_as_segments(&domain, &[&bone], &named(&["jaw"])).unwrap();
    let meshing = MeshingSettings { size: SizeField::uniform(6.0), ..MeshingSettings::default() };
    let rules = AnatomyRules { meshing, teeth_slide: true, ..AnatomyRules::default() };
    let made = build(&domain, parted, &rules, &Unobserved).unwrap();
    let codes: Vec<&str> = made.warnings.iter().map(|warning| warning.code).collect();
    assert_eq!(codes, ["tissue-left-out", "teeth-joined", "no-landmarks"], "{:?}", made.warnings);
    let left = &made.warnings[0];
    let ml = left.numbers.iter().find(|(name, _)| *name == "volume_ml").unwrap().1;
    assert!((ml / (volume(27.0) / 1000.0) - 1.0).abs() < 0.04, "{left:?}");
    assert!(left.detail.contains("(120, "), "{left:?}");
}
