//! Image values of each cell of a mesh: its mean, and how much of it lies in which window.

use rayon::prelude::*;

use super::sampling::SamplingRule;
use super::volume::ImageVolume;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::progress::StopQuery;

/// Windows of values, from <= value < to, that do not overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Windows {
    /// By their lower ends, with their numbers.
    sorted: Vec<(f64, f64, usize)>,
}

impl Windows {
    /// The windows with their numbers in this order; `None` where two overlap or one is empty.
    pub fn new(windows: &[(f64, f64)]) -> Option<Windows> {
        let numbered = windows.iter().enumerate();
        let mut sorted: Vec<(f64, f64, usize)> =
            numbered.map(|(number, &(from, to))| (from, to, number)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_sound = sorted.iter().all(|(from, to, _)| from < to)
            && sorted.windows(2).all(|pair| pair[0].1 <= pair[1].0);
        is_sound.then_some(Windows { sorted })
    }

    pub fn len(&self) -> usize {
        self.sorted.len()
    }

    pub fn is_empty(&self) -> bool {
        self.sorted.is_empty()
    }

    /// The number of the window that a value lies in.
    pub fn of(&self, value: f64) -> Option<usize> {
        let after = self.sorted.partition_point(|&(from, ..)| from <= value);
        let &(_, to, number) = self.sorted.get(after.checked_sub(1)?)?;
        (value < to).then_some(number)
    }
}

/// Image values of each cell. A cell of which any point lies outside the image has no mean and no counts.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledCells {
    /// Points in each cell.
    pub samples: usize,
    pub mean: Vec<Option<f64>>,
    windows: usize,
    counts: Vec<u16>,
}

impl SampledCells {
    /// For each window how many points of a cell lie in it.
    pub fn counts(&self, cell: usize) -> &[u16] {
        &self.counts[cell * self.windows..][..self.windows]
    }
}

/// Samples every cell at the points of the rule. The same on any number of threads. After a stop cells have no mean.
pub fn sample_cells(
    mesh: &VolumeMesh,
    image: &ImageVolume,
    rule: &SamplingRule,
    windows: &Windows,
    stop: &StopQuery,
) -> SampledCells {
    let cells = mesh.cells.len();
    let mut counts = vec![0; cells * windows.len()];
    let mut mean = vec![None; cells];
    counts.par_chunks_mut(windows.len().max(1)).zip(&mut mean).enumerate().for_each(
        |(cell, (counts, mean))| {
            if stop.is_asked_at(cell) {
                return;
            }
            let corners: Vec<Vector> = mesh.corners(cell).collect();
            *mean = sample_cell((mesh.cells.shape(cell), &corners), image, rule, |value| {
                if let Some(window) = windows.of(value) {
                    counts[window] += 1;
                }
            });
            if mean.is_none() {
                counts.fill(0);
            }
        },
    );
    SampledCells { samples: rule.count, mean, windows: windows.len(), counts }
}

fn sample_cell(
    (shape, corners): (CellShape, &[Vector]),
    image: &ImageVolume,
    rule: &SamplingRule,
    mut each: impl FnMut(f64),
) -> Option<f64> {
    let mut sum = Some(0.0);
    rule.for_each(shape, corners, |point| {
        sum = sum.zip(image.at(&point)).map(|(sum, value)| {
            each(value);
            sum + value
        });
    });
    sum.map(|sum| sum / rule.count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_lies_in_at_most_one_window() {
        let windows = Windows::new(&[(100.0, 200.0), (-30.0, 100.0)]).unwrap();
        let found = [-31.0, -30.0, 99.9, 100.0, 199.0, 200.0].map(|value| windows.of(value));
        assert_eq!(found, [None, Some(1), Some(1), Some(0), Some(0), None]);
        assert!(Windows::new(&[(0.0, 10.0), (9.0, 12.0)]).is_none());
        assert!(Windows::new(&[(5.0, 5.0)]).is_none());
        assert!(Windows::new(&[(f64::NAN, 5.0)]).is_none());
    }
}
