//! Error codes of the numerics.

use super::code::ErrorCode;
use mechanics::anatomy::{AnatomyError, SkinScanError};
use mechanics::domain::SurfaceDomainError;
use mechanics::format::FormatError;
use mechanics::mesh::SearchError;
use mechanics::meshing::MeshingError;
use mechanics::prediction::{ModelError, SceneErrorCode, SolverError};
use mechanics::validation::ComparisonError;

impl From<SceneErrorCode> for ErrorCode {
    fn from(code: SceneErrorCode) -> Self {
        match code {
            SceneErrorCode::DuplicateSegment => ErrorCode::DuplicateSegment,
            SceneErrorCode::EmptySelection => ErrorCode::EmptySelection,
            SceneErrorCode::FibreDirectionZero => ErrorCode::FibreDirectionZero,
            SceneErrorCode::MeshDegenerate => ErrorCode::MeshDegenerate,
            SceneErrorCode::MeshInvertedElements => ErrorCode::MeshInvertedElements,
            SceneErrorCode::MethodNotAvailable => ErrorCode::MethodNotAvailable,
            SceneErrorCode::MissingField => ErrorCode::MissingField,
            SceneErrorCode::MissingMaterial => ErrorCode::MissingMaterial,
            SceneErrorCode::NoInside => ErrorCode::NoInside,
            SceneErrorCode::NothingHeld => ErrorCode::NothingHeld,
            SceneErrorCode::OutsideImage => ErrorCode::OutsideImage,
            SceneErrorCode::PlanConflict => ErrorCode::PlanConflict,
            SceneErrorCode::PlanOutOfRange => ErrorCode::PlanOutOfRange,
            SceneErrorCode::SlidingConflict => ErrorCode::SlidingConflict,
            SceneErrorCode::SlidingNormalZero => ErrorCode::SlidingNormalZero,
            SceneErrorCode::TooMany => ErrorCode::TooMany,
            SceneErrorCode::TooManyRegions => ErrorCode::TooManyRegions,
            SceneErrorCode::Underconstrained => ErrorCode::Underconstrained,
            SceneErrorCode::UnknownArray => ErrorCode::UnknownArray,
            SceneErrorCode::UnknownMuscle => ErrorCode::UnknownMuscle,
            SceneErrorCode::UnknownRegion => ErrorCode::UnknownRegion,
            SceneErrorCode::UnknownSegment => ErrorCode::UnknownSegment,
            SceneErrorCode::UnknownSet => ErrorCode::UnknownSet,
            SceneErrorCode::UnknownSurface => ErrorCode::UnknownSurface,
            SceneErrorCode::WindowsOverlap => ErrorCode::WindowsOverlap,
        }
    }
}

impl From<&ModelError> for ErrorCode {
    fn from(error: &ModelError) -> Self {
        match error {
            ModelError::Inverted(_) => ErrorCode::ElementInverted,
            ModelError::Solver(error) => error.into(),
            ModelError::StepAboveLimit { .. } => ErrorCode::StepAboveLimit,
            ModelError::NoBone => ErrorCode::NoBone,
            ModelError::Standstill { .. } => ErrorCode::NoEquilibrium,
            ModelError::ContactUnsettled { .. } | ModelError::ContactAlternates { .. } => {
                ErrorCode::ContactUnsettled
            }
            ModelError::Folded { .. } => ErrorCode::TissueFolded,
            ModelError::BonesPass { cause, .. } => (&**cause).into(),
        }
    }
}

impl From<&SolverError> for ErrorCode {
    fn from(error: &SolverError) -> Self {
        match error {
            SolverError::Stopped => ErrorCode::Cancelled,
            SolverError::NotConverged { .. }
            | SolverError::Diverged { .. }
            | SolverError::NotFinite => ErrorCode::SolverDiverged,
            SolverError::Singular { .. } => ErrorCode::MatrixSingular,
            SolverError::OverBudget { .. } => ErrorCode::BudgetExceeded,
        }
    }
}

