//! Lists over HTTP come in pages.

use facies::schema::key::{KeyDocument, Scope};
use facies::store::Store;
use reqwest::{Method, StatusCode};
use serde_json::Value;
use tempfile::TempDir;

use super::tenants::Hospital;
use crate::helpers::{Answer, ask};
use crate::rows::{lose_jobs, make_keys};

/// Where the header `Link` of an answer leads on to.
fn next(answer: &Answer) -> String {
    let link = answer.header("link");
    let address = link.strip_suffix(">; rel=\"next\"").and_then(|link| link.strip_prefix('<'));
    address.unwrap_or_else(|| panic!("no next page in {link:?}")).to_owned()
}

fn length(list: &Value) -> usize {
    list.as_array().unwrap().len()
}

/// A folder with 51 keys of one tenant, 51 tenants and 51 lost jobs; one of these keys.
async fn crowded() -> (TempDir, String) {
    let folder = TempDir::new().unwrap();
    let store = Store::open(folder.path()).await.unwrap();
    let own = store.of_tenant("a");
    make_keys(&own, 50).await;
    let all = KeyDocument { label: "all".into(), scopes: Scope::ALL.into(), days: None };
    let key = own.make_key(&all).await.unwrap().text;
    lose_jobs(&own, 51).await;
    for number in 0..50 {
        store.of_tenant(&format!("other-{number}")).retain(None).await.unwrap();
    }
    store.close().await;
    (folder, key)
}

#[tokio::test]
async fn who_asks_for_no_page_gets_the_first_and_is_told_of_the_next() {
    let (folder, key) = crowded().await;
    let hospital = Hospital::open_in(folder);
    for list in ["/tenants", "/lost-jobs"] {
        let answer = ask(hospital.admin(Method::GET, list)).await;
        let first = answer.expect(StatusCode::OK);
        assert_eq!(length(&first), 50, "{list}");
        let answer = ask(hospital.admin(Method::GET, &next(&answer))).await;
        let last = answer.expect(StatusCode::OK);
        assert_eq!(length(&last), 1, "{list}");
        assert!(!first.as_array().unwrap().contains(&last[0]), "{list}");
        assert_eq!(answer.header("link"), "", "{list}");
    }
    let admin = async |path: &str| ask(hospital.admin(Method::GET, path)).await;
    let client = async |path: &str| hospital.get(&key, path).await;
    let lists = [client("/v1/keys").await, admin("/tenants/a/keys").await];
    for (answer, list) in lists.iter().zip(["/v1/keys", "/tenants/a/keys"]) {
        let first = answer.expect(StatusCode::OK);
        assert_eq!(length(&first["items"]), 50, "{list}");
        let rest = format!("{list}?limit=200&cursor={}", first["next"].as_str().unwrap());
        let answer = if list.starts_with("/v1") { client(&rest).await } else { admin(&rest).await };
        let last = answer.expect(StatusCode::OK);
        assert_eq!(length(&last["items"]), 1, "{list}");
        assert!(!first["items"].as_array().unwrap().contains(&last["items"][0]), "{list}");
        assert!(last.get("next").is_none(), "{list}");
    }
}

#[tokio::test]
async fn a_page_that_is_none_is_refused() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &["admin"]).await;
    // Of a job, in a list that is not of jobs.
    let other = "MDE5N2E1YjAtMDAwMC03MDAwLTgwMDAtMDAwMDAwMDAwMDAx";
    for wrong in ["limit=0", "limit=201", "cursor=x", "sort=up"] {
        hospital.get(&key, &format!("/v1/keys?{wrong}")).await.problem(400, "invalid-parameter");
        for list in ["/tenants", "/tenants/a/keys", "/lost-jobs"] {
            let answer = ask(hospital.admin(Method::GET, &format!("{list}?{wrong}"))).await;
            answer.problem(400, "invalid-parameter");
        }
    }
    for twice in ["limit=2&limit=3", "limit=2&limit=2"] {
        let told = hospital.get(&key, &format!("/v1/keys?{twice}")).await;
        let problem = told.problem(400, "invalid-parameter");
        assert_eq!(problem["detail"], "limit is given more than once", "{problem}");
    }
    let path = format!("/v1/keys?cursor={other}");
    hospital.get(&key, &path).await.problem(400, "invalid-parameter");
}
