//! Targets of the skin: wanted positions, or a scan.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::case::document::CaseDocument;
use crate::schema::case::selection::SelectionDocument;
use crate::schema::code::ErrorCode;
use crate::schema::plan::movement::FARTHEST_PIVOT_MM;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::{PartialTriple, Triple};
use mechanics::mesh::Vector;
use mechanics::mesh::ignored::listed;

/// Range of standard deviations in mm: with a larger ratio rounding would dominate the looser target.
const SIGMA_MM: (f64, f64) = (1e-3, 1e3);

/// The desired position of a part of the skin: exactly one of `nodes`, `landmark` and a point, and exactly one of
/// `position_mm` and `displacement_mm`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TargetDocument {
    /// Applies to every selected node of the skin; several have one component of `position_mm` at most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub nodes: Option<SelectionDocument>,
    /// A landmark of the case; it moves as the point of the skin closest to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub landmark: Option<String>,
    /// A point in mm in the frame of the case, undeformed; it moves as the point of the skin closest to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub point_mm: Option<Triple>,
    /// The desired position; a component that is null is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub position_mm: Option<PartialTriple>,
    /// The desired displacement; a component that is null is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub displacement_mm: Option<PartialTriple>,
    /// The standard deviation of each component at each node, all independent; in [1e-3, 1e3].
    #[serde(default = "usual_sigma")]
    #[schema(default = 1.0, minimum = 1e-3, maximum = 1e3)]
    pub sigma_mm: f64,
}

fn usual_sigma() -> f64 {
    1.0
}

impl TargetDocument {
    pub(super) fn check(
        &self,
        at: &Pointer,
        case: &CaseDocument,
        limits: &Limits,
        faults: &mut Faults,
    ) {
        let forms = [self.nodes.is_some(), self.landmark.is_some(), self.point_mm.is_some()];
        let given = forms.into_iter().filter(|&form| form).count();
        faults.check_one_of(at, given, "`nodes`, `landmark`, `point_mm`");
        for (axis, value) in self.point_mm.iter().flat_map(|point| point.0.into_iter().enumerate())
        {
            let farthest = -FARTHEST_PIVOT_MM..=FARTHEST_PIVOT_MM;
            faults.check_range(&at.key("point_mm").index(axis), value, farthest, "mm");
        }
        if let Some(name) = &self.landmark
            && !case.landmarks.contains_key(name)
        {
            let known = listed(case.landmarks.keys());
            let detail = format!("the case has no landmark {name:?}, only {known}");
            faults.add(&at.key("landmark"), ErrorCode::UnknownLandmark, detail);
        }
        let places = [self.position_mm, self.displacement_mm];
        let given = places.into_iter().flatten().count();
        if faults.check_one_of(at, given, "`position_mm`, `displacement_mm`") {
            let (place, components) = self.wanted(at);
            if components == [None; 3] {
                faults.add(&place, ErrorCode::MissingField, "at least one component has a value");
            }
            let farthest = match self.displacement_mm {
                Some(_) => limits.translation_mm,
                None => FARTHEST_PIVOT_MM,
            };
            for (axis, value) in components.into_iter().enumerate() {
                let value = value.unwrap_or_default();
                faults.check_range(&place.index(axis), value, -farthest..=farthest, "mm");
            }
        }
        let (least, most) = SIGMA_MM;
        faults.check_range(&at.key("sigma_mm"), self.sigma_mm, least..=most, "mm");
    }

    /// The components that are stated, and their places.
    pub fn wanted(&self, at: &Pointer) -> (Pointer, [Option<f64>; 3]) {
        match (self.position_mm, self.displacement_mm) {
            (Some(position), _) => (at.key("position_mm"), position.0),
            (None, displacement) => (at.key("displacement_mm"), displacement.unwrap_or_default().0),
        }
    }

    /// The desired displacement of a point with this undeformed position.
    pub fn displacement(&self, rest: &Vector) -> [Option<f64>; 3] {
        match self.position_mm {
            Some(PartialTriple(position)) => {
                std::array::from_fn(|axis| position[axis].map(|wanted| wanted - rest[axis]))
            }
            None => self.displacement_mm.unwrap_or_default().0,
        }
    }
}

/// Targets that are alike in all of their members would count twice.
pub(super) fn check_twice(targets: &[TargetDocument], at: &Pointer, faults: &mut Faults) {
    let mut first = BTreeMap::new();
    for (index, target) in targets.iter().enumerate() {
        let text = serde_json::to_string(target).unwrap_or_default();
        let before = *first.entry(text).or_insert(index);
        if before != index {
            let detail = format!("it is target {before} once more, which would count twice");
            faults.add(&at.index(index), ErrorCode::DuplicateName, detail);
        }
    }
}
