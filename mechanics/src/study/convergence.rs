//! Mesh convergence of the skin (Zhang et al. 2016 chose a mesh where a change was below 0.3 %;
//! docs/methods.md#studies).
//!
//! Of a quantity m on three meshes, each with half the cell size of the one before:
//!
//! p = log2((m1 - m0) / (m2 - m1))        m* = m2 + (m2 - m1) / (2^p - 1)
//!
//! m is the mean of |u| over the skin, by area: stresses at edges of what is held grow without bound.
//! p and m* exist where the steps have one sign and shrink. Source: Richardson, Gaunt, The deferred approach
//! to the limit, Philosophical Transactions A 226, 1927; Roache, Journal of Fluids Engineering 116, 1994.

use super::report::{Outcome, Report, Row};

/// The last levels of one model, on one plan and material.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub scene: String,
    pub plan: String,
    pub material: String,
    pub method: String,
    pub label: String,
    /// Two or three that follow each other, and m on each in mm.
    pub levels: Vec<u32>,
    pub skin_mean_mm: Vec<f64>,
    /// |m2 - m1| / |m2|; none where the skin does not move.
    pub last_change: Option<f64>,
    /// p.
    pub order: Option<f64>,
    /// m* in mm.
    pub limit_mm: Option<f64>,
}

/// A series for each that has numbers on at least two levels that follow each other; in the order of the
/// report.
pub fn series(report: &Report) -> Vec<Series> {
    let mut all: Vec<(&Row, Vec<(u32, f64)>)> = Vec::new();
    for row in &report.rows {
        let Outcome::Solved(solved) = &row.outcome else { continue };
        let point = (row.level, solved.skin_mean_mm);
        match all.iter_mut().find(|(first, _)| belongs(first, row)) {
            Some((_, points)) => points.push(point),
            None => all.push((row, vec![point])),
        }
    }
    all.into_iter().filter_map(|(row, points)| series_of(row, points)).collect()
}

/// p and m* of a quantity on three meshes, coarsest first.
pub fn extrapolated([m0, m1, m2]: [f64; 3]) -> Option<(f64, f64)> {
    let ratio = (m1 - m0) / (m2 - m1);
    let order = ratio.log2();
    (order.is_finite() && order > 0.0).then(|| (order, m2 + (m2 - m1) / (ratio - 1.0)))
}

fn belongs(first: &Row, row: &Row) -> bool {
    let key = |row: &Row| {
        [&row.scene, &row.plan, &row.material, &row.method, &row.label].map(String::clone)
    };
    key(first) == key(row)
}

fn series_of(row: &Row, mut points: Vec<(u32, f64)>) -> Option<Series> {
    points.sort_by_key(|(level, _)| *level);
    let follows = |pair: &[(u32, f64)]| pair[1].0 == pair[0].0 + 1;
    let run = points.windows(2).rev().take_while(|pair| follows(pair)).count().min(2);
    if run == 0 {
        return None;
    }
    let last = &points[points.len() - 1 - run..];
    let (levels, means): (Vec<u32>, Vec<f64>) = last.iter().copied().unzip();
    let (before, finest) = (means[run - 1], means[run]);
    let found = <[f64; 3]>::try_from(means.as_slice()).ok().and_then(extrapolated);
    Some(Series {
        scene: row.scene.clone(),
        plan: row.plan.clone(),
        material: row.material.clone(),
        method: row.method.clone(),
        label: row.label.clone(),
        levels,
        last_change: (finest != 0.0).then(|| ((finest - before) / finest).abs()),
        order: found.map(|(order, _)| order),
        limit_mm: found.map(|(_, limit)| limit),
        skin_mean_mm: means,
    })
}

#[cfg(test)]
mod tests {
    use super::extrapolated;

    #[test]
    fn a_quantity_of_order_two_is_extrapolated_to_its_limit() {
        let on = |h: f64| 4.0 + 0.3 * h * h;
        let (order, limit) = extrapolated([on(4.0), on(2.0), on(1.0)]).expect("the steps shrink");
        // Rounding only.
        assert!((order - 2.0).abs() < 1e-12 && (limit - 4.0).abs() < 1e-12);
    }

    #[test]
    fn steps_that_grow_or_change_sign_have_no_limit() {
        assert_eq!(extrapolated([1.0, 2.0, 4.0]), None);
        assert_eq!(extrapolated([1.0, 2.0, 1.5]), None);
        assert_eq!(extrapolated([1.0, 1.0, 1.0]), None);
    }
}
