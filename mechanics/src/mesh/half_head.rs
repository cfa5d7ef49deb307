//! The scene of the demo: the anterior half of a head, from neck to forehead, made by the program.
//!
//! Frame LPS in mm: x to the left, y to the back, z up; the face looks along -y and mirrors at
//! x = 0. Four layers of cells between bone and skin, each cut into tetrahedra.

use std::collections::BTreeMap;

use super::face_shape::{SIDE_ANGLE, TOP_ROW, column};
use super::sample::{NodeSets, bone_below, layers_of};
use super::{CellShape, TriangleSurface, Vector, VolumeMesh};

/// The fineness of the demo: 62 208 tetrahedra.
pub const STANDARD_FINENESS: usize = 6;

/// The names of the values in the cell array `layer`.
pub const LAYERS: [&str; 4] = ["deep", "muscle", "fat", "skin"];

/// Soft tissue, the bone below it and the points that orthodontists measure.
#[derive(Clone, Debug, PartialEq)]
pub struct HalfHead {
    /// Cell array `layer` (see [`LAYERS`]); node sets `maxilla`, `mandible` and `skull` on bone,
    /// `rim` on the cut faces and `skin`, whose outermost nodes are also those of the rim, with its
    /// parts `nose`, `lips` and `chin`.
    pub mesh: VolumeMesh,
    /// `maxilla`, `mandible` and `skull`: bone under the tissue, its normals towards the tissue.
    pub bones: BTreeMap<&'static str, TriangleSurface>,
    /// On the skin.
    pub landmarks: BTreeMap<&'static str, Vector>,
}

/// A half head with 9 n rows, 8 n columns and 4 layers of cells, 1728 n² tetrahedra; n at least 1.
pub fn half_head(fineness: usize) -> HalfHead {
    let grid = Grid::of(fineness.max(1));
    let nodes = grid.nodes();
    let mesh = VolumeMesh {
        cells: layers_of(&grid.quads(), grid.sheet_nodes(), 4, CellShape::Tet4, &nodes),
        cell_labels: BTreeMap::from([("layer".to_owned(), grid.layer_labels())]),
        node_sets: grid.node_sets(&nodes),
        nodes,
        ..VolumeMesh::default()
    };
    HalfHead {
        bones: BONES.into_iter().map(|name| (name, bone_below(&mesh, name))).collect(),
        landmarks: grid.landmarks(&mesh.nodes),
        mesh,
    }
}

/// Parts of the skin by rows and half width in mm.
const SKIN_REGIONS: [(&str, std::ops::RangeInclusive<f64>, f64); 3] =
    [("nose", 33.5..=44.0, 18.0), ("lips", 23.0..=31.5, 26.0), ("chin", 11.0..=20.0, 24.0)];

const BONES: [&str; 3] = ["maxilla", "mandible", "skull"];

/// Which bone the tissue is attached to. Between the jaws, 25 mm around the lips, the mucosa is
/// free, as are cheeks, floor of the mouth and nostrils; without such gaps a plan would tear.
pub(super) fn bone_at(row: f64, angle: f64, is_near_middle: bool) -> Option<&'static str> {
    let nostrils = is_near_middle && row < 45.5;
    if (11.9..=22.6).contains(&row) && angle < 1.3 {
        Some("mandible")
    } else if (30.4..=37.6).contains(&row) && angle < 0.62 {
        Some("maxilla")
    } else if row > 41.4 && !nostrils {
        Some("skull")
    } else {
        None
    }
}

/// Rows from the neck up, columns from the right side to the left, 0 in the middle.
struct Grid {
    rows: usize,
    half_columns: isize,
}

impl Grid {
    fn of(fineness: usize) -> Self {
        Grid { rows: 9 * fineness, half_columns: 4 * fineness as isize }
    }

    fn row_nodes(&self) -> usize {
        2 * self.half_columns as usize + 1
    }

    fn sheet_nodes(&self) -> usize {
        (self.rows + 1) * self.row_nodes()
    }

    fn node(&self, layer: usize, row: usize, place: usize) -> usize {
        layer * self.sheet_nodes() + row * self.row_nodes() + place
    }

    /// A row's nodes go outwards from the middle, so that the cut of the cells, which begins at the
    /// lowest number, mirrors too: columns 0, 1, -1, 2, -2, …
    fn column_at(&self, place: usize) -> isize {
        let outwards = place.div_ceil(2) as isize;
        if place % 2 == 1 { outwards } else { -outwards }
    }

    fn place_of(column: isize) -> usize {
        if column > 0 { 2 * column as usize - 1 } else { 2 * column.unsigned_abs() }
    }

