//! What the pages say of codes is what the program answers.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use facies::schema::ErrorCode;
use reqwest::StatusCode;

use crate::helpers::{Server, ask};

fn page(name: &str) -> String {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    std::fs::read_to_string(docs.join(name)).unwrap()
}

/// The code and the status of a row of a table.
fn told(line: &str) -> Option<(String, u16)> {
    let mut cells = line.strip_prefix("| `")?.split(" | ");
    let code = cells.next()?.strip_suffix('`')?;
    Some((code.to_owned(), cells.next()?.parse().ok()?))
}

#[test]
fn the_page_of_errors_lists_every_code_with_its_status() {
    let mut told: Vec<_> = page("errors.md").lines().filter_map(told).collect();
    let codes = ErrorCode::ALL.iter();
    let mut there: Vec<_> = codes.map(|code| (code.name().to_owned(), code.status())).collect();
    told.sort();
    there.sort();
    assert_eq!(told, there);
}

/// Pages that tell what happens name codes behind their status, e.g. 422 `budget-exceeded`.
#[test]
fn a_code_has_the_status_that_other_pages_tell() {
    let mut seen = Vec::new();
    for name in ["clients.md", "running.md", "trust.md"] {
        let text = page(name);
        for code in ErrorCode::ALL {
            for (at, _) in text.match_indices(&format!(" `{code}`")) {
                let before = text[..at].rsplit(|letter: char| !letter.is_ascii_digit()).next();
                if let Some(Ok(status)) = before.map(str::parse::<u16>) {
                    assert_eq!(status, code.status(), "{code} in {name}");
                    seen.push(*code);
                }
            }
        }
    }
    for code in [ErrorCode::IdempotencyMismatch, ErrorCode::BudgetExceeded] {
        assert!(seen.contains(&code), "{code} among {seen:?}");
    }
}

/// The codes of the table of warnings.
fn warnings_told() -> BTreeSet<String> {
    let text = page("errors.md");
    let (_, table) = text.split_once("## Warnings").unwrap();
    let code = |line: &str| line.strip_prefix("| `")?.split('`').next().map(str::to_owned);
    table.lines().filter_map(code).collect()
}

/// The files of a folder, its folders included.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

/// Words that look like codes: of a file format, and of errors of the rows of a study.
const NO_WARNINGS: [&str; 8] = [
    "answer-absurd",
    "budget-exceeded",
    "left-posterior-superior",
    "right-anterior-superior",
    "missing-material",
    "not-measured",
    "not-run",
    "truth-failed",
];

/// Words between hyphens, as codes are written.
fn is_code(text: &str) -> bool {
    let words: Vec<&str> = text.trim_end_matches('?').split('-').collect();
    words.iter().all(|word| word.len() > 1 && word.bytes().all(|byte| byte.is_ascii_lowercase()))
}

#[test]
fn every_code_of_a_warning_in_the_sources_is_on_the_page() {
    let told = warnings_told();
    let mut made = BTreeSet::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for path in [root.join("src"), root.join("mechanics/src")].iter().flat_map(|at| sources(at)) {
        let text = std::fs::read_to_string(&path).unwrap();
        let says = ["Warning::new(", "WarningDocument {", "warnings.extend("];
        if !says.iter().any(|made| text.contains(made)) {
            continue;
        }
        let code = text.split("#[cfg(test)]").next().unwrap();
        // A word of one part is a code only where a warning is made of it.
        let first = code.split("Warning::new(").skip(1).filter_map(|rest| {
            rest.trim_start().strip_prefix('"')?.split('"').next().map(str::to_owned)
        });
        let literals = code.split('"').skip(1).step_by(2).map(str::to_owned);
        let literals = literals.filter(|word| word.contains('-') && is_code(word));
        made.extend(first.chain(literals.filter(|word| !NO_WARNINGS.contains(&word.as_str()))));
    }
    let untold: Vec<&String> = made.difference(&told).collect();
    assert!(untold.is_empty(), "docs/errors.md lacks {untold:?}");
    let unmade: Vec<&String> = told.difference(&made).collect();
    assert!(unmade.is_empty(), "nothing says {unmade:?}");
}

#[tokio::test]
async fn the_type_of_a_problem_leads_to_the_row_of_its_code_on_a_page_that_needs_no_key() {
    let server = Server::start_with(&["--workers", "0", "--api-key", "a-key-that-nobody-has"]);
    let refused = ask(server.get("/v1/jobs")).await.problem(401, "unauthorized");
    let (address, anchor) = refused["type"].as_str().unwrap().split_once('#').unwrap();
    let page = ask(server.get(address)).await;
    assert_eq!(page.status, StatusCode::OK);
    assert!(page.header("content-type").starts_with("text/html"));
    let page = String::from_utf8(page.bytes).unwrap();
    // In the colours of the page, and as wide as what shows it.
    let palette = include_str!("../../../web/dist/assets/palette.css");
    assert!(page.contains(palette) && page.contains("width=device-width"));
    assert!(!page.contains("](") && page.contains("(trust.md)"), "links are told by their words");
    assert_eq!(anchor, "unauthorized");
    let codes = ErrorCode::ALL.iter().map(|code| code.name().to_owned());
    for code in codes.chain(warnings_told()) {
        let row = page.split(&format!("<tr id=\"{code}\">")).nth(1);
        let row = row.unwrap_or_else(|| panic!("{code}")).split("</tr>").next().unwrap();
        let says = row.rsplit("<td>").next().unwrap();
        assert!(says.len() > 12, "{code}: {says}");
    }
}
