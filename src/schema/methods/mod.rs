//! Methods in documents: for each a row with its description, its settings and their conversion to the numerics.

mod document;
pub mod dvs;
mod fem_linear;
pub mod fem_nonlinear;
mod list;
mod measured;
pub mod msm;
pub mod mtm;
mod mtm_nonlinear;
mod mtm_ti;
mod name;
pub mod thickness_warp;

use document::Description;
pub use document::{MethodDocument, ParameterDocument};
use dvs::DvsDocument;
use fem_nonlinear::FemNonlinearDocument;
pub use list::{
    MeasuredMethod, MethodList, OptimiseMethod, ResponseMethod, available_methods, check_linear,
};
pub use measured::{MeasuredDocument, time_band};
use msm::MassSpringDocument;
use mtm::MassTensorDocument;
pub use name::{
    ElementName, MethodName, WHY_ASKED, WHY_ESTIMATED, WHY_LINEAR, WHY_NOT_FORESEEN, WHY_REFINED,
};
use thickness_warp::ThicknessWarpDocument;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::prediction::{Method, MethodKind};

/// The settings of single methods in a spec, each in the field with the name of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OwnSettings {
    pub fem_nonlinear: Option<FemNonlinearDocument>,
    pub msm: Option<MassSpringDocument>,
    pub mtm: Option<MassTensorDocument>,
    pub mtm_ti: Option<MassTensorDocument>,
    pub dvs: Option<DvsDocument>,
    pub thickness_warp: Option<ThicknessWarpDocument>,
}

/// A row of the table.
struct MethodRow {
    description: fn() -> Description,
    /// Whether the spec has parameters of it.
    is_told: fn(&OwnSettings) -> bool,
    /// The method with its parameters at a place, or with defaults.
    to_method: fn(&OwnSettings, &Pointer, &mut Faults) -> Method,
}

fn row(method: MethodKind) -> MethodRow {
    match method {
        MethodKind::FemLinear => MethodRow {
            description: fem_linear::description,
            is_told: |_| false,
            to_method: |_, _, _| Method::FemLinear,
        },
        MethodKind::FemNonlinear => MethodRow {
            description: fem_nonlinear::description,
            is_told: |own| own.fem_nonlinear.is_some(),
            to_method: |own, at, faults| {
                own.fem_nonlinear.unwrap_or_default().check(at, faults);
                Method::FemNonlinear
            },
        },
        MethodKind::MassTensor => MethodRow {
            description: mtm::description,
            is_told: |own| own.mtm.is_some(),
            to_method: |own, at, faults| {
                Method::MassTensor(own.mtm.unwrap_or_default().to_settings(at, faults))
            },
        },
        MethodKind::MassTensorTransverse => MethodRow {
            description: mtm_ti::description,
            is_told: |own| own.mtm_ti.is_some(),
            to_method: |own, at, faults| {
                let settings = own.mtm_ti.unwrap_or_default().to_settings(at, faults);
                Method::MassTensorTransverse(settings)
            },
        },
        MethodKind::MassTensorNonlinear => MethodRow {
            description: mtm_nonlinear::description,
            is_told: |_| false,
            to_method: |_, _, _| Method::MassTensorNonlinear,
        },
        MethodKind::MassSpring => MethodRow {
            description: msm::description,
            is_told: |own| own.msm.is_some(),
            to_method: |own, at, faults| {
                Method::MassSpring(own.msm.unwrap_or_default().to_settings(at, faults))
            },
        },
        MethodKind::VolumeSpline => MethodRow {
            description: dvs::description,
            is_told: |own| own.dvs.is_some(),
            to_method: |own, at, faults| {
                Method::VolumeSpline(own.dvs.unwrap_or_default().to_method(at, faults))
            },
        },
        MethodKind::ThicknessWarp => MethodRow {
            description: thickness_warp::description,
            is_told: |own| own.thickness_warp.is_some(),
            to_method: |own, at, faults| {
                Method::ThicknessWarp(own.thickness_warp.unwrap_or_default().to_method(at, faults))
            },
        },
    }
}

/// Description of a method.
fn describe(method: MethodKind) -> MethodDocument {
    MethodDocument::new(method, (row(method).description)())
}

/// The method of a spec, with its settings; those of another one are refused.
pub fn to_method(
    asked: MethodName,
    own: &OwnSettings,
    at: &Pointer,
    faults: &mut Faults,
) -> Method {
    let chosen = asked.chosen();
    let told = MethodKind::ALL.iter().copied().filter(|method| (row(*method).is_told)(own));
    for other in told.filter(|method| *method != chosen) {
        let name = other.name();
        let detail =
            format!("these are settings of `{name}`, and the method is `{}`", asked.name());
        faults.add(&at.key(name), ErrorCode::MethodMismatch, detail);
    }
    (row(chosen).to_method)(own, &at.key(chosen.name()), faults)
}
