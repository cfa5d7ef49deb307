//! Spec of a study: all combinations of scenes, plans, models, materials and mesh levels against a reference
//! solution; and the criteria of its outcome.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::batch::ItemDocument;
pub use super::reference::{CaseReference, PlanReference, SceneReference};
pub use super::truth::{TruthDocument, TruthMethodName};
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::methods::{ElementName, MethodName};
use crate::schema::plan::document::PlanDocument;
use crate::schema::predict::contact::ContactName;
use crate::schema::predict::document::PredictDocument;
use crate::schema::predict::tolerance::ToleranceDocument;
use crate::schema::wire::canonical;
use crate::schema::wire::fault::Pointer;
use mechanics::study::sweep::Values;

/// `study`, or `batch`: the same report over an explicit list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum StudyKind {
    #[default]
    Study,
    Batch,
}

/// A comparison of methods: every scene with each of its plans, method, material and mesh level. Rows are solved one
/// after the other on one thread, so that their times can be compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: StudyKind,
    /// At least one, except in a batch.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scenes: Vec<SceneReference>,
    /// Of a batch, instead of `scenes`, `plans`, `methods`, `elements`, `materials` and `sweep`: `predict` specs without
    /// `budget`, `outputs`, `keep`, `compare_to`, `tags`, `accept_regions_mm`, `corrected` and `range_mm`, of which each is a row
    /// at each level; `label` is the name of its model in rows. Items of the same case, plan and materials are one scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<PredictDocument>)]
    pub items: Vec<ItemDocument>,
    /// For cases without plans of their own, at least one plan in full; for scenes by name, names of their plans to
    /// use (default: all).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plans: Vec<PlanReference>,
    /// Default: every available method, each in its usual variants, and `auto`, which takes the cheapest model whose
    /// estimated error is accepted (`accept_mm`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<Vec<MethodReference>>, min_items = 1)]
    pub methods: Option<Vec<Value>>,
    /// For methods given by name that have elements, instead of their usual variants.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub elements: Vec<ElementName>,
    /// Each entry overrides the materials of a case, by member; in scenes by name it applies to all regions. At most
    /// one of `materials` and `sweep`; default: those of the scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<BTreeMap<String, MaterialDocument>>)]
    pub materials: Vec<MaterialDocuments>,
    /// All combinations of these values, by region or by tissue of the case's `hounsfield`. `*` is every region and tissue,
    /// whether or not materials name it, but for constants that the sweep has by its name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub sweep: BTreeMap<String, SweepDocument>,
    /// Level n halves every edge n times; from 0 to 4. Forces at nodes stay at those of level 0.
    #[serde(default = "default_levels")]
    #[schema(default = json!([0]), min_items = 1)]
    pub levels: Vec<u32>,
    /// Default: that of the scene; for a case, linear finite elements on halved edges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub truth: Option<TruthDocument>,
    /// Solves of each row, whose median time is reported; fewer once they take 2 s together.
    #[serde(default = "usual_repeats")]
    #[schema(default = 3, minimum = 1, maximum = 20)]
    pub repeats: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub thresholds: Option<ThresholdsDocument>,
    /// An earlier study, by its job: if a row is worse than there, the outcome is `worse`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub baseline: Option<String>,
    #[serde(default)]
    pub tolerances: TolerancesDocument,
    /// Labels of variants that may fail without making the outcome `worse`, beside two of the program's own: the
    /// `mtm jacobi` of `mtm`, included to show its divergence, and the `msm direct` of `msm`, which is slow.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub expected_failures: Vec<String>,
    #[serde(default)]
    pub budget: StudyBudgetDocument,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

fn default_levels() -> Vec<u32> {
    vec![0]
}

fn usual_repeats() -> u32 {
    3
}

/// A method by its name, or with its parameters, as in a `predict` spec.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[serde(untagged)]
pub enum MethodReference {
    Name(MethodName),
    Variant(VariantDocument),
}

