//! Muscles around polylines: w = (1 - (d / r)²)² at the distance d < r of the nearest line, along which it pulls.

use std::collections::BTreeMap;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::fibres::unit;
use super::muscle_field::{elsewhere, muscle_volume};
use crate::mesh::refinement::refine;
use crate::mesh::{Vector, VolumeMesh, Warning, bounds_of};
use crate::model::fem::inner_stress::CellStress;
use crate::model::reference_cell;
use crate::muscle::lines::FEW_CELLS;

/// A muscle that pulls by more than this share otherwise than its lines say is told.
const PULL_OFF: f64 = 0.1;

/// A muscle of more cells is resolved by its own, so that halving their edges once is as good as twice.
const MANY_CELLS: usize = 200;

/// As many points of lines are looked for in the tissue.
const POINTS: f64 = 200.0;

/// How much of the pull of lines the cells of a mesh carry: int w dV by their quadrature points over what it is in the same tissue
/// with every edge halved twice, or once where the muscle has many cells.
pub(super) struct PullShare {
    cells: usize,
    /// None where no quadrature point of the finer cells is in reach.
    share: Option<f64>,
    /// Of the length of the lines what lies in the tissue, or within a cell of half the size from it.
    inside: f64,
}

impl PullShare {
    pub(super) fn new(lines: &Lines, mesh: &VolumeMesh, cells: &[CellStress]) -> Self {
        let halved = refine(&lines.tissue_near(mesh));
        let pull_in = |mesh: &VolumeMesh| pull_of(mesh, &lines.cells(mesh));
        let exact = match cells.len() > MANY_CELLS {
            true => pull_in(&halved),
            false => pull_in(&refine(&halved)),
        };
        let share = (exact > 0.0).then(|| pull_of(mesh, cells) / exact);
        PullShare { cells: cells.len(), share, inside: lines.share_inside(&halved) }
    }

    /// Where lines leave the tissue, and where its cells are so few or so coarse that the muscle pulls otherwise than they say.
    pub(super) fn warnings(&self, name: &str) -> impl Iterator<Item = Warning> + use<> {
        self.outside(name).into_iter().chain(self.coarse(name))
    }

    fn outside(&self, name: &str) -> Option<Warning> {
        let of = format!("the length of the lines of muscle {name:?}");
        elsewhere(self.inside, &of, "are they in mm, in the frame of the case?")
    }

    fn coarse(&self, name: &str) -> Option<Warning> {
        let PullShare { cells, share, .. } = *self;
        if cells >= FEW_CELLS && share.is_some_and(|share| (share - 1.0).abs() <= PULL_OFF) {
            return None;
        }
        let pull = share.map_or_else(
            || "no point of finer cells is within their reach".to_owned(),
            |share| {
                format!("it pulls with {:.0} % of what lines of its width exert", 100.0 * share)
            },
        );
        let detail = format!(
            "{cells} cells have tissue near the lines of muscle {name:?}, and {pull}: its pull is as coarse as they are; finer cells or a \
             larger `within_mm` carry it"
        );
        let mut warning = Warning::new("muscle-few-cells", detail).with("cells", cells as f64);
        warning.numbers.extend(share.map(|share| ("pull_share", share)));
        Some(warning)
    }
}

/// int w dV in mm^3 of stresses w f (x) f.
fn pull_of(mesh: &VolumeMesh, cells: &[CellStress]) -> f64 {
    cells.iter().map(|own| muscle_volume(mesh, own)).sum()
}

/// Squared distances that differ by less than this share of the squared reach are equal.
const EQUAL: f64 = 1e-9;

/// A straight piece of a line: its start, the way to its end, and the box around all that is within its reach.
struct Piece {
    from: Vector,
    along: Vector,
    reach: [Vector; 2],
}

impl Piece {
    fn new(from: Vector, to: Vector, within: f64) -> Self {
        let margin = Vector::repeat(within);
        Piece { from, along: to - from, reach: [from.inf(&to) - margin, from.sup(&to) + margin] }
    }
}

fn overlap([low, high]: &[Vector; 2], [other_low, other_high]: &[Vector; 2]) -> bool {
    (0..3).all(|axis| high[axis] >= other_low[axis] && low[axis] <= other_high[axis])
}

/// The lines of a muscle.
pub(super) struct Lines {
    pieces: Vec<Piece>,
    within: f64,
    /// The box around all that is within reach.
    reach: [Vector; 2],
}

