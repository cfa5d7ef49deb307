//! Fail points: named places where a test makes a process die, hang or err, by the variable `FACIES_FAULT`.
//!
//! `POINT:N:ACTION[:attempt=K][:tag=T]`, several separated by commas: at the N-th time that an attempt comes to POINT
//! (only attempt K of a job, only a job with tag T) ACTION happens. Without the variable nothing ever does.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use rustix::process::{Signal, getpid, kill_process};
use serde_json::Value;

/// The environment variable.
pub const VARIABLE: &str = "FACIES_FAULT";

/// Places in the process of a slot, then in the worker.
const POINTS: [&str; 13] = [
    "slot:start",
    "validate:begin",
    "mesh:begin",
    "assemble:begin",
    "solve:begin",
    "solve:iteration",
    "contact:begin",
    "surface:begin",
    "compare:begin",
    "write:begin",
    "publish:before",
    "publish:after",
    "claim:after",
];
const WAIT: Duration = Duration::from_millis(5);

/// Action of a fail point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Action {
    /// SIGKILL for the own process.
    Kill,
    Abort,
    /// SIGSTOP for the own process.
    Stop,
    Panic,
    /// Takes memory until there is none.
    Allocate,
    /// Calls itself until the stack is full.
    Overflow,
    /// Never returns and checks no cancellation.
    Hang,
    /// Waits until the work is cancelled, then goes on.
    Hold,
    /// An error of the storage; only before and after a publication.
    Error,
}

const ACTIONS: [(&str, Action); 9] = [
    ("kill", Action::Kill),
    ("abort", Action::Abort),
    ("stop", Action::Stop),
    ("panic", Action::Panic),
    ("allocate", Action::Allocate),
    ("overflow", Action::Overflow),
    ("hang", Action::Hang),
    ("hold", Action::Hold),
    ("error", Action::Error),
];

#[derive(Clone, Debug, PartialEq, Eq)]
struct Fault {
    point: String,
    nth: usize,
    action: Action,
    attempt: Option<i64>,
    tag: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{VARIABLE} has `{fault}`, and {wanted} is wanted there")]
pub struct FailPointError {
    fault: String,
    wanted: &'static str,
}

/// Read once; whether it can be read is asked for at the start.
static FAULTS: OnceLock<Result<Vec<Fault>, FailPointError>> = OnceLock::new();

fn faults() -> &'static [Fault] {
    let read = FAULTS.get_or_init(|| parse(&std::env::var(VARIABLE).unwrap_or_default()));
    read.as_deref().unwrap_or_default()
}

/// Whether the variable can be read; warns where it is set.
pub fn check() -> Result<(), FailPointError> {
    if !faults().is_empty() {
        tracing::warn!(faults = faults().len(), "fail points are set: this process breaks itself");
    }
    FAULTS.get().map_or(Ok(()), |read| read.clone().map(|_| ()))
}

fn parse(text: &str) -> Result<Vec<Fault>, FailPointError> {
    text.split(',').map(str::trim).filter(|fault| !fault.is_empty()).map(parse_one).collect()
}

fn parse_one(text: &str) -> Result<Fault, FailPointError> {
    let wrong = |wanted| FailPointError { fault: text.to_owned(), wanted };
    let words: Vec<&str> = text.split(':').collect();
    let [first, second, nth, action, conditions @ ..] = words.as_slice() else {
        return Err(wrong("POINT:N:ACTION"));
    };
    let point = format!("{first}:{second}");
    if !POINTS.contains(&point.as_str()) {
        return Err(wrong("a point such as solve:iteration"));
    }
    let nth = nth.parse().ok().filter(|nth| *nth > 0).ok_or_else(|| wrong("a number above 0"))?;
    let known = ACTIONS.iter().find(|(name, _)| name == action);
    let (_, action) = known.ok_or_else(|| wrong("an action such as kill"))?;
    if *action == Action::Error && !point.starts_with("publish:") {
        return Err(wrong("a publication, which alone can err,"));
    }
    let mut fault = Fault { point, nth, action: *action, attempt: None, tag: None };
    for condition in conditions {
        match condition.split_once('=') {
            Some(("attempt", value)) if value.parse::<i64>().is_ok() => {
                fault.attempt = value.parse().ok();
            }
            Some(("tag", value)) => fault.tag = Some(value.to_owned()),
            _ => return Err(wrong("attempt=K or tag=T")),
        }
    }
    Ok(fault)
}

