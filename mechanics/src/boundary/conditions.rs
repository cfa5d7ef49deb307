//! Dirichlet boundary conditions of all nodes: prescribed, joined to a segment, fixed, sliding or free
//! (docs/methods.md#boundary-conditions; precedence at a node: prescribed component, joined, fixed, sliding, free).

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::constraint::{Constraint, Holder};
use crate::mesh::{Vector, Warning};
use crate::plan::RigidMovement;

/// Two displacements of one node that differ by more than this, in mm, contradict each other.
const CONTRADICTION: f64 = 1e-9;

/// Class of a node's boundary condition, strongest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NodeClass {
    Prescribed,
    /// The number of the segment in the case.
    Joined(u32),
    Fixed,
    Sliding,
    Free,
}

impl NodeClass {
    /// The class without the segment.
    pub fn name(self) -> &'static str {
        match self {
            NodeClass::Prescribed => "prescribed",
            NodeClass::Joined(_) => "joined",
            NodeClass::Fixed => "fixed",
            NodeClass::Sliding => "sliding",
            NodeClass::Free => "free",
        }
    }
}

/// Sets of nodes and what they are held to, as a case and a plan state them.
#[derive(Clone, Debug, Default)]
pub struct HeldNodes {
    /// Node and displacement in mm; `None` leaves a component to weaker conditions.
    pub prescribed: Vec<(u32, [Option<f64>; 3])>,
    /// One entry for each segment of the case.
    pub joined: Vec<(Vec<u32>, RigidMovement)>,
    pub fixed: Vec<u32>,
    pub sliding: Vec<WallNode>,
}

/// A node that slides: held across walls, free along them.
#[derive(Clone, Debug, PartialEq)]
pub struct WallNode {
    pub node: u32,
    /// Unit normals.
    pub across: Vec<Vector>,
    /// The number of the segment that carries the walls; `None` where they stay.
    pub carrier: Option<u32>,
}

/// A wall at one node: n . u = n . ((R - I) x + t), R and t those of the segment that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// n, of length 1.
    pub normal: Vector,
    pub carrier: Option<u32>,
}

/// The class of each node, and for each node that is not free what it is held to.
#[derive(Clone, Debug)]
pub struct Conditions {
    pub classes: Vec<NodeClass>,
    pub constraints: Vec<Constraint>,
    /// The walls of each node that slides, in the order in which they hold it.
    pub walls: BTreeMap<u32, Vec<Wall>>,
    /// Nodes that more than one segment holds, ascending; the first of the segments has them.
    pub shared: Vec<u32>,
    pub warnings: Vec<Warning>,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionError {
    #[error("segments {first} and {second} move node {node} to places {distance:.3e} mm apart")]
    TwoMovements { node: u32, first: usize, second: usize, distance: f64 },
    #[error("component {component} of node {node} is prescribed as {first} mm and as {second} mm")]
    TwoValues { node: u32, component: usize, first: f64, second: f64 },
    #[error(
        "component {component} of node {node} is prescribed as {prescribed} mm, and its segment moves it by {joined} mm"
    )]
    PrescribedAgainstJoined { node: u32, component: usize, prescribed: f64, joined: f64 },
}

