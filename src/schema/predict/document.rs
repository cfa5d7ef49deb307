//! The spec of a prediction: what is to be computed, how, and within which budget.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::dvs::DvsDocument;
use super::keep::KeptName;
use super::mass_spring::MassSpringDocument;
use super::mass_tensor::MassTensorDocument;
use super::thickness_warp::ThicknessWarpDocument;
use crate::schema::case::conversion::check_tags;
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::case::membrane::MembraneDocument;
use crate::schema::compare::document::CompareToDocument;
use crate::schema::methods::{self, ElementName, MethodName};
use crate::schema::plan::document::PlanDocument;
use crate::schema::wire::canonical;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::prediction::{Method, Settings};

/// `predict`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum PredictKind {
    #[default]
    Predict,
}

/// A prediction: where the skin goes when a plan is carried out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PredictDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: PredictKind,
    /// The id of the case. In files of the command line the case stands beside the spec.
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
    /// Only with the method `msm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub msm: Option<MassSpringDocument>,
    /// Only with the method `mtm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mtm: Option<MassTensorDocument>,
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
    /// Over the materials of the case, field by field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<BTreeMap<String, MaterialDocument>>)]
    pub materials: Option<MaterialDocuments>,
    /// Absent: the skin is tissue like the rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub membrane: Option<MembraneDocument>,
    #[serde(default)]
    pub contact: ContactName,
    #[serde(default)]
    pub tolerance: ToleranceDocument,
    #[serde(default)]
    pub budget: BudgetDocument,
    /// Default: `skin.vtp` and `skin.glb`; `result.json` is always written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub outputs: Option<Vec<OutputName>>,
    /// Meshes of the result that are stored as if they had been uploaded. Default: none. Not on the command line.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep: Vec<KeptName>,
    /// Compares the predicted skin with another surface in the same job.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub compare_to: Option<CompareToDocument>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// What happens at the sliding sets of the case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ContactName {
    /// Held across, free along.
    #[default]
    Sliding,
    /// Free.
    None,
}

/// How exactly the equations are solved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ToleranceDocument {
    /// |f - K u| / |f_D| of the free rows; in [1e-14, 1e-2]. With pressures, those of both equations,
    /// a volume that is left over counted as the forces that its pressure would put on the nodes.
    #[serde(default = "usual_residual")]
    #[schema(default = 1e-8, minimum = 1e-14, maximum = 1e-2)]
    pub relative_residual: f64,
}

fn usual_residual() -> f64 {
    1e-8
}

impl Default for ToleranceDocument {
    fn default() -> Self {
        ToleranceDocument { relative_residual: usual_residual() }
    }
}

/// What a job may take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BudgetDocument {
    #[serde(default = "usual_wall")]
    #[schema(default = 600.0, exclusive_minimum = 0.0)]
    pub wall_s: f64,
    #[serde(default = "usual_memory")]
    #[schema(default = 4000.0, minimum = 1.0)]
    pub memory_mb: f64,
}

fn usual_wall() -> f64 {
    600.0
}

fn usual_memory() -> f64 {
    4000.0
}

impl Default for BudgetDocument {
    fn default() -> Self {
        BudgetDocument { wall_s: usual_wall(), memory_mb: usual_memory() }
    }
}

/// A file of a result.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema,
)]
pub enum OutputName {
    #[serde(rename = "skin.vtp")]
    SkinVtp,
    #[serde(rename = "skin.stl")]
    SkinStl,
    #[serde(rename = "skin.ply")]
    SkinPly,
    #[serde(rename = "skin.glb")]
    SkinGlb,
    #[serde(rename = "skin.csv")]
    SkinCsv,
    #[serde(rename = "volume.vtu")]
    VolumeVtu,
    #[serde(rename = "bones.vtp")]
    BonesVtp,
    #[serde(rename = "classes.svg")]
    ClassesSvg,
    #[serde(rename = "displacement.svg")]
    DisplacementSvg,
    #[serde(rename = "result.json")]
    ResultJson,
}

