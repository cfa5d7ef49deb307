//! Where methods fail (docs/verification.md#v45, docs/verification.md#v46), and the map of it: an error with its place and
//! numbers, a bound on the answer, never a NaN and never silence.

use std::sync::Arc;
use std::time::Instant;

use mechanics::material::{Fibre, FibreLaw};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, FibreDirection, InvertedCell, ModelError, Plan, Prediction,
    Scene, Settings, Sliding, SlidingNormal, predict,
};
use mechanics::progress::Unobserved;
use mechanics::registration::AlignmentError;
use mechanics::study::methods::available;
use mechanics::study::stability::{Axis, Bounds, Finding, Map, Verdict, axes, map};
use mechanics::study::{Stopwatch, Variant};
use mechanics::validation::{Statistics, StatisticsError};

use crate::scenes::{case_of, exact, material, set};

/// Every model that these facts are held against; a further one adds its line.
fn variants() -> Vec<Variant> {
    let element = |name: &str, element| Variant {
        method: "fem_linear".to_owned(),
        label: format!("fem_linear {name}"),
        settings: Settings { element, ..Settings::default() },
        accepted: None,
        may_fail: false,
    };
    vec![
        element("plain", ElementChoice::Plain),
        element("stabilised", ElementChoice::Stabilised),
        element("quadratic", ElementChoice::Quadratic),
        element("mean dilatation", ElementChoice::MeanDilatation),
    ]
}

/// Every variant of a study but those that come to rest by sweeps, which take most of the time of a whole map.
fn every_model() -> Vec<Variant> {
    let is_quick =
        |variant: &Variant| !variant.label.starts_with("mtm ") && variant.label != "msm direct";
    let mean_dilatation = variants().pop();
    available().into_iter().filter(is_quick).chain(mean_dilatation).collect()
}

/// The shape that shows what a variant is: mean dilatation is for hexahedra.
fn shape_for(variant: &Variant) -> CellShape {
    match variant.settings.element {
        ElementChoice::MeanDilatation => CellShape::Hex8,
        _ => CellShape::Tet4,
    }
}

pub(super) struct Clock(pub Instant);

impl Stopwatch for Clock {
    fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    fn reset_peak(&self) {}

    fn peak_mb(&self) -> Option<f64> {
        None
    }
}

/// Each look at this clock takes a second.
struct Hasty(std::sync::atomic::AtomicU32);

impl Stopwatch for Hasty {
    fn seconds(&self) -> f64 {
        f64::from(self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed))
    }

    fn reset_peak(&self) {}

    fn peak_mb(&self) -> Option<f64> {
        None
    }
}

fn axes_named(names: &[&str]) -> Vec<Axis> {
    axes::every().into_iter().filter(|axis| names.contains(&axis.name)).collect()
}

fn mapped(variants: &[Variant], names: &[&str]) -> Map {
    let clock = Clock(Instant::now());
    let bounds = Bounds { stopwatch: &clock, seconds: 60.0 };
    map(variants, &axes_named(names), &bounds, &|_| ())
}

/// The finding of a variant on the first axis at a value.
fn at(map: &Map, variant: usize, value: f64) -> &Finding {
    let axis = &map.axes[0];
    let place = axis.values.iter().position(|(other, _)| *other == value).unwrap();
    axis.findings[variant][place].as_ref().unwrap()
}

#[test]
fn no_answer_is_wrong_without_a_warning() {
    // The axes that are solved in little time, and every second value of the long ones; all are in docs/stability.md.
    let names = ["movement", "rotation", "sliding", "jump", "loose_parts", "fibre_ratio"];
    let mut axes = axes_named(&names);
    for axis in axes.iter_mut().filter(|axis| ["movement", "rotation"].contains(&axis.name)) {
        axis.values = axis.values.drain(..).skip(1).step_by(2).collect();
    }
    let clock = Clock(Instant::now());
    let bounds = Bounds { stopwatch: &clock, seconds: 60.0 };
    let found = map(&every_model(), &axes, &bounds, &|_| ());
    for axis in &found.axes {
        for (variant, findings) in found.variants.iter().zip(&axis.findings) {
            for (finding, (value, _)) in findings.iter().zip(&axis.values) {
                let Some(finding) = finding else { continue };
                let shown = format!("{} {variant} {value}: {finding:?}", axis.name);
                assert_ne!(finding.verdict, Verdict::Wrong, "{shown}");
                if let Some(answer) = &finding.answer {
                    assert!(answer.smallest_det_f.is_finite(), "{shown}");
                    assert!(answer.error_mm.is_none_or(f64::is_finite), "{shown}");
                }
            }
        }
    }
}

