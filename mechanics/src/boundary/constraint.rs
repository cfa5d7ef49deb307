//! Dirichlet boundary condition of one node: its constrained directions and their displacements.

use nalgebra::Matrix3;

use crate::mesh::Vector;

/// A direction whose part across the earlier ones is shorter than this adds nothing.
const INDEPENDENT: f64 = 1e-6;

/// What holds nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holder {
    /// Fixed nodes and walls that stay.
    Rest,
    /// Nodes and walls of a segment, by its number.
    Segment(u32),
    /// Nodes with prescribed displacements.
    Prescribed,
}

/// A node held at values u . e_k = v_k along the first `count` axes of an orthonormal frame,
/// and free along the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    pub node: u32,
    axes: Matrix3<f64>,
    values: Vector,
    count: usize,
    /// What the node belongs to altogether, if that is one thing.
    body: Option<Holder>,
}

impl Constraint {
    /// A node that nothing holds; among holds it says that the middle of an edge is free between held ends.
    pub fn free(node: u32) -> Self {
        Constraint {
            node,
            axes: Matrix3::identity(),
            values: Vector::zeros(),
            count: 0,
            body: None,
        }
    }

    /// A node held in all directions at a displacement in mm.
    pub fn at(node: u32, displacement: Vector) -> Self {
        Constraint { node, axes: Matrix3::identity(), values: displacement, count: 3, body: None }
    }

    /// The same node as one of a body.
    pub(in crate::boundary) fn of_body(self, body: Option<Holder>) -> Self {
        Constraint { body, ..self }
    }

    /// The body whose node this is: what stays, or a segment.
    pub fn body(&self) -> Option<Holder> {
        self.body
    }

    /// The part of a vector along the directions in which the node is held.
    pub fn part_along(&self, vector: &Vector) -> Vector {
        let own = self.axes().transpose() * vector;
        self.axes() * Vector::from_fn(|k, _| if k < self.count() { own[k] } else { 0.0 })
    }

    /// How many directions are held: 0 to 3.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The frame, one axis a column: held ones first.
    pub fn axes(&self) -> &Matrix3<f64> {
        &self.axes
    }

    /// Displacement in mm along the held axes; zero along the others.
    pub fn values(&self) -> &Vector {
        &self.values
    }

    /// Holds the node elsewhere along the same axes.
    pub fn set_values(&mut self, values: &Vector) {
        self.values = Vector::from_fn(|k, _| if k < self.count { values[k] } else { 0.0 });
    }

    /// True where the frame is that of the coordinates.
    pub fn is_aligned(&self) -> bool {
        self.axes == Matrix3::identity()
    }

    /// Holds u . direction = value too, unless earlier directions decide it already.
    pub(in crate::boundary) fn add(&mut self, direction: &Vector, value: f64) {
        let mut across = *direction;
        let mut rest = value;
        for held in 0..self.count {
            let axis = self.axes.column(held).into_owned();
            let along = axis.dot(direction);
            across -= axis * along;
            rest -= self.values[held] * along;
        }
        let length = across.norm();
        if length < INDEPENDENT {
            return;
        }
        self.axes.set_column(self.count, &(across / length));
        self.values[self.count] = rest / length;
        self.count += 1;
        self.complete_axes();
    }

    /// Makes the free axes orthonormal to the held ones.
    fn complete_axes(&mut self) {
        if self.count == 3 {
            return self.align_fully_held();
        }
        for free in self.count..3 {
            let mut best = Vector::zeros();
            for unit in [Vector::x(), Vector::y(), Vector::z()] {
                let mut across = unit;
                for earlier in 0..free {
                    let axis = self.axes.column(earlier).into_owned();
                    across -= axis * axis.dot(&unit);
                }
                if across.norm() > best.norm() + INDEPENDENT {
                    best = across;
                }
            }
            let mut axis = best.normalize();
            for earlier in 0..free {
                let other = self.axes.column(earlier).into_owned();
                axis -= other * other.dot(&axis);
            }
            self.axes.set_column(free, &axis.normalize());
        }
    }

    /// A node held in all directions needs no frame of its own.
    fn align_fully_held(&mut self) {
        if !self.is_aligned() {
            self.values = self.axes * self.values;
            self.axes = Matrix3::identity();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oblique_directions_hold_the_node_where_both_planes_meet() {
        let mut constraint = Constraint::free(0);
        let oblique = Vector::new(1.0, 1.0, 0.0).normalize();
        constraint.add(&Vector::x(), 2.0);
        constraint.add(&oblique, 0.0);
        let displacement = constraint.axes() * constraint.values();
        assert!((displacement.x - 2.0).abs() < 1e-15);
        assert!(displacement.dot(&oblique).abs() < 1e-15);
        assert_eq!(constraint.count(), 2);
    }

    #[test]
    fn a_direction_that_is_held_already_changes_nothing() {
        let mut constraint = Constraint::free(0);
        constraint.add(&Vector::z(), 1.0);
        let before = constraint.clone();
        constraint.add(&-Vector::z(), 5.0);
        assert_eq!(constraint, before);
    }

    #[test]
    fn the_frame_is_orthonormal_for_any_normal() {
        for normal in [Vector::new(0.3, -0.5, 0.8), Vector::new(1e-9, 1.0, 0.0), -Vector::x()] {
            let mut constraint = Constraint::free(0);
            constraint.add(&normal.normalize(), 0.0);
            let axes = constraint.axes();
            assert!((axes.transpose() * axes - Matrix3::identity()).amax() < 1e-15);
        }
    }

    #[test]
    fn a_node_held_in_three_oblique_directions_lies_at_their_common_point() {
        let mut constraint = Constraint::free(0);
        let target = Vector::new(1.0, -2.0, 3.0);
        let directions =
            [Vector::new(1.0, 1.0, 0.0), Vector::new(0.0, 1.0, 1.0), Vector::new(1.0, 0.0, 2.0)];
        for direction in directions.map(|d| d.normalize()) {
            constraint.add(&direction, direction.dot(&target));
        }
        assert!(constraint.is_aligned());
        assert!((constraint.values() - target).norm() < 1e-14);
    }
}
