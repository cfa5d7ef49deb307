//! Conformation of a template to a patient of which every node is known.

use std::sync::atomic::{AtomicUsize, Ordering};

use mechanics::conformation::{
    ConformationError, Landmark, Patient, Start, Template, carried, conform,
};
use mechanics::mesh::sample::{ThickSphere, thick_sphere_octant};
use mechanics::mesh::{CellShape, SurfaceSearch, TriangleSurface, Vector, VolumeMesh};
use mechanics::progress::{Phase, Progress, Unobserved};
use nalgebra::Rotation3;

fn template() -> VolumeMesh {
    let sphere =
        ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 2, cells_along: 8 };
    let mut mesh = thick_sphere_octant(sphere, CellShape::Hex8);
    // A round octant has no principal axes.
    mesh.nodes.iter_mut().for_each(|x| x.component_mul_assign(&Vector::new(1.0, 0.8, 0.6)));
    mesh
}

/// A turn of 20 degrees, a stretch by 1.1 and a smooth warp of up to 6 mm.
fn warp(x: &Vector) -> Vector {
    let (sin, cos) = 20f64.to_radians().sin_cos();
    let turned = Vector::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z) * 1.1;
    let wave = Vector::new((x.y / 30.0).sin(), (x.z / 30.0).sin(), (x.x / 30.0).cos());
    turned + wave * 3.5 + Vector::new(400.0, -20.0, 30.0)
}

fn surface(mesh: &VolumeMesh, set: &str) -> TriangleSurface {
    let nodes = &mesh.node_sets[set];
    let faces = mesh.boundary_faces();
    let on = |node: &u32| nodes.binary_search(node).is_ok();
    let faces: Vec<_> = faces.into_iter().filter(|face| face.nodes().iter().all(on)).collect();
    mesh.surface_of(&faces)
}

fn landmarks(mesh: &VolumeMesh, step: usize) -> Vec<Landmark> {
    let nodes = mesh.node_sets["outer"].iter().step_by(step);
    let pair = |&node: &u32| {
        let place = mesh.nodes[node as usize];
        Landmark { name: format!("node {node}"), template: place, patient: warp(&place) }
    };
    nodes.map(pair).collect()
}

/// Somebody who asks the work to stop after so many rounds of the free-form deformation.
struct StopsAfterRounds(usize, AtomicUsize);

impl Progress for StopsAfterRounds {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn step(&self, done: usize, _of: usize) {
        self.1.store(done, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.1.load(Ordering::Relaxed) >= self.0
    }
}

#[test]
fn a_conformation_that_is_cancelled_ends_after_the_round_it_is_in() {
    let twin = Twin::new();
    for rounds in [0, 3] {
        let progress = StopsAfterRounds(rounds, AtomicUsize::new(0));
        let skin = surface(&twin.patient, "outer");
        let patient = Patient { skin: Some(&skin), bone: None, landmarks: &[] };
        let ended = conform(&twin.sheets(), &patient, Start::Auto, &progress);
        let Err(error) = ended else { panic!("it was not cancelled") };
        assert!(
            matches!(error, ConformationError::Cancelled { rounds: own } if own == rounds),
            "{error}"
        );
    }
}

struct Twin {
    template: VolumeMesh,
    patient: VolumeMesh,
}

impl Twin {
    fn new() -> Twin {
        let template = template();
        let mut patient = template.clone();
        patient.nodes.iter_mut().for_each(|x| *x = warp(x));
        Twin { template, patient }
    }

    fn sheets(&self) -> Template<'_> {
        let sets = &self.template.node_sets;
        Template { mesh: &self.template, skin: &sets["outer"], bone: &sets["inner"] }
    }

    fn error(&self, landmarks: &[Landmark], skin: &TriangleSurface) -> ConformationError {
        let patient = Patient { skin: Some(skin), bone: None, landmarks };
        conform(&self.sheets(), &patient, Start::Auto, &Unobserved).unwrap_err()
    }
}

