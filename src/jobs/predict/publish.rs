//! Publication of a prediction: measured, compared and written as files.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::comparison::compare_skin;
use super::correction::{CORRECTED_FILE, Correction, corrected};
use super::density::default_density;
use super::input::{PredictInput, Prepared};
use super::overlap::{Collision, collisions, through_skin};
use super::planned::{in_numbers, suspect_landmarks};
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput, MadeMesh};
use crate::jobs::report::{PredictionFacts, write_reports};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{
    Origin, add_method, encode_result, laws, mesh_summary, presets, rest_on_the_way,
    solver_document,
};
use crate::jobs::result::skin::PredictedSkin;
use crate::jobs::result::stress::stress_by_region;
use crate::jobs::result::tissue::encode_volume;
use crate::jobs::result::warnings::warnings_after;
use crate::jobs::source::StoredShape;
use crate::schema::Triple;
use crate::schema::compare::result::{ComparisonDocument, StatDocument};
use crate::schema::methods::{MethodName, WHY_REFINED};
use crate::schema::optimise::result::OptimisationDocument;
use crate::schema::predict::adequacy::AdequacyDocument;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::keep::KeptName;
use crate::schema::predict::newton::LoadStepDocument;
use crate::schema::predict::nonlinearity::{NonlinearityDocument, skin_lengths};
use crate::schema::predict::refine::RefinementDocument;
use crate::schema::predict::result::{
    DisplacementDocument, ErrorLengthsDocument, FileDocument, NumericalErrorDocument,
    ResultDocument, StatisticsDocument,
};
use crate::schema::predict::stress::StressDocument;
use mechanics::mesh::{Vector, VolumeMesh, Warning};
use mechanics::prediction::{PredictedStep, Prediction, Skin};
use mechanics::progress::{Phase, Progress, StopQuery};
use mechanics::validation::{Statistics, StatisticsError};

/// A prediction to be measured, compared and written.
pub struct Predicted {
    pub prepared: Prepared,
    pub prediction: Prediction,
    /// The inverse planning of its plan, if it was not stated.
    pub optimisation: Option<OptimisationDocument>,
    /// The choice of its model, if an accepted error was stated.
    pub adequacy: Option<AdequacyDocument>,
    /// The refinement of its mesh, if requested.
    pub refinement: Option<RefinementDocument>,
}

impl Predicted {
    /// A prediction with the stated plan, model and mesh.
    pub fn of(prepared: Prepared, prediction: Prediction) -> Self {
        Predicted { prepared, prediction, optimisation: None, adequacy: None, refinement: None }
    }

    pub fn publish(
        self,
        input: &PredictInput,
        clock: &Observed,
        place: &JobContext,
    ) -> Result<JobOutput, JobError> {
        let Predicted { prepared, prediction, optimisation, adequacy, refinement } = self;

        // 1. The displacement of the skin.
        clock.phase(Phase::Surface);
        let mut skin = PredictedSkin::new(&prepared.scene.skin, &prediction);
        skin.range_mm = input.spec.range_mm();
        let mut statistics = statistics(&prepared.scene.skin, &skin, &prediction.landmarks)?;
        let nonlinearity = match &prediction.nonlinearity {
            Ok(known) => {
                skin.nonlinearity = Some(skin_lengths(&prepared.scene.skin, known));
                Ok(NonlinearityDocument::new(&prepared.scene.skin, known)?)
            }
            Err(unknown) => Err(unknown.to_string()),
        };
        let numerical_error = numerical_error(&prepared.scene.skin, &skin, &prediction)?;
        let stress = stress_by_region(&prepared.scene, &prediction)?;
        statistics.imaged = prepared.scene.imaged.as_ref().map(Into::into);
        clock.check()?;

        // 2. Against another surface, if asked.
        clock.phase(Phase::Compare);
        let compared = compare_skin(input, &prepared, &skin, clock)?;
        let mut warnings = warnings_of(input, &prepared, &prediction);
        if let Some(compared) = &compared {
            skin.signed_distance = Some(compared.signed_distance.clone());
            warnings.extend(compared.warnings.iter().cloned());
        }
        clock.check()?;

        // 3. What was learned, if asked.
        let mut correction = None;
        if input.spec.correction.is_some() {
            clock.phase(Phase::Correct);
            correction = corrected(input, &prepared, &prediction)?;
        }
        warnings.extend(correction.iter().flat_map(|own| own.warnings.iter().cloned()));

        // 4. Files.
        clock.phase(Phase::Write);
        let finished = Finished {
            origin: Origin {
                spec_hash: prepared.spec_hash.clone(),
                inputs: prepared.inputs.clone(),
                frame: prepared.case.frame,
                queue_s: input.queue_s,
            },
            prepared: &prepared,
            prediction: &prediction,
            skin: &skin,
            statistics,
            nonlinearity,
            numerical_error,
            stress,
            comparison: compared.map(|compared| compared.document),
            optimisation,
            adequacy,
            refinement,
            correction,
            warnings,
        };
        let mut folder = ResultFolder::open(place)?;
        finished.write_files(input, clock, &mut folder)?;

        // 5. The manifest.
        let result = finished.result(input, clock, &folder.files);
        folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
        let meshes = finished.kept(&input.spec.kept());
        Ok(JobOutput { result, files: folder.files, meshes })
    }
}

