//! Muscles with a surface and a tissue of their own: cells that they fill wholly and in part, doubts, and who refuses them.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::conformation::angle_between;
use mechanics::material::hyperelastic::{Law, NeoHookean};
use mechanics::material::mixture::{MixingRule, mixture};
use mechanics::material::{Fibre, FibreLaw, LinearElastic};
use mechanics::mesh::{CellShape, TriangleSurface, Vector, sample::block};
use mechanics::model::fem::mass_tensor::MassTensorSettings;
use mechanics::muscle::strap::box_surface;
use mechanics::prediction::{
    Activation, BodyFibres, Case, FibreDirection, Load, MOST_MUSCLE_WORK, Method, Muscle,
    MuscleCourse, MuscleMixing, Plan, RegionNames, Scene, SceneError, Settings, Stiffening,
};
use mechanics::response::{ResponseError, inner_loads};

use crate::scenes::{case_of, constraint, exact, material, set, solve};

/// A box between two corners.
fn boxed(low: [f64; 3], high: [f64; 3]) -> TriangleSurface {
    let (low, high) = (Vector::from(low), Vector::from(high));
    let half = (high - low) / 2.0;
    box_surface((low + high) / 2.0, [0, 1, 2].map(|k| Vector::ith(k, half[k])))
}

fn muscle(name: &str, surface: TriangleSurface, fibres: BodyFibres) -> Muscle {
    let course = MuscleCourse::Body { surface: Arc::new(surface), fibres };
    Muscle { name: name.to_owned(), course, tissue: Some(fibred()), stiffening: None }
}

fn fibred() -> LinearElastic {
    let fibre = Fibre { young_modulus: 110.0, shear_modulus: None, law: FibreLaw::Engineering };
    material(30.0, 0.45).with_fibre(&fibre).unwrap()
}

/// A block of 24 x 12 x 12 mm in cells of 3 mm, held below.
fn held(muscles: Vec<Muscle>) -> Case {
    let mesh = block(Vector::new(24.0, 12.0, 12.0), [8, 4, 4], CellShape::Hex8);
    Case {
        fixed: vec![set("z_min")],
        skin: Some(set("z_max")),
        muscles,
        ..case_of(mesh, material(5.0, 0.46))
    }
}

fn pushed() -> Plan {
    let prescribed = vec![constraint("x_max", [Some(1.0), None, Some(0.5)])];
    Plan { prescribed, ..Plan::default() }
}

fn scene(case: &Case) -> Scene {
    Scene::new(case, &pushed(), &Settings::default()).unwrap()
}

fn told<'a>(scene: &'a Scene, code: &str) -> Option<&'a mechanics::mesh::Warning> {
    scene.warnings.iter().find(|own| own.code == code)
}

#[test]
fn cells_that_a_muscle_fills_are_those_of_a_region_of_its_tissue() {
    // A strap along x, two cells thick, on the borders of cells.
    let strap = boxed([0.0, 3.0, 3.0], [24.0, 9.0, 9.0]);
    let case = held(vec![muscle("strap", strap, BodyFibres::Box { halvings: 0 })]);
    let found = solve(&case, &pushed(), &exact());
    let mut mesh = (*case.volume).clone();
    let inside = |cell: usize| {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        let middle = corners.iter().sum::<Vector>() / 8.0;
        (middle.y - 6.0).abs() < 3.0 && (middle.z - 6.0).abs() < 3.0
    };
    let labels: Vec<i64> = (0..mesh.cells.len()).map(|cell| i64::from(inside(cell))).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    let names = [(0, "fat"), (1, "strap")].map(|(label, name)| (label, name.to_owned()));
    let regions = Case {
        regions: Some(RegionNames { array: "layer".to_owned(), names: names.into() }),
        materials: BTreeMap::from([
            ("fat".to_owned(), material(5.0, 0.46)),
            ("strap".to_owned(), fibred()),
        ]),
        fibres: [("strap".to_owned(), FibreDirection::Uniform(Vector::x()))].into(),
        muscles: Vec::new(),
        volume: Arc::new(mesh),
        ..case.clone()
    };
    let expected = solve(&regions, &pushed(), &exact());
    for (found, expected) in found.displacement.iter().zip(&expected.displacement) {
        assert!((found - expected).norm() < 1e-9, "{found} {expected}");
    }
    let made = scene(&case);
    let tissue = made.muscle_tissue.unwrap();
    assert_eq!((tissue.cells, tissue.mixed, tissue.crossing), (32, 0, 0));
    assert!(tissue.rule_decides.abs() < 1e-12);
    let body = made.muscles[0].body.unwrap();
    assert!(
        (made.muscles[0].volume(&made.mesh) - 864.0).abs() < 1e-9
            && (body.enclosed - 864.0).abs() < 1e-9
    );
    assert!(body.broadness.unwrap() < 0.4 && told(&made, "muscle-broad").is_none());
}

