//! Budget of bytes in flight, for each client, for each tenant and for the process: request bodies and copies of sent
//! files. They are in files of the data folder, whose disk they must not fill.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::client::Client;
use super::error::ApiResult;
use crate::metrics::http;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

/// Counts the bytes of all clients.
#[derive(Clone)]
pub struct Budget {
    most: ByteLimits,
    used: Arc<Mutex<BytesInUse>>,
}

/// The most bytes in flight. A tenant may have three quarters of what others leave of the limit of the process,
/// with any number of keys: there is always something left for another (dynamic thresholds of Choudhury and Hahne, 1998,
/// with alpha = 3). A single body may have all that is left, so that the largest always fits into an idle service.
#[derive(Clone, Copy)]
pub struct ByteLimits {
    pub of_process: u64,
    pub of_client: u64,
}

/// The owner of the bytes of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Owner {
    pub tenant: Arc<str>,
    pub client: Client,
}

#[derive(Default)]
struct BytesInUse {
    total: u64,
    tenants: HashMap<Arc<str>, u64>,
    clients: HashMap<Client, u64>,
}

/// Bytes of one request, counted until this is dropped.
pub struct ByteReservation {
    budget: Budget,
    owner: Owner,
    bytes: Mutex<u64>,
}

/// Bytes in flight, their owner, and their limit.
struct Bound {
    used: u64,
    most: u64,
    whose: &'static str,
}

impl Budget {
    pub fn new(most: ByteLimits) -> Budget {
        Budget { most, used: Arc::default() }
    }

    /// The bytes of a request, none so far.
    pub fn hold(&self, owner: Owner) -> ByteReservation {
        ByteReservation { budget: self.clone(), owner, bytes: Mutex::new(0) }
    }

    fn take(&self, owner: &Owner, held: u64, more: u64) -> ApiResult<()> {
        let mut used = self.lock();
        self.check(&used, owner, held, more)?;
        used.total += more;
        *used.tenants.entry(owner.tenant.clone()).or_default() += more;
        *used.clients.entry(owner.client.clone()).or_default() += more;
        http::body_bytes(used.total);
        Ok(())
    }

    /// Whether a request with this many bytes may reserve this many more.
    fn check(&self, used: &BytesInUse, owner: &Owner, held: u64, more: u64) -> ApiResult<()> {
        let ByteLimits { of_process, of_client } = self.most;
        let of_tenant = used.tenants.get(&owner.tenant).copied().unwrap_or(0);
        let left = of_process.saturating_sub(used.total - of_tenant);
        let is_alone = of_tenant == held;
        let own = used.clients.get(&owner.client).copied().unwrap_or(0);
        let bounds = [
            Bound { used: own, most: of_client, whose: "this client" },
            Bound {
                used: of_tenant,
                most: if is_alone { left } else { left / 4 * 3 },
                whose: "this tenant",
            },
        ];
        let full = bounds.into_iter().find(|bound| bound.used + more > bound.most);
        let Some(Bound { used, most, whose }) = full else { return Ok(()) };
        let detail = format!(
            "{used} bytes of bodies of {whose} are in flight, and {more} more would exceed {most}"
        );
        Err(Problem::new(ErrorCode::Busy, detail).with("limit", most).into())
    }

    fn release(&self, owner: &Owner, bytes: u64) {
        let mut used = self.lock();
        used.total = used.total.saturating_sub(bytes);
        subtract(&mut used.tenants, &owner.tenant, bytes);
        subtract(&mut used.clients, &owner.client, bytes);
        http::body_bytes(used.total);
    }

    fn lock(&self) -> MutexGuard<'_, BytesInUse> {
        self.used.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn subtract<K: Hash + Eq + Clone>(used: &mut HashMap<K, u64>, whose: &K, bytes: u64) {
    let left = used.remove(whose).unwrap_or(0).saturating_sub(bytes);
    if left > 0 {
        used.insert(whose.clone(), left);
    }
}

impl ByteReservation {
    /// Reserves at least this many bytes.
    pub fn at_least(&self, bytes: u64) -> ApiResult<()> {
        let mut held = self.lock();
        if bytes > *held {
            self.budget.take(&self.owner, *held, bytes - *held)?;
            *held = bytes;
        }
        Ok(())
    }

    /// Refuses bytes beyond the present budget, before a client sends them.
    pub fn check_available(&self, bytes: u64) -> ApiResult<()> {
        let held = *self.lock();
        let used = self.budget.lock();
        self.budget.check(&used, &self.owner, held, bytes.saturating_sub(held))
    }

    fn lock(&self) -> MutexGuard<'_, u64> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for ByteReservation {
    fn drop(&mut self) {
        let bytes = *self.bytes.get_mut().unwrap_or_else(PoisonError::into_inner);
        if bytes > 0 {
            self.budget.release(&self.owner, bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn owner(tenant: &str, client: &str) -> Owner {
        Owner { tenant: tenant.into(), client: Client::named(client) }
    }

    #[test]
    fn a_client_and_all_together_hold_as_much_as_they_may_and_give_it_back() {
        let budget = Budget::new(ByteLimits { of_process: 100, of_client: 60 });
        let (one, two) = (budget.hold(owner("a", "a")), budget.hold(owner("a", "a")));
        assert!(one.at_least(40).is_ok() && one.at_least(20).is_ok() && two.at_least(20).is_ok());
        assert!(two.check_available(20).is_ok() && two.check_available(21).is_err());
        assert_eq!(two.at_least(21).unwrap_err().problem.code, ErrorCode::Busy);
        let other = budget.hold(owner("b", "b"));
        assert!(other.at_least(41).is_err(), "101 of 100");
        assert!(other.at_least(40).is_ok(), "one body may have all that is left");
        drop(one);
        assert!(two.at_least(45).is_ok());
        drop((two, other));
        let used = budget.lock();
        assert!(used.clients.is_empty() && used.tenants.is_empty() && used.total == 0);
    }

    #[test]
    fn a_tenant_with_many_keys_leaves_a_share_to_others() {
        let budget = Budget::new(ByteLimits { of_process: 1000, of_client: 1000 });
        let fill = |tenant: &str| -> Vec<ByteReservation> {
            let keys = (0..1000).map(|key| budget.hold(owner(tenant, &format!("{tenant} {key}"))));
            keys.take_while(|held| held.at_least(10).is_ok()).collect()
        };
        let (greedy, second, third) = (fill("a"), fill("b"), fill("c"));
        assert_eq!((greedy.len(), second.len(), third.len()), (75, 18, 5));
        drop(greedy);
        assert_eq!(fill("d").len(), 57, "three quarters of what the others leave");
    }
}
