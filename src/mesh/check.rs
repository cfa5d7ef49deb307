//! What is in an uploaded mesh and what is wrong with it: the report that a client reads before
//! anything is computed. Lengths, areas and volumes are in mm if the nodes are.

use std::collections::BTreeMap;

use super::surface_edges::count_edges;
use super::{CellShape, TriangleSurface, Vector, VolumeMesh, Warning};

/// A face or a part of it measures this much from corner to corner of its bounding box, in mm.
const USUAL_DIAGONAL_MM: std::ops::RangeInclusive<f64> = 50.0..=600.0;

/// Sizes of as many parts are listed.
const MOST_PARTS_LISTED: usize = 10;

/// Counts and measures of a volume mesh or a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshReport {
    pub nodes: u64,
    /// Cells by shape, for volume meshes.
    pub cells: BTreeMap<&'static str, u64>,
    /// Triangles of a surface; boundary faces of a volume mesh count as one or two.
    pub triangles: u64,
    /// Lowest and highest coordinates.
    pub bounding_box: Option<[Vector; 2]>,
    /// mm³; of a surface only where it is closed.
    pub volume_mm3: Option<f64>,
    /// mm²; of a volume mesh that of its boundary.
    pub area_mm2: f64,
    /// Parts that share no node with each other.
    pub components: u64,
    /// Cells or triangles of the ten largest parts.
    pub largest_components: Vec<u64>,
    /// Edges of one triangle only.
    pub open_edges: u64,
    /// Edges of three triangles or more.
    pub nonmanifold_edges: u64,
    /// Faces of three cells or more.
    pub nonmanifold_faces: u64,
    pub unreferenced_nodes: u64,
    /// Nodes at exactly the place of another one.
    pub duplicate_nodes: u64,
    pub node_sets: BTreeMap<String, u64>,
    pub cell_sets: BTreeMap<String, u64>,
    /// How often each value of each label array occurs.
    pub node_labels: BTreeMap<String, BTreeMap<i64, u64>>,
    pub cell_labels: BTreeMap<String, BTreeMap<i64, u64>>,
    pub node_vectors: Vec<String>,
    pub warnings: Vec<Warning>,
}

impl MeshReport {
    pub fn of_volume(mesh: &VolumeMesh) -> MeshReport {
        let surface = mesh.surface_of(&mesh.boundary_faces());
        let parts = Parts::of(mesh.nodes.len(), mesh.cells.iter().map(|(_, nodes)| nodes));
        let mut report = MeshReport {
            nodes: mesh.nodes.len() as u64,
            cells: cells_by_shape(mesh),
            triangles: surface.triangles.len() as u64,
            bounding_box: bounding_box(&mesh.nodes),
            volume_mm3: Some(volume(mesh)),
            area_mm2: surface.area(),
            components: parts.sizes.len() as u64,
            open_edges: 0,
            nonmanifold_edges: count_edges(&surface.sorted_sides()).nonmanifold,
            nonmanifold_faces: nonmanifold_faces(mesh),
            unreferenced_nodes: parts.unreferenced,
            duplicate_nodes: duplicates(&mesh.nodes),
            largest_components: parts.largest(),
            node_sets: sizes(&mesh.node_sets),
            cell_sets: sizes(&mesh.cell_sets),
            node_labels: occurrences(&mesh.node_labels),
            cell_labels: occurrences(&mesh.cell_labels),
            node_vectors: mesh.node_vectors.keys().cloned().collect(),
            warnings: Vec::new(),
        };
        report.warn();
        report
    }

    pub fn of_surface(surface: &TriangleSurface) -> MeshReport {
        let edges = count_edges(&surface.sorted_sides());
        let triangles = surface.triangles.iter().map(|corners| corners.as_slice());
        let parts = Parts::of(surface.points.len(), triangles);
        let is_closed = edges.open == 0 && edges.nonmanifold == 0;
        let mut report = MeshReport {
            nodes: surface.points.len() as u64,
            triangles: surface.triangles.len() as u64,
            bounding_box: bounding_box(&surface.points),
            volume_mm3: is_closed.then(|| surface.signed_volume()),
            area_mm2: surface.area(),
            components: parts.sizes.len() as u64,
            open_edges: edges.open,
            nonmanifold_edges: edges.nonmanifold,
            unreferenced_nodes: parts.unreferenced,
            duplicate_nodes: duplicates(&surface.points),
            largest_components: parts.largest(),
            ..MeshReport::default()
        };
        report.warn();
        report
    }

    /// From one corner of the bounding box to the other, in mm; 0 without nodes.
    pub fn diagonal(&self) -> f64 {
        self.bounding_box
            .map_or(0.0, |[low, high]| (high - low).norm())
    }

    fn warn(&mut self) {
        let mut add = |code, count: u64, detail: &str| {
            if count > 0 {
                let warning = Warning::new(code, format!("{count} {detail}"));
                self.warnings.push(warning.with("count", count as f64));
            }
        };
        let other_parts = self.components.saturating_sub(1);
        add(
            "several-components",
            other_parts,
            "parts touch the largest one nowhere",
        );
        add(
            "nonmanifold-edges",
            self.nonmanifold_edges,
            "edges belong to more than two triangles",
        );
        add(
            "nonmanifold-faces",
            self.nonmanifold_faces,
            "faces belong to more than two cells",
        );
        add(
            "duplicate-nodes",
            self.duplicate_nodes,
            "nodes lie exactly on another one",
        );
        let sets = self.node_sets.iter().chain(&self.cell_sets);
        let empty: Vec<&str> = sets
            .filter(|(_, size)| **size == 0)
            .map(|(name, _)| name.as_str())
            .collect();
        if !empty.is_empty() {
            let detail = format!("sets without a member: {}", empty.join(", "));
            let warning = Warning::new("empty-sets", detail);
            self.warnings
                .push(warning.with("count", empty.len() as f64));
        }
    }
}