#[test]
fn a_cell_that_is_muscle_in_part_is_the_mixture_of_the_rule_and_pulls_by_its_share() {
    // Half of the cells of one layer in z: their sample points are symmetric about the middle.
    let half = boxed([0.0, 3.0, 3.0], [24.0, 9.0, 7.5]);
    let rules = [MixingRule::Voigt, MixingRule::Reuss, MixingRule::Geometric];
    for rule in rules {
        let along = BodyFibres::Course(FibreDirection::Uniform(Vector::new(0.0, -2.0, 0.0)));
        let mut case = held(vec![muscle("half", half.clone(), along)]);
        case.muscle_mixing = MuscleMixing { rule, samples: 64 };
        let made = scene(&case);
        let tissue = made.muscle_tissue.unwrap();
        assert_eq!((tissue.rule, tissue.cells, tissue.mixed), (rule, 32, 16));
        let at = |place: [f64; 3]| {
            let place = Vector::from(place);
            let constraints = |cell: &usize| {
                let corners: Vec<Vector> = made.mesh.corners(*cell).collect();
                (corners.iter().sum::<Vector>() / 8.0 - place).norm() < 1e-9
            };
            (0..made.mesh.cells.len()).find(constraints).unwrap()
        };
        let (whole, mixed) = (at([10.5, 4.5, 4.5]), at([10.5, 4.5, 7.5]));
        let of = |cell: usize| made.materials[usize::from(made.material_of_cell[cell])];
        assert_eq!(of(whole), fibred());
        let known = mixture(&[(0.5, fibred()), (0.5, material(5.0, 0.46))], rule);
        let apart = (of(mixed).young_modulus() / known.young_modulus() - 1.0).abs();
        assert!(apart < 1e-9, "{rule:?}: {:?} {known:?}", of(mixed));
        for cell in [whole, mixed] {
            assert!(angle_between(&made.fibres[cell], &Vector::y()) < 1e-9);
        }
        // Its pull is T times the share, along y.
        let cells = &made.muscles[0].cells;
        let share = |cell: usize| {
            let own = cells.iter().find(|own| own.cell as usize == cell).unwrap();
            own.stress[(1, 1)]
        };
        assert!((share(whole) - 1.0).abs() < 1e-12 && (share(mixed) - 0.5).abs() < 1e-12);
        // Voigt's E is twice Reuss's in halves, its E_f six times.
        let volume_share = 16.0 / 128.0;
        assert!((tissue.rule_decides - volume_share).abs() < 1e-12, "{}", tissue.rule_decides);
        assert!(told(&made, "mixing-decides").is_some());
    }
}

#[test]
fn a_muscle_that_pulls_becomes_stiffer_along_its_fibres_by_the_stress_of_its_activation() {
    // E_f 6.2, 58.1 and 110 kPa at nothing, half and all of 40 kPa: a free block shortens by T / E_f.
    let fibre = Fibre { young_modulus: 6.2, shear_modulus: None, law: FibreLaw::Engineering };
    let tissue = material(6.2, 0.49).with_fibre(&fibre).unwrap();
    let stiffening = Stiffening { fibre, young_modulus: 110.0, stress: 40.0 };
    let whole = boxed([-1.0; 3], [25.0, 13.0, 13.0]);
    let along = BodyFibres::Course(FibreDirection::Uniform(Vector::x()));
    let own =
        Muscle { tissue: Some(tissue), stiffening: Some(stiffening), ..muscle("m", whole, along) };
    let case = Case { fixed: Vec::new(), ..held(vec![own]) };
    let zero = Some(0.0);
    let prescribed = vec![
        constraint("x_min", [zero, None, None]),
        constraint("y_min", [None, zero, None]),
        constraint("z_min", [None, None, zero]),
    ];
    let pulling = |stress: f64| {
        let activations = vec![Activation { muscle: "m".to_owned(), stress }];
        Plan { activations, prescribed: prescribed.clone(), ..Plan::default() }
    };
    // Pulled across its fibres too, it gives way across both by Poisson's ratio of that plane.
    for (stress, modulus, across) in [
        (1e-3, 6.2 + 103.8 * 1e-3 / 40.0, None),
        (20.0, 58.1, Some(0.945_576_6)),
        (40.0, 110.0, Some(0.971_254_5)),
    ] {
        let found = solve(&case, &pulling(stress), &exact()).displacement;
        let node = case.volume.node_sets["x_max"][0] as usize;
        let known = -24.0 * stress / modulus;
        assert!((found[node].x / known - 1.0).abs() < 1e-7, "{stress}: {} {known}", found[node].x);
        let Some(across) = across else { continue };
        let traction = Vector::y();
        let loads = vec![Load::Traction { faces: set("y_max"), traction }];
        let pulled = solve(&case, &Plan { loads, ..pulling(stress) }, &exact()).displacement;
        let at = |set: &str, axis: usize| {
            let node = case.volume.node_sets[set][0] as usize;
            pulled[node][axis] - found[node][axis]
        };
        let ratio = -at("z_max", 2) / at("y_max", 1);
        assert!((ratio - across).abs() < 1e-6, "{stress}: {ratio}");
    }
    let Err(errors) = Scene::new(&case, &pulling(41.0), &Settings::default()) else {
        panic!("built")
    };
    let SceneError { pointer, code, .. } = &errors.0[0];
    assert_eq!(
        (pointer.as_str(), code.name()),
        ("/plan/activations/0/stress_kpa", "plan-out-of-range")
    );
    let rest = Scene::new(&case, &Plan { prescribed, ..Plan::default() }, &Settings::default());
    let refused = inner_loads(&rest.unwrap(), &[], &["m".to_owned()]);
    assert!(matches!(refused, Err(ResponseError::Stiffens { .. })), "{refused:?}");
}