#[test]
fn methods_of_finite_strain_are_held_against_their_own_law() {
    // Both laws have the same moduli at rest, and skins that are .2 mm apart with a patch moved by 2.2 mm.
    let is_wanted = |variant: &Variant| {
        ["mtm_nonlinear", "fem_nonlinear plain"].contains(&variant.label.as_str())
    };
    let variants: Vec<Variant> = available().into_iter().filter(is_wanted).collect();
    assert_eq!(variants.len(), 2);
    let mut axes = axes_named(&["poisson_ratio"]);
    axes[0].values.truncate(1);
    let clock = Clock(Instant::now());
    let found = map(&variants, &axes, &Bounds { stopwatch: &clock, seconds: 60.0 }, &|_| ());
    for (place, variant) in variants.iter().enumerate() {
        let finding = at(&found, place, 0.3);
        let error = finding.answer.as_ref().and_then(|answer| answer.error_mm).unwrap();
        assert!(error < 0.12, "{}: {finding:?}", variant.label);
    }
}

#[test]
fn an_error_beyond_its_bound_without_a_warning_is_called_wrong() {
    // A bound that the first rotation of one degree cannot meet.
    let mut axes = axes_named(&["rotation"]);
    axes[0].bound_mm = 1e-3;
    axes[0].values.truncate(1);
    let clock = Clock(Instant::now());
    let bounds = Bounds { stopwatch: &clock, seconds: 60.0 };
    let found = map(&variants()[1..2], &axes, &bounds, &|_| ());
    assert_eq!(at(&found, 0, 1.0).verdict, Verdict::Wrong);
    assert_eq!(found.count(Verdict::Wrong), 1);
}

#[test]
fn small_strain_is_right_at_5_degrees_and_says_so_when_it_is_not_at_15_and_45() {
    let found = mapped(&variants(), &["rotation"]);
    for variant in 0..found.variants.len() {
        assert_eq!(at(&found, variant, 5.0).verdict, Verdict::Good);
        for (degrees, least, most) in [(15.0, 0.6, 0.8), (45.0, 5.5, 6.5)] {
            let answer = at(&found, variant, degrees).answer.clone().unwrap();
            let warning = answer.warnings.iter().find(|w| w.code == "large-rotation").unwrap();
            let number = |name: &str| warning.numbers.iter().find(|n| n.0 == name).unwrap().1;
            // The skin of a layer of 12 mm lies too high by 12 (1 - cos) / (1 - nu), less towards its rims:
            // 0.72 and 6.2 mm.
            let error = answer.error_mm.unwrap();
            assert!((least..most).contains(&error), "{error}");
            // An order of magnitude, on the safe side at moderate angles.
            let estimate = number("estimate_mm");
            assert!((0.8 * error..2.0 * error).contains(&estimate), "{estimate} for {error}");
            // Plain cells turn a little less at their skin.
            let turned = number("rotation_p95_deg");
            assert!((turned - degrees).abs() < 0.15 * degrees, "{turned} for {degrees}");
        }
    }
}

#[test]
fn nodes_that_slide_off_a_curved_wall_are_counted_with_their_distance() {
    let found = mapped(&variants(), &["sliding"]);
    for variant in 0..found.variants.len() {
        assert_eq!(at(&found, variant, 2.0).verdict, Verdict::Good);
        let answer = at(&found, variant, 10.0).answer.clone().unwrap();
        let warning = answer.warnings.iter().find(|w| w.code == "sliding-off-wall").unwrap();
        // Straight on along the tangent of a ball of 60 mm: 60 (1 / cos 10 deg - 1) = 0.93 mm, more where the tissue
        // is stretched.
        let largest = warning.numbers.iter().find(|n| n.0 == "largest_mm").unwrap().1;
        assert!((0.9..1.2).contains(&largest), "{largest}");
        assert!(answer.error_mm.unwrap() > 1.0);
    }
}

