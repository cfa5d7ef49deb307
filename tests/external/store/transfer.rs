//! A deployment moves from one engine to the other and back, and comes out of its backup as it went in.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use facies::config::DatabaseLocation;
use facies::schema::key::{KeyDocument, Scope};
use facies::store::{
    AddedCase, AuditedAction, Dismissal, MemberRow, NewCase, NewCohort, Published, Store,
    StoreError,
};
use serde_json::{Value, json};

use crate::deployments::Deployment;
use crate::rows::mesh;
use crate::rows::{CASE, LEASE, RESULT, blob_count, enqueue, file, new_case, new_job};
use crate::store::made::made;
use crate::support::trials::trials;

trials! {
    on_both {
        an_export_has_every_table
        an_import_is_all_or_nothing
        a_row_of_an_export_that_does_not_fit_is_refused_before_anything_is_stored
        what_the_service_could_not_read_is_refused_with_its_row_and_column
        rows_of_two_tenants_that_belong_together_and_blobs_that_are_links_are_refused
        an_export_with_other_columns_than_the_tables_is_refused
    }
    on_shared {
        a_deployment_moves_to_postgresql_and_back
    }
}

const CONSENT: &str = r#"{"statement":"a form","uses":["learn"]}"#;

/// Something in every table, with every kind of value.
async fn fill(store: &Store) {
    let case_mesh = mesh("of the case", "units=mm");
    let case = NewCase {
        document: CASE.replace('{', "{\"name\":\"Ünï\\u0000\","),
        tags: vec!["~".into(), "a".into()],
        mesh_ids: vec![case_mesh.id.clone()],
        meshes: vec![case_mesh.clone()],
        ..new_case()
    };
    assert_eq!(store.add_case(&case, 100).await.unwrap(), AddedCase::Stored);
    assert!(store.add_plan(&case.id, &uuid::Uuid::now_v7().to_string(), "{}").await.unwrap());
    let erased = uuid::Uuid::now_v7().to_string();
    assert!(store.add_plan(&case.id, &erased, "{}").await.unwrap());
    store.delete_plan((&case.id, &erased), None).await.unwrap();
    let key = KeyDocument { label: "a".into(), scopes: [Scope::Read].into(), days: None };
    store.make_key(&key).await.unwrap();
    let audited = AuditedAction { action: "a deed".into(), ..AuditedAction::default() };
    let begun = store.begin_action(&audited).await.unwrap();
    store.end_action(begun, "", "done").await.unwrap();
    store.chain_actions().await.unwrap();
    store.begin_action(&audited).await.unwrap();
    store.reserve("a key", "a request", &case.id).await.unwrap();
    let done = enqueue(store, "done").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let point = facies::store::Point { residual: Some(1.0 / 3.0), ..Default::default() };
    assert!(store.renew(&lease, LEASE, &point).await.unwrap());
    let (files, meshes) = ([file("a result")], [made("of the job")]);
    let result = Published { result: RESULT, files: &files, meshes: &meshes, case: None };
    assert!(store.publish(&lease, result).await.unwrap());
    let removed = enqueue(store, "removed").await;
    let member = |number: i64, job: &String| MemberRow {
        number,
        case_id: case.id.clone(),
        job_id: job.clone(),
        mesh_id: case_mesh.id.clone(),
        document: r#"{"prediction":"","actual":""}"#.into(),
    };
    let members = vec![member(1, &done), member(2, &removed)];
    let (id, name) = (uuid::Uuid::now_v7().to_string(), "blocks".into());
    let cohort = NewCohort { id, name, consent: Some(CONSENT.into()), members };
    assert!(store.add_cohort(&cohort).await.unwrap());
    let mut waiting = new_job("{}", "waiting");
    waiting.learns_from = Some((cohort.id, 1));
    waiting.shared_cases = vec![case.id.clone()];
    waiting.mesh_ids = vec![case_mesh.id];
    store.enqueue(&waiting, 100).await.unwrap();
    for ended in [Dismissal::Dismissed, Dismissal::Removed] {
        assert_eq!(store.dismiss(&removed).await.unwrap(), ended);
    }
}

/// The content of an export, whatever the order of its rows.
fn content(folder: &Path) -> BTreeMap<String, BTreeSet<Vec<u8>>> {
    let lines = |path: &Path| {
        let bytes = std::fs::read(path).unwrap();
        bytes.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect()
    };
    let names = |folder: &Path| -> Vec<_> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
    };
    let files = names(folder).into_iter().chain(names(&folder.join("blobs")));
    let files = files.filter(|path| path.is_file());
    files.map(|path| (path.file_name().unwrap().to_str().unwrap().into(), lines(&path))).collect()
}

