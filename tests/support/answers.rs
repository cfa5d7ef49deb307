//! What any file and any document has to be answered with, whatever is in it: a reading or one error.

use facies::schema::applied::ApplyDocument;
use facies::schema::case::meshed::CaseBody;
use facies::schema::cohort::stored::StoredCohortDocument;
use facies::schema::job_change::JobChangeDocument;
use facies::schema::job_document::JobDocument;
use facies::schema::key::{KeyDocument, RotationDocument};
use facies::schema::wire::strict;
use facies::schema::{
    CohortDocument, CompareDocument, ConformDocument, Faults, LearnDocument, Limits,
    MeshingDocument, OptimiseDocument, PlanDocument, PredictDocument, Problem, ReproduceDocument,
    ResponseDocument, StudyDocument,
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
type Reader = fn(&[u8]) -> bool;

/// Every document that clients send, by the name of its folder in `fuzz/corpus/documents`: those of jobs by their kinds, `job`
/// what tells these apart.
pub const DOCUMENTS: &[(&str, Reader)] = &[
    ("apply", |text| parsed::<ApplyDocument>(text, |_, _, _| {})),
    ("batch", |text| parsed(text, StudyDocument::check)),
    ("case", |text| read_again(text, CaseBody::parse)),
    ("cohort", |text| parsed(text, CohortDocument::check)),
    ("compare", |text| parsed(text, CompareDocument::check)),
    ("conform", |text| parsed(text, ConformDocument::check)),
    ("job", |text| read_again(text, JobDocument::parse)),
    ("job-change", |text| parsed(text, JobChangeDocument::check)),
    ("key", |text| parsed(text, |key: &KeyDocument, _, faults| join(faults, key.check()))),
    ("learn", |text| parsed(text, LearnDocument::check)),
    ("mesh", |text| parsed::<MeshingDocument>(text, |_, _, _| {})),
    ("optimise", |text| parsed::<OptimiseDocument>(text, |_, _, _| {})),
    ("plan", |text| parsed::<PlanDocument>(text, |_, _, _| {})),
    ("predict", |text| {
        parsed(text, |spec: &PredictDocument, _, faults| spec.check_for_service(faults))
    }),
    ("reproduce", |text| parsed(text, ReproduceDocument::check)),
    ("response", |text| parsed(text, ResponseDocument::check)),
    ("rotation", |text| {
        parsed(text, |new: &RotationDocument, _, faults| join(faults, new.check()))
    }),
    ("stored-cohort", |text| parsed(text, StoredCohortDocument::check)),
    ("study", |text| parsed(text, StudyDocument::check)),
];

/// True where the text was read as a document of that name.
pub fn document(name: &str, text: &[u8]) -> bool {
    let reader = DOCUMENTS.iter().find(|(known, _)| *known == name);
    reader.unwrap_or_else(|| panic!("no document is called {name}")).1(text)
}

fn join(faults: &mut Faults, checked: Result<(), Problem>) {
    if let Err(problem) = checked {
        faults.join(problem);
    }
}

/// A document that is read is checked, and says the same when it is written and read again.
fn parsed<T: DeserializeOwned + Serialize>(
    input: &[u8],
    check: fn(&T, &Limits, &mut Faults),
) -> bool {
    read_again(input, |text, limits| {
        let document = strict::parse(text, limits)?;
        check(&document, limits, &mut Faults::default());
        Ok(document)
    })
}

fn read_again<T: Serialize>(
    input: &[u8],
    parse: impl Fn(&[u8], &Limits) -> Result<T, Problem>,
) -> bool {
    let limits = Limits::default();
    match parse(input, &limits) {
        Ok(document) => {
            let text = serde_json::to_string(&document).unwrap();
            let again = parse(text.as_bytes(), &limits)
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
