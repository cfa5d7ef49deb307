//! Cubic B-spline lattices: free-form deformations u(x) = Σ B(x/h - i) c_i, and their refinement.
//!
//! Source: Rueckert et al., IEEE Transactions on Medical Imaging 18 (1999) 712 (the deformation); Lee, Wolberg, Shin,
//! IEEE Transactions on Visualization and Computer Graphics 3 (1997) 228 (lattices from coarse to fine). A lattice of
//! half the spacing holds the same function: c'_{2i} = (c_{i-1} + 6 c_i + c_{i+1}) / 8 and
//! c'_{2i+1} = (c_i + c_{i+1}) / 2 in each direction.

use nalgebra::Matrix3;

use crate::mesh::Vector;

/// The lowest and the highest corner of a box along the axes, in mm.
pub(super) type Aabb = [Vector; 2];

/// The number of a control point that reaches none of the boxes.
const IDLE: u32 = u32::MAX;

/// Where control points stand, and which of them reach the boxes that are deformed: only those count.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lattice {
    /// Of the first place, in mm.
    origin: Vector,
    /// Between neighbours, in mm.
    pub spacing: f64,
    /// Places in each direction.
    size: [usize; 3],
    /// For each place the number of its control point.
    numbers: Vec<u32>,
    /// For each control point its place.
    places: Vec<u32>,
}

/// A second difference of up to four control points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference {
    pub controls: [u32; 4],
    pub weights: [f64; 4],
    pub count: f64,
}

/// The 64 control points that reach a point, and how much each counts in each direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Support {
    first: usize,
    weights: [[f64; 4]; 3],
}

/// A displacement field, in mm.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub lattice: Lattice,
    pub controls: Vec<Vector>,
}

impl Lattice {
    /// The lattice whose functions add up to one in some boxes.
    pub fn around(boxes: &[Aabb], spacing: f64) -> Lattice {
        let first = boxes.first().copied().unwrap_or_default();
        let [low, high] = boxes.iter().fold(first, |a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])]);
        let cells = (high - low).map(|side| (side / spacing).ceil().max(1.0));
        let origin = (low + high) * 0.5 - cells * (0.5 * spacing) - Vector::repeat(spacing);
        let size = [cells.x, cells.y, cells.z].map(|cells| cells as usize + 3);
        Lattice::reaching(boxes, origin, spacing, size)
    }

    fn reaching(boxes: &[Aabb], origin: Vector, spacing: f64, size: [usize; 3]) -> Lattice {
        let numbers = vec![IDLE; size.iter().product()];
        let mut lattice = Lattice { origin, spacing, size, numbers, places: Vec::new() };
        let mut reached = vec![false; lattice.numbers.len()];
        boxes.iter().for_each(|one| lattice.reach(one, &mut reached));
        for (place, _) in reached.iter().enumerate().filter(|(_, reached)| **reached) {
            lattice.numbers[place] = lattice.places.len() as u32;
            lattice.places.push(place as u32);
        }
        lattice
    }

    /// Notes the places that reach a box.
    fn reach(&self, [low, high]: &Aabb, reached: &mut [bool]) {
        let steps = self.steps();
        let [x, y, z] =
            [0, 1, 2].map(|axis| self.cell(low, axis).0 - 1..=self.cell(high, axis).0 + 2);
        for k in z {
            for j in y.clone() {
                x.clone().for_each(|i| reached[i + j * steps[1] + k * steps[2]] = true);
            }
        }
    }

    /// The number of control points.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// From a place to the next in each direction.
    fn steps(&self) -> [usize; 3] {
        [1, self.size[0], self.size[0] * self.size[1]]
    }

    /// Calls with each control point that reaches a point, and its weight.
    #[inline(always)]
    pub fn each(&self, support: &Support, mut visit: impl FnMut(usize, f64)) {
        support.each(self.steps(), |place, weight| visit(self.numbers[place] as usize, weight));
    }

    /// Every second difference of neighbours that all count: their weights, and how often it counts.
    pub fn differences(&self) -> Vec<Difference> {
        let steps = self.steps();
        let mut found = Vec::new();
        for &at in &self.places {
            let at = at as usize;
            let place = [0, 1, 2].map(|axis| at / steps[axis] % self.size[axis]);
            let has_room = |axis: usize, more: usize| place[axis] + more < self.size[axis];
            for axis in 0..3 {
                let other = (axis + 1) % 3;
                let (step, cross) = (steps[axis], steps[other]);
                if has_room(axis, 2) {
                    let places = [at, at + step, at + 2 * step, at];
                    found.extend(self.difference(places, [1.0, -2.0, 1.0, 0.0], 1.0));
                }
                if has_room(axis, 1) && has_room(other, 1) {
                    let places = [at, at + step, at + cross, at + step + cross];
                    found.extend(self.difference(places, [1.0, -1.0, -1.0, 1.0], 2.0));
                }
            }
        }
        found
    }

    fn difference(&self, places: [usize; 4], weights: [f64; 4], count: f64) -> Option<Difference> {
        let controls = places.map(|place| self.numbers[place]);
        let counts = controls.iter().all(|control| *control != IDLE);
        counts.then_some(Difference { controls, weights, count })
    }

    /// What reaches a point; outside the box what reaches the nearest point of its border.
    pub fn support(&self, point: &Vector) -> Support {
        let steps = self.steps();
        let mut first = 0;
        let weights = std::array::from_fn(|axis| {
            let (cell, local) = self.cell(point, axis);
            first += (cell - 1) * steps[axis];
            basis(local)
        });
        Support { first, weights }
    }

    fn cell(&self, point: &Vector, axis: usize) -> (usize, f64) {
        let last = self.size[axis] as f64 - 2.0;
        let place = ((point[axis] - self.origin[axis]) / self.spacing).clamp(1.0, last);
        let cell = (place.floor() as usize).min(self.size[axis] - 3);
        (cell, place - cell as f64)
    }

    fn slopes(&self, point: &Vector) -> [[f64; 4]; 3] {
        std::array::from_fn(|axis| slope(self.cell(point, axis).1).map(|s| s / self.spacing))
    }
}

