//! Tests of scenes that are stopped while they are built.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::case::{
    BodyFibres, Case, FibreDirection, Hounsfield, Mixing, Muscle, MuscleCourse, Plan, Settings,
    SkinMembrane, TissueWindow,
};
use super::error_code::SceneErrorCode;
use super::method::Method;
use super::problem::NoScene;
use super::scene::Scene;
use crate::boundary::NodeSelection;
use crate::image::{ImageVolume, Placement, Voxels};
use crate::material::{LinearElastic, PlaneStress, Sheet};
use crate::mesh::quality::quality_unless_stopped;
use crate::mesh::sample::block;
use crate::mesh::{CellShape, TriangleSurface, Vector};
use crate::muscle::strap::box_surface;
use crate::progress::{Phase, Progress, StopQuery};

/// Cells along each edge of the block.
const CELLS: usize = 8;

/// Questions, evenly chosen, that are answered with a stop one after the other.
const STOPS: usize = 12;

/// Counts the questions, and says stop to one of them only.
struct OnceAt {
    asked: AtomicUsize,
    stop_at: usize,
}

impl OnceAt {
    fn new(stop_at: usize) -> Self {
        OnceAt { asked: AtomicUsize::new(0), stop_at }
    }
}

impl Progress for OnceAt {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        self.asked.fetch_add(1, Ordering::SeqCst) == self.stop_at
    }
}

fn tissue() -> LinearElastic {
    LinearElastic::new(5.0, 0.45, 1.0).unwrap()
}

/// A block of 16 mm that stands on its lower side.
fn plain() -> Case {
    Case {
        volume: block(Vector::repeat(16.0), [CELLS; 3], CellShape::Hex8).into(),
        fixed: vec![NodeSelection::NodeSet("z_min".to_owned())],
        materials: [("*".to_owned(), tissue())].into(),
        ..Case::default()
    }
}

fn near_a_surface(case: Case) -> Case {
    let near = NodeSelection::NearSurface { surface: "bone".to_owned(), distance: 1.0 };
    let bone = box_of([4.0, 4.0, -4.0], [12.0, 12.0, 0.0]);
    Case { fixed: vec![near], surfaces: [("bone".to_owned(), bone)].into(), ..case }
}

fn imaged(case: Case) -> Case {
    let steps = [Vector::x(), Vector::y(), Vector::z()].map(|step| step * 32.0);
    let placement = Placement { origin: Vector::repeat(-8.0), steps };
    let image = ImageVolume::new([2; 3], placement, Voxels::I16(vec![50; 8])).unwrap();
    let window =
        TissueWindow { name: "muscle".to_owned(), from_hu: 0.0, to_hu: 100.0, material: tissue() };
    let (samples, tissues, mixing) = (8, vec![window], Mixing::Fraction);
    Case { hounsfield: Some(Hounsfield { image: image.into(), samples, tissues, mixing }), ..case }
}

fn with_muscle(case: Case, course: MuscleCourse) -> Case {
    let (name, stiffening) = (format!("muscle {}", case.muscles.len()), None);
    let mut muscles = case.muscles.clone();
    muscles.push(Muscle { name, course, tissue: Some(tissue()), stiffening });
    Case { muscles, ..case }
}

fn around_a_line(case: Case) -> Case {
    let lines = vec![vec![Vector::new(0.0, 8.0, 8.0), Vector::new(16.0, 8.0, 8.0)]];
    with_muscle(case, MuscleCourse::Lines { lines, within: 3.0 })
}

fn in_a_body(case: Case) -> Case {
    let fibres = BodyFibres::Course(FibreDirection::Uniform(Vector::x()));
    let surface = box_of([1.0; 3], [15.0; 3]);
    with_muscle(case, MuscleCourse::Body { surface, fibres })
}

fn box_of(low: [f64; 3], high: [f64; 3]) -> Arc<TriangleSurface> {
    let (low, high) = (Vector::from(low), Vector::from(high));
    let half = (high - low) / 2.0;
    box_surface((low + high) / 2.0, [0, 1, 2].map(|axis| Vector::ith(axis, half[axis]))).into()
}

