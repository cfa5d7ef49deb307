//! Force series of one cell: its quadrature points at rest, the strains of displacement states, and the second and
//! third order of its forces.

use nalgebra::Matrix3;

use crate::element::{MAX_NODES, PhysicalPoint};
use crate::material::ElasticTensor;
use crate::material::law_series::LawSeries;
use crate::material::stress_series::{
    Stretch, second_green_stress, second_log_volume, second_stress, second_volume,
    third_green_stress, third_log_volume, third_stress,
};
use crate::mesh::Vector;
use crate::model::fem::assembly::Tissue;
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::fem::inner_stress::InnerStress;
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// What a solution of the linear elements holds: a displacement in mm for each node, a pressure in kPa for each unknown
/// that is one.
#[derive(Clone, Copy, Debug)]
pub struct LinearState<'a> {
    pub displacement: &'a [Vector],
    pub pressures: &'a [f64],
}

/// A cell at rest, and the parts of its stiffness.
pub(super) struct Cell {
    points: Vec<PhysicalPoint>,
    count: usize,
    volume: f64,
    /// What counts at each point.
    at_points: CellModuli,
    /// What counts with the mean volume change of the cell, where there is such a part.
    of_mean: Option<CellModuli>,
    /// Means of the gradients of the shape functions, where they are used.
    mean_gradients: [Vector; MAX_NODES],
    /// Terms of the stated law at each point.
    law: Option<LawSeries>,
    /// eps_g, and S in kPa where a muscle pulls.
    growth: f64,
    pull: Option<Matrix3<f64>>,
}

/// lambda and mu in kPa, and what fibres add to them.
struct CellModuli {
    lambda: f64,
    mu: f64,
    fibres: Option<ElasticTensor>,
}

/// Gradients and tensions of each state at each point, the mean gradient and the pressure of each state. Where tissue grows
/// they are those of F_e, and the states the orders of one path.
pub(super) struct CellStrains {
    points: usize,
    at: Vec<Stretch>,
    means: Vec<Matrix3<f64>>,
    pressures: Vec<f64>,
}

/// Forces of the corners in mN, and the volume in mm^3 that each of four pressures has.
#[derive(Clone, Debug)]
pub(super) struct CellTerms {
    pub forces: [Vector; MAX_NODES],
    pub volume: f64,
}

/// An order of ln J and of J at the points of a cell, and their means.
#[derive(Default)]
struct Volumes {
    logs: [f64; MAX_NODES],
    log_mean: f64,
    at: [f64; MAX_NODES],
    mean: f64,
}

impl From<ElasticTensor> for CellModuli {
    fn from(tensor: ElasticTensor) -> Self {
        let ElasticTensor { lambda, mu, fibre } = tensor;
        let fibres = fibre.map(|_| ElasticTensor { lambda: 0.0, mu: 0.0, fibre });
        CellModuli { lambda, mu, fibres }
    }
}

impl CellStrains {
    fn of(&self, state: usize) -> &[Stretch] {
        &self.at[state * self.points..(state + 1) * self.points]
    }
}

impl CellTerms {
    fn nothing() -> Self {
        CellTerms { forces: [Vector::zeros(); MAX_NODES], volume: 0.0 }
    }

    pub fn add(&mut self, other: &CellTerms, factor: f64) {
        for (force, more) in self.forces.iter_mut().zip(&other.forces) {
            *force += more * factor;
        }
        self.volume += other.volume * factor;
    }

    /// The forces of a stress times a volume between gradients of shape functions.
    fn add_stress(&mut self, stress: &Matrix3<f64>, gradients: &[Vector]) {
        for (force, gradient) in self.forces.iter_mut().zip(gradients) {
            *force += stress * gradient;
        }
    }
}

