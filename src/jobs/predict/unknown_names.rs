//! Node sets and regions that a mesh lacks, in documents that are refused for other mistakes: the scene that would tell is not made.

use serde_json::Value;

use crate::schema::case::region::region_names;
use crate::schema::plan::document::PlanDocument;
use crate::schema::wire::canonical;
use crate::schema::{CaseDocument, ErrorCode, Faults, Pointer};
use mechanics::mesh::VolumeMesh;
use mechanics::mesh::ignored::missing_region;
use mechanics::prediction::Case;

/// Adds the names of a case and a plan that the mesh of the case lacks, in the words of a scene.
pub(super) fn unknown_names(
    (own, plan): (&CaseDocument, &PlanDocument),
    case: &Case,
    faults: &mut Faults,
) {
    let root = Pointer::root();
    unknown_sets(&canonical::to_value(own), &root.key("case"), &case.volume, faults);
    unknown_sets(&canonical::to_value(plan), &root.key("plan"), &case.volume, faults);
    let Some(regions) = region_names(&case.regions, &case.volume) else { return };
    for (index, growth) in plan.growth.iter().enumerate() {
        let name = growth.region.trim();
        if name != "*" && !regions.contains(name) {
            let at = root.key("plan").key("growth").index(index).key("region");
            faults.add(&at, ErrorCode::UnknownRegion, missing_region(name, &regions));
        }
    }
}

/// Each object with a `node_set` is a selection of nodes.
fn unknown_sets(document: &Value, at: &Pointer, mesh: &VolumeMesh, faults: &mut Faults) {
    match document {
        Value::Object(members) => {
            let name = members.get("node_set").and_then(Value::as_str).map(str::trim);
            if let Some(name) = name.filter(|name| mesh.node_set(name).is_none()) {
                faults.add(at, ErrorCode::UnknownSet, mesh.missing_set(name));
            }
            for (name, value) in members {
                unknown_sets(value, &at.key(name), mesh, faults);
            }
        }
        Value::Array(values) => {
            for (index, value) in values.iter().enumerate() {
                unknown_sets(value, &at.index(index), mesh, faults);
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}
