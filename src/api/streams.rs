//! Open event streams: a limited number for each client, and none when the process is to stop.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::watch;

use super::client::Client;
use super::error::{ApiError, ApiResult};
use crate::metrics::http;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;
use axum::http::{HeaderValue, header};

/// The advised wait for one of a client's streams to end.
const RETRY_AFTER_S: u32 = 10;

/// Counts open streams, and ends them.
#[derive(Clone)]
pub struct Streams {
    most: u32,
    open: Arc<Mutex<HashMap<Client, u32>>>,
    stopping: watch::Sender<bool>,
}

impl Streams {
    pub fn new(most: u32) -> Self {
        Streams { most, open: Arc::default(), stopping: watch::Sender::new(false) }
    }

    /// Ends open streams, and requests that wait for a job.
    pub fn stop(&self) {
        self.stopping.send_replace(true);
    }

    /// Becomes true when the process is about to stop.
    pub fn stopping(&self) -> watch::Receiver<bool> {
        self.stopping.subscribe()
    }

    /// A permit for one more stream of a client.
    pub fn enter(&self, client: Client) -> ApiResult<StreamPlace> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let count = open.entry(client.clone()).or_insert(0);
        if *count >= self.most {
            let detail = format!("{} streams are open, as many as one client may have", self.most);
            let problem = Problem::new(ErrorCode::TooManyStreams, detail).with("limit", self.most);
            let seconds = HeaderValue::from(RETRY_AFTER_S);
            return Err(ApiError::from(problem).header(header::RETRY_AFTER, seconds));
        }
        *count += 1;
        Ok(StreamPlace { client, open: self.open.clone(), _counted: http::Stream::begin() })
    }
}

/// The permit of an open stream; released when dropped.
pub struct StreamPlace {
    client: Client,
    open: Arc<Mutex<HashMap<Client, u32>>>,
    _counted: http::Stream,
}

impl Drop for StreamPlace {
    fn drop(&mut self) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = open.get_mut(&self.client) {
            *count -= 1;
            if *count == 0 {
                open.remove(&self.client);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_free_again_when_its_stream_ends() {
        let streams = Streams::new(1);
        let (alice, bob) = (Client::named("alice"), Client::named("bob"));
        let place = streams.enter(alice.clone()).ok().unwrap();
        assert!(streams.enter(alice.clone()).is_err());
        assert!(streams.enter(bob).is_ok());
        drop(place);
        assert!(streams.enter(alice).is_ok());
    }
}
