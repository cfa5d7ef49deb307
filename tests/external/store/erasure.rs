//! What is erased takes with it what only it referred to, in whatever order things go, and leaves no trace in files.

use std::path::{Path, PathBuf};

use facies::store::{
    AddedCase, Change, CohortModelRow, Dismissal, LeftRow, MemberRow, NewCase, NewCohort, NewJob,
    NewMesh, Store, Unreached,
};

use crate::deployments::Deployment;
use crate::rows::{blob_count, mesh, new_case, new_job};
use crate::support::trials::trials;

trials! {
    on_both {
        a_mesh_of_an_erased_case_goes_with_the_last_job_that_reads_it
        a_mesh_of_an_erased_case_goes_with_the_case_whose_job_reads_it
        a_mesh_that_somebody_uploaded_stays_when_its_job_goes
        a_mesh_that_nothing_leads_to_is_found_and_erased
        a_member_leaves_its_cohorts_with_its_case_and_with_its_prediction
        a_mesh_of_an_erased_case_goes_with_the_last_cohort_that_has_it
    }
    alone {
        names_of_what_was_erased_are_in_no_file
    }
}

fn of_a_case(content: &'static str) -> NewMesh {
    NewMesh { standalone: false, ..mesh(content, "units=mm") }
}

async fn case(store: &Store, document: &str, meshes: &[&NewMesh]) -> String {
    let case = NewCase {
        document: document.into(),
        mesh_ids: meshes.iter().map(|mesh| mesh.id.clone()).collect(),
        meshes: meshes.iter().map(|mesh| (*mesh).clone()).collect(),
        ..new_case()
    };
    assert_eq!(store.add_case(&case, 100).await.unwrap(), AddedCase::Stored);
    case.id
}

/// A job that reads a mesh and has ended.
async fn ended(store: &Store, reads: &NewMesh, of_case: Option<&String>) -> String {
    let job = NewJob {
        mesh_ids: vec![reads.id.clone()],
        case_id: of_case.cloned(),
        ..new_job("{}", &reads.id)
    };
    store.enqueue(&job, 99).await.unwrap();
    assert_eq!(store.dismiss(&job.id).await.unwrap(), Dismissal::Dismissed);
    job.id
}

async fn is_erased(store: &Store, mesh: &NewMesh) -> bool {
    let erased = store.erased(&mesh.id).await.unwrap().is_some();
    assert_eq!(store.mesh(&mesh.id).await.unwrap().is_none(), erased);
    erased
}

async fn a_mesh_of_an_erased_case_goes_with_the_last_job_that_reads_it(on: Deployment) {
    let store = on.open().await;
    let bone = of_a_case("bone");
    let case = case(&store, "{}", &[&bone]).await;
    let job = ended(&store, &bone, None).await;
    assert_eq!(store.delete_case(&case, None).await.unwrap(), Change::Done);
    assert!(!is_erased(&store, &bone).await, "a job reads it");
    assert_eq!(store.dismiss(&job).await.unwrap(), Dismissal::Removed);
    assert!(is_erased(&store, &bone).await);
    assert_eq!(blob_count(&store).await, 0);
}

async fn a_mesh_of_an_erased_case_goes_with_the_case_whose_job_reads_it(on: Deployment) {
    let store = on.open().await;
    let (face, other) = (of_a_case("face"), of_a_case("other"));
    let own = case(&store, "{}", &[&other]).await;
    let read = case(&store, "{}", &[&face]).await;
    ended(&store, &face, Some(&own)).await;
    assert_eq!(store.delete_case(&read, None).await.unwrap(), Change::Done);
    assert!(!is_erased(&store, &face).await, "a job reads it");
    assert_eq!(store.delete_case(&own, None).await.unwrap(), Change::Done);
    assert!(is_erased(&store, &face).await && is_erased(&store, &other).await);
    assert_eq!(blob_count(&store).await, 0);
}

async fn a_mesh_that_somebody_uploaded_stays_when_its_job_goes(on: Deployment) {
    let store = on.open().await;
    let uploaded = mesh("uploaded", "units=mm");
    assert!(store.add_mesh(&uploaded).await.unwrap());
    let job = ended(&store, &uploaded, None).await;
    assert_eq!(store.dismiss(&job).await.unwrap(), Dismissal::Removed);
    assert!(!is_erased(&store, &uploaded).await);
}

/// A cohort of predictions of cases, with a mesh for each.
async fn cohort(store: &Store, of: &[(&String, &String, &NewMesh)]) -> String {
    let row = |(number, (case, job, mesh)): (i64, &(&String, &String, &NewMesh))| MemberRow {
        number,
        case_id: (*case).clone(),
        job_id: (*job).clone(),
        mesh_id: mesh.id.clone(),
        document: "{}".into(),
    };
    let members = (1..).zip(of).map(row).collect();
    let (id, name) = (uuid::Uuid::now_v7().to_string(), "patients".into());
    let cohort = NewCohort { id: id.clone(), name, consent: None, members };
    assert!(store.add_cohort(&cohort).await.unwrap());
    id
}

async fn version(store: &Store, cohort: &str) -> (i64, i64) {
    let row = store.cohort(cohort).await.unwrap().unwrap();
    (row.version, row.members)
}

