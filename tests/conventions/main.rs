//! What ARCHITECTURE.md says of modules and imports, held against the source.

#![allow(clippy::unwrap_used)]

mod palette;
mod references;
mod source;
mod wildcards;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use sha2::{Digest, Sha256};
use source::{Crate, Module, rust_files};

/// Modules of the numerics, and those that each may use.
const MECHANICS: [(&str, &[&str]); 31] = [
    ("rows", &[]),
    ("vectorised", &[]),
    ("progress", &[]),
    ("draws", &[]),
    ("mesh", &["progress", "rows"]),
    ("material", &[]),
    ("element", &[]),
    ("solver", &["progress", "rows", "vectorised"]),
    ("chart", &[]),
    ("image", &["mesh", "progress", "vectorised"]),
    ("domain", &["mesh", "image"]),
    ("meshing", &["mesh", "domain", "progress", "rows", "vectorised"]),
    ("landmarks", &["mesh"]),
    ("cephalometry", &["mesh"]),
    ("osteotomy", &["mesh", "image", "domain"]),
    (
        "anatomy",
        &[
            "mesh",
            "image",
            "domain",
            "meshing",
            "osteotomy",
            "landmarks",
            "registration",
            "progress",
        ],
    ),
    ("plan", &["mesh"]),
    ("registration", &["mesh", "progress"]),
    ("repair", &["mesh", "progress", "rows"]),
    ("simplification", &["mesh", "progress"]),
    ("conformation", &["mesh", "registration", "progress"]),
    ("muscle", &["mesh", "image", "domain", "material", "progress"]),
    ("format", &["mesh", "image"]),
    ("validation", &["mesh", "registration", "progress"]),
    ("boundary", &["mesh", "plan", "progress", "rows"]),
    (
        "model",
        &["mesh", "boundary", "material", "element", "solver", "progress", "rows", "vectorised"],
    ),
    (
        "prediction",
        &["mesh", "image", "plan", "boundary", "material", "muscle", "solver", "model", "progress"],
    ),
    (
        "response",
        &["mesh", "plan", "boundary", "solver", "model", "prediction", "progress", "vectorised"],
    ),
    ("optimisation", &["mesh", "plan", "material", "prediction", "response", "progress"]),
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
            "progress",
            "draws",
        ],
    ),
    (
        "learning",
        &[
            "mesh",
            "plan",
            "boundary",
            "material",
            "solver",
            "model",
            "prediction",
            "validation",
            "study",
            "progress",
            "draws",
        ],
    ),
];

/// Modules of the service, and those of the service that each may use. Which of the numerics they use is theirs to
/// choose.
const SERVICE: [(&str, &[&str]); 13] = [
    ("config", &[]),
    ("metrics", &[]),
    ("schema", &[]),
    ("fair_semaphore", &["metrics"]),
    ("telemetry", &["config", "metrics"]),
    ("traces", &["metrics"]),
    ("jobs", &["schema"]),
    ("store", &["schema", "config", "fair_semaphore"]),
    ("library", &["schema", "jobs", "store"]),
    ("worker", &["schema", "jobs", "library", "store", "config", "metrics", "traces"]),
    (
        "api",
        &[
            "schema",
            "jobs",
            "library",
            "store",
            "worker",
            "config",
            "metrics",
            "traces",
            "fair_semaphore",
        ],
    ),
    ("command", &["*"]),
    ("main", &["command"]),
];

/// What the numerics must not read, so that the same scene gives the same numbers.
const OUTSIDE_WORLD: [&str; 4] = ["std::fs", "std::env", "std::time", "std::net"];

