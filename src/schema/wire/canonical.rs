//! Canonical JSON and its hash: the same content has the same hash, however it is formatted.

use serde::Serialize;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use mechanics::prediction::NUMERICS_REVISION;

/// A document as a value whose keys are sorted.
pub fn to_value(document: &impl Serialize) -> Value {
    let mut value = serde_json::to_value(document)
        .expect("documents have text keys and serialise without failing");
    value.sort_all_objects();
    value
}

/// SHA-256 of some bytes in hexadecimal.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes in lower-case hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The hash of documents and of the numerics revision of the program, since another revision gives other results.
pub fn hash(mut content: Value) -> String {
    content["engine"] =
        json!({ "version": env!("CARGO_PKG_VERSION"), "numerics": NUMERICS_REVISION });
    content.sort_all_objects();
    sha256_hex(content.to_string().as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_is_one_of_the_documents_the_version_and_the_revision_of_the_numbers() {
        let version = env!("CARGO_PKG_VERSION");
        let text = format!(
            r#"{{"engine":{{"numerics":{NUMERICS_REVISION},"version":"{version}"}},"spec":{{"a":1}}}}"#
        );
        assert_eq!(hash(json!({ "spec": { "a": 1 } })), sha256_hex(text.as_bytes()));
    }
}
