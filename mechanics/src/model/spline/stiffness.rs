//! Stiffness and mass of a volume spline, over control points.
//!
//! Galerkin: K_jk = int lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I dV with g_j = grad N_j (docs/methods.md#volume-spline),
//! and M_jk = int rho N_j N_k dV I, summed over the points of the mesh's cells, so that shape and
//! regions of the tissue count and the box around it does not.
//!
//! A span that holds little tissue leaves its functions next to no stiffness. What the tissue does not say
//! is therefore told to continue smoothly: gamma mu V h^(2p-2) |d^p u / dx^p|^2 is added for each span with
//! tissue, V its volume, h its length along the axis, p the degree. It is zero for every polynomial below
//! degree p, rigid movements and for p above 1 constant strains among them, and vanishes with h faster than the spline's
//! own error; where p is 1 it is added by the share of the span that holds no tissue, so that full spans have none. After the ghost penalty of Burman, Comptes Rendus Mathématique 348 (2010), p. 1217, with
//! the highest derivative itself in place of its jumps.
//!
//! Lattice, as in Ulusoy et al. 2010: links of k_s between neighbouring control points, each component
//! alone, and equal masses that add up to the tissue's. Turning the lattice stretches links as well as
//! moving them apart does: the energy of a rotation by theta is told.

use rayon::prelude::*;

use super::basis::MOST_DEGREE;
use super::lattice::{Lattice, LatticeCoordinates};
use super::tissue_points::TissuePoint;
use crate::mesh::Vector;
use crate::model::dofs::DofMap;
use crate::model::fem::assembly::Tissue;
use crate::model::problem::InvertedCell;
use crate::progress::Progress;
use crate::rows::Rows;
use crate::solver::Block;
use crate::solver::half_matrix::HalfMatrix;

/// gamma. Without it the matrices of curved tissue are singular; between 1e-6 and 1e-4 the skin of the half
/// head and of a real face moves by less than 0.01 mm in the mean, and at 1e-2 the face loses a quarter of
/// the accuracy.
const CONTINUATION: f64 = 1e-4;

/// Spans whose matrices are held side by side: each takes 0.3 MB.
const SPANS_AT_ONCE: usize = 64;

/// Control points that a cubic span couples.
const MOST_MEMBERS: usize = (MOST_DEGREE + 1).pow(3);

/// Points whose contributions share a pass over the moments.
const AT_ONCE: usize = 4;

/// Matrices over control points.
pub struct Assembly<'a> {
    pub lattice: &'a Lattice,
    pub dof_map: &'a DofMap,
    pub tissue: &'a Tissue<'a>,
    /// Of each span, by material.
    points: Rows<Located>,
}

/// A tissue point in the frame of the lattice.
struct Located {
    span: u32,
    material: u16,
    local: Vector,
    volume: f64,
}

/// Gradients of the functions of a span at some points, by component, and the points' volumes.
struct Gradients([[[f64; MOST_MEMBERS]; 3]; AT_ONCE]);

impl<'a> Assembly<'a> {
    pub fn new(
        lattice: &'a Lattice,
        dof_map: &'a DofMap,
        tissue: &'a Tissue<'a>,
        points: &[TissuePoint],
    ) -> Self {
        let locate = |point: &TissuePoint| {
            let local = lattice.frame.local(&point.position);
            let span = lattice.place(&local)?.span as u32;
            let material = tissue.material_of_cell[point.cell as usize];
            Some(Located { span, material, local, volume: point.volume })
        };
        let mut points: Vec<Located> = points.par_iter().filter_map(locate).collect();
        points.sort_by_key(|point| (point.span, point.material));
        let mut lengths = vec![0; lattice.connectivity.len()];
        points.iter().for_each(|point| lengths[point.span as usize] += 1);
        Assembly { lattice, dof_map, tissue, points: Rows::of_lengths(&lengths, points) }
    }

    fn points(&self, span: usize) -> &[Located] {
        self.points.row(span)
    }

    fn place(&self, point: &Located) -> LatticeCoordinates {
        self.lattice.place(&point.local).expect("the point was found in its span before")
    }

    /// K of the tissue in mN/mm; `None` when cancelled.
    pub fn galerkin(&self, progress: &dyn Progress) -> Option<HalfMatrix<f64, 3>> {
        let mean = self.mean_shear_modulus();
        self.sum_over_spans(progress, |span| self.span_stiffness(span, mean))
    }