async fn a_deployment_moves_to_postgresql_and_back(shared: Deployment) {
    let (first, last) = (Deployment::embedded().await, Deployment::embedded().await);
    let store = first.open().await;
    fill(&store).await;
    let folders = ["1", "2", "3"].map(|name| first.folder().join(name));
    let moved = store.export(&folders[0]).await.unwrap();
    assert_eq!((moved.rows, moved.blobs), (31, 3));
    for (on, [from, to]) in [(&shared, [0, 1]), (&last, [1, 2])] {
        let store = on.open().await;
        assert_eq!(store.import(&folders[from]).await.unwrap(), moved);
        assert_eq!(store.export(&folders[to]).await.unwrap(), moved);
        assert_eq!(blob_count(&store).await, 3);
        // The waiting job is taken up where it arrived.
        assert!(store.claim(LEASE).await.unwrap().is_some());
    }
    assert_eq!(content(&folders[0]), content(&folders[1]));
    assert_eq!(content(&folders[0]), content(&folders[2]));
}

async fn an_export_has_every_table(on: Deployment) {
    let store = on.open().await;
    let tables = match on.places.database {
        DatabaseLocation::Embedded => "SELECT name FROM sqlite_master WHERE type = 'table'",
        DatabaseLocation::Server { .. } => {
            "SELECT tablename::text FROM pg_tables WHERE schemaname = 'public'"
        }
    };
    let tables = on.texts(tables).await;
    let folder = on.folder().join("export");
    store.export(&folder).await.unwrap();
    for table in tables {
        let of_the_deployment = [
            "blobs",
            "unfinished_blobs",
            "discarded_blobs",
            "identity",
            "seen_clock",
            "_sqlx_migrations",
        ];
        let left_out = of_the_deployment.contains(&table.as_str()) || table.starts_with("sqlite_");
        let exported = folder.join(format!("{table}.ndjson")).exists();
        assert_eq!(exported, !left_out, "{table}");
    }
}

async fn an_import_is_all_or_nothing(on: Deployment) {
    let (source, folder) = (Deployment::embedded().await, on.folder().join("export"));
    let exporting = source.open().await;
    fill(&exporting).await;
    exporting.export(&folder).await.unwrap();
    let store = on.open().await;

    // Nothing refers to a tag, so that only the manifest knows how many there were.
    let tags = folder.join("job_tags.ndjson");
    let whole = std::fs::read_to_string(&tags).unwrap();
    let cut = whole.trim_end().rsplit_once('\n').unwrap().0;
    std::fs::write(&tags, cut).unwrap();
    let error = store.import(&folder).await.unwrap_err();
    assert!(matches!(error, StoreError::Export(_)), "{error}");
    assert!(store.cases("", None, 10).await.unwrap().is_empty());

    std::fs::write(&tags, whole).unwrap();

    // A blob whose bytes are not those that its name says, and one that is missing.
    let blob = std::fs::read_dir(folder.join("blobs")).unwrap().next().unwrap().unwrap().path();
    let bytes = std::fs::read(&blob).unwrap();
    std::fs::write(&blob, b"other").unwrap();
    let error = store.import(&folder).await.unwrap_err().to_string();
    assert!(error.contains("damaged") && error.contains(&blob.display().to_string()), "{error}");
    std::fs::remove_file(&blob).unwrap();
    let error = store.import(&folder).await.unwrap_err().to_string();
    assert!(error.contains(&blob.display().to_string()), "{error}");
    assert!(store.cases("", None, 10).await.unwrap().is_empty());
    std::fs::write(&blob, bytes).unwrap();

    store.import(&folder).await.unwrap();
    let error = store.import(&folder).await.unwrap_err();
    assert!(matches!(error, StoreError::NotEmpty { .. }), "{error}");
}

