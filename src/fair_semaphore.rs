//! A fair counting semaphore: permits go round robin between tenants, and within a tenant in the order of its requests.
//! A tenant that sends a hundred requests delays only itself, and where one permit is kept for others, it never has all.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

use crate::metrics::http;

/// A semaphore whose permits go round robin between tenants.
#[derive(Clone)]
pub struct FairSemaphore {
    what: &'static str,
    queue: Arc<Mutex<Queue>>,
}

struct Queue {
    free: usize,
    /// Most permits of one line at a time.
    most_held: usize,
    /// Permits of each line that has some.
    held: BTreeMap<String, usize>,
    /// Most that wait in one line.
    most: usize,
    /// Nonempty queues in the order of their next turns.
    lines: VecDeque<Line>,
}

struct Line {
    name: String,
    waiting: VecDeque<oneshot::Sender<Permit>>,
}

/// A permit, held until the last clone is dropped.
#[derive(Clone)]
pub struct Permit {
    _slot: Arc<Slot>,
}

/// Handed on when it is dropped.
struct Slot {
    line: String,
    semaphore: Option<FairSemaphore>,
}

/// The queue is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full {
    pub most: usize,
}

enum Entered {
    Now,
    Later(oneshot::Receiver<Permit>),
}

impl FairSemaphore {
    /// `what` is what the places are for, in the words of the metrics; at most `most` wait in one line.
    pub fn new(what: &'static str, places: usize, most: usize) -> FairSemaphore {
        FairSemaphore::holding(what, places, places, most)
    }

    /// The same where one line holds all places but one at most: long work of one never keeps all others waiting. Of a single place it
    /// may hold that.
    pub fn keeping_one(what: &'static str, places: usize, most: usize) -> FairSemaphore {
        FairSemaphore::holding(what, places, places.saturating_sub(1).max(1), most)
    }

    fn holding(what: &'static str, places: usize, most_held: usize, most: usize) -> FairSemaphore {
        let (held, lines) = (BTreeMap::new(), VecDeque::new());
        let queue = Queue { free: places, most_held, held, most, lines };
        FairSemaphore { what, queue: Arc::new(Mutex::new(queue)) }
    }

    /// Waits for a permit. A future that is dropped leaves the queue.
    pub async fn acquire(&self, line: &str) -> Result<Permit, Full> {
        loop {
            match self.enter(line)? {
                Entered::Now => return Ok(self.taken(line.to_owned())),
                Entered::Later(permit) => {
                    if let Ok(permit) = permit.await {
                        return Ok(permit);
                    }
                }
            }
        }
    }

    /// How many wait in a line.
    pub fn waiting(&self, line: &str) -> usize {
        let queue = self.lock();
        let own = queue.lines.iter().find(|known| known.name == line);
        own.map_or(0, |line| line.waiting.iter().filter(|other| !other.is_closed()).count())
    }

    fn enter(&self, line: &str) -> Result<Entered, Full> {
        let mut queue = self.lock();
        if queue.free > 0 && queue.may_hold_more(line) {
            queue.take(line);
            return Ok(Entered::Now);
        }
        let later = queue.wait(line);
        http::waiting(self.what, queue.length());
        later.map(Entered::Later)
    }

    fn taken(&self, line: String) -> Permit {
        Permit { _slot: Arc::new(Slot { line, semaphore: Some(self.clone()) }) }
    }

