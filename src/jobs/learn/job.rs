//! The job of learning: a cohort, its validation, and the model of all of it.

use rayon::prelude::*;

use super::chart::learning_chart;
use super::gather::{Gathered, MECHANICAL, gather};
use super::input::LearnInput;
use super::maps::{ERRORS_FILE, error_maps};
use crate::jobs::clock::Observed;
use crate::jobs::cohort::tested_pair;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobOutput, Workplace};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::schema::Faults;
use crate::schema::cohort::result::CohortPairDocument;
use crate::schema::engine::EngineDocument;
use crate::schema::learn::model::{MODEL_FILE, ModelCaseDocument, ModelDocument};
use crate::schema::learn::result::{
    CurveDocument, LearnedColumnDocument, LearningDocument, ValidationDocument, WidthDocument,
};
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::ResultDocument;
use mechanics::learning::curve::learning_curve;
use mechanics::learning::learner::Rule;
use mechanics::learning::validation::{Column, Validated, validate};
use mechanics::learning::{Distance, LearnedModel, Method};
use mechanics::progress::{Phase, Progress};

/// The draw of the cases of a learning curve.
const CURVE_SEED: u64 = 1;

/// Predicts the cases, learns from all but each, and keeps the model of all.
pub fn learn_job(
    input: &LearnInput,
    place: &Workplace,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, input.spec.budget.wall_s);
    let mut faults = Faults::default();
    input.spec.check(place.limits, &mut faults);
    faults.into_result()?;

    // 1. What is predicted and what was measured.
    clock.phase(Phase::Solve);
    let gathered = gather(input, place, &clock).map_err(|error| input.at_its_place(error))?;
    clock.check()?;

    // 2. What is learned, without the case that is predicted.
    clock.phase(Phase::Compare);
    let (method, distance) = (input.spec.method(), input.spec.distance.into());
    let validated = Method::ALL.map(|method| validate(&gathered.cohort, method, distance));
    clock.check()?;
    let model = LearnedModel::new(&gathered.cohort, method, distance);
    let mut found = document(&gathered, &validated, &model, distance)?;
    found.cohort.clone_from(&input.cohort);
    clock.check()?;

    // 3. The model, where it errs, the picture and the manifest.
    clock.phase(Phase::Write);
    let origin = Origin {
        spec_hash: input.spec_hash(),
        inputs: gathered.inputs.clone(),
        frame: gathered.frame,
        queue_s: input.queue_s,
    };
    let mut folder = ResultFolder::open(place.out)?;
    let model = kept(input, &gathered, &found);
    let bytes = serde_json::to_vec(&model)
        .map_err(|error| JobError::NotFinite { what: error.to_string() })?;
    folder.add_file(MODEL_FILE, "application/json", &bytes)?;
    folder.add_file(
        ERRORS_FILE,
        OutputName::SkinVtp.media_type(),
        &error_maps(&gathered, &validated)?,
    )?;
    let chart = learning_chart(&found, gathered.cohort.len());
    folder.add_file("learning.svg", "image/svg+xml", chart.as_bytes())?;
    let warnings = model.warning().iter().map(Into::into).collect();
    let provenance = origin.provenance(&clock);
    let result = ResultDocument {
        learning: Some(found),
        ..ResultDocument::new(input.job.clone(), &folder.files, provenance, warnings)
    };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files, meshes: Vec::new() })
}

fn document(
    gathered: &Gathered,
    validated: &[Validated],
    model: &LearnedModel,
    distance: Distance,
) -> Result<LearningDocument, JobError> {
    let cohort = &gathered.cohort;
    let names: Vec<String> = cohort.cases.iter().map(|case| case.name.clone()).collect();
    let mechanical = mechanical(gathered).map(Column::means).unwrap_or_default();
    let learned = validated.iter().flat_map(|own| [&own.nested, &own.plain]);
    let table = gathered.mechanical.iter().chain(learned);
    let tests: Result<Vec<CohortPairDocument>, JobError> = validated
        .iter()
        .map(|own| tested_pair(MECHANICAL, &mechanical, own.method.name(), &own.nested.means()))
        .collect();
    let curve = |method: &Method| CurveDocument {
        method: method.name().to_owned(),
        points: learning_curve(cohort, *method, distance, CURVE_SEED)
            .iter()
            .map(Into::into)
            .collect(),
    };
    let of = |method: Method| validated.iter().find(|own| own.method == method);
    let mean = mechanical.iter().sum::<f64>() / mechanical.len().max(1) as f64;
    Ok(LearningDocument {
        cohort: None,
        method: model.method.name().to_owned(),
        width: match &model.fitted.rule {
            Rule::Regression(found) => Some(WidthDocument {
                end: found.end.into(),
                width: (found.width.is_finite() && found.width > 0.0).then_some(found.width),
            }),
            Rule::DeformationModel(_) => None,
        },
        helps: of(model.method).is_some_and(|own| own.nested.mean() < mean),
        table: table.map(|column| LearnedColumnDocument::new(column, &names)).collect(),
        tests: tests?,
        validation: validated
            .iter()
            .map(|own| ValidationDocument::new(own, &mechanical, &names))
            .collect(),
        curve: Method::ALL.par_iter().map(curve).collect(),
        thetas: gathered.thetas.iter().map(Into::into).collect(),
    })
}

fn mechanical(gathered: &Gathered) -> Option<&Column> {
    gathered.mechanical.iter().find(|column| column.name == MECHANICAL)
}

fn kept(input: &LearnInput, gathered: &Gathered, found: &LearningDocument) -> ModelDocument {
    let error = |name: &str| {
        let column = found.table.iter().find(|column| column.name == name);
        column.map_or(0.0, |column| column.mean)
    };
    let case = |(index, own): (usize, &mechanics::learning::LearningCase)| {
        let member = input.cases.get(index);
        let actual = gathered.inputs.get(index).map(|input| input.sha256.clone());
        ModelCaseDocument {
            name: own.name.clone(),
            case: member.and_then(|member| member.case.clone()),
            prediction: input.spec.cases.get(index).map(|case| case.prediction.clone()),
            spec_hash: member.and_then(|member| member.spec_hash.clone()),
            actual_sha256: actual,
            features: own.features.blocks.clone(),
            bone: own.bone.clone(),
            predicted: own.predicted.clone(),
            actual: own.actual.clone(),
        }
    };
    ModelDocument {
        engine: EngineDocument::this(),
        spec: input.spec.clone(),
        cohort: input.cohort.clone(),
        cases: gathered.cohort.cases.iter().enumerate().map(case).collect(),
        regions: gathered.cohort.regions.clone(),
        frame: Some(gathered.frame.into()),
        predicted_by: input.predicted_by(),
        helps: found.helps,
        error_mm: error(&found.method),
        mechanical_mm: error(MECHANICAL),
    }
}
