//! Plan responses of the service: the one that is valid for the present case, and its columns, cached in memory.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::applied::Applied;
use super::cache::{Cache, InMemory};
use crate::jobs::JobInput;
use crate::jobs::response::{COLUMNS_FILE, DESCRIPTION_FILE, REST_FILE, SECOND_ORDER_FILE};
use crate::jobs::result::skin::PredictedSkin;
use crate::schema::applied::{AppliedSummary, LinearPart};
use crate::schema::hashes;
use crate::schema::predict::document::{OutputName, USUAL_RANGE_MM};
use crate::schema::predict::result::NOT_A_DEVICE;
use crate::schema::response::ResponseDocument;
use crate::schema::response_description::{PlanAmounts, ResponseDescription};
use crate::schema::{CaseDocument, WarningDocument};
use crate::store::{CaseResponses, Store, StoreError};
use mechanics::format::{self, Mesh, ReadLimits, WriteError};
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::prediction::{Skin, skin_overlap};
use mechanics::response::{Amounts, COLUMNS_PER_SEGMENT, Linearity, QuadraticForm, Response};

/// Jobs with a cached verdict; beyond that all are checked again.
const MOST_VERDICTS: usize = 10_000;

/// Why no response answers.
#[derive(Debug, thiserror::Error)]
pub enum MissingResponse {
    #[error("there is no such case")]
    NoCase,
    #[error("no response was built; post a job of kind `response` first")]
    NotBuilt,
    #[error("no successful response of this case is job {job}")]
    NotOfCase { job: String },
    #[error(
        "the case or the program changed since job {job} built its response; post the job again"
    )]
    Stale { job: String },
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// A response that answers for its case: its job, and the blob of its description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundResponse {
    pub job: String,
    description: String,
}

/// A response in memory.
pub struct LoadedResponse {
    pub description: ResponseDescription,
    response: Response,
    second_order: Option<QuadraticForm>,
    linearity: Linearity,
    rest: TriangleSurface,
}

/// The files of a stored response.
struct Stored {
    description: bytes::Bytes,
    columns: bytes::Bytes,
    second_order: Option<bytes::Bytes>,
    rest: bytes::Bytes,
}

impl LoadedResponse {
    /// One pass over the columns of each order.
    pub fn apply(&self, plan: &PlanAmounts) -> Applied {
        let PlanAmounts { movements, inner, doubts: _ } = plan;
        let mut displacement = self.response.apply_all(&Amounts { movements, inner });
        let segments = &self.response.segments;
        let form = self.second_order.as_ref();
        let beyond = form.map(|form| form.apply(segments, movements, &mut displacement));
        let of_case = self.description.warnings_of(plan);
        let is_turned = self.description.is_wall_turned(movements);
        let linear = LinearPart {
            nonlinearity: self.linearity.of(movements),
            is_unknown: is_turned || inner.iter().any(|amount| *amount != 0.0),
        };
        let summary = AppliedSummary::new(&displacement, beyond, &linear);
        let tearing_checked = self.description.edges_between.is_some();
        Applied::new(displacement, summary, of_case, tearing_checked)
    }

    /// Whether the moved skin passes through itself where it did not at rest. Takes milliseconds for each ten thousand
    /// triangles, so that it is only done where it is asked for.
    pub fn check_skin(&self, applied: Applied) -> Applied {
        let skin = Skin { surface: self.rest.clone(), regions: BTreeMap::new() };
        let mut moved = self.rest.clone();
        for (point, by) in moved.points.iter_mut().zip(&applied.displacement) {
            *point += by;
        }
        let overlap = skin_overlap(&skin, &moved);
        let overlap = overlap.iter().map(WarningDocument::from).collect();
        Applied { skin_checked: true, ..applied.warned(overlap) }
    }

    /// The skin at rest as binary glTF, its vertices in the order of `node_ids`.
    pub fn rest_glb(&self) -> Result<Vec<u8>, WriteError> {
        self.to_glb(vec![Vector::zeros(); self.rest.points.len()], USUAL_RANGE_MM)
    }

