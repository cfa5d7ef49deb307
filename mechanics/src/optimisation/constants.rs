//! Tissue constants as parameters: their places in a scene and the derivatives of its skin.
//!
//! Poisson's ratio nu is a parameter as it is, Young's modulus E by its logarithm: only ratios of moduli move skin that nothing
//! but bone pulls at. The derivative of the skin is that of the plan at hand, by a difference of two full solutions.

use super::ConstantColumn;
use crate::material::{LinearElastic, MaterialError};
use crate::prediction::Scene;
use crate::progress::Progress;
use crate::response::{Amounts, ColumnRequest, ResponseError, solved_skin};

/// Half the difference by which derivatives are taken, of nu and of ln E: what it leaves out is a millionth, and what a
/// residual of 1e-8 leaves of each skin is 1e-5 of the derivative.
const STEP: f64 = 1e-3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstantKind {
    /// In kPa; its parameter is its natural logarithm.
    YoungModulus,
    PoissonRatio,
}

/// Between which values a constant of some regions may be; equal ends hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantBounds {
    /// By their numbers in `Scene::regions`; all become the same.
    pub regions: Vec<usize>,
    pub kind: ConstantKind,
    pub interval: (f64, f64),
}

/// Why a constant cannot be looked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConstantError {
    #[error("it is of no region")]
    NoRegion,
    #[error("the material has fibres, and what is looked for are constants of isotropic ones")]
    Fibres,
    #[error(
        "the material states a law of finite strain, and what is looked for are constants of linear ones"
    )]
    Law,
    #[error("tissue has its constants from an image or from muscles, cell by cell")]
    ByCell,
    #[error(transparent)]
    Material(#[from] MaterialError),
}

impl ConstantBounds {
    /// Whether it can be looked for in a scene.
    pub fn check(&self, scene: &Scene) -> Result<(), ConstantError> {
        if self.regions.is_empty() {
            return Err(ConstantError::NoRegion);
        }
        if scene.imaged.is_some() || scene.muscle_tissue.is_some() {
            return Err(ConstantError::ByCell);
        }
        for &region in &self.regions {
            let material = &scene.materials[region];
            if material.has_fibre() || material.has_pulling_fibres() {
                return Err(ConstantError::Fibres);
            }
            if material.stated_law().is_some() {
                return Err(ConstantError::Law);
            }
            for end in [self.interval.0, self.interval.1] {
                self.kind.of(material, self.kind.parameter(end))?;
            }
        }
        Ok(())
    }

    /// The interval of the parameter.
    pub(super) fn parameters(&self) -> (f64, f64) {
        (self.kind.parameter(self.interval.0), self.kind.parameter(self.interval.1))
    }

    /// The parameter as a scene has it, within its interval.
    pub(super) fn start(&self, scene: &Scene) -> f64 {
        let (low, high) = self.parameters();
        let material = self.regions.first().and_then(|&region| scene.materials.get(region));
        material.map_or(low, |own| self.kind.parameter(self.kind.value(own)).clamp(low, high))
    }

    pub(super) fn set(&self, scene: &mut Scene, parameter: f64) -> Result<(), ConstantError> {
        for &region in &self.regions {
            scene.materials[region] = self.kind.of(&scene.materials[region], parameter)?;
        }
        Ok(())
    }

    /// Derivative of the skin of a plan by the constant, near the value of a scene.
    pub(super) fn column(
        &self,
        scene: &mut Scene,
        (asked, amounts): (&ColumnRequest, &Amounts),
        value: f64,
        progress: &dyn Progress,
    ) -> Result<ConstantColumn, ConstantFailure> {
        let [low, high] = self.kind.beside(value);
        let mut skin_at = |parameter: f64| {
            self.set(scene, parameter)?;
            Ok::<_, ConstantFailure>(solved_skin(scene, asked, amounts, progress)?)
        };
        let (below, above) = (skin_at(low)?, skin_at(high)?);
        self.set(scene, value)?;
        let slopes = below.iter().zip(&above).map(|(below, above)| (above - below) / (high - low));
        let derivative = slopes.flat_map(|u| [u.x, u.y, u.z].map(|value| value as f32)).collect();
        Ok(ConstantColumn { derivative, value, interval: self.parameters() })
    }
}

#[derive(Debug, thiserror::Error)]
pub(super) enum ConstantFailure {
    #[error(transparent)]
    Constant(#[from] ConstantError),
    #[error(transparent)]
    Response(#[from] ResponseError),
}

impl ConstantKind {
    fn value(self, material: &LinearElastic) -> f64 {
        match self {
            ConstantKind::YoungModulus => material.young_modulus(),
            ConstantKind::PoissonRatio => material.poisson_ratio(),
        }
    }

    fn parameter(self, value: f64) -> f64 {
        match self {
            ConstantKind::YoungModulus => value.ln(),
            ConstantKind::PoissonRatio => value,
        }
    }

    /// The constant that a parameter stands for.
    pub fn constant(self, parameter: f64) -> f64 {
        match self {
            ConstantKind::YoungModulus => parameter.exp(),
            ConstantKind::PoissonRatio => parameter,
        }
    }

    fn of(self, material: &LinearElastic, parameter: f64) -> Result<LinearElastic, MaterialError> {
        let value = self.constant(parameter);
        let (e, nu) = match self {
            ConstantKind::YoungModulus => (value, material.poisson_ratio()),
            ConstantKind::PoissonRatio => (material.young_modulus(), value),
        };
        LinearElastic::new(e, nu, material.density())
    }

    /// Two parameters between which the derivative is taken, both of them ones that a material may have.
    fn beside(self, parameter: f64) -> [f64; 2] {
        match self {
            ConstantKind::YoungModulus => [parameter - STEP, parameter + STEP],
            ConstantKind::PoissonRatio => {
                let step = STEP.min((0.5 - parameter) / 4.0);
                [(parameter - step).max(0.0), parameter + step]
            }
        }
    }
}