#[test]
fn landmarks_skin_and_bone_bring_every_node_within_a_millimetre_and_the_skin_to_three_tenths() {
    let twin = Twin::new();
    let (skin, bone) = (surface(&twin.patient, "outer"), surface(&twin.patient, "inner"));
    let landmarks = landmarks(&twin.template, 11);
    let patient = Patient { skin: Some(&skin), bone: Some(&bone), landmarks: &landmarks };
    let found = conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap();
    let moved = carried(&twin.template, &found.deformation);
    let errors = moved.nodes.iter().zip(&twin.patient.nodes).map(|(a, b)| (a - b).norm());
    let mean = errors.sum::<f64>() / moved.nodes.len() as f64;
    assert!(mean < 1.0, "mean {mean} mm");
    let rms = rms(&found.skin_distances);
    assert!(rms < 0.3, "rms {rms} mm");
    assert!(found.landmark_distances.iter().all(|&left| left < 0.5));
    // What is told is what a search finds.
    let search = SurfaceSearch::new(&skin).unwrap();
    let node = twin.template.node_sets["outer"][5] as usize;
    let told = search.closest(&moved.nodes[node]).distance;
    assert!((found.skin_distances[5] - told).abs() < 1e-9);
}

#[test]
fn surfaces_alone_meet_the_skin_from_axes_of_inertia() {
    let twin = Twin::new();
    let skin = surface(&twin.patient, "outer");
    let patient = Patient { skin: Some(&skin), bone: None, landmarks: &[] };
    let found = conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap();
    let rms = rms(&found.skin_distances);
    assert!(rms < 0.55, "rms {rms} mm");
}

/// Root of the mean square of distances in mm.
fn rms(distances: &[f64]) -> f64 {
    (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt()
}

#[test]
fn boxes_start_what_lies_as_the_patient_does_wherever_it_lies() {
    let twin = Twin::new();
    // Larger and elsewhere, but not turned: the wave alone is left to fit.
    let mut skin = surface(&twin.template, "outer");
    let place = |x: &Vector| {
        let wave = Vector::new((x.y / 30.0).sin(), (x.z / 30.0).sin(), (x.x / 30.0).cos());
        x * 1.3 + wave * 2.0 + Vector::new(-700.0, 90.0, 12.0)
    };
    skin.points.iter_mut().for_each(|x| *x = place(x));
    let patient = Patient { skin: Some(&skin), bone: None, landmarks: &[] };
    let found = conform(&twin.sheets(), &patient, Start::Boxes, &Unobserved).unwrap();
    assert!(rms(&found.skin_distances) < 0.3, "{} mm", rms(&found.skin_distances));
    // Nodes are where they belong along the skin too, since nothing was turned.
    let moved = carried(&twin.template, &found.deformation);
    let off = |node: u32| {
        (moved.nodes[node as usize] - place(&twin.template.nodes[node as usize])).norm()
    };
    let off: Vec<f64> = twin.template.node_sets["outer"].iter().map(|&node| off(node)).collect();
    assert!(rms(&off) < 2.5, "{} mm", rms(&off));
}

#[test]
fn directions_turn_with_the_tissue_and_keep_their_length() {
    let mut twin = Twin::new();
    let fibres = vec![Vector::new(2.0, 0.0, 0.0); twin.template.cells.len()];
    twin.template.cell_vectors.insert("fibre".to_owned(), fibres);
    let (sin, cos) = 90f64.to_radians().sin_cos();
    let turn = |x: &Vector| Vector::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z) * 1.2;
    let mut landmarks = landmarks(&twin.template, 5);
    landmarks.iter_mut().for_each(|one| one.patient = turn(&one.template));
    let patient = Patient { skin: None, bone: None, landmarks: &landmarks };
    let found = conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap();
    let moved = carried(&twin.template, &found.deformation);
    for fibre in &moved.cell_vectors["fibre"] {
        assert!((fibre - Vector::new(0.0, 2.0, 0.0)).norm() < 0.05, "{fibre}");
    }
    assert_eq!(moved.node_sets, twin.template.node_sets);
}

#[test]
fn a_mirrored_patient_is_named() {
    let twin = Twin::new();
    let mirror = |x: &Vector| Vector::new(-x.x, x.y, x.z);
    let mut skin = surface(&twin.patient, "outer");
    skin.points.iter_mut().for_each(|x| *x = mirror(x));
    let mut landmarks = landmarks(&twin.template, 11);
    landmarks.iter_mut().for_each(|one| one.patient = mirror(&one.patient));
    let error = twin.error(&landmarks, &skin);
    assert!(matches!(error, ConformationError::Mirrored { .. }), "{error}");
}

#[test]
fn two_exchanged_landmarks_are_named() {
    let twin = Twin::new();
    let skin = surface(&twin.patient, "outer");
    let mut landmarks = landmarks(&twin.template, 5);
    let first = landmarks[0].patient;
    let last = landmarks.len() - 1;
    landmarks[0].patient = landmarks[last].patient;
    landmarks[last].patient = first;
    let ConformationError::Exchanged { one, other, .. } = twin.error(&landmarks, &skin) else {
        panic!("not exchanged");
    };
    assert_eq!([one, other], [landmarks[0].name.clone(), landmarks[last].name.clone()]);
}

