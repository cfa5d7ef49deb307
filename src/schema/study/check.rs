//! Checks of the spec of a study, before any scene is made.

use std::collections::BTreeSet;

use super::batch::ItemDocument;
use super::document::{CaseReference, SceneReference, StudyDocument, StudyKind};

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use mechanics::study::scenes::SCENES;

/// Each further level multiplies the cells by eight.
const MOST_LEVEL: u32 = 4;
const MOST_REPEATS: u32 = 20;
const MOST_SWEPT_VALUES: usize = 100;

impl StudyDocument {
    /// Adds its faults, except those that need scenes, methods and meshes; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        match self.kind {
            StudyKind::Study => self.check_scenes(&at, limits, faults),
            StudyKind::Batch => self.check_items(&at, faults),
        }
        let entries = limits.list_entries as usize;
        let lists = [
            ("items", self.items.len()),
            ("plans", self.plans.len()),
            ("methods", self.methods.as_ref().map_or(0, Vec::len)),
            ("elements", self.elements.len()),
            ("materials", self.materials.len()),
            ("sweep", self.sweep.len()),
            ("expected_failures", self.expected_failures.len()),
        ];
        for (name, length) in lists {
            faults.check_length(&at.key(name), length, entries);
        }
        if self.methods.as_ref().is_some_and(Vec::is_empty) {
            faults.add(
                &at.key("methods"),
                ErrorCode::MissingField,
                "at least one method is needed",
            );
        }
        if !self.materials.is_empty() && !self.sweep.is_empty() {
            faults.check_one_of(&at, 2, "`materials`, `sweep`");
        }
        self.check_levels(&at, faults);
        self.check_truth(&at.key("truth"), limits, faults);
        let repeats = f64::from(self.repeats);
        faults.check_range(&at.key("repeats"), repeats, 1.0..=f64::from(MOST_REPEATS), "");
        self.check_sweep(&at.key("sweep"), faults);
        self.check_gate(&at, limits, faults);
        check_tags(&self.tags, &at.key("tags"), limits, faults);
    }

    /// A batch has all in its items.
    fn check_items(&self, at: &Pointer, faults: &mut Faults) {
        if self.items.is_empty() {
            faults.add(&at.key("items"), ErrorCode::MissingField, "at least one item is needed");
        }
        let elsewhere = [
            ("scenes", self.scenes.is_empty()),
            ("plans", self.plans.is_empty()),
            ("methods", self.methods.is_none()),
            ("elements", self.elements.is_empty()),
            ("materials", self.materials.is_empty()),
            ("sweep", self.sweep.is_empty()),
        ];
        for (name, _) in elsewhere.into_iter().filter(|(_, is_absent)| !is_absent) {
            let detail = format!("a batch has `items`, and `{name}` belongs to a study");
            faults.add(&at.key(name), ErrorCode::UnknownField, detail);
        }
    }

    fn check_scenes(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let scenes = at.key("scenes");
        if !self.items.is_empty() {
            let detail = "a study has `scenes`, and `items` belong to a batch";
            faults.add(&at.key("items"), ErrorCode::UnknownField, detail);
        }
        if self.scenes.is_empty() {
            faults.add(&scenes, ErrorCode::MissingField, "at least one scene is needed");
        }
        faults.check_length(&scenes, self.scenes.len(), limits.list_entries as usize);
        for (index, scene) in self.scenes.iter().enumerate() {
            let place = scenes.index(index);
            if self.scenes[..index].contains(scene) {
                faults.add(&place, ErrorCode::DuplicateName, "the scene is named more than once");
            }
            match scene {
                SceneReference::Name(name) if !SCENES.contains(&name.as_str()) => {
                    let detail = format!("there is no scene {name:?}; {}", SCENES.join(", "));
                    faults.add(&place, ErrorCode::UnknownScene, detail);
                }
                SceneReference::Case(reference) => reference.check(&place, limits, faults),
                SceneReference::Name(_) => {}
            }
        }
        let lacks_plans = |scene: &SceneReference| matches!(scene, SceneReference::Case(reference) if reference.plans.is_empty());
        let (is_wanted, shared) = (self.scenes.iter().any(lacks_plans), self.plan_documents());
        if is_wanted && shared.is_empty() {
            let detail = "cases need at least one plan in full";
            faults.add(&at.key("plans"), ErrorCode::MissingField, detail);
        }
        if let (false, Some((index, _))) = (is_wanted, shared.first()) {
            let has_cases =
                self.scenes.iter().any(|scene| matches!(scene, SceneReference::Case(_)));
            let detail = match has_cases {
                true => {
                    "no case is left for this plan: every case of `scenes` states `plans` of its own"
                }
                false => {
                    "no scene is a case for this plan: scenes by name have their own plans, which are selected \
                     by name"
                }
            };
            faults.add(&at.key("plans").index(*index), ErrorCode::WrongType, detail);
        }
    }

    fn check_levels(&self, at: &Pointer, faults: &mut Faults) {
        let levels = at.key("levels");
        if self.levels.is_empty() {
            faults.add(&levels, ErrorCode::MissingField, "at least one level is needed");
        }
        let mut seen = BTreeSet::new();
        for (index, &level) in self.levels.iter().enumerate() {
            let place = levels.index(index);
            faults.check_range(&place, f64::from(level), 0.0..=f64::from(MOST_LEVEL), "");
            if !seen.insert(level) {
                faults.add(
                    &place,
                    ErrorCode::DuplicateName,
                    format!("level {level} is named twice"),
                );
            }
        }
    }

    fn check_truth(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let Some(truth) = &self.truth else { return };
        truth.check(at, limits, faults);
        let one_plan = match self.scenes.as_slice() {
            [SceneReference::Case(reference)] => self.plans_of(0, reference).len() == 1,
            _ => self.items.len() == 1,
        };
        let one_row = one_plan && self.materials.len() <= 1 && self.sweep.is_empty();
        if truth.job.is_some() && !one_row {
            let detail =
                "the skin of a job is the truth of one case with one plan and one material";
            faults.add(&at.key("job"), ErrorCode::WrongType, detail);
        }
        if truth.mesh.is_some() && !(one_plan || self.is_of_one_plan() || self.is_one_series()) {
            let detail = "a mesh is the outcome of one plan of one case";
            faults.add(&at.key("mesh"), ErrorCode::WrongType, detail);
        }
    }

    /// Whether all scenes are meshes of one face with one plan.
    fn is_one_series(&self) -> bool {
        let series = |scene: &SceneReference| match scene {
            SceneReference::Case(reference) => reference.series.clone(),
            SceneReference::Name(_) => None,
        };
        let first = self.scenes.first().and_then(series);
        let has_one_plan = self.scenes.iter().enumerate().all(|(index, scene)| match scene {
            SceneReference::Case(reference) => self.plans_of(index, reference).len() == 1,
            SceneReference::Name(_) => false,
        });
        first.is_some() && has_one_plan && self.scenes.iter().all(|scene| series(scene) == first)
    }

    /// Whether all items of a batch are about the same case and plan.
    fn is_of_one_plan(&self) -> bool {
        let of = |item: &ItemDocument| (item.case.clone(), item.plan.clone(), item.plan_id.clone());
        let mut items = self.items.iter().map(of);
        items.next().is_some_and(|first| items.all(|other| other == first))
    }

    fn check_sweep(&self, at: &Pointer, faults: &mut Faults) {
        for (region, values) in &self.sweep {
            let lists = [
                ("young_modulus_kpa", &values.young_modulus_kpa),
                ("poisson_ratio", &values.poisson_ratio),
                ("volume_change", &values.volume_change),
            ];
            if lists.iter().all(|(_, list)| list.is_empty()) {
                let detail = "at least one of `young_modulus_kpa`, `poisson_ratio` and `volume_change` has values";
                faults.add(&at.key(region), ErrorCode::MissingField, detail);
            }
            for (name, list) in lists {
                let place = at.key(region).key(name);
                faults.check_length(&place, list.len(), MOST_SWEPT_VALUES);
                for (index, value) in list.iter().enumerate() {
                    if list[..index].contains(value) {
                        let detail = format!("{value} is swept twice");
                        faults.add(&place.index(index), ErrorCode::DuplicateName, detail);
                    }
                }
            }
        }
    }

    /// Checks of outcome rules and budget.
    fn check_gate(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        if let Some(thresholds) = &self.thresholds {
            let place = at.key("thresholds");
            let bounds = [
                ("mean_mm", thresholds.mean_mm),
                ("p95_mm", thresholds.p95_mm),
                ("wall_s", thresholds.wall_s),
            ];
            for (name, bound) in bounds {
                if let Some(bound) = bound {
                    faults.check_range(&place.key(name), bound, 1e-9..=1e9, "");
                }
            }
            if bounds.iter().all(|(_, bound)| bound.is_none()) {
                let detail = "at least one of `mean_mm`, `p95_mm` and `wall_s` is given";
                faults.add(&place, ErrorCode::MissingField, detail);
            }
            faults.check_length(
                &place.key("labels"),
                thresholds.labels.len(),
                limits.list_entries as usize,
            );
        }
        let tolerances = at.key("tolerances");
        let ratios = [
            ("p95_ratio", Some(self.tolerances.p95_ratio)),
            ("iterations_ratio", Some(self.tolerances.iterations_ratio)),
            ("wall_ratio", self.tolerances.wall_ratio),
        ];
        for (name, ratio) in ratios.into_iter().filter_map(|(name, of)| Some((name, of?))) {
            faults.check_range(&tolerances.key(name), ratio, 1.0..=1000.0, "");
        }
        let budget = at.key("budget");
        faults.check_range(&budget.key("wall_s"), self.budget.wall_s, 1e-3..=limits.wall_s, "s");
        faults.check_range(&budget.key("row_s"), self.budget.row_s, 1e-3..=limits.wall_s, "s");
        let memory = self.budget.memory_mb;
        faults.check_range(&budget.key("memory_mb"), memory, 1.0..=limits.memory_mb, "MB");
    }
}

impl CaseReference {
    fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        if let Some(name) = &self.name {
            faults.check_name(&at.key("name"), name, limits.name_characters as usize);
        }
        if let Some(series) = &self.series {
            faults.check_name(&at.key("series"), series, limits.name_characters as usize);
        }
        faults.check_length(&at.key("plans"), self.plans.len(), limits.list_entries as usize);
    }
}
