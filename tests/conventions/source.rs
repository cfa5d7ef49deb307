//! The source files of a crate and what each imports.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module by the names on the way to it; the crate itself has none.
pub type Module = Vec<String>;

/// A crate of this repository.
pub struct Crate {
    pub root: PathBuf,
    pub files: BTreeMap<Module, SourceFile>,
}

/// A file without its comments, texts and unit tests, which stand last.
pub struct SourceFile {
    pub path: PathBuf,
    pub code: String,
    /// Paths of its `use` statements, `pub use` told apart.
    uses: Vec<Use>,
    /// The code but for these statements.
    body: String,
}

struct Use {
    is_facade: bool,
    path: Vec<String>,
    /// The name under which the file knows it.
    name: String,
}

impl Crate {
    /// The crate whose sources stand in this folder of the repository.
    pub fn read(folder: &str) -> Crate {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let files = rust_files(&root).into_iter().filter(|path| !path.ends_with("main.rs"));
        let files = files.map(|path| (module_of(&root, &path), SourceFile::read(path))).collect();
        Crate { root, files }
    }

    /// For each file those of the same crate that it imports from. A `pub use` names what a folder offers and imports
    /// nothing; what is imported through one is imported from where it stands.
    pub fn imports(&self) -> BTreeMap<&Module, BTreeSet<&Module>> {
        self.files.keys().map(|module| (module, self.imports_of(module))).collect()
    }

    fn imports_of(&self, module: &Module) -> BTreeSet<&Module> {
        let file = &self.files[module];
        let stated = file.uses.iter().filter(|stated| !stated.is_facade);
        let stated = stated.map(|stated| stated.path.clone());
        let inline = inline_paths(&file.body).into_iter().map(|path| file.in_full(path));
        let found = stated.chain(inline).filter_map(|path| self.resolve(module, &path, 0));
        found.filter(|other| *other != module).collect()
    }

    /// The file in which what a path names is defined; `None` for other crates.
    fn resolve(&self, from: &Module, path: &[String], depth: usize) -> Option<&Module> {
        let (mut at, mut rest) = self.start(from, path)?;
        while let Some(next) = rest.first().map(|name| child(&at, name)).filter(|m| self.has(m)) {
            at = next;
            rest = &rest[1..];
        }
        let (known, file) = self.files.get_key_value(&at)?;
        let passed_on = rest.first().filter(|_| depth < 8);
        let passed_on = passed_on.and_then(|name| file.uses.iter().find(|u| u.name == *name));
        match passed_on {
            Some(stated) => {
                let path: Vec<String> = stated.path.iter().chain(&rest[1..]).cloned().collect();
                self.resolve(&at, &path, depth + 1)
            }
            None => Some(known),
        }
    }

    /// The module that a path begins in, and what is left of the path.
    fn start<'p>(&self, from: &Module, path: &'p [String]) -> Option<(Module, &'p [String])> {
        match path.first()?.as_str() {
            "crate" => Some((Module::new(), &path[1..])),
            "self" => Some((from.clone(), &path[1..])),
            "super" => {
                let up = path.iter().take_while(|name| *name == "super").count();
                Some((from[..from.len().checked_sub(up)?].to_vec(), &path[up..]))
            }
            name => self.has(&child(from, name)).then(|| (from.clone(), path)),
        }
    }

    fn has(&self, module: &Module) -> bool {
        self.files.contains_key(module)
    }
}

impl SourceFile {
    fn read(path: PathBuf) -> SourceFile {
        let code = code_of(&fs::read_to_string(&path).unwrap());
        let (uses, body) = uses_of(&code);
        SourceFile { path, code, uses, body }
    }

    /// What it imports from another crate, as paths inside that crate.
    pub fn uses_of_crate(&self, name: &str) -> Vec<String> {
        let of_it = self.uses.iter().filter(|stated| stated.path[0] == name);
        of_it.map(|stated| stated.path[1..].join("::")).collect()
    }

    /// A path whose first name was imported, from where it was imported.
    fn in_full(&self, path: Vec<String>) -> Vec<String> {
        match self.uses.iter().find(|stated| stated.name == path[0]) {
            Some(stated) => stated.path.iter().chain(&path[1..]).cloned().collect(),
            None => path,
        }
    }
}

/// All Rust files below a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
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

fn module_of(root: &Path, path: &Path) -> Module {
    let inside = path.strip_prefix(root).unwrap().with_extension("");
    let mut names: Module =
        inside.components().map(|name| name.as_os_str().to_string_lossy().to_string()).collect();
    if names.last().is_some_and(|name| name == "mod" || name == "lib") {
        names.pop();
    }
    names
}

