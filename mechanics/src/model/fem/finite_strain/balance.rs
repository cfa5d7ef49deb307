//! Measure of rest: forces on free unknowns that nothing balances, against what holds and loads exert.

use super::pressures::Pressures;
use super::tissue::Deformed;
use crate::mesh::Vector;
use crate::model::dofs::Constrained;

/// Forces are measured against what holds and loads exert, at least this share of the most on the way: tissue that is turned
/// as a whole exerts nothing in the end. Rest is measured against this share of what the movement would exert on nodes that
/// stay, too.
const LEAST_SCALE: f64 = 1e-3;

/// |f_free| / |f_held|, with the forces that volumes left over by pressures stand for.
pub(super) struct Balance {
    /// The norm of forces in mN that rounding leaves: as much is none.
    rounding: f64,
    /// The largest norm of the forces of holds and loads on the way, in mN.
    most_exerted: f64,
    /// The largest norm of what a part of the movement would exert on nodes that stay, in mN.
    most_moved: f64,
    /// The norm of the forces on free nodes that nothing balances, in mN.
    pub unbalanced: f64,
    /// What they are relative to, in mN.
    scale: f64,
    /// Relative to what is exerted.
    pub residual: f64,
}

impl Balance {
    pub fn new(rounding: f64) -> Self {
        Balance {
            rounding,
            most_exerted: 0.0,
            most_moved: 0.0,
            unbalanced: 0.0,
            scale: 0.0,
            residual: 0.0,
        }
    }

    /// Takes up the norm in mN of what a part of the movement would exert on nodes that stay.
    pub fn moved(&mut self, load: f64) {
        self.most_moved = self.most_moved.max(load);
    }

    /// The residual of rest: 0 where rounding leaves as much.
    pub fn rest(&self) -> f64 {
        match self.unbalanced <= self.rounding {
            true => 0.0,
            false => self.unbalanced / self.scale.max(LEAST_SCALE * self.most_moved),
        }
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
        for hold in constrained.holds {
            let force = &mut left[constrained.numbering.row(hold.node)];
            let own = hold.part_along(force);
            *force -= own;
            exerted += own.norm_squared();
        }
        let volumes = pressures.map_or(0.0, |p| p.squared_forces(&deformed.volumes));
        self.unbalanced = (left.iter().map(Vector::norm_squared).sum::<f64>() + volumes).sqrt();
        self.most_exerted = self.most_exerted.max(exerted.sqrt());
        self.scale = exerted.sqrt().max(LEAST_SCALE * self.most_exerted);
        self.residual = if self.scale > 0.0 { self.unbalanced / self.scale } else { 0.0 };
    }
}
