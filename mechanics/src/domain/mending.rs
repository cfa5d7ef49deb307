//! Repair of a damaged surface before it bounds a body: triangles welded, removed and flipped, each counted.
//!
//! Turning has three steps. Triangles that share an edge with one other each are made to agree; a patch that so hangs
//! together then goes by the larger part of its area. A patch that the rest of the surface sees from
//! the other side (by winding numbers in front of it and behind it) is turned. Closed pieces that are inside out and lie in
//! no other are turned, and so is everything where the whole volume is negative.

use std::collections::HashSet;

use super::facets::{Edges, Patches, Pieces};
use super::hollows::{Hollows, hollows};
use super::lids::{Open, lids};
use super::second_sheets::{SecondSheets, second_sheets};
use super::triangle::{Corners, SolidAngles};
use super::triangle_tree::{Facet, TriangleTree};
use crate::mesh::{TriangleSurface, Vector};

/// How often patches are looked at, each time beside the turned ones of the time before.
const MOST_ROUNDS: usize = 5;
/// A patch with more of the area than this is turned by its own triangles alone.
const LARGE_PATCH: f64 = 0.1;
/// Winding numbers in front of and behind a patch that differ by more tell its side.
const DECISIVE: f64 = 0.15;

/// A patch whose area as seen along its normal is less than this part of it is nearly closed: it has an inside of its own.
const LEAST_FLATNESS: f64 = 0.3;

/// A surface with a larger opening, in parts of its area, was cut off: a hole of a damaged one is a hundredth or two.
pub(super) const MOST_OPEN: f64 = 0.03;

/// Repairs of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mending {
    /// Points at exactly the place of an earlier one.
    pub welded_points: usize,
    /// Triangles without an area.
    pub degenerate: usize,
    /// Triangles with the corners of an earlier one.
    pub duplicates: usize,
    /// Triangles turned to agree with those around them.
    pub turned: usize,
    /// The whole surface was inside out.
    pub was_inverted: bool,
    /// Triangles of pieces that stood there twice, one close beside the other.
    pub second_sheets: usize,
    /// Holes closed by a lid as curved as what is around them.
    pub lids: usize,
}

/// A surface ready to be searched.
#[derive(Clone, Debug)]
pub(super) struct RepairedSurface {
    pub facets: Vec<Facet>,
    pub mending: Mending,
    /// Edges at which the surface does not go on with one triangle of the same side.
    pub open_edges: usize,
    /// Parts that hang together over edges.
    pub pieces: usize,
    /// The sum of all area vectors in parts of the area, without lids: 0 for a whole surface.
    pub opening: f64,
    /// Wide holes that have no lid.
    pub wide_holes: usize,
    /// By how much the volumes of pieces that stood there twice differ, in mm³.
    pub second_sheets_differ: f64,
    /// What it encloses without being its inside; walls by their place among the facets.
    pub hollows: Hollows,
}

/// Mends a surface whose corners are finite points of it.
pub(super) fn mend(surface: &TriangleSurface) -> RepairedSurface {
    let mut mending = Mending::default();
    let (triangles, numbers) = sound_triangles(surface, &mut mending);
    let corners: Vec<Corners> =
        numbers.iter().map(|&number| Corners(surface.corners(number as usize))).collect();
    let edges = Edges::new(&triangles);
    let patches = edges.patches(&corners);
    let mut turned = patches.turned.clone();
    flip_patches(&corners, &patches, &mut turned);
    let pieces = edges.pieces();
    flip_pieces(&corners, &pieces, &edges.open_lengths(&corners, &turned), &mut turned);
    mending.was_inverted = 2 * turned.iter().filter(|&&turned| turned).count() > turned.len();
    let changed = turned.iter().filter(|&&turned| turned != mending.was_inverted);
    mending.turned = changed.count();
    let opening = opening(&corners, &turned);
    let closed = Closed { triangles, numbers, corners, turned };
    let (closed, SecondSheets { triangles: second, differ }) = closed.without_second(&pieces);
    mending.second_sheets = second.len();
    let edges = if second.is_empty() { edges } else { Edges::new(&closed.triangles) };
    let (closed, [lids, wide_holes]) = closed.with_lids(surface, &edges);
    mending.lids = lids;
    let edges = if lids == 0 { edges } else { Edges::new(&closed.triangles) };
    let open = edges.open_lengths(&closed.corners, &closed.turned);
    let hollows = hollows(&closed.oriented(), &edges, &open);
    let Closed { numbers, corners, turned, .. } = closed;
    let open_edges = edges.open_count(&turned);
    let facets = facets(&corners, &numbers, &turned, &open);
    let pieces = pieces.count;
    RepairedSurface {
        facets,
        mending,
        open_edges,
        pieces,
        opening,
        second_sheets_differ: differ,
        wide_holes,
        hollows,
    }
}

