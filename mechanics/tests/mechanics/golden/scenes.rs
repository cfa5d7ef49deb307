//! Small scenes of every method, and the numbers that the program finds for them. Nothing turns: sines and cosines are
//! the platform's.

use std::sync::Arc;

use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::material::{Fibre, FibreLaw, PlaneStress, Sheet};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::model::mass_spring::{MassSpringSettings, Search};
use mechanics::model::spline::stepping::{Clock, Scheme};
use mechanics::model::spline::{ControlPoints, Stiffness, VolumeSpline};
use mechanics::model::thickness_warp::ThicknessWarp;
use mechanics::optimisation::{Question, optimise};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, FibreDirection, Hounsfield, Load, Method, Mixing, ModelError,
    Plan, RegionNames, Scene, Settings, SkinMembrane, Sliding, SlidingNormal, SolverError,
    TissueWindow, predict,
};
use mechanics::progress::Unobserved;
use mechanics::response::build;
use mechanics::solver::stationary::{Iteration, Stationary};
use mechanics::study::paired::{Equality, ZeroRule, signed_rank};
use mechanics::validation::{Alignment, ComparisonSettings, DistanceStatistics, compare};
use nalgebra::Matrix3;

use crate::optimisation::scenes::{bounds, every_node, moved_skin, planted, response, skin};
use crate::scenes::{case_of, material, set};
use crate::surfaces::{map, sphere};

/// How a line of the table is compared.
#[derive(Clone, Copy)]
pub enum Holds {
    Bits,
    Near,
}

/// The numbers of a scene.
pub struct Found {
    pub name: String,
    pub solver: &'static str,
    pub constraints: Holds,
    pub values: Vec<f64>,
}

/// Cells of a scene that is factorised where it can be, and of one whose memory only iterations fit in.
const SMALL: [usize; 3] = [6, 4, 3];
const ITERATED: [usize; 3] = [8, 7, 6];
const FINER: [usize; 3] = [8, 6, 5];
const MEMORY_MB: f64 = 1.5;

/// A block on bone of which one end moves, along a wall, in two layers.
fn tissue(shape: CellShape, cells: [usize; 3]) -> Case {
    let mut mesh = block(Vector::new(30.0, 20.0, 12.0), cells, shape);
    let (jaw, skull): (Vec<u32>, Vec<u32>) =
        mesh.node_sets["z_min"].iter().partition(|node| mesh.nodes[**node as usize].x < 12.0);
    mesh.node_sets.insert("jaw".to_owned(), jaw);
    mesh.node_sets.insert("skull".to_owned(), skull);
    let is_upper = |cell| i64::from(mesh.corners(cell).all(|corner| corner.z > 7.0));
    let labels = (0..mesh.cells.len()).map(is_upper).collect();
    let course = |cell: usize| mesh.corners(cell).sum::<Vector>() + Vector::new(90.0, 0.0, 9.0);
    let courses = (0..mesh.cells.len()).map(course).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    mesh.cell_vectors.insert("course".to_owned(), courses);
    let names = [(0, "fat".to_owned()), (1, "skin".to_owned())].into();
    let mut case = case_of(mesh, material(15.0, 0.46));
    case.materials.insert("skin".to_owned(), material(60.0, 0.43));
    Case {
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("jaw") }],
        fixed: vec![set("skull")],
        sliding: vec![Sliding {
            nodes: set("y_min"),
            normal: SlidingNormal::Surface,
            segment: None,
        }],
        ..case
    }
}

/// The same with fibres in its lower layer.
fn muscle(shape: CellShape) -> Case {
    let mut case = tissue(shape, SMALL);
    let fibre = Fibre { young_modulus: 60.0, shear_modulus: Some(9.0), law: FibreLaw::Engineering };
    case.materials.insert("fat".to_owned(), material(15.0, 0.46).with_fibre(&fibre).unwrap());
    case.fibres.insert("fat".to_owned(), FibreDirection::Array("course".to_owned()));
    case
}

