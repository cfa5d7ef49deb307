//! Cuts part bone, and nodes of the tissue go with the bone behind them (docs/methods.md#cuts).

mod classes;
mod label_surfaces;
mod labelling;
mod surfaces;