fn crates() -> [(Crate, BTreeMap<&'static str, &'static [&'static str]>); 2] {
    [
        (Crate::read("mechanics/src"), MECHANICS.into_iter().collect()),
        (Crate::read("src"), SERVICE.into_iter().collect()),
    ]
}

fn top(module: &Module) -> &str {
    module.first().map_or("", String::as_str)
}

#[test]
fn every_module_uses_only_the_modules_that_the_table_allows() {
    let mut broken = Vec::new();
    for (sources, table) in crates() {
        for (module, imports) in sources.imports() {
            if module.is_empty() {
                continue;
            }
            let allowed = table.get(top(module)).copied();
            let allowed = allowed.unwrap_or_else(|| panic!("{module:?} is not in the table"));
            let others = imports.into_iter().map(top).filter(|other| *other != top(module));
            for other in others.filter(|other| !other.is_empty()) {
                if !allowed.contains(&other) && allowed != ["*"] {
                    broken.push(format!("{} uses {other}", module.join("::")));
                }
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn what_the_table_allows_is_used() {
    for (sources, table) in crates() {
        let mut used: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let imports = sources.imports();
        for (module, others) in &imports {
            used.entry(top(module)).or_default().extend(others.iter().map(|other| top(other)));
        }
        for (module, allowed) in table.iter().filter(|(name, _)| used.contains_key(**name)) {
            for other in allowed.iter().filter(|other| **other != "*") {
                assert!(used[module].contains(other), "{module} does not use {other}");
            }
        }
    }
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    for (sources, _) in crates() {
        let circles = circles(&sources.imports());
        assert!(circles.is_empty(), "in {}:\n{}", sources.root.display(), circles.join("\n"));
    }
}

/// Files that reach themselves: whatever imports nothing that is left is taken away, then whatever nothing imports, and
/// what stays stands in circles or between two of them.
fn circles(imports: &BTreeMap<&Module, BTreeSet<&Module>>) -> Vec<String> {
    let mut left = imports.clone();
    loop {
        let imported: BTreeSet<&Module> = left.values().flatten().copied().collect();
        let free: BTreeSet<&Module> = left
            .iter()
            .filter(|(module, others)| others.is_empty() || !imported.contains(**module))
            .map(|(module, _)| *module)
            .collect();
        if free.is_empty() {
            break;
        }
        left.retain(|module, _| !free.contains(module));
        left.values_mut().for_each(|others| others.retain(|other| !free.contains(other)));
    }
    let shown = |(module, others): (&&Module, &BTreeSet<&Module>)| {
        let others: Vec<String> = others.iter().map(|other| other.join("::")).collect();
        format!("{} -> {}", module.join("::"), others.join(", "))
    };
    left.iter().map(shown).collect()
}

#[test]
fn circles_of_two_and_three_files_are_found_and_chains_are_none() {
    let names = ["a", "b", "c", "d"].map(|name| vec![name.to_owned()]);
    let [a, b, c, d] = &names;
    let of = |pairs: &[(usize, usize)]| {
        let mut imports: BTreeMap<&Module, BTreeSet<&Module>> =
            names.iter().map(|name| (name, BTreeSet::new())).collect();
        for (from, to) in pairs {
            imports.get_mut(&names[*from]).unwrap().insert(&names[*to]);
        }
        circles(&imports)
    };
    assert_eq!([a, b, c, d].map(top), ["a", "b", "c", "d"]);
    assert!(of(&[(0, 1), (1, 2), (0, 2), (2, 3)]).is_empty());
    assert_eq!(of(&[(0, 1), (1, 0), (2, 3)]), ["a -> b", "b -> a"]);
    assert_eq!(of(&[(0, 1), (1, 2), (2, 0), (2, 3)]).len(), 3);
}

#[test]
fn the_tables_are_those_of_the_architecture_document() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    for (module, allowed) in MECHANICS.into_iter().chain(SERVICE) {
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
fn the_numerics_do_not_read_the_outside_world() {
    for file in Crate::read("mechanics/src").files.values() {
        for name in OUTSIDE_WORLD {
            let (module, part) = name.split_once("::").unwrap();
            let nested = file.uses_of_crate(module).iter().any(|path| path.starts_with(part));
            let inline = file.code.contains(name);
            assert!(!nested && !inline, "{} reads {name}", file.path.display());
        }
    }
}

#[test]
fn sql_stays_in_the_store_and_http_in_the_api() {
    for (module, file) in &Crate::read("src").files {
        if !["store", "command"].contains(&top(module)) {
            assert!(!file.code.contains("sqlx::"), "{} names sqlx", file.path.display());
        }
        if ["store", "jobs", "worker", "library", "schema"].contains(&top(module)) {
            assert!(!file.code.contains("axum::"), "{} names axum", file.path.display());
        }
    }
}

#[test]
fn every_file_of_migrations_is_a_step_of_the_schema() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let steps = fs::read_to_string(root.join("src/store/database/schema.rs")).unwrap();
    let files = fs::read_dir(root.join("migrations")).unwrap();
    let names: BTreeSet<String> =
        files.map(|file| file.unwrap().file_name().to_string_lossy().to_string()).collect();
    assert!(!names.is_empty());
    for (number, name) in (1..).zip(names) {
        assert!(name.starts_with(&format!("{number:04}_")), "{name} is not step {number}");
        assert!(steps.contains(&format!("migrations/{name}\"")), "{name} is no step");
    }
}

fn sources() -> Vec<std::path::PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    ["src", "mechanics/src"].iter().flat_map(|folder| rust_files(&root.join(folder))).collect()
}

#[test]
fn no_module_is_a_drawer_for_what_has_no_home() {
    for file in sources() {
        let name = file.file_stem().unwrap().to_string_lossy().to_string();
        assert!(
            !["utils", "util", "common", "helpers", "core", "misc"].contains(&name.as_str()),
            "{name}"
        );
    }
}

/// What is found, seen or told is a displacement, a region, a warning: a type has a noun of the field for its name.
#[test]
fn no_type_is_named_by_a_participle_alone() {
    let vague = [
        "Asked", "Enough", "Found", "Given", "Kept", "Known", "Made", "Place", "Said", "Seen",
        "Shown", "TakenIn", "Taken", "Told", "Wanted",
    ];
    for file in sources() {
        for line in fs::read_to_string(&file).unwrap().lines() {
            let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric()).collect();
            for pair in words.windows(2) {
                let is_type = ["struct", "enum", "trait", "type"].contains(&pair[0]);
                assert!(!(is_type && vague.contains(&pair[1])), "{}: {line}", file.display());
            }
        }
    }
}

/// The description of the API knows documents by their names alone: of two with one name it has one.
#[test]
fn no_two_documents_have_one_name() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in sources() {
        let mut is_described = false;
        for line in fs::read_to_string(&file).unwrap().lines() {
            let item = ["pub struct ", "pub enum "].iter().find_map(|item| line.strip_prefix(item));
            if let (Some(item), true) = (item, is_described) {
                let name = item.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
                places.entry(name.to_owned()).or_default().push(file.display().to_string());
            }
            let goes_on =
                line.starts_with("#[") || line.starts_with("///") || line.contains("ToSchema");
            is_described = line.contains("ToSchema") || (is_described && goes_on);
        }
    }
    assert!(places.len() > 300, "{}", places.len());
    let twice: Vec<_> = places.iter().filter(|(_, files)| files.len() > 1).collect();
    assert!(twice.is_empty(), "{twice:?}");
}

#[test]
fn files_stay_below_400_lines() {
    for file in sources() {
        let lines = fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= 400, "{} has {lines} lines", file.display());
    }
}

/// A page that was built before its last change would end the check of the page, half an hour after the tests began.
#[test]
fn the_page_is_built_of_its_sources() {
    for line in fs::read_to_string("web/sources.sha256").unwrap().lines() {
        let (hash, path) = line.split_once("  ").unwrap();
        let bytes = fs::read(Path::new("web").join(path)).unwrap_or_default();
        let found: String =
            Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(found, hash, "run web/build: web/{path} changed since");
    }
}
