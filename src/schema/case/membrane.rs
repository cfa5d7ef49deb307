//! The skin as a membrane.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fibre::to_course;
use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::material::{PlaneStress, Sheet, SheetError};
use mechanics::prediction::SkinMembrane;

/// A sheet on the skin faces of the case that resists stretching but not bending, beside the tissue under it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MembraneDocument {
    /// In [0.001, 20].
    #[serde(default = "default_thickness_mm")]
    #[schema(default = 1.5, minimum = 1e-3, maximum = 20.0)]
    pub thickness_mm: f64,
    /// In [1e-9, 1e9]; with lines, transverse to them.
    #[serde(default = "default_modulus_kpa")]
    #[schema(default = 200.0, minimum = 1e-9, maximum = 1e9)]
    pub young_modulus_kpa: f64,
    /// In [0, 0.5]; with lines, the transverse contraction under stretch along them.
    #[serde(default = "default_poisson_ratio")]
    #[schema(default = 0.45, minimum = 0.0, maximum = 0.5)]
    pub poisson_ratio: f64,
    /// In-plane stress of the skin when scanned, in balance with the tissue below, in [0, 1000]: a taut skin resists slopes
    /// and dents. Default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 1000.0)]
    pub pretension_kpa: Option<f64>,
    /// Lines along which the skin is stiffer, such as Langer's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fibre: Option<LinesDocument>,
    /// Whether the skin resists being pressed along itself. Default `carried`; `none`, for `fem_nonlinear` and with a `pretension_kpa` of
    /// at least a 200th of `young_modulus_kpa`, wrinkles instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub compression: Option<Compression>,
}

/// What a sheet does when it is pressed along itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Compression {
    /// It resists as it resists stretching; without bending stiffness it has no limit on finer meshes where it wrinkles.
    Carried,
    /// It wrinkles, as finely as needed, and carries tension only: a tension field.
    None,
}

/// Lines of the skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LinesDocument {
    /// Along the lines; in [1e-9, 1e9] and above nu^2 times the transverse one.
    #[schema(minimum = 1e-9, maximum = 1e9)]
    pub young_modulus_kpa: f64,
    /// Uniform on the skin; each face takes the component in its plane. Exactly one of `direction`
    /// and `array`; neither length nor sign matters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub direction: Option<Triple>,
    /// A point array of the volume mesh with 3 components.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub array: Option<String>,
}

fn default_thickness_mm() -> f64 {
    1.5
}

fn default_modulus_kpa() -> f64 {
    200.0
}

fn default_poisson_ratio() -> f64 {
    0.45
}

impl MembraneDocument {
    pub(in crate::schema) fn to_membrane(
        &self,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<SkinMembrane> {
        let fibre = at.key("fibre");
        let lines = self
            .fibre
            .as_ref()
            .map(|lines| to_course(lines.direction, lines.array.as_deref(), &fibre, faults));
        let sheet = PlaneStress::new(&Sheet {
            thickness: self.thickness_mm,
            young_modulus: self.young_modulus_kpa,
            poisson_ratio: self.poisson_ratio,
            along_lines: self.fibre.as_ref().map(|lines| lines.young_modulus_kpa),
        });
        let sheet = sheet.and_then(|own| own.with_tension(self.pretension_kpa.unwrap_or(0.0)));
        let sheet = sheet.and_then(|own| match self.compression {
            Some(Compression::None) => own.without_compression(),
            Some(Compression::Carried) | None => Ok(own),
        });
        match (sheet, lines) {
            (Ok(_), Some(None)) => None,
            (Ok(sheet), lines) => Some(SkinMembrane { sheet, lines: lines.flatten() }),
            (Err(error), _) => {
                let along = fibre.key("young_modulus_kpa");
                let (place, code) = match error {
                    SheetError::Thickness(_) => (at.key("thickness_mm"), ErrorCode::OutOfRange),
                    SheetError::YoungModulus(_) => {
                        (at.key("young_modulus_kpa"), ErrorCode::OutOfRange)
                    }
                    SheetError::PoissonRatio(_) => (at.key("poisson_ratio"), ErrorCode::OutOfRange),
                    SheetError::Tension(_) | SheetError::TooSlack { .. } => {
                        (at.key("pretension_kpa"), ErrorCode::OutOfRange)
                    }
                    SheetError::AlongLines(_) => (along, ErrorCode::OutOfRange),
                    SheetError::TooSoftAlongLines { .. } => (along, ErrorCode::NotPositiveDefinite),
                };
                faults.add(&place, code, error.to_string());
                None
            }
        }
    }
}
