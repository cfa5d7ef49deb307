//! Definition of an osteotomy: cuts, and the segments as sides of them.

use std::collections::BTreeSet;

use super::cut::{Cut, Side};
use super::risk::Risk;
use crate::mesh::Vector;

/// Labels of voxels are bytes, and some of them are taken.
pub const MOST_SEGMENTS: usize = 200;
/// What node sets of a mesh are called that are no segment.
const RESERVED: [&str; 8] = ["fixed", "sliding", "free", "skin", "bone", "cut", "sawn", "rest"];

/// Why cuts and segments do not go together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RuleError {
    #[error("cut `{name}` stands twice")]
    CutTwice { name: String },
    #[error("segment `{name}` stands twice")]
    SegmentTwice { name: String },
    #[error("`{name}` is the name of a class of nodes and of no segment")]
    Reserved { name: String },
    #[error("{count} segments, {MOST_SEGMENTS} at most are possible")]
    TooMany { count: usize },
    #[error("segment `{segment}` lies at cut {cut} of {cuts}")]
    NoSuchCut { segment: String, cut: usize, cuts: usize },
    #[error("segment `{segment}` names cut `{cut}` twice")]
    NamedTwice { segment: String, cut: String },
    #[error("no segment lies at cut `{name}`")]
    Unused { name: String },
    #[error("segment `{segment}` lies at the bounded cut `{cut}` and has no seed")]
    BoundedWithoutSeed { segment: String, cut: String },
}

/// A side of one of the cuts, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutSide {
    pub cut: usize,
    pub side: Side,
}

/// A piece of bone: on given sides of given cuts, and in one piece with its seeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SegmentRule {
    pub name: String,
    pub sides: Vec<CutSide>,
    /// Points in its bone, in mm. Without any the largest piece on its sides of the cuts is the segment.
    pub seeds: Vec<Vector>,
}

/// Cuts and segments that go together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Osteotomy {
    cuts: Vec<Cut>,
    segments: Vec<SegmentRule>,
    risks: Vec<Risk>,
}

impl Osteotomy {
    pub fn new(cuts: Vec<Cut>, segments: Vec<SegmentRule>) -> Result<Osteotomy, RuleError> {
        if segments.len() > MOST_SEGMENTS {
            return Err(RuleError::TooMany { count: segments.len() });
        }
        if let Some(name) = twice(cuts.iter().map(|cut| &cut.name)) {
            return Err(RuleError::CutTwice { name });
        }
        if let Some(name) = twice(segments.iter().map(|segment| &segment.name)) {
            return Err(RuleError::SegmentTwice { name });
        }
        for segment in &segments {
            segment.check(&cuts)?;
        }
        let named: BTreeSet<usize> =
            segments.iter().flat_map(|segment| &segment.sides).map(|side| side.cut).collect();
        if let Some(unused) = (0..cuts.len()).find(|cut| !named.contains(cut)) {
            return Err(RuleError::Unused { name: cuts[unused].name.clone() });
        }
        Ok(Osteotomy { cuts, segments, risks: Vec::new() })
    }

    /// The same with structures that its cuts have to keep clear of.
    pub fn with_risks(self, risks: Vec<Risk>) -> Osteotomy {
        Osteotomy { risks, ..self }
    }

    pub fn risks(&self) -> &[Risk] {
        &self.risks
    }

    pub fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    pub fn segments(&self) -> &[SegmentRule] {
        &self.segments
    }

    /// Whether a point is on the sides of a segment. A bounded cut has none: bone goes around its extent.
    pub fn admits(&self, segment: usize, point: &Vector) -> bool {
        self.segments[segment].sides.iter().all(|side| {
            let cut = &self.cuts[side.cut];
            match cut.is_bounded() {
                true => !cut.saws(point),
                false => cut.leaves(point, side.side),
            }
        })
    }

    /// Whether a point that a segment admits lies, within the extent of a bounded cut of it, on the other side of that.
    pub fn is_across(&self, segment: usize, point: &Vector) -> bool {
        self.segments[segment].sides.iter().any(|side| {
            let cut = &self.cuts[side.cut];
            cut.is_bounded() && cut.reaches(point) && !cut.leaves(point, side.side)
        })
    }

    /// Whether a bounded cut parts two points of the bone, for every segment.
    pub fn severs(&self, one: &Vector, other: &Vector) -> bool {
        self.cuts.iter().any(|cut| cut.is_bounded() && cut.parts(one, other))
    }
}

impl SegmentRule {
    fn check(&self, cuts: &[Cut]) -> Result<(), RuleError> {
        let segment = || self.name.clone();
        let is_part = ["sliding_", "skin_"].iter().any(|first| self.name.starts_with(first));
        if is_part || RESERVED.contains(&self.name.as_str()) {
            return Err(RuleError::Reserved { name: segment() });
        }
        let mut named = BTreeSet::new();
        for side in &self.sides {
            let Some(cut) = cuts.get(side.cut) else {
                let cuts = cuts.len();
                return Err(RuleError::NoSuchCut { segment: segment(), cut: side.cut, cuts });
            };
            if !named.insert(side.cut) {
                return Err(RuleError::NamedTwice { segment: segment(), cut: cut.name.clone() });
            }
            if cut.is_bounded() && self.seeds.is_empty() {
                let cut = cut.name.clone();
                return Err(RuleError::BoundedWithoutSeed { segment: segment(), cut });
            }
        }
        Ok(())
    }
}

fn twice<'a>(names: impl Iterator<Item = &'a String>) -> Option<String> {
    let mut seen = BTreeSet::new();
    names.into_iter().find(|name| !seen.insert(*name)).cloned()
}

#[cfg(test)]
mod tests {
    use super::super::cut::{Extent, Plane};
    use super::*;

    fn cut(name: &str) -> Cut {
        Cut::unbounded(name, Plane::new(Vector::zeros(), Vector::z()).unwrap())
    }

    fn segment(name: &str, cuts: &[usize]) -> SegmentRule {
        let sides = cuts.iter().map(|&cut| CutSide { cut, side: Side::Below }).collect();
        SegmentRule { name: name.to_owned(), sides, seeds: Vec::new() }
    }

    #[test]
    fn cuts_and_segments_that_do_not_go_together_are_refused_by_name() {
        let refused =
            |cuts: Vec<Cut>, segments| Osteotomy::new(cuts, segments).unwrap_err().to_string();
        let one = || vec![cut("one")];
        assert_eq!(refused(vec![cut("one"), cut("one")], vec![]), "cut `one` stands twice");
        assert_eq!(refused(one(), vec![]), "no segment lies at cut `one`");
        let [a, b] = [segment("a", &[0]), segment("a", &[])];
        assert_eq!(refused(one(), vec![a, b]), "segment `a` stands twice");
        assert_eq!(refused(one(), vec![segment("a", &[1])]), "segment `a` lies at cut 1 of 1");
        assert_eq!(
            refused(one(), vec![segment("a", &[0, 0])]),
            "segment `a` names cut `one` twice"
        );
        for name in ["skin", "sliding_jaw"] {
            let told = refused(one(), vec![segment(name, &[0])]);
            assert_eq!(told, format!("`{name}` is the name of a class of nodes and of no segment"));
        }
        let disc = Some(Extent::Disc { radius: 3.0 });
        let plane = Plane::new(Vector::zeros(), Vector::z()).unwrap();
        let disc = Cut::new("disc", plane, disc, 0.0).unwrap();
        assert_eq!(
            refused(vec![disc], vec![segment("a", &[0])]),
            "segment `a` lies at the bounded cut `disc` and has no seed"
        );
    }
}
