//! External needs of tests: data, servers, tools and rights that are not part of the project. A test whose need is not met
//! counts as ignored and says why; where a variable requires the need, it fails.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use libtest_mimic::{Arguments, Completion, Failed, Trial};

/// Makes a test fail that does not find the shared data.
pub const REQUIRE_DATA: &str = "FACIES_REQUIRE_DATA";
/// Makes a test fail that cannot start a server or lacks a tool for it.
pub const REQUIRE_SERVERS: &str = "FACIES_REQUIRE_SERVERS";

/// An external need that is not met.
#[derive(Debug)]
pub struct Missing {
    pub why: String,
    /// The variable that makes it a failure, if any does.
    pub required_by: Option<&'static str>,
}

/// What a test function returns: nothing, or an external need that is not met.
pub trait Ended {
    fn ended(self) -> Result<(), Missing>;
}

impl Ended for () {
    fn ended(self) -> Result<(), Missing> {
        Ok(())
    }
}

impl Ended for Result<(), Missing> {
    fn ended(self) -> Result<(), Missing> {
        self
    }
}

/// Why tests were ignored, and how many for each reason.
static IGNORED: Mutex<BTreeMap<String, usize>> = Mutex::new(BTreeMap::new());

/// A test by the path of its module and its name, named as by the usual harness: without the name of the target.
pub fn trial<E: Ended>(
    module: &str,
    name: &str,
    test: impl FnOnce() -> E + Send + 'static,
) -> Trial {
    let inside = module.split_once("::").map_or("", |(_target, inside)| inside);
    let name = format!("{inside}::{name}");
    Trial::ignorable_test(name.trim_start_matches("::"), move || {
        let found = completion(test(), |variable| std::env::var_os(variable).is_some())?;
        if let Completion::Ignored { reason: Some(why) } = &found {
            let mut ignored = IGNORED.lock().unwrap_or_else(PoisonError::into_inner);
            *ignored.entry(why.clone()).or_default() += 1;
        }
        Ok(found)
    })
}

/// How a test that came to its end counts, where some variables are set.
pub fn completion(found: impl Ended, is_set: impl Fn(&str) -> bool) -> Result<Completion, Failed> {
    let Err(Missing { why, required_by }) = found.ended() else { return Ok(Completion::Completed) };
    if let Some(variable) = required_by.filter(|variable| is_set(variable)) {
        return Err(format!("{why}, and {variable} is set").into());
    }
    Ok(Completion::ignored_with(why))
}

/// Runs the tests that the arguments of the process ask for; at the end, a line for each reason to ignore some.
pub fn run(trials: impl IntoIterator<Item = Vec<Trial>>) -> ExitCode {
    let trials = trials.into_iter().flatten().collect();
    let conclusion = libtest_mimic::run(&Arguments::from_args(), trials);
    for (why, count) in IGNORED.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        println!("{count} ignored: {why}");
    }
    conclusion.exit_code()
}

/// Lists the tests of a module. A test that no list names is dead code, which the compiler tells.
macro_rules! trials {
    ($($test:ident)*) => {
        pub fn trials() -> Vec<libtest_mimic::Trial> {
            vec![$($crate::support::external::trial(module_path!(), stringify!($test), $test)),*]
        }
    };
}
#[allow(unused_imports, reason = "targets of the usual harness list no tests")]
pub(crate) use trials;

/// The folder of the shared data: under `FACIES_SHARED`, or under `../shared` beside the project.
fn shared_folder() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    // The crates of a workspace have one lock file, in its root.
    let root = package.ancestors().find(|folder| folder.join("Cargo.lock").exists());
    let beside = || root.unwrap_or(package).join("../shared");
    std::env::var_os("FACIES_SHARED").map_or_else(beside, PathBuf::from).join("data")
}

/// A file of the shared data.
pub fn shared_data(file: &str) -> Result<PathBuf, Missing> {
    let folder = shared_folder();
    let path = folder.join(file);
    if path.exists() {
        return Ok(path);
    }
    let missing = if folder.exists() { path } else { folder };
    let why = format!("{} is not here", missing.display());
    Err(Missing { why, required_by: Some(REQUIRE_DATA) })
}
