//! The columns of a response: twelve load cases a segment, solved on one tissue.
//!
//! Column 4 i + j of segment s is the skin's u for u(x) = E_ij (x - centre) at the joined nodes of s, j < 3,
//! or u = e_i, j = 3, and zero wherever else a node is held. Sliding nodes are held across their wall and free
//! along it: at n . u(x) where s carries the wall, at zero where something else does or nothing.

use super::coupling::{PROBES, Probed};
use super::inner_loads::load_case;
use super::linearity::{self, Linearity, SampledSecond, joined_nodes};
use super::probes::{Probes, Squares};
use super::quadratic_form::{QuadraticForm, pairs};
use super::response_error::ResponseError;
use super::rigid_numbers::SAMPLES;
use super::second_order::Solutions;
use super::superposition::{Amounts, InnerLoad};
use super::{COLUMNS_PER_SEGMENT, Response, ResponseSegment, superposition};
use crate::boundary::tearing::{EdgeBetween, edges_between};
use crate::boundary::{ConnectedPart, Constraint, NodeClass};
use crate::mesh::Vector;
use crate::mesh::ignored::listed;
use crate::model::fem::force_series::ForceSeries;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::plan::RigidMovement;

use crate::prediction::{Scene, without_second_order};
use crate::progress::{Phase, Progress};
use crate::solver::{SolveReport, SolverError};

/// Bytes of one node in one load case: its force, its displacement, its unknowns.
const BYTES_OF_NODE: f64 = 72.0;

/// Bytes of one node beside the columns while those of second order are solved: forces and vectors of eight pairs.
const BYTES_OF_PAIRS: f64 = 2000.0;

/// How far a response goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResponseOrder {
    #[default]
    First,
    /// With the quadratic form of what linearity leaves out.
    Second,
}

/// A response in f64, as it was solved, with what tells how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Columns {
    pub segments: Vec<ResponseSegment>,
    /// A column each, after those of the segments.
    pub inner: Vec<InnerLoad>,
    /// The skin nodes, ascending.
    pub nodes: Vec<u32>,
    /// As in [`Response`], in f64.
    pub values: Vec<f64>,
    pub linearity: Linearity,
    /// The second order, where it was asked for.
    pub second_order: Option<QuadraticForm>,
    /// Connected parts with their constraints; segments by their place in `segments`, others stay.
    pub parts: Vec<ConnectedPart>,
    /// Edges that a plan may tear, of nodes held by different segments, numbered as in `parts`, or by one and what stays.
    pub edges_between: Vec<EdgeBetween>,
    /// For each segment whether tissue slides on it.
    pub carries_wall: Vec<bool>,
    /// Whether plans may carry the whole tissue away as one.
    pub allow_unfixed: bool,
    /// From one corner of the box around the mesh to the other, in mm.
    pub diagonal: f64,
    /// Of the column that took most iterations; the residual is the largest of all.
    pub solver: SolveReport,
    /// The elements used.
    pub elements: Vec<String>,
}

/// The numbers of the named segments in the scene, in the order of the scene; all where none is named.
/// Refuses a scene whose answer is not linear in the movements of its segments.
pub fn chosen(scene: &Scene, names: &[String]) -> Result<Vec<usize>, ResponseError> {
    let known = || scene.segments.iter().map(|segment| segment.name.as_str());
    if let Some(name) = names.iter().find(|name| scene.segment(name).is_none()) {
        let known = listed(known());
        return Err(ResponseError::UnknownSegment { name: name.clone(), known });
    }
    if let Some(&first) = scene.conditions.shared.first() {
        return Err(ResponseError::SharedNodes { count: scene.conditions.shared.len(), first });
    }
    let is_prescribed = |class: &NodeClass| *class == NodeClass::Prescribed;
    if !scene.settings.method.properties().is_linear {
        return Err(ResponseError::OtherMethod);
    }
    if scene.conditions.classes.iter().any(is_prescribed)
        || scene.forces.iter().any(|force| *force != Vector::zeros())
    {
        return Err(ResponseError::Loaded);
    }
    let wanted = |name: &str| names.is_empty() || names.iter().any(|other| other == name);
    let segments: Vec<usize> =
        (0..).zip(known()).filter(|(_, name)| wanted(name)).map(|(number, _)| number).collect();
    if segments.is_empty() {
        return Err(ResponseError::NoSegments);
    }
    match segment_carrying_skin(scene, &segments) {
        Some(name) if !scene.allow_unfixed => Err(ResponseError::NothingHeld { name }),
        _ => Ok(segments),
    }
}

