//! A change of an existing job: its tags.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::wire::fault::{Faults, Pointer};
use super::wire::limits::Limits;
use super::wire::names::check_tags;
use crate::schema::code::ErrorCode;

/// A change of a job.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobChangeDocument {
    pub tags: TagChangeDocument,
}

/// Tags to add to a job and to remove from it.
#[derive(Clone, Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TagChangeDocument {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub add: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remove: Vec<String>,
}

impl JobChangeDocument {
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let TagChangeDocument { add, remove } = &self.tags;
        let at = Pointer::root().key("tags");
        check_tags(add, &at.key("add"), limits, faults);
        check_tags(remove, &at.key("remove"), limits, faults);
        for (index, tag) in add.iter().enumerate().filter(|(_, tag)| remove.contains(tag)) {
            let detail = format!("the tag `{tag}` is both to be added and to be removed");
            faults.add(&at.key("add").index(index), ErrorCode::DuplicateName, detail);
        }
    }
}
