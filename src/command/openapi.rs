//! `facies openapi`: the description of the service, as it stands in `openapi/openapi.json`.

use std::io::Write;

/// Prints the description.
pub fn openapi() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, &crate::api::document())?;
    writeln!(out)
}