/// A model as in a `predict` spec, with the field of its parameters.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct VariantDocument {
    pub method: MethodName,
    /// Its name in rows and charts. Default: the method, and the element if one is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub label: Option<String>,
    /// Of `auto`, as in a `predict` spec.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub accept_mm: Option<f64>,
    pub element: ElementName,
    pub contact: ContactName,
    pub tolerance: ToleranceDocument,
}

/// Values of the constants of a region, and changes of its volume; a constant without a list keeps its value.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepDocument {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub young_modulus_kpa: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub poisson_ratio: Vec<f64>,
    /// As `volume_change` of a plan, which it overrides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub volume_change: Vec<f64>,
}

impl SweepDocument {
    pub fn to_values(&self) -> Values {
        Values {
            young_modulus: self.young_modulus_kpa.clone(),
            poisson_ratio: self.poisson_ratio.clone(),
            volume_change: self.volume_change.clone(),
        }
    }
}

/// Bounds on rows; a row above one makes the outcome `worse`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ThresholdsDocument {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, exclusive_minimum = 0.0)]
    pub mean_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, exclusive_minimum = 0.0)]
    pub p95_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, exclusive_minimum = 0.0)]
    pub wall_s: Option<f64>,
    /// Labels of the variants that they apply to. Default: all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<String>,
}

/// Allowed growth of a row over the same row of the baseline. Beyond rounding and timing jitter: a p95 error is
/// worse from 1e-4 mm more, iterations from 5 more, a time from 20 ms more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TolerancesDocument {
    #[serde(default = "usual_p95_ratio")]
    #[schema(default = 1.05, minimum = 1.0, maximum = 1000.0)]
    pub p95_ratio: f64,
    /// Of solver iterations, whose number is the same on every machine.
    #[serde(default = "usual_iterations_ratio")]
    #[schema(default = 1.5, minimum = 1.0, maximum = 1000.0)]
    pub iterations_ratio: f64,
    /// Of the time, which depends on the machine and its load: without it no time is judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1.0, maximum = 1000.0)]
    pub wall_ratio: Option<f64>,
}

fn usual_p95_ratio() -> f64 {
    1.05
}

fn usual_iterations_ratio() -> f64 {
    1.5
}

impl Default for TolerancesDocument {
    fn default() -> Self {
        TolerancesDocument {
            p95_ratio: usual_p95_ratio(),
            iterations_ratio: usual_iterations_ratio(),
            wall_ratio: None,
        }
    }
}

/// The limits of a study.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyBudgetDocument {
    /// After this time no further row is begun, and the study ends as incomplete with the rows it has; their reference
    /// solutions are still computed. The whole study may take twice this time and 60 s: if it takes longer, the job fails with
    /// `budget-exceeded` and has no rows.
    #[serde(default = "default_wall_s")]
    #[schema(default = 3600.0, exclusive_minimum = 0.0)]
    pub wall_s: f64,
    /// A solve that takes longer is cancelled, and its row fails with `budget-exceeded`, as do those of the scene's later
    /// plans with that variant and level, which are not tried.
    #[serde(default = "default_row_s")]
    #[schema(default = 60.0, exclusive_minimum = 0.0)]
    pub row_s: f64,
    /// Of each row.
    #[serde(default = "default_memory_mb")]
    #[schema(default = 4000.0, minimum = 1.0)]
    pub memory_mb: f64,
}

fn default_wall_s() -> f64 {
    3600.0
}

fn default_row_s() -> f64 {
    60.0
}

fn default_memory_mb() -> f64 {
    4000.0
}

impl Default for StudyBudgetDocument {
    fn default() -> Self {
        StudyBudgetDocument {
            wall_s: default_wall_s(),
            row_s: default_row_s(),
            memory_mb: default_memory_mb(),
        }
    }
}

