//! The cells of the generic face: rows from the neck up, columns from the middle outwards, layers from the bone out.
//!
//! The row on which the lips meet has two points for each column between the corners of the mouth, one of each lip.

use std::collections::BTreeMap;

use super::super::face_shape::{SIDE_ANGLE, interpolated};
use super::super::half_head::bone_at;
use super::super::sample::{NodeSets, layers_of};
use super::super::{CellShape, Vector, VolumeMesh};
use super::shape::{CORNER_ANGLE, FaceShape, LIP_ROW, Lip};

pub(super) const BONES: [&str; 3] = ["maxilla", "mandible", "skull"];

/// Lines of cells from the neck up at the fineness 1, and the row of the profile where each of these begins. They are finest at
/// the mouth, 3 mm, and coarsest at neck and forehead.
const ROWS: [[f64; 2]; 10] = [
    [0.0, 0.0],
    [4.0, 9.0],
    [7.0, 15.0],
    [13.0, 23.0],
    [LIP_LINE as f64, LIP_ROW],
    [21.0, 31.5],
    [26.0, 37.5],
    [31.0, 45.0],
    [35.0, 49.5],
    [39.0, 54.0],
];
const LIP_LINE: usize = 17;
const LINES: usize = 39;
/// Columns between the middle and a corner of the mouth, and to the side, at the fineness 1.
const CORNER_COLUMN: usize = 6;
const HALF_COLUMNS: usize = 18;
const LAYER_COUNT: usize = 4;

/// Parts of the skin by rows and by degrees from the front.
struct Part {
    name: &'static str,
    rows: std::ops::RangeInclusive<f64>,
    degrees: std::ops::RangeInclusive<f64>,
}

const PARTS: [Part; 4] = [
    Part { name: "nose", rows: 33.5..=44.0, degrees: 0.0..=16.0 },
    Part { name: "lips", rows: 23.5..=31.8, degrees: 0.0..=25.0 },
    Part { name: "chin", rows: 11.0..=20.0, degrees: 0.0..=22.0 },
    Part { name: "cheeks", rows: 20.0..=37.0, degrees: 30.0..=70.0 },
];

/// The places of points in a sheet, and what lies there.
pub(super) struct Grid {
    fineness: usize,
    rows: usize,
    lip_line: usize,
    half_columns: isize,
    corner: isize,
    shape: FaceShape,
}

/// A point of a sheet.
#[derive(Clone, Copy)]
struct SheetPoint {
    line: usize,
    column: isize,
    lip: Lip,
}

impl Grid {
    pub(super) fn of(fineness: usize, shape: FaceShape) -> Self {
        Grid {
            fineness,
            rows: LINES * fineness,
            lip_line: LIP_LINE * fineness,
            half_columns: (HALF_COLUMNS * fineness) as isize,
            corner: (CORNER_COLUMN * fineness) as isize,
            shape,
        }
    }

    pub(super) fn mesh(&self, shape: CellShape) -> VolumeMesh {
        let spots = self.spots();
        let nodes = self.nodes(&spots);
        let quads = self.quads();
        VolumeMesh {
            cells: layers_of(&quads, spots.len(), LAYER_COUNT, shape, &nodes),
            cell_labels: BTreeMap::from([("layer".to_owned(), self.labels(shape))]),
            node_sets: self.node_sets(&spots),
            nodes,
            ..VolumeMesh::default()
        }
    }

    fn row_points(&self) -> usize {
        2 * self.half_columns as usize + 1
    }

    /// Row by row, each from the middle outwards, so that the cut of cells, which begins at the lowest number, mirrors too;
    /// the lower lip has its line in the row, the upper one after all rows.
    fn spots(&self) -> Vec<SheetPoint> {
        let of_line = |line: usize| (0..self.row_points()).map(move |place| (line, place));
        let spot = |(line, place): (usize, usize)| SheetPoint {
            line,
            column: column_at(place),
            lip: if line < self.lip_line { Lip::Lower } else { Lip::Upper },
        };
        let mut spots: Vec<SheetPoint> = (0..=self.rows).flat_map(of_line).map(spot).collect();
        for place in 0..self.parted() {
            let column = column_at(place);
            spots[self.lip_line * self.row_points() + place].lip = Lip::Lower;
            spots.push(SheetPoint { line: self.lip_line, column, lip: Lip::Upper });
        }
        spots
    }

    /// The columns between the corners of the mouth, without these.
    fn parted(&self) -> usize {
        2 * self.corner as usize - 1
    }

    /// The number of a point in its sheet.
    fn point(&self, line: usize, column: isize, lip: Lip) -> u32 {
        let is_second = line == self.lip_line && column.abs() < self.corner && lip == Lip::Upper;
        let line = if is_second { self.rows + 1 } else { line };
        (line * self.row_points() + place_of(column)) as u32
    }

    fn row(&self, line: usize) -> f64 {
        if line == self.lip_line {
            return LIP_ROW;
        }
        let [row] = interpolated(&ROWS, line as f64 / self.fineness as f64);
        row
    }

    /// In radians from the front: evenly to the corner of the mouth, and from there ever wider.
    fn angle(&self, column: isize) -> f64 {
        let (corner, steps) = (self.corner as f64, column.unsigned_abs() as f64);
        let evenly = CORNER_ANGLE / corner;
        if steps <= corner {
            return evenly * steps;
        }
        let (rest, left) = (self.half_columns as f64 - corner, SIDE_ANGLE - CORNER_ANGLE);
        let share = (steps - corner) / rest;
        let slope = evenly * rest / left;
        CORNER_ANGLE + left * share * (slope + (1.0 - slope) * share)
    }

