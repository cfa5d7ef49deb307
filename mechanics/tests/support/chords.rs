//! Chords of bodies given by closed surfaces: where lines along y enter and leave them, and how much of two bodies differs.

use mechanics::mesh::{TriangleSurface, Vector};

/// Lines along x and along z.
const LINES: usize = 160;

/// Lines along y through a grid of the x-z plane.
#[derive(Clone, Copy, Debug)]
pub struct Lines {
    low: Vector,
    step: [f64; 2],
}

/// For each line where a surface passes it: the depth, and by how much more the surface goes around what lies beyond.
pub struct Chords(Vec<Vec<(f64, i32)>>);

impl Lines {
    /// All through a box and a little beyond.
    pub fn through(low: &Vector, high: &Vector) -> Lines {
        let margin = (high - low) * 0.02;
        let (low, high) = (low - margin, high + margin);
        let step = |axis: usize| (high[axis] - low[axis]) / LINES as f64;
        Lines { low, step: [step(0), step(2)] }
    }

    /// The area that a line stands for, in mm².
    fn area(&self) -> f64 {
        self.step[0] * self.step[1]
    }

    /// Beside the middles, so that no line meets an edge.
    pub fn at(&self, [x, z]: [usize; 2]) -> [f64; 2] {
        let place = |n: usize, axis: usize, beside: f64| {
            self.low[2 * axis] + (n as f64 + beside) * self.step[axis]
        };
        [place(x, 0, 0.503_171_3), place(z, 1, 0.496_371_9)]
    }

    pub fn chords(&self, surface: &TriangleSurface) -> Chords {
        let mut found = vec![Vec::new(); LINES * LINES];
        for triangle in 0..surface.triangles.len() {
            self.pass(surface.corners(triangle), &mut found);
        }
        found.iter_mut().for_each(|line| line.sort_by(|a, b| a.0.total_cmp(&b.0)));
        Chords(found)
    }

    fn pass(&self, corners: [Vector; 3], found: &mut [Vec<(f64, i32)>]) {
        let span = |axis: usize| {
            let of =
                corners.map(|corner| (corner[2 * axis] - self.low[2 * axis]) / self.step[axis]);
            let least = of.into_iter().fold(f64::INFINITY, f64::min).max(0.0) as usize;
            let most = of.into_iter().fold(0.0, f64::max) as usize;
            least..(most + 1).min(LINES)
        };
        for x in span(0) {
            for z in span(1) {
                let at = self.at([x, z]);
                let part = |[a, b]: [usize; 2]| {
                    let [a, b] = [corners[a], corners[b]].map(|c| [c.x - at[0], c.z - at[1]]);
                    a[0] * b[1] - a[1] * b[0]
                };
                let parts = [[1, 2], [2, 0], [0, 1]].map(part);
                let sum: f64 = parts.iter().sum();
                if parts.iter().all(|&part| part * sum > 0.0) {
                    let depth = (0..3).map(|n| parts[n] / sum * corners[n].y).sum();
                    found[z * LINES + x].push((depth, if sum > 0.0 { 1 } else { -1 }));
                }
            }
        }
    }

    /// The volume in one of two bodies alone, in mm³, of stretches of lines whose middles count.
    pub fn difference(
        &self,
        one: &Chords,
        other: &Chords,
        counts: impl Fn(&Vector) -> bool,
    ) -> f64 {
        let mut sum = 0.0;
        for (line, (one, other)) in one.0.iter().zip(&other.0).enumerate() {
            let [x, z] = self.at([line % LINES, line / LINES]);
            let of = |&[from, to]: &[f64; 2]| {
                let middle = Vector::new(x, f64::midpoint(from, to), z);
                if counts(&middle) { to - from } else { 0.0 }
            };
            sum += differing(one, other).iter().map(of).sum::<f64>();
        }
        sum * self.area()
    }
}

impl Chords {
    /// The pairs of depths between which a line lies in the body.
    pub fn inside(&self, [x, z]: [usize; 2]) -> Vec<[f64; 2]> {
        let mut around = 0;
        let mut found = Vec::new();
        for pair in self.0[z * LINES + x].windows(2) {
            around += pair[0].1;
            if around != 0 {
                found.push([pair[0].0, pair[1].0]);
            }
        }
        found
    }
}

/// The stretches of a line that lie in one of two bodies alone.
fn differing(one: &[(f64, i32)], other: &[(f64, i32)]) -> Vec<[f64; 2]> {
    let of = |list: &[(f64, i32)], body: usize| -> Vec<(f64, i32, usize)> {
        list.iter().map(|&(depth, more)| (depth, more, body)).collect()
    };
    let mut all = [of(one, 0), of(other, 1)].concat();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut around = [0, 0];
    let mut found = Vec::new();
    for pair in all.windows(2) {
        around[pair[0].2] += pair[0].1;
        if (around[0] != 0) != (around[1] != 0) {
            found.push([pair[0].0, pair[1].0]);
        }
    }
    found
}

pub const COUNT: usize = LINES;
