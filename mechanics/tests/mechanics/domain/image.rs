//! The tissue of a made CT: spheres sampled with partial volume.

use mechanics::domain::{Ball, Limit};
use mechanics::domain::{Boundary, Coverage, Domain, ImageDomain, ImageDomainError, ImageOptions};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::Vector;

use super::{directions, part};

const AIR: f64 = -1000.0;
const FLESH: f64 = 50.0;
const BONE: f64 = 950.0;
/// Half way between two materials, where a boundary of equal parts lies.
const MIDDLE: (f64, f64) = (-475.0, 500.0);
const SKIN_RADIUS: f64 = 40.0;
const BONE_RADIUS: f64 = 27.0;

/// The middle of the sphere, off every voxel.
fn centre() -> Vector {
    Vector::new(0.31, -0.17, 0.53)
}

/// Each voxel is the mean of 6 x 6 x 6 points in it.
fn image(spacing: [f64; 3], half: f64, at: impl Fn(&Vector) -> f64) -> ImageVolume {
    const PARTS: usize = 6;
    let size = spacing.map(|step| (2.0 * half / step).ceil() as usize + 1);
    let [x, y, z] = spacing;
    let steps = [Vector::x() * x, Vector::y() * y, Vector::z() * z];
    let placement = Placement { origin: Vector::repeat(-half), steps };
    let part = |n: usize| (n as f64 + 0.5) / PARTS as f64 - 0.5;
    let voxel = |n: usize| {
        let index = [n % size[0], n / size[0] % size[1], n / (size[0] * size[1])];
        let middle =
            (0..3).fold(placement.origin, |sum, axis| sum + steps[axis] * index[axis] as f64);
        let sum: f64 = (0..PARTS.pow(3))
            .map(|m| {
                let [i, j, k] = [m % PARTS, m / PARTS % PARTS, m / (PARTS * PARTS)].map(part);
                at(&(middle + steps[0] * i + steps[1] * j + steps[2] * k))
            })
            .sum();
        (sum / PARTS.pow(3) as f64) as f32
    };
    let values = (0..size.iter().product()).map(voxel).collect();
    ImageVolume::new(size, placement, Voxels::F32(values)).unwrap()
}

fn shell(point: &Vector) -> f64 {
    match (point - centre()).norm() {
        r if r > SKIN_RADIUS => AIR,
        r if r > BONE_RADIUS => FLESH,
        _ => BONE,
    }
}

fn options(smoothing: f64) -> ImageOptions {
    let (skin_threshold, bone_threshold) = MIDDLE;
    ImageOptions { skin_threshold, bone_threshold, smoothing, ..ImageOptions::default() }
}

#[test]
fn padding_and_broken_voxels_move_no_boundary() {
    let clean = image([2.0; 3], 50.0, shell);
    let Voxels::F32(values) = clean.voxels() else { panic!("floats") };
    let size = clean.size();
    let is_border = |n: &usize| {
        let index = [n % size[0], n / size[0] % size[1], n / (size[0] * size[1])];
        (0..3).any(|axis| index[axis] < 2 || index[axis] + 2 >= size[axis])
    };
    let wanted = errors(&ImageDomain::new(&clean, &options(0.8)).unwrap());
    // The usual padding of a scanner, and what programs write where there is no data.
    for padding in [-2000.0, -32_768.0, -3.4e38] {
        let mut values = values.clone();
        (0..values.len()).filter(is_border).for_each(|n| values[n] = padding);
        // Inside bone.
        let middle = [size[0] / 2, size[1] / 2, size[2] / 2];
        values[middle[0] + size[0] * (middle[1] + size[1] * middle[2])] = 1e30;
        let padded = ImageVolume::new(size, *clean.placement(), Voxels::F32(values)).unwrap();
        let found = errors(&ImageDomain::new(&padded, &options(0.8)).unwrap());
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found[1] - wanted[1]).abs() < 0.02, "{padding}: {found:?} {wanted:?}");
        }
    }
}

/// Root mean square and largest error of both radii, in mm.
fn errors(domain: &ImageDomain) -> [[f64; 2]; 2] {
    let middle = 0.5 * (SKIN_RADIUS + BONE_RADIUS);
    [(SKIN_RADIUS, 6.0, Boundary::Skin), (BONE_RADIUS, -6.0, Boundary::Bone)].map(
        |(radius, beyond, boundary)| {
            let (mut squares, mut most) = (0.0, 0.0f64);
            for direction in directions(500) {
                let inside = centre() + direction * middle;
                let outside = centre() + direction * (radius + beyond);
                let crossing = domain.crossing(&inside, &outside);
                assert_eq!(crossing.boundary, boundary);
                let error = (crossing.point - centre()).norm() - radius;
                squares += error * error;
                most = most.max(error.abs());
            }
            [(squares / 500.0).sqrt(), most]
        },
    )
}

