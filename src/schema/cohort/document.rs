//! The spec of a cohort: comparisons of the same subjects by several methods.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::compare::result::{ComparisonDocument, StatDocument};
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;

/// `cohort`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum CohortKind {
    #[default]
    Cohort,
}

/// Comparisons with scans, of the same subjects in each group, held against each other in pairs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CohortDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: CohortKind,
    /// By the name of a method: the id of a job that compared, for each subject in the same order.
    pub groups: BTreeMap<String, Vec<String>>,
    /// Names of the subjects; absent: their numbers from 1.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub subjects: Vec<String>,
    #[serde(default)]
    pub distance: CohortDistance,
    /// A region of every comparison, of which closest points are told; absent: the whole surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<String>,
    /// The number of each subject that is tested and drawn as a box.
    #[serde(default)]
    pub statistic: CohortStatistic,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// Which distances of a comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CohortDistance {
    /// Of closest points, both ways, by area.
    #[default]
    ClosestPoint,
    /// Of points of the same number.
    NodeWise,
    /// Of points by thin-plate spline and closest point.
    TpsCp,
}

/// A number of a distribution of distances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum CohortStatistic {
    #[default]
    Mean,
    Rms,
    Median,
    P90,
    P95,
    Max,
}

impl CohortStatistic {
    pub fn of(self, row: &StatDocument) -> f64 {
        match self {
            CohortStatistic::Mean => row.mean,
            CohortStatistic::Rms => row.rms,
            CohortStatistic::Median => row.median,
            CohortStatistic::P90 => row.p90,
            CohortStatistic::P95 => row.p95,
            CohortStatistic::Max => row.max,
        }
    }
}

impl CohortDocument {
    /// Adds what is wrong with it; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        let place = at.key("groups");
        faults.check_length(&place, self.groups.len(), limits.map_entries as usize);
        if self.groups.is_empty() {
            faults.add(&place, ErrorCode::MissingField, "a cohort has at least one group");
        }
        let subjects = self.groups.values().next().map_or(0, Vec::len);
        for (name, jobs) in &self.groups {
            let place = place.key(name);
            faults.check_name(&place, name, limits.name_characters as usize);
            faults.check_length(&place, jobs.len(), limits.list_entries as usize);
            if jobs.is_empty() || jobs.len() != subjects {
                let detail = format!(
                    "every group has the same subjects: here are {}, in the first group {subjects}",
                    jobs.len()
                );
                faults.add(&place, ErrorCode::OutOfRange, detail);
            }
        }
        self.check_subjects(subjects, &at, limits, faults);
        if self.region.is_some() && self.distance != CohortDistance::ClosestPoint {
            let detail = "of a region closest points are told, and nothing else";
            faults.add(&at.key("region"), ErrorCode::UnknownField, detail);
        }
    }

    fn check_subjects(&self, count: usize, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let at = at.key("subjects");
        if !self.subjects.is_empty() && self.subjects.len() != count {
            let detail = format!("{count} subjects have {} names", self.subjects.len());
            faults.add(&at, ErrorCode::OutOfRange, detail);
        }
        let mut names = BTreeSet::new();
        for (index, name) in self.subjects.iter().enumerate() {
            faults.check_name(&at.index(index), name, limits.name_characters as usize);
            if !names.insert(name) {
                let detail = format!("subject `{name}` is named more than once");
                faults.add(&at.index(index), ErrorCode::DuplicateName, detail);
            }
        }
    }

    /// The jobs with their places, in the order of the groups.
    pub fn jobs(&self) -> impl Iterator<Item = (Pointer, &String)> {
        let at = Pointer::root().key("groups");
        self.groups.iter().flat_map(move |(name, jobs)| {
            let at = at.key(name);
            jobs.iter().enumerate().map(move |(index, job)| (at.index(index), job))
        })
    }

    /// The distances of a comparison that are asked for; nothing where it has none.
    pub fn row(&self, comparison: &ComparisonDocument) -> Option<StatDocument> {
        match (self.distance, &self.region) {
            (CohortDistance::ClosestPoint, None) => Some(comparison.both.to_stat()),
            (CohortDistance::ClosestPoint, Some(region)) => {
                comparison.regions.get(region).map(|region| region.both.to_stat())
            }
            (CohortDistance::NodeWise, _) => comparison.node_wise.as_ref().map(|own| own.nodes),
            (CohortDistance::TpsCp, _) => comparison.tps_cp.as_ref().map(|own| own.nodes),
        }
    }
}
