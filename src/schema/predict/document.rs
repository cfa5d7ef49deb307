//! Spec of a prediction: outputs, method and budget.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::correction::CorrectionDocument;
use super::keep::KeptName;
use super::refine::{ACCEPTED_MM, RefineDocument};
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::case::membrane::MembraneDocument;
use crate::schema::code::ErrorCode;
use crate::schema::compare::document::CompareToDocument;
use crate::schema::methods::dvs::DvsDocument;
use crate::schema::methods::fem_nonlinear::FemNonlinearDocument;
use crate::schema::methods::msm::MassSpringDocument;
use crate::schema::methods::mtm::MassTensorDocument;
use crate::schema::methods::thickness_warp::ThicknessWarpDocument;
use crate::schema::methods::{self, ElementName, MethodName, OwnSettings};
use crate::schema::plan::document::PlanDocument;
use crate::schema::wire::canonical;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use mechanics::prediction::{Accepted, ElementChoice, MethodKind, Settings, USUALLY_ACCEPTED_MM};

pub use super::budget::BudgetDocument;
pub use super::contact::ContactName;
pub use super::estimate::EstimateName;
pub use super::output::OutputName;
pub use super::tolerance::ToleranceDocument;

/// The default displacement in mm at the end of the colour scale.
pub const USUAL_RANGE_MM: f64 = 10.0;

/// Valid ranges of colours, in mm.
pub const RANGES_MM: std::ops::RangeInclusive<f64> = 1e-3..=1e3;

/// `predict`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum PredictKind {
    #[default]
    Predict,
}

/// A prediction of the skin under a plan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PredictDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: PredictKind,
    /// The id of the case. In files of the command line the case is next to the spec.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, required)]
    pub case: Option<String>,
    /// Exactly one of `plan` and `plan_id`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub plan: Option<PlanDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub plan_id: Option<String>,
    #[serde(default)]
    pub method: MethodName,
    /// Only with the method `fem_nonlinear`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fem_nonlinear: Option<FemNonlinearDocument>,
    /// Only with the method `msm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub msm: Option<MassSpringDocument>,
    /// Only with the method `mtm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mtm: Option<MassTensorDocument>,
    /// Only with the method `mtm_ti`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mtm_ti: Option<MassTensorDocument>,
    #[serde(default)]
    pub element: ElementName,
    /// Only with the method `dvs`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub dvs: Option<DvsDocument>,
    /// Only with the method `thickness_warp`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub thickness_warp: Option<ThicknessWarpDocument>,
    /// Overrides the materials of the case, by member.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<BTreeMap<String, MaterialDocument>>)]
    pub materials: Option<MaterialDocuments>,
    /// Absent: no membrane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub membrane: Option<MembraneDocument>,
    #[serde(default)]
    pub contact: ContactName,
    #[serde(default)]
    pub tolerance: ToleranceDocument,
    /// The accepted mean error in mm over the moving skin (by more than a tenth of the largest displacement), of mesh
    /// and model as far as they are estimated. Only with the method `auto`, which takes the cheapest model expected to meet it within the time budget. Default: 0.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.001, maximum = 100.0)]
    pub accept_mm: Option<f64>,
    /// Refines the mesh where its estimated error is large. Only with the methods `auto` and `fem_linear`. The result is
    /// given at the nodes of the mesh of the case. Absent: no refinement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub refine: Option<RefineDocument>,
    /// The same over parts of the skin, by the names of `skin_regions` of the case.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub accept_regions_mm: BTreeMap<String, f64>,
    /// Whether the discretisation error of the skin is estimated.
    #[serde(default, skip_serializing_if = "EstimateName::is_default")]
    pub estimate: EstimateName,
    /// Adds the estimated discretisation error to the displacement. Default: false.
    #[serde(default, skip_serializing_if = "is_false")]
    pub corrected: bool,
    /// Adds stress and strain of cells and nodes to `volume.vtu`, required in `outputs`, and stress by region to the
    /// result. Default: false.
    #[serde(default, skip_serializing_if = "is_false")]
    pub stress: bool,
    #[serde(default)]
    pub budget: BudgetDocument,
    /// Default: `skin.vtp` and `skin.glb`, and `bones.vtp` of a case with bones; `result.json` is always written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub outputs: Option<Vec<OutputName>>,
    /// The displacement at the end of the colour scale of `skin.glb` and `skin.ply`, in mm; it begins at 0. Default: 10, for
    /// every plan, so that files can be compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.001, maximum = 1000.0)]
    pub range_mm: Option<f64>,
    /// Meshes of the result to be stored as if uploaded. Default: none. Not on the command line.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep: Vec<KeptName>,
    /// Compares the predicted skin with another surface in the same job.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub compare_to: Option<CompareToDocument>,
    /// Corrects the skin by a model learned from operated cases, in a separate file. Only with the method on whose predictions
    /// the model was learned, and without `accept_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub correction: Option<CorrectionDocument>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

