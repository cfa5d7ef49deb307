//! A hexahedron or wedge at rest at finite strain with functions on its edges, integrated at its points.
//!
//! Its inner modes come first, as in `discretisation_error::points`, at the tangent moduli of its state. Volume is resisted as the mean of J and
//! in the three moments of ln J: moments of J would resist cells too much some points of which are pressed. A cell that is all but
//! collapsed at a point has neither modes nor moments: no linear step says what it would do, and the forces of a few such cells would move
//! a whole face by centimetres.

use nalgebra::Matrix3;

use super::brick_at_rest::PointAtRest;
use super::bricks::BrickAt;
use super::edge_block::{LEAST, stiff_enough};
use crate::element::{MAX_NODES, ReferencePoint};
use crate::material::hyperelastic::point::{Corner, Point};
use crate::mesh::{CellShape, Vector};
use crate::model::fem::discretisation_error::{
    Coefficients, Corners, EdgeEquation, MAX_EDGES, MAX_MODES, ModeEquations, Modes, NO_MODES,
    OfEdges, at_point, gradient_of, mode_gradients, moment_weights, sums_of_edges,
};
use crate::model::reference_cell;

/// The det F of a point below which its cell has no inner modes.
pub const COLLAPSED: f64 = 0.2;

pub(super) struct EnrichedBrick<'a> {
    pub shape: CellShape,
    pub brick: BrickAt<'a>,
    /// The corners at rest, in mm.
    pub corners: Vec<Vector>,
    /// The shear modulus in kPa.
    pub mu: f64,
    /// The pressure in kPa that stands for that of its cell in r, where there is such.
    pub smooth: Option<f64>,
}

