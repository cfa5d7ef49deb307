//! Jobs on a case whose mesh is being made: accepted with the checks that need no mesh, and claimed once it exists.
//! Their rows lack the case, which the claim inserts.

use serde_json::{Value, json};

use super::Service;
use super::accepted::{Accepted, in_spec, require_compared};
use super::case_state::PendingCase;
use super::error::{ApiError, ApiResult};
use super::parameters::id;
use crate::jobs::{JobInput, OptimiseInput, PredictInput, ResponseInput};
use crate::schema::case::document::LengthUnit;
use crate::schema::case::merged::{PlacedMaterials, merge_materials};
use crate::schema::plan::document::PlanContext;
use crate::schema::wire::canonical::to_value;
use crate::schema::{
    CaseDocument, Faults, OptimiseDocument, PlanDocument, Pointer, PredictDocument,
    ResponseDocument, hashes,
};
use crate::store::NewJob;
use mechanics::mesh::Frame;

/// A case that waits for its mesh.
pub struct Waiting<'a> {
    pub case: &'a str,
    pub awaited: PendingCase,
}

impl Waiting<'_> {
    pub async fn prediction(
        self,
        service: &Service,
        mut plan: PlanDocument,
        spec: PredictDocument,
    ) -> ApiResult<NewJob> {
        self.check(service, Some(&plan), &spec)?;
        let mut named: Vec<String> =
            plan.surface_references_mut().into_iter().map(|(_, id)| id.clone()).collect();
        named.extend(require_compared(service, &spec).await?);
        let asked = json!({ "plan": to_value(&plan.unnamed()), "spec": spec.content() });
        let (case, tags) = (to_come(), spec.tags.clone());
        let input = PredictInput { job: None, queue_s: None, case, plan, spec };
        self.accept(service, &JobInput::Predict(input), JobRequest { asked, tags, named }).await
    }

    pub async fn response(self, service: &Service, spec: ResponseDocument) -> ApiResult<NewJob> {
        self.check(service, None, &spec.to_prediction())?;
        let mut faults = Faults::default();
        spec.check(&service.limits, &mut faults);
        faults.into_result().map_err(in_spec)?;
        let (asked, tags) = (json!({ "spec": spec.content() }), spec.tags.clone());
        let input = ResponseInput { job: None, queue_s: None, case: to_come(), spec };
        let asked = JobRequest { asked, tags, named: Vec::new() };
        self.accept(service, &JobInput::Response(input), asked).await
    }

    pub async fn optimisation(
        self,
        service: &Service,
        mut spec: OptimiseDocument,
    ) -> ApiResult<NewJob> {
        self.check(service, None, &spec.to_prediction())?;
        let named = spec.surfaces_mut().into_iter().map(|id| id.clone()).collect();
        let (asked, tags) = (json!({ "spec": spec.content() }), spec.tags.clone());
        let input = OptimiseInput { job: None, queue_s: None, case: to_come(), spec };
        self.accept(service, &JobInput::Optimise(input), JobRequest { asked, tags, named }).await
    }

    /// Checks that need no mesh, with the same places as on a case with one.
    fn check(
        &self,
        service: &Service,
        plan: Option<&PlanDocument>,
        spec: &PredictDocument,
    ) -> ApiResult<()> {
        let (limits, at) = (&service.limits, Pointer::root().key("spec"));
        let mut faults = Faults::default();
        spec.to_settings(limits, &mut faults);
        spec.check_element(&mut faults);
        let own = PlacedMaterials {
            at: Pointer::root().key("case").key("materials"),
            materials: self.awaited.materials.as_ref(),
        };
        let over = PlacedMaterials { at: at.key("materials"), materials: spec.materials.as_ref() };
        merge_materials(&own, &over, limits, &mut faults);
        if let Some(plan) = plan {
            // Only the mesh knows the frame of the case where the scan does not.
            let frame = plan.frame.map_or(Frame::Unspecified, Frame::from);
            let context = PlanContext { frame, centre: None, limits };
            plan.to_plan(&Pointer::root().key("plan"), &context, &mut faults);
        }
        Ok(faults.into_result().map_err(in_spec)?)
    }

    async fn accept(
        self,
        service: &Service,
        input: &JobInput,
        of: JobRequest,
    ) -> ApiResult<NewJob> {
        let JobRequest { asked, tags, named } = of;
        // Others are names of bones that the case will have.
        let mut mesh_ids = Vec::new();
        for mesh in named.iter().filter_map(|name| id(name)) {
            if service.store.mesh(&mesh).await?.is_some() {
                mesh_ids.push(mesh);
            }
        }
        let asked = json!({ "kind": input.kind(), "asked": asked });
        let accepted = Accepted {
            case_id: Some(self.case.to_owned()),
            shared_cases: Vec::new(),
            spec_hash: hashes::waiting_hash(self.case, &asked),
            tags,
            mesh_ids,
            study: None,
        };
        let document = without_case(input)?;
        let waits_for = Some(self.awaited.meshing);
        Ok(NewJob { document, waits_for, ..accepted.with(input)? })
    }
}

/// The content of a job.
struct JobRequest {
    /// All of it that determines the result, except the case.
    asked: Value,
    tags: Vec<String>,
    /// Meshes, and bones of the case.
    named: Vec<String>,
}

/// Placeholder of the case until there is one.
fn to_come() -> CaseDocument {
    CaseDocument::of_volume("", LengthUnit::Mm)
}

fn without_case(input: &JobInput) -> ApiResult<String> {
    let mut document = serde_json::to_value(input).map_err(ApiError::internal)?;
    for input in document.as_object_mut().into_iter().flat_map(serde_json::Map::values_mut) {
        input["case"] = Value::Null;
    }
    Ok(document.to_string())
}
