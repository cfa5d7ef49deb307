//! Rows and bytes: what belongs together stays together, what nobody refers to goes.

use facies::config::{BlobLocation, StorageLocations};
use facies::schema::job::JobStatus;
use facies::schema::wire::canonical::sha256_hex;
use facies::store::{MeshDeletion, Store, StoreError};

use crate::deployments::Deployment;
use crate::rows::{LEASE, RESULT, blob_count, enqueue, file, job, mesh, result};
use crate::support::trials::trials;

trials! {
    on_both {
        bytes_that_were_announced_and_never_referred_to_are_swept
        a_removal_that_was_broken_off_is_finished
        bytes_that_came_late_to_a_place_that_was_discarded_are_swept
        bytes_that_changed_or_are_lost_are_never_served
        bytes_that_no_row_knows_stay_until_a_repair
        a_repair_finds_bytes_again_and_has_lost_results_solved_again
        the_same_bytes_stay_as_long_as_somebody_refers_to_them
    }
    on_shared {
        a_host_whose_blobs_are_not_those_of_the_database_is_named
        a_bucket_that_does_not_exist_is_named
    }
    alone {
        a_start_removes_what_a_dead_process_left
        a_data_folder_serves_one_process
        blobs_beside_the_data_folder_have_one_database
    }
}

/// A job that has published one file; its id.
async fn published(store: &Store, content: &'static str) -> String {
    let id = enqueue(store, content).await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.publish(&lease, result(RESULT, &[file(content)])).await.unwrap());
    id
}

async fn bytes_that_were_announced_and_never_referred_to_are_swept(on: Deployment) {
    let store = on.open().await;
    assert!(store.add_mesh(&mesh("a", "1")).await.unwrap());
    assert!(store.add_mesh(&mesh("b", "1")).await.unwrap());
    on.execute("DELETE FROM meshes").await;
    on.execute(&format!("UPDATE blobs SET announced = 1 WHERE sha256 = '{}'", sha256_hex(b"a")))
        .await;
    // The other may be about to be referred to.
    assert_eq!(store.sweep_old_blobs().await.unwrap(), 1);
    assert_eq!(blob_count(&store).await, 1);
    assert_eq!(on.objects().len(), 1);
}

async fn a_removal_that_was_broken_off_is_finished(on: Deployment) {
    let store = on.open().await;
    assert!(store.add_mesh(&mesh("a", "1")).await.unwrap());
    on.execute("INSERT INTO discarded_blobs SELECT place, 1 FROM blobs").await;
    on.execute("DELETE FROM meshes").await;
    on.execute("DELETE FROM blobs").await;
    assert!(store.fsck(false).await.unwrap().is_clean(), "it is known to be on its way out");
    assert_eq!(store.sweep_old_blobs().await.unwrap(), 1);
    assert_eq!(on.objects().len(), 0);
}

async fn bytes_that_came_late_to_a_place_that_was_discarded_are_swept(on: Deployment) {
    let store = on.open().await;
    assert!(store.add_mesh(&mesh("a", "1")).await.unwrap());
    assert!(on.texts("SELECT id FROM unfinished_blobs").await.is_empty());
    on.execute("INSERT INTO unfinished_blobs SELECT 'late', place, announced FROM blobs").await;
    store.sweep_old_blobs().await.unwrap();
    assert_eq!(on.texts("SELECT id FROM unfinished_blobs").await.len(), 1, "it may still come");
    on.execute("UPDATE unfinished_blobs SET begun = 1").await;
    store.sweep_old_blobs().await.unwrap();
    assert_eq!((blob_count(&store).await, on.objects().len()), (1, 1), "what is referred to stays");
    on.execute("INSERT INTO unfinished_blobs SELECT 'late', place, 1 FROM blobs").await;
    on.execute("DELETE FROM meshes").await;
    on.execute("DELETE FROM blobs").await;
    assert!(store.fsck(false).await.unwrap().is_clean(), "it is known to be under way");
    store.sweep_old_blobs().await.unwrap();
    assert_eq!(on.objects().len(), 0);
    assert!(on.texts("SELECT id FROM unfinished_blobs").await.is_empty());
}

async fn bytes_that_changed_or_are_lost_are_never_served(on: Deployment) {
    let store = on.open().await;
    let id = published(&store, "right").await;
    let row = store.job_file(&id, "result.json").await.unwrap().unwrap();
    assert_eq!(store.read_blob(&row.blob).await.unwrap(), "right");
    std::fs::write(&on.objects()[0], "wrong").unwrap();
    let error = store.read_blob(&row.blob).await.unwrap_err();
    assert!(matches!(error, StoreError::Integrity { .. }), "{error}");
    std::fs::remove_file(&on.objects()[0]).unwrap();
    let error = store.read_blob(&row.blob).await.unwrap_err();
    assert!(matches!(error, StoreError::Missing { .. }), "{error}");
}

