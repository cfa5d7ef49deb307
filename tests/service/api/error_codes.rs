//! What the pages say of codes is what the program answers.

use std::path::Path;

use facies::schema::ErrorCode;

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
