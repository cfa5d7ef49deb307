//! Cells take their material from an image: docs/verification.md#v37, docs/methods.md#tissue-from-images.

use std::sync::Arc;

use mechanics::image::{
    ImageVolume, MOST_SAMPLES, Placement, SamplingRule, Voxels, Windows, sample_cells,
};
use mechanics::material::LinearElastic;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::prediction::{
    Case, ElementChoice, FibreDirection, Hounsfield, Mixing, Plan, RegionNames, Scene, Settings,
    TissueWindow,
};
use mechanics::progress::StopQuery;

use crate::material::anisotropy::{MUSCLE, fibred};
use crate::scenes::{SHAPES, case_of, constraint, exact, material, solve};

/// A grid of steps of 3 mm, turned out of the axes, with `value` at each centre; it holds all of [-60, 60]³.
fn oblique(value: impl Fn(usize, usize, usize) -> f32) -> ImageVolume {
    let steps =
        [Vector::new(2.9, 0.6, -0.4), Vector::new(-0.7, 2.8, 0.3), Vector::new(0.2, -0.5, 3.0)];
    let middle = steps.iter().fold(Vector::zeros(), |sum, step| sum + step * 40.0);
    let grid = |n: usize| (n % 81, n / 81 % 81, n / 81 / 81);
    let values = (0..81 * 81 * 81).map(|n| {
        let (i, j, k) = grid(n);
        value(i, j, k)
    });
    let placement = Placement { origin: -middle, steps };
    ImageVolume::new([81; 3], placement, Voxels::F32(values.collect())).unwrap()
}

/// A ramp whose values single precision holds exactly.
fn ramp() -> ImageVolume {
    oblique(|i, j, k| i as f32 * 16.0 - j as f32 * 24.0 + k as f32 * 40.0 - 1000.0)
}

/// Values that are linear in position, and the value at a point.
fn linear(image: &ImageVolume, x: &Vector) -> f64 {
    let origin = image.placement().origin;
    let steps = nalgebra::Matrix3::from_columns(&image.placement().steps);
    let index = steps.try_inverse().unwrap() * (x - origin);
    index.dot(&Vector::new(16.0, -24.0, 40.0)) - 1000.0
}

/// Cells of one shape that are sheared copies of a block: their centroid is the mean of their corners.
fn sheared(shape: CellShape) -> VolumeMesh {
    let mut mesh = block(Vector::new(50.0, 40.0, 30.0), [2, 2, 1], shape);
    let shear = nalgebra::Matrix3::new(1.0, 0.3, -0.2, 0.1, 0.9, 0.4, -0.3, 0.2, 1.1);
    mesh.nodes.iter_mut().for_each(|x| *x = shear * (*x - Vector::new(25.0, 20.0, 15.0)));
    mesh
}

fn everything() -> Windows {
    Windows::new(&[(-1e6, 1e6)]).unwrap()
}

#[test]
fn the_mean_of_a_linear_field_is_its_value_at_the_centroid_at_every_count() {
    let image = ramp();
    for shape in SHAPES {
        let mesh = sheared(shape);
        for count in 1..=MOST_SAMPLES {
            let found = sample_cells(
                &mesh,
                &image,
                &SamplingRule::new(count),
                &everything(),
                &StopQuery::never(),
            );
            for cell in 0..mesh.cells.len() {
                let corners: Vec<Vector> = mesh.corners(cell).collect();
                let centroid = corners.iter().sum::<Vector>() / corners.len() as f64;
                let error = found.mean[cell].unwrap() - linear(&image, &centroid);
                // Rounding of values of about 1e3.
                assert!(error.abs() < 1e-9, "{} {count}: {error}", shape.name());
                assert_eq!(found.counts(cell), [count as u16]);
            }
        }
    }
}

/// The share of a tetrahedron with h < c, h linear with these values at its corners (all different).
fn share_below(c: f64, h: [f64; 4]) -> f64 {
    let term = |i: usize| {
        let others = (0..4).filter(|&j| j != i).map(|j| h[j] - h[i]);
        (c - h[i]).max(0.0).powi(3) / others.product::<f64>()
    };
    (0..4).map(term).sum()
}

