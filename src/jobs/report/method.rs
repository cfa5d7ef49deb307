//! Method of a prediction in one sentence, and its limits.

use super::content::{Block, Section};
use super::tables::mm;
use super::words::{Words, filled};
use crate::schema::PlanDocument;
use crate::schema::predict::result::ResultDocument;
use mechanics::prediction::{MethodKind, Rung};

/// The model of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Model {
    Linear,
    SecondOrder,
    FiniteStrain,
    /// Another method, by its name.
    Other,
}

fn model(result: &ResultDocument) -> Model {
    let taken = result.provenance.model.as_deref();
    let rung = Rung::ALL.into_iter().find(|rung| Some(rung.name()) == taken);
    match rung.map(Rung::solution) {
        Some(Rung::SecondOrder | Rung::SecondOrderCorrected) => return Model::SecondOrder,
        Some(Rung::FiniteStrain | Rung::FiniteStrainCorrected) => return Model::FiniteStrain,
        Some(Rung::Linear | Rung::Corrected) | None => {}
    }
    match result.provenance.method.as_deref() {
        Some(name) if name == MethodKind::FemLinear.name() => Model::Linear,
        Some(name) if name == MethodKind::FemNonlinear.name() => Model::FiniteStrain,
        Some(_) | None => Model::Other,
    }
}

fn is_corrected(result: &ResultDocument) -> bool {
    result.numerical_error_mm.as_ref().is_some_and(|own| own.corrected)
}

pub fn method(result: &ResultDocument, plan: &PlanDocument, words: &Words) -> Section {
    let provenance = &result.provenance;
    let name = provenance.method.as_deref().unwrap_or("–");
    let way = match model(result) {
        Model::Linear => words.linear,
        Model::SecondOrder => words.second_order,
        Model::FiniteStrain => words.nonlinear,
        Model::Other => words.other_method,
    };
    let mesh = provenance.mesh.as_ref();
    let counts = mesh.map(|mesh| [mesh.nodes.to_string(), mesh.cells.to_string()]);
    let on_mesh = counts.map_or_else(String::new, |counts| filled(words.on_mesh, &counts));
    let why = provenance.why.as_ref().map_or_else(String::new, |why| format!("; {why}"));
    let mut sentences = vec![format!("{way} ({name}{why}), {on_mesh}")];
    let beside = [
        (!plan.growth.is_empty(), words.with_growth),
        (!plan.activations.is_empty(), words.with_muscles),
        (result.contact.is_some(), words.with_contact),
        (result.refinement.is_some(), words.with_refinement),
        (is_corrected(result), words.with_correction),
    ];
    sentences.extend(beside.iter().filter(|(is, _)| *is).map(|(_, told)| (*told).to_owned()));
    Section::new(words.method, vec![Block::Paragraph(sentences.join(" "))])
}

pub fn how_sure(result: &ResultDocument, words: &Words) -> Section {
    let mut sentences = Vec::new();
    let unknown =
        |sentence: &str, why: &Option<String>| why.as_ref().map(|why| format!("{sentence} {why}."));
    match &result.numerical_error_mm {
        Some(own) => sentences.push(filled(words.mesh_error, &[mm(own.mean), mm(own.p95)])),
        None => sentences.extend(unknown(words.mesh_unknown, &result.numerical_error_unknown)),
    }
    let leaves_out = match model(result) {
        Model::Linear | Model::Other => Some(words.model_error),
        Model::SecondOrder => Some(words.second_order_error),
        Model::FiniteStrain => None,
    };
    match (&result.nonlinearity_mm, leaves_out) {
        (Some(own), Some(leaves_out)) => {
            sentences.push(filled(leaves_out, &[mm(own.skin.mean), mm(own.skin.p95)]));
        }
        (None, Some(_)) => {
            sentences.extend(unknown(words.model_unknown, &result.nonlinearity_unknown));
        }
        (Some(_) | None, None) => sentences.push(words.finite_strain_error.to_owned()),
    }
    sentences.push(words.not_clinical.to_owned());
    Section::new(words.how_sure, vec![Block::Paragraph(sentences.join(" "))])
}
