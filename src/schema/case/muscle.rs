//! Muscles of a case, as regions with fibres, as polylines or as bodies with a surface, and their tissue.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fibre::to_course;
use super::material::{MaterialDocument, MaterialDocuments};
use super::muscle_box::{FARTHEST_MM, MuscleBoxDocument};
use super::muscle_mixing::StiffeningDocument;
use super::preset::expanded;
use super::preset_name::doubt;
use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_distinct;
use mechanics::material::LinearElastic;
use mechanics::mesh::{TriangleSurface, Vector, Warning};
use mechanics::prediction::{BodyFibres, Muscle, MuscleCourse, Stiffening};

/// Range of the distance from its lines at which a muscle acts, in mm.
pub const REACH_MM: (f64, f64) = (0.1, 50.0);

/// A muscle that plans may activate: a region with fibres, polylines through the tissue, or a closed surface. Exactly
/// one of `region`, `surface`, `box_mm` and, without these, `lines_mm`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MuscleDocument {
    pub name: String,
    /// All cells of a region contract, each along its fibre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub region: Option<String>,
    /// Uniform direction of its fibres; without it and `array` that of the material of the `region`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub direction: Option<Triple>,
    /// A cell array of the volume mesh with 3 components, or else a point array, instead of `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub array: Option<String>,
    /// Lines through the tissue along which it contracts, each of two or more points, in mm in the case's frame. Beside `surface`
    /// or `box_mm` they give the fibre direction, each cell that of the nearest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Option<Vec<Vec<Triple>>>)]
    pub lines_mm: Option<Vec<Vec<Triple>>>,
    /// The distance from its lines over which the stress falls from its full value to 0; in [0.1, 50].
    /// Default: 6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.1, maximum = 50.0)]
    pub within_mm: Option<f64>,
    /// The closed surface of the muscle: the id of a mesh. The muscle share of a cell is that of its sample points inside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub surface: Option<String>,
    /// A box instead of `surface`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub box_mm: Option<MuscleBoxDocument>,
    /// Fibres along the longest axis of this number of consecutive boxes of `surface`: 1, 2 or 4. Of strap muscles only
    /// (`muscle-broad`). Default 1, without any other fibre direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 4)]
    pub boxes: Option<u32>,
    /// The material of the muscle, mixed into its cells by its share as `muscle_mixing` states. Its `fibre` has no direction:
    /// it follows the muscle. Not of a `region`, which has its own. Absent: the muscle contracts, and the material is unchanged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub material: Option<MaterialDocument>,
    /// The `fibre` of its material stiffens with activation. Absent: it is constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub stiffening: Option<StiffeningDocument>,
}

/// The usual reach of a muscle around its lines.
pub const USUAL_REACH_MM: f64 = 6.0;

/// Surfaces in mm, by id.
pub type Surfaces = BTreeMap<String, Arc<TriangleSurface>>;

/// Context of reading muscles.
#[derive(Clone, Copy)]
pub struct MuscleContext<'a> {
    pub limits: &'a Limits,
    /// Absent: the surfaces of bodies have not been read yet, and the rest is checked.
    pub surfaces: Option<&'a Surfaces>,
}

/// The muscles of a case, with distinct names.
pub fn to_muscles(
    documents: &[MuscleDocument],
    at: &Pointer,
    context: MuscleContext,
    faults: &mut Faults,
) -> Vec<Muscle> {
    faults.check_length(at, documents.len(), context.limits.map_entries as usize);
    check_distinct(documents.iter().map(|muscle| muscle.name.as_str()), at, faults);
    let documents = documents.iter().enumerate();
    documents.filter_map(|(index, own)| own.to_muscle(&at.index(index), context, faults)).collect()
}

/// Objections to the presets of muscles.
pub(super) fn doubts(documents: &[MuscleDocument]) -> impl Iterator<Item = Warning> + '_ {
    let preset = |own: &MuscleDocument| own.material.as_ref().and_then(|material| material.preset);
    documents.iter().filter_map(move |own| doubt(&own.name, preset(own)))
}