    /// Takes a permit back from a line and gives it to the next waiting request that may have it.
    fn pass_on(&self, mut line: String) {
        loop {
            let mut queue = self.lock();
            queue.release(&line);
            let next = queue.next();
            http::waiting(self.what, queue.length());
            let Some((name, next)) = next else { return };
            drop(queue);
            line.clone_from(&name);
            let Err(permit) = next.send(self.taken(name)) else { return };
            // The waiting request is gone: the permit goes to the next one.
            if let Some(mut slot) = Arc::into_inner(permit._slot) {
                slot.semaphore = None;
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    /// A place at the end of a line.
    fn wait(&mut self, name: &str) -> Result<oneshot::Receiver<Permit>, Full> {
        let most = self.most;
        let known = self.lines.iter().position(|line| line.name == name);
        let at = known.unwrap_or_else(|| {
            self.lines.push_back(Line { name: name.to_owned(), waiting: [].into() });
            self.lines.len() - 1
        });
        let waiting = &mut self.lines[at].waiting;
        // Those who have gone wait no more.
        waiting.retain(|other| !other.is_closed());
        if waiting.len() >= most {
            return Err(Full { most });
        }
        let (permit, later) = oneshot::channel();
        waiting.push_back(permit);
        Ok(later)
    }

    /// Takes a permit for the first of the line whose turn it is, of those that may hold one more.
    fn next(&mut self) -> Option<(String, oneshot::Sender<Permit>)> {
        loop {
            let turn = self.lines.iter().position(|line| self.may_hold_more(&line.name))?;
            let mut line = self.lines.remove(turn)?;
            let Some(first) = line.waiting.pop_front() else { continue };
            let name = line.name.clone();
            self.take(&name);
            if !line.waiting.is_empty() {
                self.lines.push_back(line);
            }
            return Some((name, first));
        }
    }

    fn may_hold_more(&self, line: &str) -> bool {
        self.held.get(line).is_none_or(|held| *held < self.most_held)
    }

    fn take(&mut self, line: &str) {
        self.free -= 1;
        *self.held.entry(line.to_owned()).or_default() += 1;
    }

    fn release(&mut self, line: &str) {
        self.free += 1;
        if let Some(held) = self.held.get_mut(line) {
            *held -= 1;
            if *held == 0 {
                self.held.remove(line);
            }
        }
    }

    fn length(&self) -> usize {
        self.lines.iter().map(|line| line.waiting.len()).sum()
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        if let Some(semaphore) = self.semaphore.take() {
            semaphore.pass_on(std::mem::take(&mut self.line));
        }
    }
}

#[cfg(test)]
mod tests {
    use futures::FutureExt as _;
    use futures::future::BoxFuture;

    use super::*;

    /// A request that waits for a permit.
    fn asked<'a>(
        semaphore: &'a FairSemaphore,
        line: &'a str,
    ) -> BoxFuture<'a, Result<Permit, Full>> {
        let mut permit = semaphore.acquire(line).boxed();
        assert!((&mut permit).now_or_never().is_none(), "it waits");
        permit
    }

    #[tokio::test]
    async fn a_tenant_that_comes_late_waits_for_one_turn_of_another_and_not_for_all() {
        let semaphore = FairSemaphore::new("test", 1, 100);
        let running = semaphore.acquire("greedy").await.unwrap();
        let mut greedy: Vec<_> = (0..20).map(|_| asked(&semaphore, "greedy")).collect();
        let mut modest = asked(&semaphore, "modest");
        drop(running);
        assert!((&mut modest).now_or_never().is_none());
        let first = (&mut greedy[0]).now_or_never().expect("the first of the greedy is first");
        drop(first.unwrap());
        let second = (&mut modest).now_or_never().expect("then it is the turn of the other");
        assert!(greedy[1..].iter_mut().all(|permit| permit.now_or_never().is_none()));
        drop(second.unwrap());
        assert!((&mut greedy[1]).now_or_never().is_some());
    }

    #[tokio::test]
    async fn a_tenant_never_has_all_permits_where_one_is_kept_for_others() {
        let semaphore = FairSemaphore::keeping_one("test", 3, 100);
        let one = semaphore.acquire("greedy").await.unwrap();
        let two = semaphore.acquire("greedy").await.unwrap();
        let (mut third, mut fourth) = (asked(&semaphore, "greedy"), asked(&semaphore, "greedy"));
        let other = (&mut semaphore.acquire("modest").boxed()).now_or_never();
        let other = other.expect("it has the one that is kept").unwrap();
        let mut late = asked(&semaphore, "modest");
        // The permit that is kept goes to others, also where a tenant with enough waits longer.
        drop(other);
        let late = (&mut late).now_or_never().expect("it is not for the greedy").unwrap();
        drop(late);
        assert!((&mut third).now_or_never().is_none(), "nobody else waits, and yet it is kept");
        drop(one);
        let third = (&mut third).now_or_never().expect("its own permit is free");
        assert!((&mut fourth).now_or_never().is_none());
        drop((two, third));
        assert!((&mut fourth).now_or_never().is_some(), "no permit is lost");
    }

    #[tokio::test]
    async fn one_permit_is_for_everybody_also_where_one_is_kept() {
        let semaphore = FairSemaphore::keeping_one("test", 1, 100);
        let running = semaphore.acquire("a").await.unwrap();
        let (gone, mut next) = (asked(&semaphore, "a"), asked(&semaphore, "a"));
        drop(gone);
        drop(running);
        assert!((&mut next).now_or_never().is_some(), "who has left holds none");
    }

    #[tokio::test]
    async fn more_than_may_wait_are_refused_and_who_leaves_makes_room() {
        let semaphore = FairSemaphore::new("test", 1, 2);
        let running = semaphore.acquire("a").await.unwrap();
        let (one, two) = (asked(&semaphore, "a"), asked(&semaphore, "a"));
        let third = semaphore.acquire("a").now_or_never().expect("it is told at once");
        assert_eq!(third.err(), Some(Full { most: 2 }));
        assert_eq!((semaphore.waiting("a"), semaphore.waiting("b")), (2, 0));
        let mut other = asked(&semaphore, "b");
        drop((one, two));
        assert_eq!(semaphore.waiting("a"), 0);
        let mut third = asked(&semaphore, "a");
        drop(running);
        let permit = (&mut third).now_or_never().or_else(|| (&mut other).now_or_never());
        assert!(permit.is_some(), "places of those who left are not lost");
    }

    #[tokio::test]
    async fn a_place_that_comes_to_one_who_has_left_goes_to_the_next() {
        let semaphore = FairSemaphore::new("test", 1, 2);
        let running = semaphore.acquire("a").await.unwrap();
        let (one, mut other) = (asked(&semaphore, "a"), asked(&semaphore, "b"));
        drop(one);
        drop(running);
        assert!((&mut other).now_or_never().is_some());
    }
}
