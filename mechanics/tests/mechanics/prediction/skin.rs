//! What is told of a skin: that it passes through itself, that it is no skin, that its bones are those of others.

use std::sync::Arc;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh, Warning};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Bone, Case, CaseSegment, Plan, Scene, SceneError, SceneErrorCode, Settings,
};

use crate::scenes::{case_of, exact, material, set, solve};

fn number(warning: &Warning, name: &str) -> f64 {
    let found = warning.numbers.iter().find(|(other, _)| *other == name);
    found.unwrap_or_else(|| panic!("{warning:?} has no {name}")).1
}

fn told<'a>(warnings: &'a [Warning], code: &str) -> Option<&'a Warning> {
    warnings.iter().find(|warning| warning.code == code)
}

fn lifted(name: &str, by: f64) -> Plan {
    let up = Vector::new(0.0, 0.0, by);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), up);
    let segments = vec![PlannedSegment { name: name.to_owned(), movement }];
    Plan { segments, ..Plan::default() }
}

fn shifted(mut mesh: VolumeMesh, by: Vector) -> VolumeMesh {
    mesh.nodes.iter_mut().for_each(|node| *node += by);
    mesh
}

/// One mesh of two, whose sets get a word in front.
fn beside(mut one: VolumeMesh, other: &VolumeMesh, word: &str) -> VolumeMesh {
    let first = one.nodes.len() as u32;
    one.nodes.extend_from_slice(&other.nodes);
    for (shape, nodes) in other.cells.iter() {
        let nodes: Vec<u32> = nodes.iter().map(|node| node + first).collect();
        one.cells.push(shape, &nodes);
    }
    for (name, nodes) in &other.node_sets {
        let nodes = nodes.iter().map(|node| node + first).collect();
        one.node_sets.insert(format!("{word} {name}"), nodes);
    }
    one
}

/// A lower lip on a bone, and an upper one, smaller and askew, so far above it; both go with their bones as they are.
fn lips(gap: f64) -> Case {
    let lower = block(Vector::new(30.0, 24.0, 6.0), [10, 8, 2], CellShape::Hex8);
    let upper = block(Vector::new(13.0, 11.0, 6.0), [5, 4, 2], CellShape::Hex8);
    let corner = Vector::new(8.3, 6.1, 6.0 + gap);
    let mut mesh = beside(lower, &shifted(upper, corner), "upper");
    let all = (0..mesh.nodes.len() as u32).collect();
    mesh.node_sets.insert("skin".to_owned(), all);
    Case {
        skin: Some(set("skin")),
        skin_regions: [
            ("lower lip".to_owned(), set("z_max")),
            ("upper lip".to_owned(), set("upper z_min")),
            ("far away".to_owned(), set("z_min")),
        ]
        .into(),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("z_min") }],
        fixed: vec![set("upper z_max")],
        // Each lip goes along with what holds it.
        allow_unfixed: true,
        ..case_of(mesh, material(15.0, 0.3))
    }
}

#[test]
fn a_mesh_of_doubled_cells_is_refused_for_these_and_not_for_its_skin() {
    let single = || block(Vector::new(30.0, 24.0, 6.0), [5, 4, 2], CellShape::Hex8);
    let skin = |mesh: VolumeMesh, skin| Case {
        skin,
        fixed: vec![set("z_min")],
        ..case_of(mesh, material(15.0, 0.3))
    };
    let doubled = |from: usize| {
        let (mut mesh, once) = (single(), single());
        for (shape, nodes) in once.cells.iter().skip(from) {
            mesh.cells.push(shape, nodes);
        }
        mesh
    };
    let problems = |case: &Case| {
        let scene = Scene::new(case, &Plan::default(), &exact());
        let found = scene.err().map_or_else(Vec::new, |errors| errors.0);
        let told = |problem: &SceneError| {
            (
                problem.pointer.clone(),
                problem.code,
                problem.detail.contains("cells have the nodes of"),
            )
        };
        found.iter().map(told).collect::<Vec<_>>()
    };
    let all = || Some(set("z_max"));
    assert_eq!(problems(&skin(single(), all())), []);
    let no_boundary = ("/case/volume".to_owned(), SceneErrorCode::MeshDegenerate, true);
    for stated in [all(), None] {
        assert_eq!(problems(&skin(doubled(0), stated)), std::slice::from_ref(&no_boundary));
    }
    // The upper layer alone.
    let no_skin = ("/case/skin".to_owned(), SceneErrorCode::EmptySelection, true);
    assert_eq!(problems(&skin(doubled(20), all())), [no_skin]);
}