/// The fail points of one attempt, and how often it came to each.
#[derive(Debug, Default)]
pub struct FailPoints {
    faults: Vec<(&'static Fault, AtomicUsize)>,
}

/// The storage is made to err.
#[derive(Debug)]
pub struct Injected;

impl FailPoints {
    /// Those that mean this attempt. The document is read for its tags only where a fault asks for one.
    pub fn of(attempt: i64, document: &str) -> FailPoints {
        let all = faults();
        if all.is_empty() {
            return FailPoints::default();
        }
        let tags = tags(document);
        let means = |fault: &&Fault| {
            fault.attempt.is_none_or(|wanted| wanted == attempt)
                && fault.tag.as_ref().is_none_or(|tag| tags.contains(tag))
        };
        let meant = all.iter().filter(means);
        FailPoints { faults: meant.map(|fault| (fault, AtomicUsize::new(0))).collect() }
    }

    /// Comes to a point. `told_to_stop` ends what waits for it.
    pub fn pass(&self, point: &str, told_to_stop: &dyn Fn() -> bool) -> Result<(), Injected> {
        for (fault, passed) in self.faults.iter().filter(|(fault, _)| fault.point == point) {
            if passed.fetch_add(1, Ordering::Relaxed) + 1 == fault.nth {
                tracing::warn!(point, action = ?fault.action, "a fail point strikes");
                strike(fault.action, told_to_stop)?;
            }
        }
        Ok(())
    }

    /// The same where nothing can err.
    pub fn pass_by(&self, point: &str, told_to_stop: &dyn Fn() -> bool) {
        // `Error` is refused for all but publications.
        let _ = self.pass(point, told_to_stop);
    }
}

/// The tags in the spec of a job's document, `{KIND: {"spec": {"tags": [...]}}}`.
fn tags(document: &str) -> Vec<String> {
    let document: Value = serde_json::from_str(document).unwrap_or_default();
    let kind = document.as_object().and_then(|kinds| kinds.values().next());
    let tags = kind.and_then(|kind| kind.pointer("/spec/tags")).and_then(Value::as_array);
    let tags = tags.into_iter().flatten();
    tags.filter_map(|tag| tag.as_str().map(str::to_owned)).collect()
}

#[expect(clippy::panic, reason = "to panic is what was asked for")]
fn strike(action: Action, told_to_stop: &dyn Fn() -> bool) -> Result<(), Injected> {
    match action {
        Action::Kill => signal(Signal::KILL),
        Action::Stop => signal(Signal::STOP),
        Action::Abort => std::process::abort(),
        Action::Panic => panic!("a fail point panicked"),
        Action::Allocate => {
            let mut hoard: Vec<Vec<u8>> = Vec::new();
            loop {
                hoard.push(vec![1; 16 << 20]);
                std::hint::black_box(&mut hoard);
            }
        }
        Action::Overflow => {
            std::hint::black_box(overflow(0));
        }
        Action::Hang => loop {
            std::thread::park();
        },
        Action::Hold => {
            while !told_to_stop() {
                std::thread::sleep(WAIT);
            }
        }
        Action::Error => return Err(Injected),
    }
    Ok(())
}

fn signal(signal: Signal) {
    if let Err(error) = kill_process(getpid(), signal) {
        tracing::error!(%error, "a fail point could not send a signal");
    }
}

/// Takes a page of stack for each call; the sum after it keeps the call from becoming a loop.
fn overflow(depth: u64) -> u64 {
    let page = std::hint::black_box([depth; 512]);
    if depth == u64::MAX {
        return depth;
    }
    overflow(depth + 1) + page[(depth % 512) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_read_with_their_conditions() {
        let read =
            parse("solve:iteration:50:kill:attempt=1, write:begin:1:hang:tag=poison").unwrap();
        assert_eq!(read[0].point, "solve:iteration");
        assert_eq!((read[0].nth, read[0].action), (50, Action::Kill));
        assert_eq!((read[0].attempt, &read[0].tag), (Some(1), &None));
        assert_eq!((read[1].attempt, read[1].tag.as_deref()), (None, Some("poison")));
        assert_eq!(parse(""), Ok(Vec::new()));
    }

    #[test]
    fn a_fault_that_could_never_strike_is_refused() {
        for wrong in [
            "solve:iteration:50",
            "solve:nowhere:1:kill",
            "solve:iteration:0:kill",
            "solve:iteration:x:kill",
            "solve:iteration:1:explode",
            "solve:iteration:1:error",
            "solve:iteration:1:kill:host=a",
        ] {
            let error = parse(wrong).unwrap_err().to_string();
            assert!(error.contains(VARIABLE) && error.contains(wrong), "{error}");
        }
    }

    #[test]
    fn tags_are_those_of_the_spec() {
        let document = r#"{"predict":{"case":{"tags":["no"]},"spec":{"tags":["a","b"]}}}"#;
        assert_eq!(tags(document), ["a", "b"]);
        assert!(tags("no document").is_empty());
    }
}
