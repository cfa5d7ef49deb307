//! Muscles of a case, as regions with fibres or as polylines.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fibre::to_course;
use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_distinct;
use mechanics::mesh::Vector;
use mechanics::prediction::{Muscle, MuscleCourse};

/// Distances from its lines within which a muscle may pull, in mm.
pub const REACH_MM: (f64, f64) = (0.1, 50.0);

/// Farthest coordinate of a point of a line in mm.
const FARTHEST_MM: f64 = 1e8;

/// A muscle that plans may activate: a region with fibres, or polylines through the tissue. Exactly one of `region` and
/// `lines_mm`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MuscleDocument {
    pub name: String,
    /// All cells of a region pull, each along its fibre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<String>,
    /// Of the fibres in the whole region; without it and `array` those of the material of the region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub direction: Option<Triple>,
    /// A cell array of the volume mesh with 3 components, in the place of `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub array: Option<String>,
    /// Lines through the tissue along which it pulls, each of two points or more, in mm in the frame of the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<Vec<Vec<Triple>>>)]
    pub lines_mm: Option<Vec<Vec<Triple>>>,
    /// The distance from its lines at which the pull has fallen to nothing, from all of it at a line; in [0.1, 50].
    /// Default: 6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.1, maximum = 50.0)]
    pub within_mm: Option<f64>,
}

/// The usual reach of a muscle around its lines.
pub const USUAL_REACH_MM: f64 = 6.0;

/// The muscles of a case, with distinct names.
pub fn to_muscles(
    documents: &[MuscleDocument],
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) -> Vec<Muscle> {
    faults.check_length(at, documents.len(), limits.map_entries as usize);
    check_distinct(documents.iter().map(|muscle| muscle.name.as_str()), at, faults);
    let documents = documents.iter().enumerate();
    documents.filter_map(|(index, own)| own.to_muscle(&at.index(index), limits, faults)).collect()
}

impl MuscleDocument {
    fn to_muscle(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) -> Option<Muscle> {
        faults.check_name(&at.key("name"), &self.name, limits.name_characters as usize);
        let given = usize::from(self.region.is_some()) + usize::from(self.lines_mm.is_some());
        if !faults.check_one_of(at, given, "`region`, `lines_mm`") {
            return None;
        }
        let course = match (&self.region, &self.lines_mm) {
            (Some(region), _) => self.in_region(region, at, faults)?,
            (None, lines) => self.around(lines.as_ref()?, at, limits, faults)?,
        };
        Some(Muscle { name: self.name.trim().to_owned(), course })
    }

    fn in_region(&self, region: &str, at: &Pointer, faults: &mut Faults) -> Option<MuscleCourse> {
        self.refuse("within_mm", self.within_mm.is_some(), at, faults);
        let fibres = match (self.direction, &self.array) {
            (None, None) => None,
            (direction, array) => Some(to_course(direction, array.as_deref(), at, faults)?),
        };
        Some(MuscleCourse::Region { region: region.trim().to_owned(), fibres })
    }

    fn around(
        &self,
        lines: &[Vec<Triple>],
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Option<MuscleCourse> {
        self.refuse("direction", self.direction.is_some(), at, faults);
        self.refuse("array", self.array.is_some(), at, faults);
        let place = at.key("lines_mm");
        faults.check_length(&place, lines.len(), limits.map_entries as usize);
        for (index, line) in lines.iter().enumerate() {
            check_line(line, &place.index(index), limits, faults);
        }
        if lines.is_empty() {
            faults.add(&place, ErrorCode::MissingField, "a muscle has at least one line");
        }
        let within = self.within_mm.unwrap_or(USUAL_REACH_MM);
        let (least, most) = REACH_MM;
        faults.check_range(&at.key("within_mm"), within, least..=most, "mm");
        let points = |line: &Vec<Triple>| line.iter().map(|&point| Vector::from(point)).collect();
        Some(MuscleCourse::Lines { lines: lines.iter().map(points).collect(), within })
    }

    /// Refuses a member that belongs to the other form.
    fn refuse(&self, name: &str, is_given: bool, at: &Pointer, faults: &mut Faults) {
        if is_given {
            let form = if self.region.is_some() { "region" } else { "lines_mm" };
            let detail = format!("`{name}` does not belong to a muscle with `{form}`");
            faults.add(&at.key(name), ErrorCode::UnknownField, detail);
        }
    }
}

fn check_line(line: &[Triple], at: &Pointer, limits: &Limits, faults: &mut Faults) {
    faults.check_length(at, line.len(), limits.map_entries as usize);
    if line.len() < 2 {
        let detail = format!("a line has at least two points, this one {}", line.len());
        faults.add(at, ErrorCode::MissingField, detail);
    }
    for (index, point) in line.iter().enumerate() {
        for (axis, &coordinate) in point.0.iter().enumerate() {
            let place = at.index(index).index(axis);
            faults.check_range(&place, coordinate, -FARTHEST_MM..=FARTHEST_MM, "mm");
        }
    }
}
