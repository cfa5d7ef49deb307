//! Taylor coefficients of the internal forces of linear finite elements at finite strain, about rest.
//!
//! Along a displacement u the internal forces are f(u) = K0 u + N2(u, u) + N3(u, u, u) + ..., with K0 the matrix of the
//! linear elements to the last bit of their formulation: at each point the stress series of neo-Hookean tissue with fibres
//! (`material::stress_series`), with the tension that the element has:
//!   plain cells          lambda ln J
//!   mean dilatation      -2/3 mu ln J + J K ln(Jm) / Jm, Jm = 1/V sum_q V_q J     what is a mean at first order is one at every order
//!   stabilised pressure  (lambda - lambda') ln J + p, and a volume V/4 ln J - (C p)_a for each corner
//! (`cell_stiffness`, `displacement_pressure`). A law that is stated adds what sets it apart from neo-Hookean tissue
//! (`material::law_series`). The membrane has its plane stiffness of Green's strain.
//! The term of a solution that follows from them is u2 = -K0^-1 N2(u1, u1) with nothing moved where it is held, and
//! u3 = -K0^-1 [2 N2(u1, u2) + N3(u1, u1, u1)] (docs/estimates.md#nonlinearity). Where tissue slides it keeps the normals
//! that it has at rest, to every order.
//!
//! Growth and muscles (`inner_stress`; at finite strain `finite_strain::inner`) grow with s along the path s u1 + s^2 u2 + ...:
//! with F_e = F / (1 + s e) and the forces V (1 + s e)^2 [P(F_e) + F_e s S] g of a cell, and with
//!   G1 = H1 - e I,  G2 = H2 - e G1
//! the gradients of F_e by order, the second and the third order of the forces have beside those of G
//!   e C:G1 + (G1 + 2 e) S,
//!   e C:G2 + e^2 C:G1 + 2 e N2(G1, G1) + (G2 + 2 e G1 + e^2) S,
//! where a pressure of an order of its own makes e (C:G + p) of e C:G and -e V/4 tr G of a volume. The weight (1 + s e)^3 of the
//! equations of pressures is left out: it counts where tissue that shares a pressure grows unequally.

mod cell;

use rayon::prelude::*;

use super::assembly::Tissue;
use super::displacement_pressure::PressureCells;
use super::inner_stress::InnerStress;
use crate::mesh::Vector;
use crate::model::problem::InvertedCell;
pub use cell::LinearState;
use cell::{Cell, CellStrains, CellTerms};

/// Cells whose forces are computed side by side before they are added in cell order, which keeps the bits independent of
/// the number of threads.
const CHUNK: usize = 4096;

/// Forces in mN for each node and volumes in mm^3 for each pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct Forces {
    pub nodes: Vec<Vector>,
    pub volumes: Vec<f64>,
}

/// The strains of a cell in some states.
type Strained<'a> = dyn Fn(&[LinearState]) -> CellStrains + 'a;

/// The tissue, and for each cell the numbers of the pressures of its corners; empty where no cell has any.
pub struct ForceSeries<'a> {
    pub tissue: Tissue<'a>,
    pub pressures_of_cell: Vec<Option<[u32; 4]>>,
    pub pressure_count: usize,
    /// Growth and muscle stress along the path.
    pub inner: InnerStress,
}

impl<'a> ForceSeries<'a> {
    /// That of tissue as a linear system sees it, whose tetrahedra may have pressures.
    pub fn new(tissue: Tissue<'a>, pressures: Option<&PressureCells>) -> Self {
        let mut series = ForceSeries {
            tissue,
            pressures_of_cell: Vec::new(),
            pressure_count: 0,
            inner: InnerStress::default(),
        };
        if let Some(pressures) = pressures {
            series.pressure_count = pressures.pressure_count;
            series.pressures_of_cell = vec![None; series.tissue.mesh.cells.len()];
            for (&cell, &numbers) in pressures.cells.iter().zip(&pressures.pressures) {
                series.pressures_of_cell[cell as usize] = Some(numbers);
            }
        }
        series
    }

    /// That of tissue of which some grows, and muscles pull.
    pub fn with_inner(self, inner: &InnerStress) -> Self {
        ForceSeries { inner: inner.clone(), ..self }
    }

