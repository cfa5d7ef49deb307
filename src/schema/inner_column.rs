//! The columns of a response beside those of its segments: growth of a region, or activation of a muscle.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::plan::document::PlanDocument;
use crate::schema::plan::inner;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::mesh::Warning;
use mechanics::mesh::ignored::listed;
use mechanics::prediction::{linear_strain, nothing_left, suspect_growth_and_pull};
use mechanics::response::InnerLoad;

/// Subject of a column. It follows those of the segments: the k-th after S segments is column 12 S + k.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct InnerColumnDocument {
    pub kind: InnerColumnKind,
    /// Of the region, `*` for all tissue, or of the muscle.
    pub name: String,
}

/// The factor of its column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum InnerColumnKind {
    /// (1 + volume_change)^(1/3) - 1; `*` is all tissue, and a region beside it its additional growth.
    Growth,
    /// `stress_kpa`.
    Muscle,
}

impl InnerColumnDocument {
    pub fn new(load: &InnerLoad) -> Self {
        let (kind, name) = match load {
            InnerLoad::Growth(region) => (InnerColumnKind::Growth, region),
            InnerLoad::Muscle(muscle) => (InnerColumnKind::Muscle, muscle),
        };
        InnerColumnDocument { kind, name: name.clone() }
    }

    pub fn to_load(&self) -> InnerLoad {
        let name = self.name.clone();
        match self.kind {
            InnerColumnKind::Growth => InnerLoad::Growth(name),
            InnerColumnKind::Muscle => InnerLoad::Muscle(name),
        }
    }
}

/// The factors of the columns of growth and muscles for a plan, and what of its numbers is suspect; pointers start at `at`. A region
/// or a muscle without a column is refused, and `*` where every one of `regions` has growth of its own.
pub fn inner_amounts(
    (columns, regions): (&[InnerColumnDocument], &[String]),
    plan: &PlanDocument,
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) -> (Vec<f64>, Vec<Warning>) {
    let growth = inner::to_growth(&plan.growth, &at.key("growth"), limits, faults);
    let pulls = inner::to_activations(&plan.activations, &at.key("activations"), limits, faults);
    let names = growth.iter().map(|own| own.region.as_str());
    let nothing_left = nothing_left(names, regions).filter(|_| !regions.is_empty());
    let everything = growth.iter().position(|own| own.region == "*");
    if let (Some(index), Some(detail)) = (everything, nothing_left) {
        faults.add(&at.key("growth").index(index).key("region"), ErrorCode::UnknownRegion, detail);
    }
    let mut amounts = Amounts { columns, values: vec![0.0; columns.len()] };
    let everywhere = everything.map_or(0.0, |index| linear_strain(growth[index].volume_change));
    for (index, own) in growth.iter().enumerate() {
        let strain = linear_strain(own.volume_change);
        let beyond = if own.region == "*" { strain } else { strain - everywhere };
        let place = at.key("growth").index(index).key("region");
        amounts.add(&InnerLoad::Growth(own.region.clone()), beyond, &place, faults);
    }
    for (index, own) in pulls.iter().enumerate() {
        let place = at.key("activations").index(index).key("muscle");
        amounts.add(&InnerLoad::Muscle(own.muscle.clone()), own.stress, &place, faults);
    }
    (amounts.values, suspect_growth_and_pull(&growth, &pulls))
}

struct Amounts<'a> {
    columns: &'a [InnerColumnDocument],
    values: Vec<f64>,
}

impl Amounts<'_> {
    fn add(&mut self, load: &InnerLoad, amount: f64, at: &Pointer, faults: &mut Faults) {
        let meant = InnerColumnDocument::new(load);
        match self.columns.iter().position(|column| *column == meant) {
            Some(place) => self.values[place] += amount,
            None => {
                let alike = self.columns.iter().filter(|column| column.kind == meant.kind);
                let known = listed(alike.map(|column| &column.name));
                let (what, name) = (meant.kind.word(), meant.name);
                let detail = format!(
                    "the response has no column of {what} {name:?}; it has those of: {known}"
                );
                faults.add(at, ErrorCode::NotInResponse, detail);
            }
        }
    }
}

impl InnerColumnKind {
    fn word(self) -> &'static str {
        match self {
            InnerColumnKind::Growth => "the growth of region",
            InnerColumnKind::Muscle => "muscle",
        }
    }
}
