//! `facies openapi`: the description of the service, as it stands in `openapi/openapi.json`.

use super::CommandError;

/// Prints the description.
pub fn run() -> Result<(), CommandError> {
    let text = serde_json::to_string_pretty(&crate::api::document())
        .map_err(|error| CommandError::Usage(error.to_string()))?;
    println!("{text}");
    Ok(())
}