async fn bytes_that_no_row_knows_stay_until_a_repair(on: Deployment) {
    let store = on.open().await;
    assert!(store.add_mesh(&mesh("a", "1")).await.unwrap());
    // As in a database that was restored from a backup of yesterday.
    on.execute("DELETE FROM meshes").await;
    on.execute("DELETE FROM blobs").await;
    store.sweep().await.unwrap();
    let findings = store.fsck(false).await.unwrap();
    assert_eq!((findings.objects, findings.orphans.len()), (1, 1));
    assert_eq!(store.repair(&findings).await.unwrap().removed, 1);
    assert_eq!(blob_count(&store).await, 0);
}

async fn a_repair_finds_bytes_again_and_has_lost_results_solved_again(on: Deployment) {
    let store = on.open().await;
    let (found, lost) = (published(&store, "found").await, published(&store, "lost").await);
    assert!(store.add_mesh(&mesh("gone", "1")).await.unwrap());
    let hash = |content: &str| sha256_hex(content.as_bytes());
    on.execute(&format!("DELETE FROM blobs WHERE sha256 = '{}'", hash("found"))).await;
    for path in on.objects() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with(&hash("lost")) {
            std::fs::write(&path, "cut").unwrap();
        } else if name.starts_with(&hash("gone")) {
            std::fs::remove_file(&path).unwrap();
        }
    }
    let shallow = store.fsck(false).await.unwrap();
    assert_eq!((shallow.dangling.len(), shallow.orphans.len()), (2, 1));
    let findings = store.fsck(true).await.unwrap();
    assert_eq!((findings.dangling.len(), findings.orphans.len()), (3, 1));
    let repaired = store.repair(&findings).await.unwrap();
    assert_eq!((repaired.found_again, repaired.jobs, repaired.removed), (1, 1, 1));
    let row = store.job_file(&found, "result.json").await.unwrap().unwrap();
    assert_eq!(store.read_blob(&row.blob).await.unwrap(), "found");

    let again = job(&store, &lost).await;
    assert_eq!((again.status, again.result), (JobStatus::Accepted, None));
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.publish(&lease, result(RESULT, &[file("lost")])).await.unwrap());
    let row = store.job_file(&lost, "result.json").await.unwrap().unwrap();
    assert_eq!(store.read_blob(&row.blob).await.unwrap(), "lost");

    let left = store.fsck(true).await.unwrap();
    assert_eq!(left.dangling.len(), 1, "a mesh is in no other place");
    assert_eq!((left.dangling[0].meshes.len(), left.orphans.len()), (1, 0));
}

async fn the_same_bytes_stay_as_long_as_somebody_refers_to_them(on: Deployment) {
    let store = on.open().await;
    let (first, second) = (mesh("a", "1"), mesh("a", "2"));
    assert!(store.add_mesh(&first).await.unwrap());
    assert!(store.add_mesh(&second).await.unwrap());
    assert!(!store.add_mesh(&mesh("a", "2")).await.unwrap(), "it was there before");
    assert_eq!(blob_count(&store).await, 1);
    assert_eq!(store.delete_mesh(&first.id).await.unwrap(), MeshDeletion::Deleted);
    assert_eq!(store.read_blob(&first.blob).await.unwrap(), "a");
    assert_eq!(store.delete_mesh(&second.id).await.unwrap(), MeshDeletion::Deleted);
    assert_eq!(blob_count(&store).await, 0);
    assert_eq!(on.objects().len(), 0);
}

/// Whether something keeps results from being stored.
async fn fails(store: &Store) -> bool {
    !store.storage_faults(0).await.is_empty()
}

/// The deployment with other blobs, as another host of its database.
fn with_blobs(on: &Deployment, blobs: BlobLocation) -> StorageLocations {
    let data = on.folder().join("another host");
    StorageLocations { data, blobs, ..on.places.clone() }
}

