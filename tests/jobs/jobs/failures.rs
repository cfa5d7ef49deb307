//! Words, class and members of a job whose equilibrium was not found, as documents carry them.

use facies::jobs::JobError;
use mechanics::prediction::{InvertedCell, ModelError, SolverError};
use serde_json::{Value, json};

fn told(error: impl Into<ModelError>) -> Value {
    let document = JobError::from(error.into()).to_document();
    serde_json::to_value(document).unwrap()
}

#[test]
fn what_a_solver_ran_into_is_reported_with_its_numbers() {
    let history = vec![1.0, 0.5];
    let stalled = SolverError::NotConverged {
        iterations: 2,
        residual: 0.5,
        wanted: 1e-6,
        history: history.clone(),
    };
    assert_eq!(
        told(stalled),
        json!({
            "type": "solver-diverged", "class": "numerical",
            "detail": "residual 5.00e-1 after 2 iterations, wanted 1.00e-6",
            "iterations": 2, "residual": 0.5, "wanted": 1e-6, "residual_history": [1.0, 0.5],
        })
    );
    let grown = SolverError::Diverged { iterations: 2, growth: 1.5, residual: 0.5, history };
    assert_eq!(
        told(grown),
        json!({
            "type": "solver-diverged", "class": "numerical",
            "detail": "diverged: the residual grew 1.500 times an iteration, to 5.0e-1 after 2",
            "iterations": 2, "growth": 1.5, "residual": 0.5, "residual_history": [1.0, 0.5],
        })
    );
    assert_eq!(
        told(SolverError::Singular { node: 7 }),
        json!({
            "type": "matrix-singular", "class": "numerical",
            "detail": "the matrix is singular at node 7", "node": 7,
        })
    );
    assert_eq!(
        told(SolverError::OverBudget { needed_mb: 20.0, allowed_mb: 10.0 }),
        json!({
            "type": "budget-exceeded", "class": "budget",
            "detail": "the problem needs about 20 MB and may take 10 MB",
            "which": "memory", "needed_mb": 20.0, "allowed_mb": 10.0,
        })
    );
    assert_eq!(
        told(SolverError::NotFinite),
        json!({
            "type": "solver-diverged", "class": "numerical",
            "detail": "the solution has values that are not finite",
        })
    );
    assert_eq!(
        told(SolverError::Stopped),
        json!({ "type": "cancelled", "class": "cancelled", "detail": "stopped on request" })
    );
}

#[test]
fn what_a_model_refuses_is_reported_as_a_mistake_of_the_input() {
    assert_eq!(
        told(InvertedCell { cell: 3 }),
        json!({
            "type": "element-inverted", "class": "input",
            "detail": "cell 3 is inverted or flat", "element": 3,
        })
    );
    assert_eq!(
        told(ModelError::StepAboveLimit { step_s: 2.0, limit_s: 1.0 }),
        json!({
            "type": "step-above-limit", "class": "input",
            "detail": "a step of 2.000e0 s grows without bound: explicit steps may take up to 1.000e0 s",
            "step_s": 2.0, "limit_s": 1.0,
        })
    );
    assert_eq!(
        told(ModelError::NoBone),
        json!({
            "type": "no-bone", "class": "input",
            "detail": "no face of the tissue lies on bone: a warp has nothing to follow",
        })
    );
}
