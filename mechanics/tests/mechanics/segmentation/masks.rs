//! Distances, pieces, holes and balls.

use std::collections::VecDeque;
use std::f64::consts::PI;

use mechanics::image::coarsened::coarsened;
use mechanics::image::distance::{distance, squared_distance};
use mechanics::image::holes::filled;
use mechanics::image::morphology::{closed, dilated, eroded, opened};
use mechanics::image::{Connection, Grid, Mask, Pieces};
use mechanics::mesh::Vector;

use super::{image, mask, place, random_mask};

#[test]
fn distances_are_those_to_the_nearest_voxel_of_all() {
    for (seed, spacing) in [(1, [1.0, 1.0, 1.0]), (2, [0.4, 0.4, 3.0]), (3, [2.5, 0.7, 1.1])] {
        for share in [0.003, 0.05, 0.6] {
            let mask = random_mask([13, 9, 11], spacing, share, seed);
            let found = distance(&mask);
            let inside: Vec<Vector> = (0..mask.grid.len())
                .filter(|&voxel| mask.inside[voxel])
                .map(|voxel| place(&mask.grid, voxel))
                .collect();
            for (voxel, &found) in found.iter().enumerate() {
                let here = place(&mask.grid, voxel);
                let wanted = inside.iter().map(|x| (x - here).norm()).fold(f64::INFINITY, f64::min);
                let close = (f64::from(found) - wanted).abs() <= 1e-6 * wanted;
                assert!(close || (wanted.is_infinite() && found.is_infinite()), "{found} {wanted}");
            }
        }
    }
}

#[test]
fn a_coarsened_image_has_the_means_of_its_blocks_where_they_are() {
    // Linear, so that the mean of a block is the value in its middle.
    let value = |x: Vector| 3.0 * x.x - 2.0 * x.y + 0.5 * x.z;
    let fine = image([20, 13, 9], [0.5, 0.5, 2.0], value);
    let coarse = coarsened(&fine, 600).unwrap();
    assert_eq!((coarse.size(), coarse.spacing()), ([10, 6, 9], [1.0, 1.0, 2.0]));
    for index in [[0, 0, 0], [9, 5, 8], [4, 3, 2]] {
        let centre = coarse.centre(index);
        assert!((coarse.at(&centre).unwrap() - value(centre)).abs() < 1e-4);
    }
    assert_eq!(coarsened(&fine, 20 * 13 * 9).unwrap(), fine);
}

#[test]
fn nothing_is_infinitely_far_and_all_is_at_no_distance() {
    let none = mask([5, 4, 3], [1.0, 2.0, 3.0], |_| false);
    assert!(squared_distance(&none).iter().all(|d| *d == f32::INFINITY));
    assert!(squared_distance(&none.complement()).iter().all(|d| *d == 0.0));
}

/// Pieces by flooding, in the order of their first voxels.
fn flooded(mask: &Mask, connection: Connection) -> Vec<Option<usize>> {
    let grid = mask.grid;
    let mut piece = vec![None; grid.len()];
    let mut count = 0;
    for first in (0..grid.len()).filter(|&voxel| mask.inside[voxel]) {
        if piece[first].is_some() {
            continue;
        }
        let mut queue = VecDeque::from([first]);
        piece[first] = Some(count);
        while let Some(voxel) = queue.pop_front() {
            let near = neighbours(&grid, voxel, connection).into_iter();
            for next in near.filter(|&next| mask.inside[next]) {
                if piece[next].is_none() {
                    piece[next] = Some(count);
                    queue.push_back(next);
                }
            }
        }
        count += 1;
    }
    piece
}

fn neighbours(grid: &Grid, voxel: usize, connection: Connection) -> Vec<usize> {
    let index = grid.index(voxel).map(|n| n as i64);
    let most = if connection == Connection::Faces { 1 } else { 3 };
    let mut found = Vec::new();
    for n in 0..27_i64 {
        let by = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
        let steps = by.iter().map(|by| by.abs()).sum::<i64>();
        let there = [0, 1, 2].map(|axis| index[axis] + by[axis]);
        let is_within = (0..3).all(|axis| (0..grid.size[axis] as i64).contains(&there[axis]));
        if (1..=most).contains(&steps) && is_within {
            found.push(grid.number(there.map(|n| n as usize)));
        }
    }
    found
}