#[test]
fn two_muscles_in_a_cell_share_it_and_their_axes_cross() {
    let across = |axis| BodyFibres::Course(FibreDirection::Uniform(axis));
    let first = muscle("first", boxed([0.0, 0.0, 3.0], [24.0, 12.0, 7.5]), across(Vector::x()));
    let second = muscle("second", boxed([0.0, 0.0, 7.5], [24.0, 12.0, 9.0]), across(Vector::y()));
    let made = scene(&held(vec![first, second]));
    let tissue = made.muscle_tissue.unwrap();
    assert_eq!((tissue.cells, tissue.mixed, tissue.crossing), (64, 32, 32));
    let crossed = told(&made, "muscles-cross").unwrap();
    assert_eq!(crossed.numbers[0].1, 32.0);
    // Both fill the cell: it is muscle wholly.
    let mixed = made.material_of_cell.iter().map(|own| made.materials[usize::from(*own)]);
    let stiff = mixed.filter(|own| (own.young_modulus() - 30.0).abs() < 1e-9).count();
    assert_eq!(stiff, 64);
}

#[test]
fn muscles_whose_cells_take_too_long_to_find_are_refused_before_with_the_numbers() {
    let box_of = |name: &str, high: f64| {
        muscle(name, boxed([0.1; 3], [high, 11.9, 11.9]), BodyFibres::Box { halvings: 0 })
    };
    let refused = |samples: usize| {
        let mut case = held(vec![box_of("short", 2.9), box_of("long", 23.9)]);
        case.muscle_mixing.samples = samples;
        let built = Scene::new(&case, &pushed(), &Settings::default());
        built.err().map(|errors| errors.0[0].clone())
    };
    // 16 and 128 cells, each with its samples and 100 more; two boxes of 12 triangles.
    let told = refused(7_000_000).unwrap();
    assert_eq!((told.pointer.as_str(), told.code.name()), ("/case/muscles", "too-many"));
    assert!(told.detail.starts_with("1012016800 comparisons"), "{}", told.detail);
    assert!(told.detail.contains(&format!("at most {MOST_MUSCLE_WORK}")), "{}", told.detail);
    assert!(told.detail.contains("\"long\", 128 cells near it"), "{}", told.detail);
    assert!(refused(64).is_none());
}

#[test]
fn lines_are_tissue_by_the_share_with_which_they_pull() {
    let line = vec![Vector::new(0.0, 6.0, 6.0), Vector::new(24.0, 6.0, 6.0)];
    let course = MuscleCourse::Lines { lines: vec![line], within: 5.0 };
    let own = Muscle { name: "line".to_owned(), course, tissue: Some(fibred()), stiffening: None };
    let made = scene(&held(vec![own]));
    for own in &made.muscles[0].cells {
        let found = made.materials[usize::from(made.material_of_cell[own.cell as usize])];
        let parts =
            [(own.stress.trace(), fibred()), (1.0 - own.stress.trace(), material(5.0, 0.46))];
        let known = mixture(&parts, MixingRule::Voigt).young_modulus();
        // Shares are whole numbers of 1/512.
        assert!((found.young_modulus() - known).abs() < 25.0 / 1024.0 + 1e-9, "{found:?} {known}");
    }
    assert!(made.muscle_tissue.unwrap().mixed > 30);
}