impl Cell {
    /// `has_pressures` of a tetrahedron whose pressure is an unknown of its own.
    pub fn new(
        tissue: &Tissue,
        inner: &InnerStress,
        cell: usize,
        has_pressures: bool,
    ) -> Result<Self, InvertedCell> {
        let shape = tissue.mesh.cells.shape(cell);
        let corners: Vec<Vector> = tissue.mesh.corners(cell).collect();
        let points = reference_cell(shape).points.iter().map(|point| point.at(&corners));
        let points: Vec<PhysicalPoint> =
            points.collect::<Option<_>>().ok_or(InvertedCell { cell })?;
        let mut tensor = tissue.tensor(cell);
        if has_pressures {
            tensor.lambda -= tensor.pressure_part().lambda;
        }
        let (at_points, of_mean) = match (tissue.dilatation)(shape) {
            Dilatation::Pointwise => (tensor, None),
            Dilatation::Mean => {
                let (of_shape, of_volume) = tensor.split_volume();
                (of_shape, Some(of_volume.into()))
            }
        };
        let volume: f64 = points.iter().map(|point| point.volume).sum();
        let mean = |a: usize| -> Vector {
            points.iter().map(|point| point.gradients[a] * (point.volume / volume)).sum()
        };
        let mean_gradients = match &of_mean {
            Some(_) => std::array::from_fn(mean),
            None => [Vector::zeros(); MAX_NODES],
        };
        let count = corners.len();
        let material = &tissue.materials[usize::from(tissue.material_of_cell[cell])];
        let law = material.stated_law().and_then(LawSeries::of);
        let at_points = at_points.into();
        let (growth, pull) = (inner.strain(cell), inner.pulls(cell).copied());
        Ok(Cell { count, volume, at_points, of_mean, mean_gradients, points, law, growth, pull })
    }

    pub fn strained(
        &self,
        nodes: &[u32],
        pressures: Option<&[u32; 4]>,
        states: &[LinearState],
    ) -> CellStrains {
        let mut strained = CellStrains {
            points: self.points.len(),
            at: Vec::new(),
            means: Vec::new(),
            pressures: Vec::new(),
        };
        for (order, state) in states.iter().enumerate() {
            let of = |gradients: &[Vector]| -> Matrix3<f64> {
                let nodes = nodes.iter().zip(gradients);
                nodes.map(|(&node, g)| state.displacement[node as usize] * g.transpose()).sum()
            };
            let mut mean =
                self.of_mean.as_ref().map_or(Matrix3::zeros(), |_| of(&self.mean_gradients));
            let before = order.checked_sub(1);
            if let (true, Some(_)) = (self.growth != 0.0, &self.of_mean) {
                mean -= self.grown(before.map(|before| &strained.means[before]));
            }
            let numbers = pressures.into_iter().flatten();
            let pressure =
                numbers.map(|&number| state.pressures[number as usize]).sum::<f64>() / 4.0;
            let everywhere = pressure + self.mean_lambda() * mean.trace();
            strained.means.push(mean);
            strained.pressures.push(pressure);
            for (q, point) in self.points.iter().enumerate() {
                let mut gradient = of(&point.gradients[..self.count]);
                if self.growth != 0.0 {
                    let before = before.map(|before| &strained.of(before)[q].gradient);
                    gradient -= self.grown(before);
                }
                let tension = everywhere + self.at_points.lambda * gradient.trace();
                strained.at.push(Stretch { gradient, tension });
            }
        }
        strained
    }

    /// What growth takes from a gradient, by that of the order before: F_e = F / (1 + s e) along s.
    fn grown(&self, before: Option<&Matrix3<f64>>) -> Matrix3<f64> {
        before.copied().unwrap_or_else(Matrix3::identity) * self.growth
    }

    fn mean_lambda(&self) -> f64 {
        self.of_mean.as_ref().map_or(0.0, |parts| parts.lambda)
    }

    /// Of an order of ln J and of J at each point.
    fn volumes(&self, of: impl Fn(usize) -> [f64; 2]) -> Volumes {
        let mut volumes = Volumes::default();
        for (place, point) in self.points.iter().enumerate() {
            let [log, at] = of(place);
            (volumes.logs[place], volumes.at[place]) = (log, at);
            volumes.log_mean += log * point.volume / self.volume;
            volumes.mean += at * point.volume / self.volume;
        }
        volumes
    }

