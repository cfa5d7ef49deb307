//! The JSON documents: what is refused, where, and what becomes of what is accepted.

mod documents;
mod fibres;
mod laws;
mod methods;
mod muscles;
mod plan;
mod presets;
mod regions;
mod syntax;
mod wrong_types;
