//! Rigidly moving parts: connected parts of a mesh whose constraints all move as one rigid body. Such a part is not
//! deformed, so that a prediction says nothing about it.
//!
//! A node x is held along n at the value v. A rigid movement satisfies that where n . ((R - I) x + t) = v, which is
//! linear in the twelve numbers a of R - I and t. The squares of these equations, added up for each holder in one pass
//! over the nodes, are quadratic forms in a (12 x 12); the movement that satisfies all of them best is found by Gauss
//! and Newton's method on R and t, whatever the size of the mesh. With R - I = w x the same forms tell which small
//! motions a set of holders leaves free.

use nalgebra::{Matrix3, Matrix6, Rotation3, SMatrix, SVector, Vector6};

use super::conditions::{Conditions, NodeClass};
use super::constraint::Holder;
use super::freedom::Freedom;
use crate::mesh::connectivity::parts_by_nodes;
use crate::mesh::{Vector, VolumeMesh};
use crate::plan::doubt::farthest_apart;
use crate::plan::{NUMBERS, RigidMovement};

/// Holders move alike where each misses the common movement by at most this share of how far the part goes.
const ALIKE: f64 = 1e-3;

/// A part that goes less far than this, in mm, stays.
const STAYS_MM: f64 = 1e-6;

/// A part with at least this share of the skin is what the prediction is about.
const MUCH_SKIN: f64 = 0.1;

/// Movements are found to rounding in a few steps where there is one that satisfies all.
const STEPS: usize = 30;

/// A turn in radians, and a shift in units of the size, that is rounding.
const SMALL_STEP: f64 = 1e-14;

/// Directions that change nothing by more than this share of the largest are left alone.
const INDEPENDENT: f64 = 1e-12;

pub type Form = SMatrix<f64, NUMBERS, NUMBERS>;
type Numbers = SVector<f64, NUMBERS>;

/// All that one holder holds of a part: the mean over its nodes of the sum of (n . ((R - I) x + t) - v)^2, with x from the
/// centre of the part and lengths in units of its size.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldRows {
    pub holder: Holder,
    /// Nodes, and walls of nodes that slide.
    pub count: usize,
    pub form: Form,
    /// Of prescribed values.
    mixed: Numbers,
    square: f64,
}

/// A part connected by nodes, with its constraints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConnectedPart {
    pub nodes: usize,
    /// Its lowest node.
    pub first_node: u32,
    /// The share of the skin's nodes that are its, of those that are not held.
    pub skin_share: f64,
    /// The lowest and the highest corner of the box around it, in mm.
    pub corners: [Vector; 2],
    pub held: Vec<HeldRows>,
}

/// A part that goes along as one.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidPart {
    pub movement: RigidMovement,
    /// How far a corner of the box around it goes at most, in mm.
    pub farthest: f64,
}

/// The parts of a mesh that share no node, but for those that are bone through and through. `part_of_cell` is the part
/// of each cell by faces.
pub fn connected_parts(
    mesh: &VolumeMesh,
    part_of_cell: &[u32],
    conditions: &Conditions,
    skin: &[u32],
) -> Vec<ConnectedPart> {
    let mut part_of_node = vec![None; mesh.nodes.len()];
    for ((_, nodes), part) in mesh.cells.iter().zip(parts_by_nodes(mesh, part_of_cell)) {
        nodes.iter().for_each(|&node| part_of_node[node as usize] = Some(part));
    }
    let count = part_of_node.iter().flatten().max().map_or(0, |last| *last as usize + 1);
    let mut parts = vec![ConnectedPart::default(); count];
    let mut fully_constrained = vec![false; mesh.nodes.len()];
    for (node, (part, place)) in part_of_node.iter().zip(&mesh.nodes).enumerate() {
        if let Some(part) = part {
            parts[*part as usize].take_in(node as u32, place);
        }
    }
    for constraint in conditions.constraints.iter().filter(|constraint| constraint.count() == 3) {
        fully_constrained[constraint.node as usize] = true;
    }
    // Skin that is held is bone; where all of it is, it is what there is.
    let mut free: Vec<u32> = skin.to_vec();
    free.retain(|node| !fully_constrained[*node as usize]);
    let skin = if free.is_empty() { skin } else { &free[..] };
    for part in skin.iter().filter_map(|node| part_of_node[*node as usize]) {
        parts[part as usize].skin_share += 1.0 / skin.len() as f64;
    }
    for constraint in &conditions.constraints {
        let Some(part) = part_of_node[constraint.node as usize] else { continue };
        let part = &mut parts[part as usize];
        let arm = part.arm(&mesh.nodes[constraint.node as usize]);
        let (identity, scale) = (Matrix3::identity(), part.size());
        match conditions.classes[constraint.node as usize] {
            NodeClass::Fixed => part.rows_of(Holder::Rest).add(&arm, &identity),
            NodeClass::Joined(segment) => {
                part.rows_of(Holder::Segment(segment)).add(&arm, &identity);
            }
            NodeClass::Sliding => {
                for wall in conditions.walls.get(&constraint.node).into_iter().flatten() {
                    let holder = wall.carrier.map_or(Holder::Rest, Holder::Segment);
                    let across = wall.normal * wall.normal.transpose();
                    part.rows_of(holder).add(&arm, &across);
                }
            }
            NodeClass::Prescribed => {
                let rows = part.rows_of(Holder::Prescribed);
                let axes = constraint.axes().columns(0, constraint.count());
                rows.add(&arm, &(axes * axes.transpose()));
                for held in 0..constraint.count() {
                    let axis = constraint.axes().column(held).into_owned();
                    rows.add_value(&arm, &axis, constraint.values()[held] / scale);
                }
            }
            NodeClass::Free => {}
        }
    }
    parts.iter_mut().flat_map(|part| &mut part.held).for_each(HeldRows::finish);
    let mut has_tissue = vec![false; parts.len()];
    for (part, held) in part_of_node.iter().zip(fully_constrained) {
        part.iter().filter(|_| !held).for_each(|part| has_tissue[*part as usize] = true);
    }
    let mut has_tissue = has_tissue.into_iter();
    parts.retain(|part| has_tissue.next().unwrap_or(true) || part.has_much_skin());
    parts
}

