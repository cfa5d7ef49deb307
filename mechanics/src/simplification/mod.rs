//! Simplification of surfaces: edges collapse, the cheapest by its error quadric first, as long as what is left stays near.
//!
//! Three bounds hold at every step, beside the quadric that only orders the steps. Deviation: points over each new triangle lie no
//! farther from the given surface than a bound, and the points of the given surface that the removed triangles stood for no
//! farther from the new ones. Length: no new edge is longer than is allowed where it lies, by the thickness of the tissue there for
//! one. Shape: no triangle turns by more than 60 degrees or becomes a sliver, closed surfaces stay closed, borders stay where they were.
//! Source: Garland and Heckbert (1997), `quadric`; edge lengths from tissue thickness and a bound on the deviation: Zachow,
//! Hierold, Gladilin, Hege, Erdmann, planning models of 75 000 to 150 000 triangles within 0.1 to 0.5 mm, section 2.1 (2006).

mod bound;
mod draft;
mod quadric;

use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;

use self::bound::{BETWEEN, beyond};
use self::draft::Draft;
use self::quadric::Quadric;
use crate::mesh::area_sampling::spread_over;
use crate::mesh::{SearchError, SurfaceSearch, TriangleSurface, Vector};
use crate::progress::Progress;

/// Of planes across open borders, which keep them where they are, against those of triangles.
const BORDER_WEIGHT: f64 = 100.0;
/// The least cosine of the angle that a triangle may turn by.
const LEAST_COSINE: f64 = 0.5;
/// Triangles whose height is less than this share of their longest edge are slivers.
const LEAST_HEIGHT: f64 = 0.1;
/// Points on a triangle are no farther apart than this many deviations, within `ROWS`.
const APART: f64 = 4.0;
const ROWS: std::ops::RangeInclusive<usize> = 2..=6;
/// Simplifications until nothing lies beyond the bound, each with the points that the ones before it found beyond it.
const MOST_ROUNDS: usize = 16;
/// From one to the next the bound of what is looked at shrinks by this around what was beyond it, in the end everywhere.
const TIGHTER: f64 = 0.8;
const LOCAL_ROUNDS: usize = 10;
/// Collapses between two looks at whether to stop.
const AT_A_TIME: usize = 1 << 10;

/// Limits of a simplification. Lengths in mm.
pub struct SimplificationSettings<'a> {
    /// Neither surface is farther from the other than this, anywhere.
    pub deviation: f64,
    /// It ends when no more triangles are left; absent: when no edge can go.
    pub triangles: Option<usize>,
    /// The longest edge allowed at a place.
    pub longest: &'a (dyn Fn(&Vector) -> f64 + Sync),
}

/// Why a surface is not simplified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimplificationError {
    #[error("the deviation is {deviation} mm; more than 0 and at most 100 mm are possible")]
    Deviation { deviation: f64 },
    #[error("the surface cannot be searched: {0}")]
    Surface(#[from] SearchError),
    #[error(
        "the surface is {reached:.4} mm from its simplification, and at most {deviation} mm are allowed: it is too damaged to be simplified within that"
    )]
    Bound { deviation: f64, reached: f64 },
    #[error("cancelled with {left} triangles left")]
    Cancelled { left: usize },
}

/// An edge by what its collapse costs; of stale ones an end has changed since.
struct Candidate {
    cost: f64,
    ends: [u32; 2],
    versions: [u32; 2],
    place: Vector,
}

impl Candidate {
    fn order(&self) -> (f64, [u32; 2], [u32; 2]) {
        (self.cost, self.ends, self.versions)
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    /// The cheapest is the greatest, as a heap wants it.
    fn cmp(&self, other: &Self) -> Ordering {
        let ((cost, ends, versions), (other_cost, other_ends, other_versions)) =
            (self.order(), other.order());
        other_cost.total_cmp(&cost).then(other_ends.cmp(&ends)).then(other_versions.cmp(&versions))
    }
}

struct Work<'a> {
    settings: &'a SimplificationSettings<'a>,
    given: &'a GivenSurface<'a>,
    draft: Draft,
    quadrics: Vec<Quadric>,
    /// The longest edge allowed at each point.
    longest: Vec<f64>,
    versions: Vec<u32>,
    /// The points looked at of the given surface that each triangle stands for.
    held: Vec<Vec<u32>>,
    heap: BinaryHeap<Candidate>,
}