#[test]
fn a_lip_pushed_into_the_other_is_reported_with_how_deep_it_reaches() {
    let case = lips(1.0);
    assert_eq!(told(&solve(&case, &lifted("jaw", 0.9), &exact()).warnings, "skin-overlaps"), None);
    let found = solve(&case, &lifted("jaw", 3.0), &exact()).warnings;
    let warning = told(&found, "skin-overlaps").expect("2 mm deep");
    assert!(number(warning, "pairs") > 10.0, "{warning:?}");
    assert_eq!(number(warning, "pairs_at_rest"), 0.0);
    // Solved to 1e-13.
    assert!((number(warning, "depth_mm") - 2.0).abs() < 1e-6, "{warning:?}");
    // The end of the lower lip and that of the upper one lie in each other, with two of the four cells of their sides.
    let area = number(warning, "area_mm2");
    assert!((150.0..500.0).contains(&area), "{warning:?}");
    let z = number(warning, "z_mm");
    assert!((7.0 - 1e-6..=9.0 + 1e-6).contains(&z), "{warning:?}");
    assert!(warning.detail.contains(r#"at "lower lip", "upper lip""#), "{}", warning.detail);
    assert!(!warning.detail.contains("far away"), "{}", warning.detail);
}

#[test]
fn triangles_that_crossed_at_rest_are_not_told_as_new() {
    let case = lips(-0.5);
    assert_eq!(told(&solve(&case, &Plan::default(), &exact()).warnings, "skin-overlaps"), None);
    let found = solve(&case, &lifted("jaw", 4.0), &exact()).warnings;
    let warning = told(&found, "skin-overlaps").expect("4.5 mm deep, of which .5 at rest");
    assert!(number(warning, "pairs_at_rest") > 10.0, "{warning:?}");
    assert!((number(warning, "depth_mm") - 4.0).abs() < 1e-6, "{warning:?}");
}

#[test]
fn skin_that_crosses_at_rest_and_hardly_moves_is_not_told_to_be_deep() {
    let case = lips(-0.5);
    for (by, is_told) in [(1e-3, false), (0.1, true)] {
        let found = solve(&case, &lifted("jaw", by), &exact()).warnings;
        let depth = told(&found, "skin-overlaps").map(|warning| number(warning, "depth_mm"));
        assert!(depth.is_none_or(|depth| is_told && depth < by + 1e-6), "{by}: {depth:?}");
    }
}

#[test]
fn every_method_tells_of_skin_that_passes_through_itself() {
    use mechanics::model::thickness_warp::ThicknessWarp;
    use mechanics::prediction::Method;
    for method in [Method::FemLinear, Method::ThicknessWarp(ThicknessWarp::default())] {
        let settings = Settings { method: method.clone(), ..Settings::default() };
        let found = solve(&lips(1.0), &lifted("jaw", 3.0), &settings).warnings;
        assert!(told(&found, "skin-overlaps").is_some(), "{method:?}");
    }
}

fn warnings(case: &Case) -> Vec<Warning> {
    Scene::new(case, &Plan::default(), &Settings::default()).unwrap().warnings
}

/// A slab with two bones under its ends, each named after the set of nodes on it.
fn two_bones() -> Case {
    let mut mesh = block(Vector::new(60.0, 20.0, 10.0), [12, 4, 2], CellShape::Hex8);
    let base = |wanted: fn(f64) -> bool| {
        let on = |node: &u32| {
            mesh.nodes[*node as usize].z == 0.0 && wanted(mesh.nodes[*node as usize].x)
        };
        (0..mesh.nodes.len() as u32).filter(on).collect::<Vec<u32>>()
    };
    let (left, right) = (base(|x| x < 16.0), base(|x| x > 44.0));
    mesh.node_sets.insert("left".to_owned(), left);
    mesh.node_sets.insert("right".to_owned(), right);
    let plate = |corner: f64| {
        let mesh = block(Vector::new(15.0, 20.0, 4.0), [3, 4, 1], CellShape::Hex8);
        let mesh = shifted(mesh, Vector::new(corner, 0.0, -4.3));
        Arc::new(mesh.surface_of(&mesh.boundary_faces()))
    };
    let bone = |name: &str| Bone { name: name.to_owned(), surface: name.to_owned() };
    let segment = |name: &str| CaseSegment { name: name.to_owned(), nodes: set(name) };
    Case {
        bones: vec![bone("left"), bone("right")],
        surfaces: [("left".to_owned(), plate(0.0)), ("right".to_owned(), plate(45.0))].into(),
        segments: vec![segment("left"), segment("right")],
        skin: Some(set("z_max")),
        ..case_of(mesh, material(15.0, 0.3))
    }
}

#[test]
fn segments_whose_sets_are_swapped_are_reported_with_both_distances() {
    let mut case = two_bones();
    assert_eq!(told(&warnings(&case), "segment-far-from-bone"), None);
    case.segments[0].nodes = set("right");
    case.segments[1].nodes = set("left");
    let found = warnings(&case);
    let far: Vec<&Warning> = found.iter().filter(|w| w.code == "segment-far-from-bone").collect();
    assert_eq!(far.len(), 2, "{found:?}");
    // The middle of three or four columns of nodes, 5 mm apart, from a plate that ends 30 mm before the first.
    assert!(number(far[0], "median_mm") > 30.0, "{:?}", far[0]);
    assert!((number(far[0], "closer_median_mm") - 0.3).abs() < 1e-9, "{:?}", far[0]);
    assert!(far[0].detail.contains(r#"segment "left""#), "{}", far[0].detail);
    assert!(far[0].detail.contains(r#"bone "right" is 0.3 mm"#), "{}", far[0].detail);
}

#[test]
fn skin_that_is_held_or_faces_the_bone_is_reported_with_its_share() {
    let mut case = two_bones();
    let found = warnings(&case);
    assert!(
        told(&found, "skin-held").is_none() && told(&found, "skin-inwards").is_none(),
        "{found:?}"
    );
    case.skin = Some(set("z_min"));
    let found = warnings(&case);
    // Four of thirteen columns under each of two bones.
    let held = told(&found, "skin-held").expect("held skin");
    assert!((number(held, "share") - 8.0 / 13.0).abs() < 1e-12, "{held:?}");
    assert_eq!(number(held, "joined"), 40.0);
    case.segments.remove(1);
    case.fixed = vec![set("z_max")];
    case.skin = Some(set("z_max"));
    let found = warnings(&case);
    assert_eq!(number(told(&found, "skin-held").expect("fixed skin"), "fixed"), 65.0);
}

#[test]
fn a_named_region_that_is_held_for_the_most_part_is_told_by_its_name() {
    let mut case = two_bones();
    let skin = case.skin.clone().expect("a named skin");
    case.skin_regions = [("lips".to_owned(), skin), ("chin".to_owned(), set("chin"))].into();
    let mesh = Arc::make_mut(&mut case.volume);
    let chin: Vec<u32> = mesh.node_set("z_max").unwrap()[..6].to_vec();
    mesh.node_sets.insert("chin".to_owned(), chin.clone());
    mesh.node_sets.insert("stitched".to_owned(), chin[..3].to_vec());
    case.fixed.push(set("stitched"));
    assert_eq!(told(&warnings(&case), "skin-held"), None, "half of it");
    Arc::make_mut(&mut case.volume).node_sets.insert("stitched".to_owned(), chin[..4].to_vec());
    let found = warnings(&case);
    let held = told(&found, "skin-held").expect("a held region");
    assert_eq!(held.numbers, [("nodes", 4.0), ("regions", 1.0)]);
    assert!(held.detail.contains(r#"4 of 6 of "chin""#), "{}", held.detail);
}

#[test]
fn a_skin_that_faces_what_holds_the_tissue_is_reported() {
    // A sheet above a bone of its own: the side that looks at it is the inner one.
    let sheet = block(Vector::new(40.0, 40.0, 4.0), [8, 8, 2], CellShape::Hex8);
    let bone = block(Vector::new(40.0, 40.0, 4.0), [8, 8, 2], CellShape::Hex8);
    let mut mesh = beside(shifted(sheet, Vector::new(0.0, 0.0, 10.0)), &bone, "bone");
    let rim: Vec<u32> = mesh.node_sets["x_min"].clone();
    mesh.node_sets.insert("rim".to_owned(), rim);
    let held = ["rim", "bone z_max", "bone z_min"].map(set).to_vec();
    let case = |skin: &str| Case {
        skin: Some(set(skin)),
        fixed: held.clone(),
        ..case_of(mesh.clone(), material(15.0, 0.3))
    };
    let inner = warnings(&case("z_min"));
    let warning = told(&inner, "skin-inwards").expect("the side that looks down");
    assert!(number(warning, "share") > 0.5, "{warning:?}");
    assert_eq!(told(&warnings(&case("z_max")), "skin-inwards"), None);
}

#[test]
fn a_skin_that_nobody_named_is_reported_with_its_area_and_its_parts() {
    let mut case = two_bones();
    case.skin = None;
    let found = warnings(&case);
    let unnamed = told(&found, "skin-unnamed").expect("no skin is named");
    // The top and four sides, of which only the faces that touch no held node count, and what is free below.
    assert_eq!(number(unnamed, "parts"), 6.0);
    let area = number(unnamed, "area_mm2");
    assert!((number(unnamed, "share_of_largest") * area - 1200.0).abs() < 1e-9, "{unnamed:?}");
    case.skin = Some(set("z_max"));
    assert_eq!(told(&warnings(&case), "skin-unnamed"), None);
}
