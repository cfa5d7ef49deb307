//! The numbers of every method, held against those that belong to `NUMERICS_REVISION`: a change of numbers raises it.
//!
//! `golden.txt` has a line for each of [`scenes::all`]: its name, the solver, and its numbers.
//! `bits HASH`: SHA-256 of the bits. They are the same on any number of threads and for any vector units.
//! `near SIZE MIX LARGEST`: sum of |v|, sum of v with fixed signs, largest |v|, which may differ by [`NEAR`] of the
//! first, for what faer factorises or what a function of the system's libm enters: their last bits are the processor's
//! and the platform's.

mod scenes;

use std::collections::BTreeMap;
use std::path::Path;

use mechanics::prediction::NUMERICS_REVISION;
use sha2::{Digest as _, Sha256};

use crate::golden::scenes::{Found, Holds, all};

/// How far sums of numbers may be from those of the table, as a share of the sum of their sizes.
const NEAR: f64 = 1e-9;

const TABLE: &str = include_str!("golden.txt");

/// Set to 1, it writes the table instead.
const WRITE: &str = "FACIES_WRITE_GOLDEN";

const HEAD: &str = "# Numbers of every method, and the NUMERICS_REVISION that they belong to. Written by\n\
    # FACIES_WRITE_GOLDEN=1 cargo test --test mechanics golden\n";

fn how() -> String {
    format!("run {WRITE}=1 cargo test --test mechanics golden to write the table anew")
}

/// A line of the table, without its name.
#[derive(Clone, Debug, PartialEq)]
struct Line {
    solver: String,
    numbers: Numbers,
}

#[derive(Clone, Debug, PartialEq)]
enum Numbers {
    Bits(String),
    Near([f64; 3]),
}

impl Line {
    fn of(found: &Found) -> Line {
        let numbers = match found.constraints {
            Holds::Bits => Numbers::Bits(hash(&found.values)),
            Holds::Near => Numbers::Near(sums(&found.values)),
        };
        Line { solver: found.solver.to_owned(), numbers }
    }

    fn text(&self, name: &str) -> String {
        match &self.numbers {
            Numbers::Bits(hash) => format!("{name} | {} | bits {hash}\n", self.solver),
            Numbers::Near([a, b, c]) => format!("{name} | {} | near {a} {b} {c}\n", self.solver),
        }
    }

    fn agrees(&self, other: &Line) -> bool {
        let numbers = match (&self.numbers, &other.numbers) {
            (Numbers::Near(mine), Numbers::Near(theirs)) => {
                mine.iter().zip(theirs).all(|(a, b)| (a - b).abs() <= NEAR * mine[0])
            }
            (Numbers::Bits(mine), Numbers::Bits(theirs)) => mine == theirs,
            (Numbers::Bits(_), Numbers::Near(_)) | (Numbers::Near(_), Numbers::Bits(_)) => false,
        };
        numbers && self.solver == other.solver
    }
}

/// Of the bits; there is one zero.
fn hash(values: &[f64]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| (value + 0.0).to_le_bytes()).collect();
    Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Sum of sizes, sum with signs that follow no pattern of a mesh, largest size.
fn sums(values: &[f64]) -> [f64; 3] {
    let (mut size, mut mix, mut largest, mut state) = (0.0, 0.0, 0.0_f64, 1_u64);
    for value in values {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        size += value.abs();
        mix += if state >> 63 == 0 { *value } else { -value };
        largest = largest.max(value.abs());
    }
    [size, mix, largest]
}

/// The revision and the lines of a table.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    revision: u32,
    lines: BTreeMap<String, Line>,
}

impl Table {
    fn parse(text: &str) -> Table {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let revision = lines.next().and_then(|line| line.strip_prefix("revision ")).unwrap();
        let lines = lines.map(|line| {
            let parts: Vec<&str> = line.split(" | ").collect();
            let numbers = match parts[2].split_once(' ').unwrap() {
                ("bits", hash) => Numbers::Bits(hash.to_owned()),
                (_, sums) => {
                    let sums: Vec<f64> = sums.split(' ').map(|sum| sum.parse().unwrap()).collect();
                    Numbers::Near(sums.try_into().unwrap())
                }
            };
            (parts[0].to_owned(), Line { solver: parts[1].to_owned(), numbers })
        });
        Table { revision: revision.parse().unwrap(), lines: lines.collect() }
    }