/// A surface with fewer triangles. The same surface and settings give the same one.
///
/// Steps look at points. What lies beyond the bound between them is found when no edge can go, and looked at from then on, until
/// nothing does.
pub fn simplify(
    surface: &TriangleSurface,
    settings: &SimplificationSettings,
    progress: &dyn Progress,
) -> Result<TriangleSurface, SimplificationError> {
    let deviation = settings.deviation;
    if !(deviation > 0.0 && deviation <= 100.0) {
        return Err(SimplificationError::Deviation { deviation });
    }
    let search = SurfaceSearch::new(surface)?;
    let within = deviation * (1.0 - BETWEEN);
    let mut points = given_points(surface);
    let mut bounds = vec![within; surface.triangles.len()];
    let mut reached = 0.0;
    for round in 0..MOST_ROUNDS {
        let given = GivenSurface { surface, search: &search, points: &points, bounds: &bounds };
        let simple = collapsed(&given, settings, progress)?;
        let simple_search = SurfaceSearch::new(&simple)?;
        let there = beyond(&simple, surface, &search, within);
        let back = beyond(surface, &simple, &simple_search, within);
        if there.is_empty() && back.is_empty() {
            return Ok(simple);
        }
        let both = there.iter().chain(&back);
        reached = both.map(|apart| apart.distance).fold(0.0, f64::max);
        points.extend(there.iter().map(|apart| GivenPoint { on: apart.to, at: apart.nearest }));
        points.extend(back.iter().map(|apart| GivenPoint { on: apart.from, at: apart.place }));
        let own = there.iter().map(|apart| apart.from).chain(back.iter().map(|apart| apart.to));
        let wrong: BTreeSet<u32> = own.collect();
        let mut tighter = vec![round >= LOCAL_ROUNDS; bounds.len()];
        for corners in wrong.into_iter().map(|triangle| simple.corners(triangle as usize)) {
            let under = spread_over(&corners, *ROWS.end());
            under.for_each(|point| tighter[search.closest(&point).triangle] = true);
        }
        let pairs = bounds.iter_mut().zip(tighter);
        pairs.filter(|(_, tighter)| *tighter).for_each(|(bound, _)| *bound *= TIGHTER);
    }
    Err(SimplificationError::Bound { deviation, reached })
}

/// A point of the given surface that has to stay near, and a triangle that it is on.
struct GivenPoint {
    on: u32,
    at: Vector,
}

/// The surface as given, and what is looked at of it.
struct GivenSurface<'a> {
    surface: &'a TriangleSurface,
    search: &'a SurfaceSearch,
    points: &'a [GivenPoint],
    /// How far what is looked at may be from each triangle.
    bounds: &'a [f64],
}

/// Each corner, on one of its triangles.
fn given_points(surface: &TriangleSurface) -> Vec<GivenPoint> {
    let mut is_known = vec![false; surface.points.len()];
    let mut points = Vec::with_capacity(surface.points.len());
    for (on, corners) in (0..).zip(&surface.triangles) {
        for &corner in corners {
            if !std::mem::replace(&mut is_known[corner as usize], true) {
                points.push(GivenPoint { on, at: surface.points[corner as usize] });
            }
        }
    }
    points
}

fn collapsed(
    given: &GivenSurface,
    settings: &SimplificationSettings,
    progress: &dyn Progress,
) -> Result<TriangleSurface, SimplificationError> {
    let mut work = Work::new(given, settings);
    let enough = settings.triangles.unwrap_or(0);
    let mut steps = 0;
    while work.draft.left > enough {
        let Some(candidate) = work.heap.pop() else { break };
        steps += 1;
        if steps % AT_A_TIME == 0 && progress.is_cancelled() {
            return Err(SimplificationError::Cancelled { left: work.draft.left });
        }
        work.try_collapse(&candidate);
    }
    Ok(work.draft.into_surface())
}