/// Gives every node its class and its holds, or says which two statements contradict each other.
pub fn combine(positions: &[Vector], held: &HeldNodes) -> Result<Conditions, ConditionError> {
    let mut nodes = vec![NodeConditions::default(); positions.len()];
    for &(node, displacement) in &held.prescribed {
        nodes[node as usize].prescribe(node, displacement)?;
    }
    for (segment, (members, movement)) in held.joined.iter().enumerate() {
        for &node in members {
            let displacement = movement.displacement(&positions[node as usize]);
            nodes[node as usize].join(node, segment, displacement)?;
        }
    }
    for &node in &held.fixed {
        nodes[node as usize].fixed = true;
    }
    for WallNode { node, across, carrier } in &held.sliding {
        let wall = |normal: &Vector| Wall { normal: *normal, carrier: *carrier };
        nodes[*node as usize].walls.extend(across.iter().map(wall));
    }
    let constraints = nodes
        .iter()
        .enumerate()
        .filter_map(|(node, conditions)| {
            let carried = |segment: u32| {
                let (_, movement) = &held.joined[segment as usize];
                movement.displacement(&positions[node])
            };
            conditions.constraint(node as u32, &carried)
        })
        .collect();
    let classes: Vec<NodeClass> = nodes.iter().map(NodeConditions::class).collect();
    let walls = (0_u32..)
        .zip(&nodes)
        .filter(|(node, _)| classes[*node as usize] == NodeClass::Sliding)
        .map(|(node, conditions)| (node, conditions.walls.clone()))
        .collect();
    let numbered = (0_u32..).zip(&nodes);
    let shared = numbered.filter(|(_, node)| node.segments > 1).map(|(node, _)| node);
    let shared: Vec<u32> = shared.collect();
    let warnings = overlaps(&nodes).into_iter().chain(joined_twice(&shared)).collect();
    Ok(Conditions { classes, constraints, walls, shared, warnings })
}

/// Holds a node across its walls, each of which has moved with what carries it.
fn add_walls(constraint: &mut Constraint, walls: &[Wall], carried: &dyn Fn(u32) -> Vector) {
    for Wall { normal, carrier } in walls {
        let value = carrier.map_or(0.0, |segment| normal.dot(&carried(segment)));
        constraint.add(normal, value);
    }
}

impl Conditions {
    /// Where a hold would be, along its axes, if segments displaced its node by `moved` and nothing else moved:
    /// linear in these displacements.
    pub fn values(&self, constraint: &Constraint, moved: &dyn Fn(u32) -> Vector) -> Vector {
        match self.classes[constraint.node as usize] {
            NodeClass::Joined(segment) => constraint.axes().transpose() * moved(segment),
            NodeClass::Sliding => {
                let mut moved_hold = Constraint::free(constraint.node);
                let walls = self.walls.get(&constraint.node).map(Vec::as_slice).unwrap_or_default();
                add_walls(&mut moved_hold, walls, moved);
                *moved_hold.values()
            }
            NodeClass::Prescribed | NodeClass::Fixed | NodeClass::Free => Vector::zeros(),
        }
    }

    /// How many sliding nodes have a wall that a segment carries.
    pub fn carried_by(&self, segment: u32) -> usize {
        let is_carried = |walls: &&Vec<Wall>| walls.iter().any(|w| w.carrier == Some(segment));
        self.walls.values().filter(is_carried).count()
    }
}

/// Everything said about one node.
#[derive(Clone, Default)]
struct NodeConditions {
    prescribed: [Option<f64>; 3],
    joined: Option<(usize, Vector)>,
    /// How many segments hold the node.
    segments: u32,
    fixed: bool,
    walls: Vec<Wall>,
}

impl NodeConditions {
    fn prescribe(
        &mut self,
        node: u32,
        displacement: [Option<f64>; 3],
    ) -> Result<(), ConditionError> {
        for (component, value) in displacement.into_iter().enumerate() {
            let Some(second) = value else { continue };
            if let Some(first) = self.prescribed[component]
                && (first - second).abs() > CONTRADICTION
            {
                return Err(ConditionError::TwoValues { node, component, first, second });
            }
            self.prescribed[component] = Some(second);
        }
        Ok(())
    }

    fn join(
        &mut self,
        node: u32,
        segment: usize,
        displacement: Vector,
    ) -> Result<(), ConditionError> {
        self.segments += 1;
        if let Some((first, other)) = self.joined {
            let distance = (other - displacement).norm();
            if distance > CONTRADICTION {
                let second = segment;
                return Err(ConditionError::TwoMovements { node, first, second, distance });
            }
            return Ok(());
        }
        for (component, prescribed) in self.prescribed.into_iter().enumerate() {
            let joined = displacement[component];
            if let Some(prescribed) = prescribed
                && (prescribed - joined).abs() > CONTRADICTION
            {
                return Err(ConditionError::PrescribedAgainstJoined {
                    node,
                    component,
                    prescribed,
                    joined,
                });
            }
        }
        self.joined = Some((segment, displacement));
        Ok(())
    }

