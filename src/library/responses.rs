//! Plan responses of the service: the one that is valid for the present case, and its columns, cached in memory.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::cache::Cache;
use super::loaded_response::{LoadedResponse, Stored, parsed};
use super::meshes::document_of;
use crate::jobs::JobInput;
use crate::jobs::response::{COLUMNS_FILE, DESCRIPTION_FILE, REST_FILE, SECOND_ORDER_FILE};
use crate::schema::hashes;
use crate::schema::response::ResponseDocument;
use crate::schema::{CaseDocument, PlanDocument, WarningDocument};
use crate::store::{CaseResponses, Store, StoreError};

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

/// The response that is meant: that of a job, else the one that suits a plan best.
#[derive(Clone, Copy, Default)]
pub struct ResponseChoice<'a> {
    pub job: Option<&'a str>,
    pub plan: Option<&'a PlanDocument>,
}

/// A response that answers for its case: its job, and the blob of its description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundResponse {
    pub job: String,
    description: String,
    /// What is unusual of one that nobody named.
    pub unusual: Vec<&'static str>,
}

impl FoundResponse {
    /// That it was taken although it is of something else than the case, as there is no other.
    pub fn warning(&self) -> Option<WarningDocument> {
        let members: Vec<String> = self.unusual.iter().map(|name| format!("`{name}`")).collect();
        let detail = format!(
            "the only responses of the case were built with other members than usual, that of job {} with {}: the skin is not that of \
             `fem_linear` on the tissue of the case; post a job of kind `response` without them, or name the job to use it as it is",
            self.job,
            members.join(", ")
        );
        let numbers = serde_json::Map::new();
        let code = "other-response".to_owned();
        (!members.is_empty()).then_some(WarningDocument { code, detail, numbers })
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
    /// The blob of the description, and what was asked for; `None` where the response is stale.
    valid: Option<(String, Arc<ResponseDocument>)>,
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

    /// The response of a job, or else the newest one, that was built for the case as it is now. The usual ones come before those that
    /// were built to see what others would do, and then those with all columns that are needed.
    pub async fn find(
        &self,
        case: &str,
        wanted: ResponseChoice<'_>,
    ) -> Result<FoundResponse, MissingResponse> {
        let built = self.store.responses(case).await?;
        self.find_among(built, case, wanted).await
    }

    /// The same where the responses of the case have been looked up.
    pub async fn find_among(
        &self,
        built: Option<CaseResponses>,
        case: &str,
        wanted: ResponseChoice<'_>,
    ) -> Result<FoundResponse, MissingResponse> {
        let ResponseChoice { job, plan } = wanted;
        let built = built.ok_or(MissingResponse::NoCase)?;
        if let Some(job) = job
            && !built.jobs.iter().any(|built| built == job)
        {
            return Err(MissingResponse::NotOfCase { job: job.to_owned() });
        }
        let Some(newest) = built.jobs.first() else { return Err(MissingResponse::NotBuilt) };
        let mut best = None;
        for built_by in built.jobs.iter().filter(|built| job.is_none_or(|job| job == *built)) {
            let verdict = self.verdict(case, built.version, built_by).await?;
            let Some((description, spec)) = verdict.valid else { continue };
            let unusual = if job.is_some() { Vec::new() } else { spec.unusual() };
            let rank = (unusual.is_empty(), spec.follows(plan));
            if best.as_ref().is_none_or(|(other, _)| rank > *other) {
                let found = FoundResponse { job: built_by.clone(), description, unusual };
                best = Some((rank, found));
            }
            if rank == (true, true) {
                break;
            }
        }
        let stale = || MissingResponse::Stale { job: job.unwrap_or(newest).to_owned() };
        best.map(|(_, found)| found).ok_or_else(stale)
    }

    /// Whether a response answers, by its key and that of the case as it is now. The verdict holds for
    /// a version of the case, since meshes never change; the key is taken from documents and hashes of
    /// meshes, and no mesh is read.
    async fn verdict(&self, case: &str, version: i64, job: &str) -> Result<Verdict, StoreError> {
        let known = self.memory().verdicts.get(job).cloned();
        if let Some(verdict) = known.filter(|verdict| verdict.version == version) {
            return Ok(verdict);
        }
        let mut verdict = Verdict { version, valid: None };
        let Some(row) = self.store.case(case).await? else { return Ok(verdict) };
        verdict.version = row.version;
        if let Some(spec) = self.current(&row.document, job).await? {
            let file = self.store.job_file(job, DESCRIPTION_FILE).await?;
            verdict.valid = file.map(|file| (file.blob, Arc::new(spec)));
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
                contents.insert(id, document_of(&mesh)?.content_in_case());
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
        self.store.read_blob(&file.ok_or(StoreError::Erased)?.blob).await
    }
}
