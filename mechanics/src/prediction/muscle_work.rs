//! What finding the cells of muscles takes, told before it begins.

use rayon::prelude::*;

use super::case::{BodyFibres, Muscle, MuscleCourse};
use super::check::Check;
use super::error_code::SceneErrorCode;
use crate::mesh::{Vector, VolumeMesh, bounds_of, boxes_meet};

/// Comparisons that find the cells of all muscles of a case: cells near a muscle times its sample points and the pieces of its lines, and
/// what else costs as much. 15 muscles around lines in a face of 300 000 cells take a thirtieth.
pub const MOST_MUSCLE_WORK: u64 = 1_000_000_000;

/// As many comparisons are as costly as a cell with its stress.
const CELL: u64 = 100;
/// As a body, which tells its inside from cubes of space, and as each of its triangles.
const BODY: u64 = 2_000_000;
const TRIANGLE: u64 = 100;

type Bounds = Option<[Vector; 2]>;

/// Of a muscle.
struct Work {
    around: Bounds,
    /// The cells whose boxes meet its own.
    cells: u64,
    /// Sample points and pieces of lines with which each of them is compared.
    compared: u64,
    /// Comparisons as costly as its surface.
    surface: u64,
}

impl Work {
    fn count(&self) -> u64 {
        self.cells * (self.compared + CELL) + self.surface
    }
}

/// Where to look for the cells of muscles.
pub(super) struct NearMuscles {
    works: Vec<Work>,
    /// Of cells.
    boxes: Vec<Bounds>,
}

impl NearMuscles {
    fn new(mesh: &VolumeMesh, muscles: &[Muscle], samples: usize) -> NearMuscles {
        if muscles.is_empty() {
            return NearMuscles { works: Vec::new(), boxes: Vec::new() };
        }
        let around = |cell: usize| bounds_of(mesh.corners(cell));
        let boxes: Vec<Bounds> = (0..mesh.cells.len()).into_par_iter().map(around).collect();
        let work = |muscle: &Muscle| {
            let own = work(muscle, samples as u64);
            let cells = boxes.iter().filter(|other| meet(&own.around, other)).count() as u64;
            Work { cells, ..own }
        };
        NearMuscles { works: muscles.par_iter().map(work).collect(), boxes }
    }

    /// The cells whose boxes meet that of a muscle, ascending.
    pub(super) fn cells(&self, muscle: usize) -> Vec<u32> {
        let around = &self.works[muscle].around;
        let cells = (0..self.boxes.len() as u32).into_par_iter();
        cells.filter(|cell| meet(around, &self.boxes[*cell as usize])).collect()
    }
}

impl Check<'_> {
    /// Where the cells of the muscles may be; refused where it would take too long to find them there.
    pub(super) fn near_muscles(&mut self) -> Option<NearMuscles> {
        let (case, samples) = (self.case, self.case.muscle_mixing.samples);
        let near = NearMuscles::new(&case.volume, &case.muscles, samples);
        let all: u64 = near.works.iter().map(Work::count).sum();
        let costly = case.muscles.iter().zip(&near.works).max_by_key(|(_, work)| work.count());
        let Some((muscle, own)) = costly.filter(|_| all > MOST_MUSCLE_WORK) else {
            return Some(near);
        };
        let Work { cells, compared, surface, .. } = own;
        let detail = format!(
            "{all} comparisons find the cells of the muscles, at most {MOST_MUSCLE_WORK} are made; {} of them for muscle {:?}, {cells} cells near \
             it times {compared} pieces of lines and sample points + {CELL}, and {surface} for its surface: state fewer points, a smaller \
             `within_mm`, fewer `samples` or triangles",
            own.count(),
            muscle.name
        );
        self.problems.add("/case/muscles", SceneErrorCode::TooMany, detail);
        None
    }
}

/// That of a muscle, before its cells are counted.
fn work(muscle: &Muscle, samples: u64) -> Work {
    let (around, compared, surface) = match &muscle.course {
        MuscleCourse::Region { .. } => (None, 0, 0),
        MuscleCourse::Lines { lines, within } => (reach(lines, *within), pieces(lines), 0),
        MuscleCourse::Body { surface, fibres } => {
            let lines = match fibres {
                BodyFibres::Lines(lines) => pieces(lines),
                BodyFibres::Course(_) | BodyFibres::Box { .. } => 0,
            };
            let cost = BODY + TRIANGLE * surface.triangles.len() as u64;
            (bounds_of(&surface.points), samples + lines, cost)
        }
    };
    Work { around, cells: 0, compared, surface }
}

fn meet(one: &Bounds, other: &Bounds) -> bool {
    one.as_ref().zip(other.as_ref()).is_some_and(|(one, other)| boxes_meet(one, other))
}

fn pieces(lines: &[Vec<Vector>]) -> u64 {
    lines.iter().map(|line| line.len().saturating_sub(1) as u64).sum()
}

fn reach(lines: &[Vec<Vector>], within: f64) -> Option<[Vector; 2]> {
    let [low, high] = bounds_of(lines.iter().flatten())?;
    let margin = Vector::repeat(within);
    Some([low - margin, high + margin])
}
