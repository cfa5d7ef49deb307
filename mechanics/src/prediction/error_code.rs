//! The stable words for what can be wrong with a scene.

/// What is wrong with a case, a plan or the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneErrorCode {
    DuplicateSegment,
    EmptySelection,
    FibreDirectionZero,
    MeshDegenerate,
    MeshInvertedElements,
    MethodNotAvailable,
    MissingField,
    MissingMaterial,
    NothingHeld,
    OutsideImage,
    PlanConflict,
    PlanOutOfRange,
    SlidingConflict,
    SlidingNormalZero,
    TooManyRegions,
    Underconstrained,
    UnknownArray,
    UnknownRegion,
    UnknownSegment,
    UnknownSet,
    UnknownSurface,
    WindowsOverlap,
}

impl SceneErrorCode {
    pub const ALL: [SceneErrorCode; 22] = [
        SceneErrorCode::DuplicateSegment,
        SceneErrorCode::EmptySelection,
        SceneErrorCode::FibreDirectionZero,
        SceneErrorCode::MeshDegenerate,
        SceneErrorCode::MeshInvertedElements,
        SceneErrorCode::MethodNotAvailable,
        SceneErrorCode::MissingField,
        SceneErrorCode::MissingMaterial,
        SceneErrorCode::NothingHeld,
        SceneErrorCode::OutsideImage,
        SceneErrorCode::PlanConflict,
        SceneErrorCode::PlanOutOfRange,
        SceneErrorCode::SlidingConflict,
        SceneErrorCode::SlidingNormalZero,
        SceneErrorCode::TooManyRegions,
        SceneErrorCode::Underconstrained,
        SceneErrorCode::UnknownArray,
        SceneErrorCode::UnknownRegion,
        SceneErrorCode::UnknownSegment,
        SceneErrorCode::UnknownSet,
        SceneErrorCode::UnknownSurface,
        SceneErrorCode::WindowsOverlap,
    ];

    pub fn name(self) -> &'static str {
        match self {
            SceneErrorCode::DuplicateSegment => "duplicate-segment",
            SceneErrorCode::EmptySelection => "empty-selection",
            SceneErrorCode::FibreDirectionZero => "fibre-direction-zero",
            SceneErrorCode::MeshDegenerate => "mesh-degenerate",
            SceneErrorCode::MeshInvertedElements => "mesh-inverted-elements",
            SceneErrorCode::MethodNotAvailable => "method-not-available",
            SceneErrorCode::MissingField => "missing-field",
            SceneErrorCode::MissingMaterial => "missing-material",
            SceneErrorCode::NothingHeld => "nothing-held",
            SceneErrorCode::OutsideImage => "outside-image",
            SceneErrorCode::PlanConflict => "plan-conflict",
            SceneErrorCode::PlanOutOfRange => "plan-out-of-range",
            SceneErrorCode::SlidingConflict => "sliding-conflict",
            SceneErrorCode::SlidingNormalZero => "sliding-normal-zero",
            SceneErrorCode::TooManyRegions => "too-many-regions",
            SceneErrorCode::Underconstrained => "underconstrained",
            SceneErrorCode::UnknownArray => "unknown-array",
            SceneErrorCode::UnknownRegion => "unknown-region",
            SceneErrorCode::UnknownSegment => "unknown-segment",
            SceneErrorCode::UnknownSet => "unknown-set",
            SceneErrorCode::UnknownSurface => "unknown-surface",
            SceneErrorCode::WindowsOverlap => "windows-overlap",
        }
    }
}
