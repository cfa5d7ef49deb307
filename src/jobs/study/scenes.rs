//! The documents of a study as scenes, variants and references; all faults are reported with their places.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::documents::{Documents, Scenes, StatedHashes, spec_at};
use crate::jobs::failure::JobError;

use crate::jobs::predict::{PredictInput, Prepared};
use crate::schema::ErrorCode;
use crate::schema::case::merged::{PlacedMaterials, in_words, merge_materials};
use crate::schema::methods::{ElementName, MethodName};
use crate::schema::study::document::{CaseReference, SceneReference};
use crate::schema::wire::strict;
use crate::schema::{
    CaseDocument, Faults, MaterialDocuments, PlanDocument, Pointer, PredictDocument, Problem,
};
use mechanics::mesh::ignored::listed;
use mechanics::prediction::MethodKind;
use mechanics::study::scenes::{default_truth, scene_of};
use mechanics::study::sweep::{self, SweepError};
use mechanics::study::{Materials, StudyScene, Variant, methods};

/// Fields of a `predict` spec with another place in a study.
const OF_THE_STUDY: [&str; 10] = [
    "kind",
    "case",
    "plan",
    "plan_id",
    "materials",
    "budget",
    "outputs",
    "keep",
    "compare_to",
    "tags",
];

/// Fields of a `predict` spec not supported in rows, and why.
const NOT_OF_ROWS: [(&str, &str); 4] = [
    ("accept_regions_mm", "rows are judged over the whole skin: state `accept_mm`"),
    ("refine", "a row is the result on the mesh of its level: state `levels`"),
    ("corrected", "a row is the result of a model itself, without a correction of its mesh error"),
    ("range_mm", "a row has no file with colours"),
];

