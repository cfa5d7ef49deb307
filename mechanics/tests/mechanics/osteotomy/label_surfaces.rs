//! Labelled voxels as closed surfaces.

use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::surface_edges::count_edges;
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::osteotomy::label_surface::label_surface;
use mechanics::osteotomy::{BoneImage, Cut, Osteotomy, Side, label};

use super::labelling::{plane, scan, segment};

/// A ball of radius 9 mm around (12, 12, 12), its value falling by 100 a mm; 200 on its surface.
fn ball(x: Vector) -> f64 {
    200.0 + 100.0 * (9.0 - (x - Vector::repeat(12.0)).norm())
}

fn halves(image: &ImageVolume) -> [TriangleSurface; 2] {
    let cut = Cut::unbounded("cut", plane([12.0, 12.0, 14.3], [0.0, 0.0, 1.0]));
    let segments = vec![
        segment("lower", &[(0, Side::Below)], &[]),
        segment("upper", &[(0, Side::Above)], &[]),
    ];
    let osteotomy = Osteotomy::new(vec![cut], segments).unwrap();
    let bone = BoneImage { image, threshold: 200.0 };
    let labels = label(&bone, &osteotomy).unwrap().labels;
    [0, 1].map(|segment| label_surface(&bone, &osteotomy, &labels, segment))
}

#[test]
fn the_halves_of_a_ball_are_closed_and_lie_on_its_surface_and_on_the_cut() {
    let image = scan([25, 25, 13], ball);
    let surfaces = halves(&image);
    for surface in &surfaces {
        let edges = count_edges(&surface.sorted_sides());
        assert_eq!((edges.open, edges.inconsistent, edges.nonmanifold), (0, 0, 0));
        for point in &surface.points {
            let off_ball = ((point - Vector::repeat(12.0)).norm() - 9.0).abs();
            let off_cut = (point.z - 14.3).abs();
            // Where ball and cut meet, an edge is cut once and ends up to half a voxel early.
            assert!(off_ball.min(off_cut) < 0.3, "{point:?}");
        }
    }
    // The cap above a height of 2.3 mm: pi h^2 (3 R - h) / 3 with h = 6.7.
    let cap = std::f64::consts::PI * 6.7 * 6.7 * (27.0 - 6.7) / 3.0;
    let whole = 4.0 / 3.0 * std::f64::consts::PI * 729.0;
    for (surface, wanted) in surfaces.iter().zip([whole - cap, cap]) {
        let volume = surface.signed_volume();
        // The crease between ball and cut, 55 mm long, is chamfered by about 1 mm².
        assert!((volume / wanted - 1.0).abs() < 0.06, "{volume} {wanted}");
    }
}

#[test]
fn a_mirrored_grid_gives_surfaces_that_face_outwards_too() {
    let upright = scan([25, 25, 13], ball);
    let placement = Placement {
        origin: Vector::new(24.0, 0.0, 0.0),
        steps: [-Vector::x(), Vector::y(), Vector::z() * 2.0],
    };
    let Voxels::F32(values) = upright.voxels() else { panic!() };
    let image = ImageVolume::new([25, 25, 13], placement, Voxels::F32(values.clone())).unwrap();
    let volumes = [&upright, &image].map(|image| halves(image).map(|half| half.signed_volume()));
    assert!(volumes.iter().flatten().all(|volume| *volume > 800.0), "{volumes:?}");
}

#[test]
fn bone_that_leaves_the_scan_is_closed_half_a_voxel_beyond_it() {
    let image = scan([4, 4, 4], |_| 1000.0);
    let osteotomy = Osteotomy::new(vec![], vec![segment("all", &[], &[])]).unwrap();
    let bone = BoneImage { image: &image, threshold: 200.0 };
    let labels = label(&bone, &osteotomy).unwrap().labels;
    let surface = label_surface(&bone, &osteotomy, &labels, 0);
    let edges = count_edges(&surface.sorted_sides());
    assert_eq!((edges.open, edges.inconsistent, edges.nonmanifold), (0, 0, 0));
    let (low, high) = surface.bounds();
    assert_eq!((low, high), (Vector::new(-0.5, -0.5, -1.0), Vector::new(3.5, 3.5, 7.0)));
}
