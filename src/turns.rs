//! A fair queue for what only a few may do at a time: those who ask take turns (round robin), and of one of them who came
//! first goes first. A tenant that sends a hundred requests holds up nobody but itself.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

use crate::metrics::http;

/// Places of one kind, and the queue for them.
#[derive(Clone)]
pub struct Turns {
    what: &'static str,
    queue: Arc<Mutex<Queue>>,
}

struct Queue {
    free: usize,
    /// Most that wait in one line.
    most: usize,
    /// Lines in which somebody waits, in the order of their next turns.
    lines: VecDeque<Line>,
}

struct Line {
    name: String,
    waiting: VecDeque<oneshot::Sender<Turn>>,
}

/// A place that is taken, until the last clone is dropped.
#[derive(Clone)]
pub struct Turn {
    _place: Arc<Place>,
}

/// Handed on when it is dropped.
struct Place {
    turns: Option<Turns>,
}

/// As many wait in this line already as may.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full {
    pub most: usize,
}

enum Entered {
    Now,
    Later(oneshot::Receiver<Turn>),
}

impl Turns {
    /// `what` is what the places are for, in the words of the metrics; at most `most` wait in one line.
    pub fn new(what: &'static str, places: usize, most: usize) -> Turns {
        let queue = Queue { free: places, most, lines: VecDeque::new() };
        Turns { what, queue: Arc::new(Mutex::new(queue)) }
    }

    /// Waits for a turn. Who does not wait any more leaves the line.
    pub async fn turn(&self, line: &str) -> Result<Turn, Full> {
        loop {
            match self.enter(line)? {
                Entered::Now => return Ok(self.taken()),
                Entered::Later(turn) => {
                    if let Ok(turn) = turn.await {
                        return Ok(turn);
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
        if queue.free > 0 {
            queue.free -= 1;
            return Ok(Entered::Now);
        }
        let later = queue.wait(line);
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
    /// A place at the end of a line.
    fn wait(&mut self, name: &str) -> Result<oneshot::Receiver<Turn>, Full> {
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
        let (turn, later) = oneshot::channel();
        waiting.push_back(turn);
        Ok(later)
    }

    /// The first of the line whose turn it is.
    fn next(&mut self) -> Option<oneshot::Sender<Turn>> {
        loop {
            let mut line = self.lines.pop_front()?;
            let Some(first) = line.waiting.pop_front() else { continue };
            if !line.waiting.is_empty() {
                self.lines.push_back(line);
            }
            return Some(first);
        }
    }

    fn length(&self) -> usize {
        self.lines.iter().map(|line| line.waiting.len()).sum()
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

    /// One who has asked for a turn.
    fn asked<'a>(turns: &'a Turns, line: &'a str) -> BoxFuture<'a, Result<Turn, Full>> {
        let mut turn = turns.turn(line).boxed();
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
        let third = turns.turn("a").now_or_never().expect("it is told at once");
        assert_eq!(third.err(), Some(Full { most: 2 }));
        assert_eq!((turns.waiting("a"), turns.waiting("b")), (2, 0));
        let mut other = asked(&turns, "b");
        drop((one, two));
        assert_eq!(turns.waiting("a"), 0);
        let mut third = asked(&turns, "a");
        drop(running);
        let turn = (&mut third).now_or_never().or_else(|| (&mut other).now_or_never());
        assert!(turn.is_some(), "places of those who left are not lost");
    }

    #[tokio::test]
    async fn a_place_that_comes_to_one_who_has_left_goes_to_the_next() {
        let turns = Turns::new("test", 1, 2);
        let running = turns.turn("a").await.unwrap();
        let (one, mut other) = (asked(&turns, "a"), asked(&turns, "b"));
        drop(one);
        drop(running);
        assert!((&mut other).now_or_never().is_some());
    }
}
