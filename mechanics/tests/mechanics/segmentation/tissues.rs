//! Thresholds, equal volumes, labels, and bones that touch.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use mechanics::image::equal_volume::{BoneRegion, equal_volume};
use mechanics::image::separation::{Seed, separated};
use mechanics::image::{Histogram, ImageVolume, LabelMap, Mask, Placement, Thresholds, Voxels};
use mechanics::mesh::Vector;

use super::{Random, image, mask, place};

#[test]
fn the_threshold_between_two_values_is_half_way() {
    for (low, high) in [(-995.0, 45.0), (-5.0, 1005.0), (-1000.0, -100.0)] {
        let two = image([10, 10, 10], [1.0; 3], |x| if x.x < 3.0 { low } else { high });
        let threshold = Histogram::of(&two).otsu([-1100.0, 1600.0]).unwrap();
        assert!((threshold - (low + high) / 2.0).abs() <= 10.0, "{threshold}");
    }
    let one = image([4, 4, 4], [1.0; 3], |_| 40.0);
    assert_eq!(Histogram::of(&one).otsu([-1100.0, 1600.0]), None);
}

/// Air, fat, soft tissue and bone in layers, with noise and with the blur of coarse voxels.
fn layers() -> ImageVolume {
    let random = std::cell::RefCell::new(Random(77));
    let mut noise = || (0..6).map(|_| random.borrow_mut().next() - 0.5).sum::<f64>() * 28.0;
    let noise = std::cell::RefCell::new(&mut noise);
    image([120, 40, 40], [1.0; 3], move |x| {
        let ends = [(40.0, -1000.0), (50.0, -100.0), (100.0, 40.0), (120.0, 900.0)];
        // The mean of a voxel of 3 mm.
        let value =
            |x: f64| ends.iter().find(|(end, _)| x < *end).map_or(900.0, |(_, value)| *value);
        let mean = (-3..=3).map(|n| value(x.x + f64::from(n) / 2.0)).sum::<f64>() / 7.0;
        mean + (noise.borrow_mut())()
    })
}

#[test]
fn a_scan_of_air_fat_soft_tissue_and_bone_gives_its_modes_and_thresholds() {
    let found = Thresholds::of(&Histogram::of(&layers())).unwrap();
    assert!((found.air_mode + 1000.0).abs() <= 15.0, "{found:?}");
    assert!((found.soft_mode - 40.0).abs() <= 15.0, "{found:?}");
    assert!((-600.0..-400.0).contains(&found.skin), "{found:?}");
    assert!((180.0..450.0).contains(&found.bone), "{found:?}");
    let no_air = image([4, 4, 4], [1.0; 3], |x| 40.0 + x.x);
    assert_eq!(Thresholds::of(&Histogram::of(&no_air)), None);
}

#[test]
fn values_without_the_intercept_of_the_scanner_give_no_thresholds() {
    let random = std::cell::RefCell::new(Random(5));
    // Padding where air is looked for, air where tissue is.
    let stored = image([60, 40, 40], [1.0; 3], move |x| {
        let noise = 40.0 * (random.borrow_mut().next() - 0.5);
        match x.x {
            x if x < 15.0 => -976.0,
            x if x < 40.0 => 24.0 + noise,
            _ => 1064.0 + noise,
        }
    });
    assert_eq!(Thresholds::of(&Histogram::of(&stored)), None);
}

