//! Sets of nodes asked for by name, by label, or by distance from a surface.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rayon::prelude::*;

use crate::mesh::ignored::listed;
use crate::mesh::{ArrayUse, TriangleSearch, TriangleSurface, VolumeMesh};
use crate::progress::StopQuery;

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
    /// By their numbers, which finer meshes keep; no document states them.
    Nodes(Vec<u32>),
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SelectionError {
    #[error("{0}")]
    UnknownSet(String),
    #[error("{0}")]
    UnknownArray(String),
    #[error("the case has no surface {0:?}")]
    UnknownSurface(String),
    #[error("surface {0:?} has no triangle with an area")]
    FlatSurface(String),
    #[error("{0}")]
    Empty(String),
}

/// The mesh in which nodes are selected.
pub struct Selector<'a> {
    pub mesh: &'a VolumeMesh,
    pub surfaces: &'a BTreeMap<String, Arc<TriangleSurface>>,
    /// Nodes of boundary faces, ascending.
    pub boundary_nodes: &'a [u32],
    /// For each node of the mesh whether it belongs to a cell; others are never selected.
    pub is_in_cell: &'a [bool],
    /// How far the boundary nodes, in their order, are from surfaces that were asked for, in mm, by the names of these.
    pub distances: &'a mut BTreeMap<String, Vec<f64>>,
    /// Where it is asked for, distances are left out, and what is selected is to be dropped.
    pub stop: &'a StopQuery<'a>,
}

impl Selector<'_> {
    /// The selected nodes, ascending and without repeats; never none.
    pub fn select(&mut self, selection: &NodeSelection) -> Result<Vec<u32>, SelectionError> {
        let mut nodes = self.collect(selection)?;
        nodes.sort_unstable();
        nodes.dedup();
        let named = nodes.len();
        nodes.retain(|&node| self.is_in_cell[node as usize]);
        match (nodes.is_empty(), named) {
            (true, 0) => Err(SelectionError::Empty(self.emptiness(selection))),
            (true, _) => Err(SelectionError::Empty(format!(
                "none of the {named} nodes of the selection belongs to a cell"
            ))),
            (false, _) => Ok(nodes),
        }
    }

    fn collect(&mut self, selection: &NodeSelection) -> Result<Vec<u32>, SelectionError> {
        match selection {
            NodeSelection::NodeSet(name) => {
                let missing = || SelectionError::UnknownSet(self.mesh.missing_set(name));
                let set = self.mesh.node_set(name).ok_or_else(missing)?;
                Ok(set.to_vec())
            }
            NodeSelection::Label { array, value } => self.labelled(array, *value),
            NodeSelection::NearSurface { surface, distance } => self.near(surface, *distance),
            NodeSelection::Any(parts) => {
                let mut nodes = Vec::new();
                for part in parts {
                    nodes.extend(self.collect(part)?);
                }
                Ok(nodes)
            }
            NodeSelection::Nodes(nodes) => Ok(nodes.clone()),
        }
    }

    /// What a selection without a node looks for, and what there is.
    fn emptiness(&self, selection: &NodeSelection) -> String {
        match selection {
            NodeSelection::NodeSet(name) => format!("node set {name:?} has no node"),
            NodeSelection::Label { array, value } => {
                let labels = self.mesh.node_labels.get(array).into_iter().flatten();
                let known: BTreeSet<i64> = labels.copied().collect();
                let known = listed(known.iter().map(i64::to_string));
                format!(
                    "no node has the value {value} in the array {array:?}; its values are {known}"
                )
            }
            NodeSelection::NearSurface { surface, distance } => format!(
                "no node of the boundary is within {distance} mm of the surface {surface:?}"
            ),
            NodeSelection::Any(_) => "no part of the selection has a node".to_owned(),
            NodeSelection::Nodes(_) => "no node is selected".to_owned(),
        }
    }

    fn labelled(&self, array: &str, value: i64) -> Result<Vec<u32>, SelectionError> {
        let labels = self.mesh.node_labels.get(array).ok_or_else(|| {
            SelectionError::UnknownArray(self.mesh.missing_array(ArrayUse::PointLabels, array))
        })?;
        Ok((0_u32..)
            .zip(labels)
            .filter(|(_, label)| **label == value)
            .map(|(node, _)| node)
            .collect())
    }

    fn near(&mut self, name: &str, distance: f64) -> Result<Vec<u32>, SelectionError> {
        if !self.distances.contains_key(name) {
            let surface = self
                .surfaces
                .get(name)
                .ok_or_else(|| SelectionError::UnknownSurface(name.to_owned()))?;
            let search = TriangleSearch::new(surface)
                .map_err(|_| SelectionError::FlatSurface(name.to_owned()))?;
            let from = |(place, &node): (usize, &u32)| match self.stop.is_asked_at(place) {
                true => f64::INFINITY,
                false => search.closest(&self.mesh.nodes[node as usize]).distance,
            };
            let distances = self.boundary_nodes.par_iter().enumerate().map(from).collect();
            self.distances.insert(name.to_owned(), distances);
        }
        let nodes = self.boundary_nodes.iter().zip(&self.distances[name]);
        Ok(nodes.filter(|(_, from)| **from <= distance).map(|(node, _)| *node).collect())
    }
}