impl EnrichedBrick<'_> {
    fn points(&self) -> impl Iterator<Item = (&PointAtRest, &Point, &ReferencePoint)> {
        let reference = &reference_cell(self.shape).points;
        let pairs = self.brick.at_rest.iter().zip(self.brick.points).zip(reference);
        pairs.map(|((at_rest, point), reference)| (at_rest, point, reference))
    }

    /// The gradients at rest of the functions of the edges at a point.
    fn edges_at(&self, at_rest: &PointAtRest, reference: &ReferencePoint) -> [Vector; MAX_EDGES] {
        let mut gradients = [Vector::zeros(); MAX_NODES];
        gradients[..at_rest.gradients.len()].copy_from_slice(&at_rest.gradients);
        let corners = Corners { values: &reference.values, gradients: &gradients };
        at_point(self.shape, &corners).gradients
    }

    /// The inner modes at the state.
    fn inner(&self) -> Inner {
        let reference = &reference_cell(self.shape).points;
        let volumes: Vec<f64> = self.brick.at_rest.iter().map(|at_rest| at_rest.volume).collect();
        let positions: Vec<Vector> = reference.iter().map(|p| p.position(&self.corners)).collect();
        let edges: Vec<_> =
            self.points().map(|(at_rest, _, point)| self.edges_at(at_rest, point)).collect();
        let sums = edges.iter().map(|edges| sums_of_edges(self.shape, edges));
        let mut inner = Inner {
            gradients: mode_gradients(sums.zip(volumes.iter().copied())),
            weights: moment_weights(&positions, &volumes),
            of_volume: [[Vector::zeros(); 3]; MAX_MODES],
            means: [Vector::zeros(); MAX_MODES],
            bulk: self.brick.bulk_modulus,
            of_mean: self.brick.of_mean(),
            edges,
            is_collapsed: self.brick.points.iter().any(|point| point.volume() < COLLAPSED),
        };
        for (place, (at_rest, point, _)) in self.points().enumerate() {
            let (modes, y) = (inner.gradients[place], inner.weights[place]);
            for (mode, g) in modes.iter().enumerate() {
                let corner = point.corner(g);
                let of_log_volume = corner.of_log_volume(point.volume());
                (0..3).for_each(|k| inner.of_volume[mode][k] += of_log_volume * y[k]);
                inner.means[mode] += corner.of_volume() * at_rest.volume;
            }
        }
        inner
    }

    /// The equations of the inner modes at the tangent moduli of the state.
    fn mode_equations(&self, inner: &Inner) -> Softest {
        let mut softest =
            Softest { equations: ModeEquations::new(self.shape), least: [0.0; MAX_MODES] };
        let Softest { equations, least } = &mut softest;
        for ((at_rest, point, _), modes) in self.points().zip(&inner.gradients) {
            let own = modes.map(|g| point.corner(&g));
            for (a, b) in equations.pairs() {
                let block = point.block(&own[a], &own[b]) * at_rest.volume;
                equations.add_block((a, b), &block);
            }
            for mode in equations.modes() {
                least[mode] += LEAST * self.mu * modes[mode].norm_squared() * at_rest.volume;
            }
        }
        for (a, b) in equations.pairs() {
            let pairs = inner.of_volume[a].iter().zip(&inner.of_volume[b]);
            let block: Matrix3<f64> = pairs.map(|(v, w)| v * w.transpose()).sum();
            let of_mean = inner.means[a] * inner.means[b].transpose() * inner.of_mean;
            equations.add_block((a, b), &(block * inner.bulk + of_mean));
        }
        softest
    }

    /// The three moments of ln J.
    fn moments(&self, inner: &Inner) -> [f64; 3] {
        if inner.is_collapsed {
            return [0.0; 3];
        }
        let pairs = self.points().zip(&inner.weights);
        pairs.fold([0.0; 3], |sum, ((_, point, _), y)| {
            std::array::from_fn(|k| sum[k] + point.log_volume() * y[k])
        })
    }

    /// What the inner modes do beside the corners in the state.
    fn modes(&self, inner: &Inner) -> Modes {
        if inner.is_collapsed {
            return NO_MODES;
        }
        let mut softest = self.mode_equations(inner);
        for ((at_rest, point, _), modes) in self.points().zip(&inner.gradients) {
            let stress = point.stress() * at_rest.volume;
            for mode in softest.equations.modes() {
                softest.equations.add_force(mode, &(-(stress * modes[mode])));
            }
        }
        softest.solved(inner, self.moments(inner), 0.0)
    }

    /// v . (K_i - K) v of displaced corners at the tangent moduli, in mN mm: what moments resist, less what modes give way.
    pub fn stiffening(&self, displacement: &[Vector]) -> f64 {
        let inner = self.inner();
        if inner.is_collapsed {
            return 0.0;
        }
        let mut softest = self.mode_equations(&inner);
        let (mut moments, mut mean) = ([0.0; 3], 0.0);
        for (place, (at_rest, point, _)) in self.points().enumerate() {
            let rows = rows(point, &gradient_of(displacement, &at_rest.gradients));
            for mode in softest.equations.modes() {
                let own = point.corner(&inner.gradients[place][mode]);
                let force = force_on(point, &own, &rows) * at_rest.volume;
                softest.equations.add_force(mode, &-force);
            }
            let change: f64 = (0..3).map(|k| rows[k].of_volume()[k]).sum();
            let y = inner.weights[place];
            (0..3).for_each(|k| moments[k] += change / point.volume() * y[k]);
            mean += change * at_rest.volume;
        }
        let coefficients = softest.solved(&inner, moments, mean);
        let resisted: f64 = moments.iter().map(|moment| inner.bulk * moment * moment).sum();
        resisted - softest.equations.work(&coefficients)
    }

    /// Writes r and D of each edge. What the mean of a wedge resists counts with the shear modulus, as in
    /// `discretisation_error::points`.
    pub fn equations(&self, of_edges: &mut OfEdges) {
        let inner = self.inner();
        *of_edges =
            OfEdges { equations: [EdgeEquation::ZERO; MAX_EDGES], modes: self.modes(&inner) };
        let OfEdges { equations, modes } = of_edges;
        let (mut means, mut shears) = ([Vector::zeros(); MAX_EDGES], [0.0; MAX_EDGES]);
        let more = self.smooth.map_or(0.0, |smooth| smooth - self.brick.pressure());
        let resists = self.edges_resist_moments(&inner);
        let changes = match resists {
            true => inner.changes(self.moments(&inner), modes),
            false => [0.0; 3],
        };
        let mut of_moments = [[Vector::zeros(); 3]; MAX_EDGES];
        for (place, (at_rest, point, _)) in self.points().enumerate() {
            let linear = inner.linear(changes, place);
            let (gradients, stress) = (&inner.edges[place], point.stress());
            let rows = rows(point, &gradient_of(modes, &inner.gradients[place]));
            for (edge, equation) in equations[..self.edge_count()].iter_mut().enumerate() {
                let (g, volume) = (&gradients[edge], at_rest.volume);
                let own = point.corner(g);
                equation.residual -= (stress * g + force_on(point, &own, &rows)) * volume;
                equation.stiffness += point.block(&own, &own) * volume;
                let of_volume = own.of_volume() * volume;
                equation.residual -= of_volume * more;
                let of_log_volume = own.of_log_volume(point.volume());
                equation.residual -= of_log_volume * linear;
                let y = inner.weights[place];
                (0..3).for_each(|k| of_moments[edge][k] += of_log_volume * y[k]);
                means[edge] += of_volume;
                shears[edge] += self.mu * volume * g.norm_squared();
            }
        }
        let of_mean = match self.shape {
            CellShape::Wedge6 => self.brick.of_mean().min(self.mu / self.brick.volume()),
            CellShape::Hex8 | CellShape::Tet4 => self.brick.of_mean(),
        };
        for (edge, equation) in equations[..self.edge_count()].iter_mut().enumerate() {
            let mut block = equation.stiffness + means[edge] * means[edge].transpose() * of_mean;
            if resists {
                let moments = of_moments[edge].iter().map(|own| own * own.transpose());
                block += moments.sum::<Matrix3<f64>>() * inner.bulk;
            }
            equation.stiffness = stiff_enough(block, shears[edge]);
        }
    }

    /// The forces on the corners of coefficients of the edges, and of the modes and moments of the state.
    pub fn forces(&self, of: &Coefficients) -> [Vector; MAX_NODES] {
        let mut forces = [Vector::zeros(); MAX_NODES];
        let (mut means, mut change) = ([Vector::zeros(); MAX_NODES], 0.0);
        let inner = self.inner();
        let mut moments = self.moments(&inner);
        if self.edges_resist_moments(&inner) {
            for (place, (_, point, _)) in self.points().enumerate() {
                let rows = rows(point, &gradient_of(&of.edges, &inner.edges[place]));
                let change: f64 = (0..3).map(|k| rows[k].of_log_volume(point.volume())[k]).sum();
                (0..3).for_each(|k| moments[k] += change * inner.weights[place][k]);
            }
        }
        let changes = inner.changes(moments, &of.modes);
        for (place, (at_rest, point, _)) in self.points().enumerate() {
            let volume = at_rest.volume;
            let along = gradient_of(&of.edges, &inner.edges[place])
                + gradient_of(&of.modes, &inner.gradients[place]);
            let rows = rows(point, &along);
            for (k, row) in rows.iter().enumerate() {
                change += row.of_volume()[k] * volume;
            }
            let linear = inner.linear(changes, place);
            for (a, g) in at_rest.gradients.iter().enumerate() {
                let corner = point.corner(g);
                let of_log_volume = corner.of_log_volume(point.volume());
                means[a] += corner.of_volume() * volume;
                forces[a] += force_on(point, &corner, &rows) * volume + of_log_volume * linear;
            }
        }
        let pressure = self.brick.of_mean() * change;
        forces.iter_mut().zip(&means).for_each(|(force, mean)| *force += mean * pressure);
        forces
    }

    /// Whether the moments of ln J count for edges, as in `discretisation_error::points`.
    fn edges_resist_moments(&self, inner: &Inner) -> bool {
        self.shape == CellShape::Hex8 && !inner.is_collapsed
    }

    fn edge_count(&self) -> usize {
        self.shape.edges().len()
    }
}

