//! Growth and active muscles of a plan.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::prediction::{Activation, Growth, PULL, VOLUME_CHANGE};

/// Volume gain or loss of a region: swelling, weight change, atrophy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct GrowthDocument {
    /// A region of the case, `tissue` if it has none; `*` is every region without an entry.
    pub region: String,
    /// Volume gain of unconstrained tissue, as a share; in [-0.5, 1].
    #[schema(minimum = -0.5, maximum = 1.0)]
    pub volume_change: f64,
}

/// Activation of a muscle along its fibres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ActivationDocument {
    /// A muscle of the case.
    pub muscle: String,
    /// Activation times the stress of the fully active muscle; in [0, 10000].
    #[schema(minimum = 0.0, maximum = 10_000.0)]
    pub stress_kpa: f64,
}

/// Growth by region.
pub fn to_growth(
    documents: &[GrowthDocument],
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) -> Vec<Growth> {
    faults.check_length(at, documents.len(), limits.map_entries as usize);
    let mut names = Names { kind: "region", seen: BTreeSet::new() };
    let mut growth = Vec::new();
    for (index, GrowthDocument { region, volume_change }) in documents.iter().enumerate() {
        let at = at.index(index);
        let region = names.check(region, &at.key("region"), limits, faults);
        let place = at.key("volume_change");
        faults.check_range(&place, *volume_change, VOLUME_CHANGE, "of the volume");
        growth.push(Growth { region, volume_change: *volume_change });
    }
    growth
}

/// Muscles and their stresses.
pub fn to_activations(
    documents: &[ActivationDocument],
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) -> Vec<Activation> {
    faults.check_length(at, documents.len(), limits.map_entries as usize);
    let mut names = Names { kind: "muscle", seen: BTreeSet::new() };
    let mut activations = Vec::new();
    for (index, ActivationDocument { muscle, stress_kpa }) in documents.iter().enumerate() {
        let at = at.index(index);
        let muscle = names.check(muscle, &at.key("muscle"), limits, faults);
        faults.check_range(&at.key("stress_kpa"), *stress_kpa, PULL, "kPa");
        activations.push(Activation { muscle, stress: *stress_kpa });
    }
    activations
}

/// Names of one kind read so far.
struct Names<'a> {
    kind: &'static str,
    seen: BTreeSet<&'a str>,
}

impl<'a> Names<'a> {
    /// A name without surrounding spaces; refuses duplicates.
    fn check(
        &mut self,
        name: &'a str,
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> String {
        faults.check_name(at, name, limits.name_characters as usize);
        let name = name.trim();
        if !self.seen.insert(name) {
            let detail = format!("{} `{name}` is named more than once", self.kind);
            faults.add(at, ErrorCode::DuplicateName, detail);
        }
        name.to_owned()
    }
}
