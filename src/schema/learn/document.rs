//! The spec of learning: operated cases, or virtual ones, and the rule.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Matrix4x4;
use crate::schema::code::ErrorCode;
use crate::schema::predict::budget::BudgetDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_tags;
use mechanics::learning::cohort::LEAST_CASES;
use mechanics::learning::virtual_cohort::{FaceKind, USUAL_MAPPING};
use mechanics::learning::{Distance, Learner, Method, Target};
use mechanics::plan::RigidMovement;

/// Virtual patients that one job may make.
const MOST_VIRTUAL: f64 = 200.0;

/// Beyond it faces fold.
const MOST_MAPPING: f64 = 5.0;

/// What every client's whole numbers hold.
const MOST_SEED: f64 = 2_147_483_647.0;

/// `learn`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum LearnKind {
    #[default]
    Learn,
}

/// Learning from operated cases how the skin moves, or what mechanics misses of that, with its validation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LearnDocument {
    #[serde(default)]
    #[schema(required)]
    pub kind: LearnKind,
    /// Exactly one of `cases`, `cohort` and `virtual`. At least 3, each of another patient, all on meshes with the same cells.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<LearnCaseDocument>,
    /// The id of a stored cohort, whose members are learned from as they are at this moment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cohort: Option<String>,
    /// Patients that the program makes itself.
    #[serde(default, rename = "virtual", skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub made: Option<VirtualCohortDocument>,
    /// What the model is that is kept; all are in the table.
    #[serde(default)]
    pub learner: LearnerName,
    #[serde(default)]
    pub target: TargetName,
    #[serde(default)]
    pub distance: DistanceName,
    /// Whether theta of Rubin and Bodner's law is fitted to each class of surgery, and each case predicted with that of the others of its
    /// class: three more predictions of each case at finite strain, whose tissues of that law get another theta. Virtual patients always
    /// have it. Default: false.
    #[serde(default)]
    pub theta: bool,
    #[serde(default)]
    pub budget: BudgetDocument,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

/// An operated case: what was predicted of it, and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LearnCaseDocument {
    /// The id of a job of kind `predict`, whose case, plan and method are taken.
    pub prediction: String,
    /// The id of a mesh after the operation: a volume with the cells of the case's, or a surface with the node ids or the
    /// triangles of its skin, which tell what corresponds.
    pub actual: String,
    /// The registration of `actual` onto the case: row-major, x' = R x + t in mm. Absent: it lies in the frame of the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub matrix4x4: Option<Matrix4x4>,
    /// Absent: its number from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    /// Of surgery, such as `two_jaw`, for which one `theta` is fitted. Absent: how many segments the plan moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub class: Option<String>,
}

/// Patients that are the same for the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct VirtualCohortDocument {
    #[schema(minimum = 3, maximum = 200)]
    pub patients: u32,
    #[serde(default)]
    #[schema(maximum = 2147483647)]
    pub seed: u32,
    /// What a face is made of, and whether what happens to it is in contact.
    #[serde(default, skip_serializing_if = "is_half_head")]
    pub face: VirtualFaceName,
    /// 1728 n² tetrahedra of a half head, by default with n = 2, or 5616 n² hexahedra of a generic face, by default with n = 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 4)]
    pub fineness: Option<u32>,
    /// By how much a mapped point of the skin is off in the mean, before the operation and after: smooth over 20 mm. Default: 0.2.
    #[serde(default = "usual_mapping")]
    #[schema(default = 0.2, minimum = 0, maximum = 5)]
    pub mapping_mm: f64,
}

fn usual_mapping() -> f64 {
    USUAL_MAPPING
}

fn is_half_head(face: &VirtualFaceName) -> bool {
    *face == VirtualFaceName::HalfHead
}

/// The face of virtual patients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum VirtualFaceName {
    /// Tetrahedra on bone. What happens has no contact.
    #[default]
    HalfHead,
    /// That of `facies face`, of hexahedra, with lips, and mucosa that slides on the teeth. What happens is in unilateral contact.
    GenericFace,
}

impl From<VirtualFaceName> for FaceKind {
    fn from(name: VirtualFaceName) -> FaceKind {
        match name {
            VirtualFaceName::HalfHead => FaceKind::HalfHead,
            VirtualFaceName::GenericFace => FaceKind::Generic,
        }
    }
}

impl VirtualCohortDocument {
    /// As stated, or that of the face.
    pub fn fineness(&self) -> u32 {
        self.fineness.unwrap_or(match self.face {
            VirtualFaceName::HalfHead => 2,
            VirtualFaceName::GenericFace => 1,
        })
    }
}

