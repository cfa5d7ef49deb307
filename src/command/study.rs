//! `facies study`: methods against each other.

use std::path::PathBuf;

use clap::Args;

use super::failure::CommandError;
use super::stability;
use crate::prediction::{ElementChoice, Settings};
use crate::study::Variant;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Map where each method fails: what it does as movements, materials and meshes become impossible
    #[arg(long, required = true)]
    stability: bool,
    /// The folder for the result
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

/// Maps where methods fail.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    stability::run(&arguments.out, &variants())
}

/// Every element of the linear finite elements.
fn variants() -> Vec<Variant> {
    let elements = [
        ("plain", ElementChoice::Plain),
        ("stabilised", ElementChoice::Stabilised),
        ("quadratic", ElementChoice::Quadratic),
        ("mean dilatation", ElementChoice::MeanDilatation),
    ];
    let variant = |(name, element)| Variant {
        method: "fem_linear".to_owned(),
        label: format!("fem_linear {name}"),
        settings: Settings { element, ..Settings::default() },
    };
    elements.into_iter().map(variant).collect()
}
