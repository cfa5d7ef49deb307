//! Tetrahedra that do not lock: linear displacement and linear pressure, stabilised by projection.
//!
//! With p = lambda div u: find u, p with
//!   int 2 mu eps(u) : eps(v) + int p div v = f(v)                             K u + B^T p = f
//!   int q div u - int p q / lambda - int (p - Pi p)(q - Pi q) / mu = 0        B u - C p = 0
//! where Pi is the mean over a cell. On a tetrahedron of volume V: B_ab = V/4 grad N_b,
//! C = M / lambda + (M - Mbar) / mu, M_ab = V/20 (1 + delta_ab), Mbar_ab = V/16.
//!
//! Source: Dohrmann, Bochev, A stabilized finite element method for the Stokes problem based on polynomial
//! pressure projections, International Journal for Numerical Methods in Fluids 46, 2004; the compressible
//! term M / lambda is that of linear elasticity.
//! A node has one pressure for each material around it, because pressure jumps where stiffness does.
//! Hexahedra and wedges keep their mean dilatation and have no pressure; nor have tetrahedra with nu = 0,
//! whose pressure is zero.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::assembly::{InvertedCell, Tissue, rotate_into_frames};
use super::constrained::Constrained;
use super::linear_fem::{Equilibrium, LinearFemError, LoadCase, Observer, Problem};
use super::reference_cell;
use crate::material::LinearElastic;
use crate::mesh::{CellShape, Vector};
use crate::solver::mixed::{self, Coupling, MixedSystem};
use crate::solver::multigrid::Multigrid;
use crate::solver::sparse_rows::{Couplings, SparseRows};
use crate::solver::{BlockMatrix, LinearSystem, SolverError, Tolerance};

/// Vectors of all unknowns that the iteration keeps at most.
const VECTORS: usize = 2 * mixed::MOST_DIRECTIONS + 6;

/// Solves for each load case; matrices and hierarchy are made once. `Solution::unknowns` has the free
/// displacements and then the pressures in kPa.
pub fn solve_cases(
    problem: &Problem,
    cases: &[LoadCase],
    observer: &dyn Observer,
) -> Result<Vec<Equilibrium>, LinearFemError> {
    observer.assembling();
    let matrices = Matrices::assemble(problem, observer)?;
    observer.solving();
    let nothing = vec![0.0; matrices.held.len()];
    let multigrid = Multigrid::new(&matrices.system(&problem.tissue.mesh.nodes, &nothing));
    let solver = (&multigrid, &problem.tolerance);
    cases.iter().map(|case| matrices.solve(problem, case, solver, observer)).collect()
}

/// What is the same for all load cases; sliding nodes are written in their own frames.
struct Matrices {
    stiffness: BlockMatrix,
    coupling: Coupling,
    held: Vec<bool>,
    axes: BTreeMap<usize, Matrix3<f64>>,
}

impl Matrices {
    fn assemble(problem: &Problem, observer: &dyn Observer) -> Result<Self, LinearFemError> {
        let mesh = problem.tissue.mesh;
        let frames = Constrained { holds: problem.holds, nodes: mesh.nodes.len() };
        let axes = frames.own_axes();
        let assembled = shear_stiffness(&problem.tissue, observer)?;
        let mut stiffness = assembled.ok_or(SolverError::Stopped)?;
        rotate_into_frames(&mut stiffness, problem.holds);
        let coupling = couple(&problem.tissue, &axes)?;
        check_memory(&stiffness, &coupling, problem.tolerance.memory_mb)?;
        let held = frames.held_unknowns(mesh.cells.iter().map(|(_, nodes)| nodes));
        Ok(Matrices { stiffness, coupling, held, axes })
    }