/// Refuses an order that the elements of a scene, or its tissue, do not have.
pub fn check_order(scene: &Scene, order: ResponseOrder) -> Result<(), ResponseError> {
    match order == ResponseOrder::Second && without_second_order(scene).is_some() {
        true => Err(ResponseError::NoSecondOrder),
        false => Ok(()),
    }
}

/// The place of a segment in the list of those that may move.
fn place_among(chosen: &[usize], segment: u32) -> Option<u32> {
    let place = chosen.iter().position(|&other| other == segment as usize);
    place.map(|place| place as u32)
}

/// The parts of a scene where only these segments may move, by their place in the list.
fn parts_where(scene: &Scene, chosen: &[usize]) -> Vec<ConnectedPart> {
    let number = |segment: u32| place_among(chosen, segment);
    scene.parts.iter().map(|part| part.clone().with_segments(number)).collect()
}

/// Edges between what may move and what else holds tissue, segments by their place in the list; not those to nodes that
/// slide, which may go along with a wall.
fn edges_where(scene: &Scene, chosen: &[usize]) -> Vec<EdgeBetween> {
    let holder = |class: NodeClass| match class {
        NodeClass::Joined(segment) => {
            Some(place_among(chosen, segment).map_or(NodeClass::Fixed, NodeClass::Joined))
        }
        NodeClass::Fixed => Some(NodeClass::Fixed),
        NodeClass::Prescribed | NodeClass::Sliding | NodeClass::Free => None,
    };
    let held = |edge: EdgeBetween| {
        let [a, b] = edge.held_by.map(holder);
        let held_by = [a?, b?];
        (held_by[0] != held_by[1]).then_some(EdgeBetween { held_by, ..edge })
    };
    edges_between(&scene.mesh, &scene.conditions).into_iter().filter_map(held).collect()
}

/// A segment with which every part of the skin that may move goes along as one, whatever the plan: nothing else
/// holds it.
fn segment_carrying_skin(scene: &Scene, chosen: &[usize]) -> Option<String> {
    let parts = parts_where(scene, chosen);
    let moving =
        parts.iter().filter(|part| part.has_much_skin() && part.segments().next().is_some());
    let alone: Option<Vec<u32>> =
        moving.map(|part| part.segments().next().filter(|_| part.held.len() == 1)).collect();
    let segment = chosen[*alone?.first()? as usize];
    Some(scene.segments[segment].name.clone())
}

/// Solves the columns of the named segments, of all where none is named.
pub fn build(
    scene: &Scene,
    names: &[String],
    progress: &dyn Progress,
) -> Result<Columns, ResponseError> {
    build_to(scene, names, ResponseOrder::First, progress)
}

/// The same with columns up to an order.
pub fn build_to(
    scene: &Scene,
    names: &[String],
    order: ResponseOrder,
    progress: &dyn Progress,
) -> Result<Columns, ResponseError> {
    build_of(scene, &ColumnRequest { segments: names, order, inner: &[] }, progress)
}

/// The columns that are asked for.
#[derive(Clone, Copy)]
pub struct ColumnRequest<'a> {
    /// Names of segments; all where none is named.
    pub segments: &'a [String],
    pub order: ResponseOrder,
    /// Known to the scene ([`inner_loads`](super::inner_loads())).
    pub inner: &'a [InnerLoad],
}

