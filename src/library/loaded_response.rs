//! A response in memory: its columns as they are applied, read from its files.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::applied::Applied;
use super::cache::InMemory;
use crate::jobs::result::skin::PredictedSkin;
use crate::schema::WarningDocument;
use crate::schema::applied::{AppliedSummary, LinearPart};
use crate::schema::predict::document::{OutputName, USUAL_RANGE_MM};
use crate::schema::predict::result::NOT_A_DEVICE;
use crate::schema::response_description::{PlanAmounts, ResponseDescription};
use crate::store::StoreError;
use mechanics::format::{self, Mesh, ReadLimits, WriteError};
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::prediction::{Skin, skin_overlap};
use mechanics::response::coupling::couples;
use mechanics::response::{Amounts, COLUMNS_PER_SEGMENT, Linearity, QuadraticForm, Response};

/// A response in memory.
pub struct LoadedResponse {
    pub description: ResponseDescription,
    response: Response,
    second_order: Option<QuadraticForm>,
    linearity: Linearity,
    rest: TriangleSurface,
}

/// The files of a stored response.
pub(super) struct Stored {
    pub description: bytes::Bytes,
    pub columns: bytes::Bytes,
    pub second_order: Option<bytes::Bytes>,
    pub rest: bytes::Bytes,
}

impl LoadedResponse {
    /// One pass over the columns of each order.
    pub fn apply(&self, plan: &PlanAmounts) -> Applied {
        let PlanAmounts { movements, inner, doubts: _ } = plan;
        let mut displacement = self.response.apply_all(&Amounts { movements, inner });
        let segments = &self.response.segments;
        let form = self.second_order.as_ref();
        let beyond = form.map(|form| form.apply(segments, movements, &mut displacement));
        let of_case = self.description.warnings_of(plan);
        let is_turned = self.description.is_wall_turned(movements);
        let linear = LinearPart {
            nonlinearity: self.linearity.of(movements),
            is_unknown: is_turned
                || !self.linearity.is_known()
                || inner.iter().any(|amount| *amount != 0.0),
        };
        let summary = AppliedSummary::new(&displacement, beyond, &linear);
        let tearing_checked = self.description.edges_between.is_some();
        Applied::new(displacement, summary, of_case, tearing_checked)
    }

    /// Whether the moved skin passes through itself where it did not at rest. Takes milliseconds for each ten thousand
    /// triangles, so that it is only done where it is asked for.
    pub fn check_skin(&self, applied: Applied) -> Applied {
        let skin =
            Skin { surface: self.rest.clone(), regions: BTreeMap::new(), off: BTreeMap::new() };
        let mut moved = self.rest.clone();
        for (point, by) in moved.points.iter_mut().zip(&applied.displacement) {
            *point += by;
        }
        let overlap = skin_overlap(&skin, &moved);
        let overlap = overlap.iter().map(WarningDocument::from).collect();
        Applied { skin_checked: true, ..applied.warned(overlap) }
    }

    /// The skin at rest as binary glTF, its vertices in the order of `node_ids`.
    pub fn rest_glb(&self) -> Result<Vec<u8>, WriteError> {
        self.to_glb(vec![Vector::zeros(); self.rest.points.len()], USUAL_RANGE_MM)
    }

    /// The moved skin as binary glTF, its vertices in the order of `node_ids`, coloured by the length of its
    /// displacement up to a range in mm.
    pub fn glb(&self, applied: &Applied, range_mm: f64) -> Result<Vec<u8>, WriteError> {
        self.to_glb(applied.displacement.clone(), range_mm)
    }

    fn to_glb(&self, displacement: Vec<Vector>, range_mm: f64) -> Result<Vec<u8>, WriteError> {
        let rest =
            Skin { surface: self.rest.clone(), regions: BTreeMap::new(), off: BTreeMap::new() };
        let mut skin = PredictedSkin::of_displacement(&rest, displacement);
        skin.range_mm = range_mm;
        let texts = [
            ("job", self.description.job.clone().unwrap_or_default()),
            ("response_key", self.description.key.clone()),
            ("statement", NOT_A_DEVICE.to_owned()),
        ];
        let texts = texts.map(|(name, text)| (name.to_owned(), text));
        let bytes = skin.encode(OutputName::SkinGlb, self.description.frame.into(), &texts)?;
        bytes.ok_or(WriteError::Empty)
    }
}

impl InMemory for Arc<LoadedResponse> {
    fn size(&self) -> usize {
        let skin = 28 * self.rest.points.len() + 12 * self.rest.triangles.len();
        let second = self.second_order.as_ref().map_or(0, |form| 2 * form.values.len());
        4 * (self.response.columns.len() + 2 * self.response.nodes.len()) + second + skin
    }
}

fn broken(what: &str) -> StoreError {
    StoreError::Schema(format!("stored response: {what}"))
}

