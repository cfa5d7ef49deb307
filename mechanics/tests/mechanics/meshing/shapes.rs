//! Volumes, distances and angles of meshes of balls, shells, rings and boxes.

use std::f64::consts::PI;

use mechanics::domain::Boundary;
use mechanics::mesh::{SurfaceSearch, Vector};
use mechanics::meshing::{MeshingSettings, SizeField};

use super::domains::{Body, ball, balls, block, shell, torus};
use super::{assert_sound, meshed, off_sphere, on_sphere, surface, uniform};

#[test]
fn the_volumes_of_balls_shells_and_rings_are_met_to_a_ten_thousandth() {
    let ball_of = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
    let bodies = [
        (ball(50.0), ball_of(50.0)),
        (shell(30.0, 42.0), ball_of(42.0) - ball_of(30.0)),
        (torus(30.0, 11.0), 2.0 * PI * PI * 30.0 * 11.0 * 11.0),
    ];
    for (body, exact) in bodies {
        for size in [8.0, 4.0, 2.5] {
            let off = meshed(&body, &uniform(size)).report.volume / exact - 1.0;
            // Chords alone lack .2 % at 4 mm of the ball, 1.2 % of the ring.
            assert!(off.abs() < if size > 5.0 { 3e-4 } else { 1e-4 }, "{size} {off}");
        }
    }
}

#[test]
fn stuffing_alone_keeps_the_angle_that_is_proven_of_it() {
    for size in [3.0, 4.1, 5.3] {
        let settings = MeshingSettings { sweeps: 0, ..uniform(size) };
        let angles = assert_sound(&meshed(&ball(40.0), &settings));
        assert!(angles[0] > 10.78 && angles[1] < 164.74, "{angles:?}");
    }
}

#[test]
fn hill_climbing_brings_smooth_bodies_above_twenty_degrees() {
    for body in
        [ball(40.0), shell(30.0, 42.0), torus(30.0, 11.0), block(Vector::new(20.0, 16.0, 12.0))]
    {
        let tissue = meshed(&body, &uniform(4.0));
        let angles = assert_sound(&tissue);
        assert!(angles[0] > 20.0 && angles[1] < 160.0, "{angles:?}");
        // Above thirty degrees a cell is good, and may lose some to its neighbours.
        let raw = tissue.report.raw_angles.smallest;
        assert!(angles[0] > raw.min(30.0) - 1e-9, "{} after {raw}", angles[0]);
    }
}

#[test]
fn hill_climbing_keeps_the_volume_of_bodies_with_ridges() {
    let ridged = |width: f64| {
        let height = move |x: &Vector| 3.0 * (x.x / width).sin() * (x.y / width).sin();
        Body::skin(30.0, move |x| 0.4 * (24.0 - x.norm() + height(x)))
    };
    let finer = SizeField { at_boundary: Some(4.0), ..SizeField::graded(2.0, 8.0) };
    let finer = MeshingSettings { size: finer, ..MeshingSettings::default() };
    for width in [3.0, 4.5] {
        for settings in [uniform(4.0), finer.clone()] {
            let [before, after] = [0, 8].map(|sweeps| {
                let settings = MeshingSettings { sweeps, ..settings.clone() };
                meshed(&ridged(width), &settings).report.volume
            });
            assert!((after / before - 1.0).abs() < 2e-3, "{width}: {before} {after}");
        }
    }
}

#[test]
fn skin_and_bone_of_a_shell_lie_where_they_are_and_all_of_them_is_there() {
    let tissue = meshed(&shell(30.0, 42.0), &uniform(4.0));
    assert_sound(&tissue);
    let boundaries = [(Boundary::Skin, 42.0), (Boundary::Bone, 30.0)];
    for (boundary, radius) in boundaries {
        // Nodes lie as far beyond the boundary as the triangles between them lie within it.
        assert!(off_sphere(&tissue, boundary, radius) < 0.03 * 4.0);
    }
    assert!(tissue.nodes_on(Boundary::Cut).is_empty());
    let skin = surface(&tissue);
    let search = SurfaceSearch::new(&skin).unwrap();
    for point in boundaries.into_iter().flat_map(|(_, radius)| on_sphere(radius, 2000)) {
        // Less than half of the square of the longest edge over eight radii.
        let distance = search.closest(&point).distance;
        assert!(distance < 0.025 * 4.0, "{distance}");
    }
}

