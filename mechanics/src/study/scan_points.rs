//! Distance of an answer from a scan by the points of the skin: node by node, or by thin-plate spline and closest point
//! ([`warped_distances`]), whose spline goes from where an answer takes the landmarks to where the scan has them.

use super::answer::Refusal;
use super::variant::ScanMetric;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use crate::validation::{AlignmentReport, LandmarkPair, corresponding_points, warped_distances};

/// What the points of a skin are measured to.
pub(super) enum Partners {
    /// Closest points, which are no partners of points.
    None,
    /// For each point of the skin the number of that of the scan.
    Points(Vec<usize>),
    Landmarks(Vec<Landmark>),
}

/// A landmark on the skin at rest.
pub(super) struct Landmark {
    corners: [u32; 3],
    barycentric: [f64; 3],
    /// From its place on the skin to where the case has it.
    off: Vector,
    /// On the scan, where its alignment puts it.
    actual: Vector,
}

impl Partners {
    /// `scan` lies where its alignment puts it, as that reports.
    pub(super) fn of(
        metric: &ScanMetric,
        skin: &TriangleSurface,
        scan: &TriangleSurface,
        alignment: &AlignmentReport,
    ) -> Result<Self, Refusal> {
        match metric {
            ScanMetric::BothWays => Ok(Partners::None),
            ScanMetric::NodeWise => match corresponding_points(skin, scan) {
                Some(pairs) => Ok(Partners::Points(pairs)),
                None => {
                    let (own, other) = (skin.points.len(), scan.points.len());
                    let detail = format!(
                        "the skin has {own} points and the scan {other}, and neither their node ids nor their triangles tell which \
                         correspond"
                    );
                    Err(Refusal::new("truth-failed", detail))
                }
            },
            ScanMetric::Landmarks(pairs) => {
                let search = SurfaceSearch::new(skin)
                    .map_err(|error| Refusal::new("truth-failed", error.to_string()))?;
                let landmark = |pair: &LandmarkPair| {
                    let closest = search.closest(&pair.prediction);
                    Landmark {
                        corners: skin.triangles[closest.triangle],
                        barycentric: closest.barycentric,
                        off: pair.prediction - closest.point,
                        actual: alignment.transform.apply(&pair.actual),
                    }
                };
                Ok(Partners::Landmarks(pairs.iter().map(landmark).collect()))
            }
        }
    }

    /// For each point of a predicted skin how far it is from its partner, in mm; `None` where that lies on the border of the scan.
    pub(super) fn distances(
        &self,
        predicted: &TriangleSurface,
        scan: &TriangleSurface,
        search: &SurfaceSearch,
    ) -> Result<Option<Vec<Option<f64>>>, Refusal> {
        match self {
            Partners::None => Ok(None),
            Partners::Points(pairs) => {
                let pairs = predicted.points.iter().zip(pairs);
                Ok(Some(pairs.map(|(own, &at)| Some((own - scan.points[at]).norm())).collect()))
            }
            Partners::Landmarks(landmarks) => {
                let pair = |own: &Landmark| {
                    let corners = own.corners.map(|corner| predicted.points[corner as usize]);
                    let shares = corners.iter().zip(own.barycentric);
                    let on_skin: Vector = shares.map(|(corner, share)| corner * share).sum();
                    LandmarkPair { prediction: on_skin + own.off, actual: own.actual }
                };
                let pairs: Vec<LandmarkPair> = landmarks.iter().map(pair).collect();
                let found = warped_distances(&predicted.points, &pairs, search);
                found.map(Some).map_err(|error| Refusal::new("not-measured", error.to_string()))
            }
        }
    }
}