#[test]
fn a_flat_wall_is_never_left() {
    for variant in variants() {
        let mut case = jaw_and_skull(shape_for(&variant));
        case.fixed.clear();
        case.allow_unfixed = true;
        let bottom = case.volume.node_sets["z_min"].clone();
        let jaw = case.volume.node_sets["x_min"].clone();
        let wall = bottom.into_iter().filter(|node| !jaw.contains(node)).collect();
        Arc::make_mut(&mut case.volume).node_sets.insert("wall".to_owned(), wall);
        case.sliding.push(Sliding {
            nodes: set("wall"),
            normal: SlidingNormal::Surface,
            segment: None,
        });
        let found = answer(&case, &moved(Vector::x() * -25.0), &variant.settings).unwrap();
        // The whole block slides past the end of its wall.
        assert_eq!(found.warnings, [], "{}", variant.label);
    }
}

#[test]
fn a_stiff_layer_of_one_linear_cell_is_reported_and_one_of_two_is_not() {
    let told_from = |variant: &Variant, from: f64, layers: usize, stiffness: f64, along: f64| {
        let mut mesh = block(Vector::new(20.0, 20.0, 12.0), [4, 4, 6], shape_for(variant));
        let height = |cell: usize| {
            mesh.corners(cell).map(|x| x.z).sum::<f64>() / mesh.corners(cell).len() as f64
        };
        let top = from + 2.0 * layers as f64;
        let labels = (0..mesh.cells.len())
            .map(|cell| i64::from((from..top).contains(&height(cell))))
            .collect();
        mesh.cell_labels.insert("layer".to_owned(), labels);
        let mut case = case_of(mesh, material(15.0, 0.43));
        let names = std::collections::BTreeMap::from([(1, "stiff".to_owned())]);
        case.regions =
            Some(mechanics::prediction::RegionNames { array: "layer".to_owned(), names });
        let fibre =
            Fibre { young_modulus: 15.0 * along, shear_modulus: None, law: FibreLaw::Engineering };
        let stiff = material(15.0 * stiffness, 0.43).with_fibre(&fibre).unwrap();
        case.materials.insert("stiff".to_owned(), stiff);
        let course = FibreDirection::Uniform(Vector::x());
        case.fibres.insert("stiff".to_owned(), course);
        case.fixed.push(set("z_min"));
        let scene = Scene::new(&case, &Plan::default(), &variant.settings).unwrap();
        scene.warnings.iter().any(|warning| warning.code == "thin-stiff-layer")
    };
    let told = |variant: &Variant, layers: usize, stiffness: f64, along: f64| {
        told_from(variant, 4.0, layers, stiffness, along)
    };
    for variant in variants() {
        let is_linear = variant.settings.element != ElementChoice::Quadratic;
        assert_eq!(told(&variant, 1, 100.0, 100.0), is_linear, "{}", variant.label);
        assert_eq!(told(&variant, 1, 1.0, 10.0), is_linear, "{}", variant.label);
        assert!(!told(&variant, 1, 5.0, 5.0), "{}", variant.label);
        assert!(!told(&variant, 2, 100.0, 100.0), "{}", variant.label);
        // The same at the top of the mesh.
        assert_eq!(told_from(&variant, 10.0, 1, 100.0, 100.0), is_linear, "{}", variant.label);
        assert!(!told_from(&variant, 10.0, 1, 5.0, 5.0), "{}", variant.label);
        assert!(!told_from(&variant, 8.0, 2, 100.0, 100.0), "{}", variant.label);
    }
}

#[test]
fn a_probe_out_of_time_is_a_failure_of_its_budget() {
    let hasty = Hasty(std::sync::atomic::AtomicU32::new(0));
    let bounds = Bounds { stopwatch: &hasty, seconds: 0.5 };
    let mut axes = axes_named(&["rotation"]);
    axes[0].values.truncate(1);
    let found = map(&variants(), &axes, &bounds, &|_| ());
    for variant in 0..found.variants.len() {
        let finding = at(&found, variant, 1.0);
        assert_eq!(finding.verdict, Verdict::Failed);
        assert_eq!(finding.refusal.as_ref().unwrap().code, "budget-exceeded");
    }
}

#[test]
fn parts_that_hang_on_two_nodes_or_fewer_are_refused_with_their_place() {
    let found = mapped(&variants(), &["loose_parts"]);
    for variant in 0..found.variants.len() {
        let joined = at(&found, variant, 3.0);
        // The mesh is coarse, and the answer says so.
        assert!(matches!(joined.verdict, Verdict::Good | Verdict::Cautious), "{joined:?}");
        let told = joined.answer.iter().flat_map(|answer| &answer.warnings);
        // The tetrahedron stands on half a face of other cells.
        let is_half = shape_for(&variants()[variant]) != CellShape::Tet4;
        let codes: Vec<&str> =
            told.map(|own| own.code).filter(|code| *code != "numerical-error-large").collect();
        let expected: &[&str] = if is_half { &["cells-do-not-match"] } else { &[] };
        assert_eq!(codes, expected, "{joined:?}");
        for (shared, free) in [(2.0, "1 of the 6"), (1.0, "3 of the 6"), (0.0, "6 of the 6")] {
            let refusal = at(&found, variant, shared).refusal.clone().unwrap();
            assert_eq!(
                (refusal.pointer.as_str(), refusal.code.as_str()),
                ("/case", "underconstrained")
            );
            assert!(refusal.detail.contains(free), "{refusal:?}");
        }
    }
}

