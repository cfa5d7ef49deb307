//! The spec of a job that builds a plan response.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::code::ErrorCode;
use super::methods::{self, ElementName, MethodName};
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::case::membrane::MembraneDocument;
use crate::schema::plan::document::PlanDocument;
use crate::schema::predict::budget::BudgetDocument;
use crate::schema::predict::document::PredictDocument;
use crate::schema::predict::tolerance::ToleranceDocument;
use crate::schema::wire::canonical;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::problem::Problem;
use mechanics::mesh::Warning;
use mechanics::mesh::ignored::listed;
use mechanics::prediction::Scene;
use mechanics::response::{InnerLoad, ResponseError, ResponseOrder, inner_loads};

/// `response`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ResponseKind {
    #[default]
    Response,
}

/// A plan response: twelve solutions for each segment; the solution of every movement is a sum of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ResponseDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: ResponseKind,
    /// The id of the case.
    pub case: String,
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
    /// 1, the default: the skin is linear in the movements. 2: with the quadratic form of the second order of finite strain,
    /// 78 columns for one segment and 300 for two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 2)]
    pub order: Option<u8>,
    /// Names of segments of the case; default: all. The others are fixed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub segments: Vec<String>,
    /// Regions whose growth plans may state, a column each; `*`: all tissue. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub growth: Vec<String>,
    /// Muscles that plans may activate, a column each. Default: all of the case without `stiffening` for order 1, none for order 2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub muscles: Option<Vec<String>>,
    #[serde(default)]
    pub tolerance: ToleranceDocument,
    #[serde(default)]
    pub budget: BudgetDocument,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

impl ResponseDocument {
    /// The prediction of the same tissue, whose checks it shares.
    pub fn to_prediction(&self) -> PredictDocument {
        PredictDocument {
            method: self.method,
            element: self.element,
            materials: self.materials.clone(),
            membrane: self.membrane.clone(),
            tolerance: self.tolerance,
            budget: self.budget,
            tags: self.tags.clone(),
            ..PredictDocument::default()
        }
    }

    pub fn response_order(&self) -> ResponseOrder {
        match self.order {
            Some(2) => ResponseOrder::Second,
            _ => ResponseOrder::First,
        }
    }