impl From<&FormatError> for ErrorCode {
    fn from(error: &FormatError) -> Self {
        match error {
            FormatError::Parse { .. }
            | FormatError::UnsupportedCells { .. }
            | FormatError::Name { .. } => ErrorCode::MeshParse,
            FormatError::Limits { .. } | FormatError::Far { .. } | FormatError::Memory { .. } => {
                ErrorCode::MeshLimits
            }
            FormatError::NonFinite { .. } => ErrorCode::MeshNonfinite,
            FormatError::IndexOutOfRange { .. } => ErrorCode::MeshIndexOutOfRange,
            FormatError::Empty { .. } => ErrorCode::MeshEmpty,
            FormatError::Degenerate { .. } => ErrorCode::MeshDegenerate,
            FormatError::InvertedElements { .. } => ErrorCode::MeshInvertedElements,
            FormatError::DecompressionLimit { .. } => ErrorCode::DecompressionLimit,
            FormatError::UnsupportedFormat { .. } => ErrorCode::UnsupportedFormat,
        }
    }
}

impl From<&ComparisonError> for ErrorCode {
    fn from(error: &ComparisonError) -> Self {
        match error {
            ComparisonError::Surface { source, .. } => match source {
                SearchError::NoArea { .. } => ErrorCode::MeshEmpty,
                SearchError::NotFinite { .. } => ErrorCode::MeshNonfinite,
                SearchError::PointOutOfRange { .. } => ErrorCode::MeshIndexOutOfRange,
            },
            ComparisonError::Alignment(_) | ComparisonError::LandmarkOutside { .. } => {
                ErrorCode::AlignmentFailed
            }
            ComparisonError::EmptyRegion { .. } => ErrorCode::EmptyRegion,
            ComparisonError::NoDisplacement { .. } => ErrorCode::NoDisplacement,
            ComparisonError::NotCorresponding { .. } => ErrorCode::NotCorresponding,
            ComparisonError::TooManySamples { .. } => ErrorCode::TooManySamples,
            ComparisonError::Statistics(_) => ErrorCode::MeshDegenerate,
            ComparisonError::Cancelled => ErrorCode::Cancelled,
        }
    }
}

impl From<&SurfaceDomainError> for ErrorCode {
    fn from(error: &SurfaceDomainError) -> Self {
        match error {
            SurfaceDomainError::BoneOutside { .. } => ErrorCode::BoneOutsideSkin,
            SurfaceDomainError::NoTissue { .. } => ErrorCode::NoTissue,
            SurfaceDomainError::Coordinate { .. }
            | SurfaceDomainError::Corner { .. }
            | SurfaceDomainError::Empty { .. }
            | SurfaceDomainError::NoInside { .. }
            | SurfaceDomainError::Incomplete { .. }
            | SurfaceDomainError::Uncertain { .. }
            | SurfaceDomainError::Open { .. }
            | SurfaceDomainError::Doubled { .. }
            | SurfaceDomainError::TwoWalls { .. }
            | SurfaceDomainError::Tangled { .. }
            | SurfaceDomainError::Limit(_) => ErrorCode::NoInside,
        }
    }
}

