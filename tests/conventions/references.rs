//! References of source files to the pages of this repository, and of these pages to each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::source::rust_files;

/// Where sources stand that refer to pages.
const SOURCES: [&str; 5] = ["src", "mechanics/src", "mechanics/tests", "benches", "tests"];
/// The cases of the verification page are told by their numbers, too.
const CASES: &str = "docs/verification.md";

/// A page by its path from the root, and the anchor of a heading in it.
#[derive(Debug, PartialEq)]
struct Reference {
    page: String,
    anchor: Option<String>,
}

impl Reference {
    /// A path, and an anchor behind `#` where there is one.
    fn of(text: &str) -> Reference {
        let (page, anchor) = text.split_once('#').map_or((text, None), |(p, a)| (p, Some(a)));
        Reference { page: page.to_owned(), anchor: anchor.map(str::to_owned) }
    }
}

/// The pages of the repository with the anchors of their headings.
struct Pages(BTreeMap<String, BTreeSet<String>>);

impl Pages {
    fn read() -> Pages {
        let docs = fs::read_dir(root().join("docs")).unwrap();
        let docs = docs.map(|file| format!("docs/{}", file.unwrap().file_name().display()));
        let names = docs.filter(|name| name.ends_with(".md"));
        let names = names.chain(["README.md", "ARCHITECTURE.md"].map(str::to_owned));
        Pages(names.map(|name| (name.clone(), anchors(&text_of(&name)))).collect())
    }

