//! Polyline cuts as chains of polygons, with their errors.

use mechanics::mesh::Vector;
use mechanics::osteotomy::{Cut, CutError};

use super::conversion::OsteotomyContext;
use super::document::PolylineCutDocument;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};

impl PolylineCutDocument {
    /// A cut for each piece of the line, in order.
    pub(super) fn to_cuts(
        &self,
        at: &Pointer,
        number: usize,
        context: &OsteotomyContext,
        faults: &mut Faults,
    ) -> Option<Vec<Cut>> {
        let name = self.name.trim();
        faults.check_name(&at.key("name"), name, context.limits.name_characters as usize);
        let (place, count) = (at.key("polyline_mm"), self.polyline_mm.len());
        let most = context.limits.list_entries as usize;
        faults.check_length(&place, count, most);
        if count < 2 {
            let detail = format!("a line needs two or more points, this one has {count}");
            faults.add(&place, ErrorCode::OutOfRange, detail);
        }
        let depth = at.key("depth_mm");
        let has_depth = faults.check_range(&depth, self.depth_mm, 0.1..=300.0, "mm");
        if !((2..=most).contains(&count) && has_depth) {
            return None;
        }
        let line: Vec<Vector> = self.polyline_mm.iter().map(|&p| context.vector(p)).collect();
        let direction = context.vector(self.direction).try_normalize(1e-9);
        let Some(direction) = direction.filter(|direction| direction.norm().is_finite()) else {
            let detail = "the direction is shorter than 1e-9 or not a number";
            faults.add(&at.key("direction"), ErrorCode::OutOfRange, detail);
            return None;
        };
        let kerf = self.kerf_mm.unwrap_or(0.0);
        let cuts = Cut::chained(name, &line, direction * self.depth_mm, kerf, number);
        cuts.map_err(|error| {
            let (member, detail) = match &error {
                CutError::Kerf { .. } => ("kerf_mm", error.to_string()),
                CutError::Normal | CutError::Radius { .. } | CutError::Polygon { .. } => {
                    let detail = "a piece is parallel to the direction, or has no length";
                    ("polyline_mm", detail.to_owned())
                }
                CutError::Point => ("polyline_mm", error.to_string()),
            };
            faults.add(&at.key(member), ErrorCode::OutOfRange, detail);
        })
        .ok()
    }
}
