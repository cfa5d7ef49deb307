//! Second-order columns of a response: an approximate solution for every pair of columns, and samples of the third
//! order.
//!
//! U_kk = -K0^-1 N2(c_k, c_k) and U_kl = -2 K0^-1 N2(c_k, c_l), k < l, with N2 of `model::fem::force_series`, the matrix and
//! the hierarchy of the columns themselves, and nothing moved where it is held: what a hold states is linear in the numbers
//! of its segment. Where tissue slides it keeps the normals that it has at rest.

use super::quadratic_form::{QuadraticForm, pairs, quantised};
use super::rigid_numbers::SAMPLES;
use super::superposition::COLUMNS_PER_SEGMENT;
use crate::mesh::Vector;
use crate::model::fem::force_series::{ForceSeries, Forces, LinearState};
use crate::model::fem::linear_system::{Correction, LinearSystem, Residual, Solved};
use crate::model::problem::ModelError;
use crate::prediction::Skin;
use crate::progress::Progress;
use crate::solver::SolverError;

/// Relative residual of the columns of second and third order (docs/estimates.md has what looser ones leave).
const LOOSE: f64 = 1e-2;

/// Relative residual of what is only sampled of the second order.
const SAMPLED: f64 = 0.1;

/// Pairs that are solved for together.
const TOGETHER: usize = 8;

/// The columns of a response as they were solved, and what they were solved with.
pub(super) struct Solutions<'a> {
    pub series: ForceSeries<'a>,
    pub system: &'a LinearSystem<'a>,
    /// Those of the segments.
    pub columns: &'a [Solved],
    pub skin: &'a Skin,
}

/// A displacement and its pressures; empty where it is nothing.
#[derive(Clone, Default)]
pub(super) struct State {
    displacement: Vec<Vector>,
    pressures: Vec<f64>,
}

impl State {
    pub(super) fn add(&mut self, other: &LinearState, factor: f64) {
        let LinearState { displacement, pressures } = other;
        self.displacement.resize(displacement.len(), Vector::zeros());
        self.pressures.resize(pressures.len(), 0.0);
        self.displacement.iter_mut().zip(*displacement).for_each(|(u, v)| *u += v * factor);
        self.pressures.iter_mut().zip(*pressures).for_each(|(p, q)| *p += q * factor);
    }

    pub(super) fn as_moved(&self) -> LinearState<'_> {
        LinearState { displacement: &self.displacement, pressures: &self.pressures }
    }
}

impl From<Correction> for State {
    fn from(correction: Correction) -> Self {
        State { displacement: correction.displacement, pressures: correction.pressures }
    }
}

/// What resists some forces, as a residual.
fn resisting(forces: Forces, factor: f64) -> Residual {
    Residual {
        forces: forces.nodes.into_iter().map(|force| force * -factor).collect(),
        volumes: forces.volumes.into_iter().map(|volume| volume * -factor).collect(),
    }
}

