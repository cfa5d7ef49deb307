//! Every way of modelling that is built, as the variants of a study; a further one adds its lines here.

use super::variant::Variant;
use crate::prediction::{ElementChoice, Method, Settings};

/// All of them, each with its usual settings.
pub fn available() -> Vec<Variant> {
    let linear = [
        ("plain", ElementChoice::Plain),
        ("stabilised", ElementChoice::Stabilised),
        ("quadratic", ElementChoice::Quadratic),
    ];
    linear.into_iter().map(|(element, choice)| fem_linear(element, choice)).collect()
}

/// Those of one method by its name in documents; none where it is not built.
pub fn of_method(method: &str) -> Vec<Variant> {
    available().into_iter().filter(|variant| variant.method == method).collect()
}

fn fem_linear(element: &str, choice: ElementChoice) -> Variant {
    Variant {
        method: "fem_linear".to_owned(),
        label: format!("fem_linear {element}"),
        settings: Settings { method: Method::FemLinear, element: choice, ..Settings::default() },
    }
}