#[test]
fn the_second_threshold_makes_both_volumes_equal() {
    // The same cone of values about a point, on two grids and with another scale: 1000 - 50 r and 800 - 40 r.
    let cone = |top: f64, slope: f64| {
        move |x: Vector| top - slope * (x - Vector::new(12.0, 12.0, 12.0)).norm()
    };
    let before = image([60, 60, 25], [0.41, 0.41, 1.0], cone(1000.0, 50.0));
    let after = image([55, 55, 25], [0.44, 0.44, 1.0], cone(800.0, 40.0));
    let whole = |image: &ImageVolume| Mask::of(image, |_| true);
    let regions = [whole(&before), whole(&after)];
    let first = BoneRegion { image: &before, region: &regions[0] };
    let second = BoneRegion { image: &after, region: &regions[1] };
    // A ball of 8 mm on both: 600 HU and 480 HU.
    let [one, other] = equal_volume(first, 600.0, second).unwrap();
    let ball = 4.0 / 3.0 * PI * 512.0;
    assert!((one.volume / ball - 1.0).abs() < 0.01, "{one:?} {ball}");
    assert!(
        (one.volume - other.volume).abs() <= 0.5 * after.voxel_volume() + 1e-9,
        "{one:?} {other:?}"
    );
    assert!((other.threshold - 480.0).abs() < 2.0, "{other:?}");
    let small = mask([55, 55, 25], [0.44, 0.44, 1.0], |x| x.norm() < 2.0);
    assert!(equal_volume(first, 600.0, BoneRegion { image: &after, region: &small }).is_none());
    // Half of the ball is cut off: what lies around it has one value, and goes with it or not.
    let middle = Vector::new(12.0, 12.0, 12.0);
    let half = mask([55, 55, 25], [0.44, 0.44, 1.0], |x| x.z > middle.z);
    let ball = |x: Vector| if (x - middle).norm() < 8.0 { 900.0 } else { 0.0 };
    let even = image([55, 55, 25], [0.44, 0.44, 1.0], ball);
    assert!(equal_volume(first, 600.0, BoneRegion { image: &even, region: &half }).is_none());
}

#[test]
fn two_balls_that_touch_are_parted_at_their_neck() {
    let centres = [Vector::new(15.0, 20.0, 20.0), Vector::new(29.0, 20.0, 20.0)];
    let both = mask([50, 41, 21], [1.0, 1.0, 2.0], |x| {
        (x - centres[0]).norm() <= 11.0 || (x - centres[1]).norm() <= 6.0
    });
    let at = |x: f64| Seed { voxels: vec![both.grid.number([x as usize, 20, 10])] };
    // The second seed stands near the surface, as a click does.
    let owner = separated(&both, &[at(15.0), at(33.0)]);
    // The neck is the circle in which both meet: r1² - a² = r2² - (14 - a)², a = (196 + 121 - 36) / 28 from the first.
    let neck = 15.0 + (196.0 + 121.0 - 36.0) / 28.0;
    for (voxel, owner) in owner.iter().enumerate() {
        let x = place(&both.grid, voxel).x;
        match owner {
            None => assert!(!both.inside[voxel]),
            Some(0) => assert!(x < neck + 1.5, "{x} {neck}"),
            Some(_) => assert!(x > neck - 1.5, "{x} {neck}"),
        }
    }
    let alone = separated(&both, &[at(15.0)]);
    assert!(alone.iter().zip(&both.inside).all(|(owner, inside)| owner.is_some() == *inside));
}

#[test]
fn a_label_map_knows_its_regions_by_name_and_size() {
    let labels =
        image([6, 5, 4], [1.0; 3], |x| if x.z < 2.0 { 117.0 } else { (x.x > 3.0) as u8 as f64 });
    let names = BTreeMap::from([
        (117, "skull".to_owned()),
        (1, "mandible".to_owned()),
        (2, "none".to_owned()),
    ]);
    let map = LabelMap::of(&labels.with_label_names(names)).unwrap();
    let regions: Vec<_> = map.regions().iter().map(|r| (r.label, r.name.clone(), r.size)).collect();
    assert_eq!(regions, [(1, "mandible".to_owned(), 20), (117, "skull".to_owned(), 60)]);
    assert_eq!(map.label("Mandible"), Some(1));
    assert_eq!(map.mask(&[1, 117]).count(), 80);
}

#[test]
fn values_that_are_no_whole_numbers_from_0_to_65535_are_no_labels() {
    for bad in [-1.0, 0.5, 65536.0] {
        let image = image([3, 3, 3], [1.0; 3], |x| if x.z > 1.5 { bad } else { 1.0 });
        let refused = LabelMap::of(&image).unwrap_err();
        assert_eq!((refused.voxel, refused.value), (18, bad));
    }
    let placement =
        Placement { origin: Vector::zeros(), steps: [Vector::x(), Vector::y(), Vector::z()] };
    let large = ImageVolume::new([2, 2, 2], placement, Voxels::F32(vec![65535.0; 8])).unwrap();
    assert_eq!(LabelMap::of(&large).unwrap().labels, [65535; 8]);
}
