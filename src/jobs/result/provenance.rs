//! Provenance of the numbers of a result.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::jobs::clock::{Observed, now_rfc3339, peak_rss_mb};
use crate::jobs::failure::{JobError, thinned};
use crate::schema::case::document::{CaseDocument, LengthUnit};
use crate::schema::case::hounsfield::HounsfieldDocument;
use crate::schema::case::material::MaterialDocuments;
use crate::schema::case::merged::expanded_materials;
use crate::schema::case::muscle::muscle_materials;
use crate::schema::case::preset::{UsedPresetDocument, used_presets};
use crate::schema::methods::MethodName;
use crate::schema::predict::newton::{NewtonDocument, RestOnTheWayDocument};
use crate::schema::predict::result::{
    EngineDocument, InputDocument, MeshSummaryDocument, NOT_A_DEVICE, ProvenanceDocument,
    ResultDocument, SolverDocument,
};
use crate::schema::predict::tissue_law::TissueLawDocument;
use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::{Hyperelastic, Law, SaintVenantKirchhoff};
use mechanics::mesh::quality::QualityReport;
use mechanics::mesh::{Frame, VolumeMesh};
use mechanics::prediction::{Case, Laws, NewtonReport, RestOnTheWay, Scene, SolveReport};

/// The origin of a job, known before it starts.
pub struct Origin {
    pub spec_hash: String,
    pub inputs: Vec<InputDocument>,
    pub frame: Frame,
    pub queue_s: Option<f64>,
}

impl Origin {
    /// Provenance without method, solver and mesh.
    pub fn provenance(&self, clock: &Observed) -> ProvenanceDocument {
        ProvenanceDocument {
            engine: EngineDocument::this(),
            spec_hash: self.spec_hash.clone(),
            inputs: self.inputs.clone(),
            plan: None,
            plan_id: None,
            method: None,
            model: None,
            why: None,
            solver: None,
            mesh: None,
            laws: BTreeMap::new(),
            presets: BTreeMap::new(),
            acquisition: None,
            threads: rayon::current_num_threads() as u32,
            determinism: "bitwise".to_owned(),
            timing: clock.timing(self.queue_s),
            peak_rss_mb: peak_rss_mb(),
            frame: self.frame.into(),
            units: LengthUnit::Mm,
            created: now_rfc3339(),
            statement: NOT_A_DEVICE.to_owned(),
        }
    }

    /// Texts for result files. No times: the same job writes the same bytes.
    pub fn field_data(
        &self,
        method: MethodName,
        model: Option<&str>,
        solver: &SolverDocument,
    ) -> Vec<(String, String)> {
        let mut provenance = json!({
            "engine": EngineDocument::this(),
            "spec_hash": self.spec_hash,
            "inputs": self.inputs,
            "method": method.chosen().name(),
            "solver": solver,
            "frame": self.frame.name(),
            "units": "mm",
            "statement": NOT_A_DEVICE,
        });
        if let Some(model) = model {
            provenance["model"] = model.into();
        }
        vec![("provenance".to_owned(), provenance.to_string())]
    }
}

/// Adds the members of a prediction.
pub fn add_method(
    provenance: &mut ProvenanceDocument,
    method: MethodName,
    mesh: MeshSummaryDocument,
    solver: SolverDocument,
) {
    provenance.method = Some(method.chosen().name().to_owned());
    provenance.why = Some(method.why().to_owned());
    provenance.solver = Some(solver);
    provenance.mesh = Some(mesh);
}

/// The hyperelastic laws of a scene, by region and by tissue of its image.
pub fn laws(case: &Case, scene: &Scene) -> BTreeMap<String, TissueLawDocument> {
    let followed = |tissue: &LinearElastic| match scene.settings.method.properties().laws {
        Laws::AtRest => None,
        Laws::SaintVenantKirchhoff => {
            let (lambda, mu) = (tissue.lambda(), tissue.shear_modulus());
            let law = Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu });
            Some(Hyperelastic { law, fibres: None })
        }
        Laws::Any => Some(tissue.hyperelastic()),
    };
    let tissues = case.hounsfield.iter().flat_map(|image| &image.tissues);
    let names = scene.regions.iter().chain(tissues.map(|tissue| &tissue.name)).cloned();
    let of = names.zip(scene.materials.iter().map(followed));
    of.filter_map(|(name, law)| Some((name, (&law?).into()))).collect()
}