impl PredictDocument {
    /// Required members of a spec over HTTP: the case by id and one plan.
    pub fn check_for_service(&self, faults: &mut Faults) {
        let root = Pointer::root();
        if self.case.is_none() {
            faults.add(&root.key("case"), ErrorCode::MissingField, "missing field `case`");
        }
        let given = usize::from(self.plan.is_some()) + usize::from(self.plan_id.is_some());
        faults.check_one_of(&root, given, "`plan`, `plan_id`");
    }

    /// The settings of the numerics; pointers start at `/spec`.
    pub fn to_settings(&self, limits: &Limits, faults: &mut Faults) -> Settings {
        let at = Pointer::root().key("spec");
        let residual = self.tolerance.relative_residual;
        let place = at.key("tolerance").key("relative_residual");
        faults.check_range(&place, residual, 1e-14..=1e-2, "");
        self.budget.check(&at.key("budget"), limits, faults);
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        faults.check_range(&at.key("range_mm"), self.range_mm(), RANGES_MM, "mm");
        self.check_accepted(&at, faults);
        self.check_stress(&at.key("stress"), faults);
        if let Some(refine) = &self.refine {
            refine.check(&at.key("refine"), limits, faults);
            self.check_refined(&at.key("refine"), faults);
        }
        if let Some(compare_to) = &self.compare_to {
            compare_to.check(&at.key("compare_to"), limits, faults);
        }
        if self.corrected && self.estimate == EstimateName::None {
            let what = "a correction needs an estimated error, and `estimate` is \"none\"";
            faults.add(&at.key("corrected"), ErrorCode::OneOf, what);
        }
        let membrane = self.membrane.as_ref();
        let membrane = membrane.and_then(|sheet| sheet.to_membrane(&at.key("membrane"), faults));
        Settings {
            method: methods::to_method(self.method, &self.own_settings(), &at, faults),
            element: self.element.choice(),
            contact: self.contact.into(),
            relative_residual: residual,
            memory_mb: self.budget.memory_mb.min(limits.slot_memory_mb),
            membrane,
            estimate: self.estimate == EstimateName::Auto,
            corrected: self.corrected,
            states: self.stress,
            advance: self.fem_nonlinear.unwrap_or_default().advance(),
        }
    }

    /// The accepted errors of `auto`; none for other methods, without an estimate, and if the answer is corrected.
    pub fn accepted(&self) -> Option<Accepted> {
        let chooses = self.method == MethodName::Auto
            && self.estimate == EstimateName::Auto
            && !self.corrected;
        chooses.then(|| Accepted {
            skin_mm: self.accept_mm.unwrap_or(USUALLY_ACCEPTED_MM),
            regions_mm: self.accept_regions_mm.clone(),
            ..Accepted::default()
        })
    }

    /// Refuses an element that the method does not have.
    pub fn check_element(&self, faults: &mut Faults) {
        let (asked, method) = (self.element.choice(), self.method.chosen().properties());
        if asked == ElementChoice::Auto || method.elements.contains(&asked) {
            return;
        }
        let others = method.elements.iter().filter(|element| **element != ElementChoice::Auto);
        let others: Vec<String> = others.map(|other| format!("`{}`", other.name())).collect();
        let detail = match others.is_empty() {
            true => {
                format!("{} has no choice of elements, only `auto`", method.title)
            }
            false => format!(
                "{} has no element `{}`: there are `auto` and {}",
                method.title,
                asked.name(),
                others.join(", ")
            ),
        };
        let at = Pointer::root().key("spec").key("element");
        faults.add(&at, ErrorCode::MethodNotAvailable, detail);
    }

