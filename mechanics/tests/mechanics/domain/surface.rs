//! The tissue between surfaces of which everything is known: spheres, boxes, tori.

use mechanics::domain::{Ball, Boundary, Coverage, Domain, Limit, SurfaceDomain};
use mechanics::mesh::{TriangleSurface, Vector};

use super::{cuboid, directions, part, sphere, torus};

const SKIN_RADIUS: f64 = 40.0;
const BONE_RADIUS: f64 = 27.0;
const RINGS: usize = 40;

fn centre() -> Vector {
    Vector::new(3.0, -20.0, 100.0)
}

/// How far inside its sphere a surface of that many rings may lie: twice the sagitta of an edge, for the diagonals.
fn sagitta(radius: f64) -> f64 {
    2.0 * radius * (1.0 - (std::f64::consts::PI / (2.0 * RINGS as f64)).cos())
}

fn shell() -> SurfaceDomain {
    let skin = sphere(centre(), SKIN_RADIUS, RINGS);
    let bone = sphere(centre(), BONE_RADIUS, RINGS);
    SurfaceDomain::new(&skin, &[&bone], &[]).unwrap()
}

#[test]
fn tissue_lies_between_skin_and_bone() {
    let domain = shell();
    for direction in directions(500) {
        for (radius, is_tissue) in
            [(0.0, false), (26.0, false), (27.1, true), (33.0, true), (39.5, true), (40.1, false)]
        {
            let value = domain.value(&(centre() + direction * radius));
            assert_eq!(value > 0.0, is_tissue, "{radius}: {value}");
        }
    }
    for strange in [f64::NAN, f64::INFINITY, -1e300, 1e30] {
        let point = Vector::repeat(strange);
        let value = domain.value(&point);
        assert!(value.is_finite() && value <= 0.0, "{strange}: {value}");
        assert_ne!(domain.coverage(&point, 1.0), Coverage::Inside);
        let _ = (domain.thickness(&point), domain.projection(&point, Boundary::Bone));
        let _ = domain.crossing(&centre(), &point);
    }
}

#[test]
fn a_box_and_a_torus_are_told_from_their_outside() {
    let size = Vector::new(60.0, 50.0, 40.0);
    let skin = cuboid(size);
    let ring = torus(12.0, 4.0, 30);
    let shifted = ring.points.iter().map(|point| point + size * 0.5).collect();
    let ring = TriangleSurface { points: shifted, ..ring };
    let domain = SurfaceDomain::new(&skin, &[&ring], &[]).unwrap();
    for n in 0..20_000 {
        let point = Vector::new(part(n, 0.819_172_5), part(n, 0.671_043_6), part(n, 0.549_700_5));
        let point = point.map(|x| x * 80.0 - 10.0);
        let in_box = (0..3).all(|axis| (0.0..size[axis]).contains(&point[axis]));
        let from = point - size * 0.5;
        let to_ring = (from.x.hypot(from.y) - 12.0).hypot(from.z) - 4.0;
        if to_ring.abs() > 0.15 {
            assert_eq!(domain.value(&point) > 0.0, in_box && to_ring > 0.0, "{point}");
        }
    }
}

#[test]
fn segments_meet_the_surface_that_they_pass_at_its_triangle() {
    let domain = shell();
    let middle = 0.5 * (SKIN_RADIUS + BONE_RADIUS);
    for direction in directions(500) {
        for (radius, beyond, boundary) in
            [(SKIN_RADIUS, 4.0, Boundary::Skin), (BONE_RADIUS, -4.0, Boundary::Bone)]
        {
            let outside = centre() + direction * (radius + beyond);
            let crossing = domain.crossing(&(centre() + direction * middle), &outside);
            assert_eq!(crossing.boundary, boundary);
            let depth = radius - (crossing.point - centre()).norm();
            assert!((-1e-9..=sagitta(radius)).contains(&depth), "{depth}");
        }
    }
    let cube = SurfaceDomain::new(&cuboid(Vector::repeat(10.0)), &[], &[]).unwrap();
    let crossing = cube.crossing(&Vector::new(3.0, 4.0, 5.0), &Vector::new(3.5, 4.5, 25.0));
    assert!((crossing.point.z - 10.0).abs() < 1e-12, "{crossing:?}");
    // Every face of a box is flat: the scan ended there.
    assert_eq!((crossing.boundary, cube.cut_triangles()), (Boundary::Cut, 12));
}

