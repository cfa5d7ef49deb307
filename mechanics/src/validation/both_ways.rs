//! Distances between two surfaces in both directions, and how much of each has the other opposite.

use super::distance::{Direction, DistanceError, DistanceStatistics, Distances, Measured};
use super::error::ComparisonError;
use super::statistics::StatisticsError;
use crate::mesh::{SurfaceSearch, TriangleSurface, Warning};
use crate::progress::Progress;

/// Below this share a scan covers only a part of the prediction, which gives a warning.
const WHOLE: f64 = 0.95;

/// Distances from the prediction, from the actual surface, and of both pooled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BothDirections {
    pub to_actual: DistanceStatistics,
    pub to_prediction: DistanceStatistics,
    pub both: DistanceStatistics,
}

/// How much of each surface has the other opposite, and distances of that part alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Share of the prediction's area whose closest point is not on an open border of the actual surface.
    pub of_prediction: f64,
    /// Share of the actual surface's area, the other way round.
    pub of_actual: f64,
    /// From the covered part of the prediction; absent where all or nothing is covered.
    pub to_actual: Option<DistanceStatistics>,
    /// From the covered part of the actual surface; absent where all or nothing is covered.
    pub to_prediction: Option<DistanceStatistics>,
}

/// Two surfaces ready to be measured from each other.
pub(super) struct Pair<'a> {
    pub prediction: &'a TriangleSurface,
    pub actual: &'a TriangleSurface,
    pub prediction_search: SurfaceSearch,
    pub actual_search: SurfaceSearch,
}

impl<'a> Pair<'a> {
    pub fn new(
        prediction: &'a TriangleSurface,
        actual: &'a TriangleSurface,
    ) -> Result<Self, ComparisonError> {
        let search = |which: &'static str, surface: &TriangleSurface| {
            SurfaceSearch::new(surface).map_err(|source| ComparisonError::Surface { which, source })
        };
        Ok(Pair {
            prediction,
            actual,
            prediction_search: search("predicted", prediction)?,
            actual_search: search("actual", actual)?,
        })
    }

    pub fn measure(
        &self,
        density: f64,
        progress: &dyn Progress,
    ) -> Result<MeasuredPair, DistanceError> {
        let to_actual = Direction::ToActual(&self.actual_search);
        let to_prediction = Direction::ToPrediction(&self.prediction_search);
        Ok(MeasuredPair {
            to_actual: Distances::measure(self.prediction, to_actual, density, progress)?,
            to_prediction: Distances::measure(self.actual, to_prediction, density, progress)?,
        })
    }
}

pub(super) struct MeasuredPair {
    pub to_actual: Distances,
    pub to_prediction: Distances,
}

impl MeasuredPair {
    pub fn statistics(&self) -> Result<BothDirections, StatisticsError> {
        Ok(BothDirections {
            to_actual: self.to_actual.statistics()?,
            to_prediction: self.to_prediction.statistics()?,
            both: self.to_actual.pooled(&self.to_prediction).statistics()?,
        })
    }

    pub fn part(&self, belongs: impl Fn(&Measured) -> bool) -> MeasuredPair {
        MeasuredPair {
            to_actual: self.to_actual.part(&belongs),
            to_prediction: self.to_prediction.part(&belongs),
        }
    }

    pub fn coverage(&self, warnings: &mut Vec<Warning>) -> Result<Coverage, StatisticsError> {
        let covered = self.part(|measured| !measured.is_beyond_border);
        let of_part = |share: f64, part: &Distances| match share {
            share if share > 0.0 && share < 1.0 => part.statistics().map(Some),
            _ => Ok(None),
        };
        let of_prediction = self.to_actual.covered_share();
        let of_actual = self.to_prediction.covered_share();
        if of_prediction < WHOLE {
            let percent = of_prediction * 100.0;
            let detail = format!(
                "the actual surface covers {percent:.1} % of the prediction: the rest is measured to its border"
            );
            warnings.push(Warning::new("partial-coverage", detail).with("share", of_prediction));
        }
        Ok(Coverage {
            of_prediction,
            of_actual,
            to_actual: of_part(of_prediction, &covered.to_actual)?,
            to_prediction: of_part(of_actual, &covered.to_prediction)?,
        })
    }
}
