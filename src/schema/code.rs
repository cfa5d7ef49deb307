//! The codes of all errors: the word on the wire, the HTTP status and the title of each, one line a code. There are no
//! others.

use std::fmt;

use serde::{Serialize, Serializer};

const TOO_MUCH: &str = "A limit of the client is exceeded";
const LATER: &str = "Retry later";
/// The code names the fault of the request.
const REFUSED: &str = "The request was understood and is refused";

macro_rules! error_codes {
    ($($code:ident $status:literal $word:literal $title:expr,)+) => {
        /// The code of an error: the last word of a problem's `type`, the code of a mistake in a document, or the type of a
        /// job's error.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum ErrorCode {
            $($code,)+
        }

        impl ErrorCode {
            pub const ALL: &[ErrorCode] = &[$(ErrorCode::$code,)+];

            /// The word on the wire. Clients rely on it.
            pub const fn name(self) -> &'static str {
                match self {
                    $(ErrorCode::$code => $word,)+
                }
            }

            /// The HTTP status of a problem with this code.
            pub const fn status(self) -> u16 {
                match self {
                    $(ErrorCode::$code => $status,)+
                }
            }

            /// The kind of problem in a few words.
            pub const fn title(self) -> &'static str {
                match self {
                    $(ErrorCode::$code => $title,)+
                }
            }
        }
    };
}

