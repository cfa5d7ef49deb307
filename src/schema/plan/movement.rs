//! Movement of a segment: a rotation and a translation, a matrix, or a sequence of these.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::{Matrix4x4, Triple};
use mechanics::mesh::Vector;
use mechanics::plan::{Restriction, RigidMovement};

/// Largest coordinate of a pivot, beyond the origin of any scanner in use.
pub const FARTHEST_PIVOT_MM: f64 = 1e8;

/// Lengths of a direction with a finite square.
const SHORTEST_DIRECTION: f64 = 1e-6;
const LONGEST_DIRECTION: f64 = 1e6;

/// The order of the three rotations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub enum RotationOrder {
    /// R = Rz Ry Rx about fixed axes.
    #[serde(rename = "xyz-extrinsic")]
    XyzExtrinsic,
}

/// x' = R (x - p) + p + t, right-handed and active: either `translation_mm` and `rotation_deg`, or `matrix4x4`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MovementDocument {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub translation_mm: Option<Triple>,
    /// About x, y and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rotation_deg: Option<Triple>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rotation_order: Option<RotationOrder>,
    /// Required if a rotation is not 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub pivot_mm: Option<Triple>,
    /// Row-major, last row 0 0 0 1, orthonormal to 1e-6 with determinant +1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub matrix4x4: Option<Matrix4x4>,
    /// Of a movement by `translation_mm` and `rotation_deg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub restrict_to: Option<RestrictionDocument>,
}

/// The restriction of a movement: exactly one of an axis and a plane. Of the stated movement remain the translation
/// along it and the rotation about the axis or about the plane's normal, at the pivot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RestrictionDocument {
    /// A direction of any length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub axis: Option<Triple>,
    /// A direction of any length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub plane_normal: Option<Triple>,
}

impl RestrictionDocument {
    fn to_restriction(self, at: &Pointer, faults: &mut Faults) -> Option<Restriction> {
        let given = usize::from(self.axis.is_some()) + usize::from(self.plane_normal.is_some());
        if !faults.check_one_of(at, given, "`axis`, `plane_normal`") {
            return None;
        }
        let direction = Vector::from(self.axis.or(self.plane_normal)?);
        if !(SHORTEST_DIRECTION..=LONGEST_DIRECTION).contains(&direction.norm()) {
            let name = if self.axis.is_some() { "axis" } else { "plane_normal" };
            let detail = "a direction is between 1e-6 and 1e6 long";
            faults.add(&at.key(name), ErrorCode::OutOfRange, detail);
            return None;
        }
        Some(match self.axis {
            Some(_) => Restriction::Axis(direction),
            None => Restriction::Plane(direction),
        })
    }
}

/// The context of a plan's coordinates.
pub struct MovementContext<'a> {
    /// True if the plan is in the other of LPS and RAS than the case.
    pub mirrored_axes: bool,
    /// The centre of the mesh's bounding box in mm, in the frame of the case; `None` if there is no mesh yet.
    pub centre: Option<Vector>,
    pub limits: &'a Limits,
}

impl MovementContext<'_> {
    /// A vector of the plan in the frame of the case.
    pub fn vector(&self, Triple([x, y, z]): Triple) -> Vector {
        let sign = if self.mirrored_axes { -1.0 } else { 1.0 };
        Vector::new(sign * x, sign * y, z)
    }

    fn movement(&self, movement: RigidMovement) -> RigidMovement {
        match self.mirrored_axes {
            true => movement.between_lps_and_ras(),
            false => movement,
        }
    }

    /// Refuses a total movement that rotates too far or displaces the centre of the mesh too far.
    pub fn check_whole(&self, at: &Pointer, movement: &RigidMovement, faults: &mut Faults) {
        let degrees = movement.angle().to_degrees();
        let turn_limit = self.limits.rotation_deg;
        // An angle out of a rotation carries rounding in its last digits.
        if degrees.is_nan() || degrees > turn_limit * (1.0 + 1e-9) {
            let detail = format!("turns by {degrees:.3} deg, at most {turn_limit} deg are allowed");
            faults.add(at, ErrorCode::PlanOutOfRange, detail);
        }
        let Some(centre) = self.centre else { return };
        let displacement = movement.displacement(&centre);
        let distance = displacement.norm();
        let limit = self.limits.centre_displacement_mm;
        if distance.is_nan() || distance > limit {
            let told = match distance.is_finite() {
                true => format!("{distance:.3}"),
                false => components(displacement),
            };
            let detail = format!(
                "displaces the centre of the mesh by {told} mm, at most {limit} mm are allowed"
            );
            faults.add(at, ErrorCode::PlanOutOfRange, detail);
        }
    }
}