    fn system<'a>(
        &'a self,
        positions: &'a [Vector],
        right_hand_side: &'a [f64],
    ) -> LinearSystem<'a> {
        let Matrices { stiffness: matrix, held, axes, .. } = self;
        LinearSystem { matrix, held, right_hand_side, positions, axes }
    }

    fn solve(
        &self,
        problem: &Problem,
        case: &LoadCase,
        (multigrid, tolerance): (&Multigrid, &Tolerance),
        observer: &dyn Observer,
    ) -> Result<Equilibrium, LinearFemError> {
        // 1. What is known, and what it leaves to the free unknowns.
        let positions = &problem.tissue.mesh.nodes;
        let frames = Constrained { holds: problem.holds, nodes: positions.len() };
        let known = frames.known_displacement(&case.held);
        let acting = frames.acting_forces(&case.forces);
        let (forces, volumes) = self.right_hand_sides(&known, &acting);

        // 2. The free displacements and the pressures.
        let mixed = MixedSystem {
            stiffness: self.system(positions, &forces),
            coupling: &self.coupling,
            volumes: &volumes,
        };
        let watch = |iteration, residual| observer.iterated(iteration, residual);
        let solution = mixed::solve(&mixed, multigrid, tolerance, &watch)?;
        let (free, pressures) = solution.unknowns.split_at(self.held.len());

        // 3. Displacement and reactions, back in the frame of the coordinates.
        let total: Vec<f64> = known.iter().zip(free).map(|(known, free)| known + free).collect();
        let mut internal = vec![0.0; total.len()];
        self.stiffness.multiply(&total, &mut internal);
        self.coupling.gradient.add_expanded(pressures, &mut internal);
        if internal.iter().any(|force| !force.is_finite()) {
            return Err(SolverError::NotFinite.into());
        }
        Ok(Equilibrium {
            displacement: frames.to_coordinates(&total),
            reactions: frames.reactions(&internal, &acting),
            unknowns: self.held.iter().filter(|held| !**held).count() + pressures.len(),
            solution,
        })
    }

    /// f - K u_b over free unknowns, and -B u_b.
    fn right_hand_sides(&self, known: &[f64], acting: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut forces = vec![0.0; known.len()];
        self.stiffness.multiply(known, &mut forces);
        for (index, force) in forces.iter_mut().enumerate() {
            *force = if self.held[index] { 0.0 } else { acting[index] - *force };
        }
        let mut volumes = vec![0.0; self.coupling.mass.len()];
        self.coupling.divergence.contract(known, &mut volumes);
        volumes.iter_mut().for_each(|volume| *volume = -*volume);
        (forces, volumes)
    }
}

fn check_memory(
    stiffness: &BlockMatrix,
    coupling: &Coupling,
    allowed_mb: f64,
) -> Result<(), SolverError> {
    let unknowns = 3 * stiffness.rows() + coupling.mass.len();
    let vectors_mb = 8e-6 * (VECTORS * unknowns) as f64;
    let needed_mb = stiffness.megabytes() + coupling.megabytes() + vectors_mb;
    match needed_mb <= allowed_mb {
        true => Ok(()),
        false => Err(SolverError::OverBudget { needed_mb, allowed_mb }),
    }
}

/// K: tetrahedra with 2 mu eps : eps, which is the elastic law of Young's modulus 2 mu and nu = 0.
fn shear_stiffness(
    tissue: &Tissue,
    observer: &dyn Observer,
) -> Result<Option<BlockMatrix>, InvertedCell> {
    let regions = tissue.materials.len() as u16;
    let shear = tissue.materials.iter().map(LinearElastic::shear_only);
    let materials: Vec<LinearElastic> = tissue.materials.iter().copied().chain(shear).collect();
    let shapes = tissue.mesh.cells.iter().map(|(shape, _)| shape);
    let material_of_cell: Vec<u16> = shapes
        .zip(tissue.material_of_cell)
        .map(|(shape, &region)| if shape == CellShape::Tet4 { region + regions } else { region })
        .collect();
    let tissue = Tissue { materials: &materials, material_of_cell: &material_of_cell, ..*tissue };
    tissue.assemble(&|| !observer.is_stopped())
}

/// Tetrahedra that have pressures, one for each corner.
struct PressureCells {
    cells: Vec<u32>,
    nodes: Vec<[u32; 4]>,
    pressures: Vec<[u32; 4]>,
    pressure_count: usize,
}