#[test]
fn no_tissue_lies_in_a_hollow_of_bone_and_tissue_ends_at_its_outer_wall() {
    // From inside the skin through two thin walls of a hollow bone, at whose far side there is tissue again.
    let skin = cuboid(Vector::new(100.0, 40.0, 40.0));
    let place = |radius: f64| sphere(Vector::new(50.0, 20.0, 20.0), radius, 24);
    let (outer, mut inner) = (place(12.0), place(8.0));
    inner.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let mut hollow = outer.clone();
    hollow
        .triangles
        .extend(inner.triangles.iter().map(|t| t.map(|p| p + outer.points.len() as u32)));
    hollow.points.extend(inner.points);
    let domain = SurfaceDomain::new(&skin, &[&hollow], &[]).unwrap();
    for x in [50.0, 56.0, 60.0] {
        assert!(domain.value(&Vector::new(x, 20.0, 20.0)) <= 0.0, "{x}");
    }
    assert_eq!(domain.coverage(&Vector::new(50.0, 20.0, 20.0), 9.0), Coverage::Outside);
    let [hollow] = domain.hollows().next().unwrap() else { panic!("one hollow") };
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 512.0;
    assert!((hollow.volume / ball - 1.0).abs() < 0.02, "{hollow:?}");
    assert!((hollow.centre - Vector::new(50.0, 20.0, 20.0)).norm() < 0.01, "{hollow:?}");
    let at = |x: f64| Vector::new(x, 20.5, 20.3);
    let crossing = domain.crossing(&at(30.0), &at(60.0));
    assert!(crossing.boundary == Boundary::Bone && (crossing.point.x - 38.0).abs() < 0.3);
    let crossing = domain.crossing(&at(80.0), &at(40.0));
    assert!(crossing.boundary == Boundary::Bone && (crossing.point.x - 62.0).abs() < 0.3);
}

#[test]
fn no_ball_is_called_inside_or_outside_that_is_not() {
    let limits = [
        Limit::HalfSpace { point: centre() - Vector::z() * 20.0, normal: Vector::z() },
        Limit::Balls(vec![Ball { centre: centre() + Vector::x() * 20.0, radius: 50.0 }]),
    ];
    // A sound skin, and one of which every ninth triangle is missing.
    let skin = sphere(centre(), SKIN_RADIUS, RINGS);
    let mut open = skin.clone();
    open.triangles =
        (0..open.triangles.len()).filter(|n| n % 9 != 4).map(|n| skin.triangles[n]).collect();
    let bone = sphere(centre(), BONE_RADIUS, RINGS);
    for skin in [skin, open] {
        let domain = SurfaceDomain::new(&skin, &[&bone], &limits).unwrap();
        let mut known = [0, 0];
        for n in 0..6000 {
            let middle =
                [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|step| part(n, step) * 100.0 - 50.0);
            let middle = centre() + Vector::from(middle);
            let radius = 0.3 + 9.0 * part(n, 0.618_034).powi(2);
            let wanted = match domain.coverage(&middle, radius) {
                Coverage::Inside => true,
                Coverage::Outside => false,
                Coverage::Mixed => continue,
            };
            known[usize::from(wanted)] += 1;
            for direction in directions(24) {
                for share in [0.0, 0.5, 0.999] {
                    let value = domain.value(&(middle + direction * (radius * share)));
                    assert_eq!(value > 0.0, wanted, "{middle} {radius}: {value}");
                }
            }
        }
        println!("outside {}, inside {} of 6000", known[0], known[1]);
        assert!(known[0] > 2500 && known[1] > 30, "{known:?}");
    }
}

#[test]
fn a_point_is_projected_onto_the_boundary_that_is_asked_for() {
    let domain = shell();
    for direction in directions(300) {
        for (radius, boundary) in [(SKIN_RADIUS, Boundary::Skin), (BONE_RADIUS, Boundary::Bone)] {
            for off in [-1.5, 0.4] {
                let start = centre() + direction * (radius + off);
                let found = domain.projection(&start, boundary);
                let depth = radius - (found - centre()).norm();
                assert!((-1e-9..=sagitta(radius)).contains(&depth), "{boundary:?} {off}: {depth}");
                assert!((found - start).norm() <= f64::abs(off) + sagitta(radius));
            }
        }
    }
}

