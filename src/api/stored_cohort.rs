//! A stored cohort named by a job: its present members, each with consent for this use.

use std::collections::BTreeMap;

use super::Service;
use super::accepted::fault;
use super::error::{ApiError, ApiResult};
use super::parameters::id;
use crate::schema::cohort::stored::{
    CohortUse, CohortVersionDocument, ConsentDocument, MemberDocument,
};
use crate::schema::{CohortDocument, ErrorCode, LearnDocument};

/// A stored cohort in its present version, with consent of all members for this use.
pub struct Members {
    pub version: CohortVersionDocument,
    /// With their numbers.
    members: Vec<(i64, MemberDocument)>,
}

impl Members {
    pub async fn of(service: &Service, cohort: &str, asked: CohortUse) -> ApiResult<Members> {
        const AT: &str = "/cohort";
        let row = match id(cohort) {
            Some(id) => service.store.cohort(&id).await?,
            None => None,
        };
        let unknown = || {
            let detail = "there is no such cohort: GET /v1/cohorts lists the existing ones";
            fault(AT, ErrorCode::UnknownCohort, detail)
        };
        let row = row.ok_or_else(unknown)?;
        let of_all: Option<ConsentDocument> = row
            .consent
            .as_deref()
            .map(|text| parsed("the consent of cohort", &row.id, text))
            .transpose()?;
        let mut members = Vec::new();
        for stored in service.store.cohort_members(&row.id).await? {
            let what = format!("member {} of cohort", stored.number);
            let member: MemberDocument = parsed(&what, &row.id, &stored.document)?;
            let consent = member.consent.as_ref().or(of_all.as_ref());
            if !consent.is_some_and(|consent| consent.uses.contains(&asked)) {
                let (name, word) = (member.called(stored.number), asked.name());
                let detail = format!("member {name:?} is not to be used for `{word}`");
                return Err(fault(AT, ErrorCode::NotConsented, &detail));
            }
            members.push((stored.number, member));
        }
        let version = CohortVersionDocument { id: row.id, version: row.version };
        Ok(Members { version, members })
    }

    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// States the members as cases to learn from.
    pub fn learn(&self, spec: &mut LearnDocument) {
        spec.cohort = None;
        spec.cases = self.members.iter().map(|(number, own)| own.to_case(*number)).collect();
    }

    /// States the members as subjects, and their comparisons as groups.
    pub fn compare(&self, spec: &mut CohortDocument) {
        spec.cohort = None;
        spec.subjects = self.members.iter().map(|(number, own)| own.called(*number)).collect();
        let mut groups: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for (method, job) in self.members.iter().flat_map(|(_, own)| &own.comparisons) {
            groups.entry(method.clone()).or_default().push(job.clone());
        }
        spec.groups = groups;
    }
}

fn parsed<T: serde::de::DeserializeOwned>(what: &str, id: &str, text: &str) -> ApiResult<T> {
    serde_json::from_str(text).map_err(ApiError::unreadable(what, id))
}
