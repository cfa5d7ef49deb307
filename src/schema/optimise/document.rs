//! Spec of inverse planning: targets on the skin, and bounds of the movement of each segment.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::target::{TargetDocument, check_twice};
use super::tissue::{TissueBoundsDocument, check_tissue};
use crate::schema::Triple;
use crate::schema::case::document::CaseDocument;
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::case::membrane::MembraneDocument;
use crate::schema::code::ErrorCode;
use crate::schema::methods::{self, ElementName, MethodName};
use crate::schema::plan::document::{
    ActivationDocument, GrowthDocument, PlanDocument, PlanSegmentDocument,
};
use crate::schema::plan::inner::{to_activations, to_growth};
use crate::schema::plan::movement::FARTHEST_PIVOT_MM;
use crate::schema::predict::budget::BudgetDocument;
use crate::schema::predict::document::PredictDocument;
use crate::schema::predict::output::OutputName;
use crate::schema::predict::tolerance::ToleranceDocument;
use crate::schema::response::{ResponseDocument, check_order};
use crate::schema::wire::canonical;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::vector::Intervals;
use mechanics::mesh::Vector;
use mechanics::optimisation::{PARAMETERS_PER_SEGMENT, SegmentBounds};

/// `optimise`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum OptimiseKind {
    #[default]
    Optimise,
}

/// Inverse planning: the plan within `bounds`, and the growth and the constants within `tissue_bounds`, with the least sum of
/// squares of residual over `sigma_mm`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OptimiseDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: OptimiseKind,
    /// The id of the case.
    pub case: String,
    /// Desired positions of skin; coordinates in the frame of the case.
    #[schema(min_items = 1)]
    pub targets: Vec<TargetDocument>,
    /// Bounds of movements by segment name; other segments are fixed.
    pub bounds: BTreeMap<String, BoundsDocument>,
    /// Unknown growth and constants, estimated with the plan, by region: from a scan after the operation, loss and constants
    /// of tissue. `*` is every region without an entry.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub tissue_bounds: BTreeMap<String, TissueBoundsDocument>,
    /// Growth that is given, not searched for, and part of the plan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub growth: Vec<GrowthDocument>,
    /// Activations, given likewise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub activations: Vec<ActivationDocument>,
    /// Solves the resulting plan as `predict` would, and reports the difference of its skin from that of the
    /// response.
    #[serde(default = "yes")]
    #[schema(default = true)]
    pub verify: bool,
    /// 1, the default: the skin is linear in the movements. 2: with what linear elasticity leaves out to second order, as a response of
    /// order 2; without growth, activations and `tissue_bounds`. `verify` solves the plan at finite strain then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 2)]
    pub order: Option<u8>,
    /// Linear methods only.
    #[serde(default)]
    pub method: MethodName,
    #[serde(default)]
    pub element: ElementName,
    /// Overrides the materials of the case, by member.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<BTreeMap<String, MaterialDocument>>)]
    pub materials: Option<MaterialDocuments>,
    /// Absent: no membrane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub membrane: Option<MembraneDocument>,
    #[serde(default)]
    pub tolerance: ToleranceDocument,
    #[serde(default)]
    pub budget: BudgetDocument,
    /// As for `predict`; `volume.vtu` needs `verify`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub outputs: Option<Vec<OutputName>>,
    /// As for `predict`: the displacement at the end of the colour scale of `skin.glb` and `skin.ply`, in mm. Default: 10.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.001, maximum = 1000.0)]
    pub range_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

fn yes() -> bool {
    true
}

/// Bounds of the movement of a segment; equal bounds fix a value. Omitted members are fixed at 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundsDocument {
    #[serde(default)]
    pub translation_mm: Intervals,
    /// About x, y and z, in the order `xyz-extrinsic`.
    #[serde(default)]
    pub rotation_deg: Intervals,
    /// Required if a rotation may be other than 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub pivot_mm: Option<Triple>,
}

