//! A plate of tissue on bone that a cut parts.

use mechanics::boundary::NodeSelection;
use mechanics::domain::Boundary;
use mechanics::material::LinearElastic;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::osteotomy::bone_labels::NearestBone;
use mechanics::osteotomy::classes::{
    BoneContact, ClassRules, NodeClasses, Role, TissueBoundary, classify,
};
use mechanics::osteotomy::{BoneImage, Cut, Osteotomy, Owner, Side, label};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Case, CaseSegment, Plan, Scene, Settings, predict};
use mechanics::progress::Unobserved;

use super::labelling::{plane, scan, segment};

/// 40 x 24 x 12 mm of tissue in cells of 2 mm; its lower face is on bone, its ends are cuts, the rest is skin.
fn plate() -> (VolumeMesh, Vec<Option<Boundary>>) {
    let mesh = block(Vector::new(40.0, 24.0, 12.0), [20, 12, 6], CellShape::Tet4);
    let mark = |x: &Vector| match x {
        x if x.z == 0.0 => Some(Boundary::Bone),
        x if x.x == 0.0 || x.x == 40.0 => Some(Boundary::Cut),
        x if x.z == 12.0 || x.y == 0.0 || x.y == 24.0 => Some(Boundary::Skin),
        _ => None,
    };
    let marks = mesh.nodes.iter().map(mark).collect();
    (mesh, marks)
}

/// Of the jaw for x above 20 mm.
fn jaw_behind(place: &Vector, outward: &Vector) -> Option<NearestBone> {
    let owner = if place.x > 20.0 { Owner::Segment(0) } else { Owner::Rest };
    (outward.z < -0.9).then_some(NearestBone { owner, distance: 0.5 })
}

fn rules(band_mm: f64) -> ClassRules {
    ClassRules { movements: vec![1], band_mm, scan_ends_fixed: false, fixed_above: None }
}

fn found(rules: &ClassRules, slides: &dyn Fn(&Vector) -> bool) -> NodeClasses {
    let (mesh, marks) = plate();
    let bone = BoneContact { behind: &jaw_behind, slides };
    classify(TissueBoundary { mesh: &mesh, marks: &marks }, &bone, rules)
}

fn nowhere(_: &Vector) -> bool {
    false
}

#[test]
fn every_node_has_one_class_and_the_sets_are_these_classes() {
    let classes = found(&ClassRules { scan_ends_fixed: true, ..rules(3.0) }, &|x| x.y > 20.0);
    let (mesh, marks) = plate();
    let sets = classes.node_sets(&["jaw".to_owned()]);
    let mut seen = vec![0; mesh.nodes.len()];
    sets.values().flatten().for_each(|&node| seen[node as usize] += 1);
    assert!(seen.iter().all(|&times| times <= 1));
    let held: usize = sets.values().map(Vec::len).sum();
    assert_eq!(held + classes.count(Role::Free), mesh.nodes.len());
    let names: Vec<&str> = sets.keys().map(String::as_str).collect();
    assert_eq!(names, ["fixed", "jaw", "sliding_jaw", "sliding_rest"]);
    for (node, place) in mesh.nodes.iter().enumerate() {
        match classes.roles[node] {
            Role::Joined(segment) => assert!(segment == 0 && place.x > 20.0 && place.z == 0.0),
            Role::Fixed => assert!(marks[node] == Some(Boundary::Cut) || place.x < 20.0),
            Role::Sliding(on) => assert!(place.y > 20.0 && on.is_some() == (place.x > 20.0)),
            Role::Free => {}
        }
    }
    assert_eq!(classes.without_bone, 0);
}

#[test]
fn held_nodes_that_move_apart_are_never_nearer_than_the_band_nor_in_one_cell() {
    let (mesh, _) = plate();
    for band_mm in [0.0, 1.0, 3.0, 7.0] {
        let classes = found(&rules(band_mm), &nowhere);
        let jaw = |node: usize| matches!(classes.roles[node], Role::Joined(_));
        let fixed = |node: usize| classes.roles[node] == Role::Fixed;
        let places = |holds: &dyn Fn(usize) -> bool| -> Vec<Vector> {
            (0..mesh.nodes.len()).filter(|&n| holds(n)).map(|n| mesh.nodes[n]).collect()
        };
        let [moved, still] = [places(&jaw), places(&fixed)];
        let nearest = moved.iter().flat_map(|a| still.iter().map(move |b| (a - b).norm()));
        assert!(nearest.fold(f64::INFINITY, f64::min) > band_mm.max(2.0), "{band_mm}");
        assert!(mesh.cells.iter().all(|(_, nodes)| {
            let has = |holds: &dyn Fn(usize) -> bool| nodes.iter().any(|&n| holds(n as usize));
            !(has(&jaw) && has(&fixed))
        }));
        assert!(classes.in_band >= 26, "two rows of 13 nodes, {}", classes.in_band);
    }
}