#[test]
fn broad_muscles_far_ones_and_what_cannot_be_mixed_are_reported_with_their_place() {
    let strap = || BodyFibres::Box { halvings: 0 };
    let plate = boxed([0.0, 0.0, 3.0], [12.0, 12.0, 6.0]);
    let broad = scene(&held(vec![muscle("plate", plate.clone(), strap())]));
    let told_of = told(&broad, "muscle-broad").unwrap();
    assert!(told_of.detail.contains("plate") && told_of.numbers[0].1 > 0.9, "{told_of:?}");
    let outside = boxed([0.0, 0.0, -40.0], [24.0, 6.0, 6.0]);
    let outside = scene(&held(vec![muscle("long", outside, strap())]));
    assert!(told(&outside, "muscle-outside").unwrap().numbers[0].1 < 0.14);

    let refused = |case: &Case, settings: &Settings| {
        let Err(errors) = Scene::new(case, &pushed(), settings) else { panic!("built") };
        let error = &errors.0[0];
        (error.pointer.clone(), error.code.name(), error.detail.clone())
    };
    let usual = Settings::default();
    let mut open = plate.clone();
    open.triangles.truncate(4);
    let (pointer, code, _) = refused(&held(vec![muscle("open", open, strap())]), &usual);
    assert_eq!((pointer.as_str(), code), ("/case/muscles/0/surface", "no-inside"));
    let away = boxed([100.0; 3], [130.0; 3]);
    let (pointer, code, detail) = refused(&held(vec![muscle("away", away, strap())]), &usual);
    assert_eq!((pointer.as_str(), code), ("/case/muscles/0", "empty-selection"));
    assert!(detail.contains("(100.0, 100.0, 100.0)"), "{detail}");
    let course = BodyFibres::Course(FibreDirection::Uniform(Vector::zeros()));
    let (_, code, _) = refused(&held(vec![muscle("flat", plate.clone(), course)]), &usual);
    assert_eq!(code, "fibre-direction-zero");
    let law = Law::NeoHookean(NeoHookean { lambda: 20.0, mu: 2.0 });
    let mut case = held(vec![muscle("plate", plate, strap())]);
    let with_law = LinearElastic::of_law(law, 1.0).unwrap();
    case.materials.insert("*".to_owned(), with_law);
    let (pointer, code, detail) = refused(&case, &usual);
    assert_eq!((pointer.as_str(), code), ("/case/muscles", "method-not-available"));
    assert!(detail.contains("1 tissues"), "{detail}");
}

#[test]
fn a_method_without_fibres_takes_muscles_as_stiff_as_they_are_across_them() {
    let strap = boxed([0.0, 3.0, 3.0], [24.0, 9.0, 9.0]);
    let case = held(vec![muscle("strap", strap, BodyFibres::Box { halvings: 0 })]);
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let made = Scene::new(&case, &pushed(), &settings).unwrap();
    assert!(told(&made, "fibres-ignored").unwrap().detail.contains("1 muscles"));
    let stiff = made.material_of_cell.iter().filter(|own| {
        let own = made.materials[usize::from(**own)];
        !own.has_fibre() && own.young_modulus() == 30.0
    });
    assert_eq!(stiff.count(), 32);
    let mtm = Settings {
        method: Method::MassTensorTransverse(MassTensorSettings::default()),
        ..Settings::default()
    };
    let tetrahedra = block(Vector::new(24.0, 12.0, 12.0), [8, 4, 4], CellShape::Tet4);
    let case = Case { volume: Arc::new(tetrahedra), ..case };
    let made = Scene::new(&case, &pushed(), &mtm).unwrap();
    assert!(told(&made, "fibres-missing").is_none() && !made.fibres.is_empty());
}

#[test]
fn a_thin_body_that_samples_of_cells_miss_is_told_by_how_much_of_it_pulls() {
    // .3 mm thick where sample points are .75 mm apart: a layer of them stands for more than it is.
    let thin = boxed([2.0, 2.0, 5.5], [22.0, 10.0, 5.8]);
    let along = || BodyFibres::Course(FibreDirection::Uniform(Vector::x()));
    let scene = scene(&held(vec![muscle("thin", thin, along())]));
    let warning = told(&scene, "muscle-few-cells").expect("told");
    let share = scene.muscles[0].volume(&scene.mesh) / (20.0 * 8.0 * 0.3);
    let numbers = BTreeMap::from_iter(warning.numbers.iter().copied());
    assert!((numbers["pull_share"] - share).abs() < 1e-9, "{numbers:?} {share}");
    assert!((share - 1.0).abs() > 0.1, "{share}");

    let thick = boxed([2.0, 2.0, 3.0], [22.0, 10.0, 9.0]);
    let scene = self::scene(&held(vec![muscle("thick", thick, along())]));
    assert!(told(&scene, "muscle-few-cells").is_none());
}
