//! Mesh report: content and faults of an uploaded mesh, for the client, before anything is computed. Lengths, areas and
//! volumes are in mm if the nodes are.

use std::collections::BTreeMap;

use super::connectivity::{Faces, parts_by_nodes};
use super::disjoint_sets::DisjointSets;
use super::surface_edges::count_edges;
use super::{CellShape, TriangleSurface, Vector, VolumeMesh, Warning, bounds_of};

/// A face or a part of it measures this much from corner to corner of its bounding box, in mm.
const USUAL_DIAGONAL_MM: std::ops::RangeInclusive<f64> = 50.0..=600.0;

/// The code of the warning of a mesh in parts.
const SEVERAL_COMPONENTS: &str = "several-components";

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
    /// Parts that share no face with each other, or, in a surface, no point.
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
    pub cell_vectors: Vec<String>,
    pub warnings: Vec<Warning>,
}

impl MeshReport {
    pub fn of_volume(mesh: &VolumeMesh) -> MeshReport {
        let faces = Faces::new(mesh);
        let surface = mesh.surface_of(&mesh.boundary_of(&faces));
        let parts = volume_parts(&faces);
        let referenced = mesh.cells.iter().flat_map(|(_, nodes)| nodes);
        let mut report = MeshReport {
            nodes: mesh.nodes.len() as u64,
            cells: cells_by_shape(mesh),
            triangles: surface.triangles.len() as u64,
            bounding_box: bounds_of(&mesh.nodes),
            volume_mm3: Some((0..mesh.cells.len()).map(|cell| mesh.cell_volume(cell)).sum()),
            area_mm2: surface.area(),
            components: parts.len() as u64,
            open_edges: 0,
            nonmanifold_edges: count_edges(&surface.sorted_sides()).nonmanifold,
            nonmanifold_faces: nonmanifold_faces(&faces),
            unreferenced_nodes: unreferenced(mesh.nodes.len(), referenced),
            duplicate_nodes: duplicates(&mesh.nodes),
            largest_components: largest(&parts),
            node_sets: sizes(&mesh.node_sets),
            cell_sets: sizes(&mesh.cell_sets),
            node_labels: occurrences(&mesh.node_labels),
            cell_labels: occurrences(&mesh.cell_labels),
            node_vectors: mesh.node_vectors.keys().cloned().collect(),
            cell_vectors: mesh.cell_vectors.keys().cloned().collect(),
            warnings: Vec::new(),
        };
        report.warn();
        report
    }

    pub fn of_surface(surface: &TriangleSurface) -> MeshReport {
        let edges = count_edges(&surface.sorted_sides());
        let parts = surface_parts(surface);
        let referenced = surface.triangles.as_flattened().iter();
        let is_closed = edges.open == 0 && edges.nonmanifold == 0;
        let mut report = MeshReport {
            nodes: surface.points.len() as u64,
            triangles: surface.triangles.len() as u64,
            bounding_box: bounds_of(&surface.points),
            volume_mm3: is_closed.then(|| surface.signed_volume()),
            area_mm2: surface.area(),
            components: parts.len() as u64,
            open_edges: edges.open,
            nonmanifold_edges: edges.nonmanifold,
            unreferenced_nodes: unreferenced(surface.points.len(), referenced),
            duplicate_nodes: duplicates(&surface.points),
            largest_components: largest(&parts),
            ..MeshReport::default()
        };
        report.warn();
        report
    }

    /// From one corner of the bounding box to the other, in mm; 0 without nodes.
    pub fn diagonal(&self) -> f64 {
        self.bounding_box.map_or(0.0, |[low, high]| (high - low).norm())
    }

