//! Rate limit: requests of a client per minute, and headers with the remaining number
//! (draft-ietf-httpapi-ratelimit-headers-10).
//!
//! A bucket has the requests of one minute and fills evenly, so that short bursts pass and long ones
//! are limited to the allowed rate. Source: the generic cell rate algorithm, ITU-T I.371, 2004, annex A.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::http::{HeaderName, HeaderValue, header};
use axum::response::Response;

use super::client::Client;
use super::error::ApiError;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

const WINDOW: Duration = Duration::from_secs(60);
/// The most clients with state; above it those with a full bucket are dropped.
const REMEMBERED: usize = 10_000;

/// The buckets of all clients.
pub struct Rates {
    per_minute: u32,
    /// When the bucket of each client will be full again.
    full: Mutex<HashMap<Client, Instant>>,
}

/// The remaining requests of a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateAllowance {
    per_minute: u32,
    requests: u32,
    /// Seconds until the bucket is full again.
    reset_s: u64,
}

impl Rates {
    /// 0 means no limit.
    pub fn new(per_minute: u32) -> Self {
        Rates { per_minute, full: Mutex::default() }
    }

    /// Takes one request from the bucket of a client; `None` without a limit.
    pub fn take(&self, client: Client) -> Result<Option<RateAllowance>, ApiError> {
        self.take_at(client, Instant::now())
    }

    fn take_at(&self, client: Client, now: Instant) -> Result<Option<RateAllowance>, ApiError> {
        if self.per_minute == 0 {
            return Ok(None);
        }
        let one = WINDOW / self.per_minute;
        let mut full = self.full.lock().unwrap_or_else(PoisonError::into_inner);
        if full.len() >= REMEMBERED {
            full.retain(|_, when| *when > now);
        }
        let before = full.get(&client).map_or(now, |when| (*when).max(now));
        let after = before + one;
        let missing = after - now;
        if missing > WINDOW {
            return Err(self.refusal(before - now, missing - WINDOW));
        }
        full.insert(client, after);
        let left = (WINDOW - missing).as_secs_f64() / one.as_secs_f64();
        Ok(Some(self.allowance(left as u32, missing)))
    }

    fn allowance(&self, requests: u32, missing: Duration) -> RateAllowance {
        RateAllowance { per_minute: self.per_minute, requests, reset_s: missing.as_secs() + 1 }
    }

    fn refusal(&self, missing: Duration, wait: Duration) -> ApiError {
        let seconds = wait.as_secs() + 1;
        let detail = format!("{} requests a minute are allowed", self.per_minute);
        let problem = Problem::new(ErrorCode::RateLimited, detail).with("limit", self.per_minute);
        let error = ApiError::from(problem).header(header::RETRY_AFTER, HeaderValue::from(seconds));
        let left = self.allowance(0, missing).headers();
        left.into_iter().fold(error, |error, (name, value)| error.header(name, value))
    }
}

impl RateAllowance {
    /// Adds the headers of the rate limit to the response.
    pub fn tell(&self, response: &mut Response) {
        response.headers_mut().extend(self.headers());
    }

    fn headers(&self) -> Vec<(HeaderName, HeaderValue)> {
        let policy = format!("\"requests\";q={};w={}", self.per_minute, WINDOW.as_secs());
        let left = format!("\"requests\";r={};t={}", self.requests, self.reset_s);
        let named = |(name, text): (&'static str, String)| {
            Some((HeaderName::from_static(name), HeaderValue::from_str(&text).ok()?))
        };
        [("ratelimit-policy", policy), ("ratelimit", left)].into_iter().filter_map(named).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bucket_is_emptied_by_a_burst_and_fills_evenly() {
        let rates = Rates::new(60);
        let (alice, bob) = (Client::named("alice"), Client::named("bob"));
        let start = Instant::now();
        for taken in 1..=60 {
            let left = rates.take_at(alice.clone(), start).unwrap().unwrap();
            assert_eq!(left.requests, 60 - taken);
        }
        assert!(rates.take_at(alice.clone(), start).is_err());
        assert!(rates.take_at(bob, start).is_ok(), "others have buckets of their own");
        let later = start + Duration::from_secs(2);
        assert!(rates.take_at(alice.clone(), later).is_ok());
        assert!(rates.take_at(alice.clone(), later).is_ok());
        assert!(rates.take_at(alice, later).is_err());
    }

    #[test]
    fn nobody_is_counted_at_0() {
        assert_eq!(Rates::new(0).take(Client::named("alice")).unwrap(), None);
    }
}
