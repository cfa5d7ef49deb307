//! Inner modes of hexahedra and wedges: what a cell by itself can do beside its corners, so that it bends without shear.
//!
//! A mode is quadratic along one set of parallel edges and constant across: the sum of their functions (`edge_functions`), on a
//! hexahedron 1 - x², 1 - y², 1 - z², on a wedge 4 L_i L_j and 1 - z². Neighbours do not share modes; their gradients count
//! without their mean over the cell, so that even stress does nothing on them. Each edge function by itself bends a cell
//! against the stretch of all that is beside it; the modes of a cell bend it at the resistance of bending alone.
//!
//! With mean dilatation modes resist the change of volume that is linear in the cell too: the moments
//!   m_k = int y_k div u dV,   y_k linear, int y_k dV = 0, int y_k y_l dV = delta_kl,
//! of which the mean knows nothing, each with the bulk modulus.
//!
//! The answer's own matrix knows neither modes nor moments, and what it makes of their forces is too large where modes and moments
//! resist more than the corners by themselves: the step e is scaled by the share that leaves least energy,
//!   e . K e / e . K_i e,   K_i = K + moments - K_ca K_aa^-1 K_ac.
//!
//! Source: Wilson, Taylor, Doherty, Ghaboussi, Incompatible displacement models, Numerical and Computer Methods in Structural
//! Mechanics, 1973; without means: Taylor, Beresford, Wilson, A non-conforming element for stress analysis, International
//! Journal for Numerical Methods in Engineering 10, 1976. Here they are a term of an estimate, not of the answer.

use nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen};

use super::edge_functions::MAX_EDGES;
use crate::mesh::{CellShape, Vector};

/// The most modes a cell has.
pub(in crate::model::fem) const MAX_MODES: usize = 4;
const UNKNOWNS: usize = 3 * MAX_MODES;

/// A vector of each mode: its coefficients in mm, or its gradients.
pub(in crate::model::fem) type Modes = [Vector; MAX_MODES];
pub(in crate::model::fem) const NO_MODES: Modes = [Vector::new(0.0, 0.0, 0.0); MAX_MODES];

/// The edges whose functions make a mode.
fn parallel_edges(shape: CellShape) -> &'static [&'static [usize]] {
    match shape {
        CellShape::Tet4 => &[],
        CellShape::Hex8 => &[&[0, 2, 4, 6], &[1, 3, 5, 7], &[8, 9, 10, 11]],
        CellShape::Wedge6 => &[&[0, 3], &[1, 4], &[2, 5], &[6, 7, 8]],
    }
}

/// What modes are of the functions of edges: sums of their gradients at a point.
pub(in crate::model::fem) fn sums_of_edges(shape: CellShape, edges: &[Vector; MAX_EDGES]) -> Modes {
    let mut modes = NO_MODES;
    for (mode, parallel) in modes.iter_mut().zip(parallel_edges(shape)) {
        *mode = parallel.iter().map(|&edge| edges[edge]).sum();
    }
    modes
}

/// The gradients of modes at the points of a cell without their mean, from those sums and the volume of each point in mm³.
pub(in crate::model::fem) fn mode_gradients(
    points: impl Iterator<Item = (Modes, f64)>,
) -> Vec<Modes> {
    let all: Vec<(Modes, f64)> = points.collect();
    let volume: f64 = all.iter().map(|(_, volume)| volume).sum();
    let mean: Modes = std::array::from_fn(|mode| {
        all.iter().map(|(modes, v)| modes[mode] * *v).sum::<Vector>() / volume
    });
    let without_mean = |(modes, _): &(Modes, f64)| std::array::from_fn(|k| modes[k] - mean[k]);
    all.iter().map(without_mean).collect()
}

/// y_k dV of each point of a cell, from positions of the points in mm and the volumes in mm³ that they stand for.
pub(in crate::model::fem) fn moment_weights(
    positions: &[Vector],
    volumes: &[f64],
) -> Vec<[f64; 3]> {
    let volume: f64 = volumes.iter().sum();
    let pairs = || positions.iter().zip(volumes);
    let centre = pairs().map(|(x, v)| x * *v).sum::<Vector>() / volume;
    let spread: Matrix3<f64> =
        pairs().map(|(x, v)| (x - centre) * (x - centre).transpose() * *v).sum();
    // Points that lie in a plane have none across it.
    let Some(factor) = spread.cholesky() else { return vec![[0.0; 3]; positions.len()] };
    let lower = factor.l();
    pairs()
        .map(|(x, v)| {
            let y = lower.solve_lower_triangular(&(x - centre)).unwrap_or_default();
            [y.x * v, y.y * v, y.z * v]
        })
        .collect()
}

/// K a = f of the modes of one cell.
pub(in crate::model::fem) struct ModeEquations {
    count: usize,
    matrix: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    right: SVector<f64, UNKNOWNS>,
}

impl ModeEquations {
    pub fn new(shape: CellShape) -> Self {
        let count = parallel_edges(shape).len();
        let mut matrix = SMatrix::zeros();
        (3 * count..UNKNOWNS).for_each(|unused| matrix[(unused, unused)] = 2.0);
        ModeEquations { count, matrix, right: SVector::zeros() }
    }

