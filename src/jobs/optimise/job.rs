//! The job of inverse planning: response, plan, and the skin of that plan by a full solution.

use std::collections::BTreeMap;

use super::input::OptimiseInput;
use super::targets::PreparedOptimisation;
use super::tissue::TissueConstant;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput};
use crate::jobs::predict::{PredictInput, Predicted, Prepared, statistics};
use crate::jobs::report::{PredictionFacts, write_reports};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{
    Origin, add_method, encode_result, mesh_summary, solver_document,
};
use crate::jobs::result::skin::PredictedSkin;
use crate::jobs::result::warnings::warnings_after;
use crate::schema::applied::{AppliedSummary, outside_second_order};
use crate::schema::methods::MethodName;
use crate::schema::optimise::result::{NamedConstant, NamedOptimum, OptimisationDocument};
use crate::schema::predict::document::{OutputName, PredictDocument};
use crate::schema::predict::result::{ResultDocument, SolverDocument};
use mechanics::mesh::{Vector, Warning};
use mechanics::optimisation::{ConstantBounds, Optimum, Search, SearchError, SearchResult, search};
use mechanics::plan::doubt::PLAN_UNITS_SUSPECT;
use mechanics::prediction::{MethodKind, Prediction, predict, solved_loosely};
use mechanics::progress::{Phase, Progress, StopQuery};
use mechanics::response::linearity::LINEAR_RANGE_MM;
use mechanics::response::{
    BeyondLinear, COLUMNS_PER_SEGMENT, ColumnRequest, ResponseError, ResponseOrder, chosen,
};

/// Reported difference between full solution and response, in mm: stored in single precision and
/// solved to the default residual they agree to 1e-4 mm.
const NOTICEABLE: f64 = 0.01;

/// Why a result without a full solution has no estimate of the linearisation error.
const NOT_VERIFIED: &str = "the plan was not solved in full: set `verify`";

/// The resulting plan, and its skin from the response.
struct OptimisedPlan {
    document: OptimisationDocument,
    displacement: Vec<Vector>,
    /// In order 2.
    beyond: Option<BeyondLinear>,
    solver: SolverDocument,
}

/// Finds a plan and writes its skin like a prediction.
pub fn optimise_job(
    input: &OptimiseInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, input.spec.budget.wall_s);

    // 1. Documents and meshes, checked together.
    let mut prepared = clock.prepared(|stop| input.prepare(place.sources, place.limits, stop))?;
    let columns = COLUMNS_PER_SEGMENT * prepared.moving + prepared.inner.len();
    prepared.rest.admit(columns, place.limits)?;
    clock.check()?;

    // 2. What each number of the movements does to the skin, and the plan.
    let found = input.find(&mut prepared, &clock)?;
    clock.check()?;

    // 3. The plan as any other.
    let prediction = input.prediction(&found.document);
    let planned = |stop: &StopQuery| prediction.prepare(place.sources, place.limits, stop);
    let mut planned = clock.prepared(planned).map_err(|error| input.in_spec(error))?;
    planned.spec_hash = prepared.spec_hash;
    planned.inputs = prepared.rest.inputs;
    planned.warnings.extend(prepared.warnings);
    planned.warnings.extend(input.spec.doubts(&found.document));
    let outside = found.beyond.as_ref().and_then(outside_second_order);
    let outside = outside.map(|detail| Warning::new(AppliedSummary::OUTSIDE_SECOND, detail));
    planned.warnings.extend(outside);
    // No number of the plan was stated.
    for told in [&mut planned.warnings, &mut planned.scene.warnings] {
        told.retain(|own| own.code != PLAN_UNITS_SUSPECT);
    }
    if !input.spec.verify {
        return found.publish(&prediction, planned, &clock, place);
    }
    let solved = predict(&planned.scene, &clock).map_err(|error| clock.judge(error))?;
    let (optimisation, warning) = found.verified(&planned, &solved);
    planned.warnings.extend(warning);
    let optimisation = Some(optimisation);
    Predicted {
        prepared: planned,
        prediction: solved,
        optimisation,
        adequacy: None,
        refinement: None,
    }
    .publish(&prediction, &clock, place)
}

impl OptimiseInput {
    fn find(
        &self,
        prepared: &mut PreparedOptimisation,
        clock: &Observed,
    ) -> Result<OptimisedPlan, JobError> {
        let PreparedOptimisation { rest, inner, inner_bounds, constants, targets, .. } = prepared;
        let moving = self.spec.moving();
        let order = self.spec.to_response().response_order();
        let segments = chosen(&rest.scene, &moving).map_err(|error| self.judge(error))?;
        let name = |number: usize| &rest.scene.segments[number].name;
        let bounds: Vec<_> = segments
            .into_iter()
            .map(|number| self.spec.bounds_of(name(number)).to_bounds())
            .collect();
        let looked_for: Vec<ConstantBounds> =
            constants.iter().map(|own| own.bounds.clone()).collect();
        let asks = Search {
            asked: ColumnRequest { segments: &moving, order, inner },
            bounds: &bounds,
            targets,
            inner: inner_bounds,
            constants: &looked_for,
        };
        let found = search(&mut rest.scene, &asks, clock).map_err(|error| match error {
            SearchError::Response(ResponseError::Prediction(error)) => clock.judge(error),
            SearchError::Response(other) => self.judge(other),
            SearchError::Optimisation(error) => error.into(),
            other @ (SearchError::Constant(_) | SearchError::NotConverged { .. }) => {
                JobError::Search(other)
            }
        })?;
        clock.check()?;
        let SearchResult { optimum, columns, response, .. } = &found;
        let names: Vec<NamedConstant> = constants.iter().map(TissueConstant::named).collect();
        let named = NamedOptimum { spec: &self.spec, response, constants: &names, optimum };
        let materials = self.materials(constants, rest);
        let document = OptimisationDocument::new(&named, materials);
        let solver = solver_document(&columns.solver, &columns.elements);
        let Optimum { skin: displacement, beyond, .. } = found.optimum;
        Ok(OptimisedPlan { document, displacement, beyond, solver })
    }