impl PressureCells {
    /// Numbers the pressures: corners share one where they share node and material.
    fn new(tissue: &Tissue) -> Self {
        let materials = tissue.materials;
        let same = |material| materials.iter().position(|other| other == material);
        let kinds: Vec<usize> =
            materials.iter().enumerate().map(|(own, m)| same(m).unwrap_or(own)).collect();
        let mut cells_of_kind: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for (cell, (shape, _)) in tissue.mesh.cells.iter().enumerate() {
            let kind = kinds[tissue.material_of_cell[cell] as usize];
            if shape == CellShape::Tet4 && materials[kind].lambda() > 0.0 {
                cells_of_kind.entry(kind).or_default().push(cell as u32);
            }
        }
        let (cells, nodes, pressures) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = PressureCells { cells, nodes, pressures, pressure_count: 0 };
        // Numbers below the first of a kind are those of other kinds.
        let mut number_of_node = vec![0; tissue.mesh.nodes.len()];
        for cells in cells_of_kind.values() {
            let first = all.pressure_count as u32 + 1;
            for &cell in cells {
                let corners = tissue.mesh.cells.nodes(cell as usize);
                let corners: [u32; 4] = std::array::from_fn(|corner| corners[corner]);
                let numbers = corners.map(|node| {
                    let number = &mut number_of_node[node as usize];
                    if *number < first {
                        all.pressure_count += 1;
                        *number = all.pressure_count as u32;
                    }
                    *number - 1
                });
                all.nodes.push(corners);
                all.pressures.push(numbers);
            }
            all.cells.extend_from_slice(cells);
        }
        all
    }
}

/// One tetrahedron: its volume in mm³, grad N in 1/mm along the axes of its nodes, its moduli in kPa.
struct CellTerms {
    volume: f64,
    gradients: [Vector; 4],
    mu: f64,
    lambda: f64,
}

/// B, B^T, C and D.
fn couple(tissue: &Tissue, axes: &BTreeMap<usize, Matrix3<f64>>) -> Result<Coupling, InvertedCell> {
    let all = PressureCells::new(tissue);
    let terms: Result<Vec<CellTerms>, InvertedCell> =
        all.cells.iter().map(|&cell| cell_terms(tissue, cell as usize, axes)).collect();
    let terms = terms?;
    let volume_of = |cell: usize, node: usize| {
        let CellTerms { volume, gradients, .. } = &terms[cell];
        gradients[node] * (volume / 4.0)
    };
    let by_pressure = Couplings { rows: &all.pressures, columns: &all.nodes };
    let by_node = Couplings { rows: &all.nodes, columns: &all.pressures };
    let among_pressures = Couplings { rows: &all.pressures, columns: &all.pressures };
    let compliance = |cell: usize, a: usize, b: usize| {
        let CellTerms { volume, mu, lambda, .. } = terms[cell];
        let mass = volume / 20.0 * if a == b { 2.0 } else { 1.0 };
        mass / lambda + (mass - volume / 16.0) / mu
    };
    let count = all.pressure_count;
    let mut mass = vec![0.0; count];
    for (numbers, cell) in all.pressures.iter().zip(&terms) {
        for &number in numbers {
            mass[number as usize] += cell.volume / 4.0 * (1.0 / cell.mu + 1.0 / cell.lambda);
        }
    }
    let node_count = tissue.mesh.nodes.len();
    Ok(Coupling {
        divergence: SparseRows::assemble(count, &by_pressure, |cell, _, b| volume_of(cell, b)),
        gradient: SparseRows::assemble(node_count, &by_node, |cell, a, _| volume_of(cell, a)),
        compliance: SparseRows::assemble(count, &among_pressures, compliance),
        mass,
    })
}

fn cell_terms(
    tissue: &Tissue,
    cell: usize,
    axes: &BTreeMap<usize, Matrix3<f64>>,
) -> Result<CellTerms, InvertedCell> {
    let mut corners = [Vector::zeros(); 4];
    for (slot, corner) in corners.iter_mut().zip(tissue.mesh.corners(cell)) {
        *slot = corner;
    }
    let point = &reference_cell(CellShape::Tet4).points[0];
    let point = point.at(&corners).ok_or(InvertedCell { cell })?;
    let material = &tissue.materials[tissue.material_of_cell[cell] as usize];
    let nodes = tissue.mesh.cells.nodes(cell);
    let gradients = std::array::from_fn(|corner| match axes.get(&(nodes[corner] as usize)) {
        Some(axes) => axes.transpose() * point.gradients[corner],
        None => point.gradients[corner],
    });
    let (mu, lambda) = (material.shear_modulus(), material.lambda());
    Ok(CellTerms { volume: point.volume, gradients, mu, lambda })
}