#[test]
fn the_share_beyond_a_plane_converges_faster_than_the_root_of_the_count() {
    let image = ramp();
    let mesh = sheared(CellShape::Tet4);
    let mut errors = Vec::new();
    for count in [8, 16, 32, 64, 128, 256, 512] {
        let (mut squares, mut planes) = (0.0, 0);
        for cell in 0..mesh.cells.len() {
            let corners: Vec<Vector> = mesh.corners(cell).collect();
            let h: [f64; 4] = std::array::from_fn(|i| linear(&image, &corners[i]));
            let (low, high) = h.iter().fold((h[0], h[0]), |(a, b), &v| (a.min(v), b.max(v)));
            let mut alone = VolumeMesh { nodes: mesh.nodes.clone(), ..VolumeMesh::default() };
            alone.cells.push(CellShape::Tet4, mesh.cells.nodes(cell));
            for part in 1..20 {
                let c = low + (high - low) * f64::from(part) / 20.0;
                let windows = Windows::new(&[(-1e6, c)]).unwrap();
                let found = sample_cells(
                    &alone,
                    &image,
                    &SamplingRule::new(count),
                    &windows,
                    &StopQuery::never(),
                );
                let share = f64::from(found.counts(0)[0]) / count as f64;
                let error = share - share_below(c, h);
                assert!(
                    error.abs() < 1.0 / (count as f64).sqrt(),
                    "{count} {cell} {part}: {error}"
                );
                squares += error * error;
                planes += 1;
            }
        }
        errors.push((squares / f64::from(planes)).sqrt());
    }
    // From 8 to 512 points, six doublings: N^-1/2 would make it 1/8.
    assert!(errors[6] < errors[0] / 8.0, "{errors:?}");
    println!("root mean square error of the share at 8, 16, … 512 points: {errors:?}");
}

/// 60 x 40 x 20 mm with its lower and upper half in regions `low` and `high`.
fn halves(shape: CellShape) -> VolumeMesh {
    let mut mesh = block(Vector::new(60.0, 40.0, 20.0), [6, 4, 4], shape);
    let middle = |cell: usize| mesh.corners(cell).map(|x| x.z).sum::<f64>();
    let count = |cell: usize| mesh.corners(cell).len() as f64;
    let label = |cell: usize| i64::from(middle(cell) / count(cell) > 10.0);
    let labels: Vec<i64> = (0..mesh.cells.len()).map(label).collect();
    mesh.cell_labels.insert("half".to_owned(), labels);
    mesh
}

/// 0 HU below z = 10 and 100 HU above: the values change half a voxel of 1 mm below and above.
fn step() -> Arc<ImageVolume> {
    let placement = Placement {
        origin: Vector::repeat(-0.5),
        steps: [Vector::x() * 61.0, Vector::y() * 41.0, Vector::z()],
    };
    let value = |n: usize| if n / 4 > 10 { 100 } else { 0 };
    let values = (0..2 * 2 * 22).map(value).collect();
    Arc::new(ImageVolume::new([2, 2, 22], placement, Voxels::I16(values)).unwrap())
}

fn window(name: &str, ends: (f64, f64), material: LinearElastic) -> TissueWindow {
    TissueWindow { name: name.to_owned(), from_hu: ends.0, to_hu: ends.1, material }
}

fn soft_and_stiff() -> (LinearElastic, LinearElastic) {
    (material(3.0, 0.46), material(300.0, 0.43))
}

fn hounsfield(image: Arc<ImageVolume>, mixing: Mixing) -> Hounsfield {
    let (soft, stiff) = soft_and_stiff();
    let tissues = vec![window("fat", (-100.0, 50.0), soft), window("muscle", (50.0, 200.0), stiff)];
    Hounsfield { image, samples: 64, tissues, mixing }
}

fn imaged(mesh: VolumeMesh, hounsfield: Hounsfield) -> Case {
    Case { hounsfield: Some(hounsfield), ..case_of(mesh, material(15.0, 0.46)) }
}

fn pulled() -> Plan {
    let held =
        [constraint("x_min", [Some(0.0); 3]), constraint("x_max", [Some(3.0), None, Some(1.0)])];
    Plan { prescribed: held.to_vec(), ..Plan::default() }
}