/// The same with materials from an image: 0 HU at one end, 100 HU at the other.
fn imaged() -> Case {
    let steps = [Vector::x() * 31.0, Vector::y() * 21.0, Vector::z() * 13.0];
    let placement = Placement { origin: Vector::repeat(-0.5), steps };
    let values = (0..8).map(|n| if n % 2 == 1 { 100 } else { 0 }).collect();
    let image = ImageVolume::new([2, 2, 2], placement, Voxels::I16(values)).unwrap();
    let window = |name: &str, from_hu, to_hu, modulus| TissueWindow {
        name: name.to_owned(),
        from_hu,
        to_hu,
        material: material(modulus, 0.46),
    };
    let tissues = vec![window("fat", -10.0, 40.0, 3.0), window("muscle", 40.0, 70.0, 90.0)];
    let mixing = Mixing::Fraction;
    let hounsfield = Hounsfield { image: Arc::new(image), samples: 64, tissues, mixing };
    Case { hounsfield: Some(hounsfield), ..tissue(CellShape::Tet4, SMALL) }
}

fn moved() -> RigidMovement {
    RigidMovement::new(Matrix3::identity(), Vector::new(1.5, 0.25, -0.75)).unwrap()
}

/// The jaw moves, and something presses and pulls where the method knows forces.
fn plan(method: &Method) -> Plan {
    let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement: moved() }];
    let loads = vec![
        Load::Pressure { faces: set("z_max"), pressure: 0.05 },
        Load::Gravity { acceleration: Vector::new(0.0, 0.0, -0.0098) },
    ];
    let loads = if matches!(method, Method::ThicknessWarp(_)) { Vec::new() } else { loads };
    Plan { segments, loads, ..Plan::default() }
}

fn with_element(element: ElementChoice) -> Settings {
    Settings { element, ..Settings::default() }
}

fn with_memory_for(cells: [usize; 3], settings: Settings) -> Settings {
    if cells == ITERATED { Settings { memory_mb: MEMORY_MB, ..settings } } else { settings }
}

fn with_method(method: Method) -> Settings {
    Settings { method, ..Settings::default() }
}

/// Every scene.
pub fn all() -> Vec<Found> {
    let mut found = elements();
    found.extend(tissues());
    found.extend(mass_tensors());
    found.extend(other_models());
    found.extend(
        [columns(Holds::Near, SMALL), columns(Holds::Bits, ITERATED)].into_iter().flatten(),
    );

    found.extend([optimised(), closest_points(), aligned(), ranked(), strain()]);
    found
}

fn predicted(name: &str, constraints: Holds, case: &Case, settings: &Settings) -> Found {
    let scene = Scene::new(case, &plan(&settings.method), settings).unwrap();
    let prediction = predict(&scene, &Unobserved).unwrap();
    let mut values: Vec<f64> = prediction.displacement.iter().flatten().copied().collect();
    // Forces in mN would hide lengths in mm in sums of both.
    if matches!(constraints, Holds::Bits) {
        values.extend(prediction.deformation.iter().map(|cell| cell.det_f));
        values.extend(prediction.reactions.values().flatten());
    }
    Found { name: name.to_owned(), solver: prediction.solver.method, constraints, values }
}

fn elements() -> Vec<Found> {
    use ElementChoice::{MeanDilatation, Plain, Quadratic, Stabilised};
    let of = |name: &str, constraints, shape, cells, element| {
        let settings = with_memory_for(cells, with_element(element));
        predicted(&format!("fem_linear {name}"), constraints, &tissue(shape, cells), &settings)
    };
    let (tet, hex, wedge) = (CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6);
    vec![
        of("plain tet4", Holds::Near, tet, SMALL, Plain),
        of("plain tet4 iterated", Holds::Bits, tet, ITERATED, Plain),
        of("plain hex8", Holds::Near, hex, SMALL, Plain),
        of("stabilised tet4", Holds::Bits, tet, SMALL, Stabilised),
        of("stabilised tet4 finer", Holds::Bits, tet, FINER, Stabilised),
        of("mean_dilatation hex8", Holds::Near, hex, SMALL, MeanDilatation),
        of("mean_dilatation hex8 iterated", Holds::Bits, hex, ITERATED, MeanDilatation),
        of("mean_dilatation wedge6", Holds::Near, wedge, SMALL, MeanDilatation),
        of("quadratic tet4", Holds::Near, tet, SMALL, Quadratic),
    ]
}

fn tissues() -> Vec<Found> {
    let sheet = Sheet {
        thickness: 1.5,
        young_modulus: 200.0,
        poisson_ratio: 0.45,
        along_lines: Some(400.0),
    };
    let lines = Some(FibreDirection::Uniform(Vector::new(1.0, 0.5, 0.25)));
    let membrane = Some(SkinMembrane { sheet: PlaneStress::new(&sheet).unwrap(), lines });
    let skin = Some(set("z_max"));
    let case = Case { skin, ..tissue(CellShape::Tet4, SMALL) };
    let settings = Settings { membrane, ..Settings::default() };
    vec![
        predicted("fem_linear membrane", Holds::Bits, &case, &settings),
        predicted("fem_linear fibres", Holds::Bits, &muscle(CellShape::Tet4), &Settings::default()),
        predicted("fem_linear image", Holds::Bits, &imaged(), &Settings::default()),
    ]
}

