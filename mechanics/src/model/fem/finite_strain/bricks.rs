//! Hexahedra and wedges at positions, with one volume change for each cell or one for each of its points, and tetrahedra with nodes
//! in the middle of their edges, with one for each of four points.
//!
//! On the way a cell has a mean volume change t of its own beside the Jm of its positions (the three fields of Simo, Taylor, Pister
//! 1985, without unknowns): p = U'(t) in its tangent, p + U''(t) (Jm - t) in the forces of a step, and t goes to what the step
//! makes of Jm at first order. In the end t = Jm. With Jm alone a cell whose step turns or grows it is pressed by the bulk modulus at
//! once, and the steps of Newton's method wander.

use std::sync::Arc;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::brick_at_rest::{Brick, PointAtRest};
use super::elements::{CellBulkModulus, rounded};
use super::fibres::FibreField;
use super::problem::FiniteStrain;
use super::step_length::Volume;
use crate::material::hyperelastic::point::{Corner, MeanShare, Point};
use crate::material::hyperelastic::{Law, OfVolume, VolumeEnergy};
use crate::mesh::{CellShape, Vector};
use crate::model::dofs::DofMap;
use crate::model::fem::inner_stress::InnerStress;
use crate::model::problem::InvertedCell;
use crate::progress::Progress;
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::{Block, SolverError};

/// Cells that one thread takes at a time.
const CHUNK: usize = 128;

/// The mean volume change that a cell has of its own is at most so many times that of its positions, and not less than that part.
const MOST_APART: f64 = 2.0;

/// A brick at positions, point by point.
pub(super) struct BrickAt<'a> {
    pub at_rest: &'a [PointAtRest],
    pub points: &'a [Point],
    pub law: u16,
    /// What acts on the mean of J; none where volume is taken at each point.
    pub mean: Option<OfVolume>,
    /// In kPa, of what is taken as a mean at rest; 0 where nothing is.
    pub bulk_modulus: f64,
}

impl BrickAt<'_> {
    /// In mm^3, at rest.
    pub fn volume(&self) -> f64 {
        self.at_rest.iter().map(|point| point.volume).sum()
    }

    /// p of the mean of J in kPa.
    pub fn pressure(&self) -> f64 {
        self.mean.map_or(0.0, |mean| mean.first)
    }

    /// What resists the integral of J over the cell, in kPa/mm^3.
    pub fn of_mean(&self) -> f64 {
        self.mean.map_or(0.0, |mean| mean.second.max(0.0) / self.volume())
    }

    /// In mN mm, without what muscles pull.
    pub fn passive_energy(&self) -> f64 {
        self.energy(Point::passive_energy)
    }

    /// In mN mm. W - U(J) + p J stands for the points, U of the mean is asked for.
    fn energy(&self, of_point: impl Fn(&Point) -> f64) -> f64 {
        let energy = |(rest, point): (&PointAtRest, &Point)| {
            let pressed = self.mean.map_or(0.0, |mean| mean.energy - mean.first * point.volume());
            rest.volume * (of_point(point) + pressed)
        };
        self.at_rest.iter().zip(self.points).map(energy).sum()
    }
}

/// The hexahedra and wedges of a mesh.
pub(super) struct Bricks<'a> {
    laws: &'a [Law],
    fibres: FibreField<'a>,
    inner: Arc<InnerStress>,
    bricks: Vec<Brick>,
    /// Their places in the order of the degree-of-freedom map, and for each cell of the mesh its brick.
    own_elements: Vec<usize>,
    of_cell: Vec<u32>,
}

/// A brick at positions.
struct DeformedBrick {
    points: Vec<Point>,
    mean: Option<DeformedMean>,
}

/// What acts on the mean of J.
#[derive(Clone, Copy)]
struct DeformedMean {
    /// t of the cell, and U there.
    own: f64,
    at_own: OfVolume,
    /// Jm of its positions, and U'.
    volume: f64,
    pressure: f64,
}