impl Documents<'_> {
    /// The variants of all methods, each with a unique label.
    pub fn variants(&self, faults: &mut Faults) -> Vec<Variant> {
        let at = spec_at().key("methods");
        let mut variants: Vec<Variant> = match &self.spec.methods {
            None => {
                let named = MethodKind::ALL.iter().flat_map(|method| self.named(*method));
                named.chain([methods::auto()]).collect()
            }
            Some(entries) => {
                let entries = entries.iter().enumerate();
                entries
                    .flat_map(|(index, entry)| self.entry(entry, &at.index(index), faults))
                    .collect()
            }
        };
        let labels: Vec<&String> = variants.iter().map(|variant| &variant.label).collect();
        let is_twice = |(index, label): &(usize, &&String)| labels[..*index].contains(*label);
        let twice = labels.iter().enumerate().filter(is_twice).map(|(_, label)| label);
        let twice: BTreeSet<_> = twice.collect();
        if !twice.is_empty() {
            let names = listed(twice);
            let detail = format!("two variants have the same name: {names}; give one a `label`");
            faults.add(&at, ErrorCode::DuplicateName, detail);
        }
        self.bound(&mut variants, faults);
        variants
    }

    /// Gives the variants the memory of the study, and checks the labels that the rules of the outcome name.
    pub(super) fn bound(&self, variants: &mut [Variant], faults: &mut Faults) {
        let memory_mb = self.spec.budget.memory_mb.min(self.limits.slot_memory_mb);
        for variant in variants.iter_mut() {
            variant.settings.memory_mb = memory_mb;
        }
        self.check_labels(variants, faults);
    }

    /// Labels that the rules of the outcome name.
    fn check_labels(&self, variants: &[Variant], faults: &mut Faults) {
        let labels = |label: &str| variants.iter().any(|variant| variant.label == label);
        let known = listed(variants.iter().map(|variant| &variant.label));
        let thresholds = self.spec.thresholds.iter().flat_map(|bounds| &bounds.labels);
        let named = [
            (spec_at().key("thresholds").key("labels"), thresholds.collect::<Vec<_>>()),
            (spec_at().key("expected_failures"), self.spec.expected_failures.iter().collect()),
        ];
        for (place, names) in named {
            for (index, name) in names.into_iter().enumerate().filter(|(_, name)| !labels(name)) {
                let detail = format!("there is no variant {name:?}; there are {known}");
                faults.add(&place.index(index), ErrorCode::UnknownLabel, detail);
            }
        }
    }

    fn entry(&self, entry: &Value, at: &Pointer, faults: &mut Faults) -> Vec<Variant> {
        let parsed = match entry {
            Value::String(_) => {
                strict::from_value::<MethodName>(entry.clone()).map(|method| match method {
                    MethodName::Auto => vec![methods::auto()],
                    MethodName::Named(kind) => self.named(kind),
                })
            }
            entry => self.stated(entry.clone(), at, faults).map(|variant| vec![variant]),
        };
        parsed.unwrap_or_else(|problem| {
            faults.join(problem.moved("", at.as_str()));
            Vec::new()
        })
    }

    /// The variants of a method by its name: the usual ones, or one for each element of the study.
    fn named(&self, method: MethodKind) -> Vec<Variant> {
        let usual = methods::of_method(method);
        let (name, has_elements) = (method.name(), !method.properties().elements.is_empty());
        match (usual.first(), self.spec.elements.as_slice()) {
            (Some(first), elements @ [_, ..]) if has_elements => elements
                .iter()
                .map(|element| {
                    let mut settings = first.settings.clone();
                    settings.element = element.choice();
                    let label = format!("{name} {}", element.name());
                    Variant { label, settings, ..first.clone() }
                })
                .collect(),
            _ => usual,
        }
    }

    /// A variant with its own spec: a `predict` spec without members that belong to the study.
    pub(super) fn stated(
        &self,
        mut entry: Value,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Result<Variant, Problem> {
        let label = entry.as_object_mut().and_then(|members| members.remove("label"));
        for name in OF_THE_STUDY {
            if entry.as_object_mut().is_some_and(|members| members.remove(name).is_some()) {
                let detail = format!(
                    "unknown field `{name}`: it belongs to the study and not to one of its methods"
                );
                faults.add(&at.key(name), ErrorCode::UnknownField, detail);
            }
        }
        for (name, why) in NOT_OF_ROWS {
            if entry.as_object_mut().is_some_and(|members| members.remove(name).is_some()) {
                let detail = format!("unknown field `{name}`: {why}");
                faults.add(&at.key(name), ErrorCode::UnknownField, detail);
            }
        }
        let label = match label {
            None => None,
            Some(Value::String(label)) => {
                faults.check_name(&at.key("label"), &label, self.limits.name_characters as usize);
                Some(label)
            }
            Some(_) => {
                faults.add(&at.key("label"), ErrorCode::WrongType, "a label is a text");
                None
            }
        };
        // Without a word of the method an entry is one of linear finite elements, as it always was.
        let chooses = entry.get("method").is_some() || entry.get("accept_mm").is_some();
        let spec: PredictDocument = strict::from_value(entry)?;
        let mut own = Faults::default();
        let settings = spec.to_settings(self.limits, &mut own);
        spec.check_accepted(&Pointer::root().key("spec"), &mut own);
        if let Err(problem) = own.into_result() {
            faults.join(problem.moved("/spec", at.as_str()));
        }
        let accepted = spec.accepted().filter(|_| chooses);
        let method = match accepted {
            Some(_) => methods::AUTO,
            None => spec.method.chosen().name(),
        };
        let label = label.unwrap_or_else(|| match spec.element == ElementName::default() {
            true => method.to_owned(),
            false => format!("{method} {}", spec.element.name()),
        });
        Ok(Variant { method: method.to_owned(), label, settings, accepted, may_fail: false })
    }

    /// Every scene of the spec.
    pub fn scenes(&self, faults: &mut Faults) -> Result<Scenes, JobError> {
        let mut found = Scenes::default();
        let at = spec_at().key("scenes");
        for (index, reference) in self.spec.scenes.iter().enumerate() {
            match reference {
                SceneReference::Name(name) => found.scenes.extend(self.own_scene(name, faults)),
                SceneReference::Case(reference) => {
                    self.case_scene(index, reference, &mut found)?;
                }
            }
            let names = found.scenes.iter().map(|scene| &scene.name);
            let last = found.scenes.last().map(|scene| scene.name.clone()).unwrap_or_default();
            if names.filter(|name| **name == last).count() > 1 {
                let detail = format!("two scenes have the name {last:?}; give one a `name`");
                faults.add(&at.index(index), ErrorCode::DuplicateName, detail);
            }
        }
        self.check_plan_names(&found.scenes, faults);
        Ok(found)
    }

    fn own_scene(&self, name: &str, faults: &mut Faults) -> Option<StudyScene> {
        let mut scene = scene_of(name)?;
        let wanted = self.spec.plan_names();
        if !wanted.is_empty() {
            let all = listed(scene.plans.iter().map(|(plan, _)| plan));
            scene.plans.retain(|(plan, _)| wanted.iter().any(|(_, wanted)| wanted == plan));
            if scene.plans.is_empty() {
                let detail = format!("scene {name} has none of these plans; it has {all}");
                faults.add(&spec_at().key("plans"), ErrorCode::UnknownPlan, detail);
            }
        }
        if !self.spec.materials.is_empty() {
            scene.materials.clear();
            for (index, document) in self.spec.materials.iter().enumerate() {
                let at = spec_at().key("materials").index(index);
                let given = PlacedMaterials { at, materials: Some(document) };
                let none = PlacedMaterials { at: spec_at(), materials: None };
                let merged = merge_materials(&given, &none, self.limits, faults);
                scene.materials.push(Materials {
                    name: in_words(document),
                    by_region: merged.materials,
                    fibres: merged.fibres,
                    ..Materials::default()
                });
            }
        }
        self.sweep(&mut scene, faults);
        self.truth(&mut scene, faults);
        Some(scene)
    }

    fn check_plan_names(&self, scenes: &[StudyScene], faults: &mut Faults) {
        let named = |wanted: &str| {
            scenes.iter().any(|scene| scene.plans.iter().any(|(plan, _)| plan == wanted))
        };
        for (index, name) in self.spec.plan_names().into_iter().filter(|(_, name)| !named(name)) {
            let known =
                listed(scenes.iter().flat_map(|scene| scene.plans.iter().map(|(plan, _)| plan)));
            let detail = format!("no scene by name has a plan {name:?}; there are: {known}");
            faults.add(&spec_at().key("plans").index(index), ErrorCode::UnknownPlan, detail);
        }
    }

    /// A case with each plan, and with each of the materials.
    fn case_scene(
        &self,
        index: usize,
        reference: &CaseReference,
        found: &mut Scenes,
    ) -> Result<(), JobError> {
        let documents = self.spec.plans_of(index, reference);
        let at = spec_at().key("materials");
        let given = self.spec.materials.iter().enumerate();
        let given: Vec<_> = given.map(|(index, given)| (at.index(index), given)).collect();
        self.placed_scene(reference, &documents, &given, found)
    }

    /// The same with plans and materials with their places.
    pub(super) fn placed_scene(
        &self,
        reference: &CaseReference,
        documents: &[(Pointer, &PlanDocument)],
        given: &[(Pointer, &MaterialDocuments)],
        found: &mut Scenes,
    ) -> Result<(), JobError> {
        let missing = || Problem::at(&spec_at(), ErrorCode::UnknownCase, "there is no such case");
        let case = self.cases.get(&reference.case).ok_or_else(missing)?;
        let of_the_first = given.first().map(|(_, materials)| (*materials).clone());
        let place = |index: usize| given.get(index).map_or_else(spec_at, |(at, _)| at.clone());
        let mut plans = Vec::new();
        let mut first: Option<Prepared> = None;
        for (number, (at, document)) in (1..).zip(documents) {
            let input = input(case, (*document).clone(), of_the_first.clone());
            let prepared = input.prepare(self.sources, self.limits, self.stop);
            let prepared = prepared.map_err(|error| self.moved(error, reference, [at, &place(0)]));
            let Some(prepared) = found.found(prepared)? else { continue };
            plans.push((format!("plan {number}"), prepared.plan.clone()));
            first = first.or(Some(prepared));
        }
        let Some(first) = first else { return Ok(()) };
        let mut materials = vec![Materials {
            name: of_the_first.as_ref().map_or_else(|| "case".to_owned(), in_words),
            by_region: first.case.materials.clone(),
            fibres: first.case.fibres.clone(),
            ..Materials::default()
        }];
        for (place, document) in given.iter().skip(1) {
            let Some((at, plan)) = documents.first() else { break };
            let input = input(case, (*plan).clone(), Some((*document).clone()));
            let prepared = input.prepare(self.sources, self.limits, self.stop);
            let prepared = prepared.map_err(|error| self.moved(error, reference, [at, place]));
            let Some(Prepared { case, .. }) = found.found(prepared)? else { continue };
            materials.push(Materials {
                name: in_words(document),
                by_region: case.materials,
                fibres: case.fibres,
                ..Materials::default()
            });
        }
        let name = reference.name.clone().or_else(|| case.name.clone());
        let truth = default_truth(&first.case);
        let mut scene = StudyScene {
            name: name.unwrap_or_else(|| format!("case {}", found.scenes.len() + 1)),
            case: first.case.clone(),
            plans,
            materials,
            truth,
        };
        let mut faults = Faults::default();
        self.sweep(&mut scene, &mut faults);
        self.truth(&mut scene, &mut faults);
        found.found(faults.into_result().map_err(JobError::from))?;
        let stored = self.stored_truth(&mut scene, &first, found);
        found.found(stored)?;
        let stated = StatedHashes::of(case, documents.iter().map(|(_, plan)| *plan), &first);
        found.stated.insert(scene.name.clone(), stated);
        found.series.extend(reference.series.clone().map(|series| (scene.name.clone(), series)));
        found.contents.extend(first.contents.clone());
        found.inputs.extend(first.inputs.iter().cloned());
        found.warnings.extend(first.warnings.iter().cloned());
        found.scenes.push(scene);
        Ok(())
    }

    /// Places of a prediction as places of the study; of several cases the one is named.
    fn moved(
        &self,
        error: JobError,
        reference: &CaseReference,
        [plan, materials]: [&Pointer; 2],
    ) -> JobError {
        let JobError::Refused(problem) = error else { return error };
        let case = match self.cases.len() {
            1 => Pointer::root().key("case"),
            _ => {
                let name = reference.name.as_ref().unwrap_or(&reference.case);
                Pointer::root().key("cases").key(name)
            }
        };
        let problem =
            problem.moved("/plan", plan.as_str()).moved("/spec/materials", materials.as_str());
        JobError::Refused(problem.moved("/case", case.as_str()))
    }

    /// Every combination of the swept values, instead of the materials of the scene.
    fn sweep(&self, scene: &mut StudyScene, faults: &mut Faults) {
        if self.spec.sweep.is_empty() {
            return;
        }
        let swept = self.spec.sweep.iter().map(|(region, of)| (region.clone(), of.to_values()));
        let swept: BTreeMap<String, sweep::Values> = swept.collect();
        let at = spec_at().key("sweep");
        for region in swept.keys().filter(|region| !sweep::has_region(&scene.case, region)) {
            let detail = format!("scene {} has no region or tissue {region:?}", scene.name);
            faults.add(&at.key(region), ErrorCode::UnknownRegion, detail);
        }
        let tissues = scene.case.hounsfield.as_ref().map_or(&[][..], |image| &image.tissues);
        match sweep::combinations(&scene.case.materials, tissues, &swept) {
            Ok(materials) => scene.materials = materials,
            Err(error) => {
                let code = match &error {
                    SweepError::TooMany { .. } => ErrorCode::TooMany,
                    SweepError::UnknownRegion { .. } => ErrorCode::UnknownRegion,
                    SweepError::TwoThings { .. } => ErrorCode::DuplicateName,
                    SweepError::Fibres { .. }
                    | SweepError::Law { .. }
                    | SweepError::TissueGrows { .. } => ErrorCode::MethodNotAvailable,
                    SweepError::Material { .. } | SweepError::VolumeChange { .. } => {
                        ErrorCode::OutOfRange
                    }
                };
                let stated = |own| swept.get_key_value(own).map_or("*", |(own, _)| own);
                let place = error.region().map_or_else(|| at.clone(), |own| at.key(stated(own)));
                faults.add(&place, code, error.to_string());
            }
        }
    }
}

/// One plan and one set of materials on a case.
fn input(
    case: &CaseDocument,
    plan: crate::schema::PlanDocument,
    materials: Option<MaterialDocuments>,
) -> PredictInput {
    let spec = PredictDocument { materials, ..PredictDocument::default() };
    PredictInput { job: None, queue_s: None, case: case.clone(), plan, spec }
}
