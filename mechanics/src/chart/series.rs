//! The ways of modelling of a study as series of its charts: one symbol each, whichever of them a chart shows.

/// A way of modelling.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MethodSeries {
    /// In words.
    pub name: String,
    /// As its rows are called.
    pub label: String,
    /// As documents call it.
    pub method: String,
}

impl MethodSeries {
    /// For programs.
    pub(super) fn data(&self) -> Vec<(&'static str, String)> {
        vec![("label", self.label.clone()), ("method", self.method.clone())]
    }
}

/// The same of a mark on one mesh.
pub(super) fn mark_data(
    series: &[MethodSeries],
    place: usize,
    level: u32,
) -> Vec<(&'static str, String)> {
    let mut data = series.get(place).map_or_else(Vec::new, MethodSeries::data);
    data.push(("level", level.to_string()));
    data
}