/// The materials of muscles by name, with presets in full.
pub fn muscle_materials(documents: &[MuscleDocument]) -> MaterialDocuments {
    let of = |own: &MuscleDocument| Some((own.name.clone(), expanded(own.material.as_ref()?)));
    documents.iter().filter_map(of).collect()
}

impl MuscleDocument {
    fn to_muscle(
        &self,
        at: &Pointer,
        context: MuscleContext,
        faults: &mut Faults,
    ) -> Option<Muscle> {
        let longest = context.limits.name_characters as usize;
        faults.check_name(&at.key("name"), &self.name, longest);
        let has_body = self.surface.is_some() || self.box_mm.is_some();
        let sources = [
            self.region.is_some(),
            self.surface.is_some(),
            self.box_mm.is_some(),
            self.lines_mm.is_some() && !has_body,
        ];
        let given = sources.into_iter().filter(|is_given| *is_given).count();
        if !faults.check_one_of(at, given, "`region`, `surface`, `box_mm`, `lines_mm`") {
            return None;
        }
        let tissue = self.to_tissue(&at.key("material"), faults);
        let stiffening = self.to_stiffening(at, faults);
        let course = match (&self.region, &self.lines_mm) {
            (Some(region), _) => self.in_region(region, at, faults)?,
            (None, Some(lines)) if !has_body => self.around(lines, at, context.limits, faults)?,
            (None, _) => self.body(at, context, faults)?,
        };
        Some(Muscle { name: self.name.trim().to_owned(), course, tissue, stiffening })
    }

    fn in_region(&self, region: &str, at: &Pointer, faults: &mut Faults) -> Option<MuscleCourse> {
        let others = [
            ("lines_mm", self.lines_mm.is_some()),
            ("within_mm", self.within_mm.is_some()),
            ("boxes", self.boxes.is_some()),
            ("material", self.material.is_some()),
            ("stiffening", self.stiffening.is_some()),
        ];
        refuse(&others, "region", at, faults);
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
        let others = [
            ("direction", self.direction.is_some()),
            ("array", self.array.is_some()),
            ("boxes", self.boxes.is_some()),
        ];
        refuse(&others, "lines_mm", at, faults);
        let within = self.within_mm.unwrap_or(USUAL_REACH_MM);
        let (least, most) = REACH_MM;
        faults.check_range(&at.key("within_mm"), within, least..=most, "mm");
        let lines = to_lines(lines, &at.key("lines_mm"), limits, faults);
        Some(MuscleCourse::Lines { lines, within })
    }

    fn body(
        &self,
        at: &Pointer,
        context: MuscleContext,
        faults: &mut Faults,
    ) -> Option<MuscleCourse> {
        let (place, form) = match &self.surface {
            Some(_) => (at.key("surface"), "surface"),
            None => (at.key("box_mm"), "box_mm"),
        };
        refuse(&[("within_mm", self.within_mm.is_some())], form, at, faults);
        let fibres = self.body_fibres(at, context.limits, faults);
        let surface = self.body_surface(&place, context.surfaces, faults);
        Some(MuscleCourse::Body { surface: surface?, fibres: fibres? })
    }

    /// Its closed surface in mm, or that of its box; nothing of other muscles, and of surfaces that have not been read.
    pub fn body_surface(
        &self,
        at: &Pointer,
        surfaces: Option<&Surfaces>,
        faults: &mut Faults,
    ) -> Option<Arc<TriangleSurface>> {
        let Some(id) = &self.surface else {
            return Some(Arc::new(self.box_mm.as_ref()?.to_surface(at, faults)?));
        };
        let found = surfaces?.get(id).cloned();
        if found.is_none() {
            faults.add(at, ErrorCode::UnknownMesh, format!("mesh `{id}` is not a surface"));
        }
        found
    }

