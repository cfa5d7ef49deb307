//! Conversion of the cuts and segments of a document to the numerics, with their errors.

use std::ops::Range;

use mechanics::mesh::Vector;
use mechanics::osteotomy::contact::Bridge;
use mechanics::osteotomy::{
    Cut, CutError, CutSide, Extent, LabelError, Osteotomy, Plane, RuleError, SegmentRule, Side,
};

use super::document::{CutDocument, CutSegmentDocument, OsteotomyDocument};
use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_distinct;
use crate::schema::wire::problem::Problem;

/// Near an osteotomy tissue is detached; with cells of 4 mm this frees one row of nodes on either side.
const FREE_BAND_MM: f64 = 3.0;

/// The context of reading the document.
pub struct OsteotomyContext<'a> {
    /// Whether the document is in the other of LPS and RAS than the scan.
    pub mirrored_axes: bool,
    pub limits: &'a Limits,
}

/// An osteotomy in the frame of a scan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedOsteotomy {
    pub osteotomy: Osteotomy,
    pub free_band_mm: f64,
}

impl OsteotomyContext<'_> {
    pub(super) fn vector(&self, Triple([x, y, z]): Triple) -> Vector {
        let sign = if self.mirrored_axes { -1.0 } else { 1.0 };
        Vector::new(sign * x, sign * y, z)
    }
}

impl OsteotomyDocument {
    /// Errors are added to `faults`; then the result is `None`.
    pub fn to_osteotomy(
        &self,
        at: &Pointer,
        context: &OsteotomyContext,
        faults: &mut Faults,
    ) -> Option<PlannedOsteotomy> {
        let most = context.limits.list_entries as usize;
        faults.check_length(&at.key("cuts"), self.cuts.len(), most);
        faults.check_length(&at.key("segments"), self.segments.len(), most);
        if self.segments.is_empty() {
            let detail = "an osteotomy has at least one segment";
            faults.add(&at.key("segments"), ErrorCode::MissingField, detail);
        }
        let free_band_mm = self.free_band_mm.unwrap_or(FREE_BAND_MM);
        let has_band = faults.check_range(&at.key("free_band_mm"), free_band_mm, 0.0..=30.0, "mm");
        let risks = self.to_risks(&at.key("risks"), context, faults);
        let cuts = self.to_cuts(at, context, faults);
        let named = self.pieces();
        let segments: Vec<_> = (self.segments.iter().enumerate())
            .map(|(number, segment)| {
                let at = at.key("segments").index(number);
                segment.to_rule(&named, &at, context, faults)
            })
            .collect();
        let cuts = cuts?;
        let segments = segments.into_iter().collect::<Option<Vec<_>>>()?;
        let osteotomy = Osteotomy::new(cuts, segments)
            .map_err(|error| faults.add(at, code_of(&error), error.to_string()))
            .ok()?
            .with_risks(risks);
        (has_band && !self.segments.is_empty())
            .then_some(PlannedOsteotomy { osteotomy, free_band_mm })
    }
}

impl OsteotomyDocument {
    /// The planes, then the pieces of each polyline.
    fn to_cuts(
        &self,
        at: &Pointer,
        context: &OsteotomyContext,
        faults: &mut Faults,
    ) -> Option<Vec<Cut>> {
        let place = at.key("polylines");
        faults.check_length(&place, self.polylines.len(), context.limits.list_entries as usize);
        let names = self.polylines.iter().map(|line| line.name.as_str());
        check_distinct(names, &place, faults);
        let cuts: Vec<Option<Cut>> = (self.cuts.iter().enumerate())
            .map(|(number, cut)| cut.to_cut(&at.key("cuts").index(number), context, faults))
            .collect();
        let lines: Vec<Option<Vec<Cut>>> = (self.polylines.iter().enumerate())
            .map(|(number, line)| {
                let at = place.index(number);
                if self.cuts.iter().any(|cut| cut.name.trim() == line.name.trim()) {
                    let detail = format!("`{}` is also the name of a cut", line.name.trim());
                    faults.add(&at.key("name"), ErrorCode::DuplicateName, detail);
                }
                line.to_cuts(&at, number, context, faults)
            })
            .collect();
        let cuts = cuts.into_iter().map(|cut| cut.map(|cut| vec![cut]));
        let all: Option<Vec<Vec<Cut>>> = cuts.chain(lines).collect();
        all.map(|all| all.concat())
    }