#[test]
fn two_windows_are_the_same_bits_as_two_regions() {
    let (soft, stiff) = soft_and_stiff();
    for (shape, element) in [
        (CellShape::Tet4, ElementChoice::Auto),
        (CellShape::Tet4, ElementChoice::Quadratic),
        (CellShape::Hex8, ElementChoice::Auto),
        (CellShape::Wedge6, ElementChoice::Plain),
    ] {
        let mut regions = case_of(halves(shape), soft);
        let names = [(0, "low".to_owned()), (1, "high".to_owned())].into();
        regions.regions = Some(RegionNames { array: "half".to_owned(), names });
        regions.materials.insert("high".to_owned(), stiff);
        let settings = Settings { element, ..exact() };
        let expected = solve(&regions, &pulled(), &settings).displacement;
        // No cell is cut by the step, so that a share is all or nothing.
        for mixing in [Mixing::Mean, Mixing::Fraction] {
            let case = imaged(halves(shape), hounsfield(step(), mixing));
            let found = solve(&case, &pulled(), &settings).displacement;
            assert_eq!(found, expected, "{} {mixing:?}", shape.name());
        }
    }
}

#[test]
fn a_cell_across_a_step_is_one_tissue_by_its_mean_and_a_mixture_by_its_shares() {
    // One layer of bricks of 16 mm: 10 of them are fat.
    let mesh = || block(Vector::new(60.0, 40.0, 16.0), [3, 2, 1], CellShape::Hex8);
    let scene = |mixing| {
        Scene::new(&imaged(mesh(), hounsfield(step(), mixing)), &pulled(), &Settings::default())
            .unwrap()
    };
    let (soft, stiff) = soft_and_stiff();
    let mean = scene(Mixing::Mean);
    assert!(mean.material_of_cell.iter().all(|&m| mean.materials[m as usize] == soft));
    let found = mean.imaged.unwrap();
    assert_eq!((found.tissues[0].1.cells, found.tissues[0].1.volume_share), (6, 1.0));

    let fraction = scene(Mixing::Fraction);
    let share = fraction.imaged.as_ref().unwrap().tissues[0].1.volume_share;
    // Within the inverse root of the count of points.
    assert!((share - 10.0 / 16.0).abs() < 1.0 / 64.0_f64.sqrt(), "{share}");
    for &entry in &fraction.material_of_cell {
        let mixed = &fraction.materials[entry as usize];
        let linear = |of: fn(&LinearElastic) -> f64| share * of(&soft) + (1.0 - share) * of(&stiff);
        let (bulk, shear) =
            (linear(LinearElastic::bulk_modulus), linear(LinearElastic::shear_modulus));
        assert!((mixed.bulk_modulus() - bulk).abs() < 1e-10 * bulk);
        assert!((mixed.shear_modulus() - shear).abs() < 1e-10 * shear);
    }
    // All are of one kind, and share their pressures.
    let kinds = &fraction.pressure_of_cell;
    assert!(kinds.iter().all(|kind| *kind == kinds[0]), "{kinds:?}");

    // It is that of their larger part: of layers of fat, of a mixture of which five parts of eight are fat, and of muscle the first two
    // share theirs.
    let mut layers = block(Vector::new(60.0, 40.0, 21.0), [1, 1, 3], CellShape::Hex8);
    for node in &mut layers.nodes {
        node.z = [0.0, 5.0, 13.0, 21.0][(node.z / 7.0).round() as usize];
    }
    let case = imaged(layers, hounsfield(step(), Mixing::Fraction));
    let scene = Scene::new(&case, &pulled(), &Settings::default()).unwrap();
    let mut kinds = [u16::MAX; 3];
    for (cell, &kind) in scene.pressure_of_cell.iter().enumerate() {
        let height = scene.mesh.corners(cell).map(|x| x.z).sum::<f64>() / 8.0;
        kinds[usize::from(height > 5.0) + usize::from(height > 13.0)] = kind;
    }
    assert!(kinds[0] == kinds[1] && kinds[1] != kinds[2], "{kinds:?}");
}

