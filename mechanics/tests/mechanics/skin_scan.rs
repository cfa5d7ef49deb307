//! A camera's scan as skin over the bone of a CT: a made head as voxels, its skin with a planted difference, moved and noisy.

use std::sync::LazyLock;

use mechanics::anatomy::skin_scan::{BLEND_MM, FittedScan, REACH_MM, SkinScanRules, fit, skin_of};
use mechanics::anatomy::{AnatomyError, SkinScanError};
use mechanics::domain::{Boundary, Domain, ImageDomain, ImageOptions, ScannedSkin};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::{SurfaceSearch, TriangleSurface, Vector};
use mechanics::meshing::{MeshingSettings, SizeField, mesh};
use mechanics::progress::Unobserved;
use mechanics::registration::RigidTransform;

use crate::surfaces::{Noise, head, map, movement};

const VOXEL: f64 = 3.0;
/// The cheek is fuller on the scan by so much, in mm, around this direction.
const FULLER: f64 = 2.5;
const BONE: f64 = 22.0;

fn skin() -> TriangleSurface {
    map(&head(5), |point| point * 0.6)
}

/// How much fuller the face is on the scan at a place.
fn fuller(point: &Vector) -> f64 {
    let cosine = point.normalize().dot(&Vector::new(0.55, -0.8, 0.1).normalize());
    FULLER * ((cosine - 1.0) * 25.0).exp()
}

/// The face of the scan where it lies on the CT: what looks forward.
fn face(forward: f64) -> TriangleSurface {
    let whole = skin();
    let mut face = map(&whole, |point| point + point.normalize() * fuller(point));
    face.triangles
        .retain(|corners| corners.iter().all(|&corner| whole.points[corner as usize].y < forward));
    face
}

/// Soft tissue of 40 HU in a made head, a ball of bone of 1200 HU in it, mixed where a boundary crosses a voxel.
static CT: LazyLock<ImageVolume> = LazyLock::new(|| {
    let search = SurfaceSearch::new(&skin()).unwrap();
    let (low, high) = skin().bounds();
    let origin = low - Vector::repeat(5.0 * VOXEL);
    let size = [0, 1, 2].map(|axis| ((high[axis] - origin[axis]) / VOXEL) as usize + 6);
    let share = |depth: f64| (depth / VOXEL + 0.5).clamp(0.0, 1.0);
    let value = |number: usize| {
        let index = [number % size[0], number / size[0] % size[1], number / (size[0] * size[1])];
        let at = origin + Vector::from(index.map(|i| VOXEL * i as f64));
        let depth = -search.signed_distance(&at, &search.closest(&at));
        (-1000.0 + 1040.0 * share(depth) + 1160.0 * share(BONE - at.norm())) as i16
    };
    let values = (0..size.iter().product()).map(value).collect();
    let steps = [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * VOXEL);
    ImageVolume::new(size, Placement { origin, steps }, Voxels::I16(values)).unwrap()
});

/// Half way between air and tissue, tissue and bone, so that boundaries are where they were made.
fn options() -> ImageOptions {
    ImageOptions { skin_threshold: -480.0, bone_threshold: 620.0, ..ImageOptions::default() }
}

/// Noise of .15 mm at each point, then where a camera stood.
fn taken(face: &TriangleSurface, camera: &RigidTransform) -> TriangleSurface {
    let mut noise = Noise::new(7);
    let mut taken = face.clone();
    for point in &mut taken.points {
        let off = Vector::from_fn(|_, _| (noise.uniform() - 0.5) * 0.3);
        *point = camera.apply(&(*point + off));
    }
    taken
}

fn fitted(scan: &TriangleSurface, rules: &SkinScanRules) -> Result<FittedScan, SkinScanError> {
    fit(scan, &CT, (&options(), rules), &Unobserved).map_err(|error| match error {
        AnatomyError::SkinScan(error) => error,
        other => panic!("{other}"),
    })
}

fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(share * values.len() as f64) as usize]
}

#[test]
fn the_skin_of_a_scan_is_that_of_the_made_head_within_a_quarter_of_a_voxel() {
    let found = skin_of(&CT, &options()).unwrap();
    let search = SurfaceSearch::new(&skin()).unwrap();
    let off = found.points.iter().map(|point| search.closest(point).distance).collect();
    let off = quantile(off, 0.95);
    assert!(off < 0.25 * VOXEL, "{off}");
    assert!((found.signed_volume() / skin().signed_volume() - 1.0).abs() < 0.01);
}