/// The cubic B-splines of the four control points about a cell.
fn basis(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
        (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
        t * t * t / 6.0,
    ]
}

fn slope(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-0.5 * s * s, 1.5 * t * t - 2.0 * t, -1.5 * s * s + 2.0 * s, 0.5 * t * t]
}

impl Support {
    /// Calls with each place and its weight.
    #[inline(always)]
    fn each(&self, steps: [usize; 3], mut visit: impl FnMut(usize, f64)) {
        for (k, wz) in self.weights[2].iter().enumerate() {
            for (j, wy) in self.weights[1].iter().enumerate() {
                let (row, weight) = (self.first + k * steps[2] + j * steps[1], wz * wy);
                for (i, wx) in self.weights[0].iter().enumerate() {
                    visit(row + i, weight * wx);
                }
            }
        }
    }
}

impl Field {
    pub fn zero(lattice: Lattice) -> Field {
        let controls = vec![Vector::zeros(); lattice.len()];
        Field { lattice, controls }
    }

    pub fn at(&self, point: &Vector) -> Vector {
        self.sum(&self.lattice.support(point))
    }

    fn sum(&self, support: &Support) -> Vector {
        let mut sum = Vector::zeros();
        support.each(self.lattice.steps(), |place, weight| sum += self.control(place) * weight);
        sum
    }

    /// Zero where nothing was deformed.
    #[inline(always)]
    fn control(&self, place: usize) -> Vector {
        self.controls.get(self.lattice.numbers[place] as usize).copied().unwrap_or_default()
    }

    /// ∂u/∂x.
    pub fn gradient(&self, point: &Vector) -> Matrix3<f64> {
        let (support, slopes) = (self.lattice.support(point), self.lattice.slopes(point));
        let columns = [0, 1, 2].map(|axis| {
            let mut along = support;
            along.weights[axis] = slopes[axis];
            self.sum(&along)
        });
        Matrix3::from_columns(&columns)
    }

    /// The same function in the boxes, on a lattice of half the spacing.
    pub fn refined(&self, boxes: &[Aabb]) -> Field {
        let coarse = &self.lattice;
        let size = coarse.size.map(|size| 2 * size - 3);
        // The first place of the fine lattice lies half a coarse step in.
        let origin = coarse.origin + Vector::repeat(0.5 * coarse.spacing);
        let lattice = Lattice::reaching(boxes, origin, 0.5 * coarse.spacing, size);
        let steps = lattice.steps();
        let control = |&at: &u32| {
            let place = [0, 1, 2].map(|axis| at as usize / steps[axis] % lattice.size[axis]);
            self.refined_control(place)
        };
        let controls = lattice.places.iter().map(control).collect();
        Field { lattice, controls }
    }

    fn refined_control(&self, place: [usize; 3]) -> Vector {
        // From a fine place the coarse ones that make it in one direction, and their weights.
        let parents = place.map(|number| match number % 2 {
            0 => (number / 2, [0.5, 0.5, 0.0]),
            _ => (number / 2, [0.125, 0.75, 0.125]),
        });
        let steps = self.lattice.steps();
        let mut sum = Vector::zeros();
        for code in 0..27 {
            let offsets = [code % 3, code / 3 % 3, code / 9];
            let parts = parents.iter().zip(offsets);
            let weight: f64 = parts.map(|((_, weights), offset)| weights[offset]).product();
            if weight > 0.0 {
                let at = |axis: usize| (parents[axis].0 + offsets[axis]) * steps[axis];
                sum += self.control(at(0) + at(1) + at(2)) * weight;
            }
        }
        sum
    }
}
