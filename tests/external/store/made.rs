//! Meshes that jobs made: published with the result or not at all, and erased with it.

use facies::store::{
    AddedCase, Change, Dismissal, MadeMesh, MeshDeletion, NewMesh, Published, Store, StoreError,
};

use crate::deployments::Deployment;
use crate::rows::{LEASE, RESULT, blob_count, enqueue, file, mesh, new_case, new_job};
use crate::support::trials::trials;

trials! {
    on_both {
        a_fenced_attempt_stores_no_mesh
        a_mesh_that_came_or_went_meanwhile_is_looked_for_again
        a_case_that_is_erased_while_its_job_publishes_leaves_no_mesh
        a_mesh_that_is_lost_is_made_again_by_its_job
        a_mesh_that_a_job_made_is_not_too_old_while_the_job_is_there
    }
}

/// A mesh as a job makes it.
pub fn made(content: &'static str) -> MadeMesh {
    let mesh = NewMesh { standalone: false, ..mesh(content, "units=mm") };
    MadeMesh { mesh, known: None }
}

fn published(meshes: &[MadeMesh]) -> Published<'_> {
    Published { result: RESULT, files: &[], meshes, case: None }
}

/// The mesh as a worker looks for it.
async fn looked_for(store: &Store, made: &MadeMesh) -> MadeMesh {
    let mesh = made.mesh.clone();
    let known = store.mesh_by_content(&mesh.sha256, &mesh.options).await.unwrap();
    MadeMesh { mesh, known }
}

async fn a_fenced_attempt_stores_no_mesh(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::Dismissed);
    let made = made("late");
    assert!(!store.publish(&lease, published(std::slice::from_ref(&made))).await.unwrap());
    assert!(store.mesh(&made.mesh.id).await.unwrap().is_none());
    assert_eq!((blob_count(&store).await, on.objects().len()), (0, 0));
}

async fn a_mesh_that_came_or_went_meanwhile_is_looked_for_again(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let (first, uploaded) = (made("same"), mesh("same", "units=mm"));
    assert!(store.add_mesh(&uploaded).await.unwrap());
    let error = store.publish(&lease, published(std::slice::from_ref(&first))).await.unwrap_err();
    assert!(matches!(error, StoreError::Contended), "{error}");
    let known = looked_for(&store, &first).await;
    assert_eq!(known.id(), uploaded.id);
    assert_eq!(store.delete_mesh(&uploaded.id).await.unwrap(), MeshDeletion::Deleted);
    let error = store.publish(&lease, published(&[known])).await.unwrap_err();
    assert!(matches!(error, StoreError::Contended), "{error}");
    assert_eq!(blob_count(&store).await, 0, "what was not published is not there");
    assert!(store.holds(&lease).await.unwrap());
    assert!(store.publish(&lease, published(std::slice::from_ref(&first))).await.unwrap());
    assert_eq!(store.read_blob(&first.mesh.blob).await.unwrap(), "same");
    assert_eq!(store.dismiss(&id).await.unwrap(), Dismissal::Removed);
    assert!(store.erased(&first.mesh.id).await.unwrap().is_some());
    assert_eq!(on.objects().len(), 0);
}

async fn a_case_that_is_erased_while_its_job_publishes_leaves_no_mesh(on: Deployment) {
    let store = on.open().await;
    let other = on.again(&store).await;
    for round in 0..20 {
        let case = new_case();
        assert_eq!(store.add_case(&case, 100).await.unwrap(), AddedCase::Stored);
        let mut job = new_job("{}", &format!("job {round}"));
        job.case_id = Some(case.id.clone());
        store.enqueue(&job, 100).await.unwrap();
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        let (made, files) = ([made("of the job")], [file("a result")]);
        let result = Published { result: "{}", files: &files, meshes: &made, case: None };
        let (published, erased) =
            tokio::join!(store.publish(&lease, result), other.delete_case(&case.id, None));
        published.unwrap();
        assert_eq!(erased.unwrap(), Change::Done);
        assert!(store.mesh(&made[0].mesh.id).await.unwrap().is_none(), "round {round}");
    }
    assert_eq!(blob_count(&store).await, 0);
}

async fn a_mesh_that_is_lost_is_made_again_by_its_job(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let made = made("mesh");
    assert!(store.publish(&lease, published(std::slice::from_ref(&made))).await.unwrap());
    assert!(store.fsck(true).await.unwrap().is_clean());
    std::fs::remove_file(&on.objects()[0]).unwrap();
    let findings = store.fsck(false).await.unwrap();
    let lost = &findings.dangling[0];
    assert_eq!((&lost.meshes, &lost.jobs), (&vec![made.mesh.id.clone()], &vec![id]));
    assert_eq!(store.repair(&findings).await.unwrap().jobs, 1);
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let again = looked_for(&store, &made).await;
    assert!(store.publish(&lease, published(&[again])).await.unwrap());
    assert!(store.fsck(true).await.unwrap().is_clean());
    assert_eq!(store.read_blob(&made.mesh.blob).await.unwrap(), "mesh");
}

async fn a_mesh_that_a_job_made_is_not_too_old_while_the_job_is_there(on: Deployment) {
    let store = on.open().await;
    enqueue(&store, "a").await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.publish(&lease, published(&[made("mesh")])).await.unwrap());
    store.retain(Some(1)).await.unwrap();
    on.execute("UPDATE meshes SET created = 1").await;
    assert_eq!(store.erase_old().await.unwrap(), 0);
    on.execute("UPDATE jobs SET updated = 1").await;
    assert_eq!(store.erase_old().await.unwrap(), 1, "the job, and the mesh with it");
    assert_eq!(blob_count(&store).await, 0);
}
