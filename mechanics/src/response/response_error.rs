//! Reasons why a scene has no plan response, or not the one that is asked for.

use crate::model::problem::ModelError;

/// Why there is no response.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResponseError {
    #[error("there is no segment that could be moved")]
    NoSegments,
    #[error("the case has no segment {name:?}; its segments: {known}")]
    UnknownSegment { name: String, known: String },
    #[error(
        "{count} nodes belong to two segments, the first is node {first}: they cannot follow both"
    )]
    SharedNodes { count: usize, first: u32 },
    #[error(
        "nothing but segment {name:?} holds the tissue: every plan that moves it would carry the tissue along as one, \
         without deforming it; name in `fixed` what stays, or allow it with `allow_unfixed`"
    )]
    NothingHeld { name: String },
    #[error("segment {name:?} holds no node")]
    EmptySegment { name: String },
    #[error("the scene has prescribed displacements or loads, which a response does not know")]
    Loaded,
    #[error("the case has no region {name:?} that could grow; its regions: {known}")]
    UnknownRegion { name: String, known: String },
    #[error("the case has no muscle {name:?}; its muscles: {known}")]
    UnknownMuscle { name: String, known: String },
    #[error(
        "muscle {name:?} becomes stiffer as it pulls, so that what it does is no multiple of a column: leave it out here, or give it in the case the stiffness at one activation as its `material`, without `stiffening`"
    )]
    Stiffens { name: String },
    #[error(
        "the second order of a response is not known for quadratic tetrahedra, nor for fibres that only pull"
    )]
    NoSecondOrder,
    #[error(
        "the second order of a response is not known of tissue that grows, nor of muscles that pull"
    )]
    NoSecondOrderInside,
    #[error(
        "responses are built with linear finite elements, and the spec asks for another method"
    )]
    OtherMethod,
    #[error(transparent)]
    Prediction(#[from] ModelError),
}
