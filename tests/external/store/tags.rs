//! Tags of jobs, changed by several clients.

use std::sync::Arc;

use facies::store::Tagged;

use crate::deployments::Deployment;
use crate::rows::{enqueue, job};
use crate::support::trials::trials;

trials! {
    on_both {
        tags_are_put_on_and_taken_off_and_others_stay
        of_changes_at_the_same_time_none_is_lost_and_none_goes_beyond_the_bound
    }
}

const MOST: usize = 4;

fn words(tags: &[&str]) -> Vec<String> {
    tags.iter().map(|tag| (*tag).to_owned()).collect()
}

async fn tags_are_put_on_and_taken_off_and_others_stay(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "tagged").await;
    let steps: [(&[&str], &[&str], &[&str]); 4] = [
        (&["main", "b"], &[], &["a", "b", "main"]),
        (&["main"], &["b", "none"], &["a", "main"]),
        (&[], &[], &["a", "main"]),
        (&["c", "d", "e"], &["a"], &["c", "d", "e", "main"]),
    ];
    for (add, remove, left) in steps {
        let changed = store.change_tags(&id, &words(add), &words(remove), MOST).await.unwrap();
        assert_eq!((changed, job(&store, &id).await.tags), (Tagged::Done, words(left)));
    }
    let fifth = store.change_tags(&id, &words(&["f"]), &[], MOST).await.unwrap();
    assert_eq!((fifth, job(&store, &id).await.tags.len()), (Tagged::TooMany(5), 4));
    let foreign = store.of_tenant("other").change_tags(&id, &words(&["f"]), &[], 9).await.unwrap();
    assert_eq!((foreign, job(&store, &id).await.tags.len()), (Tagged::NotFound, 4));
}

async fn of_changes_at_the_same_time_none_is_lost_and_none_goes_beyond_the_bound(on: Deployment) {
    let store = Arc::new(on.open().await);
    let id = enqueue(&store, "tagged").await;
    let changes = (0..8).map(|number| {
        let (store, id) = (store.clone(), id.clone());
        tokio::spawn(async move {
            let tag = [format!("tag {number}")];
            store.change_tags(&id, &tag, &[], MOST).await.unwrap()
        })
    });
    let mut done = 0;
    for change in changes.collect::<Vec<_>>() {
        done += usize::from(change.await.unwrap() == Tagged::Done);
    }
    // It had one from the start.
    assert_eq!((done, job(&store, &id).await.tags.len()), (MOST - 1, MOST));
}