impl HeldRows {
    fn empty(holder: Holder) -> Self {
        let (form, mixed) = (Form::zeros(), Numbers::zeros());
        HeldRows { holder, count: 0, form, mixed, square: 0.0 }
    }

    /// The rows of a segment, or of what stays, as they were told.
    pub fn from_form(holder: Holder, count: usize, form: Form) -> Self {
        HeldRows { count, form, ..HeldRows::empty(holder) }
    }

    /// Adds the directions of a node, given by the sum of n n^T.
    fn add(&mut self, arm: &[f64; 4], across: &Matrix3<f64>) {
        self.count += 1;
        for (i, k) in (0..9).map(|entry| (entry / 3, entry % 3)) {
            if across[(i, k)] == 0.0 {
                continue;
            }
            for (j, l) in (0..16).map(|entry| (entry / 4, entry % 4)) {
                self.form[(4 * i + j, 4 * k + l)] += across[(i, k)] * arm[j] * arm[l];
            }
        }
    }

    /// Adds the value at which a direction is held.
    fn add_value(&mut self, arm: &[f64; 4], axis: &Vector, value: f64) {
        for (i, j) in (0..NUMBERS).map(|number| (number / 4, number % 4)) {
            self.mixed[4 * i + j] += axis[i] * value * arm[j];
        }
        self.square += value * value;
    }

    /// Sums become means.
    fn finish(&mut self) {
        let count = self.count.max(1) as f64;
        self.form /= count;
        self.mixed /= count;
        self.square /= count;
    }
}

/// A quadratic form a . G a - 2 b . a + c.
struct Misfit {
    form: Form,
    mixed: Numbers,
}

/// A rigid movement about the centre of a part, lengths in units of its size.
#[derive(Clone, Copy)]
struct Scaled {
    rotation: Matrix3<f64>,
    translation: Vector,
}

impl Scaled {
    fn numbers(&self) -> Numbers {
        Numbers::from_fn(|number, _| match (number / 4, number % 4) {
            (i, 3) => self.translation[i],
            (i, j) => self.rotation[(i, j)] - f64::from(u8::from(i == j)),
        })
    }

    /// What the numbers change by for a unit of each small turn and each small shift: shifts first.
    fn derivative(&self) -> SMatrix<f64, NUMBERS, 6> {
        let mut derivative = SMatrix::zeros();
        for axis in 0..3 {
            derivative[(4 * axis + 3, axis)] = 1.0;
            let turned = Vector::ith(axis, 1.0).cross_matrix() * self.rotation;
            for (i, j) in (0..9).map(|entry| (entry / 3, entry % 3)) {
                derivative[(4 * i + j, 3 + axis)] = turned[(i, j)];
            }
        }
        derivative
    }

    fn stepped(&self, step: &Vector6<f64>) -> Scaled {
        let turn = Rotation3::from_scaled_axis(step.fixed_rows::<3>(3).into_owned());
        Scaled {
            rotation: turn.matrix() * self.rotation,
            translation: self.translation + step.fixed_rows::<3>(0),
        }
    }
}

impl Misfit {
    /// Gauss and Newton's method from a movement; combinations that change nothing stay as they are.
    fn least(&self, start: Scaled) -> Scaled {
        let mut at = start;
        for _ in 0..STEPS {
            let derivative = at.derivative();
            let slope = derivative.tr_mul(&(self.form * at.numbers() - self.mixed));
            let normal: Matrix6<f64> = derivative.tr_mul(&(self.form * derivative));
            let eigen = normal.symmetric_eigen();
            let least = INDEPENDENT * eigen.eigenvalues.max();
            let mut step = Vector6::zeros();
            for (value, way) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
                if *value > least {
                    step -= way * (way.dot(&slope) / value);
                }
            }
            at = at.stepped(&step);
            if step.norm() < SMALL_STEP {
                break;
            }
        }
        at
    }
}

