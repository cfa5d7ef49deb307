//! Metrics of requests. Routes are patterns, so that no id becomes a label.

use std::time::Instant;

use ::metrics::{
    Unit, counter, describe_counter, describe_gauge, describe_histogram, gauge, histogram,
};

const REQUESTS: &str = "facies_http_requests_total";
pub(super) const TIME: &str = "facies_http_request_seconds";
const IN_FLIGHT: &str = "facies_http_requests_in_flight";
const STREAMS: &str = "facies_http_event_streams";
const WAITING: &str = "facies_http_requests_waiting";
const BODIES: &str = "facies_http_body_bytes_in_flight";

pub(super) const SECONDS: [f64; 13] =
    [0.001, 0.003, 0.005, 0.01, 0.02, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 60.0];

pub(super) fn describe() {
    describe_counter!(REQUESTS, "requests by route, method and class of status; `gone` left first");
    describe_histogram!(TIME, Unit::Seconds, "time to the head of the answer, by route and method");
    describe_gauge!(IN_FLIGHT, "requests whose answer has not begun");
    describe_gauge!(STREAMS, "open streams of events");
    describe_gauge!(WAITING, "requests that wait for their turn, by what for (for)");
    describe_gauge!(
        BODIES,
        Unit::Bytes,
        "bodies that come or are worked on, and copies of files that are sent"
    );
}

/// A method that routes may have; another one is a word of the client's.
pub fn known_method(method: &str) -> Option<&'static str> {
    let known = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"];
    known.into_iter().find(|known| *known == method)
}

/// A request from its beginning to the head of its answer.
pub struct Request {
    begun: Instant,
    route: String,
    method: &'static str,
    status: &'static str,
}

impl Request {
    /// A request whose client leaves before the answer counts as `gone`.
    pub fn begin(method: &str, route: &str) -> Request {
        gauge!(IN_FLIGHT).increment(1.0);
        let method = known_method(method).unwrap_or("other");
        Request { begun: Instant::now(), route: route.to_owned(), method, status: "gone" }
    }

    pub fn answered(mut self, status: u16) {
        self.status = match status {
            200..300 => "2xx",
            300..400 => "3xx",
            400..500 => "4xx",
            500..600 => "5xx",
            _ => "1xx",
        };
    }
}

impl Drop for Request {
    fn drop(&mut self) {
        gauge!(IN_FLIGHT).decrement(1.0);
        let route = std::mem::take(&mut self.route);
        let took = self.begun.elapsed().as_secs_f64();
        counter!(REQUESTS, "route" => route.clone(), "method" => self.method, "status" => self.status)
            .increment(1);
        histogram!(TIME, "route" => route, "method" => self.method).record(took);
    }
}

/// Requests that wait for their turn at something.
pub fn waiting(what: &'static str, count: usize) {
    gauge!(WAITING, "for" => what).set(count as f64);
}

/// Bytes of bodies that are under way.
pub fn body_bytes(bytes: u64) {
    gauge!(BODIES).set(bytes as f64);
}

/// An open stream of events.
pub struct Stream(());

impl Stream {
    pub fn begin() -> Stream {
        gauge!(STREAMS).increment(1.0);
        Stream(())
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        gauge!(STREAMS).decrement(1.0);
    }
}
