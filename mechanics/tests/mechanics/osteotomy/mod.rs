//! METHODS rows 5 and 6: cuts part bone, and nodes of the tissue go with the bone behind them.

mod classes;
mod label_surfaces;
mod labelling;
mod surfaces;
