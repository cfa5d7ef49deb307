//! Boundary conditions of each connected part of a case, as stored in a response: enough to find plans that would move a part
//! rigidly.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::CornerPair;
use mechanics::boundary::{ConnectedPart, Form, HeldRows, Holder};
use mechanics::mesh::Vector;
use mechanics::plan::NUMBERS;

/// A part of the mesh connected by nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResponsePartDocument {
    pub nodes: u64,
    /// Its node with the lowest number.
    pub first_node: u32,
    /// Its share of the skin's unconstrained nodes.
    pub skin_share: f64,
    /// The box around it.
    pub box_mm: CornerPair,
    pub held: Vec<HeldFormDocument>,
}

/// Constraints of a part by one segment, or by all fixed nodes, as a quadratic form in the twelve numbers (rows of R - I, each
/// followed by its t) of a movement: the mean over its nodes of the squared displacement along the directions in
/// which they are constrained. Positions from the centre of the part's box, lengths in units of half its diagonal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct HeldFormDocument {
    /// Absent for fixed nodes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub segment: Option<String>,
    /// Nodes, and walls of nodes that slide.
    pub count: u64,
    /// The 78 entries of the upper triangle, row by row.
    pub form: Vec<f64>,
}

/// Rows and columns of the entries of an upper triangle.
fn upper() -> impl Iterator<Item = (usize, usize)> {
    (0..NUMBERS).flat_map(|row| (row..NUMBERS).map(move |column| (row, column)))
}

impl ResponsePartDocument {
    pub fn new(part: &ConnectedPart, segments: &[String]) -> Self {
        let [low, high] = part.corners;
        let held = part.held.iter().map(|rows| HeldFormDocument {
            segment: match rows.holder {
                Holder::Segment(number) => segments.get(number as usize).cloned(),
                Holder::Rest | Holder::Prescribed => None,
            },
            count: rows.count as u64,
            form: upper().map(|entry| rows.form[entry]).collect(),
        });
        ResponsePartDocument {
            nodes: part.nodes as u64,
            first_node: part.first_node,
            skin_share: part.skin_share,
            box_mm: CornerPair([low.x, low.y, low.z, high.x, high.y, high.z]),
            held: held.collect(),
        }
    }

    pub fn to_part(&self, segments: &[String]) -> ConnectedPart {
        let CornerPair([a, b, c, d, e, f]) = self.box_mm;
        ConnectedPart {
            nodes: self.nodes as usize,
            first_node: self.first_node,
            skin_share: self.skin_share,
            corners: [Vector::new(a, b, c), Vector::new(d, e, f)],
            held: self.held.iter().map(|held| held.to_rows(segments)).collect(),
        }
    }
}

impl HeldFormDocument {
    fn to_rows(&self, segments: &[String]) -> HeldRows {
        let name = self.segment.as_ref();
        let place = name.and_then(|name| segments.iter().position(|other| other == name));
        let holder = place.map_or(Holder::Rest, |place| Holder::Segment(place as u32));
        let mut form = Form::zeros();
        for ((row, column), entry) in upper().zip(&self.form) {
            form[(row, column)] = *entry;
            form[(column, row)] = *entry;
        }
        HeldRows::from_form(holder, self.count as usize, form)
    }
}