    /// tau2 of a pair of states at each point in kPa: of the mean the second order of K J ln(Jm) / Jm.
    fn second_tensions(
        &self,
        strained: &CellStrains,
        pair: [usize; 2],
    ) -> ([f64; MAX_NODES], Volumes) {
        let [a, b] = pair.map(|state| strained.of(state));
        let second = self.volumes(|q| {
            let (g, h) = (&a[q].gradient, &b[q].gradient);
            [second_log_volume(g, h), second_volume(g, h)]
        });
        let [m, n] = pair.map(|state| strained.means[state].trace());
        let mean = second.mean - 1.5 * m * n;
        let tension = |q: usize| {
            let first = 0.5 * (m * b[q].gradient.trace() + n * a[q].gradient.trace());
            self.at_points.lambda * second.logs[q] + self.mean_lambda() * (mean + first)
        };
        (self.at_each(tension), second)
    }

    /// tau3 of the first state at each point in kPa.
    fn third_tensions(
        &self,
        strained: &CellStrains,
        second: &Volumes,
    ) -> ([f64; MAX_NODES], Volumes) {
        let a = strained.of(0);
        let third =
            self.volumes(|q| [third_log_volume(&a[q].gradient), a[q].gradient.determinant()]);
        let m = strained.means[0].trace();
        let of_second = second.mean - 1.5 * m * m;
        let mean = third.mean - 3.0 * m * second.mean + 11.0 / 6.0 * m * m * m;
        let tension = |q: usize| {
            let more = of_second * a[q].gradient.trace() + m * second.at[q];
            self.at_points.lambda * third.logs[q] + self.mean_lambda() * (mean + more)
        };
        (self.at_each(tension), third)
    }

    fn at_each(&self, of: impl Fn(usize) -> f64) -> [f64; MAX_NODES] {
        std::array::from_fn(|q| if q < self.points.len() { of(q) } else { 0.0 })
    }

    /// N2 of a pair of states.
    pub fn second(&self, strained: &CellStrains, pair: [usize; 2]) -> CellTerms {
        let [a, b] = pair.map(|state| strained.of(state));
        let (tensions, volumes) = self.second_tensions(strained, pair);
        let volume = self.volume / 4.0 * volumes.log_mean;
        let mut terms = CellTerms { volume, ..CellTerms::nothing() };
        for (q, point) in self.points.iter().enumerate() {
            let mut stress = second_stress(self.at_points.mu, [&a[q], &b[q]], tensions[q]);
            if let Some(fibres) = &self.at_points.fibres {
                stress += second_green_stress(fibres, &a[q].gradient, &b[q].gradient);
            }
            if let Some(law) = &self.law {
                stress += law.second(&a[q].gradient, &b[q].gradient);
            }
            terms.add_stress(&(stress * point.volume), &point.gradients[..self.count]);
        }
        if let Some(fibres) = self.of_mean.as_ref().and_then(|parts| parts.fibres.as_ref()) {
            let [a, b] = pair.map(|state| &strained.means[state]);
            let stress = second_green_stress(fibres, a, b) * self.volume;
            terms.add_stress(&stress, &self.mean_gradients[..self.count]);
        }
        terms
    }

    /// C : G of a state at a point, in kPa, with the tension that it has.
    fn first_stress(&self, at: &Stretch) -> Matrix3<f64> {
        let Stretch { gradient, tension } = at;
        let strain = (gradient + gradient.transpose()) * 0.5;
        let stress = strain * (2.0 * self.at_points.mu) + Matrix3::from_diagonal_element(*tension);
        match &self.at_points.fibres {
            Some(fibres) => stress + fibres.stress(&strain),
            None => stress,
        }
    }

