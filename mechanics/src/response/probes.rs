//! Probes of the skin, solved on the tissue of a response, and what they say of its second and third order (`coupling`).

use super::coupling::{PROBES, Probed, pairs, triples};
use super::rigid_numbers::SAMPLES;
use super::second_order::{Solutions, State, terms};
use super::superposition::COLUMNS_PER_SEGMENT;
use crate::mesh::Vector;
use crate::model::fem::force_series::{Forces, LinearState};
use crate::model::fem::linear_system::Residual;
use crate::model::problem::ModelError;
use crate::progress::Progress;
use crate::solver::SolverError;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Patches of the skin, each of which a probe pulls as one.
const PATCHES: usize = 128;

/// Relative residual of the solutions of probes.
const PROBED: f64 = 0.03;

/// Segments up to which every three directions are taken: their number grows with the cube.
const ALL_THREE: usize = 2;

/// Products whose forces are computed together.
const TOGETHER: usize = 16;

/// The solution of each probe.
pub(super) struct Probes(Vec<State>);

impl Probes {
    pub fn solve(solutions: &Solutions, progress: &dyn Progress) -> Result<Probes, ModelError> {
        let directions = directions(solutions);
        let mut moving: Vec<u32> = directions
            .iter()
            .flat_map(|direction| solutions.skin.moving_points(direction.as_moved().displacement))
            .map(|point| solutions.skin.nodes()[point as usize])
            .collect();
        moving.sort_unstable();
        moving.dedup();
        let probes = probes(moving, &solutions.series.tissue.mesh.nodes);
        Ok(Probes(solutions.solved(probes, PROBED, progress)?))
    }

    /// Of every pair of sampled directions.
    pub fn second(&self, solutions: &Solutions) -> Result<Vec<Probed>, ModelError> {
        let directions = directions(solutions);
        let states: Vec<LinearState> = directions.iter().map(State::as_moved).collect();
        let all: Vec<[usize; 2]> = pairs(states.len()).collect();
        let mut second = Vec::with_capacity(all.len());
        for some in all.chunks(TOGETHER) {
            let forces = solutions.series.second(&states, some)?;
            second.par_extend(forces.par_iter().zip(some).map(|(forces, [k, l])| {
                let factor = if k == l { 1.0 } else { 2.0 };
                self.of(forces).map(|value| (factor * value) as f32)
            }));
        }
        Ok(second)
    }

    /// Of every three of them, from u2 of every pair; of more than two segments none of three directions of different segments. The
    /// forces are a cubic form in the numbers of a plan, whose coefficients follow from those of up to three directions added up.
    pub fn third(
        &self,
        solutions: &Solutions,
        squares: &[State],
        progress: &dyn Progress,
    ) -> Result<Vec<Probed>, ModelError> {
        let directions = directions(solutions);
        let count = directions.len();
        let along = |sums: &[Vec<(usize, f64)>]| {
            self.along(solutions, (&directions, squares), sums, progress)
        };
        let mut known: BTreeMap<[usize; 3], [f64; PROBES]> = BTreeMap::new();

        let single: Vec<_> = (0..count).map(|j| vec![(j, 1.0)]).collect();
        known.extend(along(&single)?.into_iter().enumerate().map(|(j, own)| ([j; 3], own)));

        let two: Vec<[usize; 2]> = pairs(count).filter(|[j, k]| j < k).collect();
        let with =
            |sign: f64| -> Vec<_> { two.iter().map(|&[j, k]| vec![(j, 1.0), (k, sign)]).collect() };
        let (plus, minus) = (along(&with(1.0))?, along(&with(-1.0))?);
        for (&[j, k], (plus, minus)) in two.iter().zip(plus.iter().zip(&minus)) {
            let (of_j, of_k) = (known[&[j; 3]], known[&[k; 3]]);
            let half = |i: usize, sign: f64| 0.5 * (plus[i] + sign * minus[i]);
            known.insert([j, k, k], std::array::from_fn(|i| half(i, 1.0) - of_j[i]));
            known.insert([j, j, k], std::array::from_fn(|i| half(i, -1.0) - of_k[i]));
        }

        let is_taken = |[j, k, l]: &[usize; 3]| {
            j < k && k < l && (j / SAMPLES == l / SAMPLES || count <= ALL_THREE * SAMPLES)
        };
        let three: Vec<[usize; 3]> = triples(count).filter(is_taken).collect();
        let sums: Vec<_> = three.iter().map(|all| all.map(|j| (j, 1.0)).to_vec()).collect();
        for (&[j, k, l], all) in three.iter().zip(along(&sums)?) {
            let pair = |a, b| [[a; 3], [a, a, b], [a, b, b]];
            let parts = [pair(j, k), pair(k, l), [[l; 3], [j, j, l], [j, l, l]]];
            let rest = |i: usize| parts.iter().flatten().map(|part| known[part][i]).sum::<f64>();
            known.insert([j, k, l], std::array::from_fn(|i| all[i] - rest(i)));
        }
        let of =
            |triple| known.get(&triple).map_or([0.0; PROBES], |own| own.map(|value| value as f32));
        Ok(triples(count).map(of).collect())
    }

