//! Convergence over meshes of any cell sizes (Zhang et al. 2016 made ten of one face; docs/methods.md#studies).
//!
//! The mean movement m of the skin on meshes of cell size h is fitted by
//!
//! m(h) = m* + c h^p
//!
//! in least squares: for each p the line over h^p that fits best, and of these p the best one. Where that lies at an end of
//! [`ORDERS`], or a constant fits nearly as well, the coarsest mesh is left out, which is not near its limit, as long as
//! [`FEWEST`] are left; then the sizes show no order and no limit. Three sizes, each half of the one before, have the
//! closed form of `convergence`.
//!
//! h is the edge of a cube with the volume of six tetrahedra, two wedges or one hexahedron in the mean, so that a grid of
//! cubes has the same one however it is cut.

use std::collections::BTreeMap;

use super::report::{Outcome, Report, Row};
use crate::mesh::{CellShape, VolumeMesh};

/// Orders that are looked for: uniform meshes of faces show 1 (an edge of bone) to 2, quadratic ones up to 3.
pub const ORDERS: [f64; 2] = [0.2, 5.0];

/// A mesh is fine enough where no finer one changes the skin by more (Zhang et al. 2016).
pub const SETTLED: f64 = 0.003;

/// Meshes that a fit has at least, where there are as many: through three almost any three numbers fit.
pub const FEWEST: usize = 4;

/// Orders that are tried before the best is refined.
const TRIED: usize = 97;

/// One face on several meshes, solved in one way.
#[derive(Clone, Debug, PartialEq)]
pub struct CellSizes {
    pub series: String,
    pub plan: String,
    pub material: String,
    pub label: String,
    /// Coarsest first.
    pub meshes: Vec<MeshPoint>,
    pub fit: Option<Fit>,
    /// The coarsest size from which on no finer mesh differs from the one before by more than [`SETTLED`]; none where the last
    /// step is larger.
    pub settled: Option<f64>,
}

/// The skin on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPoint {
    pub scene: String,
    /// h in mm.
    pub cell: f64,
    pub cells: usize,
    pub unknowns: usize,
    pub wall_s: f64,
    /// m in mm.
    pub skin_mean: f64,
    /// |m - m before| / |m|; none of the coarsest, and where the skin does not move.
    pub change: Option<f64>,
}

/// m* + c h^p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// p.
    pub order: f64,
    /// m* in mm.
    pub limit: f64,
    /// Root of the mean squared distance of the meshes from it, in mm.
    pub rms: f64,
    /// How many of the finest meshes it is of.
    pub meshes: usize,
}

/// h of a mesh, in mm.
pub fn cell_size(mesh: &VolumeMesh) -> f64 {
    let in_a_cube = |shape: CellShape| -> f64 {
        match shape {
            CellShape::Tet4 => 6.0,
            CellShape::Wedge6 => 2.0,
            CellShape::Hex8 => 1.0,
        }
    };
    let cubes: f64 = mesh.cells.iter().map(|(shape, _)| in_a_cube(shape).recip()).sum();
    let boundary = mesh.surface_of(&mesh.boundary_faces());
    let volume: f64 = boundary
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] =
                triangle.map(|point| boundary.points[point as usize] - boundary.points[0]);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum();
    (volume.abs() / cubes.max(1.0)).cbrt()
}

/// The series of a report, in its order; `series_of` has that of each scene that belongs to one. Rows without numbers and finer
/// levels than 0 are left out, and so is what is left with one mesh.
pub fn cell_sizes(report: &Report, series_of: &BTreeMap<String, String>) -> Vec<CellSizes> {
    let mut all: Vec<CellSizes> = Vec::new();
    for row in report.rows.iter().filter(|row| row.level == 0) {
        let (Some(series), Some(point)) = (series_of.get(&row.scene), point(report, row)) else {
            continue;
        };
        let is_own = |of: &&mut CellSizes| {
            [&of.series, &of.plan, &of.material, &of.label]
                == [series, &row.plan, &row.material, &row.label]
        };
        match all.iter_mut().find(is_own) {
            Some(of) => of.meshes.push(point),
            None => all.push(CellSizes {
                series: series.clone(),
                plan: row.plan.clone(),
                material: row.material.clone(),
                label: row.label.clone(),
                meshes: vec![point],
                fit: None,
                settled: None,
            }),
        }
    }
    all.retain(|of| of.meshes.len() > 1);
    all.iter_mut().for_each(CellSizes::conclude);
    all
}

