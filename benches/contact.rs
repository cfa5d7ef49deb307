//! Lips of the two shared faces with the jaw raised, without contact and with it, in linear elasticity and at finite strain, as the
//! table of docs/contact.md: `cargo bench --bench contact [-- FACE … --by MM]`. Times are those of the processor, on one thread.

mod measure;

use measure::{face, process};
use mechanics::mesh::Vector;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, ContactKind, Method, Plan, Prediction, Scene, Settings, predict,
};
use mechanics::progress::Unobserved;

const RAISED_MM: [f64; 3] = [4.0, 8.0, 15.0];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let by = arguments.iter().position(|argument| argument == "--by");
    let by: Option<f64> = by.and_then(|at| arguments.get(at + 1)?.parse().ok());
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread is to be had");
    println!(
        "| face, raised by | method | s without | s with | ratio | steps without | rounds | passes | iterations | points that press |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for own in face::faces() {
        let is_named = |name: &str| arguments.iter().any(|argument| argument == name);
        if is_named("subject") != is_named("template") && !is_named(own.name) {
            continue;
        }
        let Some(mesh) = own.load() else { continue };
        let case = own.case(mesh, 0.45);
        for raised in RAISED_MM.into_iter().filter(|raised| by.is_none_or(|by| by == *raised)) {
            for method in [Method::FemLinear, Method::FemNonlinear] {
                let of = format!("{}, {raised} mm | {}", own.name, method.kind().name());
                pool.install(|| row(&case, raised, method, &of));
            }
        }
    }
}

/// The prediction of a raised jaw, and its processor time in s.
fn predicted(case: &Case, raised: f64, settings: &Settings) -> Result<(Prediction, f64), String> {
    let movement =
        RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::z() * raised);
    let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let begun = process::cpu_seconds();
    let scene = Scene::new(case, &plan, settings).map_err(|errors| format!("{errors:?}"))?;
    let found = predict(&scene, &Unobserved).map_err(|error| error.code().to_owned())?;
    let took = process::cpu_seconds() - begun;
    Ok((found, took))
}

fn row(case: &Case, raised: f64, method: Method, of: &str) {
    let free = Settings { method, ..Settings::default() };
    let pressed = Settings { contact: ContactKind::Unilateral, ..free.clone() };
    let without = predicted(case, raised, &free);
    let with = predicted(case, raised, &pressed);
    let (Ok((free, free_s)), Ok((found, s))) = (&without, &with) else {
        let ended = [without.err(), with.err()];
        return println!("| {of} | {ended:?} | | | | | | | |");
    };
    let Some(touch) = &found.contact else {
        return println!("| {of} | nothing touches | | | | | | | |");
    };
    let effort = touch.contact.effort;
    println!(
        "| {of} | {free_s:.2} | {s:.2} | {:.1} | {} | {} | {} | {} | {} |",
        s / free_s,
        free.solver.iterations,
        effort.rounds,
        effort.passes,
        effort.iterations,
        touch.contact.pressed.len(),
    );
}