impl DeformedMean {
    /// What the pressure of Jm, and that of a step, are more than U'(t), in kPa.
    fn more(&self) -> [f64; 2] {
        let OfVolume { first, second, .. } = self.at_own;
        [self.pressure - first, second * (self.volume - self.own)]
    }
}

pub(super) struct DeformedBricks<'a> {
    bricks: &'a Bricks<'a>,
    deformed: Vec<DeformedBrick>,
}

impl<'a> Bricks<'a> {
    pub fn new(
        problem: &FiniteStrain<'a>,
        dof_map: &DofMap,
        kept: &CellBulkModulus,
    ) -> Result<Self, InvertedCell> {
        let FiniteStrain { mesh, laws, law_of_cell, elements, fibres, .. } = *problem;
        let inner = Arc::clone(&problem.inner);
        let order = &dof_map.ordering.element_order;
        let is_brick = |&element: &usize| {
            elements.quadratic || mesh.cells.shape(order[element] as usize) != CellShape::Tet4
        };
        let own_elements: Vec<usize> = (0..order.len()).filter(is_brick).collect();
        let brick = |&element: &usize| {
            let cell = order[element] as usize;
            let rows = dof_map.connectivity.row(element).to_vec();
            let law = law_of_cell[cell];
            let mut brick = Brick::new(mesh, cell, rows, law)?;
            if elements.mean_dilatation {
                brick.of_mean = kept.of_brick(&laws[usize::from(law)], cell);
            }
            Ok(brick.grown(inner.grown(cell)))
        };
        let bricks = own_elements.par_iter().map(brick).collect::<Result<Vec<_>, _>>()?;
        let mut of_cell = vec![u32::MAX; if bricks.is_empty() { 0 } else { order.len() }];
        for (brick, &element) in own_elements.iter().enumerate() {
            of_cell[order[element] as usize] = brick as u32;
        }
        Ok(Bricks { laws, fibres, inner, bricks, own_elements, of_cell })
    }

    /// Cells of the mesh.
    pub fn cells(&self) -> impl Iterator<Item = usize> {
        self.bricks.iter().map(|brick| brick.cell)
    }

    /// Whether all take volume as a mean.
    pub fn all_share(&self) -> bool {
        self.bricks.iter().all(|brick| brick.of_mean.is_some())
    }

    /// Those that take volume as a mean.
    pub fn cells_that_share(&self) -> impl Iterator<Item = usize> {
        self.bricks.iter().filter(|brick| brick.of_mean.is_some()).map(|brick| brick.cell)
    }

    pub fn megabytes(&self) -> f64 {
        let points: usize = self.bricks.iter().map(|brick| brick.points.len()).sum();
        (points * (size_of::<Point>() + 8 * size_of::<Vector>())) as f64 / 1e6
    }

    /// As those of simplices, of each point.
    pub fn moduli(&self, farthest: f64) -> impl Iterator<Item = (f64, f64)> {
        self.bricks.iter().flat_map(move |brick| {
            let (lambda, mu) = self.laws[usize::from(brick.law)].at_rest();
            brick.points.iter().map(move |point| {
                rounded(point.volume * (lambda + 2.0 * mu), &point.gradients, farthest)
            })
        })
    }

    /// With the mean volume change that the cell has of its own, or that of the positions.
    fn at_brick(&self, brick: &Brick, x: &[Vector], own: Option<f64>) -> DeformedBrick {
        let law = &self.laws[usize::from(brick.law)];
        let of_cell = brick.positions(x);
        let fibres = self.fibres.along(brick.law, brick.cell);
        let pulls = self.inner.pulls(brick.cell);
        let point = |at: &PointAtRest| Point::new(law, fibres, at.gradient(&of_cell)).pulled(pulls);
        let points: Vec<Point> = brick.points.iter().map(point).collect();
        let Some(energy) = brick.of_mean else { return DeformedBrick { points, mean: None } };
        let pairs = brick.points.iter().zip(&points);
        let volume: f64 = pairs.map(|(at, point)| at.volume * point.volume()).sum();
        let volume = volume / brick.volume;
        let own = own.unwrap_or(volume);
        let (at_own, pressure) = (energy.at(own), energy.at(volume).first);
        let by = MeanShare { pressure: at_own.first, energy };
        let points = points.into_iter().map(|point| point.of_mean(by)).collect();
        DeformedBrick { points, mean: Some(DeformedMean { own, at_own, volume, pressure }) }
    }