// V.45: each a typed error with its place and numbers.

fn jaw_and_skull(shape: CellShape) -> Case {
    let mut mesh = block(Vector::new(40.0, 20.0, 10.0), [8, 4, 3], shape);
    let bone = ["x_min", "x_max"].map(|end| mesh.node_sets[end].clone()).concat();
    let top = mesh.node_sets["z_max"].iter().copied();
    let skin = top.filter(|node| !bone.contains(node)).collect();
    mesh.node_sets.insert("skin".to_owned(), skin);
    let mut case = case_of(mesh, material(15.0, 0.45));
    case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") });
    case.fixed.push(set("x_max"));
    case.skin = Some(set("skin"));
    case
}

fn moved(by: Vector) -> Plan {
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), by);
    Plan { segments: vec![PlannedSegment { name: "jaw".to_owned(), movement }], ..Plan::default() }
}

fn answer(case: &Case, plan: &Plan, settings: &Settings) -> Result<Prediction, ModelError> {
    let scene = Scene::new(case, plan, settings).unwrap_or_else(|errors| panic!("{errors}"));
    predict(&scene, &Unobserved)
}

#[test]
fn an_inverted_and_a_flat_cell_are_named_and_not_solved() {
    for variant in variants() {
        let case = jaw_and_skull(shape_for(&variant));
        let mut inverted = case.clone();
        match shape_for(&variant) {
            CellShape::Tet4 => Arc::make_mut(&mut inverted.volume).cells.nodes_mut(7).swap(0, 1),
            _ => Arc::make_mut(&mut inverted.volume).reverse_cell(7),
        }
        let found = answer(&inverted, &moved(Vector::z()), &variant.settings);
        assert_eq!(
            found.err(),
            Some(ModelError::Inverted(InvertedCell { cell: 7 })),
            "{}",
            variant.label
        );

        // All nodes of one cell in a plane: two nodes at one place among them.
        let mut flat = case.clone();
        let mesh = Arc::make_mut(&mut flat.volume);
        let height = mesh.nodes[mesh.cells.nodes(7)[0] as usize].z;
        for node in mesh.cells.nodes(7).to_vec() {
            mesh.nodes[node as usize].z = height;
        }
        let found = answer(&flat, &moved(Vector::z()), &variant.settings);
        assert!(matches!(found, Err(ModelError::Inverted(_))), "{}", variant.label);
    }
}

/// A node without a cell has no equation: it stays where it is, and nothing else notices.
#[test]
fn an_isolated_node_stays_where_it_is_and_moves_nothing_else() {
    for variant in variants() {
        let mut case = jaw_and_skull(shape_for(&variant));
        let settings = Settings { element: variant.settings.element, ..exact() };
        let without = answer(&case, &moved(Vector::z()), &settings).unwrap();
        Arc::make_mut(&mut case.volume).nodes.push(Vector::new(10.0, 10.0, 50.0));
        let with = answer(&case, &moved(Vector::z()), &settings).unwrap();
        let (last, others) = with.displacement.split_last().unwrap();
        assert_eq!(*last, Vector::zeros(), "{}", variant.label);
        for (a, b) in others.iter().zip(&without.displacement) {
            // A residual of 1e-13, in another order of the unknowns.
            assert!((a - b).norm() < 1e-10, "{}", variant.label);
        }
    }
}

