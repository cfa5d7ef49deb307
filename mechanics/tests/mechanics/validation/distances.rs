//! Nearest points, statistics and distances between surfaces (docs/verification.md#v39).

use mechanics::mesh::closest_point::Feature;
use mechanics::mesh::{SearchError, SurfaceSearch, TriangleSurface, Vector, area_sampling};
use mechanics::validation::{Statistics, StatisticsError};

use crate::surfaces::{Noise, brute_force_distance, map, sphere, square};

#[test]
fn the_nearest_point_is_the_one_that_trying_all_triangles_finds() {
    let surface = map(&sphere(70.0, Vector::new(3.0, 4.0, 5.0), 2), |p| {
        p + Vector::new(p.y, p.z, p.x).map(|x| 3.0 * (0.2 * x).sin())
    });
    let search = SurfaceSearch::new(&surface).unwrap();
    let mut random = Noise::new(7);
    for _ in 0..500 {
        let point = random.vector() * 60.0;
        let closest = search.closest(&point);
        let tried = brute_force_distance(&surface, &point);
        assert!((closest.distance - tried).abs() < 1e-10, "{point} {closest:?} {tried}");
        let corners = surface.corners(closest.triangle);
        let weights = closest.barycentric;
        let placed = (0..3).map(|i| corners[i] * weights[i]).sum::<Vector>();
        assert!((placed - closest.point).norm() < 1e-10);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(weights.iter().all(|&weight| weight >= -1e-12));
        assert_eq!(search.closest(&point), closest);
        assert_eq!(search.closest_within(&point, closest.distance * 0.999), None);
        assert_eq!(search.closest_within(&point, closest.distance * 1.001), Some(closest));
    }
}

#[test]
fn a_far_origin_does_not_move_the_nearest_point() {
    let far = Vector::new(1e7, -2e7, 3e7);
    let near_surface = sphere(70.0, Vector::zeros(), 2);
    let far_surface = map(&near_surface, |point| point + far);
    let near = SurfaceSearch::new(&near_surface).unwrap();
    let far_away = SurfaceSearch::new(&far_surface).unwrap();
    let mut random = Noise::new(3);
    for _ in 0..100 {
        let point = random.vector() * 60.0;
        let (a, b) = (near.closest(&point), far_away.closest(&(point + far)));
        // Coordinates of 3e7 are rounded to 4e-9.
        assert!((a.distance - b.distance).abs() < 2e-8);
        assert!((a.point - (b.point - far)).norm() < 1e-6);
    }
}

