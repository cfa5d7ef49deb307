//! Surfaces damaged on purpose, held against the undamaged one: the same inside, or refused by name.

use mechanics::domain::{Assessment, Domain, SurfaceDomain, SurfaceDomainError, SurfaceName};
use mechanics::mesh::{TriangleSurface, Vector};

use super::{part, sphere, torus};
use crate::surfaces::sphere as ball;

/// A ring, so that an inside has a hole, and 12 800 triangles of about 1.6 mm.
fn sound() -> TriangleSurface {
    torus(40.0, 18.0, 80)
}

/// Numbers in [0, 1), always the same ones (SplitMix64: Steele, Lea, Flood, OOPSLA 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) as f64 / 2f64.powi(64)
    }

    fn vector(&mut self) -> Vector {
        Vector::new(self.next(), self.next(), self.next()).map(|x| 2.0 * x - 1.0)
    }
}

fn keep(surface: &mut TriangleSurface, mut wanted: impl FnMut(&[Vector; 3]) -> bool) {
    let kept = (0..surface.triangles.len()).filter(|&n| wanted(&surface.corners(n)));
    surface.triangles = kept.map(|n| surface.triangles[n]).collect();
}

fn flip(surface: &mut TriangleSurface, share: f64) {
    let mut random = Random(5);
    for triangle in &mut surface.triangles {
        if random.next() < share {
            triangle.swap(1, 2);
        }
    }
}

fn add(surface: &mut TriangleSurface, other: TriangleSurface) {
    let first = surface.points.len() as u32;
    surface.points.extend(other.points);
    surface
        .triangles
        .extend(other.triangles.iter().map(|corners| corners.map(|point| point + first)));
}

