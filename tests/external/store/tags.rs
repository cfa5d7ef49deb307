//! Tags of jobs, changed by several clients.

use std::sync::Arc;

use facies::store::Enqueued;

use crate::deployments::Deployment;
use crate::rows::{enqueue, job, new_job};
use crate::support::trials::trials;

trials! {
    on_both {
        tags_are_put_on_and_taken_off_and_others_stay
        a_tag_that_goes_is_not_in_the_document_of_its_job_either
        beyond_the_bound_those_put_on_longest_ago_go
        changes_at_the_same_time_all_succeed_and_none_goes_beyond_the_bound
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
        assert_eq!((changed, job(&store, &id).await.tags), (true, words(left)));
    }
    let foreign = store.of_tenant("other").change_tags(&id, &words(&["f"]), &[], 9).await.unwrap();
    assert_eq!((foreign, job(&store, &id).await.tags.len()), (false, 4));
}

async fn a_tag_that_goes_is_not_in_the_document_of_its_job_either(on: Deployment) {
    let store = on.open().await;
    let document = |tags: &str| format!(r#"{{"predict":{{"spec":{{"tags":{tags}}}}}}}"#);
    let mut new = new_job(&document(r#"["a","b","c"]"#), "tagged");
    new.tags = words(&["a", "b", "c"]);
    assert_eq!(store.enqueue(&new, 100).await.unwrap(), Enqueued::Accepted);
    // One is taken off, one has to make room, and what is put on later is in no document.
    let steps: [(&[&str], &[&str], &str); 3] = [
        (&[], &["b", "none"], r#"["a","c"]"#),
        (&["d", "e", "f"], &[], r#"["c"]"#),
        (&[], &["c"], "[]"),
    ];
    for (add, remove, left) in steps {
        assert!(store.change_tags(&new.id, &words(add), &words(remove), MOST).await.unwrap());
        let stored = store.job_document(&new.id).await.unwrap();
        assert_eq!(stored.as_deref(), Some(document(left).as_str()));
    }
    assert_eq!(job(&store, &new.id).await.tags, words(&["d", "e", "f"]));
}

async fn beyond_the_bound_those_put_on_longest_ago_go(on: Deployment) {
    let store = on.open().await;
    let id = enqueue(&store, "tagged").await;
    let steps: [(&[&str], &[&str], &[&str]); 5] = [
        (&["z", "m", "c"], &["a"], &["c", "m", "z"]),
        (&["b", "y"], &[], &["b", "c", "m", "y"]),
        // Put on again, one is among the newest.
        (&["m"], &[], &["b", "c", "m", "y"]),
        (&["a", "x"], &[], &["a", "m", "x", "y"]),
        (&["p", "q", "r", "s"], &["y"], &["p", "q", "r", "s"]),
    ];
    for (add, remove, left) in steps {
        assert!(store.change_tags(&id, &words(add), &words(remove), MOST).await.unwrap());
        assert_eq!(job(&store, &id).await.tags, words(left));
    }
    // A lower bound takes effect with the next tag only: this is a job that was asked for again.
    assert!(store.change_tags(&id, &[], &[], 0).await.unwrap());
    assert_eq!(job(&store, &id).await.tags.len(), 4);
}

async fn changes_at_the_same_time_all_succeed_and_none_goes_beyond_the_bound(on: Deployment) {
    let store = Arc::new(on.open().await);
    let id = enqueue(&store, "tagged").await;
    let changes = (0..8).map(|number| {
        let (store, id) = (store.clone(), id.clone());
        tokio::spawn(async move {
            let tag = [format!("tag {number}")];
            store.change_tags(&id, &tag, &[], MOST).await.unwrap()
        })
    });
    for change in changes.collect::<Vec<_>>() {
        assert!(change.await.unwrap());
    }
    let left = job(&store, &id).await.tags;
    assert!(left.len() == MOST && left.iter().all(|tag| tag.starts_with("tag ")), "{left:?}");
}
