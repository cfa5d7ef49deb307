//! Preparation of a study: scenes made, meshes fetched, documents checked.

use std::collections::{BTreeMap, BTreeSet};

use super::batch::StudyItems;
use super::documents::{Documents, Scenes, StatedHashes};
use super::input::StudyInput;
use crate::jobs::failure::JobError;
use crate::jobs::source::MeshSource;
use crate::schema::code::ErrorCode;
use crate::schema::hashes;
use crate::schema::predict::result::InputDocument;
use crate::schema::study::document::StudyKind;
use crate::schema::wire::canonical;
use crate::schema::{CaseDocument, Faults, Limits, Pointer, Problem};
use mechanics::mesh::Warning;
use mechanics::progress::StopQuery;
use mechanics::study::{Study, StudyScene, truth_cost};

/// The code of the warning of a study that names no method.
pub const ALL_METHODS: &str = "all-methods";

/// A study with valid documents.
pub struct PreparedStudy {
    pub study: Study,
    pub spec_hash: String,
    /// The key of its rows.
    pub rows_key: String,
    pub inputs: Vec<InputDocument>,
    /// As in [`Scenes`](super::documents::Scenes).
    pub stated: BTreeMap<String, StatedHashes>,
    pub series: BTreeMap<String, String>,
    pub warnings: Vec<Warning>,
}

impl StudyInput {
    /// Adds what is wrong with the spec itself, whatever its cases are.
    pub fn check_spec(&self, sources: &dyn MeshSource, limits: &Limits, faults: &mut Faults) {
        let stop = StopQuery::never();
        self.spec.check(limits, faults);
        if self.spec.kind == StudyKind::Study {
            self.documents(sources, limits, &stop).variants(faults);
        }
    }

    fn documents<'a>(
        &'a self,
        sources: &'a dyn MeshSource,
        limits: &'a Limits,
        stop: &'a StopQuery,
    ) -> Documents<'a> {
        let StudyInput { spec, cases, truth_method, .. } = self;
        Documents { spec, cases, truth_method: *truth_method, sources, limits, stop }
    }

    /// Makes the scenes, fetches the meshes and checks the documents. Pointers start at `/case` and `/spec`.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<PreparedStudy, JobError> {
        let documents = self.documents(sources, limits, stop);
        let StudyItems { scenes, variants, pairs } = documents.checked()?;
        let study = Study {
            scenes: scenes.scenes,
            variants,
            pairs,
            levels: self.spec.levels.clone(),
            repeats: self.spec.repeats as usize,
            budget_s: self.spec.budget.wall_s,
            row_s: self.spec.budget.row_s,
        };
        let (rows, most) = (most_rows(&study), limits.study_rows as usize);
        if rows > most {
            let detail = format!("the study has {rows} rows, at most {most} are allowed");
            return Err(
                Problem::at(&Pointer::root().key("spec"), ErrorCode::TooMany, detail).into()
            );
        }
        let content = |id: &str| scenes.contents.get(id).cloned();
        let cases: Vec<&CaseDocument> =
            self.spec.case_ids().into_iter().filter_map(|id| self.cases.get(id)).collect();
        let baseline = self.baseline.as_ref().map(canonical::to_value);
        let spec_hash = hashes::study_hash(&cases, &self.spec, baseline.as_ref(), &content);
        let rows_key = hashes::rows_key(&cases, &self.spec, &content);
        let names_none = self.spec.kind == StudyKind::Study && self.spec.methods.is_none();
        let mut warnings = scenes.warnings;
        warnings.extend(names_none.then(|| all_methods(&study)));
        Ok(PreparedStudy {
            study,
            spec_hash,
            rows_key,
            inputs: scenes.inputs,
            stated: scenes.stated,
            series: scenes.series,
            warnings,
        })
    }
}

impl Documents<'_> {
    /// Scenes and variants, where nothing is wrong; all mistakes are told together. Scenes of a spec that is wrong itself are not made.
    fn checked(&self) -> Result<StudyItems, JobError> {
        let mut faults = Faults::default();
        self.spec.check(self.limits, &mut faults);
        let is_sound = faults.is_empty();
        let mut items = match self.spec.kind {
            StudyKind::Study => {
                let variants = self.variants(&mut faults);
                let scenes = match is_sound {
                    true => self.scenes(&mut faults)?,
                    false => Scenes::default(),
                };
                StudyItems { scenes, variants, pairs: BTreeSet::new() }
            }
            StudyKind::Batch if is_sound => self.items(&mut faults)?,
            StudyKind::Batch => StudyItems::default(),
        };
        let mut refused = std::mem::take(&mut items.scenes.refused);
        // A single one has numbers of its own.
        if let ([_], true) = (refused.as_slice(), faults.is_empty()) {
            return Err(refused.remove(0).into());
        }
        refused.into_iter().for_each(|problem| faults.join(problem));
        faults.into_result()?;
        Ok(items)
    }
}

/// Warning of a study without named methods: the most expensive takes minutes, the cheapest a second.
fn all_methods(study: &Study) -> Warning {
    let methods: BTreeSet<&str> =
        study.variants.iter().map(|variant| variant.method.as_str()).collect();
    let (methods, variants, rows) = (methods.len(), study.variants.len(), most_rows(study));
    let detail = format!(
        "no method is named, and all {methods} are solved in {variants} variants, {rows} rows at most: name methods in `methods`, \
         a few of which are much faster"
    );
    let warning = Warning::new(ALL_METHODS, detail).with("variants", variants as f64);
    warning.with("rows", rows as f64)
}

/// The number of reference solutions on a mesh with one set of materials.
pub fn truth_meshes(study: &Study) -> usize {
    let of = |(place, scene): (usize, &StudyScene)| {
        let cost = truth_cost(scene, study.variants_of(place));
        cost.map_or(0, |cost| cost.truths * cost.meshes.len() * scene.materials.len())
    };
    study.scenes.iter().enumerate().map(of).sum()
}

/// The number of rows of a study, including those that are the reference itself.
pub fn most_rows(study: &Study) -> usize {
    let of_scene = |(place, scene): (usize, &StudyScene)| {
        scene.plans.len() * scene.materials.len() * study.variants_of(place).count()
    };
    let on_a_mesh: usize = study.scenes.iter().enumerate().map(of_scene).sum();
    on_a_mesh * study.levels.len()
}
