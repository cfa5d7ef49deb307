//! What every node is held to: prescribed, joined to a segment, fixed, sliding or free
//! (METHODS row 5; precedence at a node: prescribed component, joined, fixed, sliding, free).

use nalgebra::Matrix3;

use super::hold::Hold;
use crate::mesh::{Vector, Warning};
use crate::plan::RigidMovement;

/// Two displacements of one node that differ by more than this, in mm, contradict each other.
const CONTRADICTION: f64 = 1e-9;

/// What holds a node, strongest first.
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
    /// Node and the unit directions across which it is held.
    pub sliding: Vec<(u32, Vec<Vector>)>,
}

/// The class of each node, and for each node that is not free what it is held to.
#[derive(Clone, Debug)]
pub struct Conditions {
    pub classes: Vec<NodeClass>,
    pub holds: Vec<Hold>,
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
    for (node, directions) in &held.sliding {
        nodes[*node as usize].across.extend_from_slice(directions);
    }
    let holds = nodes
        .iter()
        .enumerate()
        .filter_map(|(node, conditions)| conditions.hold(node as u32))
        .collect();
    let classes = nodes.iter().map(NodeConditions::class).collect();
    let numbered = (0_u32..).zip(&nodes);
    let shared = numbered.filter(|(_, node)| node.segments > 1).map(|(node, _)| node).collect();
    Ok(Conditions { classes, holds, shared, warnings: overlaps(&nodes).into_iter().collect() })
}

/// Everything said about one node.
#[derive(Clone, Default)]
struct NodeConditions {
    prescribed: [Option<f64>; 3],
    joined: Option<(usize, Vector)>,
    /// How many segments hold the node.
    segments: u32,
    fixed: bool,
    across: Vec<Vector>,
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
        } else if !self.across.is_empty() {
            NodeClass::Sliding
        } else {
            NodeClass::Free
        }
    }

    /// The conditions in their precedence; those that stronger ones already decide fall away.
    fn hold(&self, node: u32) -> Option<Hold> {
        let mut hold = Hold::free(node);
        for (component, value) in self.prescribed.into_iter().enumerate() {
            if let Some(value) = value {
                hold.add(&Matrix3::identity().column(component).into_owned(), value);
            }
        }
        let whole = self.joined.map(|(_, displacement)| displacement);
        if let Some(displacement) = whole.or(self.fixed.then(Vector::zeros)) {
            for component in 0..3 {
                hold.add(
                    &Matrix3::identity().column(component).into_owned(),
                    displacement[component],
                );
            }
        }
        for direction in &self.across {
            hold.add(direction, 0.0);
        }
        (hold.count() > 0).then_some(hold)
    }

    /// The classes that claim this node.
    fn claims(&self) -> [bool; 4] {
        let prescribed = self.prescribed.iter().any(Option::is_some);
        [prescribed, self.joined.is_some(), self.fixed, !self.across.is_empty()]
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