fn mass_tensors() -> Vec<Found> {
    let case = tissue(CellShape::Tet4, SMALL);
    let of = |name: &str, constraints, iterations| {
        let method = Method::MassTensor(MassTensorSettings { iterations });
        let settings = Settings { relative_residual: 1e-6, ..with_method(method) };
        predicted(&format!("mtm {name}"), constraints, &case, &settings)
    };
    let own = |iteration| {
        Iterations::Stationary(Stationary {
            iteration,
            relative_change: None,
            most_iterations: 50_000,
        })
    };
    let transverse = with_method(Method::MassTensorTransverse(MassTensorSettings::default()));
    vec![
        of("fast", Holds::Near, Iterations::Fast),
        of("gauss_seidel", Holds::Bits, own(Iteration::GaussSeidel)),
        of("damped_jacobi", Holds::Bits, own(Iteration::DampedJacobi)),
        diverged(&case, own(Iteration::Jacobi)),
        predicted("mtm_ti", Holds::Near, &muscle(CellShape::Tet4), &transverse),
    ]
}

/// Plain Jacobi has no answer but the residuals of its way.
fn diverged(case: &Case, iterations: Iterations) -> Found {
    let settings = with_method(Method::MassTensor(MassTensorSettings { iterations }));
    let scene = Scene::new(case, &plan(&settings.method), &settings).unwrap();
    let values = match predict(&scene, &Unobserved) {
        Err(ModelError::Solver(SolverError::Diverged { history, .. })) => history,
        other => panic!("{other:?}"),
    };
    Found { name: "mtm jacobi".to_owned(), solver: "diverged", constraints: Holds::Bits, values }
}

fn other_models() -> Vec<Found> {
    let case = tissue(CellShape::Tet4, SMALL);
    let springs = |search| {
        let settings = MassSpringSettings { search, most_iterations: 50_000 };
        // Node by node to 1e-8 takes half a minute in a debug build.
        let relative_residual = if search == Search::Direct { 1e-4 } else { 1e-8 };
        Settings { relative_residual, ..with_method(Method::MassSpring(settings)) }
    };
    let spline = |stiffness, clock| {
        let control = ControlPoints::Spaced(6.0);
        let spline = VolumeSpline { stiffness, clock, control, ..VolumeSpline::default() };
        with_method(Method::VolumeSpline(spline))
    };
    let clock = Clock { scheme: Scheme::BackwardEuler, step: 50.0, end: 5000.0 };
    let warp = with_method(Method::ThicknessWarp(ThicknessWarp { blend_radius: 4.0 }));
    vec![
        predicted("fem_nonlinear", Holds::Near, &case, &with_method(Method::FemNonlinear)),
        predicted("mtm_nonlinear", Holds::Near, &case, &with_method(Method::MassTensorNonlinear)),
        predicted("msm newton", Holds::Near, &case, &springs(Search::Newton)),
        predicted("msm direct", Holds::Bits, &case, &springs(Search::Direct)),
        predicted("dvs galerkin", Holds::Near, &case, &spline(Stiffness::Galerkin, None)),
        predicted("dvs lattice", Holds::Near, &case, &spline(Stiffness::Lattice(80.0), None)),
        predicted("dvs in time", Holds::Near, &case, &spline(Stiffness::Galerkin, Some(clock))),
        predicted("thickness_warp", Holds::Bits, &case, &warp),
    ]
}

/// The columns of a response, and a plan applied to them.
fn columns(constraints: Holds, cells: [usize; 3]) -> Vec<Found> {
    let settings = with_memory_for(cells, with_element(ElementChoice::MeanDilatation));
    let case = tissue(CellShape::Hex8, cells);
    let scene = Scene::new(&case, &Plan::default(), &settings).unwrap();
    let columns = build(&scene, &[], &Unobserved).unwrap();
    let solver = columns.solver.method;
    let how = if cells == ITERATED { "iterated" } else { "factorised" };
    let applied = match constraints {
        Holds::Bits => columns.to_response().apply(&[moved()]),
        // Single precision would make one last bit of a column 1e-7 of it.
        Holds::Near => columns.apply(&[moved()]),
    };
    let found = |what: &str, values| Found {
        name: format!("response {what} {how}"),
        solver,
        constraints,
        values,
    };
    vec![
        found("columns", columns.values),
        found("applied", applied.iter().flatten().copied().collect()),
    ]
}