    /// Pairs of modes, each once: the matrix is symmetric and only what is on its diagonal and below is read.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        (0..self.count).flat_map(|a| (0..=a).map(move |b| (a, b)))
    }

    pub fn modes(&self) -> std::ops::Range<usize> {
        0..self.count
    }

    pub fn add_block(&mut self, (a, b): (usize, usize), block: &Matrix3<f64>) {
        let mut place = self.matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b);
        place += block;
    }

    pub fn add_force(&mut self, mode: usize, force: &Vector) {
        let mut place = self.right.fixed_rows_mut::<3>(3 * mode);
        place += force;
    }

    /// The work of the forces on coefficients of the modes.
    pub fn work(&self, coefficients: &Modes) -> f64 {
        self.modes().map(|mode| self.right.fixed_rows::<3>(3 * mode).dot(&coefficients[mode])).sum()
    }

    /// The coefficients of the modes.
    pub fn solve(&self) -> Modes {
        // Elastic tensors are positive definite: where rounding hides that, a cell has no modes.
        self.matrix.cholesky().map_or(NO_MODES, |factor| vectors(&factor.solve(&self.right)))
    }

    /// The coefficients of the modes, none softer than its own of `least`.
    pub fn solve_above(&self, least: &[f64; MAX_MODES]) -> Modes {
        let scale = SVector::<f64, UNKNOWNS>::from_fn(|unknown, _| match least[unknown / 3] {
            0.0 => 1.0,
            least => 1.0 / least.sqrt(),
        });
        let scaled = self.matrix.component_mul(&(scale * scale.transpose()));
        let right = self.right.component_mul(&scale);
        let is_stiff = (scaled - SMatrix::identity()).cholesky().is_some();
        let solved = match scaled.cholesky().filter(|_| is_stiff) {
            Some(factor) => factor.solve(&right),
            None => {
                let mut eigen = SymmetricEigen::new(scaled);
                eigen.eigenvalues.iter_mut().for_each(|value| *value = value.max(1.0));
                let along = eigen.eigenvectors.transpose() * right;
                eigen.eigenvectors * along.component_div(&eigen.eigenvalues)
            }
        };
        vectors(&solved.component_mul(&scale))
    }
}

fn vectors(unknowns: &SVector<f64, UNKNOWNS>) -> Modes {
    std::array::from_fn(|mode| unknowns.fixed_rows::<3>(3 * mode).into_owned())
}

#[cfg(test)]
mod tests {
    use super::super::points::EnrichedCell;
    use super::*;
    use crate::material::LinearElastic;
    use crate::mesh::sample::block;
    use crate::model::fem::cell_stiffness::Dilatation;

    const SIZE: Vector = Vector::new(2.0, 1.0, 1.0);

    /// A cell whose corners move by a field about its middle, and what the modes change of its energy.
    fn stiffening(shape: CellShape, dilatation: Dilatation, field: fn(Vector) -> Vector) -> f64 {
        let material = LinearElastic::new(15.0, 0.3, 1.0).unwrap();
        let mesh = block(SIZE, [1, 1, 1], shape);
        let of_cell = |cell: usize| {
            let tensor = material.tensor(&Vector::zeros());
            let enriched = EnrichedCell::new(&mesh, cell, &tensor, dilatation).unwrap();
            let moved: Vec<Vector> = mesh.corners(cell).map(|x| field(x - SIZE * 0.5)).collect();
            enriched.stiffening(&moved)
        };
        (0..mesh.cells.len()).map(of_cell).sum()
    }

    #[test]
    fn even_strain_asks_for_no_mode() {
        for shape in [CellShape::Hex8, CellShape::Wedge6] {
            for dilatation in [Dilatation::Pointwise, Dilatation::Mean] {
                let field = |x: Vector| Vector::new(x.x + 0.3 * x.z, 0.2 * x.x, x.y - x.z);
                assert!(stiffening(shape, dilatation, field).abs() < 1e-12, "{shape:?}");
            }
        }
    }

    #[test]
    fn a_bent_cell_has_the_energy_of_a_bent_plate() {
        // u_x = x z: E/(1 - nu²) z² in place of (lambda + 2 mu) z² + mu x², nothing moving along y; over 2 x 1 x 1
        // int z² dV = 1/6, int x² dV = 2/3.
        let (young, nu) = (15.0, 0.3);
        let mu = young / (2.0 * (1.0 + nu));
        let lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
        let field = |x: Vector| Vector::new(x.x * x.z, 0.0, 0.0);
        let plate = young / (1.0 - nu * nu) / 6.0;
        let expected = plate - ((lambda + 2.0 * mu) / 6.0 + mu * 2.0 / 3.0);
        let found = stiffening(CellShape::Hex8, Dilatation::Pointwise, field);
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        // With mean dilatation bulk resists at the moments what it does at the points.
        let bulk = lambda + 2.0 / 3.0 * mu;
        let corners = (lambda + 2.0 * mu - bulk) / 6.0 + mu * 2.0 / 3.0;
        let found = stiffening(CellShape::Hex8, Dilatation::Mean, field);
        assert!((found - (plate - corners)).abs() < 1e-12, "{found} {corners}");
    }
}
