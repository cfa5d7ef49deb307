//! An audited action: a change that is recorded in the audit log.

use super::database::Row;

/// An action of a caller or an operator.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AuditedAction {
    pub tenant: String,
    /// The id of a key, `command`, or `retention`.
    pub actor: String,
    /// Method and route, or the command.
    pub action: String,
    /// The id of what it is done to, empty where there is none.
    pub object: String,
    /// The id of the request.
    pub request: String,
}

impl AuditedAction {
    pub(super) fn of_row(row: &Row) -> Result<AuditedAction, sqlx::Error> {
        Ok(AuditedAction {
            tenant: row.try_get("tenant")?,
            actor: row.try_get("actor")?,
            action: row.try_get("action")?,
            object: row.try_get("object")?,
            request: row.try_get("request")?,
        })
    }
}
