//! Contact settings: sliding without separation, or unilateral contact.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::ContactKind;

/// What happens at the sliding sets of the case, and where tissue meets other tissue or bone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ContactName {
    /// Sliding sets are held across, and free along.
    #[default]
    Sliding,
    /// Sliding sets are free.
    None,
    /// As `sliding`, and no part of the boundary of the tissue passes through another one: closed gaps press, without
    /// friction. Of `fem_linear`, `mtm_ti` and `fem_nonlinear`.
    Unilateral,
    /// `unilateral` where a gap closes, with a warning that says so; `sliding` elsewhere.
    Auto,
}

impl ContactName {
    /// Whether what touches may press.
    pub fn presses(self) -> bool {
        match self {
            ContactName::Unilateral | ContactName::Auto => true,
            ContactName::Sliding | ContactName::None => false,
        }
    }
}

impl From<ContactName> for ContactKind {
    fn from(name: ContactName) -> Self {
        match name {
            ContactName::Sliding => ContactKind::Sliding,
            ContactName::None => ContactKind::None,
            ContactName::Unilateral => ContactKind::Unilateral,
            ContactName::Auto => ContactKind::Auto,
        }
    }
}