#[test]
fn pieces_are_those_that_flooding_finds() {
    for connection in [Connection::Faces, Connection::Corners] {
        for (seed, share) in
            [(1, 0.05), (2, 0.15), (3, 0.3), (4, 0.5), (5, 0.9), (6, 0.0), (7, 1.1)]
        {
            let mask = random_mask([12, 7, 9], [1.0; 3], share, seed);
            let pieces = Pieces::of(&mask, connection);
            let wanted = flooded(&mask, connection);
            let found: Vec<_> = (0..mask.grid.len()).map(|voxel| pieces.piece(voxel)).collect();
            assert_eq!(found, wanted, "{connection:?} {share}");
            let count = |piece| wanted.iter().filter(|found| **found == Some(piece)).count() as u64;
            let sizes: Vec<u64> = (0..pieces.sizes.len()).map(count).collect();
            assert_eq!(pieces.sizes, sizes);
            let largest = pieces.largest_mask(&mask).count() as u64;
            assert_eq!(largest, sizes.iter().copied().max().unwrap_or(0));
        }
    }
}

const BALL: Vector = Vector::new(20.0, 20.0, 20.0);

fn ball(radius: f64) -> impl Fn(Vector) -> bool {
    move |x| (x - BALL).norm() <= radius
}

#[test]
fn a_shell_is_filled_and_one_with_a_tunnel_is_not() {
    let [size, spacing] = [[41, 41, 21].map(|n| n as f64), [1.0, 1.0, 2.0]];
    let size = size.map(|n| n as usize);
    let whole = mask(size, spacing, ball(15.0));
    let shell = mask(size, spacing, |x| ball(15.0)(x) && !ball(11.0)(x));
    assert_eq!(filled(&shell), whole);
    // A hole along z, through the upper wall.
    let is_tunnel = |x: Vector| (x.x - 20.0).abs() < 2.5 && (x.y - 20.0).abs() < 2.5 && x.z > 20.0;
    let open = mask(size, spacing, |x| ball(15.0)(x) && !ball(11.0)(x) && !is_tunnel(x));
    assert_eq!(filled(&open), open);
}

#[test]
fn a_voxel_grows_to_a_ball_in_mm_and_a_ball_shrinks_back() {
    let (size, spacing) = ([41, 41, 21], [1.0, 1.0, 2.0]);
    let point = mask(size, spacing, |x| x == BALL);
    let grown = dilated(&point, 12.0);
    assert_eq!(grown, mask(size, spacing, ball(12.0)));
    let volume = 4.0 / 3.0 * PI * 12.0_f64.powi(3);
    assert!((grown.volume() / volume - 1.0).abs() < 0.02, "{}", grown.volume());
    assert_eq!(eroded(&grown, 11.9).count(), 1);
}

#[test]
fn closing_fills_what_no_ball_fits_into_and_opening_cuts_what_none_fits_through() {
    let (size, spacing) = ([60, 30, 15], [0.5, 1.0, 2.0]);
    // Two blocks with a slit of 4 mm, and the same with a bridge.
    let is_slit = |x: Vector| (13.0..17.0).contains(&x.x);
    let slit = mask(size, spacing, |x| !is_slit(x));
    let all = mask(size, spacing, |_| true);
    assert_eq!(closed(&slit, 2.5), all);
    assert_eq!(closed(&slit, 1.5), slit);
    let is_bridge = |x: Vector| (x.y - 15.0).abs() < 1.5;
    let bridged = mask(size, spacing, |x| !is_slit(x) || is_bridge(x));
    let apart = opened(&bridged, 3.0);
    assert_eq!(Pieces::of(&bridged, Connection::Faces).sizes.len(), 1);
    assert_eq!(Pieces::of(&apart, Connection::Faces).sizes.len(), 2);
}
