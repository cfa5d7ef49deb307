//! Muscles and fibres of the generic face, brought to a twin of which the map is known.

use mechanics::conformation::{
    Landmark, Patient, Start, Template, Warp, angle_between, carried, cell_axes, conform,
    fibre_difference, mapped_lines, mapped_surface, spline_of,
};
use mechanics::mesh::generic_face::{FaceMuscle, FaceSettings, GenericFace, Lips, generic_face};
use mechanics::mesh::surface_edges::count_edges;
use mechanics::mesh::{CellShape, TriangleSurface, Vector, VolumeMesh};
use mechanics::muscle::strap::box_surface;
use mechanics::progress::Unobserved;
use mechanics::registration::ThinPlateSpline;
use nalgebra::{Matrix3, Rotation3};

/// A known map: a turn of 12 degrees, stretches of 1.12, 1.06 and 1.09, and waves of 3 mm.
struct Twin;

impl Twin {
    const WAVES: [[f64; 3]; 3] = [[0.0, 0.04, 0.05], [0.045, 0.0, 0.04], [0.04, 0.05, 0.0]];

    fn matrix() -> Matrix3<f64> {
        let turn = Rotation3::new(Vector::new(0.1, 0.05, 0.18));
        turn.matrix() * Matrix3::from_diagonal(&Vector::new(1.12, 1.06, 1.09))
    }
}

impl Warp for Twin {
    fn apply(&self, x: &Vector) -> Vector {
        let wave = |k: &[f64; 3]| 3.0 * (Vector::from(*k).dot(x)).sin();
        Twin::matrix() * x + Vector::from_iterator(Twin::WAVES.iter().map(wave))
    }

    fn gradient(&self, x: &Vector) -> Matrix3<f64> {
        let row = |k: &[f64; 3]| {
            let k = Vector::from(*k);
            (k * (3.0 * k.dot(x).cos())).transpose()
        };
        Twin::matrix() + Matrix3::from_rows(&Twin::WAVES.each_ref().map(row))
    }
}

fn face() -> GenericFace {
    generic_face(FaceSettings { lips: Lips::Open, fineness: 1, shape: CellShape::Hex8 })
}