    /// The fibre direction of a body; by default along its box.
    fn body_fibres(
        &self,
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Option<BodyFibres> {
        let ways = [
            self.direction.is_some(),
            self.array.is_some(),
            self.lines_mm.is_some(),
            self.boxes.is_some(),
        ];
        let given = ways.into_iter().filter(|is_given| *is_given).count();
        let forms = "`direction`, `array`, `lines_mm`, `boxes`";
        if given > 0 && !faults.check_one_of(at, given, forms) {
            return None;
        }
        if let Some(lines) = &self.lines_mm {
            return Some(BodyFibres::Lines(to_lines(lines, &at.key("lines_mm"), limits, faults)));
        }
        if self.direction.is_some() || self.array.is_some() {
            let course = to_course(self.direction, self.array.as_deref(), at, faults)?;
            return Some(BodyFibres::Course(course));
        }
        let halvings = match self.boxes.unwrap_or(1) {
            1 => 0,
            2 => 1,
            4 => 2,
            other => {
                let detail = format!("a muscle is divided into 1, 2 or 4 boxes, not into {other}");
                faults.add(&at.key("boxes"), ErrorCode::OutOfRange, detail);
                return None;
            }
        };
        Some(BodyFibres::Box { halvings })
    }

    fn to_stiffening(&self, at: &Pointer, faults: &mut Faults) -> Option<Stiffening> {
        let own = self.stiffening.as_ref()?;
        let material = self.material.as_ref().map(expanded);
        let Some(fibre) = material.and_then(|material| material.fibre?.to_fibre()) else {
            let detail = "stiffening needs `young_modulus_kpa` of the `fibre` of `material`";
            faults.add(&at.key("stiffening"), ErrorCode::MissingField, detail);
            return None;
        };
        own.to_stiffening(fibre, &at.key("stiffening"), faults)
    }

    /// Linear tissue, with presets in full, whose fibres follow the muscle.
    fn to_tissue(&self, at: &Pointer, faults: &mut Faults) -> Option<LinearElastic> {
        let material = expanded(self.material.as_ref()?);
        let place = at.key("fibre");
        let fibre = material.fibre.as_ref();
        let wrong = [
            ("/law", material.law.is_some(), "tissue that is mixed has no law of finite strain"),
            (
                "/fibre/direction",
                fibre.is_some_and(|own| own.direction.is_some()),
                "the muscle says where its fibres run",
            ),
            (
                "/fibre/array",
                fibre.is_some_and(|own| own.array.is_some()),
                "the muscle says where its fibres run",
            ),
            (
                "/fibre/k1_kpa",
                fibre.is_some_and(|own| own.k1_kpa.is_some() || own.k2.is_some()),
                "tissue that is mixed has no tension-only fibres",
            ),
        ];
        for (member, _, why) in wrong.into_iter().filter(|(_, is_given, _)| *is_given) {
            let at = Pointer::from_text(&format!("{at}{member}"));
            faults.add(&at, ErrorCode::MethodNotAvailable, why);
        }
        let isotropic = material.to_isotropic(at, faults)?;
        match fibre {
            Some(fibre) => fibre.to_stiffened(isotropic, &place, faults),
            None => Some(isotropic),
        }
    }
}

/// Refuses members that do not belong to the given form.
fn refuse(members: &[(&str, bool)], form: &str, at: &Pointer, faults: &mut Faults) {
    for (name, _) in members.iter().filter(|(_, is_given)| *is_given) {
        let detail = format!("`{name}` does not belong to a muscle with `{form}`");
        faults.add(&at.key(name), ErrorCode::UnknownField, detail);
    }
}

/// Points of all lines of a muscle: each is compared with each cell.
const MOST_POINTS: usize = 1000;

/// Lines of a muscle, each of two or more points.
fn to_lines(
    lines: &[Vec<Triple>],
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) -> Vec<Vec<Vector>> {
    faults.check_length(at, lines.len(), limits.map_entries as usize);
    for (index, line) in lines.iter().enumerate() {
        check_line(line, &at.index(index), limits, faults);
    }
    if lines.is_empty() {
        faults.add(at, ErrorCode::MissingField, "a muscle has at least one line");
    }
    let count: usize = lines.iter().map(Vec::len).sum();
    if count > MOST_POINTS {
        let detail = format!(
            "the lines have {count} points, at most {MOST_POINTS} are allowed: omit points of straight parts"
        );
        faults.add(at, ErrorCode::TooMany, detail);
    }
    let points = |line: &Vec<Triple>| line.iter().map(|&point| Vector::from(point)).collect();
    lines.iter().map(points).collect()
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
