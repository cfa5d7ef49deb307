//! Holds and forces as what is known of a linear system: along the axes of the holds, by row, and back.

use super::problem::LoadCase;
use crate::boundary::Hold;
use crate::mesh::Vector;
use crate::model::fem::assembly::{Numbering, partly_held, turn_into_axes};
use crate::solver::cliques::Cliques;
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::lanes::Lanes;
use crate::solver::{SolverError, System, Unknowns};

/// Numbered nodes of which some are held, each along the first axes of a frame of its own.
pub struct Constrained<'a> {
    pub holds: &'a [Hold],
    pub numbering: &'a Numbering,
}

/// What a load case states, by row, along the axes of the rows.
pub struct Known {
    /// Zero where free.
    pub displacement: Vec<Lanes<f64, 3, 1>>,
    pub force: Unknowns,
}

/// The numbering of nodes at positions. Nodes held in all directions have no free unknown, nor have nodes
/// of no cell, which nothing couples.
pub fn number(cells: &Cliques, positions: &[Vector], holds: &[Hold]) -> Numbering {
    let mut held = vec![true; positions.len()];
    for cell in 0..cells.len() {
        cells.members(cell).iter().for_each(|&node| held[node as usize] = false);
    }
    let whole = holds.iter().filter(|hold| hold.count() == 3);
    whole.for_each(|hold| held[hold.node as usize] = true);
    Numbering::of(cells, positions, &held)
}

impl Constrained<'_> {
    /// The system of a matrix, with partly held rows along their own axes. Positions are those of the nodes.
    pub fn system(&self, mut matrix: HalfMatrix<f64, 3>, positions: &[Vector]) -> System {
        let partly_held = partly_held(self.holds, self.numbering);
        turn_into_axes(&mut matrix, &partly_held);
        let positions = self.numbering.by_row(positions);
        System { layout: self.numbering.layout.clone(), matrix, partly_held, positions }
    }

    /// The values of holds and forces of a load case.
    pub fn known(&self, case: &LoadCase) -> Known {
        let rows = self.numbering.layout.place.len();
        let mut known = Known { displacement: vec![[[0.0]; 3]; rows], force: vec![[0.0; 3]; rows] };
        for (force, &row) in case.forces.iter().zip(&self.numbering.layout.place) {
            known.force[row as usize] = (*force).into();
        }
        for (hold, values) in self.holds.iter().zip(&case.held) {
            let row = self.numbering.row(hold.node);
            known.displacement[row] =
                std::array::from_fn(|k| [if k < hold.count() { values[k] } else { 0.0 }]);
            if !hold.is_aligned() {
                let own = hold.axes().transpose() * Vector::from(known.force[row]);
                known.force[row] = own.into();
            }
        }
        known
    }

    /// Nodal vectors along the axes of the coordinates.
    pub fn displacement(&self, total: &[Lanes<f64, 3, 1>]) -> Vec<Vector> {
        let places = self.numbering.layout.place.iter();
        let mut displacement: Vec<Vector> =
            places.map(|&row| Vector::from(total[row as usize].map(|[value]| value))).collect();
        for hold in self.holds.iter().filter(|hold| !hold.is_aligned()) {
            let own = displacement[hold.node as usize];
            displacement[hold.node as usize] = hold.axes() * own;
        }
        displacement
    }

    /// What each hold exerts: the internal force less the acting one along its held axes, along the axes
    /// of the coordinates.
    pub fn reactions(&self, internal: &[Lanes<f64, 3, 1>], force: &Unknowns) -> Vec<Vector> {
        let reaction = |hold: &Hold| {
            let row = self.numbering.row(hold.node);
            let own = Vector::from_fn(|k, _| match k < hold.count() {
                true => internal[row][k][0] - force[row][k],
                false => 0.0,
            });
            hold.axes() * own
        };
        self.holds.iter().map(reaction).collect()
    }

    /// A row of the solver is a node of the mesh.
    pub fn in_nodes(&self, error: SolverError) -> SolverError {
        match error {
            SolverError::NotPositiveDefinite { row } => {
                let place = |place: &u32| *place as usize == row;
                let node = self.numbering.layout.place.iter().position(place);
                SolverError::NotPositiveDefinite { row: node.unwrap_or(row) }
            }
            other => other,
        }
    }
}

impl Known {
    /// f - K u_b of the free unknowns, zero for held ones.
    pub fn right_hand_side(&self, system: &System) -> Unknowns {
        let product = product_at_holds(system, &self.displacement);
        let mut result: Unknowns = self.force[..system.layout.free].to_vec();
        for (value, [x, y, z]) in result.iter_mut().zip(&product) {
            *value = [value[0] - x[0], value[1] - y[0], value[2] - z[0]];
        }
        for partly in &system.partly_held {
            for (value, _) in result[partly.row].iter_mut().zip(partly.held).filter(|(_, h)| *h) {
                *value = 0.0;
            }
        }
        result
    }

    /// What is known and what was solved for.
    pub fn total(&self, solved: &Unknowns) -> Vec<Lanes<f64, 3, 1>> {
        let mut total = self.displacement.clone();
        for (total, solved) in total.iter_mut().zip(solved) {
            total.iter_mut().zip(solved).for_each(|(total, solved)| total[0] += solved);
        }
        total
    }
}

/// K x where it is of use: in the rows of held nodes, and what held nodes do to free ones. Partly held
/// nodes lie among the free ones, and with them every row counts.
pub fn product_at_holds(system: &System, x: &[Lanes<f64, 3, 1>]) -> Vec<Lanes<f64, 3, 1>> {
    let mut product = vec![[[0.0]; 3]; x.len()];
    let first = if system.partly_held.is_empty() { system.layout.free } else { 0 };
    system.matrix.add_rows(first..x.len(), x, &mut product);
    product
}

/// Unknowns of the displacement that are not held.
pub fn free_unknowns(system: &System) -> usize {
    let held = system.partly_held.iter().flat_map(|row| row.held).filter(|held| *held).count();
    3 * system.layout.free - held
}
