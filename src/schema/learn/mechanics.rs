//! What decides the mechanics of a prediction, so that a model corrects answers of the kind that it was learned from.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::schema::case::document::{CaseDocument, LengthUnit};
use crate::schema::case::hounsfield::HounsfieldDocument;
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::case::membrane::MembraneDocument;
use crate::schema::case::merged::expanded_materials;
use crate::schema::predict::contact::ContactName;
use crate::schema::predict::document::PredictDocument;
use crate::schema::wire::canonical::to_value;
use mechanics::material::LinearElastic;
use mechanics::mesh::Warning;
use mechanics::prediction::{Load, NodeClass, Plan, Scene};

/// Held nodes of a case may differ by this share from those of one that was learned from.
const OTHER_NODES: f64 = 0.02;

/// Of one prediction, as its case, plan and spec have it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MechanicsDocument {
    /// The choice, and the elements that came of it.
    pub element: String,
    pub elements: Vec<String>,
    pub contact: ContactName,
    /// Whether what the mesh leaves out is added.
    pub corrected: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub membrane: Option<MembraneDocument>,
    /// The settings of methods, with their defaults.
    pub methods: Value,
    /// As stated by case and spec, with those of an image.
    pub materials: MaterialDocuments,
    /// Kinds of what acts beside segments.
    pub loads: BTreeSet<String>,
    /// Nodes that are fixed, sliding or prescribed, ascending.
    pub held: BTreeMap<String, Vec<u32>>,
}

impl MechanicsDocument {
    pub fn new(case: &CaseDocument, spec: &PredictDocument, plan: &Plan, scene: &Scene) -> Self {
        let mut materials = expanded_materials(case.materials.as_ref(), spec.materials.as_ref());
        let of_image = case.hounsfield.as_ref().map(HounsfieldDocument::expanded);
        let of_image = of_image.unwrap_or_default().into_iter();
        materials.extend(of_image.map(|(name, own)| (format!("{name} of the image"), own)));
        MechanicsDocument {
            element: scene.element.name().to_owned(),
            elements: scene.elements(),
            contact: spec.contact,
            corrected: spec.corrected,
            membrane: spec.membrane.clone(),
            methods: json!({
                "msm": spec.msm.unwrap_or_default(),
                "mtm": spec.mtm.unwrap_or_default(),
                "mtm_ti": spec.mtm_ti.unwrap_or_default(),
                "dvs": spec.dvs.unwrap_or_default(),
                "thickness_warp": spec.thickness_warp.unwrap_or_default(),
            }),
            materials,
            loads: loads(plan),
            held: held(scene),
        }
    }

    /// Of virtual patients, who are predicted by usual linear elements of the tissue that models suppose.
    pub fn of_virtual(scene: &Scene, supposed: &BTreeMap<String, LinearElastic>) -> Self {
        let case = CaseDocument::of_volume("", LengthUnit::Mm);
        let own =
            MechanicsDocument::new(&case, &PredictDocument::default(), &Plan::default(), scene);
        let material = |tissue: &LinearElastic| MaterialDocument {
            young_modulus_kpa: Some(tissue.young_modulus()),
            poisson_ratio: Some(tissue.poisson_ratio()),
            ..MaterialDocument::default()
        };
        let materials = supposed.iter().map(|(name, own)| (name.clone(), material(own)));
        MechanicsDocument { materials: materials.collect(), ..own }
    }

    /// In what predictions are of another kind than those of `other`, whose errors are then others: the setting, that of these, and
    /// that of the other.
    pub fn conflict(&self, other: &Self) -> Option<[String; 3]> {
        let told = |what: &str, [own, other]: [String; 2]| [what.to_owned(), own, other];
        let both = [self, other];
        // The same choice makes others of other constants, which is told as such.
        if self.elements != other.elements && self.element != other.element {
            let elements = |own: &Self| format!("{} ({})", own.element, own.elements.join(", "));
            return Some(told("element", both.map(elements)));
        }
        if self.contact != other.contact {
            return Some(told("contact", both.map(|own| word(&to_value(&own.contact)))));
        }
        if self.corrected != other.corrected {
            return Some(told("corrected", both.map(|own| own.corrected.to_string())));
        }
        if self.membrane.is_some() != other.membrane.is_some() {
            let stated = |own: &Self| if own.membrane.is_some() { "stated" } else { "absent" };
            return Some(told("membrane", both.map(|own| stated(own).to_owned())));
        }
        let methods = self.methods.as_object()?.iter();
        let mut differing = methods.filter(|(name, own)| other.methods.get(name) != Some(own));
        let (name, own) = differing.next()?;
        let of_other = other.methods.get(name).unwrap_or(&Value::Null);
        Some(told(name, [own, of_other].map(word)))
    }

