//! Control points of bone: K_ff C_f = -K_fb C_b, as Ulusoy et al. 2010 move theirs.
//!
//! A control point that is the nearest one to nodes that are held altogether is bone, and moves by the mean of what they
//! are held at; a node as near to several belongs to all of them in equal parts, since rounding would choose one. The others follow. Nodes that slide are still held by springs along their normal. What bone does to the
//! tissue is told at the nodes, those of a control point alike: r_b = K_bf C_f + K_bb C_b - f_b.

use std::collections::BTreeMap;

use super::stiffness::Assembly;
use crate::boundary::Constraint;
use crate::mesh::Vector;
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::{Block, Unknowns};

/// Control points are as near to a node as the nearest where their squared distances differ by less than this share of that of
/// the farthest of its span: coordinates of files in single precision differ by a third of it.
const AS_NEAR: f64 = 1e-6;

/// The control points that are bone, by their rows.
pub(super) struct BonePoints {
    points: BTreeMap<usize, BonePoint>,
    /// For each hold within tissue the rows of its control points; none where it slides.
    of_hold: Vec<Vec<usize>>,
    /// Before what is bone was taken out.
    matrix: HalfMatrix<f64, 3>,
    force: Unknowns,
}

#[derive(Clone, Copy, Default)]
struct BonePoint {
    displacement: Vector,
    /// Nodes, of those of several points their part.
    nodes: f64,
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
            .filter_map(|constraint| Some((constraint, nearest_rows(assembly, constraint)?)));
        let (constraints, of_hold): (Vec<&Constraint>, Vec<Vec<usize>>) = rows.unzip();
        let mut points: BTreeMap<usize, BonePoint> = BTreeMap::new();
        for (constraint, rows) in constraints.iter().zip(&of_hold) {
            let along = constraint.axes() * constraint.values();
            let along = assembly.lattice.frame.axes.transpose() * along;
            let part = 1.0 / rows.len().max(1) as f64;
            for &row in rows {
                let point = points.entry(row).or_default();
                point.displacement += along * part;
                point.nodes += part;
            }
        }
        points.values_mut().for_each(|point| point.displacement /= point.nodes);
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
        let share = |rows: &Vec<usize>| {
            let of_node = |row: &usize| sums[row] / (self.points[row].nodes * rows.len() as f64);
            (!rows.is_empty()).then(|| rows.iter().map(of_node).sum())
        };
        self.of_hold.iter().map(share).collect()
    }
}

/// The rows of the control points that are nearest to a held node, none where the node slides; `None` beside all tissue.
fn nearest_rows(assembly: &Assembly, constraint: &Constraint) -> Option<Vec<usize>> {
    let lattice = assembly.lattice;
    let local = lattice.frame.local(&assembly.tissue.mesh.nodes[constraint.node as usize]);
    let place = lattice.place(&local)?;
    if constraint.count() < 3 {
        return Some(Vec::new());
    }
    let distance = |control: u32| (lattice.points[control as usize] - local).norm_squared();
    let members = || lattice.connectivity.row(place.span).iter().copied();
    let least = members().map(distance).fold(f64::INFINITY, f64::min);
    let most = members().map(distance).fold(0.0, f64::max);
    let nearest = members().filter(|&control| distance(control) - least <= AS_NEAR * most);
    Some(nearest.map(|control| assembly.dof_map.row(control)).collect())
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