    /// The name of each plane and polyline, and the numbers of its cuts.
    fn pieces(&self) -> Vec<(&str, Range<usize>)> {
        let planes = self.cuts.iter().map(|cut| (cut.name.trim(), 1));
        let lines = self.polylines.iter();
        let lines = lines.map(|line| (line.name.trim(), line.polyline_mm.len().max(1) - 1));
        let mut first = 0;
        let numbered = planes.chain(lines).map(|(name, count)| {
            first += count;
            (name, first - count..first)
        });
        numbered.collect()
    }
}

/// Segments that are separate bones without cuts; pointers start at the list of them.
pub fn given_segments(
    names: &[&str],
    at: &Pointer,
    faults: &mut Faults,
) -> Option<PlannedOsteotomy> {
    let rule = |&name: &&str| SegmentRule { name: name.to_owned(), ..SegmentRule::default() };
    let osteotomy = Osteotomy::new(Vec::new(), names.iter().map(rule).collect())
        .map_err(|error| faults.add(at, code_of(&error), error.to_string()))
        .ok()?;
    Some(PlannedOsteotomy { osteotomy, free_band_mm: FREE_BAND_MM })
}

fn code_of(error: &RuleError) -> ErrorCode {
    match error {
        RuleError::CutTwice { .. }
        | RuleError::SegmentTwice { .. }
        | RuleError::NamedTwice { .. } => ErrorCode::DuplicateName,
        RuleError::Reserved { .. } => ErrorCode::BadName,
        RuleError::TooMany { .. } => ErrorCode::TooMany,
        RuleError::NoSuchCut { .. } => ErrorCode::UnknownCut,
        RuleError::Unused { .. } => ErrorCode::UnusedCut,
        RuleError::BoundedWithoutSeed { .. } => ErrorCode::MissingField,
    }
}

/// The refusal of a segment that is not in the bone of a scan, at its place.
pub fn unfound(error: &LabelError, osteotomy: &Osteotomy, at: &Pointer) -> Problem {
    let named = |name: &str| {
        let number = osteotomy.segments().iter().position(|segment| segment.name == name);
        number.map_or_else(|| at.clone(), |number| at.key("segments").index(number))
    };
    let place = match error {
        LabelError::NoBone { segment } | LabelError::LineTurned { segment, .. } => named(segment),
        LabelError::SeedOffBone { segment, seed, .. }
        | LabelError::SeedAcross { segment, seed, .. } => {
            named(segment).key("seeds_mm").index(*seed)
        }
        LabelError::SeedsMeet { other: segment, .. } | LabelError::NeedsSeed { segment, .. } => {
            named(segment).key("seeds_mm")
        }
    };
    Problem::at(&place, ErrorCode::SegmentNotFound, error.to_string())
}

/// Refuses segments still connected by bone across a cut.
pub fn refuse_bridges(
    bridges: &[Bridge],
    osteotomy: &Osteotomy,
    at: &Pointer,
    faults: &mut Faults,
) {
    for bridge in bridges {
        let segment = &osteotomy.segments()[bridge.segment].name;
        let [x, y, z]: [f64; 3] = bridge.centre.into();
        let detail = match bridge.faces {
            0 => format!("bone of segment `{segment}` is around the cut, not beside its extent"),
            faces => format!(
                "segment `{segment}` still hangs at {:.1} mm² of bone ({faces} faces of voxels) around \
                 ({x:.1}, {y:.1}, {z:.1}) mm, beside the extent of the cut",
                bridge.area_mm2
            ),
        };
        let place = match osteotomy.cuts()[bridge.cut].chain() {
            Some(line) => at.key("polylines").index(line),
            None => at.key("cuts").index(bridge.cut),
        };
        faults.add(&place, ErrorCode::CutLeavesBridge, detail);
    }
}