#[test]
fn both_surfaces_of_a_shell_lie_within_a_fraction_of_the_voxels_and_converge() {
    let mut last = f64::INFINITY;
    // In mm, root mean square over both spheres, by voxels.
    for (spacing, smoothing, bound) in
        [([3.2, 3.2, 3.0], 1.0, 0.16), ([3.2, 3.2, 1.5], 0.8, 0.14), ([1.6, 1.6, 1.5], 0.8, 0.07)]
    {
        let image = image(spacing, 48.0, shell);
        let domain = ImageDomain::new(&image, &options(smoothing)).unwrap();
        let [skin, bone] = errors(&domain);
        println!("{spacing:?}: skin {skin:?}, bone {bone:?}");
        let worst = skin[0].max(bone[0]);
        assert!(worst < bound, "{spacing:?}: {skin:?} {bone:?}");
        assert!(worst < last);
        last = worst;
    }
}

#[test]
fn the_value_has_the_sign_of_tissue_and_is_finite_anywhere() {
    let domain = ImageDomain::new(&image([3.2, 3.2, 1.5], 48.0, shell), &options(0.8)).unwrap();
    for direction in directions(300) {
        for (radius, is_tissue) in [(20.0, false), (30.0, true), (37.0, true), (44.0, false)] {
            let value = domain.value(&(centre() + direction * radius));
            assert_eq!(value > 0.0, is_tissue, "{radius}: {value}");
        }
    }
    for strange in [f64::NAN, f64::INFINITY, -1e300, 1e30] {
        let point = Vector::repeat(strange);
        assert!(domain.value(&point).is_finite() && domain.value(&point) <= 0.0, "{strange}");
        assert_ne!(domain.coverage(&point, 1.0), Coverage::Inside);
        let _ = (domain.thickness(&point), domain.projection(&point, Boundary::Bone));
        let _ = domain.crossing(&centre(), &point);
    }
}

#[test]
fn no_ball_is_called_inside_or_outside_that_is_not() {
    let limits = vec![
        Limit::HalfSpace { point: Vector::z() * -10.0, normal: Vector::z() },
        Limit::Balls(vec![
            Ball { centre: Vector::x() * 20.0, radius: 30.0 },
            Ball { centre: Vector::y() * -20.0, radius: 35.0 },
        ]),
    ];
    let image = image([3.2, 3.2, 1.5], 48.0, shell);
    let domain = ImageDomain::new(&image, &ImageOptions { limits, ..options(0.8) }).unwrap();
    let mut known = [0, 0];
    for n in 0..20_000 {
        let middle =
            [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|step| part(n, step) * 110.0 - 55.0);
        let (middle, radius) = (Vector::from(middle), 0.3 + 9.0 * part(n, 0.618_034).powi(2));
        let coverage = domain.coverage(&middle, radius);
        let wanted = match coverage {
            Coverage::Inside => true,
            Coverage::Outside => false,
            Coverage::Mixed => continue,
        };
        known[usize::from(wanted)] += 1;
        for direction in directions(24) {
            for share in [0.0, 0.5, 1.0] {
                let value = domain.value(&(middle + direction * (radius * share)));
                assert_eq!(value > 0.0, wanted, "{middle} {radius} {coverage:?}: {value}");
            }
        }
    }
    println!("outside {}, inside {} of 20000", known[0], known[1]);
    assert!(known[0] > 10_000 && known[1] > 150, "{known:?}");
}

