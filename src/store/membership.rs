//! Membership in cohorts: removal with erased cases, and the models learned from a member.

use super::database::{Transaction, query};
use super::made::column;

/// A job is either accepted before its cohort goes, or finds it gone.
const LEARN: &str = "INSERT INTO cohort_models (cohort_id, job_id, version) VALUES ($1, $2, $3)";

/// Cohorts that lose a member with a case or with a prediction.
#[derive(Clone, Copy, Debug)]
pub(super) enum Leaving<'a> {
    Case(&'a str),
    Prediction(&'a str),
}

struct LeavingSql {
    lock: &'static str,
    note: &'static str,
    advance: &'static str,
    leave: &'static str,
}

macro_rules! leaving {
    ($members:literal) => {
        LeavingSql {
            lock: concat!(
                "SELECT id FROM cohorts WHERE id IN (SELECT cohort_id FROM cohort_members WHERE ",
                $members,
                ") ORDER BY id FOR UPDATE"
            ),
            note: concat!(
                "INSERT INTO cohort_left (cohort_id, case_id, version) \
                 SELECT cohort_id, case_id, cohorts.version + 1 \
                 FROM cohort_members JOIN cohorts ON cohorts.id = cohort_id WHERE ",
                $members,
                " ON CONFLICT DO NOTHING"
            ),
            advance: concat!(
                "UPDATE cohorts SET version = version + 1, updated = (SELECT now_ms FROM clock) \
                 WHERE id IN (SELECT cohort_id FROM cohort_members WHERE ",
                $members,
                ")"
            ),
            leave: concat!("DELETE FROM cohort_members WHERE ", $members),
        }
    };
}

impl<'a> Leaving<'a> {
    fn id(self) -> &'a str {
        match self {
            Leaving::Case(id) | Leaving::Prediction(id) => id,
        }
    }

    fn sql(self) -> LeavingSql {
        match self {
            // Its models go with it, and what these corrected, be it of another member.
            Leaving::Case(_) => leaving!(
                "case_id = $1 OR job_id IN (SELECT job_id FROM job_cases WHERE case_id = $1)"
            ),
            Leaving::Prediction(_) => leaving!("job_id = $1"),
        }
    }
}

/// Holds the cohorts that are left; false where there are none.
pub(super) async fn hold_cohorts(
    transaction: &mut Transaction,
    leaving: Leaving<'_>,
) -> Result<bool, sqlx::Error> {
    Ok(!column(transaction, leaving.sql().lock, leaving.id()).await?.is_empty())
}

/// Takes members out of every cohort, each of which is held and has another version from then on.
pub(super) async fn leave(
    transaction: &mut Transaction,
    leaving: Leaving<'_>,
) -> Result<(), sqlx::Error> {
    let LeavingSql { note, advance, leave, .. } = leaving.sql();
    for step in [note, advance, leave] {
        query(step).bind(leaving.id()).execute(&mut *transaction).await?;
    }
    Ok(())
}

/// Remembers which version of a cohort a job learns from.
pub(super) async fn learn(
    transaction: &mut Transaction,
    job: &str,
    (cohort, version): (&str, i64),
) -> Result<(), sqlx::Error> {
    query(LEARN).bind(cohort).bind(job).bind(version).execute(&mut *transaction).await?;
    Ok(())
}

/// Forgets a model that was removed for its own sake.
pub(super) async fn forget_model(
    transaction: &mut Transaction,
    job: &str,
) -> Result<(), sqlx::Error> {
    query("DELETE FROM cohort_models WHERE job_id = $1").bind(job).execute(transaction).await?;
    Ok(())
}