#[test]
fn the_boundaries_of_a_box_are_distinguished() {
    let half = Vector::new(20.0, 16.0, 12.0);
    let tissue = meshed(&block(half), &uniform(3.0));
    assert_sound(&tissue);
    type Off = fn(&Vector, &Vector) -> f64;
    // Edges between two sides of skin are rounded.
    let boundaries: [(Boundary, Off, f64); 3] = [
        (Boundary::Skin, |half, at| (half - at.abs()).xy().min(), 0.05 * 3.0),
        (Boundary::Bone, |half, at| at.z + half.z, 1e-6),
        (Boundary::Cut, |half, at| half.z - at.z, 1e-6),
    ];
    for (boundary, off, most) in boundaries {
        let nodes = tissue.nodes_on(boundary);
        assert!(nodes.len() > 100);
        for at in nodes.into_iter().map(|node| tissue.volume.nodes[node as usize]) {
            assert!(off(&half, &at).abs() < most, "{boundary:?} {at:?}");
        }
    }
    // The edges of bone and cut are kept; those between sides, and corners, are cut off by less than a cell.
    assert!(tissue.report.creased > 50, "{:?}", tissue.report);
    let exact = 8.0 * half.product();
    assert!((1.0 - tissue.report.volume / exact).abs() < 5e-3, "{}", tissue.report.volume / exact);
}

#[test]
fn balls_more_than_a_cell_apart_stay_two() {
    let at = Vector::new(21.7, 0.0, 0.0);
    let pair = balls(vec![(at, 20.0), (-at, 20.0)]);
    let both = meshed(&pair, &MeshingSettings { keep_pieces: true, ..uniform(3.0) });
    let one = meshed(&pair, &uniform(3.0));
    assert_sound(&both);
    assert_sound(&one);
    assert!(both.report.dropped.is_empty());
    let [dropped] = one.report.dropped[..] else { panic!("{:?}", one.report.dropped) };
    // What is dropped is measured before its surface encloses what chords cut off.
    let sum = dropped.volume + one.report.volume;
    assert!((sum / both.report.volume - 1.0).abs() < 5e-3, "{}", sum / both.report.volume);
    assert!((dropped.centre.norm() - 21.7).abs() < 0.1);
}

#[test]
fn tissue_that_touches_itself_shares_no_place_where_copies_are_to_be_apart() {
    let at = Vector::new(19.8, 0.0, 0.0);
    let touching = || balls(vec![(-at, 20.0), (at, 20.0)]);
    let settings = MeshingSettings { part_copies: true, ..uniform(3.0) };
    let apart = meshed(&touching(), &settings);
    assert_sound(&apart);
    let shared = |nodes: &[Vector]| {
        let mut bits: Vec<[u64; 3]> =
            nodes.iter().map(|at| [at.x, at.y, at.z].map(f64::to_bits)).collect();
        bits.sort_unstable();
        bits.windows(2).filter(|pair| pair[0] == pair[1]).count()
    };
    let settings = MeshingSettings { part_copies: false, sweeps: 0, ..settings };
    let as_made = meshed(&touching(), &settings);
    assert_sound(&as_made);
    assert!(as_made.report.copies > 0 && shared(&as_made.volume.nodes) > 0, "{:?}", as_made.report);
    assert_eq!(shared(&apart.volume.nodes), 0);
}

#[test]
fn an_empty_pocket_in_tissue_is_bounded_by_bone() {
    let body = Body { thickness: None, ..shell(8.0, 20.0) };
    let tissue = meshed(&body, &uniform(2.0));
    let exact = 4.0 / 3.0 * PI * (20.0_f64.powi(3) - 8.0_f64.powi(3));
    assert!((tissue.report.volume / exact - 1.0).abs() < 0.01);
}
