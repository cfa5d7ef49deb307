//! Sweeps over the constants of regions (Zachow et al. 2006 vary nu and E of muscle and of the
//! tissue around it; docs/methods.md#studies): every combination as materials of a study, and the best of them.

use std::collections::BTreeMap;

use super::report::{Outcome, Report, Row};
use super::variant::Materials;
use crate::material::{LinearElastic, MaterialError};
use crate::prediction::{Case, TissueWindow};

/// More combinations are refused.
pub const MOST_COMBINATIONS: usize = 1000;

/// The values that the constants of a region take; an empty list leaves the constant as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// In kPa.
    pub young_modulus: Vec<f64>,
    pub poisson_ratio: Vec<f64>,
}

/// Why a sweep is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SweepError {
    #[error("the sweep has {combinations} combinations, at most {MOST_COMBINATIONS} are allowed")]
    TooMany { combinations: usize },
    #[error("region {region:?} has no material that a sweep could start from")]
    UnknownRegion { region: String },
    #[error(
        "{region:?} is a region of the tissue and a tissue of the image: only one of them can be meant"
    )]
    TwoThings { region: String },
    #[error("the material of region {region:?} has fibres, and a sweep varies isotropic ones")]
    Fibres { region: String },
    #[error(
        "the material of region {region:?} states a law of finite strain, and a sweep varies linear ones"
    )]
    Law { region: String },
    #[error("region {region:?}: {source}")]
    Material { region: String, source: MaterialError },
}

/// Every combination of the values, over the materials of a case and of the tissues that its image shows. The last constant of the last region varies
/// fastest; names tell what varies: `muscle E 300 kPa nu 0.44, soft nu 0.46`.
pub fn combinations(
    base: &BTreeMap<String, LinearElastic>,
    tissues: &[TissueWindow],
    sweep: &BTreeMap<String, Values>,
) -> Result<Vec<Materials>, SweepError> {
    let count =
        |values: &Values| values.young_modulus.len().max(1) * values.poisson_ratio.len().max(1);
    let combinations =
        sweep.values().fold(1, |product: usize, values| product.saturating_mul(count(values)));
    if combinations > MOST_COMBINATIONS {
        return Err(SweepError::TooMany { combinations });
    }
    let mut all = vec![Materials { by_region: base.clone(), ..Materials::default() }];
    for (region, values) in sweep {
        let tissue = tissues.iter().find(|tissue| tissue.name == *region);
        if tissue.is_some() && base.contains_key(region) {
            return Err(SweepError::TwoThings { region: region.clone() });
        }
        let start = tissue.map(|tissue| &tissue.material).or_else(|| base.get(region));
        let start = start.or_else(|| base.get("*"));
        let start = start.ok_or_else(|| SweepError::UnknownRegion { region: region.clone() })?;
        if start.has_fibre() || start.has_pulling_fibres() {
            return Err(SweepError::Fibres { region: region.clone() });
        }
        if start.stated_law().is_some() {
            return Err(SweepError::Law { region: region.clone() });
        }
        let choices = choices(region, start, values)?;
        all = all
            .iter()
            .flat_map(|before| {
                choices.iter().map(|(name, material)| {
                    with(before, (region, tissue.is_some()), name, material)
                })
            })
            .collect();
    }
    Ok(all)
}

/// Whether the tissue of a case has a region of that name, or its image shows such a tissue; `*` is all of it.
pub fn has_region(case: &Case, region: &str) -> bool {
    let mut tissues = case.hounsfield.iter().flat_map(|image| &image.tissues);
    region == "*"
        || tissues.any(|tissue| tissue.name == region)
        || match &case.regions {
            None => region == "tissue",
            Some(regions) => {
                regions.names.values().any(|name| name == region) || region.parse::<i64>().is_ok()
            }
        }
}

/// What a region may become, each with its name; one nameless choice where nothing varies.
fn choices(
    region: &str,
    start: &LinearElastic,
    values: &Values,
) -> Result<Vec<(String, LinearElastic)>, SweepError> {
    let varied = |values: &[f64]| match values {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect::<Vec<_>>(),
    };
    let mut choices = Vec::new();
    for e in varied(&values.young_modulus) {
        for nu in varied(&values.poisson_ratio) {
            let words: Vec<String> =
                [e.map(|e| format!(" E {e} kPa")), nu.map(|nu| format!(" nu {nu}"))]
                    .into_iter()
                    .flatten()
                    .collect();
            let material = LinearElastic::new(
                e.unwrap_or(start.young_modulus()),
                nu.unwrap_or(start.poisson_ratio()),
                start.density(),
            )
            .map_err(|source| SweepError::Material { region: region.to_owned(), source })?;
            let called = if region == "*" { "all" } else { region };
            let name =
                if words.is_empty() { String::new() } else { called.to_owned() + &words.concat() };
            choices.push((name, material));
        }
    }
    Ok(choices)
}

fn with(
    before: &Materials,
    (region, is_tissue): (&str, bool),
    name: &str,
    material: &LinearElastic,
) -> Materials {
    let mut with = before.clone();
    let of = if is_tissue { &mut with.tissues } else { &mut with.by_region };
    of.insert(region.to_owned(), *material);
    let names = [before.name.as_str(), name].into_iter().filter(|name| !name.is_empty());
    with.name = names.collect::<Vec<_>>().join(", ");
    with
}

/// A constant that takes several values.
#[derive(Clone, Debug, PartialEq)]
pub struct SweptAxis {
    pub region: String,
    pub constant: Constant,
    pub values: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// In kPa.
    YoungModulus,
    PoissonRatio,
}

/// The constants of a sweep in the order of its combinations: the last one varies fastest.
pub fn axes(sweep: &BTreeMap<String, Values>) -> Vec<SweptAxis> {
    let of_region = |(region, values): (&String, &Values)| {
        let both = [
            (Constant::YoungModulus, &values.young_modulus),
            (Constant::PoissonRatio, &values.poisson_ratio),
        ];
        both.map(|(constant, values)| SweptAxis {
            region: region.clone(),
            constant,
            values: values.clone(),
        })
    };
    sweep.iter().flat_map(of_region).filter(|axis| !axis.values.is_empty()).collect()
}

/// Which rows a sweep is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged<'a> {
    pub scene: &'a str,
    pub plan: &'a str,
    pub label: &'a str,
    pub level: u32,
}

/// The row whose materials leave the least mean error; the first of equal ones.
pub fn best<'r>(report: &'r Report, judged: &Judged) -> Option<&'r Row> {
    let wanted = |row: &&Row| {
        row.scene == judged.scene
            && row.plan == judged.plan
            && row.label == judged.label
            && row.level == judged.level
    };
    let error = |row: &'r Row| match &row.outcome {
        Outcome::Solved(solved) => Some((row, solved.error.mean)),
        Outcome::Failed { .. } => None,
    };
    let rows = report.rows.iter().filter(wanted).filter_map(error);
    rows.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}
