//! Movements at finite strain that find no rest at once, and find it in parts.

use std::sync::Mutex;

use mechanics::model::fem::finite_strain::Elements;
use mechanics::model::problem::ModelError;
use mechanics::progress::{Phase, Progress, Unobserved};
use mechanics::solver::SolverError;

use super::finite_strain::{hard_block, neo_hookean, rest_of};

/// 54 mm and 30 degrees, with no free ring around what is moved.
fn hardest(progress: &dyn Progress) -> Result<mechanics::model::problem::Equilibrium, ModelError> {
    let (mesh, held) = hard_block([20, 20, 4], 2.0, 0.0);
    rest_of(Elements::STABLE, &mesh, neo_hookean(0.46), &held, progress)
}

#[test]
fn a_movement_without_rest_at_once_rests_in_parts_which_are_reported() {
    let moved = hardest(&Unobserved).unwrap();
    let newton = moved.solver.newton.unwrap();
    let shares: Vec<f64> = newton.parts.iter().map(|rest| rest.share).collect();
    assert!(shares.len() > 1 && shares.is_sorted() && shares.last() == Some(&1.0), "{shares:?}");
    assert!(newton.parts.iter().all(|rest| rest.least_det_f > 0.0 && rest.steps > 0));
    assert!(newton.parts.is_sorted_by(|before, after| before.energy < after.energy));
    let steps: usize = newton.parts.iter().map(|rest| rest.steps).sum();
    assert_eq!([steps, steps + 1], [moved.solver.iterations, newton.path.len()]);
    let last = newton.parts.last().unwrap();
    assert_eq!((last.energy, last.least_det_f), (newton.energy, newton.least_det_f));
    assert!(moved.solver.relative_residual <= 1e-7 && newton.bulk_in_cells == 4.0);
}

#[test]
fn what_rests_at_once_has_no_parts() {
    let (mesh, held) = hard_block([20, 20, 4], 1.0, 0.0);
    let moved = rest_of(Elements::STABLE, &mesh, neo_hookean(0.46), &held, &Unobserved).unwrap();
    assert!(moved.solver.newton.unwrap().parts.is_empty());
}

/// Stops so many iterations after the second beginning.
struct StopsInParts {
    told: Mutex<Vec<usize>>,
    later: usize,
}

impl StopsInParts {
    fn since_parts(&self) -> usize {
        let told = self.told.lock().unwrap();
        let again = told.iter().rposition(|&iteration| iteration == 1).unwrap_or(0);
        if again > 0 { told.len() - again } else { 0 }
    }
}

impl Progress for StopsInParts {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, iteration: usize, _relative_residual: f64, _wanted: f64) {
        self.told.lock().unwrap().push(iteration);
    }

    fn is_cancelled(&self) -> bool {
        self.since_parts() >= self.later
    }
}

#[test]
fn a_movement_in_parts_stops_when_cancelled() {
    let progress = StopsInParts { told: Mutex::default(), later: 5 };
    let ended = hardest(&progress);
    assert!(matches!(ended, Err(ModelError::Solver(SolverError::Stopped))));
    assert_eq!(progress.since_parts(), 5);
}