#[test]
fn a_moved_and_noisy_scan_is_found_and_is_the_skin_where_it_covers() {
    let camera = movement([6.0, -4.0, 9.0], [12.0, -9.0, 7.0]);
    let truth = face(0.0);
    let found = fitted(&taken(&truth, &camera), &SkinScanRules::default()).unwrap();
    let back = camera.then(&found.transform);
    let off: Vec<f64> =
        truth.points.iter().map(|point| (back.apply(point) - point).norm()).collect();
    assert!(quantile(off.clone(), 0.95) < 0.5, "{}", quantile(off, 0.95));
    assert!(found.left.mean < 0.5 && found.left.outliers < 0.05, "{:?}", found.left);
    let skin_scan =
        ScannedSkin { surface: found.surface.clone(), reach: REACH_MM, blend: BLEND_MM };
    let domain = ImageDomain::with_skin(&CT, &options(), &skin_scan).unwrap();
    let plain = ImageDomain::new(&CT, &options()).unwrap();
    assert_eq!(domain.bone_outside(), 0.0);
    let settings = MeshingSettings { size: SizeField::uniform(3.0), ..MeshingSettings::default() };
    let made = mesh(&domain, &settings, &Unobserved).unwrap();
    let before = mesh(&plain, &settings, &Unobserved).unwrap();

    // On the face the skin is that of the scan, at the back that of the CT.
    let scanned = SurfaceSearch::new(&found.surface).unwrap();
    let of_ct = SurfaceSearch::new(&skin()).unwrap();
    let nodes = made.nodes_on(Boundary::Skin);
    let places = || nodes.iter().map(|&node| made.volume.nodes[node as usize]);
    let on_face = places().filter(|x| x.y < -18.0).map(|x| scanned.closest(&x).distance).collect();
    let at_back = places().filter(|x| x.y > 5.0).map(|x| of_ct.closest(&x).distance).collect();
    assert!(quantile(on_face, 0.95) < 0.3, "the face");
    assert!(quantile(at_back, 0.95) < 0.3, "the back");
    // The planted cheek is there, and only there: the height of nodes over the skin of the CT.
    let heights = |is_cheek: bool| -> Vec<f64> {
        let chosen = places().filter(|x| x.y < -18.0 && (fuller(x) > 2.0) == is_cheek);
        let chosen = chosen.filter(|x| is_cheek || fuller(x) < 0.05);
        chosen.map(|x| of_ct.signed_distance(&x, &of_ct.closest(&x))).collect()
    };
    let [cheek, rest] = [true, false].map(|is_cheek| quantile(heights(is_cheek), 0.5));
    assert!((cheek - 2.25).abs() < 0.4 && rest.abs() < 0.3, "{cheek} {rest}");
    assert!(made.report.volume > before.report.volume);
}

#[test]
fn between_the_two_skins_the_joined_one_has_no_hole() {
    let camera = RigidTransform::identity();
    let found = fitted(&taken(&face(-5.0), &camera), &SkinScanRules::default()).unwrap();
    let skin_scan = ScannedSkin { surface: found.surface, reach: REACH_MM, blend: BLEND_MM };
    let domain = ImageDomain::with_skin(&CT, &options(), &skin_scan).unwrap();
    // From the bone outwards tissue ends once along every ray, and the skin lies at one of the two or between them.
    for point in skin().points.iter().step_by(7) {
        let out = point.normalize();
        let values: Vec<bool> = (0..200)
            .map(|step| out * (BONE + 2.0 + 0.25 * f64::from(step)))
            .map(|place| domain.value(&place) > 0.0)
            .collect();
        let changes = values.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert_eq!((values[0], changes), (true, 1), "{point}");
        let end = BONE + 2.0 + 0.25 * values.iter().filter(|&&tissue| tissue).count() as f64;
        let (low, high) = (point.norm() - 0.8, point.norm() + fuller(point) + 0.8);
        assert!((low..high).contains(&end), "{point}: {end} of {low} to {high}");
    }
}

#[test]
fn landmarks_bring_a_scan_from_a_frame_of_its_own() {
    let camera = movement([95.0, 20.0, -160.0], [400.0, 900.0, -200.0]);
    let scan = taken(&face(0.0), &camera);
    let places = [[30.0, -45.0, 0.0], [-25.0, -48.0, 15.0], [3.0, -60.0, 0.0], [5.0, -40.0, -40.0]];
    let landmarks = places.map(|place| {
        let place = Vector::from(place);
        [camera.apply(&(place + Vector::new(1.0, 0.5, -1.0))), place]
    });
    let rules = SkinScanRules { landmarks: landmarks.to_vec(), mask: None };
    let found = fitted(&scan, &rules).unwrap();
    assert!(found.left.mean < 0.5, "{:?}", found.left);
    assert!(fitted(&scan, &SkinScanRules::default()).is_err());
}

#[test]
fn a_scan_that_is_not_this_skin_is_refused_by_name() {
    let none = SkinScanRules::default();
    let still = RigidTransform::identity();
    let refused = |scan: &TriangleSurface| fitted(scan, &none).map(|found| found.left).unwrap_err();

    let mirrored = map(&face(0.0), |point| Vector::new(-point.x, point.y, point.z));
    let mirrored = TriangleSurface {
        triangles: mirrored.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        ..mirrored
    };
    let error = refused(&mirrored);
    assert!(
        matches!(error, SkinScanError::Mirrored { plain, mirrored } if mirrored < 0.5 * plain),
        "{error}"
    );

    let other = map(&face(0.0), |x| Vector::new(1.25 * x.x, 0.8 * x.y, 0.85 * x.z));
    let error = refused(&taken(&other, &still));
    assert!(matches!(error, SkinScanError::Misfit { .. }), "{error}");

    let nose = face(-50.0);
    assert!(nose.area() < 3500.0 && nose.area() > 300.0, "{}", nose.area());
    let error = refused(&nose);
    assert!(matches!(error, SkinScanError::Small { .. }), "{error}");

    let metres = map(&face(0.0), |point| point * 1e-3);
    let error = refused(&metres);
    assert!(matches!(error, SkinScanError::Small { .. }), "{error}");
}
