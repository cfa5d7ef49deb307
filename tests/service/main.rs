//! The service from outside: the real server, its store, its queue.

mod queue;
mod worker;