    /// Of the third order along sums of directions, each with its factor.
    fn along(
        &self,
        solutions: &Solutions,
        (directions, squares): (&[State], &[State]),
        sums: &[Vec<(usize, f64)>],
        progress: &dyn Progress,
    ) -> Result<Vec<[f64; PROBES]>, ModelError> {
        let place: BTreeMap<[usize; 2], usize> = pairs(directions.len()).zip(0..).collect();
        let path = |sum: &Vec<(usize, f64)>| {
            let mut path = [State::default(), State::default()];
            for (number, &(j, a)) in sum.iter().enumerate() {
                path[0].add(&directions[j].as_moved(), a);
                for &(k, b) in &sum[number..] {
                    path[1].add(&squares[place[&[j, k]]].as_moved(), a * b);
                }
            }
            path
        };
        let mut probed = Vec::with_capacity(sums.len());
        for some in sums.chunks(TOGETHER) {
            if progress.is_cancelled() {
                return Err(SolverError::Stopped.into());
            }
            let paths: Vec<[State; 2]> = some.par_iter().map(path).collect();
            let paths: Vec<[LinearState; 2]> =
                paths.iter().map(|path| path.each_ref().map(State::as_moved)).collect();
            let forces = solutions.series.third_of_each(&paths)?;
            probed.par_extend(forces.par_iter().map(|forces| self.of(forces)));
        }
        Ok(probed)
    }

    /// What the solution of each probe says of some forces.
    fn of(&self, forces: &Forces) -> [f64; PROBES] {
        let with = |state: &State| {
            let LinearState { displacement, pressures } = state.as_moved();
            let nodes = forces.nodes.iter().zip(displacement).map(|(f, z)| f.dot(z));
            let volumes = forces.volumes.iter().zip(pressures).map(|(f, z)| f * z);
            nodes.sum::<f64>() + volumes.sum::<f64>()
        };
        std::array::from_fn(|probe| with(&self.0[probe]))
    }
}

/// u2 of every pair of sampled directions, added up from those of pairs of columns.
pub(super) struct Squares {
    /// For each pair of columns the pairs of directions that it is part of, each with its factor.
    parts: BTreeMap<[usize; 2], Vec<(usize, f64)>>,
    pub states: Vec<State>,
}