/// The inner modes of a cell.
struct Inner {
    /// The gradients at rest of the functions of edges at each point, and of modes.
    edges: Vec<[Vector; MAX_EDGES]>,
    gradients: Vec<Modes>,
    /// y_k dV of each point.
    weights: Vec<[f64; 3]>,
    /// d(ln J) of each mode in the three moments, and dJ in the integral over the cell.
    of_volume: [[Vector; 3]; MAX_MODES],
    means: [Vector; MAX_MODES],
    /// What resists the moments in kPa, and the integral.
    bulk: f64,
    of_mean: f64,
    /// Whether its volume is less than `COLLAPSED` of that at rest at a point.
    is_collapsed: bool,
}

impl Inner {
    /// The pressures in kPa of the three moments of volume, those that corners make and those of modes.
    fn changes(&self, moments: [f64; 3], modes: &Modes) -> [f64; 3] {
        std::array::from_fn(|k| {
            let pairs = modes.iter().zip(&self.of_volume);
            self.bulk * (moments[k] + pairs.map(|(a, v)| a.dot(&v[k])).sum::<f64>())
        })
    }

    /// That pressure at a point, times its volume.
    fn linear(&self, changes: [f64; 3], place: usize) -> f64 {
        changes.iter().zip(&self.weights[place]).map(|(change, y)| change * y).sum()
    }
}

/// The equations of inner modes, none of them softer than its least stiffness.
struct Softest {
    equations: ModeEquations,
    least: [f64; MAX_MODES],
}

impl Softest {
    /// The coefficients of the modes where the change of volume has moments and an integral too.
    fn solved(&mut self, inner: &Inner, moments: [f64; 3], mean: f64) -> Modes {
        for mode in self.equations.modes() {
            let pairs = inner.of_volume[mode].iter().zip(moments);
            let of_moments: Vector = pairs.map(|(v, moment)| v * (inner.bulk * moment)).sum();
            let force = of_moments + inner.means[mode] * (inner.of_mean * mean);
            self.equations.add_force(mode, &-force);
        }
        self.equations.solve_above(&self.least)
    }
}

/// H row by row: e_k (x) (H^T e_k).
fn rows(point: &Point, along: &Matrix3<f64>) -> [Corner; 3] {
    std::array::from_fn(|k| point.corner(&along.row(k).transpose()))
}

/// d2W/dF2 : H along a shape function, for each unit of volume.
fn force_on(point: &Point, corner: &Corner, rows: &[Corner; 3]) -> Vector {
    (0..3).map(|k| point.block(corner, &rows[k]).column(k).into_owned()).sum()
}