/// Triangles by welded points, their numbers, their corners, and which of them were turned.
struct Closed {
    triangles: Vec<[u32; 3]>,
    numbers: Vec<u32>,
    corners: Vec<Corners>,
    turned: Vec<bool>,
}

impl Closed {
    /// The corners, each triangle on its side.
    fn oriented(&self) -> Vec<Corners> {
        let each = self.corners.iter().zip(&self.turned);
        each.map(|(corners, &turned)| if turned { corners.reversed() } else { *corners }).collect()
    }

    /// Without what stands there twice.
    fn without_second(mut self, pieces: &Pieces) -> (Closed, SecondSheets) {
        let second = second_sheets(&self.oriented(), pieces);
        if !second.triangles.is_empty() {
            let stays: Vec<bool> = (0..self.turned.len() as u32)
                .map(|n| second.triangles.binary_search(&n).is_err())
                .collect();
            self.triangles = kept(&self.triangles, &stays);
            self.numbers = kept(&self.numbers, &stays);
            self.corners = kept(&self.corners, &stays);
            self.turned = kept(&self.turned, &stays);
        }
        (self, second)
    }

    /// With lids on holes, how many, and how many wide holes have none.
    fn with_lids(mut self, surface: &TriangleSurface, edges: &Edges) -> (Closed, [usize; 2]) {
        let area: f64 = self.corners.iter().map(|corners| corners.area_vector().norm()).sum();
        let lids = lids(&Open {
            points: &surface.points,
            triangles: &self.triangles,
            corners: &self.oriented(),
            edges: &edges.borders(&self.turned),
            most_area: MOST_OPEN * area,
        });
        let first = surface.triangles.len() as u32;
        self.numbers.extend((first..).take(lids.triangles.len()));
        self.turned.resize(self.turned.len() + lids.triangles.len(), false);
        self.triangles.extend(lids.triangles);
        self.corners.extend(lids.corners);
        (self, [lids.count, lids.left])
    }
}

fn kept<T: Copy>(all: &[T], stays: &[bool]) -> Vec<T> {
    all.iter().zip(stays).filter(|(_, stays)| **stays).map(|(one, _)| *one).collect()
}

fn opening(corners: &[Corners], turned: &[bool]) -> f64 {
    let signed = corners.iter().zip(turned).map(|(corners, &turned)| {
        if turned { -corners.area_vector() } else { corners.area_vector() }
    });
    let (sum, area) =
        signed.fold((Vector::zeros(), 0.0), |(sum, area), one| (sum + one, area + one.norm()));
    sum.norm() / area
}

/// Triangles by welded points, without those that bound nothing, and their numbers.
fn sound_triangles(surface: &TriangleSurface, mending: &mut Mending) -> (Vec<[u32; 3]>, Vec<u32>) {
    let point_of = weld(&surface.points);
    let apart = point_of.iter().enumerate().filter(|&(point, &welded)| point as u32 != welded);
    mending.welded_points = apart.count();
    let mut seen = HashSet::with_capacity(surface.triangles.len());
    let (mut triangles, mut numbers) = (Vec::new(), Vec::new());
    for (number, corners) in surface.triangles.iter().enumerate() {
        let welded = corners.map(|corner| point_of[corner as usize]);
        let mut sorted = welded;
        sorted.sort_unstable();
        let has_area = Corners(surface.corners(number)).area_vector().norm() > 0.0;
        if sorted[0] == sorted[1] || sorted[1] == sorted[2] || !has_area {
            mending.degenerate += 1;
        } else if !seen.insert(sorted) {
            mending.duplicates += 1;
        } else {
            triangles.push(welded);
            numbers.push(number as u32);
        }
    }
    (triangles, numbers)
}

/// For each point the first one at exactly its place.
fn weld(points: &[Vector]) -> Vec<u32> {
    // Adding zero makes one of the two zeros.
    let key = |point: u32| points[point as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&point| (<[u64; 3]>::from(key(point)), point));
    let mut first_of: Vec<u32> = (0..points.len() as u32).collect();
    for pair in order.windows(2) {
        if key(pair[0]) == key(pair[1]) {
            first_of[pair[1] as usize] = first_of[pair[0] as usize];
        }
    }
    first_of
}

fn facets(corners: &[Corners], numbers: &[u32], turned: &[bool], open: &[[f64; 3]]) -> Vec<Facet> {
    let each = corners.iter().zip(numbers).zip(turned.iter().zip(open));
    each.map(|((&corners, &number), (&turned, &open))| match turned {
        true => Facet { corners: corners.reversed(), number, open: [open[2], open[1], open[0]] },
        false => Facet { corners, number, open },
    })
    .collect()
}

