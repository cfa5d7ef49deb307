//! The job of learning: a cohort, its validation, and the model of all of it.

use rayon::prelude::*;

use super::chart::learning_chart;
use super::gather::{Gathered, gather};
use super::input::LearnInput;
use super::maps::{ERRORS_FILE, error_maps};
use super::table::{TABLE_FILE, table_csv};
use crate::jobs::clock::Observed;
use crate::jobs::cohort::tested_pair;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::jobs::result::warnings::warning_documents;
use crate::schema::Faults;
use crate::schema::cohort::result::CohortPairDocument;
use crate::schema::engine::EngineDocument;
use crate::schema::learn::model::{MODEL_FILE, ModelCaseDocument, ModelDocument};
use crate::schema::learn::result::{
    CurveDocument, LearnedColumnDocument, LearningDocument, ValidationDocument, WidthDocument,
};
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::ResultDocument;
use mechanics::learning::cohort::Pool;
use mechanics::learning::curve::learning_curve;
use mechanics::learning::hill_climb::{Climb, hill_climb};
use mechanics::learning::learner::{ComparedCases, Rule};
use mechanics::learning::validation::{Column, Validated, validate};
use mechanics::learning::{Cohort, Distance, LearnedModel, Method};
use mechanics::mesh::Vector;
use mechanics::progress::{Phase, Progress};

/// The draw of the cases of a learning curve.
const CURVE_SEED: u64 = 1;

/// Of a climb that comes to no end.
const MOST_STEPS: usize = 2000;

/// Predicts the cases, learns from all but each, and keeps the model of all.
pub fn learn_job(
    input: &LearnInput,
    place: &JobContext,
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
    let mut folder = ResultFolder::open(place)?;
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
    folder.add_file(TABLE_FILE, OutputName::SkinCsv.media_type(), table_csv(&found).as_bytes())?;
    folder.add_file("learning.svg", "image/svg+xml", chart.as_bytes())?;
    let warnings = warning_documents(model.warning().iter().chain(&gathered.warnings));
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
    let learned = validated.iter().flat_map(|own| {
        let other = own.other_classes.as_ref().map(|other| &other.column);
        [Some(&own.nested), own.plain.as_ref(), other].into_iter().flatten()
    });
    let table = gathered.mechanical.iter().chain(learned);
    let tests: Result<Vec<CohortPairDocument>, JobError> = validated
        .iter()
        .map(|own| {
            tested_pair(&cohort.mechanical, &mechanical, &own.nested.name, &own.nested.means())
        })
        .collect();
    let curves = |pool: Pool| -> Vec<CurveDocument> {
        let curve = |method: &Method| CurveDocument {
            method: method.name(&cohort.mechanical),
            points: learning_curve(cohort, *method, distance, pool, CURVE_SEED)
                .iter()
                .map(Into::into)
                .collect(),
        };
        Method::ALL.par_iter().map(curve).filter(|own| !own.points.is_empty()).collect()
    };
    let of = |method: Method| validated.iter().find(|own| own.method == method);
    let mean = mechanical.iter().sum::<f64>() / mechanical.len().max(1) as f64;
    Ok(LearningDocument {
        cohort: None,
        method: model.method.name(&cohort.mechanical),
        mechanical: cohort.mechanical.clone(),
        width: match &model.fitted.rule {
            Rule::Regression(found) => {
                let climb = climb(cohort, model.method, distance);
                Some(WidthDocument::new(*found, climb))
            }
            Rule::DeformationModel(_) => None,
        },
        patients: cohort.cases.iter().map(Into::into).collect(),
        helps: of(model.method).is_some_and(|own| own.nested.mean() < mean),
        table: table.map(|column| LearnedColumnDocument::new(column, &names)).collect(),
        tests: tests?,
        validation: validated
            .iter()
            .map(|own| ValidationDocument::new(own, &mechanical, &names))
            .collect(),
        curve: curves(Pool::Others),
        curve_of_other_classes: curves(Pool::OtherClasses),
        made: gathered.made.clone(),
        thetas: gathered.thetas.iter().map(Into::into).collect(),
    })
}

/// The search of Zhang et al. 2016 over all cases.
fn climb(cohort: &Cohort, method: Method, distance: Distance) -> Climb {
    let all: Vec<usize> = (0..cohort.len()).collect();
    let left_out = ComparedCases::new(cohort, method.target, distance).leave_one_out(&all);
    hill_climb(|width| left_out.rmse(width), MOST_STEPS)
}

fn mechanical(gathered: &Gathered) -> Option<&Column> {
    gathered.mechanical.iter().find(|column| column.name == gathered.cohort.mechanical)
}

/// Three for each point.
fn numbers(points: &[Vector]) -> Vec<f64> {
    points.iter().flat_map(|own| [own.x, own.y, own.z]).collect()
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
            mechanics: gathered.mechanics.get(index).cloned(),
            at_rest: gathered.at_rest.get(index).map(|own| numbers(own)).unwrap_or_default(),
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
        correspondence: gathered.correspondence.clone(),
        predicted_by: input.predicted_by(),
        helps: found.helps,
        error_mm: error(&found.method),
        mechanical_mm: error(&found.mechanical),
        suspicions: warning_documents(gathered.suspicions().iter()),
    }
}
