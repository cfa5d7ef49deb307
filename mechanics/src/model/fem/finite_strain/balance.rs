//! Measure of rest: forces on free unknowns that nothing balances, against what holds and loads exert.

use super::pressures::Pressures;
use super::tissue::Deformed;
use crate::mesh::Vector;
use crate::model::dofs::Constrained;

/// Forces are measured against what holds and loads exert, at least this share of what is out of balance at the beginning, or
/// exerted there, and of what the whole movement would exert on nodes that stay if tissue yielded as it does there: tissue that is
/// turned as a whole exerts nothing in the end. Nothing of the way counts, where exponential laws may exert a million times as much.
const LEAST_SCALE: f64 = 1e-3;

/// |f_free| / |f_held|, with the forces that volumes left over by pressures stand for.
pub(super) struct Balance {
    /// The norm of forces in mN that rounding leaves: as much is none.
    rounding: f64,
    /// In mN; none before anything is measured.
    at_first: Option<f64>,
    has_moved: bool,
    /// The norm of the forces on free nodes that nothing balances, in mN.
    pub unbalanced: f64,
    /// Relative to what is exerted.
    pub residual: f64,
}

impl Balance {
    pub fn new(rounding: f64) -> Self {
        Balance { rounding, at_first: None, has_moved: false, unbalanced: 0.0, residual: 0.0 }
    }

    /// Takes up what the whole movement would exert on nodes that stay, by the norm in mN of what the step that a part of it makes is to
    /// balance, in the first step alone. What was out of balance before is no part of that.
    pub fn moved(&mut self, load: f64, part: f64) {
        if !self.has_moved {
            let exerted = (load - self.unbalanced).max(0.0) / part;
            self.at_first = self.at_first.map(|at_first| at_first.max(exerted));
            self.has_moved = true;
        }
    }

    /// The residual of rest: 0 where rounding leaves as much.
    pub fn rest(&self) -> f64 {
        if self.unbalanced <= self.rounding { 0.0 } else { self.residual }
    }

    /// Measures tissue at positions; what acts is given by row.
    pub fn measure(
        &mut self,
        deformed: &Deformed,
        acting: &[Vector],
        constrained: &Constrained,
        pressures: Option<&Pressures>,
    ) {
        let pairs = deformed.forces.iter().zip(acting);
        let mut left: Vec<Vector> = pairs.map(|(internal, acting)| internal - acting).collect();
        let mut exerted: f64 = acting.iter().map(Vector::norm_squared).sum();
        for constraint in constrained.constraints {
            let force = &mut left[constrained.dof_map.row(constraint.node)];
            let own = constraint.part_along(force);
            *force -= own;
            exerted += own.norm_squared();
        }
        let volumes = pressures.map_or(0.0, |p| p.squared_forces(&deformed.volumes));
        self.unbalanced = (left.iter().map(Vector::norm_squared).sum::<f64>() + volumes).sqrt();
        let exerted = exerted.sqrt();
        let at_first = *self.at_first.get_or_insert(exerted.max(self.unbalanced));
        let scale = exerted.max(LEAST_SCALE * at_first);
        self.residual = if scale > 0.0 { self.unbalanced / scale } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A method that begins anew just before the end of a movement has a sliver of it to make, and much out of balance.
    #[test]
    fn what_is_out_of_balance_is_not_taken_for_what_a_movement_exerts() {
        let after = |unbalanced: f64, load: f64, part: f64| {
            let mut balance = Balance::new(0.0);
            balance.at_first = Some(2.0);
            balance.unbalanced = unbalanced;
            balance.moved(load, part);
            balance.at_first
        };
        assert_eq!(after(5.0, 5.0, 1e-11), Some(2.0));
        assert_eq!(after(0.0, 3.0, 0.5), Some(6.0));
    }
}
