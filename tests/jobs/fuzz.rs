//! Bytes changed at random in many places at once: every reader answers. A few seconds by default;
//! `FACIES_FUZZ_S=3600 cargo test --release --test jobs fuzz -- --nocapture` goes on for an hour and says how far it came.

use std::path::Path;
use std::time::{Duration, Instant};

use facies::schema::job_document::JobKind;
use serde_json::Value;

use crate::answers;
use crate::samples::one_of_each;

/// Changed inputs where no time is asked for.
const USUAL_OF_FILES: usize = 400_000;
const USUAL_OF_DOCUMENTS: usize = 200_000;

/// No input of a few kB may take longer.
const LONGEST: Duration = Duration::from_secs(10);

/// xorshift64* (Vigna, An experimental exploration of Marsaglia's xorshift generators, scrambled, 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    fn of<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.below(choices.len())]
    }
}

const WORDS: [&str; 14] = [
    "-1",
    "0",
    "1e999",
    "nan",
    "4294967296",
    "18446744073709551616",
    "null",
    "\"\"",
    "{",
    "[",
    "\n",
    "\u{0}",
    "\u{202e}",
    "1e-400",
];

/// One to eight changes: bytes, words, pieces cut out, doubled or taken from another input.
fn changed(bytes: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(24)).min(bytes.len());
        match random.below(6) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.next() as u8,
            2 => drop(bytes.drain(at..end)),
            3 => {
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            4 => {
                let from = random.below(other.len());
                let piece = other[from..(from + 1 + random.below(24)).min(other.len())].to_vec();
                bytes.splice(at..end, piece);
            }
            _ => drop(bytes.splice(at..end, random.of(&WORDS).bytes())),
        }
    }
    bytes
}

/// Calls `check` with changed inputs, for as many or as long as is wanted.
fn fuzz(seeds: &[(&str, Vec<u8>)], usual: usize, mut check: impl FnMut(&str, &[u8])) {
    let seconds = std::env::var("FACIES_FUZZ_S").ok().map(|text| text.parse().unwrap());
    let until = seconds.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut count = 0;
    while until.map_or(count < usual, |until| Instant::now() < until) {
        let (name, seed) = &seeds[count % seeds.len()];
        let (_, other) = &seeds[random.below(seeds.len())];
        let input = changed(seed, other, &mut random);
        let begun = Instant::now();
        check(name, &input);
        assert!(begun.elapsed() < LONGEST, "{name}: {:?}", String::from_utf8_lossy(&input));
        count += 1;
    }
    println!("{count} inputs");
}

#[test]
fn any_file_is_answered() {
    let mut read_well = 0;
    fuzz(&one_of_each(), USUAL_OF_FILES, |_, input| read_well += usize::from(answers::file(input)));
    assert!(read_well > 0, "inputs are changed beyond recognition");
}

/// The inputs in `fuzz/corpus/documents`, each with the name of its document.
fn kept() -> Vec<(&'static str, Vec<u8>)> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/documents");
    let of_one = |&(name, _): &(&'static str, _)| {
        let mut files: Vec<_> = corpus.join(name).read_dir().unwrap().collect();
        files.sort_by_key(|file| file.as_ref().unwrap().file_name());
        files.into_iter().map(move |file| (name, std::fs::read(file.unwrap().path()).unwrap()))
    };
    answers::DOCUMENTS.iter().flat_map(of_one).collect()
}

#[test]
fn any_document_is_answered() {
    let mut seeds = kept();
    seeds.retain(|(name, seed)| answers::document(name, seed));
    for (name, _) in answers::DOCUMENTS {
        assert!(seeds.iter().any(|(known, _)| known == name), "no input is a document `{name}`");
    }
    let mut read_well = 0;
    fuzz(&seeds, USUAL_OF_DOCUMENTS, |name, input| {
        read_well += usize::from(answers::document(name, input));
    });
    assert!(read_well > 0, "inputs are changed beyond recognition");
}

/// The document that an operation is sent; those of jobs are told apart by their kind.
fn sent(operation: &str) -> Option<&'static str> {
    Some(match operation {
        "create_case" => "case",
        "check_case" => "predict",
        "create_plan" | "replace_plan" => "plan",
        "create_cohort" => "stored-cohort",
        "apply_response" => "apply",
        "create_job" => "job",
        "change_job" => "job-change",
        "create_key" => "key",
        "rotate_key" => "rotation",
        _ => return None,
    })
}

#[test]
fn every_document_that_clients_send_is_fuzzed() {
    for kind in JobKind::ALL {
        let name = kind.name();
        assert!(
            answers::DOCUMENTS.iter().any(|(known, _)| *known == name),
            "jobs of kind `{name}`"
        );
    }
    let description: Value =
        serde_json::from_str(include_str!("../../openapi/openapi.json")).unwrap();
    let items = description["paths"].as_object().unwrap().values();
    let operations = items.flat_map(|item| item.as_object().unwrap().values());
    let mut count = 0;
    for operation in operations.filter(|operation| operation.get("requestBody").is_some()) {
        let Some(body) = operation.pointer("/requestBody/content/application~1json") else {
            continue;
        };
        let id = operation["operationId"].as_str().unwrap();
        let name = sent(id).unwrap_or_else(|| panic!("the document of {id} is not fuzzed"));
        for example in body["examples"].as_object().unwrap().values() {
            let text = example["value"].to_string();
            assert!(answers::document(name, text.as_bytes()), "{id}: {text}");
            if name == "job" {
                let kind = example["value"]["kind"].as_str().unwrap();
                assert!(answers::document(kind, text.as_bytes()), "{id}: {text}");
            }
            count += 1;
        }
    }
    assert!(count > JobKind::ALL.len());
}
