//! Ignored arrays of a file, each with the reason, for requests that name one.

use std::fmt;

/// As many ignored arrays are kept by name; the rest is counted.
const MOST_LISTED: usize = 100;

/// As many names stand in a message.
const MOST_NAMED: usize = 20;

/// Entities that an array has values for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValuesOf {
    Points,
    /// Cells of a volume, triangles of a surface.
    Cells,
}

impl ValuesOf {
    /// The word in messages and documents.
    pub fn name(self) -> &'static str {
        match self {
            ValuesOf::Points => "point",
            ValuesOf::Cells => "cell",
        }
    }
}

/// An array that nothing reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredArray {
    pub of: ValuesOf,
    pub name: String,
    /// What the array does that nothing can use: `holds floating-point numbers, not integers`.
    pub why: String,
}

impl fmt::Display for IgnoredArray {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "the {} array {:?} {}", self.of.name(), self.name, self.why)
    }
}

/// The ignored arrays of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IgnoredArrays {
    /// In the order of their discovery, at most 100.
    pub listed: Vec<IgnoredArray>,
    /// How many there are beside those.
    pub more: u64,
}

impl IgnoredArrays {
    pub fn add(&mut self, of: ValuesOf, name: &str, why: String) {
        if self.listed.len() < MOST_LISTED {
            self.listed.push(IgnoredArray { of, name: name.trim().to_owned(), why });
        } else {
            self.more += 1;
        }
    }

    /// The names, and behind them how many arrays are not named.
    pub fn names(&self) -> Vec<String> {
        let more = (self.more > 0).then(|| format!("and {} more", self.more));
        self.listed.iter().map(|array| array.name.clone()).chain(more).collect()
    }

    pub(super) fn find(&self, of: ValuesOf, name: &str) -> Option<&IgnoredArray> {
        self.listed.iter().find(|array| array.of == of && array.name == name)
    }
}

/// Purpose for which a case names an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrayUse {
    PointLabels,
    CellLabels,
    PointVectors,
    CellVectors,
}

/// What is said of a region that is asked for and not there.
pub fn missing_region(name: &str, known: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    format!("no region is called {name:?}; there are: {}", listed(known))
}

/// Up to 20 names, so that a message stays one line; `none` where there are none.
pub fn listed(names: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let mut names: Vec<String> = names.into_iter().map(|name| name.as_ref().to_owned()).collect();
    if names.is_empty() {
        return "none".to_owned();
    }
    let more = names.len().saturating_sub(MOST_NAMED);
    names.truncate(MOST_NAMED);
    let shown = names.join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}
