//! The JSON documents: what is refused, where, and what becomes of what is accepted.

pub mod documents;
mod fibres;
mod methods;
mod plan;
mod syntax;
