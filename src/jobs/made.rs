//! Errors of generated patients.

use super::clock::Observed;
use super::failure::JobError;
use crate::schema::{ErrorCode, Pointer, Problem};
use mechanics::learning::CohortError;
use mechanics::learning::virtual_cohort::VirtualError;
use mechanics::material::MaterialError;

pub fn refused_virtual(error: VirtualError, clock: &Observed) -> JobError {
    match error {
        VirtualError::Model(error) => clock.judge(error),
        VirtualError::Scene(errors) => JobError::Refused(errors.into()),
        VirtualError::Cohort(error) => refused_cohort(&error),
        VirtualError::Material(error) => refused_material(&error),
    }
}

/// The refusal of tissue that is none.
pub fn refused_material(error: &MaterialError) -> JobError {
    let at = Pointer::from_text("/spec/virtual");
    Problem::at(&at, ErrorCode::OutOfRange, error.to_string()).into()
}

/// The refusal of a cohort unsuited to learning.
pub fn refused_cohort(error: &CohortError) -> JobError {
    let cases = Pointer::from_text("/spec/cases");
    let (at, code) = match error {
        CohortError::TooFew { .. } => (cases, ErrorCode::OutOfRange),
        CohortError::NamedTwice { second, .. } | CohortError::SamePatient { second, .. } => {
            (cases.index(*second), ErrorCode::DuplicateName)
        }
        CohortError::Length { case, .. } => (cases.index(*case), ErrorCode::NotCorresponding),
        CohortError::NotFinite { case, .. } => (cases.index(*case), ErrorCode::NotFinite),
        CohortError::NoSuchPoint { .. } => (cases, ErrorCode::NotCorresponding),
    };
    Problem::at(&at, code, error.to_string()).into()
}