impl<'a> Work<'a> {
    fn new(given: &'a GivenSurface<'a>, settings: &'a SimplificationSettings<'a>) -> Self {
        let draft = Draft::new(given.surface);
        let count = draft.points.len();
        let mut held = vec![Vec::new(); draft.triangles.len()];
        for (number, point) in (0..).zip(given.points) {
            if let Some(own) = draft.number_of_given[point.on as usize] {
                held[own as usize].push(number);
            }
        }
        let longest = draft.points.iter().map(settings.longest).collect();
        let quadrics = quadrics(&draft);
        let (versions, heap) = (vec![0; count], BinaryHeap::new());
        let mut work = Work { settings, given, draft, quadrics, longest, versions, held, heap };
        for point in 0..count as u32 {
            let later = work.draft.neighbours(point).into_iter().filter(|&other| other > point);
            later.for_each(|other| work.offer([point, other]));
        }
        work
    }

    /// Puts an edge among those that may collapse.
    fn offer(&mut self, ends: [u32; 2]) {
        let [a, b] = ends.map(|end| end as usize);
        if self.draft.is_fixed[a] || self.draft.is_fixed[b] {
            return;
        }
        let quadric = self.quadrics[a].plus(&self.quadrics[b]);
        let [one, other] = [self.draft.points[a], self.draft.points[b]];
        let place = match (self.draft.on_border[a], self.draft.on_border[b]) {
            (true, false) => one,
            (false, true) => other,
            (true, true) | (false, false) => quadric.least(&((one + other) * 0.5)),
        };
        let versions = [self.versions[a], self.versions[b]];
        let candidate = Candidate { cost: quadric.at(&place), ends, versions, place };
        if candidate.cost.is_finite() {
            self.heap.push(candidate);
        }
    }

    fn try_collapse(&mut self, candidate: &Candidate) {
        let Candidate { ends, versions, place, .. } = *candidate;
        let [a, b] = ends.map(|end| end as usize);
        if [self.versions[a], self.versions[b]] != versions || !self.draft.may_collapse(ends) {
            return;
        }
        let moved = self.draft.moved(ends, &place);
        if !self.keeps_shape(ends, &moved, &place) || !self.is_near(&moved) {
            return;
        }
        let fallen = self.draft.shared(ends);
        let standing = moved.iter().map(|(triangle, _)| *triangle);
        let all = standing.chain(fallen.iter().copied());
        let points: Vec<u32> =
            all.flat_map(|triangle| self.held[triangle as usize].clone()).collect();
        let Some(homes) = self.homes(&points, &moved) else { return };
        self.draft.collapse(ends, place);
        fallen.iter().for_each(|&triangle| self.held[triangle as usize].clear());
        moved.iter().for_each(|(triangle, _)| self.held[*triangle as usize].clear());
        for (point, home) in points.into_iter().zip(homes) {
            self.held[home as usize].push(point);
        }
        self.quadrics[a] = self.quadrics[a].plus(&self.quadrics[b]);
        self.longest[a] = (self.settings.longest)(&place);
        self.versions[a] += 1;
        self.versions[b] = u32::MAX;
        for other in self.draft.neighbours(ends[0]) {
            self.offer([ends[0].min(other), ends[0].max(other)]);
        }
    }