/// Every triangle with corners of its own.
fn soup(surface: &TriangleSurface, mut shift: impl FnMut() -> Vector) -> TriangleSurface {
    let corners = (0..surface.triangles.len()).flat_map(|n| surface.corners(n));
    let points: Vec<Vector> = corners.map(|corner| corner + shift()).collect();
    let triangles = (0..points.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    TriangleSurface { points, triangles, node_ids: None }
}

/// The part of points more than `margin` mm from the ring on whose side the damaged surface and the ring agree.
fn agreement(domain: &SurfaceDomain, margin: f64) -> f64 {
    let (mut agreed, mut all) = (0, 0);
    for n in 0..20_000 {
        let point = Vector::new(
            part(n, 0.819_172_5) * 140.0 - 70.0,
            part(n, 0.671_043_6) * 140.0 - 70.0,
            part(n, 0.549_700_5) * 60.0 - 30.0,
        );
        let depth = 18.0 - (point.x.hypot(point.y) - 40.0).hypot(point.z);
        if depth.abs() > margin {
            all += 1;
            agreed += usize::from((domain.value(&point) > 0.0) == (depth > 0.0));
        }
    }
    agreed as f64 / all as f64
}

fn assess(surface: &TriangleSurface) -> Result<Assessment, SurfaceDomainError> {
    Ok(SurfaceDomain::new(surface, &[], &[])?.assessments()[0])
}

/// The domain of a damaged ring, which must agree at this part of the points more than 1 mm away.
fn agreed(name: &str, damage: impl Fn(&mut TriangleSurface), least: f64) -> Assessment {
    let mut surface = sound();
    damage(&mut surface);
    let domain =
        SurfaceDomain::new(&surface, &[], &[]).unwrap_or_else(|error| panic!("{name}: {error}"));
    let (found, assessment) = (agreement(&domain, 1.0), domain.assessments()[0]);
    println!("{name}: agrees {found:.5}, {assessment:?}");
    assert!(found >= least, "{name}: {found} {assessment:?}");
    // 2 pi R pi r² of the ring, and its faces lie within it by 0.3 %.
    let volume = 2.0 * std::f64::consts::PI.powi(2) * 40.0 * 18.0 * 18.0;
    assert!((assessment.volume / volume - 1.0).abs() < 0.02, "{name}: {assessment:?}");
    assessment
}

#[test]
fn an_undamaged_surface_has_nothing_to_mend() {
    let found = agreed("sound", |_| {}, 1.0);
    assert_eq!((found.mending, found.open_edges, found.pieces), (Default::default(), 0, 1));
    assert!(found.level == 1.0 && found.uncertain == 0.0);
    assert!((found.volume / found.volume_of_triangles - 1.0).abs() < 0.01);
}

#[test]
fn turned_triangles_are_turned_back_and_counted() {
    let found = agreed("3 of 10 turned", |surface| flip(surface, 0.3), 1.0);
    assert!(found.open_edges == 0 && found.uncertain == 0.0, "{found:?}");
    let share = found.mending.turned as f64 / found.triangles as f64;
    assert!((share - 0.3).abs() < 0.02 && !found.mending.was_inverted, "{found:?}");
    let found = agreed("inverted", |surface| flip(surface, 2.0), 1.0);
    assert!(found.mending.was_inverted && found.mending.turned == 0, "{found:?}");
}

#[test]
fn missing_triangles_leave_the_inside_where_it_was() {
    let mut random = Random(1);
    let holes: Vec<bool> = (0..20_000).map(|_| random.next() < 0.05).collect();
    let found = agreed(
        "holes of 5 %",
        |surface| {
            let mut number = 0;
            keep(surface, |_| {
                number += 1;
                !holes[number]
            });
        },
        1.0,
    );
    assert!(found.open_edges > 1000 && found.level == 1.0);
    let at = Vector::new(58.0, 0.0, 0.0);
    let found = agreed(
        "a hole of 6 mm radius",
        |surface| keep(surface, |corners| (corners[0] - at).norm() > 6.0),
        0.999,
    );
    assert_eq!((found.mending.lids, found.open_edges), (1, 0));
}

#[test]
fn a_wide_hole_is_closed_as_curved_as_the_surface_around_it() {
    let whole = assess(&ball(40.0, Vector::zeros(), 4)).unwrap().volume_of_triangles;
    let without = |mut surface: TriangleSurface| {
        keep(&mut surface, |corners| (corners[0] - Vector::z() * 40.0).norm() > 12.0);
        assess(&surface).unwrap()
    };
    let found = without(ball(40.0, Vector::zeros(), 4));
    println!("{found:?}");
    assert_eq!((found.mending.lids, found.open_edges), (1, 0));
    // A flat lid costs .3 %.
    assert!((found.volume_of_triangles / whole - 1.0).abs() < 5e-4, "{found:?} {whole}");
    // A hole in both skins of a thin body.
    let sound = assess(&wall(40.0, 34.0)).unwrap().volume_of_triangles;
    let found = without(wall(40.0, 34.0));
    assert_eq!((found.mending.lids, found.open_edges, found.in_holes), (2, 0, 0.0));
    assert!((found.volume_of_triangles / sound - 1.0).abs() < 2e-3, "{found:?} {sound}");
}

#[test]
fn a_hole_that_no_lid_closes_is_refused_where_a_hundredth_of_the_tissue_hangs_on_it() {
    // Around a third of the equator's edge of a lens: no quadric fits there.
    let lens = |radius: f64| {
        let mut lens = ball(40.0, Vector::zeros(), 5);
        lens.points.iter_mut().for_each(|point| point.z *= 0.12);
        keep(&mut lens, |corners| (corners[0] - Vector::x() * 40.0).norm() > radius);
        assess(&lens)
    };
    assert!(lens(3.0).is_ok());
    let refused = lens(14.0).unwrap_err();
    println!("{refused}");
    assert!(
        matches!(refused, SurfaceDomainError::Uncertain { percent, .. } if percent > 1.0),
        "{refused}"
    );
}

#[test]
fn with_half_of_the_triangles_gone_the_threshold_is_halved() {
    let found = agreed(
        "half gone",
        |surface| {
            let mut random = Random(2);
            keep(surface, |_| random.next() < 0.5);
        },
        0.995,
    );
    assert!((found.level - 0.5).abs() < 0.1, "{found:?}");
}

#[test]
fn with_half_gone_and_the_rest_turned_at_random_the_rest_is_turned_back() {
    let found = agreed(
        "half gone, 3 of 10 turned",
        |surface| {
            let mut random = Random(3);
            keep(surface, |_| random.next() < 0.5);
            flip(surface, 0.3);
        },
        0.99,
    );
    assert!(found.mending.turned > 1000, "{found:?}");
}

#[test]
fn doubles_islands_and_a_second_sheet_change_nothing() {
    let twice = |surface: &mut TriangleSurface| {
        let copy = surface.clone();
        add(surface, copy);
    };
    let found = agreed("twice the same", twice, 1.0);
    assert_eq!(found.mending.duplicates, 12_800);
    assert_eq!(found.mending.welded_points, 6400);

    let sheet = |surface: &mut TriangleSurface| add(surface, torus(40.0, 17.5, 80));
    let found = agreed("a second sheet", sheet, 1.0);
    assert_eq!(found.mending.second_sheets, 12_800);
    assert!((found.volume_of_triangles / found.volume - 1.0).abs() < 0.01, "{found:?}");
    assert!((found.second_sheets_differ - 0.055).abs() < 0.01, "{found:?}");

    let islands = |surface: &mut TriangleSurface| {
        add(surface, sphere(Vector::new(0.0, 0.0, 5.0), 1.5, 6));
    };
    let found = agreed("an island", islands, 0.999);
    assert_eq!(found.pieces, 2);
}

#[test]
fn loose_and_shaken_triangles_still_enclose() {
    let found = agreed("soup", |surface| *surface = soup(surface, Vector::zeros), 1.0);
    assert!(found.open_edges == 0 && found.mending.welded_points == 12_800 * 3 - 6400);
    let shaken = |surface: &mut TriangleSurface| {
        let mut random = Random(4);
        *surface = soup(surface, || random.vector() * 0.3);
    };
    let found = agreed("shaken soup", shaken, 0.999);
    assert_eq!(found.pieces, 12_800);
    let shaken_and_turned = |surface: &mut TriangleSurface| {
        shaken(surface);
        flip(surface, 0.3);
    };
    agreed("shaken soup, 3 of 10 turned", shaken_and_turned, 0.99);
    let flat = |surface: &mut TriangleSurface| {
        surface.triangles.extend([[0, 0, 5], [7, 8, 7], [1, 1, 1]]);
    };
    assert_eq!(agreed("flat triangles", flat, 1.0).mending.degenerate, 3);
}

#[test]
fn a_piece_inside_out_is_turned_and_a_cavity_is_not() {
    let apart = Vector::new(0.0, 0.0, 60.0);
    let reversed = |radius: f64, place: Vector| {
        let mut piece = sphere(place, radius, 12);
        piece.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        piece
    };
    let mut surface = sound();
    add(&mut surface, reversed(10.0, apart));
    add(&mut surface, reversed(9.0, Vector::x() * 40.0));
    let domain = SurfaceDomain::new(&surface, &[], &[]).unwrap();
    assert!(domain.value(&apart) > 0.0, "{:?}", domain.assessments());
    assert!(domain.value(&(Vector::x() * 40.0)) <= 0.0);
    assert!(domain.value(&(Vector::x() * 52.0)) > 0.0);
}

#[test]
fn what_is_not_certain_of_its_inside_is_refused_with_its_numbers() {
    let mut few = sound();
    let mut random = Random(6);
    keep(&mut few, |_| random.next() < 0.2);
    let found = assess(&few).unwrap_err();
    println!("{found}");
    assert!(
        matches!(
            found,
            SurfaceDomainError::Incomplete { .. } | SurfaceDomainError::NoInside { .. }
        ),
        "{found}"
    );

    let mut half = sound();
    keep(&mut half, |corners| corners[0].y > 0.0);
    let found = assess(&half);
    println!("{found:?}");
    assert!(matches!(found, Err(SurfaceDomainError::Open { .. })), "{found:?}");

    let sheet = TriangleSurface {
        points: vec![
            Vector::zeros(),
            Vector::x() * 9.0,
            Vector::y() * 9.0,
            Vector::new(9.0, 9.0, 1.0),
        ],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        node_ids: None,
    };
    assert!(assess(&sheet).is_err());

    let scattered = soup(&sound(), || random.vector() * 40.0);
    let found = assess(&scattered).unwrap_err();
    assert!(matches!(found, SurfaceDomainError::Tangled { times, .. } if times > 20.0), "{found}");
}

#[test]
fn coordinates_that_are_no_place_are_refused_by_name() {
    for (strange, word) in [(f64::NAN, "NaN"), (1e30, "1000000000000000"), (f64::INFINITY, "inf")] {
        let mut surface = sound();
        surface.points[17].y = strange;
        let found = assess(&surface).unwrap_err().to_string();
        assert!(
            found.starts_with("skin: point 17 has a coordinate") && found.contains(word),
            "{found}"
        );
    }
    let mut surface = sound();
    surface.triangles[3][1] = 6400;
    let wanted = SurfaceDomainError::Corner {
        surface: SurfaceName::Bone(0),
        triangle: 3,
        point: 6400,
        points: 6400,
    };
    assert_eq!(SurfaceDomain::new(&sound(), &[&surface], &[]).unwrap_err(), wanted);
    let empty = TriangleSurface::default();
    assert!(matches!(assess(&empty), Err(SurfaceDomainError::Empty { triangles: 0, .. })));
}

/// The wall of a ball: tissue between two spheres.
fn wall(outer: f64, inner: f64) -> TriangleSurface {
    let mut surface = ball(outer, Vector::zeros(), 4);
    let mut hollow = ball(inner, Vector::zeros(), 4);
    hollow.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    add(&mut surface, hollow);
    surface
}

#[test]
fn a_thin_body_that_was_cut_off_or_is_there_twice_is_refused_by_name() {
    // Sheets that face each other, seen from the middle: what is hollow stays hollow.
    for inner in [36.0, 28.0] {
        let found = assess(&wall(40.0, inner)).unwrap();
        let exact = 4.0 / 3.0 * std::f64::consts::PI * (40.0_f64.powi(3) - inner.powi(3));
        assert!((found.volume / exact - 1.0).abs() < 0.03, "{found:?}");
    }
    let mut half = wall(40.0, 36.0);
    keep(&mut half, |corners| corners[0].z < 2.0);
    let refused = assess(&half).unwrap_err();
    println!("{refused}");
    let SurfaceDomainError::Open { percent, .. } = refused else { panic!("{refused}") };
    assert!((3.0..12.0).contains(&percent), "{percent}");
    // Its second sheets lie half a mm further in: of 4.5 mm that they all enclose 1 mm is of one of them alone.
    let mut twice = wall(40.0, 36.0);
    add(&mut twice, wall(39.5, 35.5));
    let refused = assess(&twice).unwrap_err();
    println!("{refused}");
    let SurfaceDomainError::Doubled { percent, .. } = refused else { panic!("{refused}") };
    assert!((15.0..30.0).contains(&percent), "{percent}");
}

#[test]
fn a_flat_end_is_found_though_a_speck_lies_beyond_it_and_half_of_it_is_gone() {
    let mut skin = ball(40.0, Vector::zeros(), 5);
    skin.points.iter_mut().for_each(|point| point.z = point.z.max(-20.0));
    let ends =
        |skin: &TriangleSurface| SurfaceDomain::new(skin, &[], &[]).unwrap().cut_triangles() as f64;
    let whole = ends(&skin);
    assert!(whole > 1000.0, "{whole}");
    let mut random = Random(3);
    let mut sparse = skin.clone();
    keep(&mut sparse, |_| random.next() < 0.5);
    assert!((ends(&sparse) / whole - 0.5).abs() < 0.05, "{} {whole}", ends(&sparse));
    add(&mut skin, ball(2.0, Vector::new(5.0, 3.0, -21.5), 1));
    assert!((ends(&skin) / whole - 1.0).abs() < 0.02, "{} {whole}", ends(&skin));
}
