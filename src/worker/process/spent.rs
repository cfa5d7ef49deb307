//! Memory limit of an attempt, set by its budget, and the report when it is exceeded.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Value, json};

use super::memory::{ROOM, Usage};
use crate::jobs::TIME_OF_STUDY;
use crate::schema::ErrorCode;
use crate::schema::job::ErrorClass;
use crate::schema::predict::budget::BudgetDocument;

/// What is read of the document of a job: `budget` of its spec.
#[derive(Deserialize)]
struct Stated {
    spec: Spec,
}

#[derive(Deserialize)]
struct Spec {
    budget: Option<BudgetDocument>,
}

/// The most memory that a process may take for one attempt.
pub struct MemoryBound {
    allowed_mb: f64,
    /// Of the whole process.
    most_bytes: f64,
    looked: Instant,
}

/// The kind of input whose budget of memory is that of each row.
const OF_ROWS: &str = "study";

impl MemoryBound {
    /// That of the document of a job, beyond what its process takes already. The budget of a study is that of each of its
    /// rows, and binds none of all.
    pub fn of(document: &str, taken: Option<Usage>) -> Option<MemoryBound> {
        let stated: BTreeMap<String, Stated> = serde_json::from_str(document).ok()?;
        let (_, Stated { spec }) = stated.into_iter().find(|(kind, _)| kind != OF_ROWS)?;
        let allowed_mb = spec.budget?.memory_mb;
        let most_bytes = taken?.now_bytes as f64 + ROOM * allowed_mb * 1e6;
        Some(MemoryBound { allowed_mb, most_bytes, looked: Instant::now() })
    }

    /// Whether it is time to ask again what the process takes.
    pub fn is_time(&mut self, between: Duration) -> bool {
        let is_time = self.looked.elapsed() >= between;
        if is_time {
            self.looked = Instant::now();
        }
        is_time
    }

    /// How the job ends whose process takes so much, if that is too much.
    pub fn broken(&self, usage: Usage) -> Option<Value> {
        let (taken, most) = (usage.now_bytes as f64, self.most_bytes);
        (taken > most).then(|| over_memory(self.allowed_mb, most / 1e6, taken / 1e6))
    }
}

fn over_memory(allowed_mb: f64, most_mb: f64, taken_mb: f64) -> Value {
    json!({
        "type": ErrorCode::BudgetExceeded,
        "class": ErrorClass::Budget,
        "detail": format!(
            "memory ran out: a budget of {allowed_mb} MB lets the process take {most_mb:.0} MB, and it took {taken_mb:.0} MB"
        ),
        "which": "memory",
        "allowed_mb": allowed_mb,
    })
}

/// The error of a job with this document whose time ran out and that did not notice.
pub fn over_time(document: &str, wall_s: f64) -> Value {
    let stated: Option<BTreeMap<String, IgnoredAny>> = serde_json::from_str(document).ok();
    let is_study = stated.is_some_and(|stated| stated.contains_key(OF_ROWS));
    let how = if is_study { TIME_OF_STUDY } else { "" };
    json!({
        "type": ErrorCode::BudgetExceeded,
        "class": ErrorClass::Budget,
        "detail": format!("wall ran out: {wall_s} s are allowed by `budget`{how}"),
        "which": "wall",
        "allowed_s": wall_s,
    })
}

/// The error of a job that needed more memory than its slot has.
pub fn out_of_memory(asked_bytes: u64, limit_bytes: u64, usage: Option<Usage>) -> Value {
    let (asked_mb, limit_mb) = (megabytes(asked_bytes), megabytes(limit_bytes));
    let mut error = json!({
        "type": ErrorCode::OutOfMemory,
        "class": ErrorClass::Budget,
        "detail": format!("the job may take {limit_mb:.0} MB, and asked for {asked_mb:.3} MB more than was left"),
        "which": "memory",
        "limit_mb": limit_mb,
        "asked_mb": asked_mb,
    });
    if let Some(usage) = usage {
        error["peak_mb"] = json!(megabytes(usage.peak_bytes));
    }
    error
}

pub fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_budget_of_a_meshing_binds_its_process_and_that_of_a_study_does_not() {
        let usage = |mb: u64| Usage { now_bytes: mb * 1_000_000, peak_bytes: mb * 1_000_000 };
        let meshing =
            r#"{"meshing":{"spec":{"kind":"mesh","budget":{"wall_s":60,"memory_mb":10}}}}"#;
        let bound = MemoryBound::of(meshing, Some(usage(100))).unwrap();
        assert_eq!(bound.broken(usage(115)), None, "what it took before is not the job's");
        let error = bound.broken(usage(116)).unwrap();
        assert_eq!(
            (&error["type"], &error["which"]),
            (&json!("budget-exceeded"), &json!("memory"))
        );
        let study = r#"{"study":{"spec":{"budget":{"memory_mb":1}}}}"#;
        assert!(MemoryBound::of(study, Some(usage(100))).is_none());
        let detail = |document| over_time(document, 61.0)["detail"].as_str().unwrap().to_owned();
        assert_eq!(detail(meshing), "wall ran out: 61 s are allowed by `budget`");
        assert!(detail(study).contains("twice the `wall_s` of the study"));
    }
}