    fn text(&self) -> String {
        let lines: String = self.lines.iter().map(|(name, line)| line.text(name)).collect();
        format!("{HEAD}revision {}\n{lines}", self.revision)
    }

    /// What is wrong with a table of the program's numbers, or nothing.
    fn complaint(&self, now: &Table) -> Option<String> {
        let changed = self.changed(now);
        match (self.revision == now.revision, changed.as_slice()) {
            (true, []) if self.lines.len() == now.lines.len() => None,
            (true, []) => Some(format!("scenes came or went: {}", how())),
            (true, _) => {
                let changed = changed.join("\n");
                Some(format!(
                    "the numbers changed: raise NUMERICS_REVISION and {}\n{changed}",
                    how()
                ))
            }
            (false, _) => {
                let (old, new) = (self.revision, now.revision);
                Some(format!(
                    "the table is that of revision {old}, the program's is {new}: {}",
                    how()
                ))
            }
        }
    }

    /// The lines that both have and that disagree, with what the program finds.
    fn changed(&self, now: &Table) -> Vec<String> {
        let both =
            self.lines.iter().filter_map(|(name, was)| Some((name, was, now.lines.get(name)?)));
        let changed = both.filter(|(_, was, is)| !was.agrees(is));
        changed
            .map(|(name, was, is)| format!("was {}is  {}", was.text(name), is.text(name)))
            .collect()
    }
}

fn table_of(revision: u32, found: &[Found]) -> Table {
    let lines: BTreeMap<String, Line> =
        found.iter().map(|found| (found.name.to_owned(), Line::of(found))).collect();
    assert_eq!(lines.len(), found.len(), "two scenes have one name");
    Table { revision, lines }
}

#[test]
fn the_numbers_of_every_method_are_those_of_their_revision() {
    let (kept, now) = (Table::parse(TABLE), table_of(NUMERICS_REVISION, &all()));
    let complaint = kept.complaint(&now);
    if std::env::var(WRITE).is_ok_and(|value| value == "1") {
        let same = kept.revision == now.revision;
        let changed = kept.changed(&now).join("\n");
        assert!(!same || changed.is_empty(), "raise NUMERICS_REVISION first:\n{changed}");
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mechanics/golden/golden.txt");
        std::fs::write(path, now.text()).unwrap();
        return;
    }
    assert!(complaint.is_none(), "{}", complaint.unwrap_or_default());
}

#[test]
fn the_last_bit_of_one_number_is_another_hash_and_one_billionth_other_sums() {
    let values = vec![0.25, -1.5, 3.0];
    let found = |values: &[f64], constraints| {
        let values = values.to_vec();
        table_of(7, &[Found { name: "a".to_owned(), solver: "none", constraints, values }])
    };
    for (constraints, small, large) in [(Holds::Bits, 0.0, 4e-16), (Holds::Near, 1e-10, 1e-8)] {
        let kept = found(&values, constraints);
        assert_eq!(Table::parse(&kept.text()), kept);
        let changed = |by: f64| {
            let now = found(&[0.25, -1.5, 3.0 + by], constraints);
            kept.complaint(&now)
        };
        assert_eq!(changed(small), None);
        let complaint = changed(large).unwrap();
        assert!(
            complaint.starts_with("the numbers changed: raise NUMERICS_REVISION"),
            "{complaint}"
        );
    }
    let kept = found(&values, Holds::Bits);
    let raised = Table { revision: 8, ..kept.clone() };
    assert!(kept.complaint(&raised).unwrap().starts_with("the table is that of revision 7"));
    let more = Table { lines: BTreeMap::new(), ..kept.clone() };
    assert!(kept.complaint(&more).unwrap().starts_with("scenes came or went"));
}