/// A warning where the bounding box, in mm, is no size that a face has. Names the factor that
/// would make it one, and never applies it.
pub fn units_suspect(diagonal_mm: f64) -> Option<Warning> {
    if USUAL_DIAGONAL_MM.contains(&diagonal_mm) {
        return None;
    }
    let detail = format!(
        "the bounding box measures {diagonal_mm:.4} mm from corner to corner; a face measures 50 to 600 mm"
    );
    let warning = Warning::new("units-suspect", detail).with("diagonal_mm", diagonal_mm);
    let factors = [1000.0, 10.0, 0.001].into_iter();
    let mut fitting = factors.filter(|factor| USUAL_DIAGONAL_MM.contains(&(diagonal_mm * factor)));
    Some(match fitting.next() {
        Some(factor) => warning.with("suggested_factor", factor),
        None => warning,
    })
}

fn cells_by_shape(mesh: &VolumeMesh) -> BTreeMap<&'static str, u64> {
    let mut cells = BTreeMap::new();
    for (shape, _) in mesh.cells.iter() {
        *cells.entry(CellShape::name(shape)).or_default() += 1;
    }
    cells
}

fn bounding_box(nodes: &[Vector]) -> Option<[Vector; 2]> {
    let first = *nodes.first()?;
    let widened = nodes.iter().fold([first, first], |[low, high], node| {
        [low.inf(node), high.sup(node)]
    });
    Some(widened)
}

fn volume(mesh: &VolumeMesh) -> f64 {
    (0..mesh.cells.len())
        .map(|cell| mesh.cell_jacobian(cell).volume)
        .sum()
}

fn sizes(sets: &BTreeMap<String, Vec<u32>>) -> BTreeMap<String, u64> {
    let sized = sets.iter();
    sized
        .map(|(name, set)| (name.clone(), set.len() as u64))
        .collect()
}

fn occurrences(labels: &BTreeMap<String, Vec<i64>>) -> BTreeMap<String, BTreeMap<i64, u64>> {
    let counted = labels.iter().map(|(name, values)| {
        let mut counts = BTreeMap::new();
        for &value in values {
            *counts.entry(value).or_default() += 1;
        }
        (name.clone(), counts)
    });
    counted.collect()
}

fn duplicates(nodes: &[Vector]) -> u64 {
    // Adding zero makes one of the two zeros.
    let bits = |node: &Vector| [node.x, node.y, node.z].map(|c| (c + 0.0).to_bits());
    let mut places: Vec<[u64; 3]> = nodes.iter().map(bits).collect();
    places.sort_unstable();
    let groups = places.chunk_by(|one, other| one == other);
    groups.map(|group| group.len() as u64 - 1).sum()
}

/// Faces that belong to more than two cells.
fn nonmanifold_faces(mesh: &VolumeMesh) -> u64 {
    let mut faces = Vec::with_capacity(mesh.cells.len() * 5);
    for (shape, nodes) in mesh.cells.iter() {
        for face in shape.faces() {
            let mut key = [u32::MAX; 4];
            for (slot, &local) in key.iter_mut().zip(*face) {
                *slot = nodes[local];
            }
            key.sort_unstable();
            faces.push(key);
        }
    }
    faces.sort_unstable();
    let shared = faces.chunk_by(|one, other| one == other);
    shared.filter(|group| group.len() > 2).count() as u64
}

/// Parts of a mesh that share no node.
struct Parts {
    /// Cells of each part, largest first.
    sizes: Vec<u64>,
    unreferenced: u64,
}

impl Parts {
    fn of<'a>(nodes: usize, cells: impl Iterator<Item = &'a [u32]>) -> Parts {
        let mut parent: Vec<u32> = (0..nodes as u32).collect();
        let mut first_nodes = Vec::new();
        let mut is_referenced = vec![false; nodes];
        for cell in cells {
            for &node in cell {
                is_referenced[node as usize] = true;
                let (one, other) = (root(&mut parent, cell[0]), root(&mut parent, node));
                parent[one.max(other) as usize] = one.min(other);
            }
            first_nodes.extend(cell.first());
        }
        let mut cells_of = vec![0_u64; nodes];
        for node in first_nodes {
            cells_of[root(&mut parent, node) as usize] += 1;
        }
        let mut sizes: Vec<u64> = cells_of.into_iter().filter(|size| *size > 0).collect();
        sizes.sort_unstable_by(|one, other| other.cmp(one));
        Parts {
            sizes,
            unreferenced: is_referenced.iter().filter(|named| !**named).count() as u64,
        }
    }

    fn largest(&self) -> Vec<u64> {
        self.sizes.iter().copied().take(MOST_PARTS_LISTED).collect()
    }
}

/// The node that stands for the part of `node`. Halves the path on its way.
fn root(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        let above = parent[parent[node as usize] as usize];
        parent[node as usize] = above;
        node = above;
    }
    node
}