fn nodes_of(mesh: &VolumeMesh, sets: &[&str]) -> Vec<u32> {
    let mut nodes: Vec<u32> = sets.iter().flat_map(|set| &mesh.node_sets[*set]).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// The surface of some nodes of a mesh on the twin.
fn twin_of(mesh: &VolumeMesh, nodes: &[u32]) -> TriangleSurface {
    let on = |node: &u32| nodes.binary_search(node).is_ok();
    let faces = mesh.boundary_faces().into_iter();
    let faces: Vec<_> = faces.filter(|face| face.nodes().iter().all(on)).collect();
    let mut surface = mesh.surface_of(&faces);
    surface.points.iter_mut().for_each(|x| *x = Twin.apply(x));
    surface
}

fn landmarks(face: &GenericFace) -> Vec<Landmark> {
    let pair = |(name, place): (&String, &Vector)| Landmark {
        name: name.clone(),
        template: *place,
        patient: Twin.apply(place),
    };
    face.landmarks.iter().map(pair).collect()
}

fn of_face(face: &GenericFace) -> mechanics::conformation::Conformation {
    let mesh = &face.mesh;
    let (skin, bone) =
        (nodes_of(mesh, &["skin"]), nodes_of(mesh, &["maxilla", "mandible", "skull"]));
    let surfaces = [twin_of(mesh, &skin), twin_of(mesh, &bone)];
    let landmarks = landmarks(face);
    let template = Template { mesh, skin: &skin, bone: &bone };
    let patient =
        Patient { skin: Some(&surfaces[0]), bone: Some(&surfaces[1]), landmarks: &landmarks };
    conform(&template, &patient, Start::Auto, &Unobserved).unwrap()
}

/// Of a muscle against the known map: mean and largest angle in degrees, mean distance in mm.
fn told(name: &str, map: &dyn Warp, muscles: &[FaceMuscle]) -> [f64; 3] {
    let mut all = [0.0_f64; 3];
    for muscle in muscles {
        let off = fibre_difference(map, &Twin, &muscle.lines).unwrap();
        println!(
            "{name} {:<28} {:.2} degrees ({:.1} at most), {:.2} mm",
            muscle.name, off.mean_degrees, off.largest_degrees, off.mean_mm
        );
        all[0] += off.mean_degrees / muscles.len() as f64;
        all[1] = all[1].max(off.largest_degrees);
        all[2] += off.mean_mm / muscles.len() as f64;
    }
    all
}

#[test]
fn muscles_of_the_generic_face_lie_on_its_twin_as_the_known_map_has_them() {
    let face = face();
    let found = of_face(&face);
    let [mean, largest, apart] = told("conformation", &found.deformation, &face.muscles);
    assert!(mean < 1.1 && largest < 4.5 && apart < 0.5, "{mean} {largest} degrees, {apart} mm");
    let spline = spline_of(&landmarks(&face)).unwrap();
    let [by_landmarks, _, farther] = told("landmarks", &spline, &face.muscles);
    assert!(by_landmarks < 5.0 && farther < 3.0, "{by_landmarks} degrees, {farther} mm");
    assert!(mean < by_landmarks && apart < farther);
}

/// A box of 40 by 6 by 5 mm along a line from the cheek to the mouth: its centre, and the ways to the middles of three faces.
fn cheek_box() -> (Vector, [Vector; 3]) {
    let half_axes =
        [Vector::new(-8.0, -14.0, -12.0), Vector::new(2.6, -1.5, 0.0), Vector::new(0.8, 1.4, -2.2)];
    (Vector::new(30.0, -62.0, -8.0), half_axes)
}

#[test]
fn a_box_of_a_muscle_becomes_a_closed_surface_that_bends_with_the_tissue() {
    let (centre, half_axes) = cheek_box();
    let own = box_surface(centre, half_axes);
    let known = mapped_surface(&Twin, &own);
    assert!(known.triangles.len() > 12 * 64, "{} triangles", known.triangles.len());
    let counts = count_edges(&known.sorted_sides());
    assert_eq!((counts.open, counts.nonmanifold, counts.inconsistent), (0, 0, 0));
    // The volume is the integral of det F over the box: points of Gauss's rule of two points on 8 x 8 x 8 parts.
    let [a, b, c] = half_axes;
    let at = |i: usize| {
        (i / 2) as f64 / 4.0 - 0.875
            + if i.is_multiple_of(2) { -1.0 } else { 1.0 } / (8.0 * 3.0_f64.sqrt())
    };
    let mut integral = 0.0;
    for (i, j, k) in
        (0..16).flat_map(|i| (0..16).flat_map(move |j| (0..16).map(move |k| (i, j, k))))
    {
        let x = centre + a * at(i) + b * at(j) + c * at(k);
        integral += Twin.gradient(&x).determinant() / 4096.0;
    }
    let exact = own.signed_volume() * integral;
    let off = known.signed_volume() / exact - 1.0;
    assert!(off.abs() < 2e-3, "{} mm³, {exact} by the integral", known.signed_volume());
    // Eight corners alone bend nothing.
    let points = own.points.iter().map(|x| Twin.apply(x)).collect();
    let corners = TriangleSurface { points, ..own.clone() };
    assert!((corners.signed_volume() / exact - 1.0).abs() > 5.0 * off.abs());

    let face = face();
    let found = mapped_surface(&of_face(&face).deformation, &own);
    let apart = found.points.iter().zip(&known.points).map(|(one, other)| (one - other).norm());
    // Its corners lie outside the tissue, where nothing is fitted.
    let mean = apart.sum::<f64>() / known.points.len() as f64;
    assert!(mean < 1.5, "{mean} mm");
}

#[test]
fn fibres_of_cells_are_turned_by_the_gradient_of_the_map_and_keep_their_length() {
    let mut face = face();
    let direction = Vector::new(0.0, 0.0, 2.0);
    let fibres = vec![direction; face.mesh.cells.len()];
    face.mesh.cell_vectors.insert("fibre".to_owned(), fibres);
    let found = of_face(&face);
    let moved = carried(&face.mesh, &found.deformation);
    let axes = cell_axes(&found.deformation, &face.mesh, &direction);
    assert_eq!(moved.cell_vectors["fibre"], axes);
    let known = cell_axes(&Twin, &face.mesh, &direction);
    let off: Vec<f64> = axes.iter().zip(&known).map(|(a, b)| angle_between(a, b)).collect();
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    assert!(mean < 3.0, "{mean} degrees");
    assert!(axes.iter().all(|axis| (axis.norm() - 2.0).abs() < 1e-12));
    // The nearest rotation would leave out what the map shears: here 2 to 8 degrees.
    let turned = Rotation3::from_matrix(&Twin::matrix()) * direction;
    let known = Twin::matrix() * direction;
    assert!(angle_between(&turned, &known) < 1e-9, "a stretch along axes turns none of them");
    let oblique = Vector::new(1.0, 1.0, 0.0);
    let turned = Rotation3::from_matrix(&Twin::matrix()) * oblique;
    assert!(angle_between(&turned, &(Twin::matrix() * oblique)) > 1.0);
}

struct Stretched(Vector);

impl Warp for Stretched {
    fn apply(&self, x: &Vector) -> Vector {
        x.component_mul(&self.0)
    }

    fn gradient(&self, _: &Vector) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.0)
    }
}