fn child(module: &Module, name: &str) -> Module {
    module.iter().cloned().chain([name.to_owned()]).collect()
}

/// The text without comments, texts in quotes and what stands behind the first `#[cfg(test)]` module with a body.
fn code_of(text: &str) -> String {
    let lines = text.lines().map(without_comment).collect::<Vec<_>>().join("\n");
    let tests = lines.match_indices("#[cfg(test)]\nmod ").find(|(at, _)| {
        lines[*at..].lines().nth(1).is_some_and(|line| line.trim_end().ends_with('{'))
    });
    let code = tests.map_or(lines.as_str(), |(at, _)| &lines[..at]);
    without_scopes(&without_texts(code))
}

fn without_comment(line: &str) -> &str {
    line.find("//").map_or(line, |at| if line[..at].contains('"') { line } else { &line[..at] })
}

/// Every text in quotes emptied; a quote that is escaped or a character of its own opens none.
fn without_texts(code: &str) -> String {
    let (mut out, mut inside, mut before) = (String::new(), false, ' ');
    for c in code.chars() {
        let is_quote = c == '"' && before != '\\' && (inside || before != '\'');
        if is_quote {
            inside = !inside;
        }
        if !inside || is_quote {
            out.push(c);
        }
        before = if before == '\\' && c == '\\' { ' ' } else { c };
    }
    out
}

/// `pub(in a::b)` is no import of `a::b`.
fn without_scopes(code: &str) -> String {
    let mut parts = code.split("pub(in ");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out.push_str("pub");
        out.push_str(part.split_once(')').map_or(part, |(_, rest)| rest));
    }
    out
}

fn uses_of(code: &str) -> (Vec<Use>, String) {
    let (mut uses, mut body, mut rest) = (Vec::new(), String::new(), code);
    while let Some(at) = next_use(rest) {
        body.push_str(&rest[..at.begin]);
        let statement = &rest[at.begin..];
        let end = statement.find(';').unwrap_or(statement.len());
        expand(&mut uses, at.is_facade, &[], &statement[at.tree..end]);
        rest = &statement[end..];
    }
    body.push_str(rest);
    (uses, body)
}

struct UseAt {
    begin: usize,
    /// Where its tree begins, from there.
    tree: usize,
    is_facade: bool,
}

/// The next statement whose first word, but for its visibility, is `use`.
fn next_use(code: &str) -> Option<UseAt> {
    code.match_indices("use ").find_map(|(at, _)| {
        let line = code[..at].rfind('\n').map_or(0, |end| end + 1);
        let before = code[line..at].trim();
        let is_facade = before.starts_with("pub") && !before.contains(' ');
        let begins = before.is_empty() || is_facade;
        begins.then_some(UseAt { begin: line, tree: at + 4 - line, is_facade })
    })
}

/// Every path of a tree such as `a::{b, c::{self, d as e}}`.
fn expand(uses: &mut Vec<Use>, is_facade: bool, prefix: &[String], tree: &str) {
    let tree = tree.trim();
    let (head, body) = match tree.find('{') {
        Some(at) => (&tree[..at], Some(&tree[at + 1..tree.rfind('}').unwrap_or(tree.len())])),
        None => (tree, None),
    };
    let (head, alias) = head.split_once(" as ").map_or((head, None), |(head, a)| (head, Some(a)));
    let names = head.split("::").map(str::trim).filter(|name| !name.is_empty());
    let mut path: Vec<String> = prefix.iter().cloned().chain(names.map(str::to_owned)).collect();
    match body {
        Some(body) => branches(body).for_each(|part| expand(uses, is_facade, &path, part)),
        None if tree.is_empty() => {}
        None => {
            if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
                path.pop();
            }
            let own = alias.map(|alias| alias.trim().to_owned()).or_else(|| path.last().cloned());
            uses.push(Use { is_facade, name: own.unwrap_or_default(), path });
        }
    }
}

/// The parts of the inside of braces, cut at commas that stand in no further braces.
fn branches(body: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    body.split(move |c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    })
}

/// Paths of two names or more that stand in the code itself.
fn inline_paths(code: &str) -> Vec<Vec<String>> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = code.split(|c| !is_part(c)).filter(|word| word.contains("::"));
    words
        .filter(|word| !word.starts_with(':'))
        .map(|word| word.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect())
        .filter(|path: &Vec<String>| path.len() > 1)
        .collect()
}
