//! The service from outside: the real server, its store, its queue.

mod bad_documents;
mod bad_meshes;
mod bad_requests;
mod cases;
mod demo;
mod faults;
mod helpers;
mod jobs;
mod meshes;
mod openapi;
mod plans;
mod queue;
mod settings;
mod worker;
