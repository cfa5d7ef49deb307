//! Tests of the service that are counted one by one: on both kinds of deployment, on the shared one, or alone.

use libtest_mimic::Trial;

use crate::deployments::Deployment;
use crate::support::external::{Ended, Missing, trial};

/// Runs a test to its end on a runtime of its own.
fn finish<E: Ended>(test: impl Future<Output = E>) -> Result<(), Missing> {
    tokio::runtime::Runtime::new().unwrap().block_on(test).ended()
}

/// A test that makes what it needs.
pub fn alone<E, F>(module: &str, name: &str, test: fn() -> F) -> Vec<Trial>
where
    E: Ended,
    F: Future<Output = E> + 'static,
{
    vec![trial(module, name, move || finish(test()))]
}

/// A test that is given a PostgreSQL and a store of objects.
pub fn on_shared<F>(module: &str, name: &str, test: fn(Deployment) -> F) -> Vec<Trial>
where
    F: Future<Output = ()> + 'static,
{
    let test = move || {
        finish(async move {
            test(Deployment::shared().await?).await;
            Ok(())
        })
    };
    vec![trial(module, name, test)]
}

/// A test that is run with a folder and again with a PostgreSQL and a store of objects.
pub fn on_both<F>(module: &str, name: &str, test: fn(Deployment) -> F) -> Vec<Trial>
where
    F: Future<Output = ()> + 'static,
{
    let embedded = move || finish(async move { test(Deployment::embedded().await).await });
    let embedded = trial(module, &format!("embedded::{name}"), embedded);
    let mut trials = on_shared(module, &format!("shared::{name}"), test);
    trials.insert(0, embedded);
    trials
}

/// Lists the tests of a module by what each is given. A test that no list names is dead code, which the compiler tells.
macro_rules! trials {
    ($($given:ident { $($test:ident)* })*) => {
        pub fn trials() -> Vec<libtest_mimic::Trial> {
            let lists = [$($(
                $crate::support::trials::$given(module_path!(), stringify!($test), $test),
            )*)*];
            lists.into_iter().flatten().collect()
        }
    };
}
pub(crate) use trials;