/// The same with columns of what acts inside.
pub fn build_of(
    scene: &Scene,
    asked: &ColumnRequest,
    progress: &dyn Progress,
) -> Result<Columns, ResponseError> {
    // 1. What is asked.
    let ColumnRequest { segments: names, order, inner } = *asked;
    let chosen = chosen(scene, names)?;
    check_order(scene, order)?;
    if order == ResponseOrder::Second && !inner.is_empty() {
        return Err(ResponseError::NoSecondOrderInside);
    }
    let mut segments = Vec::with_capacity(chosen.len());
    for &number in &chosen {
        segments.push(segment_of(scene, number)?);
    }
    let of_segments = COLUMNS_PER_SEGMENT * segments.len();
    let columns = of_segments + inner.len();
    check_memory(scene, columns, order)?;
    let zeros = vec![Vector::zeros(); scene.mesh.nodes.len()];
    let mut cases: Vec<LoadCase> = (0..of_segments)
        .map(|column| {
            let (place, unit) = (column / COLUMNS_PER_SEGMENT, column % COLUMNS_PER_SEGMENT);
            let held = held_values(scene, chosen[place], &segments[place].centre, unit);
            LoadCase { held, forces: zeros.clone(), ..LoadCase::default() }
        })
        .collect();
    for load in inner {
        cases.push(load_case(scene, load)?);
    }

    // 2. The tissue for each of them.
    let nodes = scene.skin.nodes().to_vec();
    let all = Cases { all: &cases, of_segments };
    let Solved { solved, sampled, coupling, second_order } = solve(scene, &all, order, progress)?;

    // 3. Its skin.
    progress.phase(Phase::Surface);
    let mut values = Vec::with_capacity(3 * columns * nodes.len());
    for equilibrium in &solved {
        for &node in &nodes {
            values.extend_from_slice(equilibrium.displacement[node as usize].as_slice());
        }
    }
    let parts = parts_where(scene, &chosen);
    let mut linearity = linearity::of_scene(scene, &chosen, &parts);
    let centres = segments.iter().map(|segment| segment.centre);
    let samples = centres.zip(sampled);
    linearity.coupling = coupling;
    linearity.sampled = samples.map(|(centre, second)| SampledSecond { centre, second }).collect();
    let (solver, elements) = (hardest(&solved)?, scene.elements());
    let carries_wall =
        chosen.iter().map(|&number| scene.conditions.carried_by(number as u32) > 0).collect();
    let [low, high] = scene.mesh.bounds();
    Ok(Columns {
        segments,
        inner: inner.to_vec(),
        nodes,
        values,
        linearity,
        second_order,
        parts,
        edges_between: edges_where(scene, &chosen),
        carries_wall,
        allow_unfixed: scene.allow_unfixed,
        diagonal: (high - low).norm(),
        solver,
        elements,
    })
}

/// The tissue for each load case, samples of its second order for each segment where elements have one, and all of it
/// where that is asked for.
#[derive(Default)]
struct Solved {
    solved: Vec<Equilibrium>,
    sampled: Vec<[f64; SAMPLES]>,
    coupling: Vec<Probed>,
    second_order: Option<QuadraticForm>,
}

/// A load case for each column, those of the segments first.
struct Cases<'a> {
    all: &'a [LoadCase],
    of_segments: usize,
}

fn solve(
    scene: &Scene,
    cases: &Cases,
    order: ResponseOrder,
    progress: &dyn Progress,
) -> Result<Solved, ResponseError> {
    let Some(system) = scene.assemble(progress)? else {
        let solved = scene.solve_cases(cases.all, progress)?;
        return Ok(Solved { solved, ..Solved::default() });
    };
    let columns = system.solve(cases.all, progress)?;
    let pressures = system.pressures.as_ref().map(|pressures| &pressures.cells);
    let series = ForceSeries::new(scene.tissue(), pressures);
    let skin = &scene.skin;
    let of_segments = &columns[..cases.of_segments];
    let solutions = Solutions { series, system: &system, columns: of_segments, skin };
    let (mut sampled, mut coupling, mut second_order) = (Vec::new(), Vec::new(), None);
    if without_second_order(scene).is_none() {
        sampled = solutions.second_of_each(progress)?;
        let probes = Probes::solve(&solutions, progress)?;
        coupling = probes.second(&solutions)?;
        if order == ResponseOrder::Second {
            let mut squares = Squares::new(of_segments.len());
            let pass = &mut |pair, solution: &_| squares.add(pair, solution);
            let mut form = solutions.quadratic_form(pass, progress)?;
            form.coupling = probes.third(&solutions, &squares.states, progress)?;
            second_order = Some(form);
        }
    }
    let solved = columns.into_iter().map(|solved| solved.equilibrium).collect();
    Ok(Solved { solved, sampled, coupling, second_order })
}