    /// `means` are the mean volume changes that cells have of their own; those of the positions where there are none.
    pub fn at(&self, x: &[Vector], means: &[f64]) -> DeformedBricks<'_> {
        let deformed = |(number, brick)| self.at_brick(brick, x, means.get(number).copied());
        let deformed = self.bricks.par_iter().enumerate().map(deformed).collect();
        DeformedBricks { bricks: self, deformed }
    }

    /// The mean volume changes of positions.
    pub fn means_at(&self, x: &[Vector]) -> Vec<f64> {
        let deformed = self.at(x, &[]).deformed.into_iter();
        deformed.map(|brick| brick.mean.map_or(1.0, |mean| mean.volume)).collect()
    }

    /// The mean volume changes of cells at rest; empty where none takes volume as a mean.
    pub fn means_at_rest(&self) -> Vec<f64> {
        match self.bricks.iter().any(|brick| brick.of_mean.is_some()) {
            true => vec![1.0; self.bricks.len()],
            false => Vec::new(),
        }
    }

    /// In mN mm.
    pub fn energy(&self, x: &[Vector]) -> f64 {
        let energy = |brick: &Brick| self.at_brick(brick, x, None).of(brick).energy(Point::energy);
        let sums: Vec<f64> =
            self.bricks.par_chunks(CHUNK).map(|bricks| bricks.iter().map(energy).sum()).collect();
        sums.iter().sum()
    }

    /// The largest part of a step up to the whole in which every point keeps that share of its volume.
    pub fn longest_step(&self, x: &[Vector], step: &[Vector], keep: f64) -> f64 {
        let longest = |brick: &Brick| {
            let (here, along) = (brick.positions(x), brick.positions(step));
            brick.points.iter().fold(1.0_f64, |most, at| {
                Volume::along(&at.gradient(&here), &at.gradient(&along), keep).positive_until(most)
            })
        };
        self.bricks.par_iter().map(longest).reduce(|| 1.0, f64::min)
    }
}

impl DeformedBrick {
    fn of<'a>(&'a self, at_rest: &'a Brick) -> BrickAt<'a> {
        let DeformedBrick { points, mean } = self;
        let bulk_modulus = at_rest.of_mean.map_or(0.0, VolumeEnergy::bulk_modulus);
        let mean = mean.map(|mean| mean.at_own);
        BrickAt { at_rest: &at_rest.points, points, law: at_rest.law, mean, bulk_modulus }
    }
}

