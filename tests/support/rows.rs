//! Rows and bytes that tests of the store put into it.

use std::time::Duration;

use bytes::Bytes;
use facies::schema::key::{KeyDocument, Scope};
use facies::schema::wire::canonical::sha256_hex;
use facies::store::{Enqueued, JobRow, NewCase, NewJob, NewMesh, Published, PublishedFile, Store};
use tempfile::TempDir;

pub const LEASE: Duration = Duration::from_secs(60);
pub const PAUSE: Duration = Duration::from_millis(500);

/// Documents as the service reads them.
pub const CASE: &str = r#"{"units":"mm","volume":""}"#;
const ENGINE: &str = r#"{"name":"facies","version":"","target":"","profile":"release"}"#;
pub const RESULT: &str = r#"{"files":[],"warnings":[],"provenance":{"engine":
    {"name":"facies","version":"","target":"","profile":"release"},"spec_hash":"of a result","inputs":[],"threads":1,
    "determinism":"bitwise","timing":{"validate_s":0,"mesh_s":0,"assemble_s":0,"solve_s":0,"contact_s":0,"surface_s":0,
    "compare_s":0,"write_s":0,"total_s":0},"frame":"LPS","units":"mm","created":"","statement":""}}"#;

pub async fn store() -> (TempDir, Store) {
    let folder = TempDir::new().unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    (folder, store)
}

/// A job of no case; its document is read by nobody or by a test's own work.
pub fn new_job(document: &str, hash: &str) -> NewJob {
    NewJob {
        id: uuid::Uuid::now_v7().to_string(),
        kind: "predict",
        priority: 0,
        case_id: None,
        shared_cases: Vec::new(),
        document: document.into(),
        spec_hash: hash.into(),
        rows_key: None,
        truths: None,
        engine: ENGINE.into(),
        tags: vec!["a".into()],
        mesh_ids: vec![],
        learns_from: None,
        traceparent: None,
        waits_for: None,
    }
}

/// A case without meshes, plans or jobs.
pub fn new_case() -> NewCase {
    NewCase {
        id: uuid::Uuid::now_v7().to_string(),
        document: CASE.into(),
        report: "null".into(),
        tags: vec![],
        mesh_ids: vec![],
        meshes: vec![],
        meshing: None,
    }
}

/// A result without meshes.
pub fn result<'a>(result: &'a str, files: &'a [PublishedFile]) -> Published<'a> {
    Published { result, files, meshes: &[], case: None }
}

pub async fn enqueue(store: &Store, hash: &str) -> String {
    let job = new_job("{}", hash);
    assert_eq!(store.enqueue(&job, 100).await.unwrap(), Enqueued::Accepted);
    job.id
}

pub async fn job(store: &Store, id: &str) -> JobRow {
    store.job(id).await.unwrap().unwrap()
}

pub fn file(content: &'static str) -> PublishedFile {
    let bytes = Bytes::from_static(content.as_bytes());
    PublishedFile {
        name: "result.json".into(),
        media_type: "application/json".into(),
        sha256: sha256_hex(&bytes),
        bytes,
    }
}

/// How many places hold bytes.
pub async fn blob_count(store: &Store) -> usize {
    let findings = store.fsck(false).await.unwrap();
    assert!(findings.is_clean(), "{findings:?}");
    findings.objects
}

/// As the service reads it.
const MESH_REPORT: &str = r#"{"id":"","sha256":"","bytes":0,"format":"vtu","created":"","report":{"kind":"volume",
    "nodes":0,"triangles":0,"bounding_box":[0,0,0,0,0,0],"diagonal":0,"warnings":[]}}"#;

/// A mesh of these bytes; other options make another mesh of the same bytes.
pub fn mesh(content: &'static str, options: &str) -> NewMesh {
    let bytes = Bytes::from_static(content.as_bytes());
    NewMesh {
        id: uuid::Uuid::now_v7().to_string(),
        sha256: sha256_hex(&bytes),
        options: options.into(),
        blob: sha256_hex(&bytes),
        bytes,
        standalone: true,
        report: MESH_REPORT.into(),
    }
}

/// Keys of one tenant that may read.
pub async fn make_keys(store: &Store, count: usize) {
    let wanted = KeyDocument { label: "test".into(), scopes: [Scope::Read].into(), days: None };
    for _ in 0..count {
        store.make_key(&wanted).await.unwrap();
    }
}

/// Jobs whose worker was lost in their only attempt.
pub async fn lose_jobs(store: &Store, count: usize) {
    for number in 0..count {
        enqueue(store, &format!("lost {number}")).await;
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert!(store.lose(&lease, 1, PAUSE, r#"{"class":"infrastructure"}"#).await.unwrap());
    }
}
