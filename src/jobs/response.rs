//! The job that builds a plan response: its columns, their description, and the undeformed skin.

use serde::{Deserialize, Serialize};

use super::clock::Observed;
use super::failure::JobError;
use super::output::{JobContext, JobOutput};
use super::source::MeshSource;
use crate::jobs::predict::{PredictInput, Prepared};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{
    Origin, add_method, encode_result, mesh_summary, solver_document,
};
use crate::jobs::result::warnings::warnings_after;
use crate::schema::case::conversion::centre;
use crate::schema::hashes;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::ResultDocument;
use crate::schema::response_description::{ResponseDescription, ResponseOrigin};
use crate::schema::second_order::{ColumnsDocument, SecondOrderDocument};
use crate::schema::wire::canonical;
use crate::schema::{
    CaseDocument, Faults, Limits, PlanDocument, ResponseDocument, WarningDocument,
};
use mechanics::format::SurfaceOutput;
use mechanics::format::vtk::vtp;
use mechanics::prediction::solved_loosely;
use mechanics::progress::{Phase, Progress, StopQuery};
use mechanics::response::{
    COLUMNS_PER_SEGMENT, ColumnRequest, Columns, InnerLoad, QuadraticForm, ResponseError,
    ResponseOrder, build_of, check_order, chosen,
};

/// f32 little-endian, [column][node][xyz].
pub const COLUMNS_FILE: &str = "response.f32";
pub const COLUMNS_MEDIA_TYPE: &str = "application/octet-stream";
/// i16 little-endian, [pair][node][xyz], of a response of second order.
pub const SECOND_ORDER_FILE: &str = "response_second_order.i16";
/// The description of the columns, and the data to apply a plan.
pub const DESCRIPTION_FILE: &str = "response.json";
pub const DESCRIPTION_MEDIA_TYPE: &str = "application/json";
/// The undeformed skin, its points in the order of a column.
pub const REST_FILE: &str = "skin_at_rest.vtp";

/// A response: the case in full beside the spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResponseInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub case: CaseDocument,
    pub spec: ResponseDocument,
}

/// A response with valid documents.
pub struct PreparedResponse {
    pub key: String,
    prepared: Prepared,
    segments: usize,
    inner: Vec<InnerLoad>,
}

impl PreparedResponse {
    /// Refuses a response with more expected memory than a slot has.
    pub fn admit(&self, limits: &Limits) -> Result<(), JobError> {
        let columns = COLUMNS_PER_SEGMENT * self.segments + self.inner.len();
        self.prepared.admit(columns, limits)
    }
}

impl ResponseInput {
    /// Fetches the meshes and checks the documents as those of a prediction in which nothing moves.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<PreparedResponse, JobError> {
        let mut faults = Faults::default();
        self.spec.check(limits, &mut faults);
        faults.into_result()?;
        let still = PredictInput {
            job: None,
            queue_s: None,
            case: self.case.clone(),
            plan: PlanDocument::default(),
            spec: self.spec.to_prediction(),
        };
        let prepared = still.prepare(sources, limits, stop)?;
        let chosen = chosen(&prepared.scene, &self.spec.segments);
        let segments = chosen.map_err(|error| self.judge(error))?.len();
        check_order(&prepared.scene, self.spec.response_order())
            .map_err(|error| self.judge(error))?;
        let inner = self.spec.inner_loads(&prepared.scene);
        let inner = inner.map_err(|error| self.judge(error))?;
        let content = |id: &str| prepared.contents.get(id).cloned();
        let key = hashes::response_key(&self.case, &self.spec, &content);
        Ok(PreparedResponse { key, prepared, segments, inner })
    }

    fn judge(&self, error: ResponseError) -> JobError {
        match error {
            ResponseError::Prediction(error) => error.into(),
            refused => JobError::Refused(self.spec.refusal(&refused)),
        }
    }
}