/// A response out of its files.
pub(super) fn parsed(stored: &Stored) -> Result<LoadedResponse, StoreError> {
    let Stored { description, columns, second_order, rest } = stored;
    let description: ResponseDescription =
        serde_json::from_slice(description).map_err(|error| broken(&error.to_string()))?;
    // Our own writer may compress better than a stranger's file is allowed to.
    let limits = ReadLimits { decoded_ratio: f64::INFINITY, ..ReadLimits::default() };
    let rest = format::read(rest, &limits).map_err(|error| broken(&error.to_string()))?;
    let Mesh::Surface(rest) = rest.mesh else { return Err(broken("the skin is no surface")) };
    let (values, _) = columns.as_chunks::<4>();
    let columns: Vec<f32> = values.iter().map(|&value| f32::from_le_bytes(value)).collect();
    let count = usize::try_from(description.columns.count).unwrap_or(usize::MAX);
    let nodes = description.node_ids.len();
    if nodes.checked_mul(3).and_then(|length| length.checked_mul(count)) != Some(columns.len())
        || rest.points.len() != nodes
    {
        return Err(broken("its files do not fit each other"));
    }
    check_coupling(&description)?;
    let second_order = second_order_of(&description, second_order.as_deref())?;
    Ok(LoadedResponse {
        second_order,
        response: Response {
            inner: description.inner_loads(),
            segments: description.response_segments(),
            nodes: description.node_ids.clone(),
            columns,
        },
        linearity: description.to_linearity(),
        rest,
        description,
    })
}

/// What its segments do together at second order, which estimates of every applied plan take.
fn check_coupling(description: &ResponseDescription) -> Result<(), StoreError> {
    let coupled = description.linearity.second_order_coupling.len();
    match couples(2, description.segments.len(), coupled) {
        true => Ok(()),
        false => Err(broken("its coupling of second order does not fit its segments")),
    }
}

/// The quadratic form of a response that has one.
fn second_order_of(
    description: &ResponseDescription,
    bytes: Option<&[u8]>,
) -> Result<Option<QuadraticForm>, StoreError> {
    let Some(document) = &description.second_order else { return Ok(None) };
    let (values, _) = bytes.unwrap_or_default().as_chunks::<2>();
    let values: Vec<i16> = values.iter().map(|&value| i16::from_le_bytes(value)).collect();
    let numbers = COLUMNS_PER_SEGMENT * description.segments.len();
    let pairs = numbers * (numbers + 1) / 2;
    if values.len() != 3 * pairs * description.node_ids.len()
        || document.scale_mm.len() != pairs
        || document.third_order_mm.len() != description.segments.len()
        || !couples(3, description.segments.len(), document.third_order_coupling.len())
    {
        return Err(broken("its columns of second order do not fit"));
    }
    Ok(Some(document.to_form(numbers, values)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::response_description::ResponseOrigin;
    use crate::schema::second_order::ColumnsDocument;
    use mechanics::response::{Columns, ResponseSegment};

    /// A response of one segment that takes 4 * (36 + 2) + 28 bytes for each node.
    fn loaded(nodes: u32) -> Arc<LoadedResponse> {
        let segments = vec![ResponseSegment { name: "jaw".into(), centre: Vector::zeros() }];
        let corner = Vector::zeros();
        let linearity = Linearity {
            thickness: 1.0,
            something_stays: true,
            boxes: vec![[corner, corner]],
            sampled: Vec::new(),
            coupling: Vec::new(),
        };
        let solver = mechanics::prediction::SolveReport::at_rest(0, 0.0);
        let values = vec![0.0; 36 * nodes as usize];
        let nodes: Vec<u32> = (0..nodes).collect();
        let rest = TriangleSurface {
            points: vec![Vector::zeros(); nodes.len()],
            ..TriangleSurface::default()
        };
        let columns = Columns {
            segments,
            inner: Vec::new(),
            nodes,
            values,
            linearity: linearity.clone(),
            second_order: None,
            parts: Vec::new(),
            edges_between: Vec::new(),
            carries_wall: vec![false],
            allow_unfixed: false,
            diagonal: 1.0,
            solver,
            elements: Vec::new(),
        };
        let (file, layout, sha256) = (String::new(), String::new(), String::new());
        let origin = ResponseOrigin {
            job: None,
            key: String::new(),
            frame: mechanics::mesh::Frame::Lps,
            mesh_centre: Vector::zeros(),
            regions: Vec::new(),
            staying: Vec::new(),
            columns: ColumnsDocument { file, layout, count: 12, bytes: 0, sha256 },
            second_order: None,
            warnings: Vec::new(),
        };
        let description = ResponseDescription::new(&columns, origin);
        let response = columns.to_response();
        Arc::new(LoadedResponse { description, response, second_order: None, linearity, rest })
    }

    #[test]
    fn a_coupling_of_other_segments_is_broken() {
        let mut description = loaded(1).description.clone();
        // Of six directions of one segment there are 21 pairs.
        for (coupled, fits) in [(0, true), (21, true), (20, false), (78, false)] {
            description.linearity.second_order_coupling = vec![Default::default(); coupled];
            assert_eq!(check_coupling(&description).is_ok(), fits, "{coupled}");
        }
    }

    #[test]
    fn a_response_takes_the_memory_of_its_columns_and_of_its_skin() {
        assert_eq!(loaded(4).size(), 180 * 4);
    }
}
