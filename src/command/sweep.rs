//! Sweeps of material constants as arguments of a study.

use std::collections::BTreeMap;

use crate::schema::study::document::SweepDocument;

const EVERY_REGION: &str = "*";
const FORM: &str = "a sweep is [REGION.]young_modulus_kpa=V,V,…, [REGION.]poisson_ratio=V,V,… or [REGION.]volume_change=V,V,…";

/// One argument: the constant of a region, and the values it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    region: String,
    constant: Constant,
    values: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Constant {
    YoungModulus,
    PoissonRatio,
    VolumeChange,
}

/// Reads `young_modulus_kpa=10,20` or `fat.poisson_ratio=0.43,0.47`.
pub fn sweep(text: &str) -> Result<Sweep, String> {
    let (place, values) = text.split_once('=').ok_or(FORM)?;
    let (region, constant) = place.rsplit_once('.').unwrap_or((EVERY_REGION, place));
    let constant = match constant {
        "young_modulus_kpa" => Constant::YoungModulus,
        "poisson_ratio" => Constant::PoissonRatio,
        "volume_change" => Constant::VolumeChange,
        other => return Err(format!("`{other}` is no constant: {FORM}")),
    };
    let number = |value: &str| {
        value.trim().parse::<f64>().map_err(|_| format!("`{value}` is not a number: {FORM}"))
    };
    let values = values.split(',').map(number).collect::<Result<_, _>>()?;
    Ok(Sweep { region: region.to_owned(), constant, values })
}

/// The document of several.
pub fn document(sweeps: &[Sweep]) -> BTreeMap<String, SweepDocument> {
    let mut regions: BTreeMap<String, SweepDocument> = BTreeMap::new();
    for Sweep { region, constant, values } in sweeps {
        let document = regions.entry(region.clone()).or_default();
        match constant {
            Constant::YoungModulus => document.young_modulus_kpa.extend(values),
            Constant::PoissonRatio => document.poisson_ratio.extend(values),
            Constant::VolumeChange => document.volume_change.extend(values),
        }
    }
    regions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_of_all_regions_and_of_one_are_swept() {
        let asked = ["young_modulus_kpa=10,20", "poisson_ratio=0.4", "fat.poisson_ratio=0.43,0.47"];
        let read: Vec<Sweep> = asked.into_iter().filter_map(|text| sweep(text).ok()).collect();
        let found = document(&read);
        assert_eq!(found["*"].young_modulus_kpa, [10.0, 20.0]);
        assert_eq!(
            (&found["*"].poisson_ratio[..], &found["fat"].poisson_ratio[..]),
            (&[0.4][..], &[0.43, 0.47][..])
        );
        for wrong in ["young_modulus_kpa", "density=1", "poisson_ratio=soft"] {
            assert!(sweep(wrong).is_err_and(|why| why.contains("a sweep is")), "{wrong}");
        }
    }
}