/// The materials of the literature in a case, with those of a spec over its own.
pub fn presets(
    case: &CaseDocument,
    spec: Option<&MaterialDocuments>,
) -> BTreeMap<String, UsedPresetDocument> {
    let regions = expanded_materials(case.materials.as_ref(), spec);
    let tissues = case.hounsfield.as_ref().map(HounsfieldDocument::expanded).unwrap_or_default();
    let muscles = muscle_materials(&case.muscles);
    used_presets(regions.iter().chain(&tissues).chain(&muscles))
}

/// The mesh of the computation, in provenance.
pub fn mesh_summary(mesh: &VolumeMesh, quality: &QualityReport) -> MeshSummaryDocument {
    MeshSummaryDocument {
        nodes: mesh.nodes.len() as u64,
        cells: mesh.cells.len() as u64,
        min_quality: quality.smallest_scaled_jacobian,
        inverted: quality.inverted as u64,
    }
}

/// The report of a solver.
pub fn solver_document(solver: &SolveReport, elements: &[String]) -> SolverDocument {
    SolverDocument {
        name: solver.method.to_owned(),
        preconditioner: solver.preconditioner.to_owned(),
        why: solver.why.clone(),
        unknowns: solver.unknowns as u64,
        iterations: solver.iterations as u64,
        relative_residual: solver.relative_residual,
        wanted_residual: solver.wanted_residual,
        elements: elements.to_vec(),
        history: thinned(&solver.history),
        steps: solver.steps,
        newton: solver.newton.as_ref().map(newton_document),
    }
}

fn newton_document(newton: &NewtonReport) -> NewtonDocument {
    NewtonDocument {
        energy_mn_mm: newton.energy,
        least_det_f: newton.least_det_f,
        path: thinned(&newton.path),
        inner_iterations: newton.inner_iterations as u64,
        hierarchies: newton.hierarchies as u64,
        indefinite_steps: newton.indefinite_steps as u64,
        is_stable: newton.is_stable,
        bulk_in_cells: newton.bulk_in_cells,
        cells_with_bulk: newton.cells_with_bulk as u64,
        parts: newton.parts.iter().map(rest_on_the_way).collect(),
    }
}

/// Equilibria before the last one.
pub fn rest_on_the_way(rest: &RestOnTheWay) -> RestOnTheWayDocument {
    let RestOnTheWay { share, energy, least_det_f, steps } = *rest;
    RestOnTheWayDocument { share, energy_mn_mm: energy, least_det_f, steps: steps as u64 }
}

/// The bytes of `result.json`. JSON cannot represent a number that is not finite and would write null:
/// such a result is refused.
pub fn encode_result(result: &ResultDocument) -> Result<Vec<u8>, JobError> {
    let value = serde_json::to_value(result)
        .map_err(|error| JobError::NotFinite { what: error.to_string() })?;
    if let Some(what) = first_null(&value, String::new()) {
        return Err(JobError::NotFinite { what });
    }
    Ok(manifest_bytes(&value))
}

/// The format of a manifest.
pub fn manifest_bytes(manifest: &Value) -> Vec<u8> {
    format!("{manifest:#}\n").into_bytes()
}

/// Members of a result that may be null: unknown estimates.
const UNKNOWN: [&str; 2] = ["/numerical_error_mm", "/nonlinearity_mm"];

/// Members stated by a client, where null is a free direction.
const STATED: &str = "/provenance/plan";

/// The place of the first null that is not permitted in a result.
pub(in crate::jobs) fn first_null(value: &Value, at: String) -> Option<String> {
    match value {
        Value::Null if !UNKNOWN.contains(&at.as_str()) => Some(at),
        Value::Object(_) if at == STATED => None,
        Value::Array(entries) => {
            let mut entries = entries.iter().enumerate();
            entries.find_map(|(index, entry)| first_null(entry, format!("{at}/{index}")))
        }
        Value::Object(members) => {
            let mut members = members.iter();
            members.find_map(|(name, member)| first_null(member, format!("{at}/{name}")))
        }
        _ => None,
    }
}