#[test]
fn the_thickness_is_the_distance_from_skin_to_bone_or_across_what_has_none() {
    let domain = shell();
    let wanted = SKIN_RADIUS - BONE_RADIUS;
    for direction in directions(200) {
        for radius in [28.0, 33.0, 39.0] {
            let point = centre() + direction * radius;
            let found = domain.thickness(&point);
            assert!((found - wanted).abs() < sagitta(SKIN_RADIUS), "{radius}: {found}");
            let [above, below] = [1.01, 0.99].map(|part| part * found);
            assert!((domain.thickness_below(&point, above) - found).abs() < 1e-12);
            assert!(domain.thickness_below(&point, below) >= below);
        }
    }
    let plate = SurfaceDomain::new(&cuboid(Vector::new(50.0, 40.0, 6.0)), &[], &[]).unwrap();
    assert!((plate.thickness(&Vector::new(22.0, 21.0, 1.0)) - 6.0).abs() < 1e-9);
}

#[test]
fn flat_ends_of_a_scan_are_cuts_and_a_round_chin_is_skin() {
    let mut skin = sphere(Vector::zeros(), SKIN_RADIUS, RINGS);
    skin.points.iter_mut().for_each(|point| point.z = point.z.max(-25.0));
    let domain = SurfaceDomain::new(&skin, &[], &[]).unwrap();
    let inside = Vector::new(5.0, 4.0, -20.0);
    let crossing = domain.crossing(&inside, &(inside - Vector::z() * 9.0));
    assert_eq!(crossing.boundary, Boundary::Cut);
    assert!((crossing.point.z + 25.0).abs() < 1e-9);
    for direction in directions(300).filter(|direction| direction.z > -0.6) {
        let crossing = domain.crossing(&Vector::zeros(), &(direction * 45.0));
        assert_eq!(crossing.boundary, Boundary::Skin, "{direction}");
    }
    let near = Vector::new(10.0, 3.0, -24.0);
    let found = domain.projection(&near, Boundary::Cut);
    assert!((found - Vector::new(10.0, 3.0, -25.0)).norm() < 1e-9, "{found}");
}

#[test]
fn a_region_of_interest_cuts_what_lies_beyond() {
    let skin = sphere(Vector::zeros(), SKIN_RADIUS, RINGS);
    let limit = Limit::HalfSpace { point: Vector::x() * 10.0, normal: -Vector::x() };
    let domain = SurfaceDomain::new(&skin, &[], &[limit]).unwrap();
    let crossing = domain.crossing(&Vector::zeros(), &(Vector::x() * 25.0));
    assert_eq!(crossing.boundary, Boundary::Cut);
    assert!((crossing.point.x - 10.0).abs() < 3e-3);
    let found = domain.projection(&Vector::new(9.5, 1.0, 2.0), Boundary::Cut);
    assert!((found - Vector::new(10.0, 1.0, 2.0)).norm() < 1e-12);
}

#[test]
fn a_throat_that_ends_at_the_cut_is_an_airway() {
    // A cylinder of 40 mm radius and 80 mm height, from whose lower end a blind throat of 8 mm radius rises.
    let profile = [[0.0, 50.0], [8.0, 50.0], [8.0, 0.0], [40.0, 0.0], [40.0, 80.0], [0.0, 80.0]];
    let skin = turned(&profile, 48);
    let domain = SurfaceDomain::new(&skin, &[], &[]).unwrap();
    let from = Vector::new(16.0, 1.0, 25.0);
    let to = |x: f64, z: f64| domain.crossing(&from, &Vector::new(x, 0.5, z)).boundary;
    assert_eq!((to(3.0, 25.0), to(45.0, 25.0)), (Boundary::Airway, Boundary::Skin));
    assert_eq!((to(18.0, -5.0), to(18.0, 90.0)), (Boundary::Cut, Boundary::Cut));
}

/// The surface of a profile of radii and heights turned about the z axis, inward side on its left.
fn turned(profile: &[[f64; 2]], steps: usize) -> TriangleSurface {
    let point = |[radius, height]: [f64; 2], step: usize| {
        let (sin, cos) = (std::f64::consts::TAU * step as f64 / steps as f64).sin_cos();
        Vector::new(radius * cos, radius * sin, height)
    };
    let rings = profile.iter().flat_map(|&ring| (0..steps).map(move |step| point(ring, step)));
    let points = rings.collect();
    let at = |ring: usize, step: usize| (ring * steps + step % steps) as u32;
    let quads = (1..profile.len()).flat_map(|ring| (0..steps).map(move |step| (ring, step)));
    let triangles = quads.flat_map(|(ring, step)| {
        let [a, b, c, d] =
            [at(ring - 1, step), at(ring - 1, step + 1), at(ring, step + 1), at(ring, step)];
        [[a, b, c], [a, c, d]]
    });
    TriangleSurface { points, triangles: triangles.collect(), node_ids: None }
}