#[test]
fn segments_that_move_alike_need_no_band_between_them() {
    let alike = found(&ClassRules { movements: vec![0], ..rules(3.0) }, &nowhere);
    assert_eq!(alike.in_band, 0);
    let bone_nodes = 21 * 13;
    assert_eq!(alike.count(Role::Joined(0)) + alike.count(Role::Fixed), bone_nodes);
}

#[test]
fn a_joined_node_in_the_fixed_part_stays_joined_and_is_counted() {
    let fixed_above = Some(plane([0.0, 21.0, 0.0], [0.0, 1.0, 0.0]));
    let rules = ClassRules { movements: vec![0], fixed_above, ..rules(0.0) };
    let classes = found(&rules, &|x| x.x > 30.0);
    let (mesh, _) = plate();
    let beyond = (0..mesh.nodes.len()).filter(|&n| mesh.nodes[n].y > 21.0);
    let (joined, fixed): (Vec<usize>, Vec<usize>) =
        beyond.partition(|&n| classes.roles[n] == Role::Joined(0));
    assert!(fixed.iter().all(|&n| classes.roles[n] == Role::Fixed));
    // Rows at y = 22 and 24: x = 22 to 30 are joined, x = 32 to 40 would slide.
    assert_eq!(joined.len(), 10);
    let [warning] = &classes.warnings[..] else { panic!("{:?}", classes.warnings) };
    assert_eq!(warning.code, "conditions-overlap");
    assert_eq!(warning.numbers, [("joined", 10.0), ("sliding", 10.0)]);
}

#[test]
fn a_node_on_bone_that_is_not_there_is_free_and_counted() {
    let (mesh, marks) = plate();
    let bone = BoneContact { behind: &|_, _| None, slides: &nowhere };
    let classes = classify(TissueBoundary { mesh: &mesh, marks: &marks }, &bone, &rules(3.0));
    assert_eq!(classes.without_bone, 21 * 13);
    assert_eq!(classes.count(Role::Free), mesh.nodes.len());
}

/// Bone below z = 0 under the plate, cut at x = 19 mm; what is beyond moves.
#[test]
fn every_joined_node_carries_the_movement_of_its_segment() {
    let image = scan([44, 28, 8], |x| if x.z < 9.0 { 1000.0 } else { 0.0 });
    let cut = Cut::unbounded("cut", plane([19.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
    let osteotomy = Osteotomy::new(vec![cut], vec![segment("jaw", &[(0, Side::Above)], &[])]);
    let bone = BoneImage { image: &image, threshold: 200.0 };
    let labels = label(&bone, &osteotomy.unwrap()).unwrap().labels;
    let (mut mesh, marks) = plate();
    mesh.nodes.iter_mut().for_each(|x| *x += Vector::new(0.0, 0.0, 9.0));
    let behind = |place: &Vector, ahead: &Vector| labels.nearest(place, ahead, 3.0);
    let contact = BoneContact { behind: &behind, slides: &nowhere };
    let classes = classify(TissueBoundary { mesh: &mesh, marks: &marks }, &contact, &rules(3.0));
    assert_eq!(classes.without_bone, 0);
    mesh.node_sets = classes.node_sets(&["jaw".to_owned()]);
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let case = Case {
        volume: mesh.clone().into(),
        materials: [("*".to_owned(), LinearElastic::new(15.0, 0.46, 1.0).unwrap())].into(),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("jaw") }],
        fixed: vec![set("fixed")],
        ..Case::default()
    };
    let [pivot, shift] = [Vector::new(30.0, 10.0, 0.0), Vector::new(3.0, 0.0, 1.0)];
    let movement = RigidMovement::about_pivot(Vector::new(0.02, 0.0, 0.05), pivot, shift);
    let planned = PlannedSegment { name: "jaw".to_owned(), movement };
    let plan = Plan { segments: vec![planned], ..Plan::default() };
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let prediction = predict(&scene, &Unobserved).unwrap();
    let mut joined = 0;
    for (node, place) in mesh.nodes.iter().enumerate() {
        let u = prediction.displacement[node];
        match classes.roles[node] {
            Role::Joined(_) => {
                joined += 1;
                assert!((place + u - movement.apply(place)).norm() < 1e-9, "{node}");
            }
            Role::Fixed => assert_eq!(u, Vector::zeros()),
            Role::Sliding(_) | Role::Free => {}
        }
    }
    assert!(joined > 100, "{joined}");
    assert!(prediction.warnings.iter().all(|warning| warning.code != "tearing"));
}