impl From<&AnatomyError> for ErrorCode {
    fn from(error: &AnatomyError) -> Self {
        match error {
            AnatomyError::Image(_)
            | AnatomyError::NoSkin { .. }
            | AnatomyError::Meshing(
                MeshingError::Empty { .. }
                | MeshingError::Scattered { .. }
                | MeshingError::TooFew { .. },
            ) => ErrorCode::NoTissue,
            AnatomyError::Surface(error) => error.into(),
            AnatomyError::SkinScan(error) => match error {
                SkinScanError::Alignment(_) | SkinScanError::EmptyMask { .. } => {
                    ErrorCode::AlignmentFailed
                }
                SkinScanError::Skin(_) => ErrorCode::MeshingFailed,
                SkinScanError::Misfit { .. } => ErrorCode::SkinScanMisfit,
                SkinScanError::Mirrored { .. } => ErrorCode::SkinScanMirrored,
                SkinScanError::Small { .. } | SkinScanError::SmallMask { .. } => {
                    ErrorCode::SkinScanSmall
                }
            },
            AnatomyError::Bone(_) => ErrorCode::SegmentNotFound,
            AnatomyError::Meshing(MeshingError::TooMany { .. } | MeshingError::TooFine { .. }) => {
                ErrorCode::MeshLimits
            }
            AnatomyError::Meshing(MeshingError::Setting { .. }) => ErrorCode::OutOfRange,
            AnatomyError::Meshing(MeshingError::Cancelled) => ErrorCode::Cancelled,
            AnatomyError::Meshing(
                MeshingError::Bounds { .. }
                | MeshingError::NotFinite { .. }
                | MeshingError::Broken { .. },
            ) => ErrorCode::MeshingFailed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mechanics::format::FilePosition;
    use mechanics::prediction::InvertedCell;
    use mechanics::registration::AlignmentError;
    use mechanics::validation::StatisticsError;

    #[test]
    fn every_word_of_a_scene_is_that_of_its_code() {
        for code in SceneErrorCode::ALL {
            assert_eq!(ErrorCode::from(code).name(), code.name());
        }
    }

    #[test]
    fn every_word_of_a_solver_is_that_of_its_code() {
        let history = Vec::new();
        for error in [
            ModelError::Solver(SolverError::Stopped),
            ModelError::Solver(SolverError::NotConverged {
                iterations: 1,
                residual: 1.0,
                wanted: 0.1,
                history: history.clone(),
            }),
            ModelError::Solver(SolverError::Diverged {
                iterations: 1,
                growth: 2.0,
                residual: 1.0,
                history,
            }),
            ModelError::Solver(SolverError::Singular { node: 0 }),
            ModelError::Inverted(InvertedCell { cell: 0 }),
            ModelError::Solver(SolverError::OverBudget { needed_mb: 2.0, allowed_mb: 1.0 }),
            ModelError::Solver(SolverError::NotFinite),
            ModelError::StepAboveLimit { step_s: 2.0, limit_s: 1.0 },
            ModelError::NoBone,
            ModelError::Standstill { made: 0.5, steps: 9, least_det_f: 0.1 },
            ModelError::ContactUnsettled { passes: 30, moved_mm: 1.0 },
            ModelError::ContactAlternates { steps: 9, residual: 0.1, depth_mm: 1.0, place: None },
            ModelError::Folded { cell: 1, det_f: -1.0 },
            ModelError::BonesPass {
                cause: Box::new(ModelError::NoBone),
                edges: 1,
                cells: 1,
                told: String::new(),
            },
        ] {
            assert_eq!(ErrorCode::from(&error).name(), error.code(), "{error}");
        }
    }

    #[test]
    fn every_word_of_a_reader_is_that_of_its_code() {
        let (count, limit) = (2, 1);
        for error in [
            FormatError::Parse {
                format: "OBJ",
                place: FilePosition::Line(1),
                detail: String::new(),
            },
            FormatError::UnsupportedCells { types: Vec::new() },
            FormatError::Name { detail: String::new() },
            FormatError::Limits { what: "nodes", declared: count, limit },
            FormatError::Far { coordinate: 2.0, limit: 1.0 },
            FormatError::Memory { values: count },
            FormatError::NonFinite { count, first: Vec::new() },
            FormatError::IndexOutOfRange { count, first: Vec::new(), nodes: 1 },
            FormatError::Empty { detail: String::new() },
            FormatError::Degenerate { what: "cells", count },
            FormatError::InvertedElements { shape: "tet4", count, of: 2, first: Vec::new() },
            FormatError::DecompressionLimit { declared: count, limit },
            FormatError::UnsupportedFormat { detail: "text" },
        ] {
            assert_eq!(ErrorCode::from(&error).name(), error.code(), "{error}");
        }
    }

    #[test]
    fn every_word_of_a_comparison_is_that_of_its_code() {
        let which = "actual";
        let unmeasured = |source| ComparisonError::Surface { which, source };
        for error in [
            unmeasured(SearchError::NoArea { triangles: 0 }),
            unmeasured(SearchError::NotFinite { point: 0 }),
            unmeasured(SearchError::PointOutOfRange { triangle: 0, point: 3, points: 3 }),
            ComparisonError::Alignment(AlignmentError::EmptyMask),
            ComparisonError::LandmarkOutside { which, pair: 0, distance: 1.0 },
            ComparisonError::EmptyRegion { name: String::new() },
            ComparisonError::NoDisplacement { region: String::new() },
            ComparisonError::NotCorresponding { prediction: 1, actual: 2 },
            ComparisonError::TooManySamples { samples: 2.0, allowed: 1.0 },
            ComparisonError::Statistics(StatisticsError::Empty),
            ComparisonError::Cancelled,
        ] {
            assert_eq!(ErrorCode::from(&error).name(), error.code(), "{error}");
        }
    }
}