#[test]
fn a_cell_that_is_half_a_region_with_fibres_has_half_of_its_stiffness() {
    // Bricks of 16 mm: 10 of them are in no window, and of a region with fibres; 6 are muscle without.
    let mesh = block(Vector::new(60.0, 40.0, 16.0), [3, 2, 1], CellShape::Hex8);
    let mut asked = hounsfield(step(), Mixing::Fraction);
    asked.tissues.remove(0);
    let region = fibred(MUSCLE).unwrap();
    let mut case = Case { hounsfield: Some(asked), ..case_of(mesh, region) };
    let along = Vector::new(1.0, 2.0, -2.0) / 3.0;
    case.fibres.insert("*".to_owned(), FibreDirection::Uniform(along));
    let scene = Scene::new(&case, &pulled(), &Settings::default()).unwrap();
    let imaged = scene.imaged.as_ref().unwrap();
    let share = imaged.region.volume_share;
    assert!((share - 10.0 / 16.0).abs() < 1.0 / 64.0_f64.sqrt(), "{share}");
    let strain = nalgebra::Matrix3::new(0.1, 0.02, -0.3, 0.02, -0.2, 0.05, -0.3, 0.05, 0.4);
    let (_, stiff) = soft_and_stiff();
    let wanted = region.tensor(&along).stress(&strain) * share
        + stiff.tensor(&along).stress(&strain) * (1.0 - share);
    for cell in 0..scene.mesh.cells.len() {
        assert!((scene.fibres[cell] - along).norm() < 1e-15);
        let found = scene.tissue().tensor(cell).stress(&strain);
        assert!((found - wanted).amax() < 1e-10 * wanted.amax(), "{found} {wanted}");
    }
    let answer = solve(&case, &pulled(), &Settings::default());
    assert!(answer.displacement.iter().all(|u| u.norm() < 10.0));
    assert!(!answer.warnings.iter().any(|warning| warning.code == "fibres-replaced"));
}

#[test]
fn cells_beyond_the_image_or_in_no_window_keep_their_region_and_are_counted() {
    let mesh = block(Vector::new(60.0, 40.0, 40.0), [3, 2, 4], CellShape::Hex8);
    let mut asked = hounsfield(step(), Mixing::Mean);
    asked.tissues.remove(0);
    let case = imaged(mesh, asked);
    let scene = Scene::new(&case, &pulled(), &Settings::default()).unwrap();
    let told: Vec<(&str, f64)> =
        scene.warnings.iter().map(|warning| (warning.code, warning.numbers[0].1)).collect();
    // Of four layers of six the two upper ones are above the image and the lowest is fat.
    assert!(told.contains(&("outside-image", 12.0)) && told.contains(&("outside-windows", 6.0)));
    let found = scene.imaged.unwrap();
    assert_eq!((found.outside, found.region.cells, found.tissues[0].1.cells), (12, 18, 6));
    assert!((found.region.volume_share - 0.75).abs() < 1e-12);
    let own = material(15.0, 0.46);
    let kept = scene.material_of_cell.iter().filter(|&&m| scene.materials[m as usize] == own);
    assert_eq!(kept.count(), 18);

    let mut elsewhere = case.clone();
    let mut far = block(Vector::new(60.0, 40.0, 40.0), [3, 2, 4], CellShape::Hex8);
    far.nodes.iter_mut().for_each(|x| x.z += 200.0);
    elsewhere.volume = Arc::new(far);
    let errors = Scene::new(&elsewhere, &pulled(), &Settings::default()).err().unwrap();
    let (pointer, code) = (errors.0[0].pointer.as_str(), errors.0[0].code.name());
    assert_eq!((pointer, code), ("/case/hounsfield/image", "outside-image"));
}

/// In [0, 1), a hash of the place of a voxel.
fn noise(i: usize, j: usize, k: usize) -> f32 {
    let mut bits = (i + 81 * j + 6561 * k) as u64 + 1;
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = bits.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (bits >> 40) as f32 / (1 << 24) as f32
}