async fn a_member_leaves_its_cohorts_with_its_case_and_with_its_prediction(on: Deployment) {
    let store = on.open().await;
    let mut cases = Vec::new();
    for name in ["a", "b", "c"] {
        let face = mesh(name, "units=mm");
        assert!(store.add_mesh(&face).await.unwrap());
        let id = case(&store, "{}", &[]).await;
        let prediction = ended(&store, &face, Some(&id)).await;
        cases.push((id, prediction, face));
    }
    let all: Vec<_> = cases.iter().map(|(case, job, mesh)| (case, job, mesh)).collect();
    let (whole, part) = (cohort(&store, &all).await, cohort(&store, &all[1..]).await);
    let model = NewJob {
        shared_cases: cases.iter().map(|(case, ..)| case.clone()).collect(),
        learns_from: Some((whole.clone(), 1)),
        ..new_job("{}", "model")
    };
    store.enqueue(&model, 99).await.unwrap();
    assert_eq!(store.of_tenant("ward").cohort(&whole).await.unwrap().map(|row| row.id), None);
    assert_eq!(store.of_tenant("ward").cohort_members(&whole).await.unwrap().len(), 0);
    assert_eq!(store.of_tenant("ward").cohort_models(&whole).await.unwrap().len(), 0);

    let (gone, kept) = (&cases[0].0, &cases[1]);
    assert_eq!(store.delete_case(gone, None).await.unwrap(), Change::Done);
    assert_eq!((version(&store, &whole).await, version(&store, &part).await), ((2, 2), (1, 2)));
    let erased = CohortModelRow { job_id: model.id, version: 1, status: None };
    assert_eq!(store.cohort_models(&whole).await.unwrap(), [erased]);

    assert_eq!(store.dismiss(&kept.1).await.unwrap(), Dismissal::Removed);
    assert_eq!((version(&store, &whole).await, version(&store, &part).await), ((3, 1), (2, 1)));
    let left = |case: &String, version| LeftRow { case_id: case.clone(), version };
    assert_eq!(store.left_cohort(&whole).await.unwrap(), [left(gone, 2), left(&kept.0, 3)]);
    assert_eq!(store.left_cohort(&part).await.unwrap(), [left(&kept.0, 2)]);
    assert_eq!(store.delete_cohort(&whole, 2).await.unwrap(), Change::OtherVersion(3));
    assert_eq!(store.delete_cohort(&whole, 3).await.unwrap(), Change::Done);
    assert!(store.erased(&whole).await.unwrap().is_some());
}

async fn a_mesh_of_an_erased_case_goes_with_the_last_cohort_that_has_it(on: Deployment) {
    let store = on.open().await;
    let (face, other) = (of_a_case("face"), of_a_case("other"));
    let (own, came_with) =
        (case(&store, "{}", &[&other]).await, case(&store, "{}", &[&face]).await);
    let prediction = ended(&store, &other, Some(&own)).await;
    let cohort = cohort(&store, &[(&own, &prediction, &face)]).await;
    assert_eq!(store.delete_case(&came_with, None).await.unwrap(), Change::Done);
    assert!(!is_erased(&store, &face).await, "a cohort has it");
    assert_eq!(store.delete_cohort(&cohort, 1).await.unwrap(), Change::Done);
    assert!(is_erased(&store, &face).await);
    assert_eq!(store.delete_case(&own, None).await.unwrap(), Change::Done);
    assert_eq!(blob_count(&store).await, 0);
}

/// As the erasures of an earlier program left them.
async fn a_mesh_that_nothing_leads_to_is_found_and_erased(on: Deployment) {
    let store = on.open().await.of_tenant("ward");
    let face = of_a_case("face");
    assert!(store.add_mesh(&face).await.unwrap());
    let findings = store.fsck(false).await.unwrap();
    let unreached = [Unreached { mesh: face.id.clone(), tenant: "ward".into() }];
    assert_eq!(findings.unreached, unreached);
    assert!(!findings.is_clean());
    assert_eq!(store.repair(&findings).await.unwrap().erased, 1);
    assert!(is_erased(&store, &face).await);
    assert_eq!(blob_count(&store).await, 0);
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// The files that hold a text.
fn holding(folder: &Path, text: &str) -> Vec<PathBuf> {
    let holds = |path: &PathBuf| {
        let bytes = std::fs::read(path).unwrap();
        bytes.windows(text.len()).any(|part| part == text.as_bytes())
    };
    files(folder).into_iter().filter(holds).collect()
}

async fn names_of_what_was_erased_are_in_no_file() {
    const NAME: &str = "Wilhelmine Mustermann";
    let on = Deployment::embedded().await;
    let store = on.open().await;
    let mut cases = Vec::new();
    for number in 0..50 {
        // Longer than a page too, so that some of it lies in pages of its own.
        let document =
            format!("{{\"name\":\"{}{number}\"}}", format!("{NAME} ").repeat(1 + 9 * number));
        cases.push(case(&store, &document, &[]).await);
    }
    assert!(store.wipe().await.unwrap());
    assert!(!holding(&on.places.data, NAME).is_empty());
    for id in &cases[..40] {
        store.delete_case(id, None).await.unwrap();
    }
    for id in &cases[40..] {
        store.delete_case(id, None).await.unwrap();
        assert!(store.wipe().await.unwrap());
    }
    assert_eq!(holding(&on.places.data, NAME), [] as [PathBuf; 0]);
    store.close().await;
}