#[test]
fn landmarks_shifted_together_are_named_and_no_exchange_is_told() {
    let twin = Twin::new();
    // A mouth 8 mm to the side, without the middle of its upper lip, beside which a ridge then lies.
    let turn = Rotation3::new(Vector::new(0.1, -0.2, 0.15));
    let lip = [("ridge left", 5.0), ("ridge right", -5.0), ("lip", 0.0)].map(|(name, x)| {
        let template = Vector::new(x, -90.0, -22.0);
        Landmark { name: name.to_owned(), template, patient: template }
    });
    let mut landmarks: Vec<Landmark> = face_points().into_iter().chain(lip).collect();
    landmarks.iter_mut().for_each(|own| own.patient = turn * own.template * 1.05);
    let is_shifted = |name: &str| {
        ["point 4", "point 9", "point 10", "ridge left", "ridge right"].contains(&name)
    };
    for own in landmarks.iter_mut().filter(|own| is_shifted(&own.name)) {
        own.patient += turn * Vector::x() * 8.0;
    }
    let patient = Patient { skin: None, bone: None, landmarks: &landmarks };
    let told = conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap_err();
    let ConformationError::Misplaced { name, left, place, near, others } = &told else {
        panic!("{told}")
    };
    assert_eq!([name.as_str(), place.as_str()], ["ridge right", "lip"], "{told}");
    assert!(*left > 2.0 * near, "{told}");
    for other in ["point 9", "point 10", "ridge left"] {
        assert!(others.contains(&format!("{other:?} by ")), "{told}");
    }
    assert!(!told.to_string().contains("if they are exchanged"), "{told}");
}

/// Twelve points about a face, of which a twin has others by 4 mm.
fn face_points() -> Vec<Landmark> {
    let places: [[f64; 3]; 12] = [
        [0.0, -60.0, 80.0],
        [0.0, -80.0, 40.0],
        [0.0, -95.0, 0.0],
        [0.0, -85.0, -20.0],
        [0.0, -84.0, -30.0],
        [0.0, -78.0, -55.0],
        [0.0, -60.0, -70.0],
        [40.0, -70.0, 40.0],
        [-40.0, -70.0, 40.0],
        [25.0, -72.0, -25.0],
        [-25.0, -72.0, -25.0],
        [60.0, 0.0, -40.0],
    ];
    let turn = Rotation3::new(Vector::new(0.1, -0.2, 0.15));
    let landmark = |(number, place): (usize, &[f64; 3])| {
        let template = Vector::from(*place);
        let wave = (0.05 * (place[0] + 2.0 * place[2]) + number as f64).sin();
        let patient = turn * template * 1.05 + Vector::new(2.0, -2.0, 3.0) * wave;
        Landmark { name: format!("point {number}"), template, patient }
    };
    places.iter().enumerate().map(landmark).collect()
}

#[test]
fn landmarks_that_stand_at_others_are_named_however_far_apart_they_are() {
    let twin = Twin::new();
    let error = |landmarks: &[Landmark]| {
        let patient = Patient { skin: None, bone: None, landmarks };
        conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap_err()
    };
    let sound = face_points();
    // The hairline and the chin, which turn the similarity of all over.
    let mut swapped = sound.clone();
    (swapped[0].patient, swapped[6].patient) = (sound[6].patient, sound[0].patient);
    let told = error(&swapped);
    let ConformationError::Exchanged { one, other, apart, exchanged } = &told else {
        panic!("{told}")
    };
    assert_eq!([one.as_str(), other.as_str()], ["point 0", "point 6"]);
    assert!(*apart > 20.0 && *exchanged < 6.0, "{told}");
    // Three of them, around.
    let mut around = sound.clone();
    around[0].patient = sound[11].patient;
    around[11].patient = sound[2].patient;
    around[2].patient = sound[0].patient;
    let told = error(&around);
    let ConformationError::Permuted { names, after, .. } = &told else { panic!("{told}") };
    assert_eq!(
        names,
        "\"point 0\" at \"point 2\", \"point 2\" at \"point 11\", \"point 11\" at \"point 0\""
    );
    assert!(*after < 6.0, "{told}");
    // One that is nobody's place is no permutation.
    let mut away = sound.clone();
    away[0].patient += Vector::new(0.0, 120.0, 60.0);
    let told = error(&away);
    assert!(matches!(told, ConformationError::Unlike { .. }), "{told}");
}