async fn a_row_of_an_export_that_does_not_fit_is_refused_before_anything_is_stored(on: Deployment) {
    let (source, folder) = (Deployment::embedded().await, on.folder().join("export"));
    let exporting = source.open().await;
    let row = mesh("a mesh", "units=mm");
    assert!(exporting.add_mesh(&row).await.unwrap());
    exporting.export(&folder).await.unwrap();
    let store = on.open().await;
    let meshes = folder.join("meshes.ndjson");
    let whole = std::fs::read_to_string(&meshes).unwrap();
    let (blob, end) = (format!("\"{}\"", row.blob), "]\n");
    // Its hash is also that of the bytes as they came: every one of them is replaced.
    let faults = [
        (blob.as_str(), "\"../../../victim\"", "its blob is none of those of the manifest"),
        (blob.as_str(), "5", "holds text"),
        ("\"default\"", "{}", "column tenant holds text"),
        (end, ",1]\n", "values for"),
    ];
    for (from, to, wanted) in faults {
        let changed = whole.replace(from, to);
        assert_ne!(changed, whole, "{wanted}");
        // The first line says what the columns are.
        let head = whole.lines().next().unwrap();
        let changed = format!("{head}\n{}", changed.split_once('\n').unwrap().1);
        std::fs::write(&meshes, changed).unwrap();
        let error = store.import(&folder).await.unwrap_err().to_string();
        assert!(error.contains("meshes.ndjson, line 2 (row 1): "), "{error}");
        assert!(error.contains(wanted), "{error}");
        assert_eq!(blob_count(&store).await, 0);
    }
    std::fs::write(&meshes, whole).unwrap();
    assert_eq!(store.import(&folder).await.unwrap().blobs, 1);
}

/// The lines of a table of an export, as JSON.
fn lines(folder: &Path, table: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.join(format!("{table}.ndjson"))).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn write(folder: &Path, table: &str, lines: &[Value]) {
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.join(format!("{table}.ndjson")), text).unwrap();
}

/// What an import says where the lines of one table are others.
async fn refusal(store: &Store, folder: &Path, table: &str, lines: &[Value]) -> String {
    let file = folder.join(format!("{table}.ndjson"));
    let whole = std::fs::read(&file).unwrap();
    write(folder, table, lines);
    let error = store.import(folder).await.unwrap_err();
    assert!(matches!(error, StoreError::Export(_)), "{table}: {error}");
    assert_eq!(blob_count(store).await, 0, "{table}: {error}");
    assert!(store.tenants(None, 1).await.unwrap().is_empty(), "{table}: {error}");
    std::fs::write(&file, whole).unwrap();
    error.to_string()
}

/// An export of something in every table, and a deployment with nothing in it.
async fn exported(on: &Deployment) -> (std::path::PathBuf, Store) {
    let (source, folder) = (Deployment::embedded().await, on.folder().join("export"));
    let exporting = source.open().await;
    fill(&exporting).await;
    exporting.export(&folder).await.unwrap();
    (folder, on.open().await)
}

fn place_of(head: &Value, column: &str) -> usize {
    let columns = head["columns"].as_array().unwrap();
    columns.iter().position(|pair| pair[0] == column).unwrap()
}

async fn what_the_service_could_not_read_is_refused_with_its_row_and_column(on: Deployment) {
    let (folder, store) = exported(&on).await;
    let faults = [
        ("jobs", "kind", json!("abc"), "column kind holds a kind of job"),
        ("jobs", "status", json!("abc"), "column status holds the status of a job"),
        ("jobs", "engine", json!("[]"), "column engine holds the program of a job, and that of "),
        ("jobs", "truths", json!("{}"), "column truths holds the costs of a study, and that of "),
        ("job_events", "status", json!(""), "column status holds the status of a job"),
        ("jobs", "document", json!("[]"), "column document holds the input of a job, and that of "),
        ("jobs", "error", json!("{}"), "column error holds the error of a job, and that of "),
        ("jobs", "result", json!("{}"), "column result holds the result of a job, and that of "),
        ("cases", "document", json!("{}"), "column document holds a case, and that of "),
        ("cases", "report", json!("{}"), "column report holds the check of a case or null, and "),
        ("plans", "document", json!("5"), "column document holds a plan, and that of "),
        ("cohorts", "consent", json!("{}"), "column consent holds a consent, and that of "),
        ("cohort_members", "document", json!("{}"), "column document holds a member of a cohort"),
        ("meshes", "report", json!("{}"), "column report holds the report of a mesh"),
        (
            "job_files",
            "name",
            json!("../x.vtp"),
            "column name holds the name of a file of a result",
        ),
        ("job_files", "media_type", json!("text/html"), "column media_type holds application/json"),
        ("job_files", "bytes", json!(7), "column bytes holds 7, and the blob has 8 bytes"),
        ("job_files", "bytes", json!(-1), "column bytes holds integers from 0, not -1"),
        ("jobs", "attempt", json!(-1), "column attempt holds integers from 0, not -1"),
        (
            "jobs",
            "created",
            json!(9_000_000_000_000_000_000_i64),
            "column created holds times in ms",
        ),
        ("keys", "scopes", json!("root"), "column scopes holds scopes"),
        ("meshes", "id", json!(null), "column id must not be null"),
        ("audit", "outcome", json!(null), "column outcome must not be null"),
        ("plans", "case_id", json!("nobody"), "it refers to a row that is not there"),
    ];
    for (table, column, value, wanted) in faults {
        let mut changed = lines(&folder, table);
        let place = place_of(&changed[0], column);
        changed[1][place] = value;
        let error = refusal(&store, &folder, table, &changed).await;
        assert!(error.contains(&format!("{table}.ndjson, line 2 (row 1): {wanted}")), "{error}");
    }
    let mut changed = lines(&folder, "jobs");
    let id = place_of(&changed[0], "id");
    changed[2][id] = changed[1][id].clone();
    let error = refusal(&store, &folder, "jobs", &changed).await;
    assert!(
        error.contains("jobs.ndjson, line 3 (row 2): a row before it has the same key"),
        "{error}"
    );

    // As that of a case which is being meshed.
    let mut changed = lines(&folder, "cases");
    let report = place_of(&changed[0], "report");
    changed[1][report] = json!("null");
    write(&folder, "cases", &changed);
    store.import(&folder).await.unwrap();
}

