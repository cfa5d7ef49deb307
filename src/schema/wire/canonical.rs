//! Canonical JSON and its hash: the same content has the same hash, however it was written down.

use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

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

/// The hash of what documents say and of the program's version: another program may find other results.
pub fn hash(mut content: Value) -> String {
    content["engine"] = env!("CARGO_PKG_VERSION").into();
    content.sort_all_objects();
    sha256_hex(content.to_string().as_bytes())
}
