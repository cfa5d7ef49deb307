//! The items of a batch as the scenes and the variants of a study.

use std::collections::BTreeSet;

use serde_json::Value;

use super::documents::{Documents, Scenes, spec_at};
use crate::jobs::failure::JobError;
use crate::schema::study::batch::ItemDocument;
use crate::schema::study::document::CaseReference;
use crate::schema::wire::canonical;
use crate::schema::{ErrorCode, Faults};
use mechanics::study::Variant;

/// Scenes and variants of a study.
#[derive(Default)]
pub(super) struct StudyItems {
    pub scenes: Scenes,
    pub variants: Vec<Variant>,
    /// Scenes and variants that belong together, by their places; all combinations if there is none.
    pub pairs: BTreeSet<(usize, usize)>,
}

impl Documents<'_> {
    /// A scene for each case with a plan and materials, a variant for each model.
    pub fn items(&self, faults: &mut Faults) -> Result<StudyItems, JobError> {
        let mut parts =
            StudyItems { scenes: Scenes::default(), variants: Vec::new(), pairs: BTreeSet::new() };
        let (mut scenes, mut ways): (Vec<[Value; 3]>, Vec<&Value>) = Default::default();
        for (index, item) in self.spec.items.iter().enumerate() {
            let at = spec_at().key("items").index(index);
            // 1. How.
            let way = ways.iter().position(|way| **way == item.variant);
            let way = match way {
                Some(way) => way,
                None => {
                    let Some(variant) = self.way(item, index, faults) else { continue };
                    let is_taken = parts.variants.iter().any(|other| other.label == variant.label);
                    if is_taken {
                        let detail = format!(
                            "another model has the name {:?}; give one a `label`",
                            variant.label
                        );
                        faults.add(&at.key("label"), ErrorCode::DuplicateName, detail);
                    }
                    ways.push(&item.variant);
                    parts.variants.push(variant);
                    ways.len() - 1
                }
            };
            // 2. What.
            let what = [
                item.case.clone().into(),
                canonical::to_value(&item.plan),
                canonical::to_value(&item.materials),
            ];
            let scene = match scenes.iter().position(|scene| *scene == what) {
                Some(scene) => scene,
                None => {
                    self.add_scene(item, index, &mut parts.scenes)?;
                    scenes.push(what);
                    scenes.len() - 1
                }
            };
            if !parts.pairs.insert((scene, way)) {
                faults.add(&at, ErrorCode::DuplicateName, "the item is in the list already");
            }
        }
        self.bound(&mut parts.variants, faults);
        Ok(parts)
    }

    fn way(&self, item: &ItemDocument, index: usize, faults: &mut Faults) -> Option<Variant> {
        let at = spec_at().key("items").index(index);
        let stated = self.stated(item.variant.clone(), &at, faults);
        stated.map_err(|problem| faults.join(problem.moved("", at.as_str()))).ok()
    }

    fn add_scene(
        &self,
        item: &ItemDocument,
        index: usize,
        found: &mut Scenes,
    ) -> Result<(), JobError> {
        let place = spec_at().key("items").index(index);
        let plan = item.plan.clone().unwrap_or_default();
        let known = self.cases.get(&item.case).and_then(|case| case.name.clone());
        let name = known.unwrap_or_else(|| format!("case {}", index + 1));
        let is_taken = |name: &str| {
            found.scenes.iter().any(|scene: &mechanics::study::StudyScene| scene.name == name)
        };
        let name = match is_taken(&name) {
            true => format!("{name}, item {}", index + 1),
            false => name,
        };
        let reference = CaseReference {
            case: item.case.clone(),
            name: Some(name),
            series: None,
            plans: vec![plan],
        };
        let plans = vec![(place.key("plan"), &reference.plans[0])];
        let materials: Vec<_> =
            item.materials.iter().map(|given| (place.key("materials"), given)).collect();
        self.placed_scene(&reference, &plans, &materials, found)
    }
}