/// The block of two halves, glued along x = 20 mm except above z = 3.4 mm, where each has nodes of its own.
#[test]
fn tissue_that_is_cut_by_duplicate_nodes_says_so() {
    for variant in variants() {
        let mut case = jaw_and_skull(shape_for(&variant));
        let whole = answer(&case, &moved(Vector::z()), &variant.settings).unwrap();
        let told = |prediction: &Prediction| {
            let warning = prediction.warnings.iter().find(|w| w.code == "duplicate-nodes");
            warning.map(|warning| warning.numbers[0].1)
        };
        assert_eq!(told(&whole), None);
        let mesh = Arc::make_mut(&mut case.volume);
        let on_cut = |x: &Vector| (x.x - 20.0).abs() < 1e-9 && x.z > 3.4;
        let cut: Vec<u32> = (0..mesh.nodes.len() as u32)
            .filter(|&node| on_cut(&mesh.nodes[node as usize]))
            .collect();
        let first = mesh.nodes.len() as u32;
        cut.iter().for_each(|&node| mesh.nodes.push(mesh.nodes[node as usize]));
        for cell in 0..mesh.cells.len() {
            let is_right = mesh.corners(cell).all(|x| x.x > 20.0 - 1e-9);
            for node in mesh.cells.nodes_mut(cell) {
                if let Some(place) = cut.iter().position(|other| other == node).filter(|_| is_right)
                {
                    *node = first + place as u32;
                }
            }
        }
        let apart = answer(&case, &moved(Vector::z()), &variant.settings).unwrap();
        // Two rows of five nodes, at two thirds of the height and at the top.
        assert_eq!(told(&apart), Some(10.0), "{}", variant.label);
    }
}

#[test]
fn materials_that_no_tissue_has_are_refused_with_their_number() {
    for nu in [0.5, 0.51, -0.1, f64::NAN] {
        let error = mechanics::material::LinearElastic::new(15.0, nu, 1.0).unwrap_err().to_string();
        assert!(error.contains(&nu.to_string()), "{error}");
    }
    for young_modulus in [0.0, -15.0, 1e20, f64::INFINITY, f64::NAN] {
        assert!(mechanics::material::LinearElastic::new(young_modulus, 0.46, 1.0).is_err());
    }
}

#[test]
fn what_nothing_holds_or_two_segments_hold_is_refused_for_every_variant() {
    for variant in variants() {
        let settings = &variant.settings;
        let refusal = |case: &Case, plan: &Plan| {
            let errors = Scene::new(case, plan, settings).err().unwrap();
            (errors.0[0].pointer.clone(), errors.0[0].code.name(), errors.0[0].detail.clone())
        };
        let mut free = jaw_and_skull(shape_for(&variant));
        (free.fixed, free.segments) = (Vec::new(), Vec::new());
        let (pointer, code, detail) = refusal(&free, &Plan::default());
        assert_eq!((pointer.as_str(), code), ("/case", "underconstrained"));
        assert!(detail.contains("6 of the 6"), "{detail}");

        let mut twice = jaw_and_skull(shape_for(&variant));
        twice.segments.push(CaseSegment { name: "chin".to_owned(), nodes: set("z_min") });
        let (pointer, code, detail) = refusal(&twice, &moved(Vector::z() * 25.0));
        assert_eq!((pointer.as_str(), code), ("/plan/segments/0", "plan-conflict"));
        assert!(detail.contains("2.500e1 mm apart"), "{detail}");

        let mut slides = jaw_and_skull(shape_for(&variant));
        let normal = SlidingNormal::Direction(Vector::zeros());
        slides.sliding.push(Sliding { nodes: set("z_min"), normal, segment: None });
        let (pointer, code, _) = refusal(&slides, &Plan::default());
        assert_eq!((pointer.as_str(), code), ("/case/sliding/0/normal", "sliding-normal-zero"));
    }
}

/// Tissue of 3 mm, a patch of its base moved by 25 mm: an answer that nobody may take for one.
#[test]
fn a_movement_of_25_mm_under_3_mm_of_tissue_is_reported_with_its_numbers() {
    for variant in variants() {
        let mut mesh = block(Vector::new(60.0, 40.0, 3.0), [15, 10, 1], shape_for(&variant));
        let inside = |node: &u32| {
            let x = mesh.nodes[*node as usize];
            ((x.x - 30.0).abs(), (x.y - 20.0).abs())
        };
        let base = mesh.node_sets["z_min"].clone();
        let patch =
            base.iter().filter(|n| inside(n).0 < 8.1 && inside(n).1 < 8.1).copied().collect();
        let far =
            base.iter().filter(|n| inside(n).0 > 15.9 || inside(n).1 > 15.9).copied().collect();
        mesh.node_sets.insert("patch".to_owned(), patch);
        mesh.node_sets.insert("far".to_owned(), far);
        let mut case = case_of(mesh, material(15.0, 0.46));
        case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("patch") });
        case.fixed.push(set("far"));
        case.skin = Some(set("z_max"));
        for by in [Vector::z() * 25.0, Vector::z() * -25.0, Vector::x() * 25.0] {
            let found = answer(&case, &moved(by), &variant.settings).unwrap();
            assert!(found.displacement.iter().flatten().all(|value| value.is_finite()));
            let warning = found
                .warnings
                .iter()
                .find(|w| w.code.starts_with("large-"))
                .unwrap_or_else(|| panic!("{} {by}: {:?}", variant.label, found.warnings));
            let estimate = warning.numbers[0];
            assert!(estimate.0 == "estimate_mm" && estimate.1 > 0.5, "{warning:?}");
        }
    }
}