error_codes! {
    MalformedJson 400 "malformed-json" "The body is not valid JSON",
    MalformedMultipart 400 "malformed-multipart" "The body is not valid multipart",
    MalformedRequest 400 "malformed-request" "The request could not be read",
    DigestMismatch 400 "digest-mismatch" "The body differs from its Content-Digest",
    InvalidParameter 400 "invalid-parameter" "A parameter is not valid",
    Unauthorized 401 "unauthorized" "A key is needed",
    ForbiddenScope 403 "forbidden-scope" "The key does not allow this",
    ForeignOrigin 403 "foreign-origin" "Pages of other sites may not request this",
    NotFound 404 "not-found" "There is nothing here",
    NoSuchJob 404 "no-such-job" "There is no such job",
    NoSuchOutput 404 "no-such-output" "The job has no such file",
    ClientsNotBuilt 404 "clients-not-built" "The service has no clients to hand out",
    ResponseNotBuilt 404 "response-not-built" "The case has no response",
    ResultNotReady 404 "result-not-ready" "The job has not ended",
    MethodNotAllowed 405 "method-not-allowed" "The resource does not support this method",
    NotAcceptable 406 "not-acceptable" "The resource has no such representation",
    RequestTimeout 408 "request-timeout" "The body came too slowly",
    CaseNotReady 409 "case-not-ready" "The case has no mesh",
    ConflictInUse 409 "conflict-in-use" "Something refers to it",
    ResponseStale 409 "response-stale" "The response is older than its case",
    Conflict 409 "conflict" "It changed meanwhile",
    TooManyKeys 409 "too-many-keys" TOO_MUCH,
    Gone 410 "gone" "It was erased",
    PreconditionFailed 412 "precondition-failed" "It has another version",
    PayloadTooLarge 413 "payload-too-large" "The body is too large",
    UriTooLong 414 "uri-too-long" "The address is too long",
    UnsupportedMediaType 415 "unsupported-media-type" "The media type of the body is not supported",
    RangeNotSatisfiable 416 "range-not-satisfiable" "The range is outside the file",
    UnknownHost 421 "unknown-host" "The service does not have this host name",
    PreconditionRequired 428 "precondition-required" "If-Match has to name the version",
    RateLimited 429 "rate-limited" TOO_MUCH,
    TooManyStreams 429 "too-many-streams" TOO_MUCH,
    HeaderTooLarge 431 "header-too-large" "The headers are too large",
    Internal 500 "internal" "The service failed",
    Integrity 500 "integrity" "A stored file is damaged",
    Busy 503 "busy" LATER,
    NotReady 503 "not-ready" LATER,
    QueueFull 503 "queue-full" LATER,
    StorageFull 507 "storage-full" "The disk is full",

    // About the shape of a document.
    ValidationFailed 422 "validation-failed" REFUSED,
    BadName 422 "bad-name" REFUSED,
    DuplicateKey 422 "duplicate-key" REFUSED,
    DuplicateName 422 "duplicate-name" REFUSED,
    MissingField 422 "missing-field" REFUSED,
    NullValue 422 "null-value" REFUSED,
    OneOf 422 "one-of" REFUSED,
    OutOfRange 422 "out-of-range" REFUSED,
    TooMany 422 "too-many" REFUSED,
    TooManyRegions 422 "too-many-regions" REFUSED,
    UnknownField 422 "unknown-field" REFUSED,
    UnknownWord 422 "unknown-word" REFUSED,
    WrongType 422 "wrong-type" REFUSED,

    // About what a document names.
    DuplicateSegment 422 "duplicate-segment" REFUSED,
    FrameConflict 422 "frame-conflict" REFUSED,
    NoClosedForm 422 "no-closed-form" REFUSED,
    NoScan 422 "no-scan" REFUSED,
    NoThresholds 422 "no-thresholds" REFUSED,
    NotInResponse 422 "not-in-response" REFUSED,
    OtherCase 422 "other-case" REFUSED,
    UnknownArray 422 "unknown-array" REFUSED,
    UnknownCase 422 "unknown-case" REFUSED,
    UnknownCohort 422 "unknown-cohort" REFUSED,
    UnknownCut 422 "unknown-cut" REFUSED,
    UnknownJob 422 "unknown-job" REFUSED,
    UnknownLabel 422 "unknown-label" REFUSED,
    UnknownLandmark 422 "unknown-landmark" REFUSED,
    UnknownMesh 422 "unknown-mesh" REFUSED,
    UnknownMuscle 422 "unknown-muscle" REFUSED,
    UnknownPlan 422 "unknown-plan" REFUSED,
    UnknownRegion 422 "unknown-region" REFUSED,
    UnknownScene 422 "unknown-scene" REFUSED,
    UnknownSegment 422 "unknown-segment" REFUSED,
    SegmentNotFound 422 "segment-not-found" REFUSED,
    UnknownSet 422 "unknown-set" REFUSED,
    UnknownSurface 422 "unknown-surface" REFUSED,
    UnusedCut 422 "unused-cut" REFUSED,
    UnusedPart 422 "unused-part" REFUSED,
    UnitsConflict 422 "units-conflict" REFUSED,
    UnitsSuspect 422 "units-suspect" REFUSED,
    WrongMesh 422 "wrong-mesh" REFUSED,

    // About what it says of the face.
    BoneOutsideSkin 422 "bone-outside-skin" REFUSED,
    CutLeavesBridge 422 "cut-leaves-bridge" REFUSED,
    EmptySelection 422 "empty-selection" REFUSED,
    FibreDirectionZero 422 "fibre-direction-zero" REFUSED,
    MissingMaterial 422 "missing-material" REFUSED,
    LawMismatch 422 "law-mismatch" REFUSED,
    NotInLaw 422 "not-in-law" REFUSED,
    NotPositiveDefinite 422 "not-positive-definite" REFUSED,
    NothingHeld 422 "nothing-held" REFUSED,
    NoTissue 422 "no-tissue" REFUSED,
    NoInside 422 "no-inside" REFUSED,
    SkinScanMisfit 422 "skin-scan-misfit" REFUSED,
    SkinScanMirrored 422 "skin-scan-mirrored" REFUSED,
    SkinScanSmall 422 "skin-scan-small" REFUSED,
    OutsideImage 422 "outside-image" REFUSED,
    PlanConflict 422 "plan-conflict" REFUSED,
    PlanNotRigid 422 "plan-not-rigid" REFUSED,
    PlanOutOfRange 422 "plan-out-of-range" REFUSED,
    SlidingConflict 422 "sliding-conflict" REFUSED,
    SlidingNormalZero 422 "sliding-normal-zero" REFUSED,
    Underconstrained 422 "underconstrained" REFUSED,
    WindowsOverlap 422 "windows-overlap" REFUSED,

    // About what is asked for.
    FormatNotAvailable 422 "format-not-available" REFUSED,
    IdempotencyMismatch 422 "idempotency-mismatch" REFUSED,
    JobFailed 422 "job-failed" REFUSED,
    MethodMismatch 422 "method-mismatch" REFUSED,
    MethodNotAvailable 422 "method-not-available" REFUSED,
    ModelStale 422 "model-stale" REFUSED,
    NotConsented 422 "not-consented" REFUSED,
    NeedsVerify 422 "needs-verify" REFUSED,
    NotLinear 422 "not-linear" REFUSED,
    NothingFree 422 "nothing-free" REFUSED,

    // About the bytes of a mesh.
    DecompressionLimit 422 "decompression-limit" REFUSED,
    MeshDegenerate 422 "mesh-degenerate" REFUSED,
    MeshEmpty 422 "mesh-empty" REFUSED,
    MeshIndexOutOfRange 422 "mesh-index-out-of-range" REFUSED,
    MeshInvertedElements 422 "mesh-inverted-elements" REFUSED,
    MeshLimits 422 "mesh-limits" REFUSED,
    MeshNonfinite 422 "mesh-nonfinite" REFUSED,
    MeshParse 422 "mesh-parse" REFUSED,
    UnsupportedFormat 422 "unsupported-format" REFUSED,

    // About two surfaces that are compared.
    AlignmentFailed 422 "alignment-failed" REFUSED,
    EmptyRegion 422 "empty-region" REFUSED,
    NoDisplacement 422 "no-displacement" REFUSED,
    NotCorresponding 422 "not-corresponding" REFUSED,
    TooManySamples 422 "too-many-samples" REFUSED,

    // How jobs fail; a check that fails in the same way is refused.
    BudgetExceeded 422 "budget-exceeded" REFUSED,
    Cancelled 422 "cancelled" REFUSED,
    ElementInverted 422 "element-inverted" REFUSED,
    EncodingFailed 422 "encoding-failed" REFUSED,
    MatrixSingular 422 "matrix-singular" REFUSED,
    MeshingFailed 422 "meshing-failed" REFUSED,
    NoBone 422 "no-bone" REFUSED,
    ContactUnsettled 422 "contact-unsettled" REFUSED,
    NoEquilibrium 422 "no-equilibrium" REFUSED,
    NoPlanFound 422 "no-plan-found" REFUSED,
    NotFinite 422 "not-finite" REFUSED,
    OutOfMemory 422 "out-of-memory" REFUSED,
    SolverDiverged 422 "solver-diverged" REFUSED,
    StatisticsFailed 422 "statistics-failed" REFUSED,
    StepAboveLimit 422 "step-above-limit" REFUSED,
    TissueFolded 422 "tissue-folded" REFUSED,

    // How jobs fail through no fault of their own.
    Storage 500 "storage" "A file could not be read or written",
    WorkerLost 500 "worker-lost" "The process of the job ended",
}

impl fmt::Display for ErrorCode {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl Serialize for ErrorCode {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_code_has_a_name_of_its_own_a_status_of_an_error_and_a_title() {
        let mut names = BTreeSet::new();
        for code in ErrorCode::ALL {
            let name = code.name();
            let words = name.split('-');
            let is_word =
                |word: &str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase());
            assert!(words.clone().all(is_word), "{name}");
            // The name of the variant is the same words.
            let joined: String = words.collect();
            assert_eq!(joined, format!("{code:?}").to_lowercase());
            assert!(names.insert(name), "two codes are called {name}");
            assert!((400..600).contains(&code.status()), "{name}");
            assert!(!code.title().is_empty(), "{name}");
        }
    }
}