    /// The members that make its skin another than that of `fem_linear` on the tissue of the case, with the usual element and tolerance.
    pub fn unusual(&self) -> Vec<&'static str> {
        let usual = ResponseDocument::default();
        let loose = usual.tolerance.relative_residual < self.tolerance.relative_residual;
        let members = [
            ("method", self.method.chosen() != usual.method.chosen()),
            ("element", self.element != usual.element),
            ("materials", self.materials.is_some()),
            ("membrane", self.membrane.is_some()),
            ("tolerance", loose),
        ];
        members.into_iter().filter(|(_, is_own)| *is_own).map(|(name, _)| name).collect()
    }

    /// Whether it has the columns that a plan names; without a plan, those of all segments.
    pub fn follows(&self, plan: Option<&PlanDocument>) -> bool {
        let Some(plan) = plan else { return self.segments.is_empty() };
        let has = |names: &[String], name: &str| names.iter().any(|own| own.trim() == name.trim());
        let all_muscles = self.muscles.is_none() && self.response_order() == ResponseOrder::First;
        let muscles = self.muscles.as_deref().unwrap_or_default();
        let moves = |name: &str| self.segments.is_empty() || has(&self.segments, name);
        plan.segments.iter().all(|of| moves(&of.name))
            && plan.growth.iter().all(|of| has(&self.growth, &of.region))
            && plan.activations.iter().all(|of| all_muscles || has(muscles, &of.muscle))
    }

    /// Everything that determines the numbers, for the key: no tags, segments unordered.
    pub fn content(&self) -> serde_json::Value {
        let mut plain = self.clone();
        plain.tags.clear();
        plain.segments.sort_unstable();
        plain.growth.sort_unstable();
        plain.muscles.iter_mut().for_each(|names| names.sort_unstable());
        plain.order = plain.order.filter(|order| *order != 1);
        canonical::to_value(&plain)
    }

    /// Refuses methods without a response, duplicate names, and too many names.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let spec = Pointer::root().key("spec");
        methods::check_linear(self.method, &spec.key("method"), faults);
        check_order(self.order, &spec, faults);
        let muscles = self.muscles.as_deref().unwrap_or_default();
        let named = [
            ("segments", "segment", &self.segments[..], limits.list_entries),
            ("growth", "region", &self.growth, limits.map_entries),
            ("muscles", "muscle", muscles, limits.map_entries),
        ];
        for (member, kind, names, most) in named {
            let at = spec.key(member);
            faults.check_length(&at, names.len(), most as usize);
            for (index, name) in names.iter().enumerate() {
                if names[..index].contains(name) {
                    let detail = format!("{kind} `{name}` is named more than once");
                    faults.add(&at.index(index), ErrorCode::DuplicateName, detail);
                }
            }
        }
    }

    /// The requested columns of growth and muscles of a scene.
    pub fn inner_loads(&self, scene: &Scene) -> Result<Vec<InnerLoad>, ResponseError> {
        let linear = scene.muscles.iter().filter(|own| !own.stiffens);
        let usual = match self.response_order() {
            ResponseOrder::First => linear.map(|own| own.name.clone()).collect(),
            ResponseOrder::Second => Vec::new(),
        };
        let trimmed = |names: &[String]| -> Vec<String> {
            names.iter().map(|name| name.trim().to_owned()).collect()
        };
        let muscles = self.muscles.as_deref().map_or(usual, trimmed);
        let loads = inner_loads(scene, &trimmed(&self.growth), &muscles)?;
        match self.response_order() == ResponseOrder::Second && !loads.is_empty() {
            true => Err(ResponseError::NoSecondOrderInside),
            false => Ok(loads),
        }
    }

    /// The warning of muscles that have no column since they stiffen, where no muscles are stated.
    pub fn left_out(&self, scene: &Scene) -> Option<Warning> {
        if self.muscles.is_some() || self.response_order() == ResponseOrder::Second {
            return None;
        }
        let stiff: Vec<&String> =
            scene.muscles.iter().filter(|own| own.stiffens).map(|own| &own.name).collect();
        let (count, names) = (stiff.len(), listed(stiff));
        let detail = format!(
            "muscles whose stiffness grows with their activation have no column, and applied plans cannot activate them: {names}"
        );
        (count > 0).then(|| Warning::new("muscle-not-linear", detail).with("muscles", count as f64))
    }

    fn place_of_muscle(&self, name: &str) -> Pointer {
        let mut names = self.muscles.iter().flatten();
        let place = names.position(|other| other.trim() == name);
        Pointer::root().key("spec").key("muscles").index(place.unwrap_or_default())
    }

    /// The refusal of a scene that has no response.
    pub fn refusal(&self, error: &ResponseError) -> Problem {
        let root = Pointer::root();
        let segments = root.key("spec").key("segments");
        let (at, code) = match error {
            ResponseError::UnknownSegment { name, .. } => {
                let place = self.segments.iter().position(|other| other == name);
                (segments.index(place.unwrap_or_default()), ErrorCode::UnknownSegment)
            }
            ResponseError::SharedNodes { .. } => {
                (root.key("case").key("segments"), ErrorCode::PlanConflict)
            }
            ResponseError::NoSegments | ResponseError::EmptySegment { .. } => {
                (root.key("case").key("segments"), ErrorCode::EmptySelection)
            }
            ResponseError::NothingHeld { .. } => {
                (root.key("case").key("fixed"), ErrorCode::NothingHeld)
            }
            ResponseError::UnknownRegion { name, .. } => {
                let place = self.growth.iter().position(|other| other.trim() == name);
                let at = root.key("spec").key("growth").index(place.unwrap_or_default());
                (at, ErrorCode::UnknownRegion)
            }
            ResponseError::UnknownMuscle { name, .. } => {
                (self.place_of_muscle(name), ErrorCode::UnknownMuscle)
            }
            ResponseError::Stiffens { name } => (self.place_of_muscle(name), ErrorCode::NotLinear),
            ResponseError::NoSecondOrder | ResponseError::NoSecondOrderInside => {
                (root.key("spec").key("order"), ErrorCode::MethodNotAvailable)
            }
            ResponseError::OtherMethod => (root.key("spec").key("method"), ErrorCode::NotLinear),
            ResponseError::Loaded | ResponseError::Prediction(_) => (root, ErrorCode::NotLinear),
        };
        let problem = Problem::at(&at, code, error.to_string());
        match error {
            ResponseError::SharedNodes { count, first } => {
                problem.with("count", *count as u64).with("first_node", *first)
            }
            _ => problem,
        }
    }
}

/// Refuses an order that there is not.
pub fn check_order(order: Option<u8>, spec: &Pointer, faults: &mut Faults) {
    if let Some(order) = order.filter(|order| !(1..=2).contains(order)) {
        let detail = format!("{order} is neither 1 nor 2");
        faults.add(&spec.key("order"), ErrorCode::OutOfRange, detail);
    }
}
