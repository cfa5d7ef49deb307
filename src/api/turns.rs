//! A fair queue of requests for what only a few may do at a time: tenants take turns (round robin), and of a tenant who came
//! first goes first. One who sends a hundred requests holds up nobody but himself.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

use super::error::{ApiError, ApiResult};
use crate::metrics::http;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;
use crate::worker::niceness::give_way;

/// Places of one kind, and the queue for them.
#[derive(Clone)]
pub struct Turns {
    what: &'static str,
    queue: Arc<Mutex<Queue>>,
}

struct Queue {
    free: usize,
    /// Most requests of one tenant that wait.
    most: usize,
    /// Tenants of whom requests wait, in the order of their next turns.
    tenants: VecDeque<Waiting>,
}

struct Waiting {
    tenant: String,
    requests: VecDeque<oneshot::Sender<Turn>>,
}

/// The turn of a request, until its last clone is dropped.
#[derive(Clone)]
pub struct Turn {
    _place: Arc<Place>,
}

/// A place that is taken; handed on when it is dropped.
struct Place {
    turns: Option<Turns>,
}

enum Entered {
    Now,
    Later(oneshot::Receiver<Turn>),
}

impl Turns {
    /// `what` is what the places are for, in the words of the metrics.
    pub fn new(what: &'static str, places: usize, most: usize) -> Turns {
        let queue = Queue { free: places, most, tenants: VecDeque::new() };
        Turns { what, queue: Arc::new(Mutex::new(queue)) }
    }

    /// Waits for the turn of a request of a tenant.
    pub async fn turn(&self, tenant: &str) -> ApiResult<Turn> {
        let entered = self.enter(tenant)?;
        match entered {
            Entered::Now => Ok(self.taken()),
            Entered::Later(turn) => turn.await.map_err(ApiError::internal),
        }
    }

    fn enter(&self, tenant: &str) -> ApiResult<Entered> {
        let mut queue = self.lock();
        if queue.free > 0 {
            queue.free -= 1;
            return Ok(Entered::Now);
        }
        let later = queue.wait(tenant);
        http::waiting(self.what, queue.length());
        later.map(Entered::Later)
    }

    fn taken(&self) -> Turn {
        Turn { _place: Arc::new(Place { turns: Some(self.clone()) }) }
    }

    /// Gives a free place to the next who still waits.
    fn pass_on(&self) {
        loop {
            let mut queue = self.lock();
            let next = queue.next();
            http::waiting(self.what, queue.length());
            let Some(next) = next else {
                queue.free += 1;
                return;
            };
            drop(queue);
            let Err(turn) = next.send(self.taken()) else { return };
            // Whoever waited has gone: the place is not given back, but to the next.
            if let Some(mut place) = Arc::into_inner(turn._place) {
                place.turns = None;
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    /// A place at the end of the queue of a tenant.
    fn wait(&mut self, tenant: &str) -> ApiResult<oneshot::Receiver<Turn>> {
        let most = self.most;
        let known = self.tenants.iter().position(|waiting| waiting.tenant == tenant);
        let at = known.unwrap_or_else(|| {
            self.tenants.push_back(Waiting { tenant: tenant.to_owned(), requests: [].into() });
            self.tenants.len() - 1
        });
        let requests = &mut self.tenants[at].requests;
        // Those whose clients have gone wait no more.
        requests.retain(|request| !request.is_closed());
        if requests.len() >= most {
            let detail = format!("{most} requests of this tenant wait for their turn already");
            return Err(Problem::new(ErrorCode::Busy, detail).with("limit", most).into());
        }
        let (turn, later) = oneshot::channel();
        requests.push_back(turn);
        Ok(later)
    }

    /// The first request of the tenant whose turn it is.
    fn next(&mut self) -> Option<oneshot::Sender<Turn>> {
        loop {
            let mut waiting = self.tenants.pop_front()?;
            let Some(request) = waiting.requests.pop_front() else { continue };
            if !waiting.requests.is_empty() {
                self.tenants.push_back(waiting);
            }
            return Some(request);
        }
    }

    fn length(&self) -> usize {
        self.tenants.iter().map(|waiting| waiting.requests.len()).sum()
    }
}

impl Turn {
    /// Runs work that takes a processor for long on a thread of its own, which gives way to those that answer. The turn
    /// lasts until the work is done, also where its client has gone.
    pub async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> ApiResult<T> {
        let (done, made) = oneshot::channel();
        let turn = self.clone();
        let patient = move || {
            let _turn = turn;
            give_way();
            // Nobody waits any more where the client has gone.
            let _ = done.send(work());
        };
        let thread = std::thread::Builder::new().name("parser".to_owned()).spawn(patient);
        thread.map_err(ApiError::internal)?;
        // A thread that panics drops its end.
        made.await.map_err(ApiError::internal)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        if let Some(turns) = self.turns.take() {
            turns.pass_on();
        }
    }
}

#[cfg(test)]
mod tests {
    use futures::FutureExt as _;
    use futures::future::BoxFuture;

    use super::*;

    /// A request that has asked for its turn.
    fn asked<'a>(turns: &'a Turns, tenant: &'a str) -> BoxFuture<'a, ApiResult<Turn>> {
        let mut turn = turns.turn(tenant).boxed();
        assert!((&mut turn).now_or_never().is_none(), "it waits");
        turn
    }

    #[tokio::test]
    async fn a_tenant_that_comes_late_waits_for_one_turn_of_another_and_not_for_all() {
        let turns = Turns::new("test", 1, 100);
        let running = turns.turn("greedy").await.unwrap();
        let mut greedy: Vec<_> = (0..20).map(|_| asked(&turns, "greedy")).collect();
        let mut modest = asked(&turns, "modest");
        drop(running);
        assert!((&mut modest).now_or_never().is_none());
        let first = (&mut greedy[0]).now_or_never().expect("the first of the greedy is first");
        drop(first.unwrap());
        let second = (&mut modest).now_or_never().expect("then it is the turn of the other");
        assert!(greedy[1..].iter_mut().all(|turn| turn.now_or_never().is_none()));
        drop(second.unwrap());
        assert!((&mut greedy[1]).now_or_never().is_some());
    }

    #[tokio::test]
    async fn more_than_may_wait_are_refused_and_who_leaves_makes_room() {
        let turns = Turns::new("test", 1, 2);
        let running = turns.turn("a").await.unwrap();
        let (one, two) = (asked(&turns, "a"), asked(&turns, "a"));
        let refused = turns.turn("a").await.err().unwrap();
        assert_eq!(refused.problem.code, ErrorCode::Busy);
        let mut other = asked(&turns, "b");
        drop((one, two));
        let mut third = asked(&turns, "a");
        drop(running);
        let turn = (&mut third).now_or_never().or_else(|| (&mut other).now_or_never());
        assert!(turn.is_some(), "places of those who left are not lost");
    }

    #[tokio::test]
    async fn a_turn_lasts_as_long_as_its_work() {
        let turns = Turns::new("test", 1, 2);
        let (go, wait) = std::sync::mpsc::channel::<()>();
        let turn = turns.turn("a").await.unwrap();
        let (begin, begun) = std::sync::mpsc::channel::<()>();
        let work = turn.compute(move || {
            begin.send(()).unwrap();
            wait.recv()
        });
        let left = work.boxed().now_or_never();
        assert!(left.is_none(), "it computes");
        begun.recv().unwrap();
        drop(turn);
        let next = asked(&turns, "a");
        go.send(()).unwrap();
        assert!(next.await.is_ok());
    }
}