impl DeformedBricks<'_> {
    /// Adds internal forces in mN to those of the positions, and to those of a step.
    pub fn add_forces(&self, forces: &mut [Vector], of_step: &mut [Vector]) {
        let pairs = self.bricks.bricks.par_iter().zip(&self.deformed);
        let of_bricks: Vec<Vec<[Vector; 2]>> = pairs
            .map(|(brick, deformed)| {
                let more = deformed.mean.map_or([0.0; 2], |mean| mean.more());
                let mut forces = vec![[Vector::zeros(); 2]; brick.rows.len()];
                for (at, point) in brick.points.iter().zip(&deformed.points) {
                    let stress = point.stress() * at.volume;
                    for (force, g) in forces.iter_mut().zip(&at.gradients) {
                        let (own, of_volume) =
                            (stress * g, point.corner(g).of_volume() * at.volume);
                        force.iter_mut().zip(more).for_each(|(f, m)| *f += own + of_volume * m);
                    }
                }
                forces
            })
            .collect();
        for (brick, own) in self.bricks.bricks.iter().zip(of_bricks) {
            for (&row, [force, in_step]) in brick.rows.iter().zip(own) {
                forces[row as usize] += force;
                of_step.get_mut(row as usize).into_iter().for_each(|sum| *sum += in_step);
            }
        }
    }

    /// Moves the mean volume changes that cells have of their own by a part of a step.
    pub fn advance(&self, step: &[Vector], taken: f64, means: &mut [f64]) {
        let bricks = self.bricks.bricks.par_iter().zip(&self.deformed);
        bricks.zip(means).for_each(|((brick, deformed), own)| {
            let Some(mean) = &deformed.mean else { return };
            let step = brick.positions(step);
            let pairs = brick.points.iter().zip(&deformed.points);
            let grown = pairs.map(|(at, point)| {
                let corners = step.iter().zip(&at.gradients);
                let along: f64 = corners.map(|(d, g)| point.corner(g).of_volume().dot(d)).sum();
                along * at.volume
            });
            let ahead = mean.volume + grown.sum::<f64>() / brick.volume;
            let next = *own + taken * (ahead - *own);
            *own = next.clamp(mean.volume / MOST_APART, mean.volume * MOST_APART);
        });
    }

    /// Adds the derivatives of the internal forces, in kPa mm.
    pub fn add_tangent(
        &self,
        matrix: &mut HalfMatrix<f64, 3>,
        dof_map: &DofMap,
        progress: &dyn Progress,
    ) -> Result<(), SolverError> {
        let of_cell = |cell: usize| Ok(self.tangent_of(self.bricks.of_cell[cell] as usize));
        // The cells are known to be sound.
        match dof_map.add_cells(matrix, &self.bricks.own_elements, progress, of_cell) {
            Ok(true) => Ok(()),
            Ok(false) | Err(InvertedCell { .. }) => Err(SolverError::Stopped),
        }
    }

    /// The hexahedron or wedge of a cell of the mesh.
    pub fn at_cell(&self, cell: usize) -> BrickAt<'_> {
        let brick = self.bricks.of_cell[cell] as usize;
        let (own, deformed) = (&self.bricks.bricks[brick], &self.deformed[brick]);
        deformed.of(own)
    }

    fn tangent_of(&self, brick: usize) -> Vec<Block> {
        let (at_rest, deformed) = (&self.bricks.bricks[brick], &self.deformed[brick]);
        let count = at_rest.rows.len();
        let mut sums = vec![Matrix3::zeros(); count * count];
        let mut of_volume = vec![Vector::zeros(); count];
        for (at, point) in at_rest.points.iter().zip(&deformed.points) {
            let corners: Vec<Corner> = at.gradients.iter().map(|g| point.corner(g)).collect();
            for (entry, sum) in sums.iter_mut().enumerate() {
                let (a, b) = (&corners[entry / count], &corners[entry % count]);
                *sum += point.block(a, b) * at.volume;
            }
            for (sum, corner) in of_volume.iter_mut().zip(&corners) {
                *sum += corner.of_volume() * at.volume;
            }
        }
        if let Some(mean) = &deformed.mean {
            let factor = mean.at_own.second / at_rest.volume;
            for (entry, sum) in sums.iter_mut().enumerate() {
                *sum += of_volume[entry / count] * of_volume[entry % count].transpose() * factor;
            }
        }
        sums.iter().map(|m| std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))).collect()
    }

    /// The least det F.
    pub fn least_volume(&self) -> f64 {
        self.least_volumes().map(|(_, volume)| volume).fold(f64::INFINITY, f64::min)
    }

    /// Each cell of the mesh that is a brick, and the least det F of its points.
    pub fn least_volumes(&self) -> impl Iterator<Item = (usize, f64)> {
        self.bricks.bricks.iter().zip(&self.deformed).map(|(brick, deformed)| {
            let volumes = deformed.points.iter().map(Point::volume);
            (brick.cell, volumes.fold(f64::INFINITY, f64::min))
        })
    }
}
