//! Muscles around polylines: w = (1 - (d / r)²)² at the distance d < r of the nearest line, along which it pulls.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::fibres::unit;
use super::muscle_field::{elsewhere, muscle_volume};
use super::muscle_pieces::{Piece, Search};
use crate::mesh::ball::Ball;
use crate::mesh::refinement::refine;
use crate::mesh::{Vector, VolumeMesh, Warning, bounds_of, boxes_meet};
use crate::model::fem::inner_stress::CellStress;
use crate::model::reference_cell;
use crate::muscle::lines::FEW_CELLS;
use crate::progress::StopQuery;

/// A muscle that pulls by more than this share otherwise than its lines say is told.
const PULL_OFF: f64 = 0.1;

/// A muscle of more cells is resolved by its own, so that halving their edges once is as good as twice.
const MANY_CELLS: usize = 200;

/// The quadrature points of more cells hold the pull to some per cent wherever they lie.
const ENOUGH_CELLS: usize = 5000;

/// As many points of lines are looked for in the tissue.
const POINTS: f64 = 200.0;

/// How much of the pull of lines the cells of a mesh carry: int w dV by their quadrature points over what it is in the same tissue
/// with every edge halved twice, once where the muscle has many cells, and none where these are enough.
pub(super) struct PullShare {
    cells: usize,
    /// None where no quadrature point of the finer cells is in reach.
    share: Option<f64>,
    /// Of the length of the lines what lies in the tissue, or within a cell of half the size from it.
    inside: f64,
}

impl PullShare {
    /// Of a muscle that has `cells` of those that are `near` it; to be dropped after a stop.
    pub(super) fn new(
        lines: &Lines,
        mesh: &VolumeMesh,
        (near, cells): (&[u32], &[CellStress]),
        stop: &StopQuery,
    ) -> Self {
        let near = lines.tissue_near(mesh, near, stop);
        if cells.len() > ENOUGH_CELLS {
            let inside = lines.share_inside(&near);
            return PullShare { cells: cells.len(), share: Some(1.0), inside };
        }
        let halved = refine(&near);
        let pull_in = |mesh: &VolumeMesh| {
            let all: Vec<u32> = (0..mesh.cells.len() as u32).collect();
            pull_of(mesh, &lines.cells(mesh, &all, stop))
        };
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

    /// w f (x) f of all cells near them where it is not zero; after a stop cells are left out.
    pub(super) fn cells(
        &self,
        mesh: &VolumeMesh,
        near: &[u32],
        stop: &StopQuery,
    ) -> Vec<CellStress> {
        let made = |cell: usize, near: &[&Piece]| {
            if stop.is_asked() {
                return None;
            }
            let stress = self.mean(mesh, cell, near)?;
            Some(CellStress { cell: cell as u32, stress })
        };
        let search = Search { within: self.within, made };
        let mut cells = search.run(mesh, near, &self.pieces);
        cells.sort_unstable_by_key(|own| own.cell);
        cells
    }

    /// Of their length the share that is nearer to the middle of a cell than its farthest corner.
    fn share_inside(&self, mesh: &VolumeMesh) -> f64 {
        let length: f64 = self.pieces.iter().map(|piece| piece.along.norm()).sum();
        let counts = self.pieces.iter().map(|piece| (POINTS * piece.along.norm() / length).ceil());
        let counts: Vec<f64> = counts.collect();
        let mut points: Vec<(Vector, usize, bool)> = Vec::new();
        for (number, (piece, count)) in self.pieces.iter().zip(&counts).enumerate() {
            let at = |k: usize| piece.from + piece.along * ((k as f64 + 0.5) / count);
            points.extend((0..*count as usize).map(|k| (at(k), number, false)));
        }
        points.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
        for cell in 0..mesh.cells.len() {
            let ball = Ball::of(mesh, cell);
            let Ball { middle, squared_radius } = ball;
            let first = points.partition_point(|(x, ..)| x.x < middle.x - ball.radius());
            let from = points[first..].iter_mut();
            for (x, _, is_inside) in from.take_while(|(x, ..)| x.x <= middle.x + ball.radius()) {
                *is_inside |= (*x - middle).norm_squared() <= squared_radius;
            }
        }
        let mut there = vec![0.0; self.pieces.len()];
        points.iter().for_each(|(_, number, is_inside)| there[*number] += f64::from(*is_inside));
        let shares = self.pieces.iter().zip(counts.iter().zip(&there));
        shares.map(|(piece, (count, there))| piece.along.norm() / length * there / count).sum()
    }

    /// Whether a cell may have tissue within reach.
    fn may_reach<'a>(
        &self,
        corners: &[Vector],
        mut pieces: impl Iterator<Item = &'a Piece>,
    ) -> bool {
        let Some(around) = bounds_of(corners) else { return false };
        boxes_meet(&around, &self.reach) && pieces.any(|piece| boxes_meet(&around, &piece.reach))
    }

    /// The cells that may have tissue within reach, of those near.
    fn tissue_near(&self, mesh: &VolumeMesh, cells: &[u32], stop: &StopQuery) -> VolumeMesh {
        let mut near = VolumeMesh::default();
        let mut number_of = BTreeMap::new();
        for (place, cell) in cells.iter().map(|&cell| cell as usize).enumerate() {
            if stop.is_asked_at(place) {
                break;
            }
            let (shape, nodes) = (mesh.cells.shape(cell), mesh.cells.nodes(cell));
            let corners: Vec<Vector> = mesh.corners(cell).collect();
            if !self.may_reach(&corners, self.pieces.iter()) {
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

    /// The mean over a cell by the pieces near it; none where no point of it is within reach.
    fn mean(&self, mesh: &VolumeMesh, cell: usize, near: &[&Piece]) -> Option<Matrix3<f64>> {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        if !self.may_reach(&corners, near.iter().copied()) {
            return None;
        }
        let (mut sum, mut volume) = (Matrix3::zeros(), 0.0);
        for point in &reference_cell(mesh.cells.shape(cell)).points {
            let physical = point.at(&corners)?;
            let place: Vector = corners.iter().zip(&point.values).map(|(x, n)| x * *n).sum();
            sum += self.at(&place, near) * physical.volume;
            volume += physical.volume;
        }
        (sum != Matrix3::zeros()).then(|| sum / volume)
    }

    /// w f (x) f at a place; where pieces are equally near, the mean of theirs, so that rounding does not choose.
    fn at(&self, place: &Vector, near: &[&Piece]) -> Matrix3<f64> {
        let reach = self.within * self.within;
        let (mut nearest, mut sum, mut count) = (reach, Matrix3::zeros(), 0.0);
        for piece in near {
            let squared = piece.squared_distance(place);
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
