//! Distance of an answer from a scanned surface, which has neither the nodes of the skin nor its triangles.
//!
//! D = (∫_P d(x, S) + ∫_S d(x, P)) / (|P| + |S|) over the parts of the prediction P and the scan S that belong to
//! triangles of the skin which any of the answers moves by more than a stated length, and that have something
//! opposite: a closest point off every open border. By points (`scan_points.rs`) D is the mean over the points of the skin in
//! such triangles, each by its area there. What stays where it is says nothing of the tissue (Zachow et al.
//! 2006, section 3.5, leave out 60 % of the face), and a hole of the scan is no distance.

use std::collections::BTreeMap;

use super::answer::Refusal;
use super::error::{Estimated, Measured, errors as errors_of, moved};
use super::report::{Errors, Outcome, Row};
use super::scan_points::Partners;
use super::variant::Scan;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, Warning};
use crate::prediction::Skin;
use crate::progress::Progress;
use crate::validation::distance::{Direction, Measured as MeasuredPoint};
use crate::validation::{Aligned, Distances, Statistics, StatisticsError, aligned};

/// Samples of both surfaces on each mm².
const SAMPLES_PER_MM2: f64 = 1.0;

/// Answers that have less of their moving skin opposite the scan are told to.
const WHOLE: f64 = 0.95;

/// A skin and the scan of it.
pub(super) struct ScannedSkin<'a> {
    skin: &'a Skin,
    areas: Vec<f64>,
    /// The scan where its alignment puts it.
    surface: TriangleSurface,
    search: SurfaceSearch,
    /// What registration left, in mm.
    pub noise: Option<f64>,
    /// In words.
    pub about: String,
    pub warnings: Vec<Warning>,
    /// For each triangle of the skin, whether it counts.
    moves: Vec<bool>,
    /// Of each point of the skin, what lies in triangles that count, in mm².
    moving_areas: Vec<f64>,
    partners: Partners,
    progress: &'a dyn Progress,
}

impl<'a> ScannedSkin<'a> {
    /// `farthest` is how far any answer moves each point of the skin, in mm.
    pub(super) fn of(
        skin: &'a Result<Skin, Refusal>,
        scan: &'a Scan,
        farthest: &[f64],
        progress: &'a dyn Progress,
    ) -> Result<Self, Refusal> {
        let skin = skin.as_ref().map_err(Refusal::clone)?;
        let failed = |error: String| Refusal::new("truth-failed", error);
        let aligned = aligned(&skin.surface, &scan.surface, &scan.alignment, progress);
        let Aligned { surface, report, warnings } =
            aligned.map_err(|error| failed(error.to_string()))?;
        let search = SurfaceSearch::new(&surface).map_err(|error| failed(error.to_string()))?;
        let mean = |corners: &[u32; 3]| {
            corners.iter().map(|&point| farthest.get(point as usize).unwrap_or(&0.0)).sum::<f64>()
                / 3.0
        };
        let moves: Vec<bool> = skin
            .surface
            .triangles
            .iter()
            .map(|corners| mean(corners) > scan.moved_by_more_than)
            .collect();
        if !moves.contains(&true) {
            let detail =
                format!("no answer moves the skin by more than {} mm", scan.moved_by_more_than);
            return Err(failed(detail));
        }
        let areas = skin.surface.point_areas();
        let mut moving = skin.surface.clone();
        let kept = moving.triangles.iter().zip(&moves).filter(|(_, moves)| **moves);
        moving.triangles = kept.map(|(corners, _)| *corners).collect();
        let moving_areas = moving.point_areas();
        let partners = Partners::of(&scan.metric, &skin.surface, &surface, &report)?;
        let noise = scan.noise.or(report.rms);
        let triangles = surface.triangles.len();
        let about = format!("a scan of {triangles} triangles, aligned by {}", report.method);
        Ok(ScannedSkin {
            skin,
            areas,
            surface,
            search,
            noise,
            about,
            warnings,
            moves,
            moving_areas,
            partners,
            progress,
        })
    }