impl Columns {
    /// The displacement of each skin node in mm, for one movement of each segment.
    pub fn apply(&self, movements: &[RigidMovement]) -> Vec<Vector> {
        self.apply_all(&Amounts { movements, inner: &[] })
    }

    /// The same with what acts inside.
    pub fn apply_all(&self, amounts: &Amounts) -> Vec<Vector> {
        superposition::apply(&self.segments, amounts, &self.values, self.nodes.len())
    }

    /// The columns as they are stored and served.
    pub fn to_response(&self) -> Response {
        Response {
            segments: self.segments.clone(),
            inner: self.inner.clone(),
            nodes: self.nodes.clone(),
            columns: self.values.iter().map(|&value| value as f32).collect(),
        }
    }
}

/// A segment with the mean of its nodes as centre.
pub(super) fn segment_of(scene: &Scene, number: usize) -> Result<ResponseSegment, ResponseError> {
    let name = scene.segments[number].name.clone();
    let (mut sum, mut count) = (Vector::zeros(), 0);
    for place in joined_nodes(scene, number) {
        sum += place;
        count += 1;
    }
    match count {
        0 => Err(ResponseError::EmptySegment { name }),
        _ => Ok(ResponseSegment { name, centre: sum / f64::from(count) }),
    }
}

/// For each hold its displacement along its axes for one unit of one number of a segment's movement.
pub(super) fn held_values(
    scene: &Scene,
    segment: usize,
    centre: &Vector,
    unit: usize,
) -> Vec<Vector> {
    let (row, column) = (unit / 4, unit % 4);
    let value = |node: u32| {
        let mut displacement = Vector::zeros();
        let place = scene.mesh.nodes[node as usize] - centre;
        displacement[row] = if column == 3 { 1.0 } else { place[column] };
        displacement
    };
    let conditions = &scene.conditions;
    let values = |constraint: &Constraint| {
        let moved = |other: u32| match other as usize == segment {
            true => value(constraint.node),
            false => Vector::zeros(),
        };
        conditions.values(constraint, &moved)
    };
    conditions.constraints.iter().map(values).collect()
}

/// All load cases stand in memory together.
fn check_memory(scene: &Scene, columns: usize, order: ResponseOrder) -> Result<(), ModelError> {
    let (nodes, skin) = (scene.mesh.nodes.len() as f64, scene.skin.nodes().len() as f64);
    let second = match order {
        ResponseOrder::First => 0.0,
        ResponseOrder::Second => {
            let stored = pairs(columns).count() * 3 * size_of::<i16>();
            let directions = columns / COLUMNS_PER_SEGMENT * SAMPLES;
            let samples = (3 * SAMPLES + pairs(directions).count()) * size_of::<Vector>();
            stored as f64 * skin + (samples as f64 + BYTES_OF_PAIRS) * nodes
        }
    };
    let probes = (2 * PROBES * size_of::<Vector>()) as f64;
    let needed_mb = ((columns as f64 * BYTES_OF_NODE + probes) * nodes + second) / 1e6;
    let allowed_mb = scene.settings.memory_mb;
    match needed_mb > allowed_mb {
        true => Err(SolverError::OverBudget { needed_mb, allowed_mb }.into()),
        false => Ok(()),
    }
}

/// The report of the column that took most iterations, with the largest residual of all.
fn hardest(solved: &[Equilibrium]) -> Result<SolveReport, ResponseError> {
    let reports = || solved.iter().map(|equilibrium| &equilibrium.solver);
    let largest = reports().map(|report| report.relative_residual).fold(0.0, f64::max);
    let hardest = reports().max_by_key(|report| report.iterations);
    let hardest = hardest.ok_or(ResponseError::NoSegments)?.clone();
    Ok(SolveReport { relative_residual: largest, ..hardest })
}