    /// The prediction of a plan that was found: in order 2, whose skin no linear solution has, at finite strain.
    pub fn prediction(&self, found: &OptimisationDocument) -> PredictInput {
        let usual = self.spec.to_prediction();
        let method = match self.spec.to_response().response_order() {
            ResponseOrder::Second if self.spec.verify => {
                MethodName::Named(MethodKind::FemNonlinear)
            }
            ResponseOrder::First | ResponseOrder::Second => usual.method,
        };
        PredictInput {
            job: self.job.clone(),
            queue_s: self.queue_s,
            case: self.case.clone(),
            plan: found.plan.clone(),
            spec: PredictDocument {
                materials: found.materials.clone().or_else(|| self.spec.materials.clone()),
                method,
                ..usual
            },
        }
    }
}

impl OptimisedPlan {
    /// The result with the largest difference between the skin of the full solution and that of the response.
    fn verified(
        &self,
        planned: &Prepared,
        solved: &Prediction,
    ) -> (OptimisationDocument, Option<Warning>) {
        let nodes = planned.scene.skin.nodes().iter().zip(&self.displacement);
        let difference = nodes
            .map(|(&node, found)| (solved.displacement[node as usize] - found).norm())
            .fold(0.0, f64::max);
        let (most, detail) = match self.beyond {
            None => (
                NOTICEABLE,
                "the skin of the full solution is not that of the response: solve both more exactly",
            ),
            Some(_) => (
                LINEAR_RANGE_MM,
                "the skin at finite strain is not that of the response of order 2: the plan is too large for it",
            ),
        };
        let warning =
            Warning::new("verification-differs", detail).with("difference_mm", difference);
        let document = self.document.clone();
        let document =
            OptimisationDocument { verified_difference_mm: Some(difference), ..document };
        (document, (difference > most).then_some(warning))
    }

    /// The skin of the response as files, without a full solution: no reactions, no volume.
    fn publish(
        self,
        input: &PredictInput,
        planned: Prepared,
        clock: &Observed,
        place: &JobContext,
    ) -> Result<JobOutput, JobError> {
        clock.phase(Phase::Surface);
        let scene = &planned.scene;
        let mut skin = PredictedSkin::of_displacement(&scene.skin, self.displacement);
        skin.range_mm = input.spec.range_mm();
        let statistics = statistics(&scene.skin, &skin, &BTreeMap::new())?;
        clock.check()?;
        clock.phase(Phase::Write);
        let frame = planned.case.frame;
        let origin = Origin {
            spec_hash: planned.spec_hash.clone(),
            inputs: planned.inputs.clone(),
            frame,
            queue_s: input.queue_s,
        };
        let field_data = origin.field_data(input.spec.method, None, &self.solver);
        let mut folder = ResultFolder::open(place)?;
        for name in input.files() {
            let bytes = planned.encode(name, (&skin, &statistics.skin.nodes), &field_data)?;
            if let Some(bytes) = bytes {
                folder.add(name, &bytes)?;
            }
        }
        let loosely =
            solved_loosely(scene.settings.relative_residual, self.solver.relative_residual);
        let mut provenance = origin.provenance(clock);
        let mesh = mesh_summary(&scene.mesh, &planned.quality);
        add_method(&mut provenance, input.spec.method, mesh, self.solver);
        let warnings = planned.warnings.iter().chain(&scene.warnings).chain(&loosely);
        let warnings = warnings_after(&planned.told, warnings);
        let mut result = ResultDocument {
            statistics: Some(statistics),
            optimisation: Some(self.document),
            nonlinearity_unknown: Some(NOT_VERIFIED.to_owned()),
            ..ResultDocument::new(input.job.clone(), &folder.files, provenance, warnings)
        };
        let facts = PredictionFacts {
            case: &input.case,
            plan: &input.plan,
            scene,
            frame,
            after: &skin.surface,
            range_mm: input.spec.range_mm(),
            result: &result,
        };
        write_reports(&input.files(), &facts, &mut folder)?;
        result.pictures = input.pictures_beside(&folder.files);
        result.files.clone_from(&folder.files);
        folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
        Ok(JobOutput { result, files: folder.files, meshes: Vec::new() })
    }
}