#[test]
fn a_patient_in_metres_is_named_with_the_scale() {
    let twin = Twin::new();
    let mut skin = surface(&twin.patient, "outer");
    skin.points.iter_mut().for_each(|x| *x /= 1000.0);
    let ConformationError::Scale { scale } = twin.error(&[], &skin) else { panic!("no scale") };
    assert!((scale - 0.0011).abs() < 2e-4, "{scale}");
}

#[test]
fn nothing_to_fit_is_an_error() {
    let twin = Twin::new();
    let patient = Patient { skin: None, bone: None, landmarks: &[] };
    let error = conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap_err();
    assert_eq!(error, ConformationError::NothingToFit);
}

/// A round piece of a surface, so far before it.
fn sheet_before(skin: &TriangleSurface, middle: usize, radius: f64, by: f64) -> TriangleSurface {
    let (at, normals) = (skin.points[middle], skin.point_normals());
    let is_near = |corner: &u32| (skin.points[*corner as usize] - at).norm() < radius;
    let near = skin.triangles.iter().filter(|corners| corners.iter().any(is_near)).copied();
    let points: Vec<Vector> = skin.points.iter().map(|x| x + normals[middle] * by).collect();
    TriangleSurface { points, triangles: near.collect(), node_ids: None }
}

fn together(one: &TriangleSurface, other: &TriangleSurface) -> TriangleSurface {
    let first = one.points.len() as u32;
    let moved = other.triangles.iter().map(|corners| corners.map(|corner| corner + first));
    TriangleSurface {
        points: one.points.iter().chain(&other.points).copied().collect(),
        triangles: one.triangles.iter().copied().chain(moved).collect(),
        node_ids: None,
    }
}

/// It once pulled the template by 11 mm to a sheet 15 mm before the skin.
#[test]
fn a_dressing_before_the_skin_of_a_scan_pulls_nothing_and_is_told() {
    let twin = Twin::new();
    let skin = surface(&twin.patient, "outer");
    let landmarks = landmarks(&twin.template, 11);
    let middle = skin.points.len() / 2;
    let fitted = |skin: &TriangleSurface| {
        let patient = Patient { skin: Some(skin), bone: None, landmarks: &landmarks };
        conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap()
    };
    let clean = fitted(&skin);
    assert_eq!(clean.covering.area_mm2, 0.0);
    for by in [5.0, 15.0, 40.0] {
        let sheet = sheet_before(&skin, middle, 15.0, by);
        let found = fitted(&together(&skin, &sheet));
        let nodes = twin.template.nodes.iter();
        let apart = nodes.map(|x| (found.deformation.apply(x) - clean.deformation.apply(x)).norm());
        let most = apart.fold(0.0, f64::max);
        println!("{by} mm: {most:.3} mm, {:?}", found.covering);
        assert!(most < 0.3, "{by} mm: {most}");
        assert!((found.covering.area_mm2 / sheet.area() - 1.0).abs() < 0.1, "{:?}", found.covering);
    }
}

/// One of them 15 mm along the skin once pulled the template there by as much, without a word.
#[test]
fn a_landmark_elsewhere_than_the_others_say_is_left_out_and_correct_ones_are_not_doubted() {
    let twin = Twin::new();
    let skin = surface(&twin.patient, "outer");
    let search = SurfaceSearch::new(&skin).unwrap();
    let right = landmarks(&twin.template, 5);
    let fitted = |landmarks: &[Landmark]| {
        let patient = Patient { skin: Some(&skin), bone: None, landmarks };
        conform(&twin.sheets(), &patient, Start::Auto, &Unobserved).unwrap()
    };
    assert_eq!(fitted(&right).doubtful, []);
    for (wrong, by) in [(3, 15.0), (7, 10.0), (11, 25.0)] {
        let mut landmarks = right.clone();
        let name = landmarks[wrong].name.clone();
        let before = landmarks[wrong].patient;
        landmarks[wrong].patient = search.closest(&(before + Vector::new(by, -by, by))).point;
        let moved = (landmarks[wrong].patient - before).norm();
        let found = fitted(&landmarks);
        println!("{moved:.1} mm: {:?}", found.doubtful);
        let [doubtful] = &found.doubtful[..] else { panic!("{:?}", found.doubtful) };
        assert!(doubtful.is_left_out && found.leaves_out(&name), "{doubtful:?}");
        assert!((doubtful.distance - moved).abs() < 3.0, "{doubtful:?} of {moved}");
        landmarks.remove(wrong);
        assert_eq!(found.deformation, fitted(&landmarks).deformation);
    }
}
