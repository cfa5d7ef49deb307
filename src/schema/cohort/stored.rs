//! Stored cohorts: operated cases, their measured outcome, and consent for learning.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Matrix4x4;
use crate::schema::code::ErrorCode;
use crate::schema::learn::document::{LearnCaseDocument, check_registration};
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::learning::cohort::LEAST_CASES;

/// The most characters of a statement of consent.
const LONGEST_STATEMENT: usize = 2000;

/// Operated cases to learn from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StoredCohortDocument {
    pub name: String,
    /// Of every member without its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub consent: Option<ConsentDocument>,
    /// At least 3, each of another patient, all in one frame.
    pub members: Vec<MemberDocument>,
}

/// Consent for learning from a member.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ConsentDocument {
    /// Legal basis, such as the number of a form or of an approval; no names of patients.
    #[schema(min_length = 1, max_length = 2000)]
    pub statement: String,
    /// Permitted uses; empty: none.
    pub uses: BTreeSet<CohortUse>,
}

/// A use of a cohort.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum CohortUse {
    /// A model that corrects predictions of other patients, by a job of kind `learn`.
    Learn,
    /// A comparison of the errors of methods, by a job of kind `cohort`.
    Compare,
}

impl CohortUse {
    pub fn name(self) -> &'static str {
        match self {
            CohortUse::Learn => "learn",
            CohortUse::Compare => "compare",
        }
    }
}

/// An operated case: its prediction and its outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MemberDocument {
    /// The id of a job of kind `predict`, whose case, plan and method are used.
    pub prediction: String,
    /// The id of a mesh after the operation: a volume with the cells of the case's, or a surface with the node ids or the
    /// triangles of its skin, which tell what corresponds.
    pub actual: String,
    /// The registration of `actual` onto the case: row-major, x' = R x + t in mm. Absent: it is registered already.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub matrix4x4: Option<Matrix4x4>,
    /// A pseudonym. Absent: its number from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    /// Class of surgery, such as `two_jaw`, for which one `theta` is fitted. Absent: the number of segments that the plan moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub class: Option<String>,
    /// By the name of a method: the id of a job on the case that compared, for jobs of kind `cohort`. All members have the same
    /// methods.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub comparisons: BTreeMap<String, String>,
    /// Replaces that of the cohort.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub consent: Option<ConsentDocument>,
}

/// A version of a cohort.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortVersionDocument {
    pub id: String,
    pub version: i64,
}

impl MemberDocument {
    /// The member as a case to learn from.
    pub fn to_case(&self, number: i64) -> LearnCaseDocument {
        LearnCaseDocument {
            prediction: self.prediction.clone(),
            actual: self.actual.clone(),
            matrix4x4: self.matrix4x4,
            name: Some(self.called(number)),
            class: self.class.clone(),
        }
    }

    /// Its name, or its number.
    pub fn called(&self, number: i64) -> String {
        self.name.as_deref().map_or_else(|| number.to_string(), |name| name.trim().to_owned())
    }

    fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let longest = limits.name_characters as usize;
        for (member, named) in [("name", &self.name), ("class", &self.class)] {
            if let Some(named) = named {
                faults.check_name(&at.key(member), named, longest);
            }
        }
        check_registration(self.matrix4x4.as_ref(), at, faults);
        let place = at.key("comparisons");
        faults.check_length(&place, self.comparisons.len(), limits.map_entries as usize);
        for method in self.comparisons.keys() {
            faults.check_name(&place.key(method), method, longest);
        }
    }
}

impl ConsentDocument {
    fn check(&self, at: &Pointer, faults: &mut Faults) {
        faults.check_name(&at.key("statement"), &self.statement, LONGEST_STATEMENT);
    }
}

impl StoredCohortDocument {
    /// Adds its faults; pointers start at its root.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let root = Pointer::root();
        faults.check_name(&root.key("name"), &self.name, limits.name_characters as usize);
        if let Some(consent) = &self.consent {
            consent.check(&root.key("consent"), faults);
        }
        let at = root.key("members");
        let count = self.members.len();
        faults.check_length(&at, count, limits.list_entries as usize);
        if count < LEAST_CASES {
            let detail = format!(
                "a cohort of {count} is too small: with one left out, two are to learn from; at least {LEAST_CASES} are needed"
            );
            faults.add(&at, ErrorCode::OutOfRange, detail);
        }
        let mut seen: [BTreeSet<String>; 3] = Default::default();
        for (index, member) in self.members.iter().enumerate() {
            let place = at.index(index);
            member.check(&place, limits, faults);
            self.check_consent(member, &place, faults);
            self.check_methods(member, &place, faults);
            let name = member.called(index as i64 + 1);
            let own =
                [("prediction", &member.prediction), ("actual", &member.actual), ("name", &name)];
            for ((key, value), seen) in own.into_iter().zip(&mut seen) {
                if !seen.insert(value.trim().to_owned()) {
                    let detail =
                        format!("{value:?} is listed twice, and every member is another patient");
                    faults.add(&place.key(key), ErrorCode::DuplicateName, detail);
                }
            }
        }
    }

    fn check_consent(&self, member: &MemberDocument, at: &Pointer, faults: &mut Faults) {
        match (&member.consent, &self.consent) {
            (Some(own), _) => own.check(&at.key("consent"), faults),
            (None, Some(_)) => {}
            (None, None) => {
                let detail = "neither the member nor the cohort states consent";
                faults.add(&at.key("consent"), ErrorCode::MissingField, detail);
            }
        }
    }

    /// Tests are in pairs: every member needs the methods of the first one.
    fn check_methods(&self, member: &MemberDocument, at: &Pointer, faults: &mut Faults) {
        let first = self.members.first().map(|first| first.comparisons.keys());
        if first.is_some_and(|first| !first.eq(member.comparisons.keys())) {
            let detail = "every member has comparisons of the same methods as the first";
            faults.add(&at.key("comparisons"), ErrorCode::OutOfRange, detail);
        }
    }
}
