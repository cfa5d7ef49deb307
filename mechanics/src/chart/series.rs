//! Series of a study's charts: one symbol for each model, the same in every chart.

use super::drawing::{Document, Style};
use super::symbol::Symbol;

/// A model.
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
    /// Its line in a legend, `place` its own among the series.
    pub(super) fn write_entry(
        &self,
        document: &mut Document,
        place: usize,
        [x, y]: [f64; 2],
        room: f64,
    ) {
        document.open_with("legend", &self.name, self.data());
        Symbol::of(place).draw(document, [x + 9.0, y - 4.0], 6.8, 1.0);
        document.text([x + 26.0, y], room - 26.0, Style::of(12.5), &self.name);
        document.close();
    }

    /// For programs.
    fn data(&self) -> Vec<(&'static str, String)> {
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
