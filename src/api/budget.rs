//! A budget of bytes in flight, for each client and for the process: bodies that come or are worked on, and copies of files
//! that are sent. They lie on the disk of the data folder, which so many bytes cannot fill unseen.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::client::Client;
use super::error::ApiResult;
use crate::metrics::http;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

/// Counts the bytes of all clients.
#[derive(Clone)]
pub struct Budget {
    most: Most,
    used: Arc<Mutex<Used>>,
}

/// How many bytes may be in flight at once.
#[derive(Clone, Copy)]
pub struct Most {
    pub of_process: u64,
    pub of_client: u64,
}

#[derive(Default)]
struct Used {
    total: u64,
    clients: HashMap<Client, u64>,
}

/// Bytes of one request, counted until this is dropped.
pub struct Held {
    budget: Budget,
    client: Client,
    bytes: Mutex<u64>,
}

impl Budget {
    pub fn new(most: Most) -> Budget {
        Budget { most, used: Arc::default() }
    }

    /// The bytes of a request of a client, none so far.
    pub fn hold(&self, client: Client) -> Held {
        Held { budget: self.clone(), client, bytes: Mutex::new(0) }
    }

    fn take(&self, client: &Client, bytes: u64) -> ApiResult<()> {
        let mut used = self.lock();
        let own = used.clients.get(client).copied().unwrap_or(0);
        let Most { of_process, of_client } = self.most;
        let bounds = [(own, of_client, "this client"), (used.total, of_process, "all clients")];
        if let Some((used, most, whose)) =
            bounds.into_iter().find(|(used, most, _)| used + bytes > *most)
        {
            let detail = format!(
                "{used} bytes of bodies of {whose} are under way, and with {bytes} more there are more than {most}"
            );
            return Err(Problem::new(ErrorCode::Busy, detail).with("limit", most).into());
        }
        used.total += bytes;
        used.clients.insert(client.clone(), own + bytes);
        http::body_bytes(used.total);
        Ok(())
    }

    fn give_back(&self, client: &Client, bytes: u64) {
        let mut used = self.lock();
        used.total = used.total.saturating_sub(bytes);
        let own = used.clients.remove(client).unwrap_or(0).saturating_sub(bytes);
        if own > 0 {
            used.clients.insert(client.clone(), own);
        }
        http::body_bytes(used.total);
    }

    fn lock(&self) -> MutexGuard<'_, Used> {
        self.used.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Held {
    /// Holds at least so many bytes.
    pub fn at_least(&self, bytes: u64) -> ApiResult<()> {
        let mut held = self.bytes.lock().unwrap_or_else(PoisonError::into_inner);
        if bytes > *held {
            self.budget.take(&self.client, bytes - *held)?;
            *held = bytes;
        }
        Ok(())
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let bytes = *self.bytes.get_mut().unwrap_or_else(PoisonError::into_inner);
        if bytes > 0 {
            self.budget.give_back(&self.client, bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_and_all_together_hold_as_much_as_they_may_and_give_it_back() {
        let budget = Budget::new(Most { of_process: 10, of_client: 6 });
        let [a, b] = ["a", "b"].map(Client::named);
        let (one, two) = (budget.hold(a.clone()), budget.hold(a.clone()));
        assert!(one.at_least(4).is_ok() && one.at_least(2).is_ok() && two.at_least(2).is_ok());
        assert_eq!(two.at_least(3).unwrap_err().problem.code, ErrorCode::Busy);
        let other = budget.hold(b.clone());
        assert!(other.at_least(5).is_err(), "11 of 10");
        assert!(other.at_least(4).is_ok());
        drop(one);
        assert!(two.at_least(6).is_ok());
        drop((two, other));
        assert!(budget.lock().clients.is_empty() && budget.lock().total == 0);
    }
}