    /// No triangle turns over or becomes a sliver, and no new edge is too long.
    fn keeps_shape(&self, ends: [u32; 2], moved: &[(u32, [Vector; 3])], place: &Vector) -> bool {
        let longest = (self.settings.longest)(place);
        let neighbours = ends.iter().flat_map(|&end| self.draft.neighbours(end));
        let is_long = |point: u32| {
            let length = (self.draft.points[point as usize] - place).norm();
            !ends.contains(&point) && length > longest.min(self.longest[point as usize])
        };
        if neighbours.into_iter().any(is_long) {
            return false;
        }
        moved.iter().all(|(triangle, corners)| {
            let before = area_vector(&self.draft.corners(*triangle));
            let after = area_vector(corners);
            let turns = before.dot(&after) < LEAST_COSINE * before.norm() * after.norm();
            let height = 2.0 * after.norm() / longest_edge(corners).powi(2);
            let was = 2.0 * before.norm() / longest_edge(&self.draft.corners(*triangle)).powi(2);
            !turns && height > LEAST_HEIGHT.min(was)
        })
    }

    /// Points all over the new triangles lie near the given surface.
    fn is_near(&self, moved: &[(u32, [Vector; 3])]) -> bool {
        let GivenSurface { search, bounds, .. } = self.given;
        let deviation = self.settings.deviation;
        moved.iter().all(|(_, corners)| {
            let wanted = longest_edge(corners) / (APART * deviation);
            let rows = (wanted.ceil() as usize).clamp(*ROWS.start(), *ROWS.end());
            spread_over(corners, rows).all(|point| {
                let closest = search.closest_within(&point, deviation);
                closest.is_some_and(|closest| closest.distance <= bounds[closest.triangle])
            })
        })
    }

    /// The nearest of the new triangles to each point of the given surface; `None` where one is too far.
    fn homes(&self, points: &[u32], moved: &[(u32, [Vector; 3])]) -> Option<Vec<u32>> {
        let origin = moved.first()?.1[0];
        let local = |point: &Vector| {
            let way = point - origin;
            ParryVector::new(way.x, way.y, way.z)
        };
        let triangles: Vec<(u32, Triangle)> = moved
            .iter()
            .map(|(number, [a, b, c])| (*number, Triangle::new(local(a), local(b), local(c))))
            .collect();
        let home = |&point: &u32| {
            let own = &self.given.points[point as usize];
            let place = local(&own.at);
            let far = |triangle: &Triangle| triangle.distance_to_local_point(place, true);
            let each = triangles.iter().map(|(number, triangle)| (far(triangle), *number));
            let (distance, number) =
                each.min_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)))?;
            (distance <= self.given.bounds[own.on as usize]).then_some(number)
        };
        points.iter().map(home).collect()
    }
}

/// Of each point: the planes of its triangles, and planes across open borders.
fn quadrics(draft: &Draft) -> Vec<Quadric> {
    let mut quadrics = vec![Quadric::default(); draft.points.len()];
    for (triangle, corners) in (0..).zip(&draft.triangles) {
        let places = draft.corners(triangle);
        let area = area_vector(&places);
        let Some(normal) = area.try_normalize(f64::MIN_POSITIVE) else { continue };
        let plane = Quadric::of_plane(&places[0], &normal, area.norm());
        for (number, &corner) in corners.iter().enumerate() {
            quadrics[corner as usize] = quadrics[corner as usize].plus(&plane);
            let next = corners[(number + 1) % 3];
            if draft.on_border[corner as usize]
                && draft.on_border[next as usize]
                && draft.shared([corner, next]).len() == 1
            {
                let along = draft.points[next as usize] - draft.points[corner as usize];
                let across = along.cross(&normal);
                let Some(across) = across.try_normalize(f64::MIN_POSITIVE) else { continue };
                let weight = BORDER_WEIGHT * along.norm_squared();
                let wall = Quadric::of_plane(&places[number], &across, weight);
                for end in [corner, next] {
                    quadrics[end as usize] = quadrics[end as usize].plus(&wall);
                }
            }
        }
    }
    quadrics
}

fn area_vector([a, b, c]: &[Vector; 3]) -> Vector {
    (b - a).cross(&(c - a)) * 0.5
}

fn longest_edge([a, b, c]: &[Vector; 3]) -> f64 {
    (b - a).norm().max((c - b).norm()).max((a - c).norm())
}
