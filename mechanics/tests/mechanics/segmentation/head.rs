//! A made head: skin apart from airways, and what lies around it.

use mechanics::image::{ImageVolume, Mask, outer_skin};
use mechanics::mesh::Vector;

use super::image;

/// What a made head may have.
#[derive(Clone, Copy)]
pub struct Made {
    /// Between the lips, in mm.
    pub gap: f64,
    pub table: bool,
    /// Teeth join jaw and skull.
    pub bite: bool,
    pub metal: bool,
    /// How far the head is moved to the left, in mm.
    pub aside: f64,
}

pub const PLAIN: Made = Made { gap: 0.0, table: false, bite: false, metal: false, aside: 0.0 };

const SIZE: [usize; 3] = [100, 110, 100];
const SPACING: [f64; 3] = [1.5, 1.5, 2.0];

/// A head with a nose that looks to the front (-y) in air, a throat that opens below, a nostril of 5 mm, a skull and a
/// lower jaw. Its noise is a fixed pattern of 6 HU.
pub fn made(head: Made) -> ImageVolume {
    image(SIZE, SPACING, |x| {
        let noise =
            ((x.x * 12.9898 + x.y * 78.233 + x.z * 37.719).sin() * 43758.5453).fract() * 12.0;
        value(head, x - Vector::new(head.aside, 0.0, 0.0)) + noise
    })
}

fn value(head: Made, x: Vector) -> f64 {
    let from = x - Vector::new(75.0, 90.0, 100.0);
    if head.table && (150.0..155.0).contains(&x.y) && from.y > 0.0 {
        return -200.0;
    }
    let is_head =
        (from.x / 55.0).powi(2) + (from.y / 58.0).powi(2) <= 1.0 && x.z < 185.0 && x.z > 20.0
            || (x - Vector::new(75.0, 90.0, 20.0)).xy().norm() < 35.0 && x.z <= 20.0;
    let is_nose = (x - Vector::new(75.0, 30.0, 120.0)).norm() < 12.0;
    if !is_head && !is_nose {
        return -1000.0;
    }
    if is_airway(x) || (x.z - 90.0).abs() < head.gap / 2.0 && x.y < 60.0 {
        return -1000.0;
    }
    let is_metal = head.metal && (x - Vector::new(75.0, 48.0, 96.0)).norm() < 4.0;
    if is_metal {
        return 3000.0;
    }
    if head.metal && (x.z - 96.0).abs() < 5.0 {
        // Streaks: stripes from row to row.
        let stripe = if (x.x / 1.5).round() as i64 % 2 == 0 { 90.0 } else { -90.0 };
        return 40.0 + stripe;
    }
    if is_bone(head, from, x) { 900.0 } else { 40.0 }
}

/// A nostril, the cavity behind it and the throat, to the lower end.
fn is_airway(x: Vector) -> bool {
    let is_throat = (x - Vector::new(75.0, 100.0, 0.0)).xy().norm() < 9.0 && x.z < 112.0;
    let is_cavity = (x - Vector::new(75.0, 70.0, 112.0)).norm() < 14.0;
    let is_passage =
        (x.x - 75.0).abs() < 8.0 && (70.0..100.0).contains(&x.y) && (104.0..112.0).contains(&x.z);
    let is_nostril = (x.x - 75.0).abs() < 2.5 && x.y < 70.0 && (x.z - 112.0).abs() < 2.5;
    is_throat || is_cavity || is_passage || is_nostril
}

fn is_bone(head: Made, from: Vector, x: Vector) -> bool {
    let ring = ((from.x / 55.0).powi(2) + (from.y / 58.0).powi(2)).sqrt();
    let is_ring = (0.78..0.9).contains(&ring);
    let is_skull = is_ring && x.z > 100.0 && x.z < 180.0;
    let is_jaw = is_ring && from.y < 0.0 && (50.0..80.0).contains(&x.z);
    let is_tooth = head.bite && is_ring && from.y < -40.0 && (80.0..=100.0).contains(&x.z);
    is_skull || is_jaw || is_tooth
}

#[test]
fn the_skin_is_what_is_seen_from_outside_and_airways_are_within() {
    let scan = made(Made { table: true, ..PLAIN });
    let solid = Mask::above(&scan, -500.0);
    let found = outer_skin(&solid, 2, 4.0);
    let takes = |rule: &dyn Fn(Vector) -> bool| super::mask(SIZE, SPACING, rule);
    let airways = takes(&|x| value(PLAIN, x) == -1000.0 && is_airway(x) && x.y > 45.0);
    // The mouth of the nostril may belong to either side.
    let missed = airways.without(&found.airways).count();
    assert!(missed * 100 < airways.count(), "{missed} of {}", airways.count());
    let outside = takes(&|x| value(PLAIN, x) == -1000.0 && !is_airway(x));
    let taken = outside.and(&found.head).count();
    assert!(taken * 1000 < outside.count(), "{taken} of {}", outside.count());
    let table = takes(&|x| (150.0..155.0).contains(&x.y));
    assert_eq!(table.without(&found.other).count(), 0);
    assert_eq!(found.other.count(), table.count());
    assert_eq!(found.tissue.without(&found.head).count(), 0);
}

#[test]
fn a_throat_that_opens_at_the_end_of_the_scan_stays_an_airway() {
    let scan = made(PLAIN);
    let found = outer_skin(&Mask::above(&scan, -500.0), 2, 4.0);
    let grid = found.head.grid;
    let throat = grid.number([50, 67, 0]);
    assert!(found.airways.inside[throat] && found.head.inside[throat]);
}