    fn row(&self, row: usize) -> f64 {
        TOP_ROW * row as f64 / self.rows as f64
    }

    /// In radians from the front; columns stand closer in the middle of the face.
    fn angle(&self, column: isize) -> f64 {
        let share = column as f64 / self.half_columns as f64;
        SIDE_ANGLE * share * (0.62 + 0.38 * share * share)
    }

    /// Layer by layer from the bone out.
    fn nodes(&self) -> Vec<Vector> {
        let mut nodes = vec![Vector::zeros(); 5 * self.sheet_nodes()];
        for row in 0..=self.rows {
            for place in 0..self.row_nodes() {
                let angle = self.angle(self.column_at(place));
                let across = column(self.row(row), angle.abs());
                for (layer, mut point) in across.into_iter().enumerate() {
                    // Both sides come from the same angle, so that they mirror to the last bit.
                    point.x = if angle == 0.0 { 0.0 } else { point.x.abs().copysign(angle) };
                    nodes[self.node(layer, row, place)] = point;
                }
            }
        }
        nodes
    }

    fn node_sets(&self, nodes: &[Vector]) -> BTreeMap<String, Vec<u32>> {
        let mut sets = NodeSets::default();
        for (number, point) in nodes.iter().enumerate() {
            let node = number as u32;
            let layer = number / self.sheet_nodes();
            let in_sheet = number % self.sheet_nodes();
            let (row, place) = (in_sheet / self.row_nodes(), in_sheet % self.row_nodes());
            let (column, row_of_profile) = (self.column_at(place), self.row(row));
            let rim = row == 0 || row == self.rows || column.abs() == self.half_columns;
            sets.push("rim", node, rim);
            sets.push("skin", node, layer == 4);
            for (name, rows, half_width) in SKIN_REGIONS {
                let inside = rows.contains(&row_of_profile) && point.x.abs() < half_width;
                sets.push(name, node, layer == 4 && inside);
            }
            let bone = bone_at(row_of_profile, self.angle(column).abs(), point.x.abs() < 11.0);
            for name in BONES {
                sets.push(name, node, layer == 0 && !rim && bone == Some(name));
            }
        }
        sets.0
    }

    /// Row by row from the right; cut along their diagonal 0-2, which leads outwards and up.
    fn quads(&self) -> Vec<[u32; 4]> {
        let mut quads = Vec::new();
        for row in 0..self.rows {
            for column in -self.half_columns..self.half_columns {
                let at = |row: usize, column| self.node(0, row, Self::place_of(column)) as u32;
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
                quads.push(if column < 0 { [b, c, d, a] } else { [a, b, c, d] });
            }
        }
        quads
    }

    /// The layer of each tetrahedron, in the order of the cells. The muscle is a band around the
    /// mouth and through the cheeks; above and below it, its layer is fat.
    fn layer_labels(&self) -> Vec<i64> {
        let mut labels = Vec::new();
        for layer in 0..4 {
            for row in 0..self.rows {
                let middle = self.row(row) + self.row(1) / 2.0;
                let muscle = (19.5..34.5).contains(&middle);
                let label = if layer == 1 && !muscle { 2 } else { layer };
                labels.extend(std::iter::repeat_n(label, 6 * 2 * self.half_columns as usize));
            }
        }
        labels
    }

    /// Extreme points of the profile, each between two rows.
    fn landmarks(&self, nodes: &[Vector]) -> BTreeMap<&'static str, Vector> {
        let extreme = |from: f64, to: f64, direction: Vector| {
            let candidates = (0..=self.rows)
                .filter(|&row| (from..=to).contains(&self.row(row)))
                .map(|row| nodes[self.node(4, row, 0)]);
            candidates.max_by(|a, b| a.dot(&direction).total_cmp(&b.dot(&direction)))
        };
        let forward = -Vector::y();
        [
            ("glabella", 49.0, 52.0, forward),
            ("nasion", 44.0, 48.5, -forward),
            ("pronasale", 34.5, 41.0, forward),
            ("subnasale", 30.5, 34.5, -forward),
            ("labrale_superius", 28.0, 31.0, forward),
            ("stomion", 25.5, 29.0, -forward),
            ("labrale_inferius", 23.5, 27.0, forward),
            ("sulcus_mentolabialis", 19.5, 24.0, -forward),
            ("pogonion", 14.0, 19.5, forward),
            ("menton", 10.0, 14.0, forward - Vector::z() * 4.0),
        ]
        .into_iter()
        .filter_map(|(name, from, to, direction)| Some((name, extreme(from, to, direction)?)))
        .collect()
    }
}

#[cfg(test)]
#[path = "half_head_tests.rs"]
mod tests;
