//! Expected cost of a prediction, before it is solved.

use super::input::Prepared;
use crate::jobs::failure::JobError;
use crate::schema::Limits;
use crate::schema::methods::{MethodName, time_band};
use crate::schema::predict::refine::RefineBoundDocument;
use crate::schema::predict::time_band::TimeBandDocument;
use mechanics::mesh::CellShape;
use mechanics::prediction::{
    Advance, ElementChoice, Laws, MethodKind, NEWTON_MAY_TAKE, Scene, Unknowns,
};
use mechanics::prediction::{ModelError, SolverError};

/// The peak of a whole process in MB was measured for blocks of up to 384 000 cells (12, 24 and 40 bricks along each
/// edge, six tetrahedra a brick), files of the skin and the volume included: some 20 MB for the program, up to 30 more
/// for the factorisation of a small system, and this number of bytes for each cell. The estimate was within a third of each.
const PROGRAM_MB: f64 = 30.0;
const HEXAHEDRON: f64 = 4700.0;
/// Two share a node with twenty neighbours, where one hexahedron has a node with 26.
const WEDGE: f64 = 2300.0;
const TETRAHEDRON: f64 = 520.0;
const OF_SPRINGS: f64 = 680.0;
const WITH_PRESSURE: f64 = 780.0;
const QUADRATIC: f64 = 6700.0;
/// Additional memory of an element at finite strain: 1160 to 1600 bytes a tetrahedron, 10 300 a hexahedron and 6100 a wedge
/// were measured on hard blocks of 109 350 tetrahedra, 18 225 hexahedra and 36 450 wedges (`docs/finite-strain.md`).
const AT_FINITE_STRAIN: f64 = 2.5;
/// A cell that is read, drawn and written, but not assembled.
const READ_ONLY: f64 = 200.0;
/// A refined mesh is in memory with the previous one and the tree of its cells.
const BESIDE_ANOTHER: f64 = 1.5;
/// Of one column of a response at one node: its right-hand side, its unknowns and its vectors of the iteration. 24
/// columns at the 50 700 nodes of `docs/performance.md` took 254 MB more than one.
const COLUMN_AT_NODE: f64 = 210.0;

/// Factor of the time if gaps close: that of a jaw raised by 4, 8 and 15 mm into the lips of two faces over that of
/// the same without contact at small strain (`docs/contact.md#what-was-measured`); at finite strain it is chosen, not measured.
pub const CONTACT: f64 = 80.0;
pub const CONTACT_AT_FINITE_STRAIN: f64 = 5.0;

/// The memory of a process that solves a scene, in MB, and of the columns of a response. Volume splines check
/// the size of their lattice themselves, and have the memory of their mesh here.
pub fn memory_mb(scene: &Scene, columns: usize) -> f64 {
    let cells: f64 = scene.mesh.cells.iter().map(|(shape, _)| bytes_of_cell(scene, shape)).sum();
    let columns = (columns * scene.mesh.nodes.len()) as f64;
    PROGRAM_MB + (cells + columns * COLUMN_AT_NODE) / 1e6
}

fn bytes_of_cell(scene: &Scene, shape: CellShape) -> f64 {
    match scene.settings.method.properties().unknowns {
        Unknowns::None | Unknowns::ControlPoints => READ_ONLY,
        Unknowns::Springs => OF_SPRINGS,
        Unknowns::Elements if is_at_finite_strain(scene) => {
            AT_FINITE_STRAIN * bytes_of_element(shape, scene.element) + bytes_of_tensors(scene)
        }
        Unknowns::Elements => bytes_of_element(shape, scene.element),
    }
}

/// The nonlinear mass-tensor stores 243 numbers for each cell.
fn bytes_of_tensors(scene: &Scene) -> f64 {
    match scene.settings.method.properties().laws {
        Laws::AtRest | Laws::Any => 0.0,
        Laws::SaintVenantKirchhoff => 243.0 * 8.0,
    }
}

fn is_at_finite_strain(scene: &Scene) -> bool {
    let properties = scene.settings.method.properties();
    properties.unknowns == Unknowns::Elements && !properties.is_small_strain
}

fn bytes_of_element(shape: CellShape, element: ElementChoice) -> f64 {
    match (shape, element) {
        (CellShape::Hex8, _) => HEXAHEDRON,
        (CellShape::Wedge6, _) => WEDGE,
        (CellShape::Tet4, ElementChoice::Plain | ElementChoice::MeanDilatation) => TETRAHEDRON,
        (CellShape::Tet4, ElementChoice::Auto | ElementChoice::Stabilised) => WITH_PRESSURE,
        (CellShape::Tet4, ElementChoice::Quadratic) => QUADRATIC,
    }
}

