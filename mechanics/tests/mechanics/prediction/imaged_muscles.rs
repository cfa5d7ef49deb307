//! Muscles with a tissue of their own in tissue that an image shows: C = f C_muscle + (1 - f) C_rest, where C_rest is itself the
//! mixture of what the image shows of a cell.

use std::sync::Arc;

use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::material::LinearElastic;
use mechanics::mesh::{CellShape, Vector, sample::block};
use mechanics::muscle::strap::box_surface;
use mechanics::prediction::{
    BodyFibres, Case, FibreDirection, Hounsfield, Load, Mixing, Muscle, MuscleCourse, Plan, Scene,
    Settings, TissueWindow,
};
use nalgebra::Matrix3;

use crate::material::anisotropy::{MUSCLE, fibred};
use crate::scenes::{case_of, constraint, exact, material, set, solve};

const SIZE: [f64; 3] = [24.0, 12.0, 12.0];

/// 0 HU below z = 6 and 100 HU above.
fn step() -> ImageVolume {
    let placement = Placement {
        origin: Vector::new(-1.0, -1.0, -0.5),
        steps: [Vector::x() * 26.0, Vector::y() * 14.0, Vector::z()],
    };
    let values = (0..2 * 2 * 14).map(|n| if n / 4 > 6 { 100 } else { 0 }).collect();
    ImageVolume::new([2, 2, 14], placement, Voxels::I16(values)).unwrap()
}

fn fat_and_gland() -> [LinearElastic; 2] {
    [material(3.0, 0.46), material(40.0, 0.3)]
}

/// A bar of one layer of bricks whose lower half is fat, whose upper half is gland, and of which a muscle along x fills the left
/// share.
fn bar(share: f64, mixing: Mixing) -> Case {
    let mesh = block(Vector::from(SIZE), [4, 1, 1], CellShape::Hex8);
    let [fat, gland] = fat_and_gland();
    let window = |name: &str, from_hu, to_hu, material| TissueWindow {
        name: name.to_owned(),
        from_hu,
        to_hu,
        material,
    };
    let tissues = vec![window("fat", -50.0, 49.0, fat), window("gland", 49.0, 150.0, gland)];
    let width = share * SIZE[1];
    let half = [14.0, 0.5 * width, 8.0];
    let middle = Vector::new(12.0, 0.5 * width, 6.0);
    let surface = box_surface(middle, [0, 1, 2].map(|k| Vector::ith(k, half[k])));
    let along = BodyFibres::Course(FibreDirection::Uniform(Vector::x()));
    let muscle = Muscle {
        name: "muscle".to_owned(),
        course: MuscleCourse::Body { surface: Arc::new(surface), fibres: along },
        tissue: Some(fibred(MUSCLE).unwrap()),
        stiffening: None,
    };
    Case {
        hounsfield: Some(Hounsfield { image: Arc::new(step()), samples: 64, tissues, mixing }),
        muscles: vec![muscle],
        ..case_of(mesh, material(15.0, 0.46))
    }
}

/// Pulled along x with 1 kPa, its sides free.
fn pulled() -> Plan {
    let zero = Some(0.0);
    let prescribed = vec![
        constraint("x_min", [zero, None, None]),
        constraint("y_min", [None, zero, None]),
        constraint("z_min", [None, None, zero]),
    ];
    let loads = vec![Load::Traction { faces: set("x_max"), traction: Vector::x() }];
    Plan { prescribed, loads, ..Plan::default() }
}

/// Young's modulus along x and Poisson's ratio across it of a sum of parts with shares.
fn along_and_across(parts: &[(f64, LinearElastic)]) -> [f64; 2] {
    let stiffness = |row: usize, column: usize| -> f64 {
        let mut strain = Matrix3::zeros();
        strain[(column, column)] = 1.0;
        let of = |part: &LinearElastic| part.tensor(&Vector::x()).stress(&strain)[(row, row)];
        parts.iter().map(|(share, part)| share * of(part)).sum()
    };
    let (across, lateral) = (stiffness(0, 1), stiffness(1, 1) + stiffness(1, 2));
    [stiffness(0, 0) - 2.0 * across * across / lateral, across / lateral]
}

#[test]
fn a_muscle_mixes_into_what_the_image_shows_of_a_cell() {
    let [fat, gland] = fat_and_gland();
    let muscle = fibred(MUSCLE).unwrap();
    // By its mean of 50 HU a cell is gland, by its shares half of each; half of it muscle: E by another program (docs/growth-and-muscles.md).
    for (mixing, rest, half) in [
        (Mixing::Fraction, vec![(0.5, fat), (0.5, gland)], 67.134_206_67),
        (Mixing::Mean, vec![(1.0, gland)], 77.720_235_65),
    ] {
        for share in [0.0, 0.5, 1.0] {
            let parts: Vec<(f64, LinearElastic)> =
                rest.iter().map(|(own, part)| ((1.0 - share) * own, *part)).collect();
            let parts = [parts, vec![(share, muscle)]].concat();
            let [young_modulus, ratio] = along_and_across(&parts);
            let mut case = bar(share, mixing);
            if share == 0.0 {
                case.muscles.clear();
            }
            let found = solve(&case, &pulled(), &exact()).displacement;
            let corner = case.volume.nodes.iter().position(|at| *at == Vector::from(SIZE)).unwrap();
            let strain = found[corner].component_div(&Vector::from(SIZE));
            let wanted = Vector::new(1.0, -ratio, -ratio) / young_modulus;
            assert!(share != 0.5 || (young_modulus - half).abs() < 1e-7, "{young_modulus} {half}");
            assert!((strain - wanted).amax() < 1e-9, "{mixing:?} {share}: {strain} {wanted}");
        }
    }
}

#[test]
fn the_parts_of_a_cell_and_its_axis_are_told() {
    let scene = Scene::new(&bar(0.5, Mixing::Fraction), &pulled(), &Settings::default()).unwrap();
    let imaged = scene.imaged.as_ref().unwrap();
    for (name, own) in &imaged.tissues {
        assert!((own.volume_share - 0.5).abs() < 1e-12, "{name}: {own:?}");
    }
    let tissue = scene.muscle_tissue.as_ref().unwrap();
    assert_eq!((tissue.cells, tissue.mixed, tissue.crossing), (4, 4, 0));
    assert!((scene.muscles[0].volume(&scene.mesh) - 0.5 * 24.0 * 12.0 * 12.0).abs() < 1e-9);
    let [fat, gland] = fat_and_gland();
    let [rest, _] = along_and_across(&[(0.5, fat), (0.5, gland)]);
    let wanted = 0.5 * rest + 0.5 * fibred(MUSCLE).unwrap().fibre_modulus().unwrap();
    for cell in 0..4 {
        assert!(scene.fibres[cell].cross(&Vector::x()).norm() < 1e-12);
        let own = &scene.materials[usize::from(scene.material_of_cell[cell])];
        let told = own.fibre_modulus().unwrap();
        assert!((told - wanted).abs() < 1e-9, "{told} {wanted}");
    }
}