/// Warnings on the scene and the result, before any comparison.
fn warnings_of(input: &PredictInput, prepared: &Prepared, prediction: &Prediction) -> Vec<Warning> {
    let (case, scene) = (&prepared.case, &prepared.scene);
    let mut warnings = prepared.warnings.clone();
    warnings.extend(prediction.warnings.iter().cloned());
    let collisions = collisions(case, scene, &StopQuery::never());
    warnings.extend(collisions.iter().filter_map(Collision::warning));
    warnings.extend(through_skin(case, scene, prediction));
    warnings.extend(suspect_landmarks(&input.case, case));
    warnings.extend(default_density(input));
    warnings
}

/// A prediction with the content of its files.
struct Finished<'a> {
    origin: Origin,
    prepared: &'a Prepared,
    prediction: &'a Prediction,
    skin: &'a PredictedSkin,
    statistics: StatisticsDocument,
    /// The linearisation error, or why it is not known.
    nonlinearity: Result<NonlinearityDocument, String>,
    numerical_error: Option<NumericalErrorDocument>,
    stress: Option<StressDocument>,
    comparison: Option<ComparisonDocument>,
    optimisation: Option<OptimisationDocument>,
    adequacy: Option<AdequacyDocument>,
    refinement: Option<RefinementDocument>,
    correction: Option<Correction>,
    warnings: Vec<Warning>,
}

impl Finished<'_> {
    /// The method that was used.
    fn method(&self) -> MethodName {
        MethodName::Named(self.prepared.scene.settings.method.kind())
    }

    /// The model chosen by `auto`.
    fn model(&self) -> Option<&str> {
        self.adequacy.as_ref().map(|adequacy| adequacy.taken.as_str())
    }

    fn kept(&self, wanted: &[KeptName]) -> Vec<MadeMesh> {
        let frame = self.origin.frame;
        let shape = |what: KeptName| match what {
            KeptName::Skin => StoredShape::Surface(Arc::new(self.skin.surface.clone())),
            KeptName::Volume => StoredShape::Volume(Arc::new(self.moved_volume())),
        };
        wanted
            .iter()
            .map(|&what| MadeMesh {
                what: what.into(),
                name: None,
                shape: shape(what),
                frame,
                told: Vec::new(),
            })
            .collect()
    }

    fn moved_volume(&self) -> VolumeMesh {
        let mut moved = (*self.prepared.scene.mesh).clone();
        for (node, displacement) in moved.nodes.iter_mut().zip(&self.prediction.displacement) {
            *node += displacement;
        }
        moved
    }

    fn write_files(
        &self,
        input: &PredictInput,
        clock: &Observed,
        folder: &mut ResultFolder,
    ) -> Result<(), JobError> {
        let solver = solver_document(&self.prediction.solver, &self.prediction.elements);
        let field_data = self.origin.field_data(self.method(), self.model(), &solver);
        let scene = &self.prepared.scene;
        let frame = self.origin.frame;
        let skin = (self.skin, &self.statistics.skin.nodes);
        for name in input.files() {
            let bytes = match name {
                OutputName::VolumeVtu => {
                    Some(encode_volume(scene, self.prediction, frame, &field_data)?)
                }
                other => self.prepared.encode(other, skin, &field_data)?,
            };
            if let Some(bytes) = bytes {
                folder.add(name, &bytes)?;
            }
        }
        let corrected = self.correction.as_ref().and_then(|own| own.skin.as_ref());
        if let Some(bytes) = corrected {
            folder.add_file(CORRECTED_FILE, OutputName::SkinVtp.media_type(), bytes)?;
        }
        let result = self.result(input, clock, &folder.files);
        let facts = PredictionFacts {
            case: &input.case,
            plan: &input.plan,
            scene,
            frame,
            after: &self.skin.surface,
            range_mm: input.spec.range_mm(),
            result: &result,
        };
        write_reports(&input.files(), &facts, folder)
    }

    fn result(
        &self,
        input: &PredictInput,
        clock: &Observed,
        files: &[FileDocument],
    ) -> ResultDocument {
        let mut provenance = self.origin.provenance(clock);
        let solver = solver_document(&self.prediction.solver, &self.prediction.elements);
        let mesh = mesh_summary(&self.prepared.scene.mesh, &self.prepared.quality);
        add_method(&mut provenance, input.spec.method, mesh, solver);
        provenance.plan = Some(input.plan.clone());
        provenance.plan_id = input.spec.plan_id.clone();
        if let Some(adequacy) = &self.adequacy {
            provenance.method = Some(self.method().name().to_owned());
            provenance.model = Some(adequacy.taken.clone());
            provenance.why = Some(adequacy.why());
        } else if self.refinement.is_some() && input.spec.method == MethodName::Auto {
            provenance.why = Some(WHY_REFINED.to_owned());
        }
        provenance.laws = laws(&self.prepared.case, &self.prepared.scene);
        provenance.acquisition = input.case.acquisition.clone();
        provenance.presets = presets(&input.case, input.spec.materials.as_ref());
        let warnings = warnings_after(&self.prepared.told, self.warnings.iter());
        let Prepared { case, scene, .. } = self.prepared;
        let head = in_numbers(&input.case, case, scene, Some(&self.prediction.landmarks));
        ResultDocument {
            pictures: input.pictures_beside(files),
            statistics: Some(self.statistics.clone()),
            nonlinearity_mm: self.nonlinearity.as_ref().ok().cloned(),
            nonlinearity_unknown: self.nonlinearity.as_ref().err().cloned(),
            comparison: self.comparison.clone(),
            optimisation: self.optimisation.clone(),
            contact: self.prediction.contact.as_ref().map(Into::into),
            stress: self.stress.clone(),
            adequacy: self.adequacy.clone(),
            correction: self.correction.as_ref().map(|own| own.document.clone()),
            refinement: self.refinement.clone(),
            numerical_error_mm: self.numerical_error.clone(),
            numerical_error_unknown: self
                .prediction
                .numerical_error
                .as_ref()
                .err()
                .map(|why| why.to_string()),
            cephalometry: head.measures,
            symmetry: head.symmetry,
            reaction_millinewton: triples(&self.prediction.reactions),
            reaction_mn: triples(&self.prediction.reactions),
            load_steps: self.prediction.load_steps.iter().map(load_step).collect(),
            reactions: self.prediction.condition_reactions.iter().map(Into::into).collect(),
            ..ResultDocument::new(input.job.clone(), files, provenance, warnings)
        }
    }
}