impl Solutions<'_> {
    /// The columns of all pairs, and the samples of each segment; each solution is passed on.
    pub fn quadratic_form(
        &self,
        pass: &mut dyn FnMut([usize; 2], &State),
        progress: &dyn Progress,
    ) -> Result<QuadraticForm, ModelError> {
        let numbers = self.columns.len();
        let all: Vec<[usize; 2]> = pairs(numbers).collect();
        let (mut values, mut scales) = (Vec::new(), Vec::new());
        for (done, some) in all.chunks(TOGETHER).enumerate() {
            progress.step(done * TOGETHER, all.len());
            for (pair, state) in some.iter().zip(self.columns_of(some, progress)?) {
                pass(*pair, &state);
                let (column, scale) = quantised(&self.at_skin(&state.displacement));
                values.extend(column);
                scales.push(scale);
            }
        }
        let segments = 0..numbers / COLUMNS_PER_SEGMENT;
        let third = segments.map(|segment| self.third_of(segment, progress));
        let third = third.collect::<Result<_, ModelError>>()?;
        Ok(QuadraticForm { numbers, values, scales, third, coupling: Vec::new() })
    }

    /// U of some pairs.
    fn columns_of(
        &self,
        some: &[[usize; 2]],
        progress: &dyn Progress,
    ) -> Result<Vec<State>, ModelError> {
        let mut used: Vec<usize> = some.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let place = |column: usize| used.partition_point(|&other| other < column);
        let column = |&column: &usize| self.column(column);
        let states: Vec<LinearState> = used.iter().map(column).collect();
        let places: Vec<[usize; 2]> = some.iter().map(|pair| pair.map(place)).collect();
        let forces = self.series.second(&states, &places)?;
        let twice = some.iter().map(|[k, l]| if k == l { 1.0 } else { 2.0 });
        let residuals = forces.into_iter().zip(twice);
        let residuals = residuals.map(|(forces, factor)| resisting(forces, factor)).collect();
        self.solved(residuals, LOOSE, progress)
    }

    fn column(&self, column: usize) -> LinearState<'_> {
        let Solved { equilibrium, pressures } = &self.columns[column];
        LinearState { displacement: &equilibrium.displacement, pressures }
    }

    fn at_skin(&self, displacement: &[Vector]) -> Vec<Vector> {
        self.skin.nodes().iter().map(|&node| displacement[node as usize]).collect()
    }

    pub(super) fn solved(
        &self,
        residuals: Vec<Residual>,
        relative_residual: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<State>, ModelError> {
        if progress.is_cancelled() {
            return Err(SolverError::Stopped.into());
        }
        let solved = self.system.solve_for(&residuals, relative_residual, progress)?;
        Ok(solved.into_iter().map(State::from).collect())
    }

    /// The mean length of u3 on the skin that moves for a unit of each sampled direction of a segment.
    fn third_of(
        &self,
        segment: usize,
        progress: &dyn Progress,
    ) -> Result<[f64; SAMPLES], ModelError> {
        let first = self.samples(segment);
        let second = self.squares(&first, LOOSE, progress)?;
        let both = first.iter().zip(&second);
        let forces = both.map(|(u, v)| self.series.third(u.as_moved(), v.as_moved()));
        let residuals: Result<Vec<Residual>, ModelError> =
            forces.map(|forces| Ok(resisting(forces?, 1.0))).collect();
        Ok(self.mean_lengths(&first, &self.solved(residuals?, LOOSE, progress)?))
    }

    /// For each segment the mean length of u2 on the skin that moves for a unit of each sampled direction.
    pub fn second_of_each(
        &self,
        progress: &dyn Progress,
    ) -> Result<Vec<[f64; SAMPLES]>, ModelError> {
        let segments = 0..self.columns.len() / COLUMNS_PER_SEGMENT;
        let of = |segment: usize| {
            let first = self.samples(segment);
            let second = self.squares(&first, SAMPLED, progress)?;
            Ok(self.mean_lengths(&first, &second))
        };
        segments.map(of).collect()
    }

    pub(super) fn samples(&self, segment: usize) -> Vec<State> {
        (0..SAMPLES).map(|direction| self.sampled(segment, direction)).collect()
    }

    /// u2 of each of the sampled directions.
    fn squares(
        &self,
        first: &[State],
        relative_residual: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<State>, ModelError> {
        let states: Vec<LinearState> = first.iter().map(State::as_moved).collect();
        let squares: [[usize; 2]; SAMPLES] = std::array::from_fn(|direction| [direction; 2]);
        let forces = self.series.second(&states, &squares)?.into_iter();
        let residuals = forces.map(|forces| resisting(forces, 1.0)).collect();
        self.solved(residuals, relative_residual, progress)
    }

    /// The mean length of each of some states over the skin that its direction moves.
    fn mean_lengths(&self, directions: &[State], states: &[State]) -> [f64; SAMPLES] {
        std::array::from_fn(|direction| {
            let moving = self.skin.moving_points(&directions[direction].displacement);
            self.skin.mean_length(&moving, &states[direction].displacement)
        })
    }

    /// A unit of translation along an axis, or of rotation about one.
    fn sampled(&self, segment: usize, direction: usize) -> State {
        let mut state = State::default();
        for (factor, column) in terms(SAMPLES * segment + direction) {
            state.add(&self.column(column), factor);
        }
        state
    }
}

/// A sampled direction, of those of all segments, as a sum of columns.
pub(super) fn terms(direction: usize) -> Vec<(f64, usize)> {
    let (axis, first) = (direction % 3, direction / SAMPLES * COLUMNS_PER_SEGMENT);
    let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
    match direction % SAMPLES < 3 {
        true => vec![(1.0, first + 4 * axis + 3)],
        // u = e_axis x (x - centre): the entries (j, i) and (i, j) of R - I.
        false => vec![(1.0, first + 4 * j + i), (-1.0, first + 4 * i + j)],
    }
}
