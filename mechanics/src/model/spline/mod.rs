//! Dynamic volume spline: soft tissue as a volume of B-splines whose control points have mass, damping and
//! stiffness (Ulusoy et al. 2010; docs/methods.md#volume-spline).
//!
//! M d'' + D d' + K d = f over the displacements d of control points, either in time to rest or at rest at
//! once: K d = f. `lattice` says where control points are, `stiffness` what holds them together,
//! `held_points` what bone does to them, `stepping` how time passes.

pub mod basis;
mod bone_points;
pub mod held_points;
pub mod lattice;
pub mod stepping;
pub mod stiffness;
pub mod tissue_points;

use super::dofs::DofMap;
use super::problem::{Equilibrium, ModelError};
use crate::mesh::{Vector, Warning};
use crate::model::fem::displacement::{Problem, check_finite};
use crate::progress::{Phase, Progress};
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::lanes::Lanes;
use crate::solver::{
    self, Solution, SolveReport, SolverError, System, Unknowns, cholesky, ordering,
};
use bone_points::BonePoints;
use held_points::{HeldPoints, add_at};
pub use lattice::ControlPoints;
use lattice::Lattice;
use stepping::{Clock, Damping, Motion, State};
use stiffness::Assembly;
use tissue_points::tissue_points;

/// Parameters of a volume spline.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeSpline {
    /// Along each principal axis of the tissue, the longest first; 1 to 3.
    pub degrees: [usize; 3],
    pub control: ControlPoints,
    pub bone: Bone,
    /// How hard held nodes are held, see [`held_points`]; in [1, 1e6].
    pub hold_weight: f64,
    pub stiffness: Stiffness,
    pub damping: Damping,
    /// None: at rest at once.
    pub clock: Option<Clock>,
}

/// How bone moves the spline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bone {
    /// Springs draw held nodes to where they have to be.
    #[default]
    Springs,
    /// Control points next to held nodes are bone, and go where these go ([`bone_points`]); at rest only.
    ControlPoints,
}

/// Stiffness between control points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// The elasticity of the tissue.
    Galerkin,
    /// Links of that many mN/mm between neighbours.
    Lattice(f64),
}

/// Relaxes with 1/80 s, which is the damping over the stiffness of Ulusoy et al. 2010, in ms.
pub const RELAXATION: f64 = 12.5;

/// Multiplications of a factorisation that takes up to about half a minute.
const FACTORISED: f64 = 1e11;

impl Default for VolumeSpline {
    fn default() -> Self {
        VolumeSpline {
            degrees: [3; 3],
            control: ControlPoints::Chosen,
            bone: Bone::Springs,
            hold_weight: 5.0,
            stiffness: Stiffness::Galerkin,
            damping: Damping { mass: 0.0, stiffness: RELAXATION },
            clock: None,
        }
    }
}

impl VolumeSpline {
    /// In the words of results, e.g. `B-spline degree 3 galerkin`.
    pub fn element(&self) -> String {
        let stiffness = match self.stiffness {
            Stiffness::Galerkin => "galerkin",
            Stiffness::Lattice(_) => "lattice",
        };
        let [a, b, c] = self.degrees;
        let degrees = if a == b && b == c { a.to_string() } else { format!("{a} x {b} x {c}") };
        let bone = match self.bone {
            Bone::Springs => "",
            Bone::ControlPoints => ", control points of bone",
        };
        format!("B-spline degree {degrees} {stiffness}{bone}")
    }
}

/// The spline of a problem, ready to be solved.
struct Assembled<'a> {
    assembly: Assembly<'a>,
    held: HeldPoints,
    /// Where control points are bone.
    bone: Option<BonePoints>,
    /// Of tissue and holds.
    system: System,
    force: Unknowns,
}

/// Solves for rest.
pub fn solve(
    problem: &Problem,
    spline: &VolumeSpline,
    progress: &dyn Progress,
) -> Result<Equilibrium, ModelError> {
    // 1. Control points.
    progress.phase(Phase::Assemble);
    let mesh = problem.tissue.mesh;
    let points = tissue_points(mesh)?;
    let lattice = Lattice::fit(mesh, &points, spline.degrees, spline.control);
    check_memory(&lattice, problem)?;
    let nothing_held = vec![false; lattice.points.len()];
    let dof_map = DofMap::of(&lattice.connectivity, &lattice.points, &nothing_held);
    let assembly = Assembly::new(&lattice, &dof_map, &problem.tissue, &points);

    // 2. What holds them together, and what holds the tissue.
    let stopped = || ModelError::from(SolverError::Stopped);
    let stiffness = match spline.stiffness {
        Stiffness::Galerkin => assembly.galerkin(progress).ok_or_else(stopped)?,
        Stiffness::Lattice(links) => assembly.links(links),
    };
    let resisted = rotation_resisted(spline, &assembly);
    let assembled = assemble(assembly, stiffness, problem, spline).ok_or_else(stopped)?;

    // 3. Rest.
    progress.phase(Phase::Solve);
    let (control, solver) = assembled.rest(problem, spline, progress)?;
    let mut equilibrium = assembled.equilibrium(problem, &control, solver);
    equilibrium.warnings.extend(resisted);
    equilibrium.warnings.extend(materials_ignored(spline));
    check_finite(std::slice::from_ref(&equilibrium))?;
    Ok(equilibrium)
}

