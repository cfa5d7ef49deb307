//! `facies openapi`: the description of the service, as it stands in `openapi/openapi.json`.

use std::io::Write;

use super::CommandError;

/// Prints the description.
pub fn run() -> Result<(), CommandError> {
    let write = || {
        let mut out = std::io::stdout().lock();
        serde_json::to_writer_pretty(&mut out, &crate::api::document())?;
        writeln!(out)
    };
    write().map_err(|source| CommandError::Write { path: "standard output".into(), source })
}