impl OptimiseDocument {
    /// Adds its faults, except those that need the meshes; pointers start at `/spec`.
    pub fn check(&self, case: &CaseDocument, limits: &Limits, faults: &mut Faults) {
        let root = Pointer::root().key("spec");
        methods::check_linear(self.method, &root.key("method"), faults);
        check_order(self.order, &root, faults);
        let at = root.key("targets");
        if self.targets.is_empty() {
            faults.add(&at, ErrorCode::MissingField, "at least one target is needed");
        }
        faults.check_length(&at, self.targets.len(), limits.list_entries as usize);
        for (index, target) in self.targets.iter().enumerate() {
            target.check(&at.index(index), case, limits, faults);
        }
        check_twice(&self.targets, &at, faults);
        let at = root.key("bounds");
        faults.check_length(&at, self.bounds.len(), limits.list_entries as usize);
        for (name, bounds) in &self.bounds {
            faults.check_name(&at.key(name), name, limits.name_characters as usize);
            bounds.check(&at.key(name), limits, faults);
        }
        _ = to_growth(&self.growth, &root.key("growth"), limits, faults);
        _ = to_activations(&self.activations, &root.key("activations"), limits, faults);
        check_tissue(&self.tissue_bounds, &self.growth, &root.key("tissue_bounds"), limits, faults);
        if self.order == Some(2) && !self.tissue_bounds.is_empty() {
            let detail = "constants and growth are looked for in order 1 only";
            faults.add(&root.key("order"), ErrorCode::MethodNotAvailable, detail);
        }
        let moves = self.bounds.values().any(BoundsDocument::is_free);
        if !moves && !self.tissue_bounds.values().any(TissueBoundsDocument::is_free) {
            let detail = "nothing may change: raise at least one highest value above its lowest";
            faults.add(&at, ErrorCode::NothingFree, detail);
        }
        for (index, name) in self.outputs.iter().flatten().enumerate() {
            if !self.verify && *name == OutputName::VolumeVtu {
                let detail = "the inside of the tissue needs `verify`";
                faults.add(&root.key("outputs").index(index), ErrorCode::NeedsVerify, detail);
            }
        }
    }

    /// The names of the segments that may move or are fixed at other values than 0.
    pub fn moving(&self) -> Vec<String> {
        let moving = self.bounds.iter().filter(|(_, bounds)| **bounds != bounds.at_rest());
        moving.map(|(name, _)| name.trim().to_owned()).collect()
    }

    /// The regions with a column of growth: first those of given growth, then those of unknown growth.
    pub fn growing(&self) -> Vec<String> {
        let stated = self.growth.iter().map(|own| own.region.trim().to_owned());
        let free = self.tissue_bounds.iter().filter(|(_, own)| own.volume_change.is_some());
        stated.chain(free.map(|(region, _)| region.trim().to_owned())).collect()
    }

    /// The bounds of a segment.
    pub fn bounds_of(&self, segment: &str) -> BoundsDocument {
        let mut bounds = self.bounds.iter();
        let own = bounds.find(|(name, _)| name.trim() == segment.trim());
        own.map(|(_, bounds)| *bounds).unwrap_or_default()
    }

    /// A plan in which every segment of the bounds stays.
    pub fn rest(&self) -> PlanDocument {
        let rest = |name: &String| PlanSegmentDocument {
            name: name.clone(),
            translation_mm: Some(Triple::default()),
            ..PlanSegmentDocument::default()
        };
        PlanDocument { segments: self.bounds.keys().map(rest).collect(), ..PlanDocument::default() }
    }

    /// A plan of the given growth and activations.
    pub fn held(&self) -> PlanDocument {
        PlanDocument {
            growth: self.growth.clone(),
            activations: self.activations.clone(),
            ..PlanDocument::default()
        }
    }

    /// The prediction of the resulting plan, whose checks it shares.
    pub fn to_prediction(&self) -> PredictDocument {
        let shared = self.to_response().to_prediction();
        PredictDocument { outputs: self.outputs.clone(), range_mm: self.range_mm, ..shared }
    }

