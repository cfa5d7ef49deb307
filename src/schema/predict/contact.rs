//! Contact settings: sliding without separation, or unilateral contact.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::ContactKind;

/// Contact at the sliding sets of the case, and of tissue with other tissue or bone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ContactName {
    /// Sliding sets are constrained along normals, free tangentially.
    #[default]
    Sliding,
    /// Sliding sets are free.
    None,
    /// As `sliding`, and no part of the tissue boundary penetrates another: unilateral contact without
    /// friction. Of `fem_linear`, `mtm_ti` and `fem_nonlinear`.
    Unilateral,
    /// `unilateral` if a gap closes, with a warning; else `sliding`.
    Auto,
}

impl ContactName {
    /// Whether contact may be unilateral.
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
