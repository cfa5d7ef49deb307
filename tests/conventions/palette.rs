//! Colours have one home: `chart/colour.rs` in the numerics, `palette.css` for documents of browsers, `palette.ts` for what the page
//! draws; and what has the same name in two of them is the same.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::source::rust_files;

const DRAWN: &str = "mechanics/src/chart/colour.rs";
const PAGE: &str = "web/src/palette.ts";
const STYLES: &str = "web/public/assets/palette.css";

fn text(path: impl AsRef<Path>) -> String {
    fs::read_to_string(path).unwrap()
}

/// What stands behind `name` up to the next `;`, without the letters that languages differ in.
fn value(source: &str, name: &str) -> String {
    let at = source.find(name).unwrap_or_else(|| panic!("there is no {name}"));
    let rest = &source[at + name.len()..];
    let rest = rest.split_once('=').unwrap().1;
    let value: String = rest.split(';').next().unwrap().split_whitespace().collect();
    value.replace(",]", "]")
}

fn variable(name: &str) -> String {
    let styles = text(STYLES);
    let start = styles.find(&format!("--{name}: ")).unwrap() + name.len() + 4;
    styles[start..].split(';').next().unwrap().to_owned()
}

#[test]
fn pictures_charts_reports_and_the_page_have_the_same_colours() {
    let (drawn, page) = (text(DRAWN), text(PAGE));
    for name in [
        "INK",
        "FAINT_INK",
        "GRID",
        "SERIES",
        "SKIN",
        "OUTLINE",
        "SEQUENCE",
        "SIGNED",
        "SEGMENTS",
        "FIXED",
        "SLIDING",
        "FREE",
    ] {
        let [ours, theirs] = [&drawn, &page].map(|source| value(source, &format!("const {name}:")));
        assert_eq!(ours, theirs, "{name} of {DRAWN} and {PAGE}");
    }
    let named = [("INK", "ink"), ("FAINT_INK", "soft"), ("GRID", "line"), ("GROUND", "ground")];
    let heeded = [("WARN_INK", "warn-ink"), ("FAILED_INK", "bad-ink")];
    for (name, style) in named.into_iter().chain(heeded) {
        let styled = format!("{:?}", variable(style));
        assert_eq!(value(&drawn, &format!("const {name}:")), styled, "{name} and --{style}");
    }
    assert_eq!(value(&page, "const ACCENT:"), format!("{:?}", variable("accent")));
    assert_eq!(text(STYLES), text("web/dist/assets/palette.css"), "web/build was not run");
}

/// `#rrggbb` in a source.
fn colours(source: &str) -> Vec<String> {
    let hexadecimal = |part: &str| {
        let digits: String = part.chars().take_while(char::is_ascii_hexdigit).collect();
        (digits.len() == 6).then(|| digits.to_lowercase())
    };
    source.split('#').skip(1).filter_map(hexadecimal).collect()
}

#[test]
fn no_colour_is_written_in_two_files() {
    let mut homes: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    let roots = ["mechanics/src", "src"].map(Path::new);
    for path in roots.into_iter().flat_map(rust_files) {
        let mut found = colours(&text(&path));
        found.sort();
        found.dedup();
        found.retain(|colour| !["ffffff", "000000"].contains(&colour.as_str()));
        found.into_iter().for_each(|colour| homes.entry(colour).or_default().push(path.clone()));
    }
    let many: Vec<_> = homes.into_iter().filter(|(_, files)| files.len() > 1).collect();
    assert!(many.is_empty(), "a colour of two files belongs to {DRAWN}: {many:?}");
    let written: Vec<PathBuf> =
        fs::read_dir("web/src/views").unwrap().map(|entry| entry.unwrap().path()).collect();
    let others = ["charts.ts", "workbench.ts", "scene.ts", "marks.ts"]
        .map(|name| Path::new("web/src").join(name));
    for path in written.into_iter().chain(others) {
        assert!(colours(&text(&path)).is_empty(), "{}: colours belong to {PAGE}", path.display());
    }
}