async fn a_host_whose_blobs_are_not_those_of_the_database_is_named(on: Deployment) {
    let store = on.open().await;
    store.check_blobs().await.unwrap();
    let BlobLocation::Bucket { bucket, settings, .. } = on.places.blobs.clone() else {
        panic!("a bucket")
    };
    let prefix = format!("mistyped-{}", uuid::Uuid::now_v7());
    let mistyped = BlobLocation::Bucket { bucket, prefix, settings };
    let places = with_blobs(&on, mistyped);
    // Nothing is stored yet, and either may be meant.
    Store::connect(&places).await.unwrap().check_blobs().await.unwrap();
    for name in ["a", "b"] {
        assert!(store.add_mesh(&mesh(name, "1")).await.unwrap());
    }
    store.check_blobs().await.unwrap();
    for places in [places, with_blobs(&on, BlobLocation::InData)] {
        let stray = Store::connect(&places).await.unwrap();
        let error = stray.check_blobs().await.unwrap_err();
        assert!(matches!(error, StoreError::OtherBlobs { meshes: 2 }), "{error}");
        assert!(error.is_setting() && fails(&stray).await);
    }
}

async fn a_bucket_that_does_not_exist_is_named(on: Deployment) {
    let BlobLocation::Bucket { settings, prefix, .. } = on.places.blobs.clone() else {
        panic!("a bucket")
    };
    let nowhere = BlobLocation::Bucket { bucket: "nowhere".into(), prefix, settings };
    let store = Store::connect(&with_blobs(&on, nowhere)).await.unwrap();
    let error = store.check_blobs().await.unwrap_err();
    assert!(matches!(error, StoreError::NoBucket), "{error}");
    assert!(error.is_setting() && error.is_unavailable() && fails(&store).await);
}

async fn blobs_beside_the_data_folder_have_one_database() {
    let (one, other) = (Deployment::embedded().await, Deployment::embedded().await);
    let blobs = one.folder().join("shared");
    let open = async |on: &Deployment| {
        let blobs = BlobLocation::Folder(blobs.clone());
        Store::connect(&StorageLocations { blobs, ..on.places.clone() }).await.unwrap()
    };
    let (store, second) = (open(&one).await, open(&other).await);
    store.check_blobs().await.unwrap();
    assert!(store.add_mesh(&mesh("a", "1")).await.unwrap());
    let error = second.check_blobs().await.unwrap_err();
    assert!(matches!(error, StoreError::ForeignBlobs { .. }) && error.is_setting(), "{error}");
    assert!(fails(&second).await);
    assert!(store.fsck(true).await.unwrap().is_clean(), "the mark is no blob");

    // As an earlier version left them: whose meshes are there tells whose they are.
    let mark = blobs.join("facies-owner");
    std::fs::remove_file(&mark).unwrap();
    let error = second.check_blobs().await.unwrap_err();
    let StoreError::ForeignBlobs { identity, .. } = &error else { panic!("{error}") };
    assert!(!mark.exists());
    store.check_blobs().await.unwrap();
    assert!(mark.exists());
    // The way out that the error names.
    std::fs::write(&mark, identity).unwrap();
    second.check_blobs().await.unwrap();
    assert!(store.check_blobs().await.is_err());
}

async fn a_start_removes_what_a_dead_process_left() {
    let on = Deployment::embedded().await;
    let store = on.open().await;
    let id = published(&store, "kept").await;
    assert!(store.add_mesh(&mesh("left", "1")).await.unwrap());
    on.execute("DELETE FROM meshes").await;
    let attempt = store.attempt_folder("job", 1);
    std::fs::create_dir_all(&attempt).unwrap();
    std::fs::write(attempt.join("skin.vtp"), "half").unwrap();
    let half = format!("{}#1", "ab".repeat(32));
    std::fs::write(store.folder().join("blobs").join(half), "x").unwrap();

    let swept = store.sweep().await.unwrap();
    assert_eq!((swept.blobs, swept.temporary), (1, 2));
    assert!(!attempt.exists());
    assert_eq!(blob_count(&store).await, 1);
    let row = store.job_file(&id, "result.json").await.unwrap().unwrap();
    assert_eq!(store.read_blob(&row.blob).await.unwrap(), "kept");
}

async fn a_data_folder_serves_one_process() {
    let on = Deployment::embedded().await;
    let _store = on.open().await;
    let error = Store::connect(&on.places).await.err().unwrap();
    assert!(matches!(error, StoreError::InUse { .. }), "{error}");
    let error = Store::migrate(&on.places).await.err().unwrap();
    let told = error.to_string();
    assert!(matches!(error, StoreError::ServedAlready { .. }) && error.is_setting(), "{told}");
    assert!(told.contains(on.places.data.to_str().unwrap()) && told.contains("migrates"), "{told}");
}
