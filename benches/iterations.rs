//! The mass-tensor model's own iterations against the fast solver, on the face-like shells of the shared data.
//!
//! `cargo bench --bench iterations [-- SIZE … --materials abcd]` prints one row for each size, material and
//! iteration: the loosest residual, in steps of half a decade, that brings every skin node within 0.01 mm of the
//! converged answer, the iterations and the seconds it takes, from mesh in memory to displacement in memory
//! (check, assembly, setup, solve), and how many times that is of the fast solver. Each time is the
//! median of three runs, of one where a run takes longer than ten seconds. `RAYON_NUM_THREADS` sets the threads.
//! Without the data it says so and ends.

mod measure;

use std::time::Instant;

use measure::{median, shell};
use mechanics::mesh::Vector;
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::prediction::{Case, Method, ModelError, Plan, Prediction, Scene, Settings, predict};
use mechanics::progress::Unobserved;
use mechanics::solver::stationary::{Iteration, Stationary};

/// In mm, of every skin node.
const WITHIN: f64 = 0.01;

const HEAD: &str = "| shell | material | iterations | unknowns | residual | count | wall s | times fast | largest error mm |\n\
    | --- | --- | --- | --- | --- | --- | --- | --- | --- |";

fn main() {
    let mut sizes = Vec::new();
    let mut materials = "ac".to_owned();
    let mut given = std::env::args().skip(1);
    while let Some(argument) = given.next() {
        match argument.as_str() {
            "--bench" => {} // cargo says so to every bench
            "--materials" => materials = given.next().expect("--materials needs a value"),
            size => sizes.push(size.to_owned()),
        }
    }
    if sizes.is_empty() {
        sizes.push("100k".to_owned());
    }
    println!("{HEAD}");
    for size in &sizes {
        let Some(mesh) = shell::load(size) else { continue };
        for material in materials.chars().map(String::from) {
            let (case, plan) = shell::standard_load(&mesh, shell::materials(&material));
            compare(&format!("| {size} | {material} |"), &case, &plan);
        }
    }
}

/// One row for each kind of iteration.
fn compare(head: &str, case: &Case, plan: &Plan) {
    let own = |iteration| {
        Iterations::Stationary(Stationary {
            iteration,
            relative_change: None,
            most_iterations: 100_000,
        })
    };
    let (_, exact) = timed(case, plan, Iterations::Fast, 1e-12);
    let exact = exact.expect("the fast solver converges");
    let skin = shell_skin(case, plan);
    let mut fast = f64::NAN;
    for (name, iterations) in [
        ("fast", Iterations::Fast),
        ("gauss_seidel", own(Iteration::GaussSeidel)),
        ("damped_jacobi", own(Iteration::DampedJacobi)),
        ("jacobi", own(Iteration::Jacobi)),
    ] {
        match close_enough(case, plan, iterations, (&skin, &exact.displacement)) {
            Ok(Close { residual, seconds, error, found }) => {
                if name == "fast" {
                    fast = seconds;
                }
                let (unknowns, count) = (found.solver.unknowns, found.solver.iterations);
                println!(
                    "{head} {name} | {unknowns} | {residual:.0e} | {count} | {seconds:.3} | {:.1} | {error:.4} |",
                    seconds / fast
                );
            }
            Err(failed) => println!("{head} {name} | {failed} |"),
        }
    }
}

struct Close {
    residual: f64,
    seconds: f64,
    error: f64,
    found: Prediction,
}

/// The first answer within 0.01 mm as the residual is made smaller.
fn close_enough(
    case: &Case,
    plan: &Plan,
    iterations: Iterations,
    (skin, exact): (&[u32], &[Vector]),
) -> Result<Close, ModelError> {
    let mut digits = 1.0;
    loop {
        let residual = 10.0_f64.powf(-digits);
        let (seconds, found) = timed(case, plan, iterations, residual);
        let found = found?;
        let apart = |&node: &u32| (found.displacement[node as usize] - exact[node as usize]).norm();
        let error = skin.iter().map(apart).fold(0.0, f64::max);
        if error <= WITHIN {
            let more = if seconds < 10.0 { 2 } else { 0 };
            let again = (0..more).map(|_| timed(case, plan, iterations, residual).0);
            let seconds = median(again.chain([seconds]).collect());
            return Ok(Close { residual, seconds, error, found });
        }
        digits += 0.5;
    }
}

/// Seconds from mesh to displacement.
fn timed(
    case: &Case,
    plan: &Plan,
    iterations: Iterations,
    relative_residual: f64,
) -> (f64, Result<Prediction, ModelError>) {
    let method = Method::MassTensor(MassTensorSettings { iterations });
    let settings = Settings { method, relative_residual, ..Settings::default() };
    let begin = Instant::now();
    let scene = Scene::new(case, plan, &settings).expect("the standard load is valid");
    let found = predict(&scene, &Unobserved);
    (begin.elapsed().as_secs_f64(), found)
}

/// Nodes of the skin.
fn shell_skin(case: &Case, plan: &Plan) -> Vec<u32> {
    let scene = Scene::new(case, plan, &Settings::default()).expect("the standard load is valid");
    scene.skin.surface.node_ids.clone().unwrap_or_default()
}
