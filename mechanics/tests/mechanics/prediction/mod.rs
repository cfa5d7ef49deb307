//! Predictions against closed forms, published numbers and each other.

mod adaptive;
mod adequate;
mod closed_form;
mod conditions;
mod contact;
mod contact_at_finite_strain;
pub mod elements;
mod fibres;
mod generic_face;
mod growth;
mod inner_at_finite_strain;
mod jump;
mod membrane_at_finite_strain;
mod moving_walls;
mod muscle_tissue;
mod muscles;
mod no_free_node;
mod nonlinearity;
mod numerical_error;
mod patch;
mod refined_scene;
mod skin;
mod slab_table;
mod sliding;
mod stress;
mod suspicious;
mod unheld;
