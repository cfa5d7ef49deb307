//! A database that answers late.

use std::time::{Duration, Instant};

use facies::config::DatabaseLocation;
use reqwest::StatusCode;
use tempfile::TempDir;

use crate::deployments::Deployment;
use crate::helpers::{Answer, Server, ask, serve_shared};
use crate::invariants::{is_shed, works_on};
use crate::partition::Way;
use crate::processes::until;
use crate::support::trials::trials;

trials! {
    on_shared {
        requests_to_a_slow_database_are_told_to_come_back_and_do_not_pile_up
    }
}

const LESS_THAN_AN_ANSWER: Duration = Duration::from_secs(7);

async fn timed(request: reqwest::RequestBuilder) -> (Answer, Duration) {
    let begun = Instant::now();
    (ask(request).await, begun.elapsed())
}

async fn requests_to_a_slow_database_are_told_to_come_back_and_do_not_pile_up(on: Deployment) {
    let DatabaseLocation::Server { address, .. } = &on.places.database else {
        panic!("it is shared")
    };
    let way = Way::to(address.reveal());
    let mut command = serve_shared(&on);
    command.args(["--workers", "1", "--database", &way.address]);
    let server = Server::start_command(command, TempDir::new().unwrap());
    works_on(&server).await;

    // Eight seconds for each question and its answer: longer than a connection is waited for, shorter than an answer is.
    way.slow_down(Duration::from_secs(4));
    let many = futures::future::join_all((0..40).map(|_| timed(server.get("/v1/jobs"))));
    let ready = timed(server.get("/readyz"));
    let alive = timed(server.get("/healthz"));
    let (many, (ready, ready_after), (alive, alive_after)) = tokio::join!(many, ready, alive);
    assert_eq!(alive.status, StatusCode::OK);
    assert!(alive_after < LESS_THAN_AN_ANSWER, "{alive_after:?}");
    ready.problem(503, "not-ready");
    assert!(ready_after < LESS_THAN_AN_ANSWER, "{ready_after:?}");
    let times: Vec<Duration> = many.iter().map(|(_, after)| *after).collect();
    let at_once =
        |(answer, after): &&(Answer, Duration)| is_shed(answer) && *after < LESS_THAN_AN_ANSWER;
    let shed = many.iter().filter(at_once).count();
    assert!(shed >= 20, "{shed} of 40 found no connection and were told: {times:?}");
    // Who has a connection is given up by the limit of an answer.
    assert!(times.iter().all(|after| *after < Duration::from_secs(40)), "{times:?}");

    way.mend();
    until("the service is ready", async || {
        (ask(server.get("/readyz")).await.status == StatusCode::OK).then_some(())
    })
    .await;
    works_on(&server).await;
}