/// Builds a response and writes its files.
pub fn response_job(
    input: &ResponseInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, input.spec.budget.wall_s);

    // 1. Documents and meshes, checked together.
    let checked = clock.prepared(|stop| input.prepare(place.sources, place.limits, stop))?;
    checked.admit(place.limits)?;
    let PreparedResponse { key, prepared, inner, .. } = checked;
    clock.check()?;

    // 2. The columns.
    let order = input.spec.response_order();
    let asked = ColumnRequest { segments: &input.spec.segments, order, inner: &inner };
    let built = build_of(&prepared.scene, &asked, &clock);
    let columns = built.map_err(|error| match error {
        ResponseError::Prediction(error) => clock.judge(error),
        other => input.judge(other),
    })?;
    clock.check()?;

    // 3. Files.
    clock.phase(Phase::Write);
    let origin = Origin {
        spec_hash: key,
        inputs: prepared.inputs.clone(),
        frame: prepared.case.frame,
        queue_s: input.queue_s,
    };
    let solver = solver_document(&columns.solver, &columns.elements);
    let mut folder = ResultFolder::open(place)?;
    write_columns(&origin, input, &prepared, &columns, &mut folder)?;
    let mut rest = SurfaceOutput::plain(&prepared.scene.skin.surface, origin.frame);
    rest.field_data = origin.field_data(input.spec.method, None, &solver);
    folder.add_file(REST_FILE, OutputName::SkinVtp.media_type(), &vtp::write(&rest)?)?;

    // 4. The manifest.
    let mut provenance = origin.provenance(&clock);
    let mesh = mesh_summary(&prepared.scene.mesh, &prepared.quality);
    add_method(&mut provenance, input.spec.method, mesh, solver);
    let warnings = warnings_of(input, &prepared, &columns);
    let result = ResultDocument::new(input.job.clone(), &folder.files, provenance, warnings);
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files, meshes: Vec::new() })
}

/// Of the case and its mesh, of muscles without a column, of what its law makes of the second order, and of how its columns were solved.
fn warnings_of(
    input: &ResponseInput,
    prepared: &Prepared,
    columns: &Columns,
) -> Vec<WarningDocument> {
    let left_out = input.spec.left_out(&prepared.scene);
    let of_order = match input.spec.response_order() {
        ResponseOrder::First => None,
        ResponseOrder::Second => prepared.scene.second_order_locking(),
    };
    let of_case = prepared.warnings.iter().chain(&prepared.scene.warnings);
    let wanted = prepared.scene.settings.relative_residual;
    let loosely = solved_loosely(wanted, columns.solver.relative_residual);
    warnings_after(&prepared.told, of_case.chain(&left_out).chain(&of_order).chain(&loosely))
}

/// The columns and their description.
fn write_columns(
    origin: &Origin,
    input: &ResponseInput,
    prepared: &Prepared,
    columns: &Columns,
    folder: &mut ResultFolder,
) -> Result<(), JobError> {
    let values = columns.values.iter().map(|&value| value as f32);
    let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
    folder.add_file(COLUMNS_FILE, COLUMNS_MEDIA_TYPE, &bytes)?;
    let second_order = match &columns.second_order {
        Some(form) => Some(write_second_order(form, folder)?),
        None => None,
    };
    let moved = |name: &str| columns.segments.iter().any(|segment| segment.name == name);
    let names = prepared.scene.segments.iter().map(|segment| segment.name.clone());
    let origin = ResponseOrigin {
        job: input.job.clone(),
        key: origin.spec_hash.clone(),
        frame: origin.frame,
        mesh_centre: centre(&prepared.case.volume),
        regions: prepared.scene.regions.clone(),
        staying: names.filter(|name| !moved(name)).collect(),
        columns: ColumnsDocument {
            file: COLUMNS_FILE.to_owned(),
            layout: "f32 little-endian [column][node][xyz], mm".to_owned(),
            count: (columns.values.len() / (3 * columns.nodes.len()).max(1)) as u64,
            bytes: bytes.len() as u64,
            sha256: canonical::sha256_hex(&bytes),
        },
        second_order,
        warnings: warnings_of(input, prepared, columns),
    };
    let description = ResponseDescription::new(columns, origin);
    let text = serde_json::to_vec(&description)
        .map_err(|error| JobError::NotFinite { what: error.to_string() })?;
    folder.add_file(DESCRIPTION_FILE, DESCRIPTION_MEDIA_TYPE, &text)
}

/// The columns of second order.
fn write_second_order(
    form: &QuadraticForm,
    folder: &mut ResultFolder,
) -> Result<SecondOrderDocument, JobError> {
    let bytes: Vec<u8> = form.values.iter().flat_map(|value| value.to_le_bytes()).collect();
    folder.add_file(SECOND_ORDER_FILE, COLUMNS_MEDIA_TYPE, &bytes)?;
    Ok(SecondOrderDocument {
        columns: ColumnsDocument {
            file: SECOND_ORDER_FILE.to_owned(),
            layout: "i16 little-endian [column][node][xyz], in units of scale_mm[column]"
                .to_owned(),
            count: form.scales.len() as u64,
            bytes: bytes.len() as u64,
            sha256: canonical::sha256_hex(&bytes),
        },
        scale_mm: form.scales.clone(),
        third_order_mm: form.third.clone(),
        third_order_coupling: form.coupling.clone(),
    })
}
