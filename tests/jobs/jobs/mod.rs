//! Jobs without a server: from documents to result files.

mod cell_sizes;
mod cohort;
mod comparisons;
mod cuts;
mod failures;
mod image;
mod learn;
mod load_steps;
mod optimise;
mod own_iterations;
mod planning;
mod predicted_head;
mod refined;
mod reproduce_damage;
mod results;
mod stop_at;
mod stress;
mod study_report;
mod test_piece;
mod twin;