impl CutDocument {
    fn to_cut(&self, at: &Pointer, context: &OsteotomyContext, faults: &mut Faults) -> Option<Cut> {
        let name = self.name.trim();
        faults.check_name(&at.key("name"), name, context.limits.name_characters as usize);
        if self.radius_mm.is_some() && self.corners_mm.is_some() {
            let detail = "a cut is a disc or a polygon, not both";
            faults.add(at, ErrorCode::OneOf, detail);
            return None;
        }
        let disc = self.radius_mm.map(|radius| Extent::Disc { radius });
        let polygon = self.corners_mm.as_ref().map(|corners| Extent::Polygon {
            corners: corners.iter().map(|&corner| context.vector(corner)).collect(),
        });
        let cut = Plane::new(context.vector(self.point_mm), context.vector(self.normal))
            .and_then(|plane| Cut::new(name, plane, disc.or(polygon), self.kerf_mm.unwrap_or(0.0)));
        cut.map_err(|error| {
            let at = member_of(&error).map_or_else(|| at.clone(), |member| at.key(member));
            faults.add(&at, ErrorCode::OutOfRange, error.to_string());
        })
        .ok()
    }
}

/// The invalid member; a point may be that of the plane or a corner.
fn member_of(error: &CutError) -> Option<&'static str> {
    match error {
        CutError::Point => None,
        CutError::Normal => Some("normal"),
        CutError::Kerf { .. } => Some("kerf_mm"),
        CutError::Radius { .. } => Some("radius_mm"),
        CutError::Polygon { .. } => Some("corners_mm"),
    }
}