/// A rule of learning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LearnerName {
    /// General regression neural network.
    #[default]
    Regression,
    /// Statistical deformation model, with as many modes, from none, as predict its cases best from each other.
    DeformationModel,
    /// The same with the modes that hold 95 % of the variance, two fewer than cases at most.
    DeformationModelByVariance,
}

/// What is learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TargetName {
    /// What mechanics misses, which is added to a prediction.
    #[default]
    Residual,
    /// The displacement itself.
    Displacement,
}

/// How far features are apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum DistanceName {
    /// The sum of absolute differences.
    #[default]
    L1,
    /// The Euclidean norm.
    L2,
}

impl From<DistanceName> for Distance {
    fn from(name: DistanceName) -> Distance {
        match name {
            DistanceName::L1 => Distance::L1,
            DistanceName::L2 => Distance::L2,
        }
    }
}

impl LearnDocument {
    /// The rule whose model is kept.
    pub fn method(&self) -> Method {
        let learner = match self.learner {
            LearnerName::Regression => Learner::Regression,
            LearnerName::DeformationModel => Learner::DeformationModel,
            LearnerName::DeformationModelByVariance => Learner::DeformationModelByVariance,
        };
        let target = match self.target {
            TargetName::Residual => Target::Residual,
            TargetName::Displacement => Target::Displacement,
        };
        Method { learner, target }
    }

    /// The name of a case.
    pub fn name(&self, index: usize) -> String {
        let named = self.cases.get(index).and_then(|case| case.name.as_deref());
        named.map_or_else(|| (index + 1).to_string(), |name| name.trim().to_owned())
    }

    /// The class of surgery of a case whose plan moves so many segments.
    pub fn class(&self, index: usize, segments: usize) -> String {
        let stated = self.cases.get(index).and_then(|case| case.class.clone());
        stated.unwrap_or_else(|| format!("{segments} moved"))
    }

    /// Adds what is wrong with it; pointers start at `/spec`.
    pub fn check(&self, limits: &Limits, faults: &mut Faults) {
        let at = Pointer::root().key("spec");
        check_tags(&self.tags, &at.key("tags"), limits, faults);
        self.budget.check(&at.key("budget"), limits, faults);
        let given = [!self.cases.is_empty(), self.cohort.is_some(), self.made.is_some()];
        let given = given.into_iter().filter(|given| *given).count();
        faults.check_one_of(&at, given, "`cases`, `cohort`, `virtual`");
        if let Some(made) = &self.made {
            let place = at.key("virtual");
            let (patients, fineness) = (f64::from(made.patients), f64::from(made.fineness()));
            faults.check_range(&place.key("patients"), patients, 3.0..=MOST_VIRTUAL, "patients");
            faults.check_range(&place.key("fineness"), fineness, 1.0..=4.0, "");
            faults.check_range(&place.key("seed"), f64::from(made.seed), 0.0..=MOST_SEED, "");
            faults.check_range(&place.key("mapping_mm"), made.mapping_mm, 0.0..=MOST_MAPPING, "mm");
        }
        if !self.cases.is_empty() {
            self.check_cases(&at.key("cases"), limits, faults);
        }
    }

    fn check_cases(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let count = self.cases.len();
        faults.check_length(at, count, limits.list_entries as usize);
        if count < LEAST_CASES {
            let detail = format!(
                "{count} cases are too few: with one left out, two are to learn from; at least {LEAST_CASES} are needed"
            );
            faults.add(at, ErrorCode::OutOfRange, detail);
        }
        let mut seen: [BTreeSet<String>; 3] = Default::default();
        for (index, case) in self.cases.iter().enumerate() {
            let place = at.index(index);
            for (member, named) in [("name", &case.name), ("class", &case.class)] {
                if let Some(named) = named {
                    faults.check_name(&place.key(member), named, limits.name_characters as usize);
                }
            }
            check_registration(case.matrix4x4.as_ref(), &place, faults);
            let name = self.name(index);
            let members =
                [("prediction", &case.prediction), ("actual", &case.actual), ("name", &name)];
            for ((member, value), seen) in members.into_iter().zip(&mut seen) {
                if !seen.insert(value.clone()) {
                    let detail = format!(
                        "{value:?} is there twice: a patient who is learned from and predicted proves nothing"
                    );
                    faults.add(&place.key(member), ErrorCode::DuplicateName, detail);
                }
            }
        }
    }
}

/// Refuses a registration that is not rigid.
pub fn check_registration(matrix: Option<&Matrix4x4>, at: &Pointer, faults: &mut Faults) {
    if let Some(Err(error)) = matrix.map(|matrix| RigidMovement::from_matrix4(&matrix.0)) {
        faults.add(&at.key("matrix4x4"), ErrorCode::PlanNotRigid, error.to_string());
    }
}
