//! Simplified surfaces: closed as before, within the bound both ways, with edges as short as they have to be.

use mechanics::mesh::SurfaceSearch;
use mechanics::mesh::surface_edges::{EdgeCounts, count_edges};
use mechanics::mesh::{TriangleSurface, Vector, area_sampling};
use mechanics::progress::Unobserved;
use mechanics::simplification::{SimplificationError, SimplificationSettings, simplify};

use crate::surfaces::{head, map, sphere, square};

fn anything(_: &Vector) -> f64 {
    f64::INFINITY
}

fn within(surface: &TriangleSurface, deviation: f64) -> TriangleSurface {
    let settings = SimplificationSettings { deviation, triangles: None, longest: &anything };
    simplify(surface, &settings, &Unobserved).unwrap()
}

/// The largest distance from points all over one surface to the other.
fn farthest(from: &TriangleSurface, to: &TriangleSurface) -> f64 {
    let search = SurfaceSearch::new(to).unwrap();
    let samples = area_sampling::every_triangle(from, 3.0);
    let points = samples.iter().map(|sample| &sample.point).chain(&from.points);
    points.map(|point| search.closest(point).distance).fold(0.0, f64::max)
}

fn counts(surface: &TriangleSurface) -> EdgeCounts {
    count_edges(&surface.sorted_sides())
}

#[test]
fn a_head_keeps_within_the_bound_both_ways_with_a_tenth_of_its_triangles() {
    for (deviation, share, levels) in [(0.1, 0.35, 5), (0.5, 0.1, 6)] {
        let given = head(levels);
        let simple = within(&given, deviation);
        let left = simple.triangles.len() as f64 / given.triangles.len() as f64;
        assert!(left < share, "{left} of {} within {deviation} mm", given.triangles.len());
        let [out, back] = [farthest(&simple, &given), farthest(&given, &simple)];
        assert!(out <= deviation && back <= deviation, "{out} {back} {deviation}");
        assert_eq!(counts(&simple), EdgeCounts::default());
        // Euler's number of a sphere.
        let (points, triangles) = (simple.points.len() as i64, simple.triangles.len() as i64);
        assert_eq!(points - 3 * triangles / 2 + triangles, 2);
        // Quadrics keep the volume within a part of what the bound would allow.
        let off = (simple.signed_volume() - given.signed_volume()).abs() / given.area();
        assert!(off < 0.35 * deviation, "{off} mm of {deviation}");
    }
}

#[test]
fn the_same_surface_is_simplified_to_the_same_bits() {
    let given = head(4);
    assert_eq!(within(&given, 0.5), within(&given, 0.5));
}

#[test]
fn no_new_edge_is_longer_than_tissue_is_thick() {
    let given = sphere(40.0, Vector::zeros(), 5);
    let longest = |point: &Vector| if point.z > 0.0 { 6.0 } else { 14.0 };
    let settings = SimplificationSettings { deviation: 1.0, triangles: None, longest: &longest };
    let simple = simplify(&given, &settings, &Unobserved).unwrap();
    let mut mean = [(0.0, 0); 2];
    for triangle in 0..simple.triangles.len() {
        let corners = simple.corners(triangle);
        for (a, b) in [(corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])]
        {
            let allowed = longest(&a).min(longest(&b));
            assert!((a - b).norm() <= allowed, "{a} {b}");
            let half = &mut mean[usize::from(a.z > 0.0 && b.z > 0.0)];
            *half = (half.0 + (a - b).norm(), half.1 + 1);
        }
    }
    let [below, above] = mean.map(|(sum, count)| sum / f64::from(count));
    assert!(below > 1.5 * above, "{below} {above}");
}

#[test]
fn flat_sheets_keep_their_border_and_what_stops_at_a_count_stops_there() {
    let sheet = square(60.0, 3.0, 24);
    let simple = within(&sheet, 0.01);
    assert!(simple.triangles.len() < 40, "{}", simple.triangles.len());
    assert!((simple.area() - 3600.0).abs() < 1e-6, "{}", simple.area());
    let ((low, high), (sheet_low, sheet_high)) = (simple.bounds(), sheet.bounds());
    assert!((low - sheet_low).amax() < 1e-9 && (high - sheet_high).amax() < 1e-9);
    let settings =
        SimplificationSettings { deviation: 5.0, triangles: Some(2000), longest: &anything };
    let some = simplify(&head(5), &settings, &Unobserved).unwrap();
    assert!((1999..=2000).contains(&some.triangles.len()), "{}", some.triangles.len());
}

#[test]
fn what_is_not_manifold_stays_and_what_is_no_surface_is_refused() {
    // Two balls that share an edge of four triangles: the fan stays, the rest is simplified.
    let ball = sphere(20.0, Vector::zeros(), 4);
    let [a, b, _] = ball.triangles[0];
    let middle = (ball.points[a as usize] + ball.points[b as usize]) * 0.5;
    let mut fin = ball.clone();
    fin.points.push(middle * 1.4);
    fin.triangles.push([b, a, ball.points.len() as u32]);
    let simple = within(&fin, 0.5);
    assert!(simple.triangles.len() < ball.triangles.len() / 3);
    assert_eq!((counts(&fin).nonmanifold, counts(&simple).nonmanifold), (1, 1));
    assert!(simple.points.contains(&ball.points[a as usize]));

    let nothing = map(&ball, |_| Vector::zeros());
    let settings = SimplificationSettings { deviation: 0.5, triangles: None, longest: &anything };
    let error = simplify(&nothing, &settings, &Unobserved).unwrap_err();
    assert!(matches!(error, SimplificationError::Surface(_)), "{error}");
    for deviation in [0.0, -1.0, f64::NAN, 1e9] {
        let settings = SimplificationSettings { deviation, triangles: None, longest: &anything };
        let error = simplify(&ball, &settings, &Unobserved).unwrap_err();
        assert!(matches!(error, SimplificationError::Deviation { .. }), "{error}");
    }
}