    /// int rho N N dV in mg.
    pub fn mass(&self, progress: &dyn Progress) -> Option<HalfMatrix<f64, 3>> {
        self.sum_over_spans(progress, |span| {
            let (orders, members) = (self.lattice.orders(), self.lattice.members());
            let mut blocks = vec![[[0.0; 3]; 3]; members * members];
            for point in self.points(span) {
                let density = self.tissue.materials[point.material as usize].density();
                let values: Vec<f64> = self.place(point).products(orders).collect();
                for (j, a) in values.iter().enumerate() {
                    for (k, b) in values.iter().enumerate() {
                        add_to_diagonal(
                            &mut blocks[j * members + k],
                            density * point.volume * a * b,
                        );
                    }
                }
            }
            blocks
        })
    }

    /// Links of that many mN/mm between neighbouring control points.
    pub fn links(&self, stiffness: f64) -> HalfMatrix<f64, 3> {
        let mut matrix = HalfMatrix::zeros(self.dof_map.pattern.clone());
        for link in self.linked() {
            let [a, b] = link.map(|control| self.dof_map.row(control));
            add_to_diagonal(matrix.block_mut(a, a), stiffness);
            add_to_diagonal(matrix.block_mut(b, b), stiffness);
            add_to_diagonal(matrix.block_mut(a.max(b), a.min(b)), -stiffness);
        }
        matrix
    }

    /// Neighbouring control points that some tissue lies between: where it leaves a gap, control points on its two
    /// sides may stand next to each other.
    pub fn linked(&self) -> Vec<[u32; 2]> {
        let mut links = self.lattice.links();
        links.retain(|link| {
            let [a, b] = link.map(|control| self.dof_map.row(control));
            self.dof_map.pattern.couples(a.max(b), a.min(b))
        });
        links
    }

    /// The mass of the tissue in equal shares, in mg.
    pub fn equal_masses(&self) -> HalfMatrix<f64, 3> {
        let mut matrix = HalfMatrix::zeros(self.dof_map.pattern.clone());
        let density = |point: &Located| self.tissue.materials[point.material as usize].density();
        let mass: f64 =
            self.points.entries().iter().map(|point| density(point) * point.volume).sum();
        let share = mass / matrix.rows() as f64;
        matrix.diagonal.iter_mut().for_each(|block| add_to_diagonal(block, share));
        matrix
    }

    /// Sums span matrices in a fixed order.
    pub fn sum_over_spans(
        &self,
        progress: &dyn Progress,
        span_matrix: impl Fn(usize) -> Vec<Block> + Sync,
    ) -> Option<HalfMatrix<f64, 3>> {
        let mut matrix = HalfMatrix::zeros(self.dof_map.pattern.clone());
        let spans: Vec<usize> = (0..self.lattice.connectivity.len()).collect();
        for spans in spans.chunks(SPANS_AT_ONCE) {
            let matrix_of = |span| Ok::<_, InvertedCell>(span_matrix(span));
            let added = self.dof_map.add_cells(&mut matrix, spans, progress, matrix_of);
            if !added.unwrap_or(false) {
                return None;
            }
        }
        Some(matrix)
    }

    fn span_stiffness(&self, span: usize, mean_shear: f64) -> Vec<Block> {
        let (orders, members) = (self.lattice.orders(), self.lattice.members());
        let mut blocks = vec![[[0.0; 3]; 3]; members * members];
        let mut moments = vec![0.0; members * 9 * members];
        let (mut shear, mut volume) = (0.0, 0.0);
        for same in self.points(span).chunk_by(|a, b| a.material == b.material) {
            let material = &self.tissue.materials[same[0].material as usize];
            let (lambda, mu) = (material.lambda(), material.shear_modulus());
            moments.fill(0.0);
            for some in same.chunks(AT_ONCE) {
                let mut volumes = [0.0; AT_ONCE];
                let mut gradients = Gradients([[[0.0; MOST_MEMBERS]; 3]; AT_ONCE]);
                for (at, point) in some.iter().enumerate() {
                    volumes[at] = point.volume;
                    gradients.set(at, &self.place(point), orders);
                    shear += mu * point.volume;
                    volume += point.volume;
                }
                gradients.add_moments(&volumes, members, &mut moments);
            }
            add_stiffness(&moments, [lambda, mu], members, &mut blocks);
        }
        let shear = if volume > 0.0 { shear / volume } else { mean_shear };
        self.add_smoothness_penalty(span, [CONTINUATION * shear, volume], &mut blocks);
        blocks
    }