    /// Adds to the forces of an order along a path what growth adds beside the gradients of F_e, as multiples of
    /// C : G of the states; `super` has the derivation.
    fn add_growth(&self, strained: &CellStrains, of_states: &[f64], terms: &mut CellTerms) {
        let growth = self.growth;
        for (state, factor) in of_states.iter().enumerate() {
            for (point, at) in self.points.iter().zip(strained.of(state)) {
                let stress = self.first_stress(at) * (factor * point.volume);
                terms.add_stress(&stress, &point.gradients[..self.count]);
            }
            if let Some(fibres) = self.of_mean.as_ref().and_then(|parts| parts.fibres.as_ref()) {
                let mean = &strained.means[state];
                let stress = fibres.stress(&((mean + mean.transpose()) * 0.5));
                let stress = stress * (factor * self.volume);
                terms.add_stress(&stress, &self.mean_gradients[..self.count]);
            }
        }
        // What the pressure of the order itself answers to.
        let last = of_states.len() - 1;
        let pressed = Matrix3::from_diagonal_element(growth * strained.pressures[last]);
        for (point, at) in self.points.iter().zip(strained.of(last)) {
            terms.add_stress(&(pressed * point.volume), &point.gradients[..self.count]);
            terms.volume -= growth / 4.0 * point.volume * at.gradient.trace();
        }
    }

    /// Adds the forces of (1 + s e)^2 (1 + H_e) s S, of the order that `stress` has.
    fn add_pull(&self, stress: impl Fn(usize) -> Matrix3<f64>, terms: &mut CellTerms) {
        for (q, point) in self.points.iter().enumerate() {
            terms.add_stress(&(stress(q) * point.volume), &point.gradients[..self.count]);
        }
    }

    /// Contribution of growth and muscles to the second order along a path.
    pub fn second_order_of_inner(&self, strained: &CellStrains, terms: &mut CellTerms) {
        if self.growth != 0.0 {
            self.add_growth(strained, &[self.growth], terms);
        }
        if let Some(pull) = &self.pull {
            let twice = Matrix3::from_diagonal_element(2.0 * self.growth);
            self.add_pull(|q| (strained.of(0)[q].gradient + twice) * pull, terms);
        }
    }

    /// Their contribution to the third order.
    pub fn third_order_of_inner(&self, strained: &CellStrains, terms: &mut CellTerms) {
        let growth = self.growth;
        if growth != 0.0 {
            self.add_growth(strained, &[growth * growth, growth], terms);
            let volume = terms.volume;
            terms.add(&self.second(strained, [0, 0]), 2.0 * growth);
            terms.volume = volume;
        }
        if let Some(pull) = &self.pull {
            let stress = |q: usize| {
                let [first, second] = [0, 1].map(|order| strained.of(order)[q].gradient);
                let square = Matrix3::from_diagonal_element(growth * growth);
                (second + first * (2.0 * growth) + square) * pull
            };
            self.add_pull(stress, terms);
        }
    }

    /// N3 of the first state.
    pub fn third(&self, strained: &CellStrains) -> CellTerms {
        let a = strained.of(0);
        let (seconds, second) = self.second_tensions(strained, [0, 0]);
        let (thirds, third) = self.third_tensions(strained, &second);
        let volume = self.volume / 4.0 * third.log_mean;
        let mut terms = CellTerms { volume, ..CellTerms::nothing() };
        for (q, point) in self.points.iter().enumerate() {
            let mut stress = third_stress(self.at_points.mu, &a[q], seconds[q], thirds[q]);
            if let Some(fibres) = &self.at_points.fibres {
                stress += third_green_stress(fibres, &a[q].gradient);
            }
            if let Some(law) = &self.law {
                stress += law.third(&a[q].gradient);
            }
            terms.add_stress(&(stress * point.volume), &point.gradients[..self.count]);
        }
        if let Some(fibres) = self.of_mean.as_ref().and_then(|parts| parts.fibres.as_ref()) {
            let stress = third_green_stress(fibres, &strained.means[0]) * self.volume;
            terms.add_stress(&stress, &self.mean_gradients[..self.count]);
        }
        terms
    }
}
