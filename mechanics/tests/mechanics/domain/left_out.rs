//! Scans of several bodies.

use mechanics::anatomy::left_out::left_out_of_scan;
use mechanics::domain::{ImageDomain, ImageDomainError, ImageOptions};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::{Vector, Warning};

/// Balls of 30 mm radius of tissue around bone of 18 mm radius, 76 mm apart along x, in voxels of 4 mm.
fn balls(count: usize) -> Result<ImageDomain, ImageDomainError> {
    let size = [19 * count + 2, 21, 21];
    let steps = [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * 4.0);
    let at = |voxel: usize| {
        let index = [voxel % size[0], voxel / size[0] % size[1], voxel / (size[0] * size[1])];
        let place = Vector::from(index.map(|index| 4.0 * index as f64));
        let nearest = ((place.x - 40.0) / 76.0).round().clamp(0.0, count as f64 - 1.0);
        match (place - Vector::new(40.0 + 76.0 * nearest, 40.0, 40.0)).norm() {
            r if r < 18.0 => 700.0,
            r if r < 30.0 => 40.0,
            _ => -1000.0,
        }
    };
    let values = (0..size.iter().product()).map(at).collect();
    let placement = Placement { origin: Vector::zeros(), steps };
    let image = ImageVolume::new(size, placement, Voxels::F32(values)).unwrap();
    ImageDomain::new(&image, &ImageOptions::default())
}

#[test]
fn a_second_body_is_reported_with_its_size_and_its_place() {
    let domain = balls(2).unwrap();
    let left = domain.left_out();
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 27.0;
    assert_eq!(left.pieces, 1);
    assert!((left.all / ball - 1.0).abs() < 0.05 && left.largest == left.all, "{left:?}");
    assert!((left.kept / left.all - 1.0).abs() < 1e-9, "{left:?}");
    assert!((left.centre - Vector::new(116.0, 40.0, 40.0)).norm() < 1e-9, "{left:?}");
    // It is no table, though the report calls it an object beside the head.
    for told in [vec![], vec![Warning::new("objects-beside-head", "")]] {
        let warning = left_out_of_scan(left, &told).unwrap();
        assert_eq!(warning.code, "tissue-left-out");
        assert!(warning.detail.contains("(116, 40, 40)"), "{}", warning.detail);
    }
    assert_eq!(left_out_of_scan(balls(1).unwrap().left_out(), &[]), None);
}

#[test]
fn a_scan_of_which_little_would_be_kept_is_refused() {
    let refused = balls(4).unwrap_err();
    let ImageDomainError::Scattered { pieces, all, kept } = refused else { panic!("{refused}") };
    assert!(pieces == 4 && (all / kept - 4.0).abs() < 1e-9, "{refused}");
}
