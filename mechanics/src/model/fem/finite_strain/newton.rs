//! Newton's method that moves the bones and brings the tissue to rest in the same steps (docs/methods.md#newton).
//!
//! At x, with the share s of the movement made: K d_f = -f_f - K_fb d_b with d_b on the rest of the way, then x <- x + t d,
//! s <- s + t ds, t the longest step in which every cell keeps a share of its volume; pressures p <- p + t d_p alike, and mean volume
//! changes of hexahedra and wedges (`bricks`). Once s = 1 the energy has to fall too, where neither makes of its least a saddle.

use super::balance::Balance;
use super::direction::{Direction, Directions, Remaining, inner_tolerance_at_rest};
use super::newton_state::{Ending, NewtonExits, Question, Rest, Start, advanced};
use super::tissue::{Deformed, Rounding, Tissue};
use super::touching::Touching;
use crate::mesh::Vector;
use crate::model::problem::{LoadCase, ModelError};
use crate::solver::{NewtonReport, SolveReport, SolverError, tell};

/// Relative residual of the linear system of a step while bones move, without pressures and with them.
const ADVANCING: f64 = 0.01;
const ADVANCING_MIXED: f64 = 0.003;

/// Steps this short, this often one after the other, are a standstill.
const SHORT: f64 = 0.01;
const MOST_SHORT: usize = 5;

/// With pressures, and where only pressed cells keep bulk modulus, steps this short, this often in all, are a jam, and so is a system
/// that is not solved in its iterations.
const JAMMED: f64 = 0.1;
const MOST_JAMMED: usize = 3;

/// The least share of the movement that is tried at once.
const LEAST_AHEAD: f64 = 1e-3;

/// The share of the slope by which the energy has to fall, and how often a step is halved for it.
const ENOUGH: f64 = 1e-4;
const MOST_HALVINGS: usize = 30;

/// The relative residual at which tissue is near rest, and the share of its volume that a cell has to have there for all of its bulk
/// modulus to be shared.
const NEAR: f64 = 0.01;
const ROOMY: f64 = 0.2;

pub(super) struct Newton<'a, 'b> {
    tissue: &'b Tissue<'a>,
    question: Question<'a>,
    directions: Directions,
    x: Vec<Vector>,
    p: Vec<f64>,
    /// The mean volume change that each hexahedron and wedge has of its own; empty where none takes volume as a mean.
    means: Vec<f64>,
    made: f64,
    /// How much of the movement the next step tries.
    ahead: f64,
    touching: Option<Touching<'a>>,
    /// Steps in a row that were short, and steps that were rather short in all.
    short: usize,
    jammed: usize,
    /// Whether a tangent was not positive definite since the tissue was last near rest.
    unsettled: bool,
    rounding: Rounding,
    balance: Balance,
    history: Vec<f64>,
    /// The share that was made before each step.
    path: Vec<f64>,
    halved: usize,
}

impl<'a, 'b> Newton<'a, 'b> {
    pub fn new(
        tissue: &'b Tissue<'a>,
        directions: Directions,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Self {
        let pressures = directions.pressures.as_ref();
        Newton {
            tissue,
            question,
            x: start.x,
            p: pressures.map_or_else(Vec::new, |p| p.of_log_volumes(&start.log_volumes)),
            means: if question.by_energy { Vec::new() } else { tissue.means_from(start.means) },
            directions,
            made: start.made,
            ahead: start.touching.as_ref().map_or(1.0, |touching| touching.most_ahead),
            touching: start.touching,
            short: 0,
            jammed: 0,
            unsettled: false,
            balance: Balance::new(tissue.rounding().force),
            rounding: tissue.rounding(),
            history: start.history,
            path: start.path,
            halved: 0,
        }
    }

    /// Goes on until rest is found or what else ends it, or says why it is not found.
    pub fn solve(mut self, until: NewtonExits) -> Result<Ending<'a>, ModelError> {
        let Question { constrained, share, most_steps, tolerance, progress, .. } = self.question;
        let wanted = tolerance.relative_residual;
        loop {
            let tissue = self.tissue;
            let pressures = self.directions.pressures.as_ref();
            let deformed = tissue.on_the_way(&self.x, &self.p, pressures, &self.means);
            let contact_rests = self.look();
            let pressures = self.directions.pressures.as_ref();
            self.balance.measure(&deformed, &self.acting(), constrained, pressures);
            let residual = self.balance.residual;
            self.history.push(residual);
            self.path.push(self.made);
            tell(progress, self.history.len(), residual, wanted)?;
            let rests = self.balance.rest() <= wanted;
            if self.made >= share && rests && contact_rests {
                return Ok(Ending::Rest(Box::new(self.rest()?)));
            }
            let is_near = self.made >= share && residual <= NEAR;
            if until.near && is_near {
                let pressed = deformed.pressed(ROOMY);
                // Another beginning may take contact on another way: with it only where no cell is pressed.
                if self.touching.is_none() || !pressed.contains(&true) {
                    return Ok(Ending::Near(self.reached(), pressed));
                }
            }
            if self.history.len() > most_steps {
                return Err(self.no_rest(&deformed));
            }
            self.step(&deformed)?;
            if until.jammed && self.jammed >= MOST_JAMMED {
                return Ok(Ending::Jam(self.reached()));
            }
        }
    }

