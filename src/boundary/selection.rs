//! Sets of nodes asked for by name, by label, or by distance from a surface.

/// How a set of nodes is asked for (SELECT of the documents).
#[derive(Clone, Debug, PartialEq)]
pub enum NodeSelection {
    NodeSet(String),
    Label {
        array: String,
        value: i64,
    },
    /// Boundary nodes of the volume mesh at most `distance` mm from the triangles of a surface of the case.
    NearSurface {
        surface: String,
        distance: f64,
    },
    Any(Vec<NodeSelection>),
}
