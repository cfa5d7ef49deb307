//! The size field: how large a lattice cell may be at a place.

use super::error::MeshingError;
use crate::mesh::Vector;

/// Cells along the longest side of a body, at least.
const FEWEST: f64 = 4.0;

/// How large cells may be: the edge of the cubes of the lattice in mm, the smallest of all rules, and never less than
/// `finest`. Cubes have edges of `finest` times a power of two; a cube inside tissue is worth twelve tetrahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeField {
    pub finest: f64,
    pub coarsest: f64,
    /// How much larger cells may be for each mm of distance from where a region asks for a size.
    pub grading: f64,
    /// At the boundary of the tissue.
    pub at_boundary: Option<f64>,
    pub regions: Vec<SizeRegion>,
    pub thickness: Option<ThicknessRule>,
}

/// A size asked for in a part of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeRegion {
    pub shape: RegionShape,
    pub size: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RegionShape {
    /// From its lowest to its highest corner.
    Box {
        low: Vector,
        high: Vector,
    },
    Ball {
        centre: Vector,
        radius: f64,
    },
}

impl RegionShape {
    pub fn middle(&self) -> Vector {
        match self {
            RegionShape::Box { low, high } => (low + high) / 2.0,
            RegionShape::Ball { centre, .. } => *centre,
        }
    }
}

/// Cells are at most `factor` times as large as the tissue is thick, but need not be smaller than `floor`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThicknessRule {
    pub factor: f64,
    pub floor: f64,
}

impl ThicknessRule {
    /// The size at tissue of that thickness.
    pub fn size(&self, thickness: f64) -> f64 {
        (self.factor * thickness).max(self.floor)
    }
}

impl SizeField {
    /// The same size everywhere.
    pub fn uniform(size: f64) -> SizeField {
        SizeField {
            finest: size,
            coarsest: size,
            grading: 0.5,
            at_boundary: None,
            regions: Vec::new(),
            thickness: None,
        }
    }

    /// From fine to coarse, bound to the thickness of the tissue, as it is used for heads.
    pub fn graded(finest: f64, coarsest: f64) -> SizeField {
        let thickness = Some(ThicknessRule { factor: 0.8, floor: finest });
        SizeField { finest, coarsest, thickness, ..SizeField::uniform(finest) }
    }

    /// The size that regions leave to a cell about a place, without thickness and boundary.
    pub fn at(&self, centre: &Vector, radius: f64) -> f64 {
        let asked = self.regions.iter().map(|region| {
            let distance = (region.shape.distance(centre) - radius).max(0.0);
            region.size + self.grading * distance
        });
        asked.fold(self.coarsest, f64::min).max(self.finest)
    }

    /// With a few cells at least along the longest side of a body.
    #[must_use]
    pub(super) fn bounded(&self, longest_side: f64) -> SizeField {
        let coarsest = self.coarsest.min((longest_side / FEWEST).max(self.finest));
        SizeField { coarsest, ..self.clone() }
    }

    /// All lengths times a number.
    #[must_use]
    pub fn scaled(&self, by: f64) -> SizeField {
        let region = |region: &SizeRegion| SizeRegion { size: region.size * by, ..*region };
        let rule = |rule: ThicknessRule| ThicknessRule { floor: rule.floor * by, ..rule };
        SizeField {
            finest: self.finest * by,
            coarsest: self.coarsest * by,
            grading: self.grading,
            at_boundary: self.at_boundary.map(|size| size * by),
            regions: self.regions.iter().map(region).collect(),
            thickness: self.thickness.map(rule),
        }
    }

    pub(super) fn check(&self) -> Result<(), MeshingError> {
        let sizes = self.regions.iter().map(|region| ("size of a region", region.size));
        let at_boundary = self.at_boundary.map(|size| ("at_boundary", size));
        let rule = self.thickness.iter();
        let rules = rule.flat_map(|rule| [("factor", rule.factor), ("floor", rule.floor)]);
        let lengths = [("finest", self.finest), ("coarsest", self.coarsest)].into_iter();
        let bad = |&(_, value): &(&str, f64)| !(value.is_finite() && value > 0.0);
        if let Some((setting, value)) =
            lengths.chain(at_boundary).chain(rules).chain(sizes).find(bad)
        {
            return Err(MeshingError::Setting { setting, value, wanted: "finite and above 0" });
        }
        let (setting, value) = ("coarsest", self.coarsest);
        if self.coarsest < self.finest {
            return Err(MeshingError::Setting { setting, value, wanted: "at least `finest`" });
        }
        let (setting, value) = ("grading", self.grading);
        if !(value.is_finite() && value >= 0.0) {
            return Err(MeshingError::Setting {
                setting,
                value,
                wanted: "finite and not negative",
            });
        }
        Ok(())
    }
}

impl RegionShape {
    /// 0 inside.
    pub(crate) fn distance(&self, point: &Vector) -> f64 {
        match self {
            RegionShape::Box { low, high } => (point - point.sup(low).inf(high)).norm(),
            RegionShape::Ball { centre, radius } => ((point - centre).norm() - radius).max(0.0),
        }
    }
}
