//! The Euclidean distance of every voxel to a mask, exact, in mm, on voxels that need not be cubes.
//!
//! Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing 8 (2012): along one axis
//! after the other, the lower envelope of the parabolas f(q) + s² (p - q)².

use rayon::prelude::*;

use super::mask::{Grid, Mask};

/// The squared distance from the centre of each voxel to the nearest centre within the mask, in mm²; infinite where the
/// mask is empty. Rounded to single precision after each axis.
pub fn squared_distance(mask: &Mask) -> Vec<f32> {
    let zero_inside = |&inside: &bool| if inside { 0.0 } else { f32::INFINITY };
    let mut values: Vec<f32> = mask.inside.par_iter().map(zero_inside).collect();
    // Each pass leaves its own axis the fastest, which turns the axes round once in three passes.
    let mut axes = [0, 1, 2];
    for _ in 0..3 {
        values = along_first(&values, &mask.grid, axes);
        axes.rotate_left(1);
        values = turned(&values, axes.map(|axis| mask.grid.size[axis]));
    }
    values
}

/// The distance itself, in mm.
pub fn distance(mask: &Mask) -> Vec<f32> {
    let mut values = squared_distance(mask);
    values.par_iter_mut().for_each(|value| *value = value.sqrt());
    values
}

/// One pass along the axis that is the fastest.
fn along_first(values: &[f32], grid: &Grid, axes: [usize; 3]) -> Vec<f32> {
    let (length, spacing) = (grid.size[axes[0]], grid.spacing[axes[0]]);
    let mut passed = vec![0.0; values.len()];
    let lines = passed.par_chunks_mut(length).zip(values.par_chunks(length));
    lines.for_each_init(
        || Envelope::new(length, spacing),
        |envelope, (to, from)| envelope.pass(from, to),
    );
    passed
}

/// Values whose fastest axis was the last of these sizes, with the first of them the fastest.
fn turned(values: &[f32], [fast, middle, was_fast]: [usize; 3]) -> Vec<f32> {
    let mut turned = vec![0.0; values.len()];
    turned.par_chunks_mut(fast * middle).enumerate().for_each(|(place, slab)| {
        for (number, value) in slab.iter_mut().enumerate() {
            *value = values[place + was_fast * number];
        }
    });
    turned
}

/// The lower envelope of parabolas along one line.
struct Envelope {
    squared_spacing: f64,
    /// The places of the parabolas, and where each begins to be the lowest.
    roots: Vec<usize>,
    begins: Vec<f64>,
}

impl Envelope {
    fn new(length: usize, spacing: f64) -> Envelope {
        let squared_spacing = spacing * spacing;
        Envelope {
            squared_spacing,
            roots: Vec::with_capacity(length),
            begins: Vec::with_capacity(length),
        }
    }

    fn pass(&mut self, from: &[f32], to: &mut [f32]) {
        self.roots.clear();
        self.begins.clear();
        let s = self.squared_spacing;
        for (q, &value) in from.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let height = |q: usize, value: f32| f64::from(value) / s + (q * q) as f64;
            let mut begin = f64::NEG_INFINITY;
            while let (Some(&root), Some(&start)) = (self.roots.last(), self.begins.last()) {
                begin = (height(q, value) - height(root, from[root])) / (2 * (q - root)) as f64;
                if begin > start {
                    break;
                }
                self.roots.pop();
                self.begins.pop();
                begin = f64::NEG_INFINITY;
            }
            self.roots.push(q);
            self.begins.push(begin);
        }
        if self.roots.is_empty() {
            to.fill(f32::INFINITY);
            return;
        }
        let mut at = 0;
        for (p, to) in to.iter_mut().enumerate() {
            while self.begins.get(at + 1).is_some_and(|&begin| begin < p as f64) {
                at += 1;
            }
            let root = self.roots[at];
            let apart = p.abs_diff(root) as f64;
            *to = (f64::from(from[root]) + s * apart * apart) as f32;
        }
    }
}
