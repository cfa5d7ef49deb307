//! Labelled voxels as closed surfaces.

use mechanics::anatomy::{AnatomyRules, part_bone};
use mechanics::domain::ImageOptions;
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::surface_edges::count_edges;
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::osteotomy::cut_face::cut_faces;
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

#[test]
fn a_saw_of_any_width_across_a_box_leaves_one_outline_with_the_area_of_the_box() {
    // A box of 30 by 14 by 30 mm, cut by a plane that is tilted by twenty degrees.
    let half = Vector::new(15.0, 7.0, 15.0);
    let middle = Vector::new(20.2, 12.3, 20.1);
    let image = scan([41, 25, 21], |x| 200.0 - 100.0 * ((x - middle).abs() - half).max());
    let tilt = 20.0_f64.to_radians();
    let normal = [0.0, -tilt.sin(), tilt.cos()];
    for kerf in [0.0, 0.3, 0.6, 1.0, 2.0] {
        let cut = Cut::new("cut", plane(middle.into(), normal), None, kerf).unwrap();
        let osteotomy =
            Osteotomy::new(vec![cut], vec![segment("lower", &[(0, Side::Below)], &[])]).unwrap();
        let bone = BoneImage { image: &image, threshold: 200.0 };
        let labels = label(&bone, &osteotomy).unwrap().labels;
        let surface = label_surface(&bone, &osteotomy, &labels, 0);
        // Voxels of 1 by 1 by 2 mm.
        let faces = cut_faces(&osteotomy, &[surface], 2.0_f64.cbrt());
        let [face] = &faces[..] else { panic!("{} faces", faces.len()) };
        let wanted = 30.0 * 14.0 / tilt.cos();
        println!("kerf {kerf}: {} outlines, {} of {wanted} mm2", face.paths.len(), face.area);
        assert_eq!(face.paths.len(), 1, "kerf {kerf}");
        assert!((face.area / wanted - 1.0).abs() < 0.05, "kerf {kerf}: {} of {wanted}", face.area);
    }
}

#[test]
fn the_volume_of_a_segment_is_that_within_its_surface_and_not_of_its_voxels() {
    // A box whose faces lie between voxels: 19 by 19 by 9 of them have their centres in it.
    let (half, middle) = (9.9, Vector::repeat(12.0));
    let image = scan([25, 25, 13], |x| 200.0 - 100.0 * ((x - middle).amax() - half));
    let rules = AnatomyRules {
        image: ImageOptions { bone_threshold: 200.0, ..ImageOptions::default() },
        osteotomy: Osteotomy::new(vec![], vec![segment("all", &[], &[])]).unwrap(),
        ..AnatomyRules::default()
    };
    let parted = part_bone(&image, &rules).unwrap();
    let [solid] = parted.solids()[..] else { panic!("one segment") };
    let wanted = (2.0 * half).powi(3);
    println!(
        "{} of {wanted} mm3, {} by voxels",
        solid.volume_mm3, parted.labelled.segments[0].volume_mm3
    );
    assert!((solid.volume_mm3 / wanted - 1.0).abs() < 0.03, "{solid:?}");
    assert!((solid.centre - middle).norm() < 0.05, "{solid:?}");
    assert!(parted.labelled.segments[0].volume_mm3 < 0.9 * wanted);
}