fn built(case: &Case, progress: &OnceAt) -> Result<Scene, NoScene> {
    let stop = StopQuery::of(progress);
    Scene::unless_stopped(case, &Plan::default(), &Settings::default(), &stop)
}

/// Questions while the scene of a case is built.
fn questions(case: &Case) -> usize {
    let patient = OnceAt::new(usize::MAX);
    assert!(built(case, &patient).is_ok(), "{:?}", built(case, &patient).err());
    patient.asked.into_inner()
}

#[test]
fn a_scene_that_is_stopped_is_none_and_who_lets_it_be_built_has_the_usual_one() {
    let case = in_a_body(around_a_line(imaged(near_a_surface(plain()))));
    let usual = Scene::new(&case, &Plan::default(), &Settings::default()).unwrap();
    let patient = OnceAt::new(usize::MAX);
    let scene = built(&case, &patient).unwrap();
    assert_eq!(scene.material_of_cell, usual.material_of_cell);
    assert_eq!(scene.conditions.constraints.len(), usual.conditions.constraints.len());
    let questions = patient.asked.into_inner();
    let stops = (0..questions).step_by(questions.div_ceil(STOPS));
    for at in stops.chain([questions - 1]) {
        let impatient = OnceAt::new(at);
        assert_eq!(built(&case, &impatient).err(), Some(NoScene::Stopped), "question {at}");
        // Threads that ask at the same time.
        let asked = impatient.asked.into_inner();
        assert!(asked <= at + 1 + rayon::current_num_threads(), "{asked} questions, stop at {at}");
    }
}

#[test]
fn long_loops_over_cells_and_nodes_ask_whether_to_stop() {
    let few = questions(&plain());
    let loops = CELLS.pow(3) / 64;
    for longer in [near_a_surface, imaged, around_a_line, in_a_body] {
        let asked = questions(&longer(plain()));
        assert!(asked >= few + loops / 2, "{asked} questions, {few} without the loop");
    }
}

#[test]
fn what_is_wrong_is_told_where_nobody_stops() {
    let case = Case { fixed: Vec::new(), ..plain() };
    let usual = Scene::new(&case, &Plan::default(), &Settings::default()).err().unwrap();
    let told = built(&case, &OnceAt::new(usize::MAX)).err();
    assert_eq!(told, Some(NoScene::Refused(usual)));
}

#[test]
fn a_membrane_without_compression_is_refused_where_it_is_stated() {
    let sheet =
        Sheet { thickness: 1.5, young_modulus: 200.0, poisson_ratio: 0.45, along_lines: None };
    let sheet = PlaneStress::new(&sheet).unwrap().with_tension(10.0).unwrap();
    let told = |sheet: PlaneStress, method: Method| {
        let membrane = Some(SkinMembrane { sheet, lines: None });
        let settings = Settings { membrane, method, ..Settings::default() };
        let refused = Scene::new(&plain(), &Plan::default(), &settings).err();
        refused.map(|errors| (errors.0[0].code, errors.0[0].pointer.clone()))
    };
    let at = |place: &str| Some((SceneErrorCode::MethodNotAvailable, place.to_owned()));
    let slack = sheet.without_compression().unwrap();
    assert_eq!(told(slack, Method::FemLinear), at("/spec/membrane/compression"));
    assert_eq!(told(slack, Method::FemNonlinear), None);
    assert_eq!(told(sheet, Method::FemLinear), None);
}

#[test]
fn quality_is_left_out_after_a_stop() {
    let mesh = block(Vector::repeat(16.0), [CELLS; 3], CellShape::Hex8);
    let (stopped, patient) = (OnceAt::new(0), OnceAt::new(usize::MAX));
    let stop = StopQuery::of(&stopped);
    assert_eq!(quality_unless_stopped(&mesh, &stop).total_volume, 0.0);
    assert!(stop.is_asked(), "who asks afterwards knows");
    let whole = quality_unless_stopped(&mesh, &StopQuery::of(&patient)).total_volume;
    assert!((whole - 4096.0).abs() < 1e-9, "{whole} mm³");
}