impl Lines {
    /// None where no line has a length.
    pub(super) fn new(lines: &[Vec<Vector>], within: f64) -> Option<Self> {
        let pairs = lines.iter().flat_map(|line| line.windows(2));
        let pieces = pairs.map(|pair| Piece::new(pair[0], pair[1], within));
        let pieces: Vec<Piece> = pieces.filter(|piece| unit(&piece.along).is_some()).collect();
        let first = pieces.first()?.reach;
        let boxes = pieces.iter().map(|piece| piece.reach);
        let reach = boxes.fold(first, |[l, h], [low, high]| [l.inf(&low), h.sup(&high)]);
        Some(Lines { pieces, within, reach })
    }

    /// w f (x) f of all cells where it is not zero.
    pub(super) fn cells(&self, mesh: &VolumeMesh) -> Vec<CellStress> {
        let of_cell = |cell: usize| {
            let stress = self.mean(mesh, cell)?;
            Some(CellStress { cell: cell as u32, stress })
        };
        (0..mesh.cells.len()).into_par_iter().filter_map(of_cell).collect()
    }

    /// Of their length the share that is nearer to the middle of a cell than its farthest corner.
    fn share_inside(&self, mesh: &VolumeMesh) -> f64 {
        let balls: Vec<(Vector, f64)> = (0..mesh.cells.len())
            .map(|cell| {
                let middle = mesh.centroid(cell);
                let squared = mesh.corners(cell).map(|x| (x - middle).norm_squared());
                (middle, squared.fold(0.0, f64::max))
            })
            .collect();
        let length: f64 = self.pieces.iter().map(|piece| piece.along.norm()).sum();
        let mut inside = 0.0;
        for piece in &self.pieces {
            let own = piece.along.norm();
            let points = (POINTS * own / length).ceil();
            let at = |k: usize| piece.from + piece.along * ((k as f64 + 0.5) / points);
            let is_in = |x: &Vector| balls.iter().any(|(m, r)| (x - m).norm_squared() <= *r);
            let there = (0..points as usize).filter(|&k| is_in(&at(k))).count();
            inside += own / length * there as f64 / points;
        }
        inside
    }

    /// Whether a cell may have tissue within reach.
    fn may_reach(&self, corners: &[Vector]) -> bool {
        let Some(around) = bounds_of(corners) else { return false };
        overlap(&around, &self.reach)
            && self.pieces.iter().any(|piece| overlap(&around, &piece.reach))
    }

    /// The cells that may have tissue within reach.
    fn tissue_near(&self, mesh: &VolumeMesh) -> VolumeMesh {
        let mut near = VolumeMesh::default();
        let mut number_of = BTreeMap::new();
        for (cell, (shape, nodes)) in mesh.cells.iter().enumerate() {
            let corners: Vec<Vector> = mesh.corners(cell).collect();
            if !self.may_reach(&corners) {
                continue;
            }
            let numbered = nodes.iter().map(|&node| {
                *number_of.entry(node).or_insert_with(|| {
                    near.nodes.push(mesh.nodes[node as usize]);
                    near.nodes.len() as u32 - 1
                })
            });
            let numbered: Vec<u32> = numbered.collect();
            near.cells.push(shape, &numbered);
        }
        near
    }

    /// The mean over a cell; none where no point of it is within reach.
    fn mean(&self, mesh: &VolumeMesh, cell: usize) -> Option<Matrix3<f64>> {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        if !self.may_reach(&corners) {
            return None;
        }
        let (mut sum, mut volume) = (Matrix3::zeros(), 0.0);
        for point in &reference_cell(mesh.cells.shape(cell)).points {
            let physical = point.at(&corners)?;
            let place: Vector = corners.iter().zip(&point.values).map(|(x, n)| x * *n).sum();
            sum += self.at(&place) * physical.volume;
            volume += physical.volume;
        }
        (sum != Matrix3::zeros()).then(|| sum / volume)
    }

    /// w f (x) f at a place; where pieces are equally near, the mean of theirs, so that rounding does not choose.
    fn at(&self, place: &Vector) -> Matrix3<f64> {
        let reach = self.within * self.within;
        let (mut nearest, mut sum, mut count) = (reach, Matrix3::zeros(), 0.0);
        for piece in &self.pieces {
            let share = (place - piece.from).dot(&piece.along) / piece.along.norm_squared();
            let foot = piece.from + piece.along * share.clamp(0.0, 1.0);
            let squared = (place - foot).norm_squared();
            let Some(f) = unit(&piece.along).filter(|_| squared < nearest + EQUAL * reach) else {
                continue;
            };
            if squared < nearest - EQUAL * reach {
                (nearest, sum, count) = (squared, Matrix3::zeros(), 0.0);
            }
            sum += f * f.transpose();
            count += 1.0;
        }
        let fall = 1.0 - nearest / reach;
        if count == 0.0 { Matrix3::zeros() } else { sum * (fall * fall / count) }
    }
}