impl CutSegmentDocument {
    fn to_rule(
        &self,
        cuts: &[(&str, Range<usize>)],
        at: &Pointer,
        context: &OsteotomyContext,
        faults: &mut Faults,
    ) -> Option<SegmentRule> {
        let name = self.name.trim();
        faults.check_name(&at.key("name"), name, context.limits.name_characters as usize);
        let most = context.limits.list_entries as usize;
        faults.check_length(&at.key("seeds_mm"), self.seeds_mm.len(), most);
        let mut sides = Vec::new();
        let mut all_known = self.seeds_mm.len() <= most;
        for (member, names, side) in
            [("below", &self.below, Side::Below), ("above", &self.above, Side::Above)]
        {
            for (number, wanted) in names.iter().enumerate() {
                let known = cuts.iter().find(|(name, _)| *name == wanted.trim());
                match known {
                    Some((_, pieces)) => {
                        sides.extend(pieces.clone().map(|cut| CutSide { cut, side }));
                    }
                    None => {
                        all_known = false;
                        let detail = format!("there is no cut `{}`", wanted.trim());
                        let at = at.key(member).index(number);
                        faults.add(&at, ErrorCode::UnknownCut, detail);
                    }
                }
            }
        }
        let seeds = self.seeds_mm.iter().map(|&seed| context.vector(seed)).collect();
        all_known.then(|| SegmentRule { name: name.to_owned(), sides, seeds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::wire::strict;

    fn read(text: &str, mirrored_axes: bool) -> Result<PlannedOsteotomy, Vec<(String, ErrorCode)>> {
        let limits = Limits::default();
        let places = |problem: Problem| -> Vec<(String, ErrorCode)> {
            problem.errors.iter().map(|error| (error.pointer.clone(), error.code)).collect()
        };
        let document: OsteotomyDocument =
            strict::parse(text.as_bytes(), &limits).map_err(places)?;
        let mut faults = Faults::default();
        let context = OsteotomyContext { mirrored_axes, limits: &limits };
        let found = document.to_osteotomy(&Pointer::root(), &context, &mut faults);
        match faults.into_result() {
            Ok(()) => Ok(found.unwrap()),
            Err(problem) => Err(places(problem)),
        }
    }

    const MAXILLA: &str = r#"{"cuts": [{"name": "le-fort-1", "point_mm": [1, 2, 3], "normal": [0, 3, 4]}],
        "segments": [{"name": "maxilla", "below": ["le-fort-1"], "seeds_mm": [[5, 6, 7]]}]}"#;

    #[test]
    fn a_document_is_an_osteotomy_in_the_frame_of_the_scan() {
        for (mirrored, sign) in [(false, 1.0), (true, -1.0)] {
            let found = read(MAXILLA, mirrored).unwrap();
            let [cut] = found.osteotomy.cuts() else { panic!() };
            assert_eq!(cut.plane().point(), Vector::new(sign, 2.0 * sign, 3.0));
            assert_eq!(cut.plane().normal(), Vector::new(0.0, 0.6 * sign, 0.8));
            assert_eq!((cut.is_bounded(), cut.kerf()), (false, 0.0));
            let [segment] = found.osteotomy.segments() else { panic!() };
            assert_eq!(segment.sides, [CutSide { cut: 0, side: Side::Below }]);
            assert_eq!(segment.seeds, [Vector::new(5.0 * sign, 6.0 * sign, 7.0)]);
            assert_eq!(found.free_band_mm, 3.0);
        }
    }

    #[test]
    fn each_mistake_is_reported_at_its_place() {
        let changed = |from: &str, to: &str| {
            assert!(MAXILLA.contains(from), "{from}");
            read(&MAXILLA.replace(from, to), false).unwrap_err()
        };
        let one = |at: &str, code: ErrorCode| vec![(at.to_owned(), code)];
        let cases = [
            ("[0, 3, 4]", "[0, 0, 0]", "/cuts/0/normal", ErrorCode::OutOfRange),
            ("[0, 3, 4]", "[0, 3, 4], \"kerf_mm\": 11", "/cuts/0/kerf_mm", ErrorCode::OutOfRange),
            (
                "[0, 3, 4]",
                "[0, 3, 4], \"radius_mm\": 0",
                "/cuts/0/radius_mm",
                ErrorCode::OutOfRange,
            ),
            (
                "[0, 3, 4]",
                "[0, 3, 4], \"corners_mm\": [[0, 0, 0]]",
                "/cuts/0/corners_mm",
                ErrorCode::OutOfRange,
            ),
            (
                "[0, 3, 4]",
                "[0, 3, 4], \"radius_mm\": 1, \"corners_mm\": []",
                "/cuts/0",
                ErrorCode::OneOf,
            ),
            ("[\"le-fort-1\"]", "[\"lefort\"]", "/segments/0/below/0", ErrorCode::UnknownCut),
            ("\"below\": [\"le-fort-1\"], ", "", "", ErrorCode::UnusedCut),
            ("\"maxilla\"", "\"skin\"", "", ErrorCode::BadName),
            ("\"maxilla\"", "\" \"", "/segments/0/name", ErrorCode::BadName),
            (
                "\"maxilla\"",
                "\"maxilla\", \"side\": 1",
                "/segments/0/side",
                ErrorCode::UnknownField,
            ),
            (
                "{\"cuts\"",
                "{\"free_band_mm\": -1, \"cuts\"",
                "/free_band_mm",
                ErrorCode::OutOfRange,
            ),
        ];
        for (from, to, at, code) in cases {
            assert_eq!(changed(from, to), one(at, code), "{to}");
        }
        let nothing = read(r#"{"segments": []}"#, false).unwrap_err();
        assert_eq!(nothing, one("/segments", ErrorCode::MissingField));
    }
}