    /// What differs from all that was learned from, so that mechanics may miss something else.
    pub fn unlike(&self, learned: &[&Self]) -> Vec<Warning> {
        let mut differing = Vec::new();
        if is_new(learned, &|own| to_value(&own.materials), &to_value(&self.materials)) {
            differing.push(self.other_materials(learned));
        }
        if is_new(learned, &|own| to_value(&own.membrane), &to_value(&self.membrane)) {
            differing.push("the membrane has other constants".to_owned());
        }
        if learned.iter().all(|own| own.loads != self.loads) {
            let listed = |loads: &BTreeSet<String>| match loads.is_empty() {
                true => "nothing".to_owned(),
                false => loads.iter().cloned().collect::<Vec<_>>().join(", "),
            };
            let of_first = learned.first().map(|own| listed(&own.loads)).unwrap_or_default();
            differing.push(format!(
                "beside segments the plan has {}, that of the first case {of_first}",
                listed(&self.loads)
            ));
        }
        let mut warnings: Vec<Warning> = differing.iter().map(|what| otherwise(what)).collect();
        let least = learned.iter().map(|own| self.other_nodes(own)).min_by(f64::total_cmp);
        if let Some(share) = least.filter(|share| *share > OTHER_NODES) {
            let percent = 100.0 * share;
            let what = format!(
                "of the nodes that are fixed, sliding or prescribed here or there, {percent:.1} % at least are held otherwise"
            );
            warnings.push(otherwise(&what).with("share", share));
        }
        warnings
    }

    fn other_materials(&self, learned: &[&Self]) -> String {
        let first = learned.first().map(|own| &own.materials);
        let names = self.materials.keys().chain(first.into_iter().flat_map(|own| own.keys()));
        let of = |own: Option<&MaterialDocuments>, name: &String| {
            own.and_then(|own| own.get(name)).map_or("none".to_owned(), |own| word(&to_value(own)))
        };
        let differing = names
            .map(|name| (name, of(Some(&self.materials), name), of(first, name)))
            .find(|(_, own, other)| own != other);
        match differing {
            Some((name, own, other)) => {
                format!("the material `{name}` is {own}, and {other} in the first case")
            }
            None => "no case has these materials".to_owned(),
        }
    }

    /// The share of nodes held here or there that are not held in the same way in both.
    fn other_nodes(&self, other: &Self) -> f64 {
        let all = |own: &Self| -> BTreeSet<(String, u32)> {
            let named = own.held.iter();
            named.flat_map(|(name, nodes)| nodes.iter().map(|&n| (name.clone(), n))).collect()
        };
        let (own, other) = (all(self), all(other));
        let either = own.union(&other).count();
        own.symmetric_difference(&other).count() as f64 / either.max(1) as f64
    }
}

/// Whether none of some cases has a value, unless each of several has one of its own.
fn is_new(
    learned: &[&MechanicsDocument],
    of: &dyn Fn(&MechanicsDocument) -> Value,
    own: &Value,
) -> bool {
    let known: Vec<Value> = learned.iter().map(|own| of(own)).collect();
    let is_repeated = |(place, value): (usize, &Value)| known[..place].contains(value);
    let are_shared = known.len() < 2 || known.iter().enumerate().any(is_repeated);
    are_shared && !known.contains(own)
}

fn otherwise(what: &str) -> Warning {
    let detail = format!(
        "{what}: no case that the model was learned from is like that, and mechanics may miss something else here; learn from such cases"
    );
    Warning::new("learned-otherwise", detail)
}

fn word(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn loads(plan: &Plan) -> BTreeSet<String> {
    let kind = |load: &Load| match load {
        Load::Force { .. } => "force",
        Load::Traction { .. } => "traction",
        Load::Pressure { .. } => "pressure",
        Load::Gravity { .. } => "gravity",
    };
    let others = [
        ("growth", plan.grows()),
        ("muscle pull", plan.activations.iter().any(|own| own.stress != 0.0)),
        ("prescribed displacements", !plan.prescribed.is_empty()),
    ];
    let others = others.into_iter().filter(|(_, is)| *is).map(|(name, _)| name);
    plan.loads.iter().map(kind).chain(others).map(str::to_owned).collect()
}

fn held(scene: &Scene) -> BTreeMap<String, Vec<u32>> {
    let mut held: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for (node, class) in (0_u32..).zip(&scene.conditions.classes) {
        match class {
            NodeClass::Fixed | NodeClass::Sliding | NodeClass::Prescribed => {
                held.entry(class.name().to_owned()).or_default().push(node);
            }
            NodeClass::Joined(_) | NodeClass::Free => {}
        }
    }
    held
}