/// The expected range of the solution time of a scene, in s; none for methods whose unknowns are not those of the
/// mesh.
pub fn time_s(scene: &Scene, method: MethodName) -> Option<TimeBandDocument> {
    let takes = if is_at_finite_strain(scene) { CONTACT_AT_FINITE_STRAIN } else { CONTACT };
    time_without_contact_s(scene, method).map(|band| with_contact(scene, band, takes))
}

/// The times of a scene in which gaps may close, longer by up to this factor.
pub fn with_contact(scene: &Scene, band: TimeBandDocument, takes: f64) -> TimeBandDocument {
    match scene.settings.contact.is_unilateral() {
        true => TimeBandDocument { high: takes * band.high, ..band },
        false => band,
    }
}

/// The same without contact.
pub fn time_without_contact_s(scene: &Scene, method: MethodName) -> Option<TimeBandDocument> {
    let nodes = scene.mesh.nodes.len();
    let held: usize =
        scene.conditions.constraints.iter().map(|constraint| constraint.count()).sum();
    let unknowns = (3 * nodes - held) as f64;
    match scene.settings.method.properties().unknowns {
        Unknowns::None | Unknowns::ControlPoints => return None,
        Unknowns::Springs | Unknowns::Elements => {}
    }
    let unknowns = match scene.element {
        // An edge for seven in eight nodes of the finer mesh.
        ElementChoice::Quadratic => 8.0 * unknowns,
        ElementChoice::Auto
        | ElementChoice::Plain
        | ElementChoice::MeanDilatation
        | ElementChoice::Stabilised => unknowns,
    };
    if is_at_finite_strain(scene) {
        let linear = time_band(MethodKind::FemLinear.name(), unknowns as u64);
        return linear.map(at_finite_strain).map(|band| in_load_steps(scene, band));
    }
    time_band(method.chosen().name(), unknowns as u64)
}

/// The times of Newton's method, from those of a linear solution.
pub fn at_finite_strain(linear: TimeBandDocument) -> TimeBandDocument {
    let [least, most] = NEWTON_MAY_TAKE;
    TimeBandDocument { low: least * linear.low, high: most * linear.high }
}

/// The times of a scene at finite strain: for each load step that of all at once at most, and a third of it at least (5 load steps took
/// 1.9 times the steps of Newton's method, 4 took 3.3 times as many).
fn in_load_steps(scene: &Scene, at_once: TimeBandDocument) -> TimeBandDocument {
    match scene.settings.advance {
        Advance::AtOnce | Advance::AtOnceOrInParts => at_once,
        Advance::InSteps(steps) => {
            let steps = f64::from(steps.get());
            let low = at_once.low * (steps / 3.0).max(1.0);
            TimeBandDocument { low, high: at_once.high * steps }
        }
    }
}

/// The most cells of a refined scene, and their expected memory: the cells of the spec, or fewer
/// if limited by the memory of a slot.
pub fn refined_bound(scene: &Scene, asked: u64, limits: &Limits) -> RefineBoundDocument {
    let of_cell = (memory_mb(scene, 0) - PROGRAM_MB) / scene.mesh.cells.len().max(1) as f64;
    let fitting = ((limits.slot_memory_mb - PROGRAM_MB) / (of_cell * BESIDE_ANOTHER)).max(0.0);
    let cells = asked.min(fitting as u64);
    let memory_mb = PROGRAM_MB + cells as f64 * of_cell * BESIDE_ANOTHER;
    RefineBoundDocument { cells, memory_mb }
}

/// The memory of a process that solves the same scene at finite strain, in MB.
pub fn memory_at_finite_strain_mb(scene: &Scene) -> f64 {
    let bytes = |shape| AT_FINITE_STRAIN * bytes_of_element(shape, scene.element);
    PROGRAM_MB + scene.mesh.cells.iter().map(|(shape, _)| bytes(shape)).sum::<f64>() / 1e6
}

impl Prepared {
    /// Why the memory of a slot is too small for finite strain, if it is.
    pub fn too_large_at_finite_strain(&self, limits: &Limits) -> Option<String> {
        let (needed, allowed) = (memory_at_finite_strain_mb(&self.scene), limits.slot_memory_mb);
        let why = format!("it is expected to need {needed:.0} MB, and {allowed:.0} MB are allowed");
        (needed > allowed).then_some(why)
    }

    /// Refuses a job with more expected memory than a slot has.
    pub fn admit(&self, columns: usize, limits: &Limits) -> Result<(), JobError> {
        let (needed_mb, allowed_mb) = (memory_mb(&self.scene, columns), limits.slot_memory_mb);
        match needed_mb > allowed_mb {
            true => Err(ModelError::from(SolverError::OverBudget { needed_mb, allowed_mb }).into()),
            false => Ok(()),
        }
    }
}
