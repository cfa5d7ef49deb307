//! Control points of bone: K_ff C_f = -K_fb C_b, as Ulusoy et al. 2010 move theirs.
//!
//! A control point that is the nearest one to nodes that are held altogether is bone, and moves by the mean of what they
//! are held at; the others follow. Nodes that slide are still held by springs along their normal. What bone does to the
//! tissue is told at the nodes, those of a control point alike: r_b = K_bf C_f + K_bb C_b - f_b.

use std::collections::BTreeMap;

use super::stiffness::Assembly;
use crate::boundary::Constraint;
use crate::mesh::Vector;
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::{Block, Unknowns};

/// The control points that are bone, by their rows.
pub(super) struct BonePoints {
    points: BTreeMap<usize, BonePoint>,
    /// For each hold within tissue the row of its control point; none where it slides.
    of_hold: Vec<Option<usize>>,
    /// Before what is bone was taken out.
    matrix: HalfMatrix<f64, 3>,
    force: Unknowns,
}

#[derive(Clone, Copy, Default)]
struct BonePoint {
    displacement: Vector,
    nodes: usize,
}

impl BonePoints {
    /// Eliminates the control points of bone from a system: their displacements become boundary conditions.
    pub fn eliminate(
        assembly: &Assembly,
        constraints: &[Constraint],
        matrix: &mut HalfMatrix<f64, 3>,
        force: &mut Unknowns,
    ) -> BonePoints {
        let rows = constraints
            .iter()
            .filter_map(|constraint| Some((constraint, nearest_row(assembly, constraint)?)));
        let (constraints, of_hold): (Vec<&Constraint>, Vec<Option<usize>>) = rows.unzip();
        let mut points: BTreeMap<usize, BonePoint> = BTreeMap::new();
        for (constraint, row) in constraints.iter().zip(&of_hold) {
            let Some(row) = row else { continue };
            let point = points.entry(*row).or_default();
            let along = constraint.axes() * constraint.values();
            point.displacement += assembly.lattice.frame.axes.transpose() * along;
            point.nodes += 1;
        }
        points.values_mut().for_each(|point| point.displacement /= point.nodes as f64);
        let bone = BonePoints { points, of_hold, matrix: matrix.clone(), force: force.clone() };
        bone.prescribe(matrix, force);
        bone
    }

    fn prescribe(&self, matrix: &mut HalfMatrix<f64, 3>, force: &mut Unknowns) {
        let pattern = matrix.pattern.clone();
        for row in 0..pattern.rows() {
            for (at, &column) in pattern.range(row).zip(pattern.columns(row)) {
                let column = column as usize;
                let (below, beside) = (self.points.get(&row), self.points.get(&column));
                let block = matrix.lower[at];
                if let Some(point) = beside {
                    subtract(&mut force[row], &block, &point.displacement);
                }
                if let Some(point) = below {
                    subtract(&mut force[column], &transposed(&block), &point.displacement);
                }
                if below.is_some() || beside.is_some() {
                    matrix.lower[at] = [[0.0; 3]; 3];
                }
            }
        }
        for (&row, point) in &self.points {
            let block = &mut matrix.diagonal[row];
            let own = block[0][0].max(block[1][1]).max(block[2][2]);
            *block = [[own, 0.0, 0.0], [0.0, own, 0.0], [0.0, 0.0, own]];
            force[row] = (point.displacement * own).into();
        }
    }

    /// The forces of the holds on the tissue in mN along the axes of the frame, from the displacements of control points
    /// by row; none of a hold that slides.
    pub fn reactions(&self, of_row: &[Vector]) -> Vec<Option<Vector>> {
        let mut sums: BTreeMap<usize, Vector> = BTreeMap::new();
        for &row in self.points.keys() {
            let own = times(&self.matrix.diagonal[row], &of_row[row]);
            sums.insert(row, own - Vector::from(self.force[row]));
        }
        for row in 0..self.matrix.rows() {
            for (column, block) in self.matrix.lower_row(row) {
                if let Some(sum) = sums.get_mut(&row) {
                    *sum += times(block, &of_row[column]);
                }
                if let Some(sum) = sums.get_mut(&column) {
                    *sum += times(&transposed(block), &of_row[row]);
                }
            }
        }
        let share = |row: usize| sums[&row] / self.points[&row].nodes as f64;
        self.of_hold.iter().map(|row| row.map(share)).collect()
    }
}

/// The row of the control point that is nearest to a held node, none where the node slides; `None` beside all tissue.
fn nearest_row(assembly: &Assembly, constraint: &Constraint) -> Option<Option<usize>> {
    let lattice = assembly.lattice;
    let local = lattice.frame.local(&assembly.tissue.mesh.nodes[constraint.node as usize]);
    let place = lattice.place(&local)?;
    let distance = |control: &u32| (lattice.points[*control as usize] - local).norm_squared();
    let members = lattice.connectivity.row(place.span).iter().copied();
    let nearest = members.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    Some((constraint.count() == 3).then(|| assembly.dof_map.row(nearest)))
}

fn times(block: &Block, x: &Vector) -> Vector {
    Vector::from_fn(|r, _| (0..3).map(|c| block[r][c] * x[c]).sum())
}

fn transposed(block: &Block) -> Block {
    std::array::from_fn(|r| std::array::from_fn(|c| block[c][r]))
}

fn subtract(force: &mut [f64; 3], block: &Block, x: &Vector) {
    let product = times(block, x);
    (0..3).for_each(|k| force[k] -= product[k]);
}