#[test]
fn a_point_beside_a_boundary_is_projected_onto_it_and_a_far_one_stays() {
    let plane = Limit::HalfSpace { point: Vector::zeros(), normal: Vector::z() };
    let image = image([3.2, 3.2, 1.5], 48.0, shell);
    let options = ImageOptions { limits: vec![plane], ..options(0.8) };
    let domain = ImageDomain::new(&image, &options).unwrap();
    for direction in directions(200).filter(|direction| direction.z > 0.1) {
        for (radius, boundary) in [(SKIN_RADIUS, Boundary::Skin), (BONE_RADIUS, Boundary::Bone)] {
            for off in [-1.5, -0.3, 0.4, 1.2] {
                let start = centre() + direction * (radius + off);
                let found = domain.projection(&start, boundary);
                let error = (found - centre()).norm() - radius;
                assert!(error.abs() < 0.35, "{boundary:?} {off}: {error}");
                // As near as the sphere itself, but for the image's errors.
                assert!((found - start).norm() < off.abs() + 0.35);
                assert!(domain.value(&found).abs() < 1e-3);
            }
        }
    }
    let cut = Vector::new(33.0, 3.0, 0.6);
    assert_eq!(domain.projection(&cut, Boundary::Cut), Vector::new(33.0, 3.0, 0.0));
    let below = centre() + Vector::new(39.0, 5.0, -1.3);
    let crease = domain.projection(&below, Boundary::Skin);
    assert!(crease.z.abs() < 2e-3 && domain.value(&crease).abs() < 2e-3, "{crease}");
    let middle = centre() + Vector::z() * 33.5;
    assert_eq!(domain.projection(&centre(), Boundary::Skin), centre());
    assert!((domain.projection(&middle, Boundary::Skin) - middle).norm() < 9.7);
}

#[test]
fn the_thickness_is_the_distance_from_skin_to_bone() {
    let domain = ImageDomain::new(&image([3.2, 3.2, 1.5], 48.0, shell), &options(0.8)).unwrap();
    let wanted = SKIN_RADIUS - BONE_RADIUS;
    for direction in directions(200) {
        for radius in [25.0, 28.0, 33.0, 39.0, 41.0] {
            let found = domain.thickness(&(centre() + direction * radius));
            // A voxel of 3.2 mm and some tenths: it is the distance between voxels, and bounds the size of cells.
            assert!((found - wanted).abs() < 3.8, "{radius} {direction}: {found}");
        }
    }
    let soft = image([3.2; 3], 48.0, |point| shell(point).min(FLESH));
    let domain = ImageDomain::new(&soft, &options(0.8)).unwrap();
    assert_eq!(domain.thickness(&centre()), f64::INFINITY);
}

#[test]
fn where_the_image_ends_the_tissue_is_cut() {
    let image = image([3.2, 3.2, 1.5], 35.0, shell);
    let domain = ImageDomain::new(&image, &options(0.8)).unwrap();
    let inside = centre() + Vector::x() * 33.0;
    let crossing = domain.crossing(&inside, &(inside + Vector::x() * 5.0));
    let (_, high) = image.bounds();
    assert_eq!(crossing.boundary, Boundary::Cut);
    assert!((crossing.point.x - high.x).abs() < 1e-3, "{crossing:?}");
}

#[test]
fn air_inside_the_head_bounds_an_airway() {
    let mouth = |point: &Vector| point.z.abs() < 4.0 && point.x > 29.0 && point.y.abs() < 9.0;
    let lips = |point: &Vector| point.x > 36.0 && point.z.abs() > 1.0;
    let image = image([1.6, 1.6, 1.5], 48.0, |point| match mouth(point) && !lips(point) {
        true => AIR,
        false => shell(point),
    });
    let domain = ImageDomain::new(&image, &options(0.6)).unwrap();
    let roof = domain.crossing(&Vector::new(33.0, 0.0, 8.0), &Vector::new(33.0, 0.0, 1.0));
    assert_eq!(roof.boundary, Boundary::Airway, "{roof:?}");
    assert!((roof.point.z - 4.0).abs() < 0.3, "{roof:?}");
    let cheek = domain.crossing(&Vector::new(0.0, 36.0, 0.0), &Vector::new(0.0, 44.0, 0.0));
    assert_eq!(cheek.boundary, Boundary::Skin);
    // From the skin to the mouth, not to the jaw behind it.
    let found = domain.thickness(&Vector::new(33.0, 0.0, 8.0));
    assert!(found < 11.0, "{found}");
}

#[test]
fn options_that_leave_nothing_are_refused_with_their_numbers() {
    let image = image([6.0; 3], 48.0, shell);
    let refused = |change: &dyn Fn(&mut ImageOptions)| {
        let mut options = options(0.8);
        change(&mut options);
        ImageDomain::new(&image, &options).unwrap_err()
    };
    let found = refused(&|options| options.skin_threshold = 600.0);
    assert_eq!(found, ImageDomainError::Thresholds { skin: 600.0, bone: 500.0 });
    let found = refused(&|options| options.smoothing = f64::NAN);
    assert!(matches!(found, ImageDomainError::Length { name: "smoothing", .. }));
    let found = refused(&|options| {
        (options.skin_threshold, options.bone_threshold) = (2000.0, 3000.0);
    });
    assert!(matches!(found, ImageDomainError::NoTissue { high: 950.0, .. }), "{found}");
}
