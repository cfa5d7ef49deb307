//! Edges of cells that a plan may tear, as stored in a response.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::boundary::NodeClass;
use mechanics::boundary::tearing::{EdgeBetween, tearing_between};
use mechanics::mesh::{Vector, Warning};
use mechanics::plan::RigidMovement;

/// Edges of cells from a node held by a segment to one held by another, or by what stays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResponseEdgesDocument {
    pub segment: String,
    /// Absent for what stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub other: Option<String>,
    /// Two nodes of an edge, one after the other; the first of them is held by `segment`.
    pub node_ids: Vec<u32>,
    /// Where they are at rest: x, y, z of each.
    pub points_mm: Vec<f32>,
}

impl ResponseEdgesDocument {
    /// Edges by what holds their ends, with the names of the segments.
    pub fn all(edges: &[EdgeBetween], segments: &[String]) -> Vec<Self> {
        let name = |class| match class {
            NodeClass::Joined(place) => segments.get(place as usize).cloned(),
            _ => None,
        };
        let mut all: Vec<Self> = Vec::new();
        for edge in edges {
            // Segments stand before what stays.
            let [first, second] = if edge.held_by[0] < edge.held_by[1] { [0, 1] } else { [1, 0] };
            let [segment, other] = [first, second].map(|end| name(edge.held_by[end]));
            let Some(segment) = segment else { continue };
            let is_of = |of: &Self| of.segment == segment && of.other == other;
            let place = all.iter().position(is_of).unwrap_or_else(|| {
                all.push(Self { segment, other, node_ids: Vec::new(), points_mm: Vec::new() });
                all.len() - 1
            });
            for end in [first, second] {
                all[place].node_ids.push(edge.nodes[end]);
                all[place].points_mm.extend(edge.ends[end].iter().map(|&value| value as f32));
            }
        }
        all
    }

    fn to_edges(&self, segments: &[&str]) -> impl Iterator<Item = EdgeBetween> {
        let place = |name: &str| segments.iter().position(|other| *other == name);
        let class = |name: &str| {
            place(name).map_or(NodeClass::Fixed, |place| NodeClass::Joined(place as u32))
        };
        let other = self.other.as_ref().map_or(NodeClass::Fixed, |name| class(name));
        let held_by = [class(&self.segment), other];
        let ends = self.points_mm.chunks_exact(6).map(|ends| {
            let end = |from: usize| {
                Vector::from_iterator(ends[from..from + 3].iter().map(|&value| f64::from(value)))
            };
            [end(0), end(3)]
        });
        let nodes = self.node_ids.chunks_exact(2).map(|nodes| [nodes[0], nodes[1]]);
        nodes.zip(ends).map(move |(nodes, ends)| EdgeBetween { nodes, ends, held_by })
    }
}

/// Where movements of segments tear the tissue at these edges, as a prediction of the plan warns.
pub fn torn(
    documents: &[ResponseEdgesDocument],
    segments: &[&str],
    movements: &[RigidMovement],
) -> Option<Warning> {
    let edges: Vec<EdgeBetween> = documents.iter().flat_map(|of| of.to_edges(segments)).collect();
    let displacement = |class: NodeClass, at: &Vector| match class {
        NodeClass::Joined(place) => movements[place as usize].displacement(at),
        _ => Vector::zeros(),
    };
    let name = |class: NodeClass| match class {
        NodeClass::Joined(place) => format!("joined:{}", segments[place as usize]),
        other => other.name().to_owned(),
    };
    tearing_between(&edges, displacement, name)
}