/// Inverse planning on a response whose columns and plan know exponentials, sines and cosines.
fn optimised() -> Found {
    let response = response(&skin());
    let plan = planted([[2.0, -1.0, 0.5, 1.0, 0.0, -2.0], [0.0, 1.5, 0.0, 0.0, 3.0, 0.0]]);
    let mut wanted = moved_skin(&response, &plan);
    wanted.iter_mut().step_by(7).for_each(|u| *u += Vector::new(0.1, -0.05, 0.2));
    let (bounds, targets) = (bounds(4.0, 8.0), [every_node(&wanted, 0.5)]);
    let question = Question {
        response: &response,
        bounds: &bounds,
        targets: &targets,
        inner: &[],
        constants: &[],
        second_order: None,
    };
    let optimum = optimise(&question).unwrap();
    let mut values: Vec<f64> = optimum.parameters.iter().flatten().copied().collect();
    values.extend(optimum.certainty.covariance.iter());
    values.push(optimum.weighted_square_sum);
    Found { name: "optimise".to_owned(), solver: "none", constraints: Holds::Near, values }
}

fn of_distances(found: &DistanceStatistics) -> Vec<f64> {
    let shares = [found.share_below_1_mm, found.share_below_2_mm, found.hausdorff];
    let [unsigned, signed] = [&found.unsigned, &found.signed];
    let numbers = |of: &mechanics::validation::Statistics| {
        [of.mean, of.sd, of.rms, of.median, of.p90, of.p95, of.p99, of.max]
    };
    [numbers(unsigned).as_slice(), &numbers(signed), &shares].concat()
}

fn compared(name: &str, constraints: Holds, alignment: Alignment) -> Found {
    let prediction = sphere(30.0, Vector::zeros(), 3);
    let squeezed = |point: &Vector| point.component_mul(&Vector::new(1.05, 0.9, 1.0)) + Vector::x();
    let actual = map(&prediction, squeezed);
    let settings = ComparisonSettings { alignment, ..ComparisonSettings::default() };
    let comparison = compare(&prediction, &actual, &settings, &Unobserved).unwrap();
    let mut values = comparison.signed_distance.clone();
    let both = &comparison.distances;
    for found in [&both.to_actual, &both.to_prediction, &both.both] {
        values.extend(of_distances(found));
    }
    values.extend(comparison.alignment.transform.rotation.iter());
    values.extend(comparison.alignment.transform.translation.iter());
    Found { name: format!("comparison {name}"), solver: "none", constraints, values }
}

fn closest_points() -> Found {
    compared("as given", Holds::Bits, Alignment::None)
}

fn aligned() -> Found {
    compared("aligned", Holds::Near, Alignment::ClosestPoint { mask: None })
}

/// The test of pairs that a study ends with: counted out, and with the normal tail.
fn ranked() -> Found {
    let few: Vec<f64> = (0..12).map(|n| f64::from(n * n % 7) - 2.5).collect();
    let many: Vec<f64> = (0..40).map(|n| f64::from(n * n % 11) - 4.0).collect();
    let mut values = Vec::new();
    for (pairs, zeros) in [(&few, ZeroRule::Wilcox), (&many, ZeroRule::Pratt)] {
        let equality = Equality { within: 1e-9, zeros };
        let test = signed_rank(pairs, &vec![0.0; pairs.len()], equality).unwrap();
        values.extend([test.two_sided_p, test.effect]);
    }
    Found { name: "study signed rank".to_owned(), solver: "none", constraints: Holds::Near, values }
}

/// What a displacement does to cells.
fn strain() -> Found {
    let scene = Scene::new(
        &tissue(CellShape::Hex8, SMALL),
        &plan(&Method::FemLinear),
        &Settings::default(),
    );
    let prediction = predict(&scene.unwrap(), &Unobserved).unwrap();
    let cells = prediction.deformation.iter();
    let values = cells.flat_map(|cell| [&cell.principal_strain()[..], &[cell.rotation]].concat());
    let (name, solver) = ("strain".to_owned(), prediction.solver.method);
    Found { name, solver, constraints: Holds::Near, values: values.collect() }
}
