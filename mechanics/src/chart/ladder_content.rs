//! Content of a chart of speed and accuracy: what is drawn, and how it is called.

use super::series::MethodSeries;

/// Content of the picture.
pub struct LadderPicture<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    /// The methods of the study, in the order of the legend, which has those with marks or failures.
    pub series: &'a [MethodSeries],
    pub marks: &'a [LadderMark],
    pub failures: &'a [LadderFailure],
    /// Lines for the foot of the picture.
    pub notes: &'a [String],
}

/// One method on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct LadderMark {
    /// Its place in `series`.
    pub series: usize,
    /// How often each edge of the mesh was halved.
    pub level: u32,
    pub wall_s: f64,
    pub error_mm: f64,
    /// Whether no other is both faster and nearer to the truth.
    pub on_front: bool,
    /// Time and error of each run that the mark stands for, if there are several.
    pub runs: Vec<[f64; 2]>,
}

/// One method that gave no answer on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct LadderFailure {
    pub series: usize,
    pub level: u32,
    /// In a few words.
    pub reason: String,
}

impl LadderPicture<'_> {
    /// Mesh levels that are drawn, ascending.
    pub(super) fn levels(&self) -> Vec<u32> {
        let failed = self.failures.iter().map(|failure| failure.level);
        let mut levels: Vec<u32> = self.marks.iter().map(|mark| mark.level).chain(failed).collect();
        levels.sort_unstable();
        levels.dedup();
        levels
    }

    /// The places of the methods that are drawn.
    pub(super) fn shown(&self) -> Vec<usize> {
        let failed = self.failures.iter().map(|failure| failure.series);
        let mut shown: Vec<usize> =
            self.marks.iter().map(|mark| mark.series).chain(failed).collect();
        shown.sort_unstable();
        shown.dedup();
        shown
    }

    pub(super) fn name(&self, series: usize) -> &str {
        self.series.get(series).map_or("?", |series| series.name.as_str())
    }

    /// A name with its mesh level, where there are several.
    pub(super) fn full_name(&self, series: usize, level: u32) -> String {
        match self.levels().len() {
            0 | 1 => self.name(series).to_owned(),
            _ => format!("{}, level {level}", self.name(series)),
        }
    }

    /// How large and how full a mark of a mesh level is.
    pub(super) fn size(&self, level: u32) -> (f64, f64) {
        let levels = self.levels();
        let place = levels.iter().position(|other| *other == level).unwrap_or_default() as f64;
        match levels.len() {
            0 | 1 => (7.5, 1.0),
            count => (6.2 + 1.3 * place, place / (count - 1) as f64),
        }
    }
}
