//! The spec of a cohort: comparisons of the same subjects by several methods.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::compare::result::{ComparisonDocument, StatDocument};
use crate::schema::predict::budget::BudgetDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use mechanics::learning::virtual_cohort::PARTS;
use mechanics::mesh::ignored::listed;

/// The most twins: p is exact up to this number.
const MOST_TWINS: f64 = 25.0;

/// The largest integer of all clients.
const MOST_SEED: f64 = 2_147_483_647.0;

/// `cohort`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum CohortKind {
    #[default]
    Cohort,
}

/// Comparisons with scans, of the same subjects in each group, tested in pairs. Exactly one of `groups`,
/// `cohort` and `virtual`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CohortDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: CohortKind,
    /// By the name of a method: the id of a job that compared, for each subject in the same order.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub groups: BTreeMap<String, Vec<String>>,
    /// The id of a stored cohort, in its present version: its members are the subjects, and the methods of their `comparisons` the
    /// groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cohort: Option<String>,
    /// Generated twins, with four models as groups; distances are of nodes.
    #[serde(default, rename = "virtual", skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub made: Option<TwinsDocument>,
    /// Names of the subjects; absent: their numbers from 1.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub subjects: Vec<String>,
    #[serde(default)]
    pub distance: CohortDistance,
    /// A region of every comparison, for distances by closest points; of twins `nose`, `lips`, `chin` or `cheeks`.
    /// Absent: the whole surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<String>,
    /// The statistic of each subject that is tested and drawn as a box.
    #[serde(default)]
    pub statistic: CohortStatistic,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// Operated twins of the generic face, deterministic by their numbers: one tissue or muscles along their fibres in it, glued to
/// the teeth or sliding along them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TwinsDocument {
    #[schema(minimum = 3, maximum = 25)]
    pub patients: u32,
    #[serde(default)]
    #[schema(maximum = 2147483647)]
    pub seed: u32,
    /// Of the generic face: 5616 n² hexahedra.
    #[serde(default = "one")]
    #[schema(default = 1, minimum = 1, maximum = 2)]
    pub fineness: u32,
    #[serde(default)]
    pub budget: BudgetDocument,
}

fn one() -> u32 {
    1
}

impl TwinsDocument {
    fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let range = 3.0..=MOST_TWINS;
        faults.check_range(&at.key("patients"), f64::from(self.patients), range, "patients");
        faults.check_range(&at.key("fineness"), f64::from(self.fineness), 1.0..=2.0, "");
        faults.check_range(&at.key("seed"), f64::from(self.seed), 0.0..=MOST_SEED, "");
        self.budget.check(&at.key("budget"), limits, faults);
    }
}

/// The distances of a comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CohortDistance {
    /// Of closest points, both ways, by area.
    #[default]
    ClosestPoint,
    /// Of points with the same index.
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
    /// Adds its faults; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        if self.cohort.is_some() {
            return self.check_cohort(&at, faults);
        }
        if let Some(made) = &self.made {
            return self.check_made(made, &at, limits, faults);
        }
        let place = at.key("groups");
        faults.check_length(&place, self.groups.len(), limits.map_entries as usize);
        if self.groups.is_empty() {
            faults.add(&place, ErrorCode::MissingField, "a cohort has at least one group");
        }
        let subjects = self.groups.values().next().map_or(0, Vec::len);
        let mut names = BTreeSet::new();
        for (name, jobs) in &self.groups {
            let place = place.key(name);
            faults.check_name(&place, name, limits.name_characters as usize);
            if !names.insert(name.trim()) {
                let detail = format!("group `{}` is named more than once", name.trim());
                faults.add(&place, ErrorCode::DuplicateName, detail);
            }
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
            let detail = "a region has distances by closest points only";
            faults.add(&at.key("region"), ErrorCode::UnknownField, detail);
        }
    }

    /// Members that a stored cohort does not have.
    fn check_cohort(&self, at: &Pointer, faults: &mut Faults) {
        let given = 1 + usize::from(!self.groups.is_empty()) + usize::from(self.made.is_some());
        faults.check_one_of(at, given, "`groups`, `cohort`, `virtual`");
        if !self.subjects.is_empty() {
            let detail = "the subjects of a stored cohort have the names of its members";
            faults.add(&at.key("subjects"), ErrorCode::UnknownField, detail);
        }
    }

    fn check_made(&self, made: &TwinsDocument, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let given = 1 + usize::from(!self.groups.is_empty());
        faults.check_one_of(at, given, "`groups`, `cohort`, `virtual`");
        made.check(&at.key("virtual"), limits, faults);
        self.check_subjects(made.patients as usize, at, limits, faults);
        if self.distance == CohortDistance::TpsCp {
            let detail = "twins have distances of nodes only";
            faults.add(&at.key("distance"), ErrorCode::NoSuchOutput, detail);
        }
        if let Some(region) = self.region.as_ref().filter(|own| !PARTS.contains(&own.as_str())) {
            let detail = format!("twins have no region {region:?}; they have: {}", listed(PARTS));
            faults.add(&at.key("region"), ErrorCode::UnknownRegion, detail);
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
            if !names.insert(name.trim()) {
                let detail = format!("subject `{name}` is named more than once");
                faults.add(&at.index(index), ErrorCode::DuplicateName, detail);
            }
        }
    }

    /// The name of a subject; by default its number from 1.
    pub fn subject(&self, index: usize) -> String {
        self.subjects.get(index).cloned().unwrap_or_else(|| (index + 1).to_string())
    }

    /// The jobs with their places, in the order of the groups.
    pub fn jobs(&self) -> impl Iterator<Item = (Pointer, &String)> {
        let at = Pointer::root().key("groups");
        self.groups.iter().flat_map(move |(name, jobs)| {
            let at = at.key(name);
            jobs.iter().enumerate().map(move |(index, job)| (at.index(index), job))
        })
    }

    /// The selected distances of a comparison, if any.
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
