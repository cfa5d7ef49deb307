//! Errors of a conformation.

use crate::mesh::SearchError;
use crate::registration::AlignmentError;

/// Why a template cannot be conformed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConformationError {
    #[error("there is neither a skin nor bone nor a landmark to conform to")]
    NothingToFit,
    #[error(
        "no face of the template has all its corners among the {nodes} nodes given as its {sheet}"
    )]
    NoSheet { sheet: SheetName, nodes: usize },
    #[error("the patient's {sheet} cannot be searched: {error}")]
    Surface { sheet: SheetName, error: SearchError },
    #[error("the landmarks do not place the template: {0}")]
    Landmarks(AlignmentError),
    #[error("no thin-plate spline goes through the landmarks: {0}")]
    Spline(AlignmentError),
    #[error(
        "no thin-plate spline goes through the landmarks: {one} and {other} are at one place of the template"
    )]
    SameLandmark { one: String, other: String },
    #[error("{landmarks} landmarks do not place the template, {needed} are needed")]
    FewLandmarks { landmarks: usize, needed: usize },
    #[error(
        "the patient is {scale:.4} times as large as the template, and 0.5 to 2 is possible: one of the two is not in mm"
    )]
    Scale { scale: f64 },
    #[error(
        "the landmarks are left {rms:.1} mm (rms) from each other, and {mirrored:.1} mm where the template is mirrored: left and right are swapped"
    )]
    Mirrored { rms: f64, mirrored: f64 },
    #[error(
        "the landmarks turn the template by {degrees:.0} degrees and lie in one plane, where left and right exchanged would look the same: check their sides, or add one that lies off the plane"
    )]
    SidesUndecided { degrees: f64 },
    #[error(
        "the landmark {name:?} lies {distance:.0} mm from the template, which is {size:.0} mm across: it is in another unit or frame"
    )]
    FarFromTemplate { name: String, distance: f64, size: f64 },
    #[error(
        "the landmarks {one:?} and {other:?} are left {apart:.1} mm (rms) from their places, and {exchanged:.1} mm if they are exchanged"
    )]
    Exchanged { one: String, other: String, apart: f64, exchanged: f64 },
    #[error(
        "the landmark {name:?} is left {left:.1} mm from its place, and {near:.1} mm from that of {place:?}, which is not exchanged with it.{others} Check whether they were picked on the right place, and on the surface of this patient"
    )]
    Misplaced { name: String, left: f64, place: String, near: f64, others: String },
    #[error(
        "landmarks lie where others are said to be, {names}: they are left {rms:.1} mm (rms) from their places, and {after:.1} mm if each is put where it belongs"
    )]
    Permuted { names: String, rms: f64, after: f64 },
    #[error(
        "the landmarks are left {rms:.1} mm (rms) from their places by the best similarity, {share:.0} % of their spread of {spread:.1} mm; {worst:?} is left {left:.1} mm: they are no pairs"
    )]
    Unlike { rms: f64, share: f64, spread: f64, worst: String, left: f64 },
    #[error(
        "only {partners} of {points} points of the template's skin lie opposite the patient's, at least half are needed: a part of the face is missing, or the template lies turned"
    )]
    FewPartners { partners: usize, points: usize },
    #[error(
        "after the best affine map the skins are {median:.1} mm apart (median), {share:.1} % of the template's size of {size:.0} mm, and {most:.1} % is what faces differ by: this is no such face"
    )]
    NoSuchFace { median: f64, share: f64, size: f64, most: f64 },
    #[error(
        "the best affine map stretches the template {ratio:.2} times as much in one direction as in another, and {most} is what faces differ by: a part of the face is missing, or this is none"
    )]
    Stretched { ratio: f64, most: f64 },
    #[error("cancelled after {rounds} rounds of the conformation")]
    Cancelled { rounds: usize },
}

/// A part of the template's boundary that meets a surface of the patient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetName {
    Skin,
    Bone,
}

impl std::fmt::Display for SheetName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            SheetName::Skin => "skin",
            SheetName::Bone => "bone",
        })
    }
}
