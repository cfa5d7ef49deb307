//! Real faces and a real CT, from the documents to the results.

pub mod ct;
pub mod cuts;
pub mod faces;