fn point(report: &Report, row: &Row) -> Option<MeshPoint> {
    let Outcome::Solved(solved) = &row.outcome else { return None };
    let scene = report.scenes.iter().find(|scene| scene.name == row.scene)?;
    Some(MeshPoint {
        scene: row.scene.clone(),
        cell: scene.cell_size,
        cells: scene.cells,
        unknowns: solved.unknowns,
        wall_s: solved.wall_s,
        skin_mean: solved.skin_mean_mm,
        change: None,
    })
}

impl CellSizes {
    fn conclude(&mut self) {
        self.meshes.sort_by(|a, b| b.cell.total_cmp(&a.cell));
        for at in 1..self.meshes.len() {
            let (before, own) = (self.meshes[at - 1].skin_mean, self.meshes[at].skin_mean);
            self.meshes[at].change = (own != 0.0).then(|| ((own - before) / own).abs());
        }
        let points: Vec<[f64; 2]> =
            self.meshes.iter().map(|mesh| [mesh.cell, mesh.skin_mean]).collect();
        let most_left_out = points.len() - points.len().min(FEWEST);
        self.fit = (0..=most_left_out).find_map(|coarsest| fitted(&points[coarsest..]));
        let is_small = |mesh: &&MeshPoint| mesh.change.is_some_and(|change| change <= SETTLED);
        let small = self.meshes.iter().rev().take_while(is_small).count();
        let first = self.meshes.len() - 1 - small;
        self.settled = (small > 0).then(|| self.meshes[first].cell);
    }
}

/// m* + c h^p through points (h, m), of three sizes or more.
pub fn fitted(points: &[[f64; 2]]) -> Option<Fit> {
    let mut sizes: Vec<f64> = points.iter().map(|[h, _]| *h).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup();
    if sizes.len() < 3 {
        return None;
    }
    let mean = points.iter().map(|[_, m]| m).sum::<f64>() / points.len() as f64;
    let flat = points.iter().map(|[_, m]| (m - mean).powi(2)).sum::<f64>();
    let [least, most] = ORDERS;
    let step = (most - least) / (TRIED - 1) as f64;
    let order = |at: usize| least + step * at as f64;
    let best = (0..TRIED)
        .min_by(|&a, &b| line(points, order(a)).1.total_cmp(&line(points, order(b)).1))
        .filter(|at| (1..TRIED - 1).contains(at))?;
    let p = refined(points, [order(best - 1), order(best + 1)]);
    let (limit, left) = line(points, p);
    let rms = (left / points.len() as f64).sqrt();
    // A tenth of what a constant leaves is an order; more is noise.
    (left <= 0.1 * flat && flat > 0.0).then_some(Fit { order: p, limit, rms, meshes: points.len() })
}