#[test]
fn no_values_have_no_statistics_and_too_few_landmarks_no_alignment() {
    assert_eq!(Statistics::plain(&[]).err(), Some(StatisticsError::Empty));
    let points = [Vector::zeros(), Vector::x()];
    let found = mechanics::registration::align_points(&points, &points);
    assert!(matches!(found, Err(AlignmentError::TooFewPoints { .. })), "{found:?}");
}

// V.46: what must not depend on threads, units and the place of the scene.

fn turned() -> RigidMovement {
    let angles = Vector::new(7.0, -5.0, 11.0).map(f64::to_radians);
    RigidMovement::about_pivot(angles, Vector::new(3.0, 40.0, -50.0), Vector::new(1.5, -0.7, 5.0))
}

fn with_movement(movement: RigidMovement) -> Plan {
    Plan { segments: vec![PlannedSegment { name: "jaw".to_owned(), movement }], ..Plan::default() }
}

#[test]
fn every_variant_answers_with_the_same_bits_on_any_number_of_threads() {
    for variant in variants() {
        let mesh = block(Vector::new(40.0, 30.0, 20.0), [16, 12, 8], shape_for(&variant));
        let mut case = case_of(mesh, material(15.0, 0.46));
        case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") });
        case.fixed.push(set("x_max"));
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool
                .install(|| answer(&case, &with_movement(turned()), &variant.settings).unwrap());
            (found.displacement, found.reactions, found.warnings)
        };
        let once = on(1);
        for threads in [1, 2, 3] {
            assert_eq!(once, on(threads), "{} on {threads} threads", variant.label);
        }
    }
}

/// The mesh, its materials untouched, with every length in another unit.
fn scaled(case: &Case, factor: f64) -> Case {
    let mut case = case.clone();
    Arc::make_mut(&mut case.volume).nodes.iter_mut().for_each(|x| *x *= factor);
    case
}

#[test]
fn every_variant_answers_the_same_in_metres_as_in_millimetres() {
    for variant in variants() {
        let settings = Settings { element: variant.settings.element, ..exact() };
        let case = jaw_and_skull(shape_for(&variant));
        let here = answer(&case, &with_movement(turned()), &settings).unwrap();
        let movement =
            RigidMovement::new(*turned().rotation(), turned().translation() * 1e-3).unwrap();
        let there = answer(&scaled(&case, 1e-3), &with_movement(movement), &settings).unwrap();
        let largest = here.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
        for (a, b) in here.displacement.iter().zip(&there.displacement) {
            // A residual of 1e-13 on a well-conditioned block.
            assert!((a - b * 1e3).norm() < 1e-10 * largest, "{}", variant.label);
        }
    }
}

#[test]
fn every_variant_moves_and_turns_its_answer_with_the_scene() {
    let pose = RigidMovement::about_pivot(
        Vector::new(0.4, -1.2, 2.0),
        Vector::new(10.0, 0.0, 5.0),
        Vector::new(100.0, -30.0, 70.0),
    );
    let far = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::repeat(1e4));
    for variant in variants() {
        let settings = Settings { element: variant.settings.element, ..exact() };
        let case = jaw_and_skull(shape_for(&variant));
        let here = answer(&case, &with_movement(turned()), &settings).unwrap();
        for pose in [pose, far] {
            let mut there = case.clone();
            let mesh = Arc::make_mut(&mut there.volume);
            mesh.nodes.iter_mut().for_each(|x| *x = pose.apply(x));
            let movement = pose.inverse().then(&turned()).then(&pose);
            let found = answer(&there, &with_movement(movement), &settings).unwrap();
            for (a, b) in here.displacement.iter().zip(&found.displacement) {
                assert!((pose.rotation() * a - b).norm() < 1e-8, "{}", variant.label);
            }
        }
    }
}