    /// The second order along s u1: N2(u1, u1), with what grows and pulls.
    pub fn second_along(&self, first: LinearState) -> Result<Forces, InvertedCell> {
        let of_cell = |cell: &Cell, strained: &Strained| {
            let strained = strained(&[first]);
            let mut terms = cell.second(&strained, [0, 0]);
            cell.second_order_of_inner(&strained, &mut terms);
            vec![terms]
        };
        let mut sum = self.sum(1, &of_cell)?.remove(0);
        if let Some(membrane) = self.tissue.membrane {
            let pair = [first.displacement; 2];
            membrane.add_second_order(self.tissue.mesh, pair, 1.0, &mut sum.nodes);
        }
        Ok(sum)
    }

    /// N2(u, v), bilinear and symmetric, for pairs of states, of tissue in which nothing grows or pulls.
    pub fn second(
        &self,
        states: &[LinearState],
        pairs: &[[usize; 2]],
    ) -> Result<Vec<Forces>, InvertedCell> {
        let of_cell = |cell: &Cell, strained: &Strained| {
            let strained = strained(states);
            pairs.iter().map(|&pair| cell.second(&strained, pair)).collect()
        };
        let mut sums = self.sum(pairs.len(), &of_cell)?;
        if let Some(membrane) = self.tissue.membrane {
            for (sum, pair) in sums.iter_mut().zip(pairs) {
                let pair = pair.map(|state| states[state].displacement);
                membrane.add_second_order(self.tissue.mesh, pair, 1.0, &mut sum.nodes);
            }
        }
        Ok(sums)
    }

    /// The third order along s u1 + s^2 u2: 2 N2(u1, u2) + N3(u1, u1, u1).
    pub fn third(&self, first: LinearState, second: LinearState) -> Result<Forces, InvertedCell> {
        Ok(self.third_of_each(&[[first, second]])?.remove(0))
    }

    /// The same along each of some paths.
    pub fn third_of_each(&self, paths: &[[LinearState; 2]]) -> Result<Vec<Forces>, InvertedCell> {
        let of_cell = |cell: &Cell, strained: &Strained| {
            let third = |path: &[LinearState; 2]| {
                let strained = strained(path);
                let (mut all, cross) = (cell.third(&strained), cell.second(&strained, [0, 1]));
                all.add(&cross, 2.0);
                cell.third_order_of_inner(&strained, &mut all);
                all
            };
            paths.iter().map(third).collect()
        };
        let mut sums = self.sum(paths.len(), &of_cell)?;
        if let Some(membrane) = self.tissue.membrane {
            for (sum, path) in sums.iter_mut().zip(paths) {
                let pair = path.each_ref().map(|state| state.displacement);
                membrane.add_second_order(self.tissue.mesh, pair, 2.0, &mut sum.nodes);
                membrane.add_third_order(self.tissue.mesh, pair[0], &mut sum.nodes);
            }
        }
        Ok(sums)
    }

    fn sum(
        &self,
        count: usize,
        of_cell: &(dyn Fn(&Cell, &Strained) -> Vec<CellTerms> + Sync),
    ) -> Result<Vec<Forces>, InvertedCell> {
        let mesh = self.tissue.mesh;
        let nothing = Forces {
            nodes: vec![Vector::zeros(); mesh.nodes.len()],
            volumes: vec![0.0; self.pressure_count],
        };
        let mut sums = vec![nothing; count];
        let terms = |cell: usize| {
            let pressures = self.pressures(cell);
            let built = Cell::new(&self.tissue, &self.inner, cell, pressures.is_some())?;
            let nodes = mesh.cells.nodes(cell);
            let strained =
                |states: &[LinearState]| built.strained(nodes, pressures.as_ref(), states);
            Ok((pressures, of_cell(&built, &strained)))
        };
        for first in (0..mesh.cells.len()).step_by(CHUNK) {
            let last = (first + CHUNK).min(mesh.cells.len());
            let chunk: Vec<_> =
                (first..last).into_par_iter().map(terms).collect::<Result<_, InvertedCell>>()?;
            for (cell, (pressures, terms)) in (first..last).zip(chunk) {
                for (sum, term) in sums.iter_mut().zip(&terms) {
                    sum.add(mesh.cells.nodes(cell), pressures.as_ref(), term);
                }
            }
        }
        Ok(sums)
    }

    fn pressures(&self, cell: usize) -> Option<[u32; 4]> {
        self.pressures_of_cell.get(cell).copied().flatten()
    }
}

impl Forces {
    fn add(&mut self, nodes: &[u32], pressures: Option<&[u32; 4]>, term: &CellTerms) {
        for (&node, force) in nodes.iter().zip(&term.forces) {
            self.nodes[node as usize] += force;
        }
        for &pressure in pressures.into_iter().flatten() {
            self.volumes[pressure as usize] += term.volume;
        }
    }
}