#[test]
fn a_line_has_the_length_and_the_width_that_a_stretch_gives_it() {
    let lines = vec![vec![Vector::zeros(), Vector::new(10.0, 0.0, 0.0)]];
    for (stretch, length, widening) in
        [([1.2, 1.2, 1.2], 12.0, 1.2), ([2.0, 1.0, 1.0], 20.0, 1.0), ([1.0, 4.0, 1.0], 10.0, 2.0)]
    {
        let found = mapped_lines(&Stretched(stretch.into()), &lines, 1000);
        assert!((found.lengths[0] - 10.0).abs() < 1e-12);
        assert!((found.lengths[1] - length).abs() < 1e-12, "{stretch:?}: {:?}", found.lengths);
        assert!((found.widening - widening).abs() < 1e-12, "{stretch:?}: {}", found.widening);
        // 10 mm are four pieces of at most 3 mm, or one where a line may have no more points.
        assert_eq!(found.lines[0].len(), 5);
        assert_eq!(mapped_lines(&Stretched(stretch.into()), &lines, 4).lines[0].len(), 2);
    }
    let none = mapped_lines(&Stretched(Vector::repeat(2.0)), &[vec![Vector::zeros(); 3]], 1000);
    assert_eq!((none.lengths, none.widening), ([0.0, 0.0], 1.0));
}

#[test]
fn two_maps_differ_by_the_angle_between_their_lines() {
    let lines = vec![vec![Vector::zeros(), Vector::new(6.0, 0.0, 0.0)]];
    let turned = |degrees: f64| {
        let turn = Rotation3::new(Vector::z() * degrees.to_radians());
        let from = [Vector::zeros(), Vector::x(), Vector::y(), Vector::z(), Vector::repeat(2.0)];
        ThinPlateSpline::new(&from, &from.map(|x| turn * x), 0.0).unwrap()
    };
    let off = fibre_difference(&turned(0.0), &turned(10.0), &lines).unwrap();
    assert!((off.mean_degrees - 10.0).abs() < 1e-6 && (off.largest_degrees - 10.0).abs() < 1e-6);
    // Half a degree of arc at 1.5 and 4.5 mm, the middles of both pieces.
    let chord = 2.0 * 5_f64.to_radians().sin();
    assert!(
        (off.mean_mm - 3.0 * chord).abs() < 1e-6 && (off.largest_mm - 4.5 * chord).abs() < 1e-6
    );
    let opposite = fibre_difference(&turned(0.0), &turned(170.0), &lines).unwrap();
    assert!((opposite.mean_degrees - 10.0).abs() < 1e-6, "a sign does not matter");
    assert_eq!(fibre_difference(&turned(0.0), &turned(1.0), &[vec![Vector::zeros()]]), None);
}

#[test]
fn a_splines_gradient_is_that_of_its_places() {
    let face = face();
    let spline = spline_of(&landmarks(&face)).unwrap();
    let place = Vector::new(21.0, -60.0, -14.0);
    let step = 1e-4;
    let gradient = Warp::gradient(&spline, &place);
    for axis in 0..3 {
        let offset = Vector::ith(axis, step);
        let slope =
            (spline.apply(&(place + offset)) - spline.apply(&(place - offset))) / (2.0 * step);
        assert!((gradient.column(axis) - slope).norm() < 1e-7, "{axis}");
    }
    // At a landmark the spline has no gradient; that of the others is finite.
    let at = *face.landmarks.values().next().unwrap();
    assert!(Warp::gradient(&spline, &at).iter().all(|x| x.is_finite()));
    assert!(spline_of(&landmarks(&face)[..3]).unwrap_err().to_string().contains('3'));
    let mut doubled = landmarks(&face);
    doubled[4].template = doubled[2].template;
    let error = spline_of(&doubled).unwrap_err().to_string();
    assert!([2, 4].iter().all(|&own| error.contains(&doubled[own].name)), "{error}");
}