impl ConnectedPart {
    fn take_in(&mut self, node: u32, place: &Vector) {
        if self.nodes == 0 {
            (self.first_node, self.corners) = (node, [*place; 2]);
        }
        self.nodes += 1;
        self.corners = [self.corners[0].inf(place), self.corners[1].sup(place)];
    }

    fn centre(&self) -> Vector {
        (self.corners[0] + self.corners[1]) * 0.5
    }

    /// Half the diagonal of its box, in mm.
    fn size(&self) -> f64 {
        let half = (self.corners[1] - self.corners[0]).norm() * 0.5;
        if half > 0.0 { half } else { 1.0 }
    }

    /// A place from the centre, in units of the size, and 1.
    fn arm(&self, place: &Vector) -> [f64; 4] {
        let arm = (place - self.centre()) / self.size();
        [arm.x, arm.y, arm.z, 1.0]
    }

    fn rows_of(&mut self, holder: Holder) -> &mut HeldRows {
        let place = self.held.iter().position(|rows| rows.holder == holder);
        let place = place.unwrap_or_else(|| {
            self.held.push(HeldRows::empty(holder));
            self.held.len() - 1
        });
        &mut self.held[place]
    }

    /// Whether the part has a notable share of the skin.
    pub fn has_much_skin(&self) -> bool {
        self.skin_share >= MUCH_SKIN
    }

    /// The segments that hold it.
    pub fn segments(&self) -> impl Iterator<Item = u32> {
        self.held.iter().filter_map(|rows| match rows.holder {
            Holder::Segment(segment) => Some(segment),
            Holder::Rest | Holder::Prescribed => None,
        })
    }

    /// The same part where only some segments may move, each by another number.
    pub fn with_segments(mut self, number: impl Fn(u32) -> Option<u32>) -> Self {
        for rows in &mut self.held {
            if let Holder::Segment(segment) = rows.holder {
                rows.holder = number(segment).map_or(Holder::Rest, Holder::Segment);
            }
        }
        self
    }

    /// The small motions that some of its holders leave free.
    pub fn freedom(&self, stays: impl Fn(Holder) -> bool) -> Freedom {
        let still = Scaled { rotation: Matrix3::identity(), translation: Vector::zeros() };
        let derivative = still.derivative();
        let staying = self.held.iter().filter(|rows| stays(rows.holder));
        let form: Form = staying.map(|rows| rows.form).sum();
        let gram: Matrix6<f64> = derivative.tr_mul(&(form * derivative));
        Freedom::of(&gram, &self.centre(), self.size())
    }

    /// The common rigid movement of all constraints of the part, if there is one and the part does not stay.
    pub fn carried(&self, movement: impl Fn(u32) -> RigidMovement) -> Option<RigidPart> {
        let targets: Vec<Option<Numbers>> =
            self.held.iter().map(|rows| self.target(rows.holder, &movement)).collect();
        let mut misfit = Misfit { form: Form::zeros(), mixed: Numbers::zeros() };
        for (rows, target) in self.held.iter().zip(&targets) {
            misfit.form += rows.form;
            misfit.mixed += target.map_or(rows.mixed, |target| rows.form * target);
        }
        // What no holder decides stays, where it may; else it goes with a segment.
        let starts = std::iter::once(RigidMovement::default());
        for start in starts.chain(self.segments().map(&movement)) {
            let found = misfit.least(self.scaled(&start));
            let carried = self.movement_of(&found);
            let farthest = farthest_apart(&carried, &RigidMovement::default(), &self.corners);
            let most = ALIKE * farthest.max(STAYS_MM) / self.size();
            let numbers = found.numbers();
            let follows = |(rows, target): (&HeldRows, &Option<Numbers>)| {
                rows.missed(&numbers, target.as_ref()) <= most * most
            };
            if self.held.iter().zip(&targets).all(follows) {
                return (farthest > STAYS_MM).then_some(RigidPart { movement: carried, farthest });
            }
        }
        None
    }

    /// The numbers of a holder's movement; none where every node has a value of its own.
    fn target(&self, holder: Holder, movement: &impl Fn(u32) -> RigidMovement) -> Option<Numbers> {
        match holder {
            Holder::Rest => Some(Numbers::zeros()),
            Holder::Segment(segment) => Some(self.scaled(&movement(segment)).numbers()),
            Holder::Prescribed => None,
        }
    }

    fn scaled(&self, movement: &RigidMovement) -> Scaled {
        let translation = movement.displacement(&self.centre()) / self.size();
        Scaled { rotation: *movement.rotation(), translation }
    }

    fn movement_of(&self, scaled: &Scaled) -> RigidMovement {
        RigidMovement::about_centre(
            scaled.rotation,
            &self.centre(),
            scaled.translation * self.size(),
        )
    }
}

impl HeldRows {
    /// The mean square by which a movement misses the values.
    fn missed(&self, numbers: &Numbers, target: Option<&Numbers>) -> f64 {
        match target {
            Some(target) => {
                let apart = numbers - target;
                apart.dot(&(self.form * apart))
            }
            None => {
                numbers.dot(&(self.form * numbers)) - 2.0 * numbers.dot(&self.mixed) + self.square
            }
        }
    }
}