impl MovementDocument {
    /// True if fields of the form with `translation_mm` and `rotation_deg` are given.
    pub fn has_pivot_form(&self) -> bool {
        self.translation_mm.is_some()
            || self.rotation_deg.is_some()
            || self.rotation_order.is_some()
            || self.pivot_mm.is_some()
            || self.restrict_to.is_some()
    }

    /// The movement in the frame of the case; `None` if faults were added.
    pub fn to_movement(
        &self,
        at: &Pointer,
        context: &MovementContext,
        faults: &mut Faults,
    ) -> Option<RigidMovement> {
        let given = usize::from(self.has_pivot_form()) + usize::from(self.matrix4x4.is_some());
        let forms = "`translation_mm` with `rotation_deg`, `matrix4x4`";
        if !faults.check_one_of(at, given, forms) {
            return None;
        }
        let movement = match &self.matrix4x4 {
            Some(matrix) => from_matrix(&matrix.0, &at.key("matrix4x4"), faults)?,
            None => self.about_pivot(at, context.limits, faults)?,
        };
        Some(context.movement(movement))
    }

    fn about_pivot(
        &self,
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Option<RigidMovement> {
        if self.translation_mm.is_none() && self.rotation_deg.is_none() {
            faults.add(
                at,
                ErrorCode::MissingField,
                "give `translation_mm`, `rotation_deg`, or both",
            );
            return None;
        }
        let translation = Vector::from(self.translation_mm.unwrap_or_default());
        let degrees = Vector::from(self.rotation_deg.unwrap_or_default());
        let turns = degrees != Vector::zeros();
        if turns && self.pivot_mm.is_none() {
            faults.add(
                &at.key("pivot_mm"),
                ErrorCode::MissingField,
                "`pivot_mm` is required where a rotation is not 0",
            );
        }
        let pivot = Vector::from(self.pivot_mm.unwrap_or_default());
        let is_near = pivot.amax() <= FARTHEST_PIVOT_MM;
        if !is_near {
            let detail =
                format!("a coordinate is {:e} mm, at most 1e8 mm are allowed", pivot.amax());
            faults.add(&at.key("pivot_mm"), ErrorCode::PlanOutOfRange, detail);
        }
        let inside = within_limits(at, translation, degrees, limits, faults);
        let known = !turns || self.pivot_mm.is_some();
        let angles = degrees.map(f64::to_radians);
        let restriction =
            self.restrict_to.map(|to| to.to_restriction(&at.key("restrict_to"), faults));
        if !inside || !known || !is_near || restriction == Some(None) {
            return None;
        }
        let movement = RigidMovement::about_pivot(angles, pivot, translation);
        let restricted = restriction.flatten().map(|to| movement.restricted(&pivot, to));
        Some(restricted.unwrap_or(movement))
    }
}

/// What a vector is told by whose length is more than the largest number.
fn components(vector: Vector) -> String {
    format!("({}, {}, {})", vector.x, vector.y, vector.z)
}

fn within_limits(
    at: &Pointer,
    translation: Vector,
    degrees: Vector,
    limits: &Limits,
    faults: &mut Faults,
) -> bool {
    let (length, longest) = (translation.norm(), limits.translation_mm);
    if length > longest {
        let told = if length.is_finite() { length.to_string() } else { components(translation) };
        let detail = format!("moves by {told} mm, at most {longest} mm are allowed");
        faults.add(&at.key("translation_mm"), ErrorCode::PlanOutOfRange, detail);
    }
    let (angle, largest) = (degrees.amax(), limits.rotation_deg);
    if angle > largest {
        let detail = format!("turns by {angle} deg, at most {largest} deg are allowed");
        faults.add(&at.key("rotation_deg"), ErrorCode::PlanOutOfRange, detail);
    }
    length <= longest && angle <= largest
}

fn from_matrix(matrix: &[f64; 16], at: &Pointer, faults: &mut Faults) -> Option<RigidMovement> {
    RigidMovement::from_matrix4(matrix)
        .map_err(|error| faults.add(at, ErrorCode::PlanNotRigid, error.to_string()))
        .ok()
}