    /// Adds the penalty on the highest derivatives.
    fn add_smoothness_penalty(
        &self,
        span: usize,
        [modulus, tissue]: [f64; 2],
        blocks: &mut [Block],
    ) {
        let bases = &self.lattice.bases;
        let (orders, place) = (self.lattice.orders(), self.lattice.span(span));
        let members = self.lattice.members();
        let volume: f64 = bases.iter().map(|basis| basis.spacing()).product();
        for (axis, basis) in bases.iter().enumerate() {
            let order = orders[axis];
            let degree = order as i32 - 1;
            let derivatives = basis.highest_derivatives(place[axis] as usize);
            // A constant strain is the highest derivative of degree 1: only where tissue is missing.
            let share = if degree > 1 { 1.0 } else { (1.0 - tissue / volume).clamp(0.0, 1.0) };
            let lines = (members / order) as f64;
            let weight = share * modulus * volume * basis.spacing().powi(2 * degree - 2) / lines;
            let stride: usize = orders[..axis].iter().product();
            for first in (0..members).filter(|at| (at / stride).is_multiple_of(order)) {
                for (j, a) in derivatives[..order].iter().enumerate() {
                    for (k, b) in derivatives[..order].iter().enumerate() {
                        let entry = (first + j * stride) * members + first + k * stride;
                        add_to_diagonal(&mut blocks[entry], weight * a * b);
                    }
                }
            }
        }
    }

    fn mean_shear_modulus(&self) -> f64 {
        let volume: f64 = self.points.entries().iter().map(|point| point.volume).sum();
        let shear =
            |point: &Located| self.tissue.materials[point.material as usize].shear_modulus();
        self.points.entries().iter().map(|point| shear(point) * point.volume).sum::<f64>() / volume
    }
}

impl Gradients {
    fn set(&mut self, at: usize, place: &LatticeCoordinates, orders: [usize; 3]) {
        for (member, gradient) in place.gradients(orders).enumerate() {
            for axis in 0..3 {
                self.0[at][axis][member] = gradient[axis];
            }
        }
    }

    /// moments[j][a][b][k] += sum V g_ja g_kb for k up to j.
    fn add_moments(&self, volumes: &[f64; AT_ONCE], members: usize, moments: &mut [f64]) {
        let [p, q, r, s] = &self.0;
        for (j, of_member) in moments.chunks_exact_mut(9 * members).enumerate() {
            for (entry, row) in of_member.chunks_exact_mut(members).enumerate() {
                let (a, b) = (entry / 3, entry % 3);
                let scaled: [f64; AT_ONCE] = std::array::from_fn(|n| volumes[n] * self.0[n][a][j]);
                let lines = p[b].iter().zip(&q[b]).zip(r[b].iter().zip(&s[b]));
                for (sum, ((p, q), (r, s))) in row[..=j].iter_mut().zip(lines) {
                    *sum += scaled[0] * p + scaled[1] * q + scaled[2] * r + scaled[3] * s;
                }
            }
        }
    }
}

/// Blocks from moments m_ab = sum V g_ja g_kb: lambda m + mu m^T + mu tr m I, and their transposes.
fn add_stiffness(moments: &[f64], [lambda, mu]: [f64; 2], members: usize, blocks: &mut [Block]) {
    for j in 0..members {
        for k in 0..=j {
            let moment = |a: usize, b: usize| moments[(9 * j + 3 * a + b) * members + k];
            let trace = moment(0, 0) + moment(1, 1) + moment(2, 2);
            let value = |a: usize, b: usize| {
                let on_diagonal = if a == b { mu * trace } else { 0.0 };
                lambda * moment(a, b) + mu * moment(b, a) + on_diagonal
            };
            let block: Block = std::array::from_fn(|a| std::array::from_fn(|b| value(a, b)));
            add_block(&mut blocks[j * members + k], &block);
            if k < j {
                let transposed = std::array::from_fn(|a| std::array::from_fn(|b| block[b][a]));
                add_block(&mut blocks[k * members + j], &transposed);
            }
        }
    }
}

fn add_block(sum: &mut Block, block: &Block) {
    for (sum, value) in sum.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
        *sum += value;
    }
}

pub(super) fn add_to_diagonal(block: &mut Block, value: f64) {
    (0..3).for_each(|k| block[k][k] += value);
}