/// The displacement of the skin, its parts and the landmarks.
pub fn statistics(
    skin: &Skin,
    predicted: &PredictedSkin,
    landmarks: &BTreeMap<String, Vector>,
) -> Result<StatisticsDocument, StatisticsError> {
    let areas = skin.surface.point_areas();
    let over = |points: &[u32]| -> Result<DisplacementDocument, StatisticsError> {
        let pick = |values: &[f64]| points.iter().map(|&point| values[point as usize]).collect();
        let (lengths, areas): (Vec<f64>, Vec<f64>) = (pick(&predicted.magnitude), pick(&areas));
        Ok(DisplacementDocument {
            nodes: StatDocument::from(&Statistics::plain(&lengths)?),
            area: StatDocument::from(&Statistics::weighted(&lengths, &areas)?),
        })
    };
    let everywhere: Vec<u32> = (0..predicted.magnitude.len() as u32).collect();
    let mut regions = BTreeMap::new();
    for (name, points) in &skin.regions {
        regions.insert(name.clone(), over(points)?);
    }
    let landmarks = triples(landmarks);
    Ok(StatisticsDocument { skin: over(&everywhere)?, regions, landmarks, imaged: None })
}

/// The estimated error of the skin, its parts and the landmarks.
fn numerical_error(
    skin: &Skin,
    predicted: &PredictedSkin,
    prediction: &Prediction,
) -> Result<Option<NumericalErrorDocument>, StatisticsError> {
    let (Some(lengths), Ok(error)) = (&predicted.numerical_error, &prediction.numerical_error)
    else {
        return Ok(None);
    };
    let Statistics { mean, p95, max, .. } = Statistics::plain(lengths)?;
    let mut regions = BTreeMap::new();
    for (name, points) in &skin.regions {
        let own: Vec<f64> = points.iter().map(|&point| lengths[point as usize]).collect();
        let Statistics { mean, p95, max, .. } = Statistics::plain(&own)?;
        regions.insert(name.clone(), ErrorLengthsDocument { mean, p95, max });
    }
    let at_landmarks = prediction.landmarks_missing.iter();
    let landmarks = at_landmarks.map(|(name, missing)| (name.clone(), missing.norm())).collect();
    let corrected = error.is_added;
    Ok(Some(NumericalErrorDocument { mean, p95, max, regions, landmarks, corrected }))
}

fn load_step(step: &PredictedStep) -> LoadStepDocument {
    LoadStepDocument {
        rest: rest_on_the_way(&step.rest),
        relative_residual: step.relative_residual,
        is_stable: step.is_stable,
        bulk_in_cells: step.bulk_in_cells,
        cells_with_bulk: step.cells_with_bulk as u64,
        warnings: step.is_bulk_in_all.then(|| "bulk-in-all-cells".to_owned()).into_iter().collect(),
        reaction_millinewton: triples(&step.reactions),
        contact: step.contact.as_ref().map(Into::into),
    }
}

fn triples(vectors: &BTreeMap<String, Vector>) -> BTreeMap<String, Triple> {
    vectors.iter().map(|(name, &vector)| (name.clone(), vector.into())).collect()
}