impl OutputName {
    pub fn file_name(self) -> &'static str {
        match self {
            OutputName::SkinVtp => "skin.vtp",
            OutputName::SkinStl => "skin.stl",
            OutputName::SkinPly => "skin.ply",
            OutputName::SkinGlb => "skin.glb",
            OutputName::SkinCsv => "skin.csv",
            OutputName::VolumeVtu => "volume.vtu",
            OutputName::BonesVtp => "bones.vtp",
            OutputName::ClassesSvg => "classes.svg",
            OutputName::DisplacementSvg => "displacement.svg",
            OutputName::ResultJson => "result.json",
        }
    }

    pub fn media_type(self) -> &'static str {
        match self {
            OutputName::SkinVtp | OutputName::VolumeVtu | OutputName::BonesVtp => {
                "application/vnd.vtk.xml"
            }
            OutputName::SkinStl => "model/stl",
            OutputName::SkinPly => "application/vnd.ply",
            OutputName::SkinGlb => "model/gltf-binary",
            OutputName::SkinCsv => "text/csv; charset=utf-8",
            OutputName::ClassesSvg | OutputName::DisplacementSvg => "image/svg+xml",
            OutputName::ResultJson => "application/json",
        }
    }
}

impl PredictDocument {
    /// What only a spec that arrives over HTTP must have: the case by id and one plan.
    pub fn check_for_service(&self, faults: &mut Faults) {
        let root = Pointer::root();
        if self.case.is_none() {
            faults.add(&root.key("case"), "missing-field", "missing field `case`");
        }
        let given = usize::from(self.plan.is_some()) + usize::from(self.plan_id.is_some());
        faults.check_one_of(&root, given, "`plan`, `plan_id`");
    }

    /// The settings of the path; pointers start at `/spec`.
    pub fn to_settings(&self, limits: &Limits, faults: &mut Faults) -> Settings {
        let at = Pointer::root().key("spec");
        methods::check_method(self.method, &at.key("method"), faults);
        let residual = self.tolerance.relative_residual;
        let place = at.key("tolerance").key("relative_residual");
        faults.check_range(&place, residual, 1e-14..=1e-2, "");
        let budget = at.key("budget");
        faults.check_range(&budget.key("wall_s"), self.budget.wall_s, 1e-3..=limits.wall_s, "s");
        let memory = self.budget.memory_mb;
        faults.check_range(&budget.key("memory_mb"), memory, 1.0..=limits.memory_mb, "MB");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        if let Some(compare_to) = &self.compare_to {
            compare_to.check(&at.key("compare_to"), limits, faults);
        }
        let membrane = self.membrane.as_ref();
        let membrane = membrane.and_then(|sheet| sheet.to_membrane(&at.key("membrane"), faults));
        Settings {
            method: self.to_method(&at, faults),
            element: self.element.choice(),
            sliding: self.contact == ContactName::Sliding,
            relative_residual: residual,
            memory_mb: memory.min(limits.slot_memory_mb),
            membrane,
        }
    }

    /// The method with its own settings; those of another one are refused.
    fn to_method(&self, at: &Pointer, faults: &mut Faults) -> Method {
        let own = [
            (MethodName::Msm, self.msm.is_some()),
            (MethodName::Mtm, self.mtm.is_some()),
            (MethodName::Dvs, self.dvs.is_some()),
            (MethodName::ThicknessWarp, self.thickness_warp.is_some()),
        ];
        for (name, is_given) in own {
            methods::check_own(name, is_given, self.method, at, faults);
        }
        match self.method.chosen() {
            MethodName::Msm => {
                let own = self.msm.unwrap_or_default();
                Method::MassSpring(own.to_settings(&at.key("msm"), faults))
            }
            MethodName::Mtm => {
                let own = self.mtm.unwrap_or_default();
                Method::MassTensor(own.to_settings(&at.key("mtm"), faults))
            }
            MethodName::MtmTi => Method::MassTensorTransverse,
            MethodName::Dvs => {
                let own = self.dvs.unwrap_or_default();
                Method::VolumeSpline(own.to_method(&at.key("dvs"), faults))
            }
            MethodName::ThicknessWarp => {
                let own = self.thickness_warp.unwrap_or_default();
                Method::ThicknessWarp(own.to_method(&at.key("thickness_warp"), faults))
            }
            _ => Method::FemLinear,
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

    /// The meshes to keep, each once.
    pub fn kept(&self) -> Vec<KeptName> {
        let mut kept = self.keep.clone();
        kept.sort_unstable();
        kept.dedup();
        kept
    }

    /// What decides the numbers, for the hash of the job: no tags, no ids, the plan in full.
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
