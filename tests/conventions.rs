//! The import table of ARCHITECTURE.md, held against the source.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Module, and the modules of ours that it may use.
const TABLE: [(&str, &[&str]); 26] = [
    ("mesh", &[]),
    ("material", &[]),
    ("element", &[]),
    ("solver", &[]),
    ("config", &[]),
    ("chart", &[]),
    ("telemetry", &["config", "metrics"]),
    ("metrics", &[]),
    ("traces", &["metrics"]),
    ("registration", &["mesh", "solver"]),
    ("image", &["mesh"]),
    ("format", &["mesh", "image"]),
    ("plan", &["mesh"]),
    ("validation", &["mesh", "registration"]),
    ("boundary", &["mesh", "plan"]),
    ("model", &["mesh", "boundary", "material", "element", "solver"]),
    ("prediction", &["mesh", "image", "plan", "boundary", "material", "solver", "model"]),
    ("response", &["mesh", "plan", "boundary", "material", "solver", "model", "prediction"]),
    ("optimisation", &["mesh", "plan", "response"]),
    (
        "study",
        &[
            "mesh",
            "plan",
            "boundary",
            "material",
            "solver",
            "model",
            "prediction",
            "response",
            "validation",
        ],
    ),
    (
        "schema",
        &[
            "mesh",
            "image",
            "format",
            "plan",
            "boundary",
            "material",
            "solver",
            "model",
            "prediction",
            "response",
            "optimisation",
            "registration",
            "validation",
            "study",
        ],
    ),
    ("store", &["schema", "config"]),
    (
        "jobs",
        &[
            "mesh",
            "image",
            "registration",
            "format",
            "plan",
            "boundary",
            "prediction",
            "response",
            "optimisation",
            "validation",
            "study",
            "chart",
            "schema",
            "store",
            "config",
            "metrics",
            "traces",
        ],
    ),
    (
        "api",
        &[
            "mesh", "format", "plan", "response", "schema", "store", "jobs", "config", "metrics",
            "traces",
        ],
    ),
    ("command", &["*"]),
    ("main", &["command"]),
];

/// What modules above `schema` must not name.
const SERVICE_CRATES: [&str; 4] = ["axum", "sqlx", "tokio", "utoipa"];

/// What the numerics must not read, so that the same scene gives the same numbers.
const OUTSIDE_WORLD: [&str; 4] = ["std::fs", "std::env", "std::time", "std::net"];

const NUMERICS: [&str; 15] = [
    "mesh",
    "material",
    "element",
    "solver",
    "chart",
    "registration",
    "format",
    "plan",
    "validation",
    "boundary",
    "model",
    "prediction",
    "response",
    "study",
    "optimisation",
];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The top module that a file belongs to.
fn module_of(file: &Path) -> String {
    let inside = file.strip_prefix(source()).unwrap();
    let first = inside.components().next().unwrap().as_os_str().to_string_lossy();
    first.trim_end_matches(".rs").to_owned()
}

/// The code of a file without its comments and without its unit tests, which stand last.
fn code_of(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// The modules of ours that code names: `crate::x` or, in the binary, `facies::x`.
fn used_modules(code: &str, prefix: &str) -> BTreeSet<String> {
    code.match_indices(prefix)
        .flat_map(|(at, _)| {
            let rest = &code[at + prefix.len()..];
            match rest.strip_prefix('{') {
                Some(list) => {
                    let list = list.split('}').next().unwrap_or_default();
                    list.split(',').map(first_word).collect::<Vec<_>>()
                }
                None => vec![first_word(rest)],
            }
        })
        .filter(|word| !word.is_empty())
        .collect()
}

fn first_word(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

#[test]
fn every_module_uses_only_the_modules_that_the_table_allows() {
    let table: BTreeMap<&str, &[&str]> = TABLE.into_iter().collect();
    let mut broken = Vec::new();
    for file in rust_files(&source()) {
        let module = module_of(&file);
        if module == "lib" {
            continue;
        }
        let allowed = table.get(module.as_str()).copied();
        let allowed = allowed.unwrap_or_else(|| panic!("{module} is not in the table"));
        let code = code_of(&file);
        let used =
            used_modules(&code, "crate::").into_iter().chain(used_modules(&code, "facies::"));
        for other in used {
            let ours = table.contains_key(other.as_str());
            if ours && other != module && !allowed.contains(&other.as_str()) && allowed != ["*"] {
                broken.push(format!("{} uses {other}", file.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn the_table_is_the_one_in_the_architecture_document() {
    let text = fs::read_to_string(source().join("../ARCHITECTURE.md")).unwrap();
    for (module, allowed) in TABLE {
        let named = match allowed {
            [] => "nothing of ours".to_owned(),
            ["*"] => "everything".to_owned(),
            _ => allowed.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" "),
        };
        let row = format!("| `{module}` | {named} |");
        assert!(text.contains(&row), "ARCHITECTURE.md lacks the row {row}");
    }
}

#[test]
fn nothing_above_the_documents_names_a_crate_of_the_service_or_reads_the_outside_world() {
    for file in rust_files(&source()) {
        if NUMERICS.contains(&module_of(&file).as_str()) {
            let code = code_of(&file);
            for name in SERVICE_CRATES.iter().map(|name| format!("{name}::")) {
                assert!(!code.contains(&name), "{} names {name}", file.display());
            }
            for name in OUTSIDE_WORLD {
                assert!(!code.contains(name), "{} reads {name}", file.display());
            }
        }
    }
}

#[test]
fn sql_stays_in_the_store_and_http_in_the_api() {
    for file in rust_files(&source()) {
        let (module, code) = (module_of(&file), code_of(&file));
        if !["store", "command"].contains(&module.as_str()) {
            assert!(!code.contains("sqlx::"), "{} names sqlx", file.display());
        }
        if ["store", "jobs", "schema"].contains(&module.as_str()) {
            assert!(!code.contains("axum::"), "{} names axum", file.display());
        }
    }
}

#[test]
fn no_module_is_a_drawer_for_what_has_no_home() {
    for file in rust_files(&source()) {
        let name = file.file_stem().unwrap().to_string_lossy().to_string();
        assert!(
            !["utils", "util", "common", "helpers", "core", "misc"].contains(&name.as_str()),
            "{name}"
        );
    }
}

#[test]
fn files_stay_below_400_lines() {
    for file in rust_files(&source()) {
        let lines = fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= 400, "{} has {lines} lines", file.display());
    }
}
