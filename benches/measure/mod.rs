//! What the benches share: the shells and their standard load, the faces, yardsticks of the machine, and clocks.

#![allow(dead_code, reason = "each bench uses the parts it needs")]

pub mod face;
pub mod process;
pub mod shell;
pub mod split;
pub mod yardstick;

use std::time::Instant;

/// The median of the values; NaN of none.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Median seconds of `repeats` calls after one that warms up.
pub fn seconds(repeats: usize, mut work: impl FnMut()) -> f64 {
    work();
    let timed = (0..repeats).map(|_| {
        let begin = Instant::now();
        work();
        begin.elapsed().as_secs_f64()
    });
    median(timed.collect())
}

/// Runs work on that many threads.
pub fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("the machine has threads to give").install(work)
}
