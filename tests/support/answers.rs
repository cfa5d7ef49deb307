//! What any file and any document has to be answered with, whatever is in it: a reading or one error.

use facies::schema::wire::strict;
use facies::schema::{
    CaseDocument, CompareDocument, Limits, MeshingDocument, OptimiseDocument, PlanDocument,
    PredictDocument, ResponseDocument, StudyDocument,
};
use mechanics::format::{FormatError, ReadLimits, read};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// True where the file was read; it may not ask for memory by a number that it holds.
pub fn file(bytes: &[u8]) -> bool {
    let limits = ReadLimits {
        nodes: 1000,
        triangles: 1000,
        cells: 1000,
        voxels: 1000,
        decoded_floor_bytes: 1 << 16,
        image_floor_bytes: 1 << 16,
        ..ReadLimits::default()
    };
    match read(bytes, &limits) {
        Ok(_) => true,
        Err(FormatError::Memory { values }) => panic!("memory for {values} values was asked for"),
        Err(error) => {
            assert!(!error.code().is_empty() && !error.to_string().is_empty());
            false
        }
    }
}

/// True where the text was read as a document of that name.
pub fn document(name: &str, text: &[u8]) -> bool {
    match name {
        "case" => parsed::<CaseDocument>(text),
        "plan" => parsed::<PlanDocument>(text),
        "predict" => parsed::<PredictDocument>(text),
        "study" | "batch" => parsed::<StudyDocument>(text),
        "optimise" => parsed::<OptimiseDocument>(text),
        "compare" => parsed::<CompareDocument>(text),
        "response" => parsed::<ResponseDocument>(text),
        "mesh" => parsed::<MeshingDocument>(text),
        _ => panic!("no document is called {name}"),
    }
}

/// A document that is read says the same when it is written and read again.
fn parsed<T: DeserializeOwned + Serialize>(input: &[u8]) -> bool {
    let limits = Limits::default();
    match strict::parse::<T>(input, &limits) {
        Ok(document) => {
            let text = serde_json::to_string(&document).unwrap();
            let again = strict::parse::<T>(text.as_bytes(), &limits)
                .unwrap_or_else(|problem| panic!("{text}: {}", problem.detail));
            assert_eq!(serde_json::to_string(&again).unwrap(), text);
            true
        }
        Err(problem) => {
            assert!(!problem.detail.is_empty());
            false
        }
    }
}