    /// The moved skin as binary glTF, its vertices in the order of `node_ids`, coloured by the length of its
    /// displacement up to a range in mm.
    pub fn glb(&self, applied: &Applied, range_mm: f64) -> Result<Vec<u8>, WriteError> {
        self.to_glb(applied.displacement.clone(), range_mm)
    }

    fn to_glb(&self, displacement: Vec<Vector>, range_mm: f64) -> Result<Vec<u8>, WriteError> {
        let rest = Skin { surface: self.rest.clone(), regions: BTreeMap::new() };
        let mut skin = PredictedSkin::of_displacement(&rest, displacement);
        skin.range_mm = range_mm;
        let texts = [
            ("job", self.description.job.clone().unwrap_or_default()),
            ("response_key", self.description.key.clone()),
            ("statement", NOT_A_DEVICE.to_owned()),
        ];
        let texts = texts.map(|(name, text)| (name.to_owned(), text));
        let bytes = skin.encode(OutputName::SkinGlb, self.description.frame.into(), &texts)?;
        bytes.ok_or(WriteError::Empty)
    }
}

impl InMemory for Arc<LoadedResponse> {
    fn size(&self) -> usize {
        let skin = 28 * self.rest.points.len() + 12 * self.rest.triangles.len();
        let second = self.second_order.as_ref().map_or(0, |form| 2 * form.values.len());
        4 * (self.response.columns.len() + 2 * self.response.nodes.len()) + second + skin
    }
}

/// Stored responses by case.
#[derive(Clone)]
pub struct Responses {
    store: Store,
    memory: Arc<Mutex<Memory>>,
}

/// Responses by the blob of their description, which names that of the columns, and verdicts by job.
struct Memory {
    loaded: Cache<Arc<LoadedResponse>>,
    verdicts: HashMap<String, Verdict>,
}

/// Whether a response answers for its case at a version of it.
#[derive(Clone)]
struct Verdict {
    version: i64,
    /// The blob of the description; `None` where the response is stale.
    description: Option<String>,
    /// Whether it is of the tissue of the case, and of no other.
    is_of_case_alone: bool,
}

impl Responses {
    /// Keeps responses of at most `room` bytes in memory.
    pub fn new(store: Store, room: usize) -> Self {
        let memory = Memory { loaded: Cache::new(room), verdicts: HashMap::new() };
        Responses { store, memory: Arc::new(Mutex::new(memory)) }
    }

    /// The same responses scoped to a tenant.
    pub fn of_tenant(&self, tenant: &str) -> Self {
        Responses { store: self.store.of_tenant(tenant), memory: self.memory.clone() }
    }

    fn memory(&self) -> MutexGuard<'_, Memory> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The response of a job, or else the newest one, that was built for the case as it is now; one with the tissue of the case and the usual
    /// element comes before all that were built to see what others would do.
    pub async fn find(
        &self,
        case: &str,
        job: Option<&str>,
    ) -> Result<FoundResponse, MissingResponse> {
        let built = self.store.responses(case).await?;
        self.find_among(built, case, job).await
    }

    /// The same where the responses of the case have been looked up.
    pub async fn find_among(
        &self,
        built: Option<CaseResponses>,
        case: &str,
        job: Option<&str>,
    ) -> Result<FoundResponse, MissingResponse> {
        let built = built.ok_or(MissingResponse::NoCase)?;
        if let Some(job) = job
            && !built.jobs.iter().any(|built| built == job)
        {
            return Err(MissingResponse::NotOfCase { job: job.to_owned() });
        }
        let Some(newest) = built.jobs.first() else { return Err(MissingResponse::NotBuilt) };
        let mut with_others = None;
        for built_by in built.jobs.iter().filter(|built| job.is_none_or(|job| job == *built)) {
            let verdict = self.verdict(case, built.version, built_by).await?;
            let Some(description) = verdict.description else { continue };
            let found = FoundResponse { job: built_by.clone(), description };
            if verdict.is_of_case_alone {
                return Ok(found);
            }
            with_others.get_or_insert(found);
        }
        let stale = || MissingResponse::Stale { job: job.unwrap_or(newest).to_owned() };
        with_others.ok_or_else(stale)
    }