    fn warn(&mut self) {
        let mut add = |code, count: u64, detail: &str| {
            if count > 0 {
                let warning = Warning::new(code, format!("{count} {detail}"));
                self.warnings.push(warning.with("count", count as f64));
            }
        };
        let other_parts = self.components.saturating_sub(1);
        add(SEVERAL_COMPONENTS, other_parts, "parts touch the largest one nowhere");
        add("nonmanifold-edges", self.nonmanifold_edges, "edges belong to more than two triangles");
        add("nonmanifold-faces", self.nonmanifold_faces, "faces belong to more than two cells");
        add("duplicate-nodes", self.duplicate_nodes, "nodes lie exactly on another one");
        let sets = self.node_sets.iter().chain(&self.cell_sets);
        let empty: Vec<&str> =
            sets.filter(|(_, size)| **size == 0).map(|(name, _)| name.as_str()).collect();
        if !empty.is_empty() {
            let detail = format!("sets without a member: {}", empty.join(", "));
            let warning = Warning::new("empty-sets", detail);
            self.warnings.push(warning.with("count", empty.len() as f64));
        }
    }
}

/// The warning of a volume mesh in parts that share no node: a face is one, and what is not joined to it is held and
/// moved by itself.
pub fn several_components(mesh: &VolumeMesh, faces: &Faces) -> Option<Warning> {
    let mut cells: Vec<u64> = Vec::new();
    for part in parts_by_nodes(mesh, &faces.parts()) {
        cells.resize(cells.len().max(part as usize + 1), 0);
        cells[part as usize] += 1;
    }
    cells.sort_unstable_by(|one, other| other.cmp(one));
    let (largest, others) = cells.split_first()?;
    let rest: u64 = others.iter().sum();
    let detail = format!(
        "{} parts of the mesh, {rest} cells, touch the largest one, of {largest} cells, nowhere",
        others.len()
    );
    let warning = Warning::new(SEVERAL_COMPONENTS, detail).with("count", others.len() as f64);
    (!others.is_empty()).then(|| warning.with("cells", rest as f64))
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

fn sizes(sets: &BTreeMap<String, Vec<u32>>) -> BTreeMap<String, u64> {
    let sized = sets.iter();
    sized.map(|(name, set)| (name.clone(), set.len() as u64)).collect()
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
fn nonmanifold_faces(faces: &Faces) -> u64 {
    faces.shared().filter(|group| group.len() > 2).count() as u64
}

/// Cells of each part of a volume mesh, largest first; parts hang together by faces.
fn volume_parts(faces: &Faces) -> Vec<u64> {
    let mut sizes = Vec::new();
    for part in faces.parts() {
        let part = part as usize;
        sizes.resize(sizes.len().max(part + 1), 0);
        sizes[part] += 1;
    }
    sizes.sort_unstable_by(|one: &u64, other| other.cmp(one));
    sizes
}

/// Triangles of each part of a surface, largest first; parts hang together by points.
fn surface_parts(surface: &TriangleSurface) -> Vec<u64> {
    let mut parts = DisjointSets::new(surface.points.len());
    for &[a, b, c] in &surface.triangles {
        parts.join(a, b);
        parts.join(b, c);
    }
    let mut triangles_of = vec![0_u64; surface.points.len()];
    for triangle in &surface.triangles {
        triangles_of[parts.root(triangle[0]) as usize] += 1;
    }
    triangles_of.retain(|size| *size > 0);
    triangles_of.sort_unstable_by(|one, other| other.cmp(one));
    triangles_of
}

fn largest(parts: &[u64]) -> Vec<u64> {
    parts.iter().copied().take(MOST_PARTS_LISTED).collect()
}

fn unreferenced<'a>(nodes: usize, named: impl Iterator<Item = &'a u32>) -> u64 {
    referenced(nodes, named).iter().filter(|named| !**named).count() as u64
}

/// For each of so many nodes whether it is among those that cells or triangles name.
pub fn referenced<'a>(nodes: usize, named: impl Iterator<Item = &'a u32>) -> Vec<bool> {
    let mut is_named = vec![false; nodes];
    named.for_each(|&node| is_named[node as usize] = true);
    is_named
}
