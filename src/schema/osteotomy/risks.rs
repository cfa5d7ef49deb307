//! Conversion of structures at risk, which cuts must avoid, to the numerics, with their errors.

use mechanics::osteotomy::Risk;

use super::conversion::OsteotomyContext;
use super::document::OsteotomyDocument;
use crate::schema::TriangleCorners;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::names::check_distinct;

/// Points, and triangles, of a structure as a surface.
const MOST_OF_SURFACE: usize = 20_000;

/// The largest distance of a head from the origin of its scan.
const FARTHEST_MM: f64 = 1e5;

impl OsteotomyDocument {
    pub(super) fn to_risks(
        &self,
        at: &Pointer,
        context: &OsteotomyContext,
        faults: &mut Faults,
    ) -> Vec<Risk> {
        let most = context.limits.list_entries as usize;
        faults.check_length(at, self.risks.len(), most);
        check_distinct(self.risks.iter().map(|risk| risk.name.as_str()), at, faults);
        let mut risks = Vec::new();
        for (number, risk) in self.risks.iter().enumerate() {
            let at = at.index(number);
            let name = risk.name.trim();
            faults.check_name(&at.key("name"), name, context.limits.name_characters as usize);
            let (place, count) = (at.key("points_mm"), risk.points_mm.len());
            let triangles = at.key("triangles");
            let is_surface = !risk.triangles.is_empty();
            faults.check_length(&place, count, if is_surface { MOST_OF_SURFACE } else { most });
            faults.check_length(&triangles, risk.triangles.len(), MOST_OF_SURFACE);
            let beyond =
                |corners: &TriangleCorners| corners.0.iter().any(|&own| own as usize >= count);
            if let Some(triangle) = risk.triangles.iter().position(beyond) {
                let detail = format!("a corner is not one of the {count} points, counted from 0");
                faults.add(&triangles.index(triangle), ErrorCode::OutOfRange, detail);
            }
            if count < 2 {
                let detail = format!("a line needs two or more points, this one has {count}");
                faults.add(&place, ErrorCode::OutOfRange, detail);
            }
            for (number, point) in risk.points_mm.iter().enumerate() {
                for (axis, &value) in point.0.iter().enumerate() {
                    let place = place.index(number).index(axis);
                    faults.check_range(&place, value, -FARTHEST_MM..=FARTHEST_MM, "mm");
                }
            }
            let radius = risk.radius_mm.unwrap_or(0.0);
            faults.check_range(&at.key("radius_mm"), radius, 0.0..=20.0, "mm");
            faults.check_range(&at.key("clearance_mm"), risk.clearance_mm, 0.0..=50.0, "mm");
            risks.push(Risk {
                name: name.to_owned(),
                points: risk.points_mm.iter().map(|&point| context.vector(point)).collect(),
                triangles: risk.triangles.iter().map(|corners| corners.0).collect(),
                radius,
                clearance: risk.clearance_mm,
            });
        }
        risks
    }
}