async fn rows_of_two_tenants_that_belong_together_and_blobs_that_are_links_are_refused(
    on: Deployment,
) {
    let (folder, store) = exported(&on).await;
    let mut changed = lines(&folder, "meshes");
    let tenant = place_of(&changed[0], "tenant");
    changed[1][tenant] = json!("other");
    let error = refusal(&store, &folder, "meshes", &changed).await;
    // Where the tenants are stated, and what ties the rows together.
    let mesh = changed[1][place_of(&changed[0], "id")].as_str().unwrap();
    let wanted = [
        "cases.ndjson, line 2 (row 1): ".to_owned(),
        " is of tenant \"default\", and ".to_owned(),
        format!("/meshes.ndjson, line 2 (row 1): {mesh} of \"other\"; by case_meshes.ndjson they "),
    ];
    assert!(wanted.iter().all(|words| error.contains(words)), "{wanted:?}: {error}");
    let blob = std::fs::read_dir(folder.join("blobs")).unwrap().next().unwrap().unwrap().path();
    let moved = folder.join("moved");
    std::fs::rename(&blob, &moved).unwrap();
    std::os::unix::fs::symlink(&moved, &blob).unwrap();
    let error = store.import(&folder).await.unwrap_err().to_string();
    assert!(error.contains(&format!("{} is no plain file", blob.display())), "{error}");
}

async fn an_export_with_other_columns_than_the_tables_is_refused(on: Deployment) {
    let (folder, store) = exported(&on).await;
    let whole = lines(&folder, "tenants");
    let columns = whole[0]["columns"].as_array().unwrap();
    let with = |added: Value| {
        let columns = columns.iter().cloned().chain([added]).collect::<Vec<_>>();
        let mut changed = vec![json!({ "columns": columns })];
        for row in &whole[1..] {
            let mut row = row.clone();
            row.as_array_mut().unwrap().push(json!(null));
            changed.push(row);
        }
        changed
    };
    let mut shorter = whole.clone();
    shorter[0]["columns"].as_array_mut().unwrap().pop();
    shorter[1..].iter_mut().for_each(|row| drop(row.as_array_mut().unwrap().pop()));
    let last = columns.last().unwrap()[0].as_str().unwrap();
    let mut typed = whole.clone();
    typed[0]["columns"][place_of(&whole[0], "served")][1] = json!("text");
    let faults = [
        (with(json!(["name", "text"])), "column name is there twice".to_owned()),
        (with(json!(["colour", "text"])), "tenants has no column colour".to_owned()),
        (shorter, format!("column {last} is missing")),
        (typed, "column served holds integers, not text".to_owned()),
    ];
    for (changed, wanted) in faults {
        let error = refusal(&store, &folder, "tenants", &changed).await;
        assert!(error.contains(&format!("tenants.ndjson: {wanted}")), "{error}");
    }
}