    /// The response that the optimisation uses.
    pub fn to_response(&self) -> ResponseDocument {
        ResponseDocument {
            case: self.case.clone(),
            order: self.order,
            method: self.method,
            element: self.element,
            materials: self.materials.clone(),
            membrane: self.membrane.clone(),
            segments: self.moving(),
            growth: self.growing(),
            muscles: Some(
                self.activations.iter().map(|own| own.muscle.trim().to_owned()).collect(),
            ),
            tolerance: self.tolerance,
            budget: self.budget,
            tags: self.tags.clone(),
            ..ResponseDocument::default()
        }
    }

    /// Every surface of its selections; some may be names of bones of the case.
    pub fn surfaces_mut(&mut self) -> Vec<&mut String> {
        let mut found = Vec::new();
        for nodes in self.targets.iter_mut().filter_map(|target| target.nodes.as_mut()) {
            nodes.surfaces_mut(&Pointer::root(), &mut found);
        }
        found.into_iter().map(|(_, id)| id).collect()
    }

    /// Everything that determines the numbers, for the hash of the job: no tags, no ids.
    pub fn content(&self) -> Value {
        let mut plain = self.clone();
        plain.tags.clear();
        plain.case.clear();
        plain.outputs = Some(self.to_prediction().files());
        plain.order = plain.order.filter(|order| *order != 1);
        canonical::to_value(&plain)
    }
}

impl BoundsDocument {
    /// The six intervals in mm and degrees.
    pub fn intervals(&self) -> [[f64; 2]; PARAMETERS_PER_SEGMENT] {
        let (Intervals([x, y, z]), Intervals([a, b, c])) = (self.translation_mm, self.rotation_deg);
        [x, y, z, a, b, c]
    }

    fn is_free(&self) -> bool {
        self.intervals().iter().any(|[low, high]| low < high)
    }

    /// The same with everything fixed at 0.
    fn at_rest(&self) -> Self {
        BoundsDocument { pivot_mm: self.pivot_mm, ..BoundsDocument::default() }
    }

    pub fn to_bounds(self) -> SegmentBounds {
        let intervals = self.intervals();
        SegmentBounds {
            intervals: std::array::from_fn(|number| {
                let [low, high] = intervals[number];
                if number < 3 { (low, high) } else { (low.to_radians(), high.to_radians()) }
            }),
            pivot: self.pivot_mm.unwrap_or_default().into(),
        }
    }

    fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let whole = [
            ("translation_mm", self.translation_mm, limits.translation_mm, "mm"),
            ("rotation_deg", self.rotation_deg, limits.rotation_deg, "deg"),
        ];
        for (name, Intervals(intervals), most, unit) in whole {
            for (axis, [low, high]) in intervals.into_iter().enumerate() {
                let place = at.key(name).index(axis);
                let inside = faults.check_range(&place.index(0), low, -most..=most, unit)
                    && faults.check_range(&place.index(1), high, -most..=most, unit);
                if inside && low > high {
                    let detail = format!("the lowest value {low} is above the highest {high}");
                    faults.add(&place, ErrorCode::OutOfRange, detail);
                }
            }
        }
        let farthest = self.translation_mm.0.map(|[low, high]| low.abs().max(high.abs()));
        let (length, longest) = (Vector::from(farthest).norm(), limits.translation_mm);
        // One that overflows has been refused at its place.
        if length > longest && length.is_finite() {
            let detail = format!(
                "the farthest corner is at {length:.3} mm, at most {longest} mm are allowed"
            );
            faults.add(&at.key("translation_mm"), ErrorCode::PlanOutOfRange, detail);
        }
        let place = at.key("pivot_mm");
        match self.pivot_mm {
            None if self.rotation_deg != Intervals::default() => {
                let detail = "`pivot_mm` is required where a rotation may be other than 0";
                faults.add(&place, ErrorCode::MissingField, detail);
            }
            None => {}
            Some(Triple(pivot)) => {
                for (axis, coordinate) in pivot.into_iter().enumerate() {
                    let range = -FARTHEST_PIVOT_MM..=FARTHEST_PIVOT_MM;
                    faults.check_range(&place.index(axis), coordinate, range, "mm");
                }
            }
        }
    }
}