/// Golden section.
fn refined(points: &[[f64; 2]], [mut low, mut high]: [f64; 2]) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..80 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if line(points, a).1 <= line(points, b).1 { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// m* of the line over h^p that fits best, and the sum of squares that it leaves. Powers are of the largest size, which
/// changes neither.
fn line(points: &[[f64; 2]], p: f64) -> (f64, f64) {
    let largest = points.iter().map(|[h, _]| *h).fold(0.0, f64::max);
    let n = points.len() as f64;
    let power = |h: f64| (h / largest).powf(p);
    let (x, m) = points.iter().fold((0.0, 0.0), |(x, m), [h, value]| (x + power(*h), m + value));
    let (x, m) = (x / n, m / n);
    let (along, both) = points.iter().fold((0.0, 0.0), |(along, both), [h, value]| {
        let away = power(*h) - x;
        (along + away * away, both + away * (value - m))
    });
    let slope = both / along;
    let limit = m - slope * x;
    let left = points.iter().map(|[h, value]| (value - limit - slope * power(*h)).powi(2)).sum();
    (limit, left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vector;
    use crate::mesh::sample::block;

    #[test]
    fn ten_sizes_of_a_planted_order_give_it_and_its_limit() {
        // Not halved, as meshes that a mesher makes.
        let sizes = [8.0, 7.0, 6.1, 5.2, 4.6, 4.0, 3.3, 2.9, 2.4, 2.0];
        for planted in [0.5, 1.0, 1.7, 3.0] {
            let points = sizes.map(|h: f64| [h, 4.2 - 0.03 * h.powf(planted)]);
            let fit = fitted(&points).expect("an order");
            assert!((fit.order - planted).abs() < 1e-5, "{planted}: {fit:?}");
            assert!((fit.limit - 4.2).abs() < 1e-5 && fit.rms < 1e-7, "{planted}: {fit:?}");
        }
    }

    #[test]
    fn a_coarse_mesh_that_is_far_from_its_limit_is_left_out() {
        // Plain tetrahedra on the slab of docs/verification.md#v29, whose first step is too small.
        let sizes = [6.0, 3.0, 2.0, 1.5, 1.2];
        let means = [3.5235, 3.5470, 3.5704, 3.5848, 3.5942];
        let points: Vec<[f64; 2]> = sizes.into_iter().zip(means).map(|(h, m)| [h, m]).collect();
        assert_eq!(fitted(&points), None);
        let fit = fitted(&points[1..]).expect("an order");
        assert_eq!(fit.meshes, 4);
        assert!((0.3..1.2).contains(&fit.order) && (3.60..3.68).contains(&fit.limit), "{fit:?}");
    }

    #[test]
    fn three_halved_sizes_give_what_extrapolation_gives() {
        let means = [4.5, 4.3, 4.22];
        let fit = fitted(&[[6.0, means[0]], [3.0, means[1]], [1.5, means[2]]]).expect("an order");
        let (order, limit) = super::super::convergence::extrapolated(means).expect("it shrinks");
        assert!((fit.order - order).abs() < 1e-6 && (fit.limit - limit).abs() < 1e-6, "{fit:?}");
    }

    #[test]
    fn noise_and_two_sizes_have_no_order() {
        let noise = [[8.0, 4.0], [6.0, 4.3], [5.0, 3.9], [4.0, 4.2], [3.0, 4.0], [2.0, 4.25]];
        assert_eq!(fitted(&noise), None);
        // A course of order 2 that its noise hides.
        let sizes: [f64; 7] = [8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0];
        let trend = |at: usize| 4.0 - 0.02 * sizes[at].powi(2) + [0.3, -0.3][at % 2];
        let points: Vec<[f64; 2]> = (0..7).map(|at| [sizes[at], trend(at)]).collect();
        assert_eq!(fitted(&points), None);
        assert_eq!(fitted(&[[2.0, 1.0], [1.0, 2.0]]), None);
        assert_eq!(fitted(&[[2.0, 1.0], [2.0, 1.1], [1.0, 2.0]]), None);
        assert_eq!(fitted(&[[3.0, 1.0], [2.0, 1.0], [1.0, 1.0]]), None);
    }

    #[test]
    fn a_block_of_cubes_has_the_size_of_its_cubes_however_it_is_cut() {
        for shape in [CellShape::Tet4, CellShape::Wedge6, CellShape::Hex8] {
            let mesh = block(Vector::new(12.0, 6.0, 9.0), [4, 2, 3], shape);
            assert!((cell_size(&mesh) - 3.0).abs() < 1e-12, "{shape:?} {}", cell_size(&mesh));
        }
    }

    #[test]
    fn a_series_is_settled_from_the_size_on_that_changes_by_less_than_a_third_of_a_percent() {
        let mesh = |cell: f64, skin_mean: f64| MeshPoint {
            scene: format!("{cell} mm"),
            cell,
            cells: 1,
            unknowns: 1,
            wall_s: 0.1,
            skin_mean,
            change: None,
        };
        let of = |means: [f64; 4]| {
            let sizes = [2.0, 8.0, 4.0, 1.0];
            let meshes = sizes.iter().zip(means).map(|(cell, mean)| mesh(*cell, mean)).collect();
            let name = String::new;
            let mut series = CellSizes {
                series: name(),
                plan: name(),
                material: name(),
                label: name(),
                meshes,
                fit: None,
                settled: None,
            };
            series.conclude();
            series
        };
        let series = of([4.2, 5.0, 4.4, 4.195]);
        assert_eq!(series.settled, Some(2.0));
        assert_eq!(series.meshes[0].cell, 8.0);
        assert!((series.meshes[1].change.expect("a step") - 0.6 / 4.4).abs() < 1e-12);
        assert_eq!(of([4.2, 5.0, 4.4, 4.1]).settled, None);
    }
}