    fn class(&self) -> NodeClass {
        if self.prescribed.iter().any(Option::is_some) {
            NodeClass::Prescribed
        } else if let Some((segment, _)) = self.joined {
            NodeClass::Joined(segment as u32)
        } else if self.fixed {
            NodeClass::Fixed
        } else if !self.walls.is_empty() {
            NodeClass::Sliding
        } else {
            NodeClass::Free
        }
    }

    /// The conditions in their precedence; those that stronger ones already decide fall away. `carried` is the
    /// displacement that a segment gives what it carries here.
    fn constraint(&self, node: u32, carried: &dyn Fn(u32) -> Vector) -> Option<Constraint> {
        let mut constraint = Constraint::free(node);
        for (component, value) in self.prescribed.into_iter().enumerate() {
            if let Some(value) = value {
                constraint.add(&Matrix3::identity().column(component).into_owned(), value);
            }
        }
        let whole = self.joined.map(|(_, displacement)| displacement);
        if let Some(displacement) = whole.or(self.fixed.then(Vector::zeros)) {
            for component in 0..3 {
                constraint.add(
                    &Matrix3::identity().column(component).into_owned(),
                    displacement[component],
                );
            }
        }
        add_walls(&mut constraint, &self.walls, carried);
        (constraint.count() > 0).then(|| constraint.of_body(self.body()))
    }

    /// The body that the node belongs to altogether: prescribed components count for what stays where they are zero alone.
    fn body(&self) -> Option<Holder> {
        let mut prescribed = self.prescribed.iter().flatten();
        match self.joined {
            Some((segment, _)) => {
                prescribed.next().is_none().then_some(Holder::Segment(segment as u32))
            }
            None => (self.fixed && prescribed.all(|value| *value == 0.0)).then_some(Holder::Rest),
        }
    }

    /// The classes that claim this node.
    fn claims(&self) -> [bool; 4] {
        let prescribed = self.prescribed.iter().any(Option::is_some);
        [prescribed, self.joined.is_some(), self.fixed, !self.walls.is_empty()]
    }
}

/// One warning that counts the nodes claimed by two classes, for each pair of classes.
fn overlaps(nodes: &[NodeConditions]) -> Option<Warning> {
    const PAIRS: [(usize, usize, &str); 6] = [
        (0, 1, "prescribed_and_joined"),
        (0, 2, "prescribed_and_fixed"),
        (0, 3, "prescribed_and_sliding"),
        (1, 2, "joined_and_fixed"),
        (1, 3, "joined_and_sliding"),
        (2, 3, "fixed_and_sliding"),
    ];
    let mut warning = Warning::new(
        "conditions-overlap",
        "nodes belong to more than one class; the stronger holds: prescribed, joined, fixed, sliding",
    );
    for (stronger, weaker, name) in PAIRS {
        let both = |node: &&NodeConditions| node.claims()[stronger] && node.claims()[weaker];
        let count = nodes.iter().filter(both).count();
        if count > 0 {
            warning = warning.with(name, count as f64);
        }
    }
    (!warning.numbers.is_empty()).then_some(warning)
}

/// A warning on the nodes of several segments, none of which a plan can move without the others.
fn joined_twice(shared: &[u32]) -> Option<Warning> {
    let (first, count) = (shared.first()?, shared.len());
    let detail = format!(
        "{count} nodes, the first of them {first}, belong to more than one segment: plans have to move these segments alike, and no response \
         can be built"
    );
    Some(Warning::new("conditions-overlap", detail).with("joined_twice", count as f64))
}
