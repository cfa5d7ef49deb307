//! Where a cut comes into an image.

use super::*;
use crate::osteotomy::{Extent, Plane};

/// Voxels that are no cubes, along axes that are not those of space.
fn labels() -> BoneLabels {
    let steps =
        [Vector::new(0.4, 0.3, 0.0), Vector::new(-0.6, 0.8, 0.1), Vector::new(0.0, -0.2, 2.5)];
    let placement = Placement { origin: Vector::new(-3.0, 7.0, 20.0), steps };
    BoneLabels::new([7, 5, 4], placement, |_| false)
}

#[test]
fn a_cut_comes_into_an_image_where_its_extent_is_near_one_of_the_voxels() {
    let labels = labels();
    let half = 0.5 * labels.placement().steps.iter().map(Vector::norm).sum::<f64>();
    let is_near = |cut: &Cut, voxel: usize| {
        let centre = labels.centre_of(voxel);
        cut.plane().height(&centre).abs() <= half && cut.reaches(&centre)
    };
    let middle = labels.centre([3, 2, 1]);
    let mut met = [0, 0];
    for normal in [Vector::x(), -Vector::z(), Vector::new(2.0, -1.0, 0.3), Vector::repeat(1e-3)] {
        for offset in (-12..=12).map(|step| f64::from(step) * 0.6) {
            let point = middle + Vector::new(0.3, -0.7, 1.0) * offset;
            let plane = Plane::new(point, normal).unwrap();
            let [u, v] = plane.axes();
            let corners = [u, v, -u - v].map(|way| point + 1.5 * way).to_vec();
            let extents = [Extent::Disc { radius: 0.8 }, Extent::Polygon { corners }];
            for extent in extents.into_iter().map(Some).chain([None]) {
                let cut = Cut::new("c", plane, extent, 0.0).unwrap();
                let wanted = (0..labels.bytes().len()).any(|voxel| is_near(&cut, voxel));
                assert_eq!(labels.is_met_by(&cut), wanted, "{normal} {offset} {cut:?}");
                met[usize::from(wanted)] += 1;
            }
        }
    }
    assert!(met.iter().all(|count| *count > 50), "{met:?}");
}