    fn rest(mut self) -> Result<Rest<'a>, ModelError> {
        let tissue = self.tissue;
        let deformed = tissue.at(&self.x, &self.p, self.directions.pressures.as_ref());
        let report = self.report(&deformed)?;
        let forces = deformed.forces;
        let Newton { x: positions, p: pressures, means, made, directions, touching, .. } = self;
        Ok(Rest { positions, pressures, means, made, forces, report, directions, touching })
    }

    /// The state reached, which is measured again where it is gone on from.
    fn reached(mut self) -> Start<'a> {
        self.history.pop();
        self.path.pop();
        let pressures = self.directions.pressures.as_ref();
        let log_volumes = pressures.map_or_else(Vec::new, |own| own.log_volumes(&self.p));
        let tally = self.directions.tally;
        let Newton { x, means, made, history, path, touching, .. } = self;
        Start { x, log_volumes, means, made, history, path, tally, touching }
    }

    /// One step: a direction, how far, and the same of the movement of the bones.
    fn step(&mut self, deformed: &Deformed) -> Result<(), ModelError> {
        let Question { share, out_of_balance, .. } = self.question;
        let rests = self.unsettled && self.balance.residual > out_of_balance;
        let ahead = if rests { 0.0 } else { self.ahead.min(share - self.made) };
        let direction = self.direction(deformed, ahead)?;
        if direction.is_convex || self.means.is_empty() {
            return self.take(deformed, direction, ahead);
        }
        // Where the tangent is not positive definite the energy says how far to go, which is that of the positions alone.
        self.directions.tally.indefinite -= 1;
        self.means.clear();
        let deformed = self.tissue.at(&self.x, &self.p, self.directions.pressures.as_ref());
        let direction = self.direction(&deformed, ahead)?;
        self.take(&deformed, direction, ahead)?;
        self.means = self.tissue.means_at(&self.x);
        Ok(())
    }

    /// Goes along a direction that makes so much more of the movement.
    fn take(
        &mut self,
        deformed: &Deformed,
        direction: Direction,
        ahead: f64,
    ) -> Result<(), ModelError> {
        let Question { share, out_of_balance, .. } = self.question;
        let is_out = self.balance.residual > out_of_balance;
        self.unsettled = !direction.is_convex || (self.unsettled && is_out);
        let longest = self.tissue.longest_step(&self.x, &direction.positions);
        if let Some(touching) = &mut self.touching {
            touching.press(direction.multipliers);
        }
        let taken = match ahead > 0.0 {
            true => longest,
            false if self.is_saddle() => longest,
            false => self.falling(deformed, &direction.positions, longest)?,
        };
        self.x.iter_mut().zip(&direction.positions).for_each(|(x, d)| *x += d * taken);
        self.p.iter_mut().zip(&direction.pressures).for_each(|(p, d)| *p += d * taken);
        deformed.bricks.advance(&direction.positions, taken, &mut self.means);
        if ahead > 0.0 {
            self.balance.moved(direction.load, ahead);
            self.made = advanced(self.made, taken * ahead, share);
            let most = self.touching.as_ref().map_or(1.0, |touching| touching.most_ahead);
            self.ahead = (2.0 * taken * ahead).max(LEAST_AHEAD).min(most);
        }
        self.short = if taken < SHORT { self.short + 1 } else { 0 };
        let may_jam = self.has_pressures() || self.tissue.shares_all;
        self.jammed += usize::from(may_jam && taken < JAMMED);
        if !direction.is_met {
            self.jammed = MOST_JAMMED;
        }
        match self.short > MOST_SHORT {
            true => Err(self.standstill(deformed)),
            false => Ok(()),
        }
    }

    /// Whether the least energy is a saddle of what the steps go to.
    fn is_saddle(&self) -> bool {
        self.has_pressures() || !self.means.is_empty() || self.touching.is_some()
    }

    fn has_pressures(&self) -> bool {
        self.directions.pressures.is_some()
    }

    fn direction(&mut self, deformed: &Deformed, ahead: f64) -> Result<Direction, SolverError> {
        let (case, nodes) = (self.remaining(deformed, ahead), self.positions());
        let displacement = self.displacement();
        let (volumes, relative) = (&*deformed.volumes, self.inner_tolerance());
        let unbalanced = self.balance.unbalanced;
        let remaining = Remaining {
            case: &case,
            volumes,
            nodes: &nodes,
            displacement: &displacement,
            share: self.made + ahead,
            relative,
            unbalanced,
            progress: self.question.progress,
        };
        let touching = self.touching.as_mut();
        self.directions.of(deformed, self.question.constrained, &remaining, touching)
    }

    fn inner_tolerance(&self) -> f64 {
        if self.made < self.question.share {
            return if self.has_pressures() { ADVANCING_MIXED } else { ADVANCING };
        }
        let last = self.history.iter().rev().nth(1).copied().unwrap_or(1.0);
        let wanted = self.question.tolerance.relative_residual;
        inner_tolerance_at_rest([last, self.balance.residual], wanted, 2.0 * ADVANCING)
    }

    /// What of movement and load is made in this step, with the forces that are not balanced yet, for each node.
    fn remaining(&self, deformed: &Deformed, ahead: f64) -> LoadCase {
        let Question { constrained, case, .. } = self.question;
        let share = self.made + ahead;
        let row = |node: u32| constrained.dof_map.row(node);
        let held = constrained.constraints.iter().zip(&case.held).map(|(constraint, target)| {
            let moved = self.x[row(constraint.node)] - self.tissue.rest[row(constraint.node)];
            let own = constraint.axes().transpose() * moved;
            Vector::from_fn(|k, _| match k < constraint.count() {
                true if share < 1.0 => (target[k] - own[k]) * ahead / (1.0 - self.made),
                true => target[k] - own[k],
                false => 0.0,
            })
        });
        let mut forces = self.acting_on_nodes(share.min(1.0));
        for (force, &row) in forces.iter_mut().zip(&constrained.dof_map.ordering.place) {
            *force -= deformed.forces_of_step()[row as usize];
        }
        LoadCase { held: held.collect(), forces, ..LoadCase::default() }
    }

    /// The longest part of a step with bones at rest that lets the energy fall.
    fn falling(
        &mut self,
        deformed: &Deformed,
        step: &[Vector],
        longest: f64,
    ) -> Result<f64, SolverError> {
        let along = |forces: &[Vector]| -> f64 {
            forces.iter().zip(step).map(|(force, d)| force.dot(d)).sum()
        };
        let (pull, work) = (along(&deformed.forces), along(&self.acting()));
        let (energy, mut taken) = (self.tissue.energy(&self.x), longest);
        for _ in 0..MOST_HALVINGS {
            let there: Vec<Vector> = self.x.iter().zip(step).map(|(x, d)| x + d * taken).collect();
            let change = self.tissue.energy(&there) - energy - taken * work;
            if change <= ENOUGH * taken * (pull - work) + self.rounding.energy {
                return Ok(taken);
            }
            taken *= 0.5;
            self.halved += 1;
        }
        Err(self.not_converged())
    }

    /// What acts so far, by row.
    fn acting(&self) -> Vec<Vector> {
        self.question.constrained.dof_map.by_row(&self.acting_on_nodes(self.made))
    }

    /// A share of the loads, and what presses, in mN.
    fn acting_on_nodes(&self, share: f64) -> Vec<Vector> {
        let loads = &self.question.case.forces;
        let mut forces: Vec<Vector> = loads.iter().map(|f| f * share).collect();
        if let Some(touching) = &self.touching {
            let pressing = touching.forces(forces.len());
            forces.iter_mut().zip(&pressing).for_each(|(force, pressing)| *force += pressing);
        }
        forces
    }

    /// Looks for what touches; whether contact leaves nothing to do.
    fn look(&mut self) -> bool {
        let displacement = self.displacement();
        let Some(touching) = &mut self.touching else { return true };
        touching.look(&displacement, self.made, self.made >= self.question.share);
        touching.rests(&displacement, self.made)
    }

    /// Of the nodes.
    fn displacement(&self) -> Vec<Vector> {
        let rest = &self.tissue.rest;
        let places = self.question.constrained.dof_map.ordering.place.iter();
        places.map(|&row| self.x[row as usize] - rest[row as usize]).collect()
    }

    /// Of the nodes.
    fn positions(&self) -> Vec<Vector> {
        let places = self.question.constrained.dof_map.ordering.place.iter();
        places.map(|&row| self.x[row as usize]).collect()
    }

    /// Why there is no rest after so many steps: forces out of balance, contact, or bones on their way.
    fn no_rest(&mut self, deformed: &Deformed) -> ModelError {
        if self.balance.rest() > self.question.tolerance.relative_residual {
            return self.not_converged().into();
        }
        let (displacement, steps) = (self.displacement(), self.history.len());
        let Some(touching) = self.touching.as_mut().filter(|_| self.made >= self.question.share)
        else {
            return self.standstill(deformed);
        };
        touching.alternates(&displacement, self.made, steps, self.balance.residual)
    }

    fn not_converged(&self) -> SolverError {
        SolverError::NotConverged {
            iterations: self.history.len(),
            residual: self.balance.residual,
            wanted: self.question.tolerance.relative_residual,
            history: self.history.clone(),
        }
    }

    fn standstill(&self, deformed: &Deformed) -> ModelError {
        let least_det_f = deformed.least_volume();
        ModelError::Standstill { made: self.made, steps: self.history.len(), least_det_f }
    }

    fn report(&mut self, deformed: &Deformed) -> Result<SolveReport, SolverError> {
        let is_stable = self.directions.is_stable(
            deformed,
            self.question.constrained,
            &self.positions(),
            self.question.progress,
        )?;
        // What presses holds what is not stable without it.
        let presses = self.touching.as_ref().is_some_and(Touching::presses);
        let is_stable = is_stable.filter(|is_stable| *is_stable || !presses);
        let tally = self.directions.tally;
        let (mut energy, mut unknowns) =
            (deformed.energy(&self.x), self.question.constrained.free_unknowns());
        if let Some(pressures) = &self.directions.pressures {
            energy += pressures.energy(&self.p);
            unknowns += pressures.count();
        }
        Ok(SolveReport {
            method: "newton",
            preconditioner: "multigrid",
            why: format!("tissue at finite strain, {} halvings for the energy", self.halved),
            unknowns,
            iterations: self.history.len() - 1,
            relative_residual: self.balance.rest(),
            wanted_residual: self.question.tolerance.relative_residual,
            history: self.history.clone(),
            steps: 1,
            newton: Some(NewtonReport {
                energy,
                least_det_f: deformed.least_volume(),
                path: self.path.clone(),
                inner_iterations: tally.inner,
                hierarchies: tally.hierarchies,
                indefinite_steps: tally.indefinite,
                is_stable,
                bulk_in_cells: self.tissue.bulk_in_cells,
                cells_with_bulk: self.tissue.cells_with_bulk,
                parts: Vec::new(),
                load_steps: Vec::new(),
            }),
        })
    }
}