    /// Whether a response answers, by its key and that of the case as it is now. The verdict holds for
    /// a version of the case, since meshes never change; the key is taken from documents and hashes of
    /// meshes, and no mesh is read.
    async fn verdict(&self, case: &str, version: i64, job: &str) -> Result<Verdict, StoreError> {
        let known = self.memory().verdicts.get(job).cloned();
        if let Some(verdict) = known.filter(|verdict| verdict.version == version) {
            return Ok(verdict);
        }
        let mut verdict = Verdict { version, description: None, is_of_case_alone: false };
        let Some(row) = self.store.case(case).await? else { return Ok(verdict) };
        verdict.version = row.version;
        if let Some(spec) = self.current(&row.document, job).await? {
            let file = self.store.job_file(job, DESCRIPTION_FILE).await?;
            verdict.description = file.map(|file| file.blob);
            verdict.is_of_case_alone = spec.is_of_case_alone();
        }
        let mut memory = self.memory();
        if memory.verdicts.len() >= MOST_VERDICTS {
            memory.verdicts.clear();
        }
        memory.verdicts.insert(job.to_owned(), verdict.clone());
        Ok(verdict)
    }

    /// What a job was asked for, if it would have the same key if it were posted now. A document of an earlier program that
    /// this one cannot read is stale as well.
    async fn current(&self, case: &str, job: &str) -> Result<Option<ResponseDocument>, StoreError> {
        let Some(row) = self.store.response(job).await? else { return Ok(None) };
        let case: Result<CaseDocument, _> = serde_json::from_str(case);
        let (Ok(case), Ok(JobInput::Response(input))) = (case, serde_json::from_str(&row.document))
        else {
            return Ok(None);
        };
        let mut contents = BTreeMap::new();
        for id in case.mesh_ids() {
            if let Some(mesh) = self.store.mesh(&id).await? {
                contents.insert(id, mesh.sha256);
            }
        }
        let content = |id: &str| contents.get(id).cloned();
        let key = hashes::response_key(&case, &input.spec, &content);
        Ok((key == row.key).then_some(input.spec))
    }

    /// A response with its columns, from memory where it is there.
    pub async fn load(&self, found: &FoundResponse) -> Result<Arc<LoadedResponse>, StoreError> {
        let kept = self.memory().loaded.get(&found.description);
        if let Some(kept) = kept {
            return Ok(kept);
        }
        let description = self.store.read_blob(&found.description).await?;
        let columns = self.file(&found.job, COLUMNS_FILE).await?;
        let rest = self.file(&found.job, REST_FILE).await?;
        let second_order = match self.store.job_file(&found.job, SECOND_ORDER_FILE).await? {
            Some(file) => Some(self.store.read_blob(&file.blob).await?),
            None => None,
        };
        let stored = Stored { description, columns, second_order, rest };
        let parse = move || parsed(&stored);
        let parsed = tokio::task::spawn_blocking(parse).await;
        let response = Arc::new(parsed.map_err(|_| StoreError::Interrupted)??);
        self.memory().loaded.insert(&found.description, response.clone());
        Ok(response)
    }

    async fn file(&self, job: &str, name: &str) -> Result<bytes::Bytes, StoreError> {
        let file = self.store.job_file(job, name).await?;
        self.store.read_blob(&file.ok_or(StoreError::Interrupted)?.blob).await
    }
}

fn broken(what: &str) -> StoreError {
    StoreError::Schema(format!("stored response: {what}"))
}