    /// Why a reference leads nowhere.
    fn fault_of(&self, reference: &Reference) -> Option<String> {
        let Some(anchors) = self.0.get(&reference.page) else {
            return Some(format!("there is no page {}", reference.page));
        };
        let anchor = reference.anchor.as_ref().filter(|anchor| !anchors.contains(*anchor))?;
        Some(format!("{} has no heading #{anchor}", reference.page))
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text_of(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

/// The anchors that headings get where pages are shown: lower case, spaces as hyphens, without other signs.
fn anchors(page: &str) -> BTreeSet<String> {
    let mut is_example = false;
    let mut found = BTreeSet::new();
    for line in page.lines() {
        is_example ^= line.trim_start().starts_with("```");
        let heading = line.trim_start_matches('#');
        if !is_example && heading.len() < line.len() && heading.starts_with(' ') {
            let heading = heading.trim().to_lowercase().replace(' ', "-");
            let kept = |c: &char| c.is_alphanumeric() || ['-', '_'].contains(c);
            found.insert(heading.chars().filter(kept).collect());
        }
    }
    found
}

/// `docs/PAGE.md`, with `#ANCHOR` or without, and `V.7` for that case.
fn references_of_source(text: &str) -> Vec<Reference> {
    let part_of_name = |c: char| c.is_ascii_alphanumeric() || "-_/.#".contains(c);
    let words = text.split(|c| !part_of_name(c)).map(|word| word.trim_end_matches(['.', '#']));
    words.filter_map(reference_of_word).collect()
}

fn reference_of_word(word: &str) -> Option<Reference> {
    let case = word.strip_prefix("V.").and_then(|number| number.parse::<u8>().ok());
    if let Some(case) = case {
        return Some(Reference::of(&format!("{CASES}#v{case}")));
    }
    let page = word.trim_start_matches(['.', '/']);
    let is_page = page.starts_with("docs/") && page.split('#').next()?.ends_with(".md");
    is_page.then(|| Reference::of(page))
}

/// Links of a page to others and to itself: `[words](PAGE.md#ANCHOR)`.
fn references_of_page(name: &str, text: &str) -> Vec<Reference> {
    let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let to_pages = links.filter(|link| link.starts_with('#') || is_page(link));
    to_pages.map(|link| Reference::of(&from_root(name, link))).collect()
}

fn is_page(link: &str) -> bool {
    !link.contains("://") && link.split('#').next().is_some_and(|page| page.ends_with(".md"))
}

fn from_root(name: &str, link: &str) -> String {
    let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
    match link.strip_prefix("../") {
        _ if link.starts_with('#') => format!("{name}{link}"),
        Some(above) => above.to_owned(),
        None if folder.is_empty() => link.to_owned(),
        None => format!("{folder}/{link}"),
    }
}

/// Sources, without this folder, whose tests have made-up references.
fn sources() -> impl Iterator<Item = (PathBuf, String)> {
    let files = SOURCES.iter().flat_map(|folder| rust_files(&root().join(folder)));
    let files = files.filter(|path| !path.starts_with(root().join("tests/conventions")));
    files.map(|path| (path.clone(), fs::read_to_string(path).unwrap()))
}

#[test]
fn every_page_and_heading_that_the_source_refers_to_is_there() {
    let pages = Pages::read();
    let mut faults = Vec::new();
    let mut anchored = 0;
    for (path, text) in sources() {
        let references = references_of_source(&text);
        anchored += references.iter().filter(|reference| reference.anchor.is_some()).count();
        let found = references.iter().filter_map(|reference| pages.fault_of(reference));
        faults.extend(found.map(|fault| format!("{}: {fault}", path.display())));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(anchored > 100, "only {anchored} references were found");
}

#[test]
fn every_page_and_heading_that_another_page_links_to_is_there() {
    let pages = Pages::read();
    let mut faults = Vec::new();
    for name in pages.0.keys() {
        let references = references_of_page(name, &text_of(name));
        let found = references.iter().filter_map(|reference| pages.fault_of(reference));
        faults.extend(found.map(|fault| format!("{name}: {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_file_that_a_page_links_to_is_there() {
    let mut linked = 0;
    for name in Pages::read().0.keys() {
        for link in text_of(name).split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains("://") || link.starts_with('#') {
                continue;
            }
            let file = from_root(name, link);
            let file = file.split('#').next().unwrap();
            assert!(root().join(file).exists(), "{name} links to {file}, which is not there");
            linked += 1;
        }
    }
    assert!(linked > 100, "only {linked} links were found");
}

#[test]
fn every_test_that_the_verification_page_names_is_there() {
    let tests: BTreeMap<PathBuf, String> = sources().collect();
    let page = text_of(CASES);
    let named = page.split('`').skip(1).step_by(2).filter_map(|code| code.split_once("::"));
    let is_there = |module: &str, test: &str| {
        let of_module = |path: &Path| path.file_stem().is_some_and(|stem| stem == module);
        let named = format!("fn {test}()");
        tests.iter().any(|(path, text)| of_module(path) && text.contains(&named))
    };
    let named: Vec<_> = named.collect();
    assert!(named.len() > 80, "only {} names were found", named.len());
    for (module, test) in named {
        assert!(is_there(module, test), "{CASES} names {module}::{test}, which is not there");
    }
}

#[test]
fn papers_are_cited_by_author_and_year() {
    let pages = Pages::read().0.into_keys().chain(["openapi/openapi.json".to_owned()]);
    let pages = pages.map(|name| (PathBuf::from(&name), text_of(&name)));
    for (path, text) in sources().chain(pages) {
        for number in 0..5 {
            let number = format!("paper 00{number}");
            assert!(!text.to_lowercase().contains(&number), "{} says {number}", path.display());
        }
    }
}

#[test]
fn references_that_lead_nowhere_are_found() {
    let page = "# Top\n\n## The `auto` rule, twice\n```sh\n# no heading\n```\n### V.7\n";
    let found = anchors(page);
    assert_eq!(found, ["the-auto-rule-twice", "top", "v7"].map(str::to_owned).into());
    let pages = Pages([(CASES.to_owned(), found)].into());

    let source = "/// The sphere (V.7, docs/verification.md#v7), not V.8. See docs/none.md#top.";
    let faults: Vec<_> =
        references_of_source(source).iter().map(|reference| pages.fault_of(reference)).collect();
    let missing = |text: &str| Some(text.to_owned());
    let expected = [
        None,
        None,
        missing("docs/verification.md has no heading #v8"),
        missing("there is no page docs/none.md"),
    ];
    assert_eq!(faults, expected);

    let links =
        "[a](#v7) [b](verification.md#v9) [c](../README.md) [d](https://e.org/f.md) [g](h.svg)";
    let found: Vec<_> = references_of_page(CASES, links).into_iter().collect();
    let expected = ["docs/verification.md#v7", "docs/verification.md#v9", "README.md"];
    assert_eq!(found, expected.map(Reference::of));
}