/// Matrix and factor of that many control points, each of which couples with 7^3 - 1 others at most.
fn check_memory(lattice: &Lattice, problem: &Problem) -> Result<(), SolverError> {
    let reach: usize = lattice.orders().iter().map(|order| 2 * order - 1).product();
    let reach = reach.min(lattice.points.len());
    let needed_mb = lattice.points.len() as f64 * reach as f64 / 2.0 * 76.0 / 1e6;
    let allowed_mb = problem.tolerance.memory_mb;
    match needed_mb > allowed_mb {
        true => Err(SolverError::OverBudget { needed_mb, allowed_mb }),
        false => Ok(()),
    }
}

/// Stiffness with the springs of holds, and forces; `None` when cancelled.
fn assemble<'a>(
    assembly: Assembly<'a>,
    stiffness: HalfMatrix<f64, 3>,
    problem: &Problem,
    spline: &VolumeSpline,
) -> Option<Assembled<'a>> {
    let (lattice, mesh) = (assembly.lattice, problem.tissue.mesh);
    let held = HeldPoints::new(&assembly, problem.constraints, &stiffness, spline.hold_weight);
    let springs = match spline.bone {
        Bone::Springs => None,
        Bone::ControlPoints => Some(held.sliding()),
    };
    let springs = springs.as_ref().unwrap_or(&held);
    let mut matrix = springs.stiffness(&assembly)?;
    let blocks = matrix.diagonal.iter_mut().chain(&mut matrix.lower);
    for (sum, block) in blocks.zip(stiffness.diagonal.iter().chain(&stiffness.lower)) {
        for (sum, value) in sum.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
            *sum += value;
        }
    }
    let mut force: Unknowns = vec![[0.0; 3]; lattice.points.len()];
    springs.add_forces(&assembly, &mut force);
    for (node, nodal) in problem.forces.iter().enumerate().filter(|(_, f)| **f != Vector::zeros()) {
        if let Some(place) = lattice.place(&lattice.frame.local(&mesh.nodes[node])) {
            add_at(&assembly, &place, &(lattice.frame.axes.transpose() * nodal), &mut force);
        }
    }
    let bone = match spline.bone {
        Bone::Springs => None,
        Bone::ControlPoints => {
            Some(BonePoints::eliminate(&assembly, problem.constraints, &mut matrix, &mut force))
        }
    };
    let ordering = assembly.dof_map.ordering.clone();
    let positions = assembly.dof_map.by_row(&lattice.points);
    let system = System { ordering, matrix, partly_constrained: Vec::new(), positions };
    Some(Assembled { assembly, held, bone, system, force })
}