    /// Refuses an accepted error that is out of range, or not used.
    pub fn check_accepted(&self, at: &Pointer, faults: &mut Faults) {
        let place = at.key("accept_mm");
        if let Some(accepted) = self.accept_mm {
            faults.check_range(&place, accepted, ACCEPTED_MM, "mm");
        }
        let regions = at.key("accept_regions_mm");
        for (name, accepted) in &self.accept_regions_mm {
            faults.check_range(&regions.key(name), *accepted, ACCEPTED_MM, "mm");
        }
        let place = if self.accept_mm.is_some() { place } else { regions };
        if self.accept_mm.is_none() && self.accept_regions_mm.is_empty() {
            return;
        }
        if self.method != MethodName::Auto {
            let detail = format!(
                "an accepted error chooses the model, and the method is `{}`: omit one of them",
                self.method.name()
            );
            faults.add(&place, ErrorCode::MethodMismatch, detail);
        }
        if self.corrected || self.estimate == EstimateName::None {
            let detail = "a model is chosen by its estimated errors, and corrected if sufficient: omit `corrected` and \
                          `estimate`";
            faults.add(&place, ErrorCode::OneOf, detail);
        }
    }

    fn check_refined(&self, at: &Pointer, faults: &mut Faults) {
        let is_linear = match self.method {
            MethodName::Auto => true,
            MethodName::Named(kind) => kind == MethodKind::FemLinear,
        };
        if !is_linear {
            let name = self.method.name();
            let detail = format!(
                "meshes are refined for `fem_linear` and `auto`, and the method is `{name}`"
            );
            faults.add(at, ErrorCode::MethodMismatch, detail);
        }
        if self.element.choice() == ElementChoice::Quadratic {
            let detail =
                "meshes are refined for elements of first order only: omit `element` or `refine`";
            faults.add(at, ErrorCode::OneOf, detail);
        }
        if self.contact.presses() {
            let detail =
                "meshes are not refined with unilateral contact: omit `contact` or `refine`";
            faults.add(at, ErrorCode::OneOf, detail);
        }
        let chooses = self.accept_mm.is_some() || !self.accept_regions_mm.is_empty();
        if chooses || self.estimate == EstimateName::None {
            let detail = "a mesh is refined by the estimate of its error, and a model chosen for a fixed mesh: omit \
                          `estimate`, and either `accept_mm` and `accept_regions_mm` or `refine`, which has `regions`";
            faults.add(at, ErrorCode::OneOf, detail);
        }
    }

    /// Refines the mesh to another accepted error; stated limits and bounds remain.
    pub fn refine_to(&mut self, accept_mm: f64) {
        let stated = self.refine.take();
        let usual = || RefineDocument::new(accept_mm);
        self.refine = Some(stated.map_or_else(usual, |own| RefineDocument { accept_mm, ..own }));
    }

    /// The displacement at the end of the colour scale, in mm.
    pub fn range_mm(&self) -> f64 {
        self.range_mm.unwrap_or(USUAL_RANGE_MM)
    }

    fn own_settings(&self) -> OwnSettings {
        OwnSettings {
            fem_nonlinear: self.fem_nonlinear,
            msm: self.msm,
            mtm: self.mtm,
            mtm_ti: self.mtm_ti,
            dvs: self.dvs,
            thickness_warp: self.thickness_warp,
        }
    }

    /// The files to write, each once, always with `result.json`.
    pub fn files(&self) -> Vec<OutputName> {
        let usual = [OutputName::SkinVtp, OutputName::SkinGlb];
        let mut files = match &self.outputs {
            Some(outputs) => outputs.clone(),
            None => usual.to_vec(),
        };
        files.push(OutputName::ResultJson);
        files.sort_unstable();
        files.dedup();
        files
    }

    /// The meshes to store, each once.
    pub fn kept(&self) -> Vec<KeptName> {
        let mut kept = self.keep.clone();
        kept.sort_unstable();
        kept.dedup();
        kept
    }

    /// Everything that determines the numbers, for the hash of the job: no tags, no ids, the plan in full.
    pub fn content(&self) -> Value {
        let mut plain = self.clone();
        plain.tags.clear();
        plain.case = None;
        plain.plan = None;
        plain.plan_id = None;
        plain.outputs = Some(self.files());
        plain.keep = self.kept();
        canonical::to_value(&plain)
    }
}

fn is_false(value: &bool) -> bool {
    !value
}