#[test]
fn mixtures_that_differ_from_cell_to_cell_do_not_lock() {
    // Fat and muscle in random voxels of 3 mm, so that every tetrahedron is another mixture.
    let image = Arc::new(oblique(|i, j, k| 100.0 * noise(i, j, k)));
    let mesh = || block(Vector::new(60.0, 40.0, 20.0), [6, 4, 2], CellShape::Tet4);
    let mut asked = hounsfield(image, Mixing::Fraction);
    asked.tissues[0].material = material(30.0, 0.4995);
    asked.tissues[1].material = material(90.0, 0.4995);
    let case = imaged(mesh(), asked);
    let bent = Plan {
        prescribed: vec![
            constraint("x_min", [Some(0.0); 3]),
            constraint("x_max", [None, None, Some(4.0)]),
        ],
        ..Plan::default()
    };
    let moved = |element| solve(&case, &bent, &Settings { element, ..Settings::default() });
    let quadratic = moved(ElementChoice::Quadratic);
    let far = |element| {
        let pairs = moved(element).displacement.into_iter().zip(&quadratic.displacement);
        let squares: Vec<f64> = pairs.map(|(u, v)| (u - v).norm_squared()).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let (stabilised, plain) = (far(ElementChoice::Auto), far(ElementChoice::Plain));
    println!("rms from quadratic elements: stabilised {stabilised:.4} mm, plain {plain:.4} mm");
    assert!(stabilised < plain / 3.0, "{stabilised} {plain}");
}

#[test]
fn more_mixtures_than_can_be_numbered_are_rounded_until_they_can() {
    // Four tissues in random places: hardly two cells of 74 088 show the same shares of them.
    let mixed = |i: usize, j: usize, k: usize| 1024.0 * noise(i, j, k);
    let mut mesh = block(Vector::repeat(100.0), [42; 3], CellShape::Hex8);
    mesh.nodes.iter_mut().for_each(|x| *x -= Vector::repeat(50.0));
    let window = |n: i32| {
        let ends = (f64::from(n) * 256.0, f64::from(n) * 256.0 + 256.0);
        window(&n.to_string(), ends, material(10.0 + f64::from(n) * 100.0, 0.4))
    };
    let tissues: Vec<TissueWindow> = (0..4).map(window).collect();
    let image = Arc::new(oblique(mixed));
    let asked = Hounsfield { image, samples: 512, tissues, mixing: Mixing::Fraction };
    let scene = Scene::new(&imaged(mesh, asked), &pulled(), &Settings::default()).unwrap();
    let count = scene.materials.len();
    assert!(count > 1000 && count <= 65_535, "{count}");
    let found = scene.imaged.unwrap();
    let whole: f64 = found.tissues.iter().map(|(_, share)| share.volume_share).sum();
    // Everything lies in some window, and rounding keeps the sum of each cell.
    assert!((whole - 1.0).abs() < 1e-12, "{whole}");
    assert!(scene.material_of_cell.iter().all(|&m| (m as usize) < count));
}

#[test]
fn cells_that_lose_their_fibres_to_a_tissue_of_the_image_are_counted() {
    let mesh = block(Vector::new(40.0, 20.0, 20.0), [4, 2, 2], CellShape::Hex8);
    let muscle = fibred(MUSCLE).unwrap();
    let window = |from_hu: f64, to_hu: f64| TissueWindow {
        name: "fat".to_owned(),
        from_hu,
        to_hu,
        material: material(3.0, 0.46),
    };
    let warning = |tissue: TissueWindow| {
        let image = Arc::new(oblique(|_, _, _| -50.0));
        let mixing = Mixing::Mean;
        let case = Case {
            fixed: vec![crate::scenes::set("x_min")],
            hounsfield: Some(Hounsfield { image, samples: 8, tissues: vec![tissue], mixing }),
            fibres: [("*".to_owned(), FibreDirection::Uniform(Vector::x()))].into(),
            ..case_of(mesh.clone(), muscle)
        };
        let scene = Scene::new(&case, &Plan::default(), &Settings::default()).unwrap();
        scene.warnings.into_iter().find(|warning| warning.code == "fibres-replaced")
    };
    let told = warning(window(-100.0, 0.0)).expect("every cell is fat");
    assert_eq!(told.numbers, [("cells", 16.0), ("of", 16.0)]);
    assert_eq!(warning(window(100.0, 200.0)), None);
}