/// Turns small patches that the rest of the surface sees from the other side.
fn flip_patches(corners: &[Corners], patches: &Patches, turned: &mut [bool]) {
    let area: f64 = patches.areas.iter().sum();
    let small: Vec<usize> =
        (0..patches.areas.len()).filter(|&n| patches.areas[n] <= LARGE_PATCH * area).collect();
    if small.is_empty() {
        return;
    }
    for _ in 0..MOST_ROUNDS {
        let closed = vec![[0.0; 3]; corners.len()];
        let numbers: Vec<u32> = (0..corners.len() as u32).collect();
        let tree = TriangleTree::new(facets(corners, &numbers, turned, &closed));
        let is_wrong = |&&patch: &&usize| {
            let members = &patches.members[patch];
            seen_from_behind(&tree, corners, members, turned)
        };
        let wrong: Vec<usize> = small.iter().filter(is_wrong).copied().collect();
        for &patch in &wrong {
            patches.members[patch].iter().for_each(|&n| turned[n as usize] = !turned[n as usize]);
        }
        if wrong.is_empty() {
            return;
        }
    }
}

/// Whether the rest of a surface goes around the front of a patch more than around its back.
fn seen_from_behind(
    tree: &TriangleTree,
    corners: &[Corners],
    members: &[u32],
    turned: &[bool],
) -> bool {
    let own: Vec<Corners> = members
        .iter()
        .map(|&n| match turned[n as usize] {
            true => corners[n as usize].reversed(),
            false => corners[n as usize],
        })
        .collect();
    let largest =
        own.iter().max_by(|a, b| a.area_vector().norm().total_cmp(&b.area_vector().norm()));
    let across: Vector = own.iter().map(Corners::area_vector).sum();
    let area: f64 = own.iter().map(|corners| corners.area_vector().norm()).sum();
    let Some(largest) = largest.filter(|_| across.norm() > LEAST_FLATNESS * area) else {
        return false;
    };
    let normal = across.normalize();
    let without = |point: &Vector| {
        let mut angles = SolidAngles::default();
        own.iter().for_each(|corners| angles.add(corners, point));
        tree.winding(point) - angles.winding()
    };
    let away = normal * (0.5 * across.norm().sqrt());
    without(&(largest.middle() + away)) - without(&(largest.middle() - away)) > DECISIVE
}

/// Turns everything where the volume is negative, then closed pieces inside out that lie in no other piece.
fn flip_pieces(corners: &[Corners], pieces: &Pieces, open: &[[f64; 3]], turned: &mut [bool]) {
    let middle = corners.iter().map(Corners::middle).sum::<Vector>() / corners.len().max(1) as f64;
    let signed = |n: usize, turned: &[bool]| {
        let volume = corners[n].volume_with(&middle);
        if turned[n] { -volume } else { volume }
    };
    if (0..corners.len()).map(|n| signed(n, turned)).sum::<f64>() < 0.0 {
        turned.iter_mut().for_each(|turned| *turned = !*turned);
    }
    if pieces.count < 2 {
        return;
    }
    let mut volumes = vec![0.0; pieces.count];
    let mut is_open = vec![false; pieces.count];
    for (n, &piece) in pieces.piece_of.iter().enumerate() {
        volumes[piece as usize] += signed(n, turned);
        is_open[piece as usize] |= open[n] != [0.0; 3];
    }
    let inside_out = |piece: usize| volumes[piece] < 0.0 && !is_open[piece];
    if !(0..pieces.count).any(inside_out) {
        return;
    }
    let numbers: Vec<u32> = (0..corners.len() as u32).collect();
    let tree = TriangleTree::new(facets(corners, &numbers, turned, open));
    let lone: Vec<bool> = (0..pieces.count)
        .map(|piece| inside_out(piece) && !is_enclosed(&tree, corners, pieces, piece))
        .collect();
    for (n, &piece) in pieces.piece_of.iter().enumerate() {
        turned[n] ^= lone[piece as usize];
    }
}

/// Just beyond its outermost corner a closed piece goes around nothing: what is there are the others.
fn is_enclosed(tree: &TriangleTree, corners: &[Corners], pieces: &Pieces, piece: usize) -> bool {
    let members = pieces.piece_of.iter().zip(corners).filter(|(of, _)| **of as usize == piece);
    let points = members.flat_map(|(_, corners)| corners.0);
    let outermost = points.max_by(|a, b| a.x.total_cmp(&b.x));
    let (low, high) = tree.bounds();
    let beyond = Vector::x() * ((high - low).norm() * 1e-6);
    outermost.is_some_and(|point| tree.winding(&(point + beyond)) > 0.5)
}