impl Default for StudyDocument {
    fn default() -> Self {
        StudyDocument {
            kind: StudyKind::Study,
            scenes: Vec::new(),
            plans: Vec::new(),
            methods: None,
            elements: Vec::new(),
            materials: Vec::new(),
            sweep: BTreeMap::new(),
            levels: default_levels(),
            items: Vec::new(),
            truth: None,
            repeats: usual_repeats(),
            thresholds: None,
            baseline: None,
            tolerances: TolerancesDocument::default(),
            expected_failures: Vec::new(),
            budget: StudyBudgetDocument::default(),
            tags: Vec::new(),
        }
    }
}

impl StudyDocument {
    /// The ids of its cases, each once.
    pub fn case_ids(&self) -> Vec<&str> {
        let mut ids = Vec::new();
        for scene in &self.scenes {
            if let SceneReference::Case(reference) = scene
                && !ids.contains(&reference.case.as_str())
            {
                ids.push(reference.case.as_str());
            }
        }
        for item in &self.items {
            if !ids.contains(&item.case.as_str()) {
                ids.push(&item.case);
            }
        }
        ids
    }

    /// The plans in full, with their places in `plans`.
    pub fn plan_documents(&self) -> Vec<(usize, &PlanDocument)> {
        let plans = self.plans.iter().enumerate();
        plans
            .filter_map(|(index, plan)| match plan {
                PlanReference::Plan(document) => Some((index, document.as_ref())),
                PlanReference::Name(_) => None,
            })
            .collect()
    }

    /// The plans of the case at a place in `scenes`, each with its own place.
    pub fn plans_of<'a>(
        &'a self,
        scene: usize,
        reference: &'a CaseReference,
    ) -> Vec<(Pointer, &'a PlanDocument)> {
        let at = Pointer::root().key("spec");
        let own = at.key("scenes").index(scene).key("plans");
        if !reference.plans.is_empty() {
            return reference
                .plans
                .iter()
                .enumerate()
                .map(|(k, plan)| (own.index(k), plan))
                .collect();
        }
        let shared = self.plan_documents().into_iter();
        shared.map(|(index, plan)| (at.key("plans").index(index), plan)).collect()
    }

    /// All plans in full: those of the study, of its cases and of its items.
    pub fn plan_documents_mut(&mut self) -> Vec<&mut PlanDocument> {
        let shared = self.plans.iter_mut().filter_map(|plan| match plan {
            PlanReference::Plan(document) => Some(document.as_mut()),
            PlanReference::Name(_) => None,
        });
        let own = self.scenes.iter_mut().filter_map(|scene| match scene {
            SceneReference::Case(reference) => Some(&mut reference.plans),
            SceneReference::Name(_) => None,
        });
        let of_items = self.items.iter_mut().filter_map(|item| item.plan.as_mut());
        shared.chain(own.flatten()).chain(of_items).collect()
    }

    /// The meshes of its reference, with their places.
    pub fn truth_meshes_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        let at = Pointer::root().key("spec").key("truth");
        let truth = self.truth.iter_mut();
        truth.flat_map(|truth| truth.mesh_references_mut(&at)).collect()
    }

    /// The names of plans of scenes by name, with their places in `plans`.
    pub fn plan_names(&self) -> Vec<(usize, &str)> {
        let plans = self.plans.iter().enumerate();
        plans
            .filter_map(|(index, plan)| match plan {
                PlanReference::Name(name) => Some((index, name.as_str())),
                PlanReference::Plan(_) => None,
            })
            .collect()
    }

    /// Without the rules of the outcome.
    pub fn without_rules(&self) -> StudyDocument {
        StudyDocument {
            thresholds: None,
            baseline: None,
            tolerances: TolerancesDocument::default(),
            expected_failures: Vec::new(),
            ..self.clone()
        }
    }

    /// Everything that determines the report, for the hash of the job: no tags, no ids of cases.
    pub fn content(&self) -> Value {
        let mut plain = self.clone();
        plain.tags.clear();
        for scene in &mut plain.scenes {
            if let SceneReference::Case(reference) = scene {
                reference.case.clear();
            }
        }
        plain.items.iter_mut().for_each(|item| item.case.clear());
        canonical::to_value(&plain)
    }
}
