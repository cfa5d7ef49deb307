//! Warnings: facts that a reader of a result needs although the work went on.

/// A stable code, one sentence, and the numbers behind it in the order in which they matter.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    pub code: &'static str,
    pub detail: String,
    pub numbers: Vec<(&'static str, f64)>,
}

impl Warning {
    pub fn new(code: &'static str, detail: impl Into<String>) -> Self {
        Warning { code, detail: detail.into(), numbers: Vec::new() }
    }

    /// The same warning with one more number.
    pub fn with(mut self, name: &'static str, value: f64) -> Self {
        self.numbers.push((name, value));
        self
    }
}
