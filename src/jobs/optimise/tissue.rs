//! Unknown growth and constants of regions, and the resulting materials.

use super::input::OptimiseInput;
use crate::jobs::failure::JobError;
use crate::jobs::predict::Prepared;
use crate::schema::case::material::{MaterialDocument, MaterialDocuments};
use crate::schema::optimise::result::NamedConstant;
use crate::schema::{ErrorCode, Pointer, Problem};
use mechanics::mesh::ignored::listed;
use mechanics::optimisation::{ConstantBounds, ConstantError, ConstantKind, InnerBounds};
use mechanics::prediction::{Scene, nothing_left};
use mechanics::response::InnerLoad;

/// An unknown constant, and its region.
pub struct TissueConstant {
    pub region: String,
    pub bounds: ConstantBounds,
}

impl TissueConstant {
    pub fn named(&self) -> NamedConstant {
        (self.region.clone(), self.bounds.kind)
    }
}

impl OptimiseInput {
    /// The bounds of each column of growth and muscles.
    pub(super) fn inner_bounds(&self, inner: &[InnerLoad]) -> Vec<InnerBounds> {
        let bounds = |load: &InnerLoad| match load {
            InnerLoad::Growth(region) => {
                let mut stated = self.spec.growth.iter();
                match stated.find(|own| own.region.trim() == region) {
                    Some(own) => InnerBounds::Growth(own.volume_change, own.volume_change),
                    None => {
                        let free = self.spec.tissue_bounds_of(region).volume_change;
                        let [low, high] = free.unwrap_or_default().0;
                        InnerBounds::Growth(low, high)
                    }
                }
            }
            InnerLoad::Muscle(name) => {
                let mut stated = self.spec.activations.iter();
                let own = stated.find(|own| own.muscle.trim() == name);
                InnerBounds::Held(own.map_or(0.0, |own| own.stress_kpa))
            }
        };
        inner.iter().map(bounds).collect()
    }

    /// Refuses growth of `*` where every region has growth of its own, as a prediction of the plan would at the end.
    pub(super) fn check_growth(&self, scene: &Scene) -> Result<(), JobError> {
        let growing = self.spec.growing();
        let Some(detail) = nothing_left(growing.iter().map(String::as_str), &scene.regions) else {
            return Ok(());
        };
        let spec = Pointer::root().key("spec");
        let stated = self.spec.growth.iter().position(|own| own.region.trim() == "*");
        let at = match stated {
            Some(index) => spec.key("growth").index(index).key("region"),
            None => spec.key("tissue_bounds").key("*").key("volume_change"),
        };
        Err(refused(&at, ErrorCode::UnknownRegion, detail))
    }

    /// The unknown constants; refuses those of regions that a case does not have, and of tissue that is not
    /// isotropic.
    pub(super) fn constants(&self, rest: &Prepared) -> Result<Vec<TissueConstant>, JobError> {
        let mut constants = Vec::new();
        for (name, own) in &self.spec.tissue_bounds {
            let at = Pointer::root().key("spec").key("tissue_bounds").key(name);
            let region = name.trim().to_owned();
            for (kind, [low, high]) in own.constants() {
                let regions = self.regions_of(&region, rest);
                let Some(regions) = regions else {
                    let known = listed(rest.scene.regions.iter());
                    let detail = format!("the case has no region {region:?}; its regions: {known}");
                    return Err(refused(&at, ErrorCode::UnknownRegion, detail));
                };
                let bounds = ConstantBounds { regions, kind, interval: (low, high) };
                bounds.check(&rest.scene).map_err(|error| {
                    let code = match error {
                        ConstantError::NoRegion => ErrorCode::EmptySelection,
                        ConstantError::Fibres | ConstantError::Law | ConstantError::ByCell => {
                            ErrorCode::MethodNotAvailable
                        }
                        ConstantError::Material(_) => ErrorCode::OutOfRange,
                    };
                    let detail = format!("{} of region {region:?}: {error}", words(kind));
                    refused(&at, code, detail)
                })?;
                constants.push(TissueConstant { region: region.clone(), bounds });
            }
        }
        Ok(constants)
    }

    /// The numbers of the regions of a name: `*` for those without constants of their own to look for.
    fn regions_of(&self, name: &str, rest: &Prepared) -> Option<Vec<usize>> {
        let regions = || rest.scene.regions.iter().enumerate();
        if name != "*" {
            return regions().find(|(_, own)| *own == name).map(|(number, _)| vec![number]);
        }
        let has_bounds = |region: &str| {
            let mut all = self.spec.tissue_bounds.iter();
            all.any(|(name, own)| name.trim() == region && !own.constants().is_empty())
        };
        Some(regions().filter(|(_, own)| !has_bounds(own)).map(|(number, _)| number).collect())
    }

    /// The materials of the spec with the present constants of a scene; none if none are unknown.
    pub(super) fn materials(
        &self,
        constants: &[TissueConstant],
        rest: &Prepared,
    ) -> Option<MaterialDocuments> {
        let scene = &rest.scene;
        let mut materials = self.spec.materials.clone().unwrap_or_default();
        for TissueConstant { region, bounds } in constants {
            for &number in &bounds.regions {
                let own = scene.materials.get(number)?;
                let name = &scene.regions[number];
                let has_own = rest.case.materials.contains_key(name);
                let stated = materials.entry(if has_own { name } else { region }.clone());
                let stated = stated.or_default();
                *stated = MaterialDocument {
                    young_modulus_kpa: Some(own.young_modulus()),
                    poisson_ratio: Some(own.poisson_ratio()),
                    density_g_per_cm3: Some(own.density()),
                    ..stated.clone()
                };
            }
        }
        (!constants.is_empty()).then_some(materials)
    }
}

fn refused(at: &Pointer, code: ErrorCode, detail: String) -> JobError {
    JobError::Refused(Problem::at(at, code, detail))
}

fn words(kind: ConstantKind) -> &'static str {
    match kind {
        ConstantKind::YoungModulus => "Young's modulus",
        ConstantKind::PoissonRatio => "Poisson's ratio",
    }
}
