//! Surfaces of labelled bone by marching tetrahedra: closed, with the iso-surface of the scan where bone ends, and the
//! planes of the cuts where it is cut.
//!
//! Each cube of eight voxels is six tetrahedra around its diagonal (Kuhn's), the same on shared faces. An edge between a
//! voxel of the segment and another is crossed where the image passes the threshold or the saw of a cut of the segment begins,
//! whichever comes first, and in the middle where bone touches bone or the scan ends.
//! Source: Doi, Koide, An efficient method of triangulating equi-valued surfaces by using tetrahedral cells, IEICE
//! Transactions 74 (1991).

use std::collections::HashMap;

use nalgebra::Matrix3;

use super::bone_image::BoneImage;
use super::bone_labels::{BoneLabels, Owner};
use super::cut::Cut;
use super::rule::Osteotomy;
use crate::mesh::{TriangleSurface, Vector};

/// Crossings keep this share of an edge away from its ends, so that no triangle is a line.
const NEAREST_END: f64 = 0.05;
/// The orders in which a way from one corner of a cube to the opposite one takes the axes; the first three are even.
const WAYS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];

/// The place of a voxel in a grid with one more voxel around the image.
type VoxelIndex = [usize; 3];

/// A closed surface around the voxels of a segment; empty where it has none.
pub fn label_surface(
    bone: &BoneImage<'_>,
    osteotomy: &Osteotomy,
    labels: &BoneLabels,
    segment: usize,
) -> TriangleSurface {
    let steps = Matrix3::from_columns(&labels.placement().steps);
    let mut marching = Marching {
        bone,
        osteotomy,
        labels,
        segment,
        is_right_handed: steps.determinant() > 0.0,
        crossings: HashMap::new(),
        surface: TriangleSurface::default(),
    };
    let [x, y, z] = labels.size();
    for k in 0..=z {
        for j in 0..=y {
            for i in 0..=x {
                marching.add_cube([i, j, k]);
            }
        }
    }
    marching.surface
}

struct Marching<'a> {
    bone: &'a BoneImage<'a>,
    osteotomy: &'a Osteotomy,
    labels: &'a BoneLabels,
    segment: usize,
    is_right_handed: bool,
    crossings: HashMap<[VoxelIndex; 2], u32>,
    surface: TriangleSurface,
}

impl Marching<'_> {
    fn add_cube(&mut self, first: VoxelIndex) {
        let corner = |number: usize| [0, 1, 2].map(|axis| first[axis] + (number >> axis & 1));
        let inside = (0..8).filter(|&number| self.is_inside(corner(number))).count();
        if inside == 0 || inside == 8 {
            return;
        }
        for (number, way) in WAYS.iter().enumerate() {
            let mut at = first;
            let mut corners = [first; 4];
            for (step, &axis) in way.iter().enumerate() {
                at[axis] += 1;
                corners[step + 1] = at;
            }
            if (number < 3) != self.is_right_handed {
                corners.swap(2, 3);
            }
            self.add_tetrahedron(corners);
        }
    }

    /// The triangles in a tetrahedron of positive volume.
    fn add_tetrahedron(&mut self, corners: [VoxelIndex; 4]) {
        let inside = corners.map(|corner| self.is_inside(corner));
        let mut order = [0, 1, 2, 3];
        order.sort_by_key(|&corner| !inside[corner]);
        if !is_even(order) {
            let swapped = if inside.iter().filter(|inside| **inside).count() >= 2 { 0 } else { 2 };
            order.swap(swapped, swapped + 1);
        }
        let [a, b, c, d] = order.map(|corner| corners[corner]);
        match inside.iter().filter(|inside| **inside).count() {
            1 => self.add([[a, b], [a, c], [a, d]]),
            2 => {
                self.add([[a, c], [a, d], [b, d]]);
                self.add([[a, c], [b, d], [b, c]]);
            }
            3 => self.add([[a, d], [b, d], [c, d]]),
            _ => {}
        }
    }

    /// A triangle by the edges that it crosses, each from inside to outside.
    fn add(&mut self, edges: [[VoxelIndex; 2]; 3]) {
        let triangle = edges.map(|edge| self.crossing(edge));
        self.surface.triangles.push(triangle);
    }

    fn crossing(&mut self, edge: [VoxelIndex; 2]) -> u32 {
        if let Some(&point) = self.crossings.get(&edge) {
            return point;
        }
        let [from, to] = edge.map(|place| self.centre(place));
        let share = self.share(edge, [from, to]).clamp(NEAREST_END, 1.0 - NEAREST_END);
        let point = self.surface.points.len() as u32;
        self.surface.points.push(from + (to - from) * share);
        self.crossings.insert(edge, point);
        point
    }

    /// How much of an edge lies inside.
    fn share(&self, [inside, outside]: [VoxelIndex; 2], [from, to]: [Vector; 2]) -> f64 {
        let (Some(inside), Some(outside)) = (self.voxel(inside), self.voxel(outside)) else {
            return 0.5;
        };
        let above = |voxel: usize| self.bone.value(voxel) - self.bone.threshold;
        let [inner, outer] = [above(inside), above(outside)];
        let threshold = (outer <= 0.0).then(|| inner / (inner - outer));
        let sides = &self.osteotomy.segments()[self.segment].sides;
        let cuts = sides.iter().map(|side| &self.osteotomy.cuts()[side.cut]);
        let is_sawn = |cut: &&Cut| cut.parts(&from, &to) || cut.saws(&to);
        let cut = cuts.filter(is_sawn).map(|cut| {
            let [here, there] = [from, to].map(|end| cut.plane().height(&end));
            let off_face = here.abs() - cut.kerf() / 2.0;
            if off_face > 0.0 { off_face / (here - there).abs() } else { 0.0 }
        });
        cut.chain(threshold).reduce(f64::min).unwrap_or(0.5)
    }

    fn is_inside(&self, place: VoxelIndex) -> bool {
        let owner = self.voxel(place).and_then(|voxel| self.labels.owner(voxel));
        owner == Some(Owner::Segment(self.segment))
    }

    /// The number of a voxel; `None` around the image.
    fn voxel(&self, place: VoxelIndex) -> Option<usize> {
        let size = self.labels.size();
        let is_within = (0..3).all(|axis| (1..=size[axis]).contains(&place[axis]));
        is_within.then(|| place[0] - 1 + size[0] * (place[1] - 1 + size[1] * (place[2] - 1)))
    }

    fn centre(&self, place: VoxelIndex) -> Vector {
        let placement = self.labels.placement();
        let steps = placement.steps.iter().zip(place);
        steps.fold(placement.origin, |sum, (step, count)| sum + step * (count as f64 - 1.0))
    }
}

fn is_even(order: [usize; 4]) -> bool {
    let before = |one: usize| (one + 1..4).filter(move |&other| order[one] > order[other]);
    (0..4).flat_map(before).count() % 2 == 0
}
