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

/// What stands for every region of the tissue, and every tissue that an image shows.
const EVERY: &str = "*";

/// Every combination of the values, over the materials of a case and of the tissues that its image shows. The last constant of the last region varies
/// fastest; names tell what varies: `muscle E 300 kPa nu 0.44, soft nu 0.46`. `*` is every region and tissue, but for constants that
/// the sweep varies by name.
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
        let is_tissue = tissues.iter().any(|tissue| tissue.name == *region);
        if is_tissue && base.contains_key(region) {
            return Err(SweepError::TwoThings { region: region.clone() });
        }
        let starts = starts(region, base, tissues);
        if starts.is_empty() {
            return Err(SweepError::UnknownRegion { region: region.clone() });
        }
        starts.iter().try_for_each(|(name, start)| refuse_material(name, start, values))?;
        refuse_growth(region, is_tissue, values)?;
        let choices = choices(region, values);
        let pairs = all.iter().flat_map(|before| choices.iter().map(move |own| (before, own)));
        let with = |(before, own): (&Materials, &Choice)| own.over(before, tissues, sweep);
        all = pairs.map(with).collect::<Result<_, _>>()?;
    }
    Ok(all)
}

/// The materials, by their names, that a region of a sweep varies.
fn starts<'a>(
    region: &'a str,
    base: &'a BTreeMap<String, LinearElastic>,
    tissues: &'a [TissueWindow],
) -> Vec<(&'a str, &'a LinearElastic)> {
    let of_tissues = tissues.iter().map(|tissue| (tissue.name.as_str(), &tissue.material));
    if region == EVERY {
        return base.iter().map(|(name, own)| (name.as_str(), own)).chain(of_tissues).collect();
    }
    let of_tissue = of_tissues.filter(|(name, _)| *name == region).map(|(_, own)| own).next();
    let start = of_tissue.or_else(|| base.get(region)).or_else(|| base.get(EVERY));
    start.map(|start| (region, start)).into_iter().collect()
}

/// Whether the tissue of a case has a region of that name, or its image shows such a tissue; `*` is all of it.
pub fn has_region(case: &Case, region: &str) -> bool {
    let mut tissues = case.hounsfield.iter().flat_map(|image| &image.tissues);
    region == EVERY
        || tissues.any(|tissue| tissue.name == region)
        || match &case.regions {
            None => region == "tissue",
            Some(regions) => {
                regions.names.values().any(|name| name == region) || region.parse::<i64>().is_ok()
            }
        }
}

fn refuse_material(region: &str, start: &LinearElastic, values: &Values) -> Result<(), SweepError> {
    let region = || region.to_owned();
    if values.vary_material() && (start.has_fibre() || start.has_pulling_fibres()) {
        return Err(SweepError::Fibres { region: region() });
    }
    if values.vary_material() && start.stated_law().is_some() {
        return Err(SweepError::Law { region: region() });
    }
    Ok(())
}

fn refuse_growth(region: &str, is_tissue: bool, values: &Values) -> Result<(), SweepError> {
    let region = || region.to_owned();
    if is_tissue && !values.volume_change.is_empty() {
        return Err(SweepError::TissueGrows { region: region() });
    }
    match values.volume_change.iter().find(|change| !VOLUME_CHANGE.contains(change)) {
        Some(&volume_change) => Err(SweepError::VolumeChange { region: region(), volume_change }),
        None => Ok(()),
    }
}

/// What a region may become; nameless where nothing varies, and none where a value stays.
struct Choice {
    name: String,
    region: String,
    young_modulus: Option<f64>,
    poisson_ratio: Option<f64>,
    volume_change: Option<f64>,
}

fn choices(region: &str, values: &Values) -> Vec<Choice> {
    let varied = |values: &[f64]| match values {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect::<Vec<_>>(),
    };
    let called = if region == EVERY { "all" } else { region };
    let mut choices = Vec::new();
    for young_modulus in varied(&values.young_modulus) {
        for poisson_ratio in varied(&values.poisson_ratio) {
            for volume_change in varied(&values.volume_change) {
                let words = [
                    young_modulus.map(|e| format!(" E {e} kPa")),
                    poisson_ratio.map(|nu| format!(" nu {nu}")),
                    volume_change.map(|change| format!(" volume {:+} %", 100.0 * change)),
                ];
                let words: Vec<String> = words.into_iter().flatten().collect();
                let name = match words.is_empty() {
                    true => String::new(),
                    false => called.to_owned() + &words.concat(),
                };
                let region = region.to_owned();
                choices.push(Choice { name, region, young_modulus, poisson_ratio, volume_change });
            }
        }
    }
    choices
}

impl Choice {
    /// Materials with this choice over what they are before.
    fn over(
        &self,
        before: &Materials,
        tissues: &[TissueWindow],
        sweep: &BTreeMap<String, Values>,
    ) -> Result<Materials, SweepError> {
        let is_meant = |name: &str| self.region == EVERY || self.region == name;
        let mut with = before.clone();
        for tissue in tissues.iter().filter(|tissue| is_meant(&tissue.name)) {
            let own = with.tissues.entry(tissue.name.clone()).or_insert(tissue.material);
            *own = self.of(&tissue.name, own, sweep)?;
        }
        let is_tissue = tissues.iter().any(|tissue| tissue.name == self.region);
        let varies = self.young_modulus.is_some() || self.poisson_ratio.is_some();
        if let (true, Some(rest)) = (varies && !is_tissue, before.by_region.get(EVERY)) {
            with.by_region.entry(self.region.clone()).or_insert(*rest);
        }
        for (name, own) in with.by_region.iter_mut().filter(|(name, _)| is_meant(name)) {
            *own = self.of(name, own, sweep)?;
        }
        if let Some(volume_change) = self.volume_change {
            with.growth.push(Growth { region: self.region.clone(), volume_change });
        }
        let names = [&before.name, &self.name].into_iter().filter(|name| !name.is_empty());
        with.name = names.map(String::as_str).collect::<Vec<_>>().join(", ");
        Ok(with)
    }

    /// The material of a region with this choice; of `*` without what the sweep varies by the name of the region.
    fn of(
        &self,
        name: &str,
        before: &LinearElastic,
        sweep: &BTreeMap<String, Values>,
    ) -> Result<LinearElastic, SweepError> {
        let named = sweep.get(name).filter(|_| self.region != name);
        let is_own = |of: fn(&Values) -> &Vec<f64>| named.is_some_and(|own| !of(own).is_empty());
        let e = self.young_modulus.filter(|_| !is_own(|own| &own.young_modulus));
        let nu = self.poisson_ratio.filter(|_| !is_own(|own| &own.poisson_ratio));
        if e.is_none() && nu.is_none() {
            return Ok(*before);
        }
        let e = e.unwrap_or(before.young_modulus());
        let nu = nu.unwrap_or(before.poisson_ratio());
        LinearElastic::new(e, nu, before.density())
            .map_err(|source| SweepError::Material { region: name.to_owned(), source })
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