impl Assembled<'_> {
    /// Displacements of control points at rest, and how they were found.
    fn rest(
        &self,
        problem: &Problem,
        spline: &VolumeSpline,
        progress: &dyn Progress,
    ) -> Result<(Vec<Vector>, SolveReport), ModelError> {
        let clock = spline.clock.as_ref().filter(|_| self.bone.is_none());
        let Some(clock) = clock else {
            let solution = self.static_solution(problem, progress)?;
            let by_row = solution.unknowns.iter().map(|d| Vector::from(*d)).collect();
            return Ok((self.by_control(by_row), solution.report));
        };
        let mass = match spline.stiffness {
            Stiffness::Galerkin => {
                let mass = self.assembly.mass(progress);
                mass.ok_or(SolverError::Stopped)?
            }
            Stiffness::Lattice(_) => self.assembly.equal_masses(),
        };
        let motion = Motion {
            stiffness: &self.system,
            mass: &mass,
            damping: spline.damping,
            force: &self.force,
        };
        let wanted = problem.tolerance.relative_residual;
        let state = motion.run(clock, wanted, problem.tolerance.memory_mb, progress)?;
        let solver = self.report(clock, &state, wanted)?;
        Ok((self.by_control(state.displacement()), solver))
    }

    /// K d = f, by a factorisation where that takes seconds: functions that overlap this much make rows of
    /// some hundred blocks, which iterations pass over again and again.
    fn static_solution(
        &self,
        problem: &Problem,
        progress: &dyn Progress,
    ) -> Result<Solution, SolverError> {
        let (forces, tolerance) = (std::slice::from_ref(&self.force), &problem.tolerance);
        let ordering = ordering::minimum_degree(&self.system);
        let fits = ordering.factor_mb + self.system.megabytes() <= tolerance.memory_mb;
        let nothing_acts = self.force.iter().flatten().all(|value| *value == 0.0);
        if nothing_acts || !fits || ordering.multiplications > FACTORISED {
            return Ok(solver::solve(&self.system, forces, tolerance, progress)?.remove(0));
        }
        let mut solved =
            cholesky::solve(&self.system, &ordering, forces, tolerance, progress)?.remove(0);
        solved.report.why =
            format!("{:.1e} multiplications make the factor", ordering.multiplications);
        Ok(solved)
    }

    fn by_control(&self, by_row: Vec<Vector>) -> Vec<Vector> {
        let places = self.assembly.dof_map.ordering.place.iter();
        places.map(|&row| by_row[row as usize]).collect()
    }

    /// Motion that is not at rest at the end of its time has not converged.
    fn report(
        &self,
        clock: &Clock,
        state: &State,
        wanted: f64,
    ) -> Result<SolveReport, SolverError> {
        let steps = state.history.len();
        let mut product: Vec<Lanes<f64, 3, 1>> = vec![[[0.0]; 3]; self.force.len()];
        self.system.multiply(&state.displacement, &mut product);
        let (mut left, mut whole) = (0.0, 0.0);
        for (f, k) in self.force.iter().zip(&product) {
            for c in 0..3 {
                left += (f[c] - k[c][0]).powi(2);
                whole += f[c] * f[c];
            }
        }
        let relative_residual = if whole > 0.0 { (left / whole).sqrt() } else { 0.0 };
        if !state.at_rest {
            let (residual, history) = (state.history[steps - 1], state.history.clone());
            return Err(SolverError::NotConverged { iterations: steps, residual, wanted, history });
        }
        Ok(SolveReport {
            method: clock.scheme.name(),
            preconditioner: "none",
            why: format!("steps of {} s until at rest", clock.step / 1e3),
            unknowns: self.system.free_unknowns(),
            iterations: steps,
            relative_residual,
            wanted_residual: wanted,
            history: state.history.clone(),
            steps: steps as u32,
            newton: None,
        })
    }

    fn equilibrium(
        &self,
        problem: &Problem,
        control: &[Vector],
        solver: SolveReport,
    ) -> Equilibrium {
        let (lattice, mesh) = (self.assembly.lattice, problem.tissue.mesh);
        let moved = |(x, is_in_cell): (&Vector, bool)| {
            if !is_in_cell {
                return Vector::zeros();
            }
            let place = lattice.place(&lattice.frame.local(x));
            let along = place.map(|place| lattice.displacement(&place, control));
            along.map_or(Vector::zeros(), |along| lattice.frame.axes * along)
        };
        let missed = self.held.missed(lattice, control);
        let mut reactions = self.held.reactions(lattice, &missed);
        if let Some(bone) = &self.bone {
            let places = &self.assembly.dof_map.ordering.place;
            let mut of_row = vec![Vector::zeros(); control.len()];
            places.iter().zip(control).for_each(|(&row, d)| of_row[row as usize] = *d);
            let of_bone = bone.reactions(&of_row);
            for (reaction, own) in reactions.iter_mut().zip(of_bone) {
                *reaction = own.map_or(*reaction, |own| lattice.frame.axes * own);
            }
        }
        Equilibrium {
            displacement: mesh.nodes.iter().zip(mesh.is_in_cell()).map(moved).collect(),
            reactions,
            solver,
            warnings: held_points::warning(&missed).into_iter().collect(),
            states: Default::default(),
        }
    }
}

/// What a lattice of links holds against the most resisted rotation by one degree.
fn rotation_resisted(spline: &VolumeSpline, assembly: &Assembly) -> Option<Warning> {
    let Stiffness::Lattice(links) = spline.stiffness else { return None };
    let angle = 1.0_f64.to_radians();
    let (linked, points) = (assembly.linked(), &assembly.lattice.points);
    let stretched = |axis: usize| {
        let link = |[a, b]: &[u32; 2]| {
            let along = points[*b as usize] - points[*a as usize];
            along.norm_squared() - along[axis] * along[axis]
        };
        0.5 * links * angle * angle * linked.iter().map(link).sum::<f64>()
    };
    let energy = (0..3).map(stretched).fold(0.0, f64::max);
    let detail = format!(
        "links resist rotation: turning the whole tissue by 1 degree takes {energy:.3e} mN mm, and should take \
         none"
    );
    Some(Warning::new("rotation-resisted", detail).with("energy_mn_mm", energy))
}

fn materials_ignored(spline: &VolumeSpline) -> Option<Warning> {
    let Stiffness::Lattice(links) = spline.stiffness else { return None };
    let detail = "links know no materials: only the density of the tissue is used";
    let warning = Warning::new("materials-ignored", detail).with("stiffness_n_per_m", links);
    Some(warning)
}