    /// Of a displacement of the points of the skin.
    pub(super) fn measure(&self, found: &[Vector]) -> Result<Measured, Refusal> {
        let refused = |error: String| Refusal::new("not-measured", error);
        let predicted = moved(&self.skin.surface, found);
        let [to_scan, to_prediction] = self.distances(&predicted)?;
        let counts = |at: &MeasuredPoint| self.moves[at.triangle as usize];
        let moving = to_scan.part(counts);
        let covered_share = if moving.has_area() { moving.covered_share() } else { 0.0 };
        let covered = |at: &MeasuredPoint| counts(at) && !at.is_beyond_border;
        let (there, back) = (to_scan.part(covered), to_prediction.part(covered));
        if !there.has_area() || !back.has_area() {
            let words = "the scan has nothing opposite where the skin moves";
            return Err(refused(words.to_owned()));
        }
        let failed = |error: StatisticsError| refused(error.to_string());
        let length: Vec<f64> = found.iter().map(|u| u.norm()).collect();
        let by_points = self.partners.distances(&predicted, &self.surface, &self.search)?;
        let (error, regions) = match by_points {
            None => {
                let regions = self.regions([&to_scan, &to_prediction]);
                (errors(&there.pooled(&back)).map_err(failed)?, regions.map_err(failed)?)
            }
            Some(distances) => {
                let of = |areas: &[f64], counts: &dyn Fn(u32) -> bool| {
                    let known = (0_u32..).zip(&distances).zip(areas);
                    let known = known.filter(|((point, _), _)| counts(*point));
                    let known = known.filter_map(|((_, own), area)| Some(((*own)?, *area)));
                    let (values, areas): (Vec<f64>, Vec<f64>) = known.unzip();
                    errors_of(&values, &areas)
                };
                let named = self.skin.regions.iter();
                let regions = named.filter_map(|(name, points)| {
                    let constraints = |point: u32| points.binary_search(&point).is_ok();
                    Some((name.clone(), of(&self.areas, &constraints).ok()?))
                });
                (of(&self.moving_areas, &|_| true).map_err(failed)?, regions.collect())
            }
        };
        Ok(Measured {
            error,
            estimated: Estimated::default(),
            closest_point: errors(&there).map_err(failed)?,
            regions,
            skin_mean_mm: Statistics::weighted(&length, &self.areas).map_err(failed)?.mean,
            covered_share: Some(covered_share),
        })
    }

    /// Of the skin as it is before anything moves; none where it cannot be measured.
    pub(super) fn unmoved(&self) -> Option<Measured> {
        let rest = vec![Vector::zeros(); self.skin.surface.points.len()];
        self.measure(&rest).ok()
    }

    /// A warning where no answer is nearer to the scan than the skin at rest: by the distance that is asked for, and by closest points
    /// too, since partners of points may be those of another scan.
    pub(super) fn before_operation(&self, unmoved: &Measured, rows: &[Row]) -> Option<Warning> {
        let by = |of: fn(&Errors, &Errors) -> f64| {
            let mean = |row: &Row| match &row.outcome {
                Outcome::Solved(solved) => Some(of(&solved.error, &solved.closest_point)),
                Outcome::Failed { .. } => None,
            };
            let rest = of(&unmoved.error, &unmoved.closest_point);
            before_operation(rest, rows.iter().filter_map(mean))
        };
        by(|error, _| error.mean).or_else(|| match self.partners {
            Partners::None => None,
            Partners::Points(_) | Partners::Landmarks(_) => by(|_, closest| closest.mean),
        })
    }

    fn distances(&self, predicted: &TriangleSurface) -> Result<[Distances; 2], Refusal> {
        let refused = |error: String| Refusal::new("not-measured", error);
        let search = SurfaceSearch::new(predicted).map_err(|error| refused(error.to_string()))?;
        let there = Direction::ToActual(&self.search);
        let back = Direction::ToPrediction(&search);
        let measured = |from: &TriangleSurface, to: Direction| {
            Distances::measure(from, to, SAMPLES_PER_MM2, self.progress)
                .map_err(|error| refused(error.to_string()))
        };
        Ok([measured(predicted, there)?, measured(&self.surface, back)?])
    }

    /// The same over each named part of the skin, whatever moves; parts with nothing opposite are left out.
    fn regions(
        &self,
        distances: [&Distances; 2],
    ) -> Result<BTreeMap<String, Errors>, StatisticsError> {
        let mut regions = BTreeMap::new();
        for (name, points) in &self.skin.regions {
            let constraints = |at: &MeasuredPoint| {
                let corners = self.skin.surface.triangles[at.triangle as usize];
                !at.is_beyond_border && corners.iter().all(|c| points.binary_search(c).is_ok())
            };
            let [there, back] = distances.map(|own| own.part(constraints));
            if there.has_area() && back.has_area() {
                regions.insert(name.clone(), errors(&there.pooled(&back))?);
            }
        }
        Ok(regions)
    }
}

fn before_operation(unmoved: f64, answers: impl Iterator<Item = f64>) -> Option<Warning> {
    let least = answers.min_by(f64::total_cmp)?;
    let detail = format!(
        "the scan is {unmoved:.3} mm from the skin at rest and {least:.3} mm or more from every answer: is it the scan before the operation?"
    );
    let warning = Warning::new("before-operation-suspect", detail);
    let warning = warning.with("at_rest_mm", unmoved).with("least_mm", least);
    (unmoved <= least).then_some(warning)
}

/// Whether so little of what moves has the scan opposite that the reader has to know.
pub(super) fn is_partial(covered_share: Option<f64>) -> bool {
    covered_share.is_some_and(|share| share < WHOLE)
}

fn errors(distances: &Distances) -> Result<Errors, StatisticsError> {
    let found = distances.statistics()?;
    Ok(Errors { mean: found.unsigned.mean, p95: found.unsigned.p95, max: found.hausdorff })
}