/// A response out of its files.
fn parsed(stored: &Stored) -> Result<LoadedResponse, StoreError> {
    let Stored { description, columns, second_order, rest } = stored;
    let description: ResponseDescription =
        serde_json::from_slice(description).map_err(|error| broken(&error.to_string()))?;
    // Our own writer may compress better than a stranger's file is allowed to.
    let limits = ReadLimits { decoded_ratio: f64::INFINITY, ..ReadLimits::default() };
    let rest = format::read(rest, &limits).map_err(|error| broken(&error.to_string()))?;
    let Mesh::Surface(rest) = rest.mesh else { return Err(broken("the skin is no surface")) };
    let (values, _) = columns.as_chunks::<4>();
    let columns: Vec<f32> = values.iter().map(|&value| f32::from_le_bytes(value)).collect();
    let count = usize::try_from(description.columns.count).unwrap_or(usize::MAX);
    let nodes = description.node_ids.len();
    if nodes.checked_mul(3).and_then(|length| length.checked_mul(count)) != Some(columns.len())
        || rest.points.len() != nodes
    {
        return Err(broken("its files do not fit each other"));
    }
    let second_order = second_order_of(&description, second_order.as_deref())?;
    Ok(LoadedResponse {
        second_order,
        response: Response {
            inner: description.inner_loads(),
            segments: description.response_segments(),
            nodes: description.node_ids.clone(),
            columns,
        },
        linearity: description.to_linearity(),
        rest,
        description,
    })
}

/// The quadratic form of a response that has one.
fn second_order_of(
    description: &ResponseDescription,
    bytes: Option<&[u8]>,
) -> Result<Option<QuadraticForm>, StoreError> {
    let Some(document) = &description.second_order else { return Ok(None) };
    let (values, _) = bytes.unwrap_or_default().as_chunks::<2>();
    let values: Vec<i16> = values.iter().map(|&value| i16::from_le_bytes(value)).collect();
    let numbers = COLUMNS_PER_SEGMENT * description.segments.len();
    let pairs = numbers * (numbers + 1) / 2;
    if values.len() != 3 * pairs * description.node_ids.len()
        || document.scale_mm.len() != pairs
        || document.third_order_mm.len() != description.segments.len()
    {
        return Err(broken("its columns of second order do not fit"));
    }
    Ok(Some(document.to_form(numbers, values)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::response_description::ResponseOrigin;
    use crate::schema::second_order::ColumnsDocument;
    use mechanics::response::{Columns, ResponseSegment};

    /// A response of one segment that takes 4 * (36 + 2) + 28 bytes for each node.
    fn loaded(nodes: u32) -> Arc<LoadedResponse> {
        let segments = vec![ResponseSegment { name: "jaw".into(), centre: Vector::zeros() }];
        let corner = Vector::zeros();
        let linearity = Linearity {
            thickness: 1.0,
            something_stays: true,
            boxes: vec![[corner, corner]],
            sampled: Vec::new(),
        };
        let solver = mechanics::prediction::SolveReport::at_rest(0, 0.0);
        let values = vec![0.0; 36 * nodes as usize];
        let nodes: Vec<u32> = (0..nodes).collect();
        let rest = TriangleSurface {
            points: vec![Vector::zeros(); nodes.len()],
            ..TriangleSurface::default()
        };
        let columns = Columns {
            segments,
            inner: Vec::new(),
            nodes,
            values,
            linearity: linearity.clone(),
            second_order: None,
            parts: Vec::new(),
            edges_between: Vec::new(),
            carries_wall: vec![false],
            allow_unfixed: false,
            diagonal: 1.0,
            solver,
            elements: Vec::new(),
        };
        let (file, layout, sha256) = (String::new(), String::new(), String::new());
        let origin = ResponseOrigin {
            job: None,
            key: String::new(),
            frame: mechanics::mesh::Frame::Lps,
            mesh_centre: Vector::zeros(),
            regions: Vec::new(),
            staying: Vec::new(),
            columns: ColumnsDocument { file, layout, count: 12, bytes: 0, sha256 },
            second_order: None,
            warnings: Vec::new(),
        };
        let description = ResponseDescription::new(&columns, origin);
        let response = columns.to_response();
        Arc::new(LoadedResponse { description, response, second_order: None, linearity, rest })
    }

    #[test]
    fn a_response_takes_the_memory_of_its_columns_and_of_its_skin() {
        assert_eq!(loaded(4).size(), 180 * 4);
    }
}