    /// Layer by layer from the bone out.
    fn nodes(&self, spots: &[SheetPoint]) -> Vec<Vector> {
        let mut nodes = vec![Vector::zeros(); (LAYER_COUNT + 1) * spots.len()];
        for (number, spot) in spots.iter().enumerate() {
            let across = self.shape.column(self.row(spot.line), self.angle(spot.column), spot.lip);
            for (layer, mut point) in across.into_iter().enumerate() {
                // Both sides come from the same angle, so that they mirror to the last bit.
                point.x = match spot.column {
                    0 => 0.0,
                    column => point.x.abs().copysign(column as f64),
                };
                nodes[layer * spots.len() + number] = point;
            }
        }
        nodes
    }

    /// Cut along their diagonal 0-2, which leads outwards and up.
    fn quads(&self) -> Vec<[u32; 4]> {
        let mut quads = Vec::new();
        for line in 0..self.rows {
            let lip = if line < self.lip_line { Lip::Lower } else { Lip::Upper };
            for column in -self.half_columns..self.half_columns {
                let at = |line, column| self.point(line, column, lip);
                let [a, b] = [at(line, column), at(line, column + 1)];
                let [c, d] = [at(line + 1, column + 1), at(line + 1, column)];
                quads.push(if column < 0 { [b, c, d, a] } else { [a, b, c, d] });
            }
        }
        quads
    }

    /// The layer of each cell. Muscle is a band around the mouth, through the cheeks and over the chin; elsewhere its layer is fat.
    fn labels(&self, shape: CellShape) -> Vec<i64> {
        let cells = match shape {
            CellShape::Hex8 => 1,
            CellShape::Wedge6 => 2,
            CellShape::Tet4 => 6,
        };
        let mut labels = Vec::new();
        for layer in 0..LAYER_COUNT {
            for line in 0..self.rows {
                let middle = (self.row(line) + self.row(line + 1)) / 2.0;
                for column in -self.half_columns..self.half_columns {
                    let angle = (self.angle(column) + self.angle(column + 1)) / 2.0;
                    let label = match layer {
                        0 if bone_behind(middle, angle).is_none() => 4,
                        1 if !(12.0..38.0).contains(&middle) => 2,
                        layer => layer as i64,
                    };
                    labels.extend(std::iter::repeat_n(label, cells));
                }
            }
        }
        labels
    }

    fn node_sets(&self, spots: &[SheetPoint]) -> BTreeMap<String, Vec<u32>> {
        let mut sets = NodeSets::default();
        for layer in 0..=LAYER_COUNT {
            for (number, spot) in spots.iter().enumerate() {
                let node = (layer * spots.len() + number) as u32;
                let SheetPoint { line, column, lip } = *spot;
                let (row, angle) = (self.row(line), self.angle(column));
                let is_rim = line == 0 || line == self.rows || column.abs() == self.half_columns;
                let parts = line == self.lip_line && column.abs() <= self.corner;
                let is_corner = parts && column.abs() == self.corner;
                sets.push("rim", node, is_rim);
                sets.push("upper_lip_margin", node, parts && (is_corner || lip == Lip::Upper));
                sets.push("lower_lip_margin", node, parts && (is_corner || lip == Lip::Lower));
                if layer == LAYER_COUNT && !is_rim {
                    skin_sets(&mut sets, node, (row, angle), lip);
                }
                if layer == 0 && !is_rim {
                    inner_sets(&mut sets, node, (row, angle), lip);
                }
            }
        }
        sets.0
    }
}

/// Columns 0, 1, -1, 2, -2, …
fn column_at(place: usize) -> isize {
    let outwards = place.div_ceil(2) as isize;
    if place % 2 == 1 { outwards } else { -outwards }
}

fn place_of(column: isize) -> usize {
    if column > 0 { 2 * column as usize - 1 } else { 2 * column.unsigned_abs() }
}

fn skin_sets(sets: &mut NodeSets, node: u32, (row, angle): (f64, f64), lip: Lip) {
    sets.push("skin", node, true);
    for Part { name, rows, degrees } in &PARTS {
        let is_in = rows.contains(&row) && degrees.contains(&angle.to_degrees());
        sets.push(name, node, is_in);
        if *name == "lips" {
            sets.push("upper_lip", node, is_in && lip == Lip::Upper);
            sets.push("lower_lip", node, is_in && lip == Lip::Lower);
        }
    }
}

fn inner_sets(sets: &mut NodeSets, node: u32, (row, angle): (f64, f64), lip: Lip) {
    let bone = bone_behind(row, angle);
    for name in BONES {
        sets.push(name, node, bone == Some(name));
    }
    let on_teeth = bone.is_none() && (22.6..=30.4).contains(&row) && angle < TEETH;
    sets.push("upper_vestibule", node, on_teeth && lip == Lip::Upper);
    sets.push("lower_vestibule", node, on_teeth && lip == Lip::Lower);
}

/// Where the rows of teeth end, in radians from the front.
const TEETH: f64 = 1.0;

/// The bone behind a place of the face.
fn bone_behind(row: f64, angle: f64) -> Option<&'static str> {
    bone_at(row, angle, angle < 0.2)
}
