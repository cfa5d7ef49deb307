//! Sweeps over the constants of regions and over changes of their volume (Zachow et al. 2006 vary nu and E of muscle and of the
//! tissue around it; docs/methods.md#studies): every combination as materials of a study, and the best of them.

use std::collections::BTreeMap;

use super::report::{Outcome, Report, Row};
use super::variant::Materials;
use crate::material::{LinearElastic, MaterialError};
use crate::prediction::{Case, Growth, TissueWindow, VOLUME_CHANGE};

/// More combinations are refused.
pub const MOST_COMBINATIONS: usize = 1000;

/// The values that the constants of a region take, and the changes of its volume; an empty list leaves what it is of as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// In kPa.
    pub young_modulus: Vec<f64>,
    pub poisson_ratio: Vec<f64>,
    /// As shares of the volume, over those of a plan.
    pub volume_change: Vec<f64>,
}

impl Values {
    fn combinations(&self) -> usize {
        let lists = [&self.young_modulus, &self.poisson_ratio, &self.volume_change];
        lists.map(|values| values.len().max(1)).iter().product()
    }

    /// Whether a constant of the material is among them.
    fn vary_material(&self) -> bool {
        !self.young_modulus.is_empty() || !self.poisson_ratio.is_empty()
    }
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
    #[error("{region:?} is a tissue of the image, and only regions of the mesh grow")]
    TissueGrows { region: String },
    #[error(
        "region {region:?}: a change of volume of {volume_change} is outside {} to {}", VOLUME_CHANGE.start(), VOLUME_CHANGE.end()
    )]
    VolumeChange { region: String, volume_change: f64 },
    #[error("region {region:?}: {source}")]
    Material { region: String, source: MaterialError },
}

impl SweepError {
    /// The region that it speaks of.
    pub fn region(&self) -> Option<&str> {
        match self {
            SweepError::TooMany { .. } => None,
            SweepError::UnknownRegion { region }
            | SweepError::TwoThings { region }
            | SweepError::Fibres { region }
            | SweepError::Law { region }
            | SweepError::TissueGrows { region }
            | SweepError::VolumeChange { region, .. }
            | SweepError::Material { region, .. } => Some(region),
        }
    }
}

/// Every combination of the values, over the materials of a case and of the tissues that its image shows. The last constant of the last region varies
/// fastest; names tell what varies: `muscle E 300 kPa nu 0.44, soft nu 0.46`.
pub fn combinations(
    base: &BTreeMap<String, LinearElastic>,
    tissues: &[TissueWindow],
    sweep: &BTreeMap<String, Values>,
) -> Result<Vec<Materials>, SweepError> {
    let product = |product: usize, values: &Values| product.saturating_mul(values.combinations());
    let combinations = sweep.values().fold(1, product);
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
        refuse(region, (start, tissue.is_some()), values)?;
        let choices = choices(region, start, values)?;
        let with = |before: &Materials| -> Vec<Materials> {
            choices.iter().map(|own| own.over(before, (region, tissue.is_some()))).collect()
        };
        all = all.iter().flat_map(with).collect();
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

/// What of a region cannot be swept.
fn refuse(
    region: &str,
    (start, is_tissue): (&LinearElastic, bool),
    values: &Values,
) -> Result<(), SweepError> {
    let region = || region.to_owned();
    if values.vary_material() && (start.has_fibre() || start.has_pulling_fibres()) {
        return Err(SweepError::Fibres { region: region() });
    }
    if values.vary_material() && start.stated_law().is_some() {
        return Err(SweepError::Law { region: region() });
    }
    if is_tissue && !values.volume_change.is_empty() {
        return Err(SweepError::TissueGrows { region: region() });
    }
    match values.volume_change.iter().find(|change| !VOLUME_CHANGE.contains(change)) {
        Some(&volume_change) => Err(SweepError::VolumeChange { region: region(), volume_change }),
        None => Ok(()),
    }
}

/// What a region may become; nameless where nothing varies.
struct Choice {
    name: String,
    /// None where its constants stay.
    material: Option<LinearElastic>,
    volume_change: Option<f64>,
}

fn choices(
    region: &str,
    start: &LinearElastic,
    values: &Values,
) -> Result<Vec<Choice>, SweepError> {
    let varied = |values: &[f64]| match values {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect::<Vec<_>>(),
    };
    let called = if region == "*" { "all" } else { region };
    let mut choices = Vec::new();
    for e in varied(&values.young_modulus) {
        for nu in varied(&values.poisson_ratio) {
            let of = |source| SweepError::Material { region: region.to_owned(), source };
            let varied_material = || {
                let (e, nu) =
                    (e.unwrap_or(start.young_modulus()), nu.unwrap_or(start.poisson_ratio()));
                LinearElastic::new(e, nu, start.density()).map_err(of)
            };
            let material = values.vary_material().then(varied_material).transpose()?;
            for volume_change in varied(&values.volume_change) {
                let words = [
                    e.map(|e| format!(" E {e} kPa")),
                    nu.map(|nu| format!(" nu {nu}")),
                    volume_change.map(|change| format!(" volume {:+} %", 100.0 * change)),
                ];
                let words: Vec<String> = words.into_iter().flatten().collect();
                let name = match words.is_empty() {
                    true => String::new(),
                    false => called.to_owned() + &words.concat(),
                };
                choices.push(Choice { name, material, volume_change });
            }
        }
    }
    Ok(choices)
}

impl Choice {
    /// Materials with this choice over what they are before.
    fn over(&self, before: &Materials, (region, is_tissue): (&str, bool)) -> Materials {
        let mut with = before.clone();
        if let Some(material) = self.material {
            let of = if is_tissue { &mut with.tissues } else { &mut with.by_region };
            of.insert(region.to_owned(), material);
        }
        if let Some(volume_change) = self.volume_change {
            with.growth.push(Growth { region: region.to_owned(), volume_change });
        }
        let names = [&before.name, &self.name].into_iter().filter(|name| !name.is_empty());
        with.name = names.map(String::as_str).collect::<Vec<_>>().join(", ");
        with
    }
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
    /// As a share of the volume.
    VolumeChange,
}

/// The constants of a sweep in the order of its combinations: the last one varies fastest.
pub fn axes(sweep: &BTreeMap<String, Values>) -> Vec<SweptAxis> {
    let of_region = |(region, values): (&String, &Values)| {
        let all = [
            (Constant::YoungModulus, &values.young_modulus),
            (Constant::PoissonRatio, &values.poisson_ratio),
            (Constant::VolumeChange, &values.volume_change),
        ];
        all.map(|(constant, values)| SweptAxis {
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
