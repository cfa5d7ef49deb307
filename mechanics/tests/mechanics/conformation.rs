//! Conformation of a template to a patient of which every node is known.

use mechanics::conformation::{
    ConformationError, Landmark, Patient, Start, Template, carried, conform,
};
use mechanics::mesh::sample::{ThickSphere, thick_sphere_octant};
use mechanics::mesh::{CellShape, SurfaceSearch, TriangleSurface, Vector, VolumeMesh};
use mechanics::progress::Unobserved;

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
    let squares: f64 = found.skin_distances.iter().map(|d| d * d).sum();
    let rms = (squares / found.skin_distances.len() as f64).sqrt();
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
    let squares: f64 = found.skin_distances.iter().map(|d| d * d).sum();
    let rms = (squares / found.skin_distances.len() as f64).sqrt();
    assert!(rms < 0.55, "rms {rms} mm");
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
