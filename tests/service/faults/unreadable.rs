//! Rows that the service cannot read, as after a change by hand: the log names which.

use std::fs::{File, read_to_string};
use std::process::Stdio;

use facies::store::{AddedCase, Enqueued, NewCase, NewJob, Store};
use tempfile::TempDir;

use crate::helpers::{Server, ask, serve};
use crate::processes::until;
use crate::rows::{new_case, new_job};

#[tokio::test]
async fn a_row_that_ends_a_list_is_named_in_the_log() {
    let (folder, logs) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    let store = Store::open(folder.path()).await.unwrap();
    let case = NewCase { document: "{}".into(), ..new_case() };
    assert_eq!(store.add_case(&case, 100).await.unwrap(), AddedCase::Stored);
    let job = NewJob { engine: "{}".into(), ..new_job("{}", "a") };
    assert_eq!(store.enqueue(&job, 100).await.unwrap(), Enqueued::Accepted);
    store.close().await;
    drop(store);

    let log = logs.path().join("log");
    let mut command = serve(folder.path());
    command.args(["--workers", "0"]).stderr(Stdio::from(File::create(&log).unwrap()));
    let server = Server::start_command(command, folder);
    let lists = [
        ("/v1/cases", format!("case {} cannot be read: missing field `units`", case.id)),
        ("/v1/jobs", format!("job {} cannot be read: missing field `name`", job.id)),
    ];
    for (list, named) in lists {
        ask(server.get(list)).await.problem(500, "internal");
        until("the row is named", async || {
            read_to_string(&log).ok()?.contains(&named).then_some(())
        })
        .await;
    }
}