impl Squares {
    pub fn new(columns: usize) -> Self {
        let directions = columns / COLUMNS_PER_SEGMENT * SAMPLES;
        let mut parts: BTreeMap<[usize; 2], Vec<(usize, f64)>> = BTreeMap::new();
        for (number, [d, e]) in pairs(directions).enumerate() {
            for (a, k) in terms(d) {
                for (b, l) in terms(e) {
                    // Both orders of two columns are passed, of two directions only one.
                    let factor = if d == e { 1.0 } else { 2.0 } * if k == l { 1.0 } else { 0.5 };
                    let part = (number, factor * a * b);
                    parts.entry([k.min(l), k.max(l)]).or_default().push(part);
                }
            }
        }
        Squares { parts, states: vec![State::default(); pairs(directions).count()] }
    }

    /// Adds the solution of a pair of columns.
    pub fn add(&mut self, pair: [usize; 2], solution: &State) {
        for &(number, factor) in self.parts.get(&pair).into_iter().flatten() {
            self.states[number].add(&solution.as_moved(), factor);
        }
    }
}

fn directions(solutions: &Solutions) -> Vec<State> {
    let segments = 0..solutions.columns.len() / COLUMNS_PER_SEGMENT;
    segments.flat_map(|segment| solutions.samples(segment)).collect()
}

/// The forces of each probe on some nodes of the skin at their places.
fn probes(mut skin: Vec<u32>, places: &[Vector]) -> Vec<Residual> {
    let mut patches = Vec::new();
    split(&mut skin, places, PATCHES, &mut patches);
    let probe = |probe: usize| {
        let mut forces = vec![Vector::zeros(); places.len()];
        for (patch, nodes) in patches.iter().enumerate() {
            let sign = |axis| sign([probe, patch, axis]);
            let force = Vector::new(sign(0), sign(1), sign(2)) / (nodes.len() as f64).sqrt();
            nodes.iter().for_each(|&node| forces[node as usize] = force);
        }
        Residual { forces, volumes: Vec::new() }
    };
    (0..PROBES).map(probe).collect()
}

/// Halves nodes across their longest extent until there are so many patches.
fn split(nodes: &mut [u32], places: &[Vector], parts: usize, patches: &mut Vec<Vec<u32>>) {
    if parts < 2 || nodes.len() < 2 {
        patches.extend((!nodes.is_empty()).then(|| nodes.to_vec()));
        return;
    }
    let at = |node: &u32| places[*node as usize];
    let (mut low, mut high) = (at(&nodes[0]), at(&nodes[0]));
    for node in nodes.iter() {
        (low, high) = (low.inf(&at(node)), high.sup(&at(node)));
    }
    let axis = (high - low).imax();
    nodes.sort_by(|a, b| at(a)[axis].total_cmp(&at(b)[axis]).then(a.cmp(b)));
    let (below, above) = nodes.split_at_mut(nodes.len() / 2);
    split(below, places, parts / 2, patches);
    split(above, places, parts / 2, patches);
}

/// The same sign for the same numbers on every machine (splitmix64).
fn sign([probe, patch, axis]: [usize; 3]) -> f64 {
    let mut bits = ((probe * PATCHES + patch) * 3 + axis + 1) as u64;
    bits = bits.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    if (bits ^ (bits >> 31)) & 1 == 1 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_square_of_the_probes_is_that_of_a_smooth_field() {
        let places: Vec<Vector> =
            (0..900).map(|n| Vector::new(f64::from(n % 30), f64::from(n / 30), 0.0)).collect();
        let skin: Vec<u32> = (0..900).collect();
        let field = |x: &Vector| Vector::new((0.2 * x.x).sin(), 0.3, (0.1 * x.y).cos());
        let exact: f64 = places.iter().map(|x| field(x).norm_squared()).sum();
        let with = |probe: Residual| {
            probe.forces.iter().zip(&places).map(|(w, x)| w.dot(&field(x))).sum::<f64>()
        };
        let squares = probes(skin, &places).into_iter().map(|probe| with(probe).powi(2));
        let ratio = squares.sum::<f64>() / PROBES as f64 / exact;
        assert!((0.5..1.6).contains(&ratio), "{ratio}");
    }
}
