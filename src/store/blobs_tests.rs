//! Tests of places of blobs, and of a folder that goes away.

use super::*;

#[test]
fn places_of_a_store_within_another_are_none_of_its_own() {
    let places = ["ab/1", "facies-owner", "b/facies-owner", "b/cd/2", "bc/3", "not-facies-owner"];
    let own = own_places(places.map(str::to_owned).into());
    assert_eq!(own, ["ab/1", "bc/3", "not-facies-owner"]);
}

#[tokio::test]
async fn a_folder_that_is_not_mounted_is_out_of_reach_and_stays_as_it_is() {
    let place = tempfile::tempdir().unwrap();
    let (root, away) = (place.path().join("blobs"), place.path().join("away"));
    for in_data in [false, true] {
        let blobs = Blobs::in_folder(&root, in_data).unwrap();
        if !in_data {
            let unknown = blobs.put("ab/1", "early".into()).await;
            assert!(matches!(unknown, Err(StoreError::NoFolder { .. })), "{unknown:?}");
            blobs.set_owner("one").await.unwrap();
            blobs.know_owner("one");
        }
        blobs.put("ab/1", "kept".into()).await.unwrap();
        std::fs::rename(&root, &away).unwrap();
        if !in_data {
            // An empty mount point.
            std::fs::create_dir(&root).unwrap();
        }
        let outcomes = [
            blobs.put("ab/2", "lost".into()).await,
            blobs.find("ab/1", "").await.map(drop),
            blobs.exists("ab/1").await.map(drop),
            blobs.delete("ab/1").await,
            blobs.list().await.map(drop),
        ];
        for outcome in outcomes {
            let error = outcome.unwrap_err();
            assert!(matches!(error, StoreError::NoFolder { .. }), "{error}");
            assert!(error.is_unavailable() && !error.is_setting());
        }
        assert_eq!(blobs.ping().await.is_err(), in_data, "a mount point takes a file");
        assert!(std::fs::read_dir(&root).map_or(0, Iterator::count) == 0);
        if !in_data {
            std::fs::remove_dir(&root).unwrap();
        }
        std::fs::rename(&away, &root).unwrap();
        blobs.put("ab/2", "kept".into()).await.unwrap();
        assert!(blobs.exists("ab/1").await.unwrap());
        let lost = blobs.find("ab/3", "").await.map(drop);
        assert!(matches!(lost, Err(StoreError::Missing { .. })), "{lost:?}");
    }
}