/// A box from -1 to 1, twelve triangles, outward.
fn cube() -> TriangleSurface {
    let points = (0..8).map(|c| {
        Vector::from([c & 1, (c >> 1) & 1, (c >> 2) & 1].map(|bit| 2.0 * f64::from(bit) - 1.0))
    });
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriangleSurface {
        points: points.collect(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        node_ids: None,
    }
}

#[test]
fn the_side_is_right_at_faces_edges_and_corners_also_of_a_triangle_soup() {
    let cube = cube();
    let mut soup = TriangleSurface::default();
    for triangle in 0..cube.triangles.len() {
        let first = soup.points.len() as u32;
        soup.points.extend(cube.corners(triangle));
        soup.triangles.push([first, first + 1, first + 2]);
    }
    let mut random = Noise::new(11);
    for surface in [&cube, &soup] {
        let search = SurfaceSearch::new(surface).unwrap();
        let mut kinds = [0; 3];
        for _ in 0..500 {
            let point = random.vector();
            let closest = search.closest(&point);
            let signed = search.signed_distance(&point, &closest);
            let is_outside = point.amax() > 1.0;
            assert_eq!(signed > 0.0, is_outside, "{point} {closest:?}");
            assert!((signed.abs() - closest.distance).abs() < 1e-15);
            assert!(!search.is_on_open_border(&closest));
            kinds[match closest.feature {
                Feature::Face => 0,
                Feature::Edge(_) => 1,
                Feature::Vertex(_) => 2,
            }] += 1;
        }
        assert!(kinds.iter().all(|&count| count > 10), "{kinds:?}");
        // An angle-weighted normal at a corner of a cube is along its diagonal, however it is cut.
        let at_corner = search.closest(&Vector::new(2.0, 2.0, 2.0));
        let diagonal = Vector::repeat(1.0 / 3.0_f64.sqrt());
        assert!((search.pseudo_normal(&at_corner) - diagonal).norm() < 1e-14);
    }
}

#[test]
fn an_open_border_is_known() {
    let search = SurfaceSearch::new(&square(10.0, 0.0, 4)).unwrap();
    for (point, is_open) in [
        (Vector::new(1.0, 1.0, 3.0), false),
        (Vector::new(2.5, 2.5, 1.0), false),
        (Vector::new(9.0, 1.0, 3.0), true),
        (Vector::new(9.0, -9.0, 3.0), true),
    ] {
        let closest = search.closest(&point);
        assert_eq!(search.is_on_open_border(&closest), is_open, "{point} {closest:?}");
    }
}

#[test]
fn triangles_without_area_are_left_out_and_a_surface_of_them_is_refused() {
    let mut surface = square(10.0, 0.0, 1);
    surface.points.push(Vector::new(0.0, 0.0, 1.0));
    surface.triangles.insert(0, [4, 4, 4]);
    surface.triangles.push([0, 4, 0]);
    let closest = SurfaceSearch::new(&surface).unwrap().closest(&Vector::new(0.0, 1.0, 1.0));
    assert!((closest.distance - 1.0).abs() < 1e-15 && [1, 2].contains(&closest.triangle));

    let refused = |surface: &TriangleSurface| SurfaceSearch::new(surface).err();
    surface.triangles = vec![[0, 0, 1], [4, 4, 4]];
    assert_eq!(refused(&surface), Some(SearchError::NoArea { triangles: 2 }));
    assert_eq!(refused(&TriangleSurface::default()), Some(SearchError::NoArea { triangles: 0 }));
    surface.points[2].z = f64::NAN;
    assert_eq!(refused(&surface), Some(SearchError::NotFinite { point: 2 }));
    surface.triangles.push([0, 9, 1]);
    let expected = SearchError::PointOutOfRange { triangle: 2, point: 9, points: 5 };
    assert_eq!(refused(&surface), Some(expected));
}

#[test]
fn a_hundred_thousand_equal_triangles_are_searched_all_the_same() {
    let mut surface = square(10.0, 0.0, 1);
    surface.triangles = vec![[0, 1, 2]; 100_000];
    let search = SurfaceSearch::new(&surface).unwrap();
    let closest = search.closest(&Vector::new(1.0, -1.0, 4.0));
    assert!((closest.distance - 4.0).abs() < 1e-14);
    assert_eq!(search.closest(&Vector::repeat(f64::NAN)).distance, f64::INFINITY);
}

#[test]
fn samples_spread_over_every_triangle_and_carry_its_area() {
    let surface = sphere(70.0, Vector::zeros(), 2);
    for density in [1e-3, 0.05, 1.0] {
        let samples = area_sampling::every_triangle(&surface, density);
        let total: f64 = samples.iter().map(|sample| sample.area).sum();
        assert!((total / surface.area() - 1.0).abs() < 1e-12);
        let count = area_sampling::count_of_every_triangle(&surface, density);
        assert_eq!(samples.len(), count as usize);
        let mut seen = vec![false; surface.triangles.len()];
        for sample in &samples {
            seen[sample.triangle as usize] = true;
        }
        assert!(seen.into_iter().all(|seen| seen));
    }
    assert_eq!(area_sampling::equal_areas(&surface, 777).len(), 777);
}

#[test]
fn the_mean_of_a_coordinate_over_samples_is_the_centroid() {
    let triangle = TriangleSurface {
        points: vec![Vector::zeros(), Vector::new(8.0, 0.0, 0.0), Vector::new(0.0, 6.0, 0.0)],
        triangles: vec![[0, 1, 2]],
        node_ids: None,
    };
    for count in [1, 4, 16, 64] {
        let samples = area_sampling::equal_areas(&triangle, count);
        let mean = samples.iter().map(|s| s.point).sum::<Vector>() / count as f64;
        assert!((mean - Vector::new(8.0 / 3.0, 2.0, 0.0)).norm() < 1e-13, "{count} {mean}");
    }
    // Of x² the mean over the triangle is 8²/6.
    let samples = area_sampling::equal_areas(&triangle, 1000);
    let mean = samples.iter().map(|s| s.point.x * s.point.x).sum::<f64>() / 1000.0;
    assert!((mean / (64.0 / 6.0) - 1.0).abs() < 5e-3, "{mean}");
}

#[test]
fn statistics_follow_their_definitions() {
    let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
    let plain = Statistics::plain(&values).unwrap();
    // No interpolation: the 50th, 90th, 95th and 99th of a hundred values.
    assert_eq!((plain.median, plain.p90, plain.p95, plain.p99), (50.0, 90.0, 95.0, 99.0));
    assert_eq!((plain.count, plain.mean, plain.max), (100, 50.5, 100.0));
    assert!((plain.sd - (9999.0_f64 / 12.0).sqrt()).abs() < 1e-12);
    assert!((plain.rms.powi(2) - plain.mean.powi(2) - plain.sd.powi(2)).abs() < 1e-9);

    // A weight of n is the value n times, at any scale of the weights.
    let weighted = Statistics::weighted(&[3.0, -1.0, 2.0, 9.0], &[0.1, 0.2, 0.3, 0.0]).unwrap();
    let repeated = Statistics::plain(&[3.0, -1.0, -1.0, 2.0, 2.0, 2.0]).unwrap();
    for (a, b) in [
        (weighted.mean, repeated.mean),
        (weighted.sd, repeated.sd),
        (weighted.rms, repeated.rms),
        (weighted.median, repeated.median),
        (weighted.p90, repeated.p90),
        (weighted.max, repeated.max),
    ] {
        assert!((a - b).abs() < 1e-14, "{weighted:?} {repeated:?}");
    }
    assert_eq!(weighted.median, 2.0);
}

#[test]
fn values_without_statistics_are_refused_by_name() {
    assert_eq!(Statistics::plain(&[]), Err(StatisticsError::Empty));
    let error = Statistics::plain(&[1.0, f64::INFINITY]).unwrap_err();
    assert_eq!(error, StatisticsError::NotFinite { index: 1, value: f64::INFINITY });
    assert!(matches!(Statistics::plain(&[f64::NAN]), Err(StatisticsError::NotFinite { .. })));
    let error = Statistics::weighted(&[1.0, 2.0], &[1.0, -1.0]).unwrap_err();
    assert_eq!(error, StatisticsError::BadWeight { index: 1, weight: -1.0 });
    let error = Statistics::weighted(&[1.0], &[0.0]).unwrap_err();
    assert_eq!(error, StatisticsError::NoWeight { count: 1 });
    let error = Statistics::weighted(&[1.0], &[]).unwrap_err();
    assert_eq!(error, StatisticsError::NotPaired { values: 1, weights: 0 });
}
