//! Compartments of a head, voxel by voxel: outer air, airways, soft tissue, bone, and what bone encloses.
//!
//! Thresholds alone call the brain soft tissue, the wall of a sinus a sheet of soft tissue (partial volume between bone and
//! air), and the throat skin. Compartments tell them apart by distance: a passage narrower than a given width is closed.

use super::flood::{Size, borders, flood, largest_piece, place, spread};
use crate::image::distance::{Nearest, nearest_marked};

/// Compartment of a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compartment {
    /// Air around the head, and what is not connected to the head.
    OuterAir,
    /// Air in nose, mouth and throat.
    InnerAir,
    Tissue,
    Bone,
    /// Marrow, brain, sinuses: what bone encloses but for narrow passages.
    Cavity,
    /// Air or thin lining beside bone in an airway.
    Lining,
}

impl Compartment {
    /// Whether tissue ends there as at bone.
    pub(super) fn is_bony(self) -> bool {
        match self {
            Compartment::Bone | Compartment::Cavity | Compartment::Lining => true,
            Compartment::OuterAir | Compartment::InnerAir | Compartment::Tissue => false,
        }
    }
}

/// Parameters of the division of a head. Lengths in mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Division {
    pub size: Size,
    pub spacing: [f64; 3],
    /// Below this value there is air.
    pub skin: f64,
    /// From this value on there is bone.
    pub bone: f64,
    /// Openings of the skin narrower than this lead into an airway.
    pub airway_opening: f64,
    /// Passages through bone narrower than this lead into a cavity.
    pub bone_gap: f64,
}

/// How far around the corner of a groove its air counts as reached, of the radius of the ball that must fit in.
const CORNER: f64 = 1.5;

/// The compartment of each voxel.
pub(super) fn compartments(values: &[f32], division: &Division) -> Vec<Compartment> {
    let has_body = |voxel: usize| f64::from(values[voxel]) >= division.skin;
    let has_bone = |voxel: usize| f64::from(values[voxel]) >= division.bone;
    let mut all = known_compartments(division, has_body, has_bone);
    close_cavities(&mut all, division);
    close_linings(&mut all, division.size);
    all
}

/// The compartments of voxels of which it is known what they are: nothing is closed.
pub(super) fn known_compartments(
    division: &Division,
    has_body: impl Fn(usize) -> bool,
    has_bone: impl Fn(usize) -> bool,
) -> Vec<Compartment> {
    let head = largest_piece(division.size, &has_body);
    let outer = outer_air(&head, division);
    let of = |voxel: usize| match (head[voxel], outer[voxel] || has_body(voxel)) {
        (true, _) if has_bone(voxel) => Compartment::Bone,
        (true, _) => Compartment::Tissue,
        (false, true) => Compartment::OuterAir,
        (false, false) => Compartment::InnerAir,
    };
    (0..head.len()).map(of).collect()
}

/// For each voxel whether the air nearest to it is that of an airway.
pub(super) fn airways(head: &[bool], division: &Division) -> Vec<bool> {
    let outer = outer_air(head, division);
    let to =
        |counts: &dyn Fn(usize) -> bool| nearest_marked(division.size, division.spacing, counts);
    let to_outer = to(&|voxel| outer[voxel]);
    let to_inner = to(&|voxel| !head[voxel] && !outer[voxel]);
    to_inner.iter().zip(&to_outer).map(|(inner, outer)| inner.square < outer.square).collect()
}

/// Air that a ball of the width of an opening reaches from the edges of the image, and the grooves beside it.
///
/// A throat that the lower face of the image cuts is an island of air in that face: air on the faces counts
/// as reached only where it hangs together with an edge of the image.
fn outer_air(head: &[bool], division: &Division) -> Vec<bool> {
    let size = division.size;
    let radius = 0.5 * division.airway_opening;
    let to_head = nearest_marked(size, division.spacing, |voxel| head[voxel]);
    let on_edge = (0..head.len()).filter(|&voxel| borders(voxel, size) >= 2);
    let on_faces = flood(size, on_edge, |voxel| !head[voxel] && borders(voxel, size) >= 1);
    let mut seeds: Vec<usize> = (0..head.len()).filter(|&voxel| on_faces[voxel]).collect();
    if seeds.is_empty() {
        // Every edge lies in the body: all air on the border is as good as any.
        seeds = (0..head.len()).filter(|&v| !head[v] && borders(v, size) >= 1).collect();
    }
    let fits = |voxel: usize| !head[voxel] && to_head[voxel].distance() > radius;
    let mut reached = flood(size, seeds.iter().copied(), fits);
    seeds.into_iter().for_each(|seed| reached[seed] = true);
    let to_reached = nearest_marked(size, division.spacing, |voxel| reached[voxel]);
    let is_near = |nearest: &Nearest| nearest.distance() <= CORNER * radius;
    head.iter().zip(&to_reached).map(|(&head, nearest)| !head && is_near(nearest)).collect()
}

/// Which side of a passage through bone a voxel lies on.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Open,
    Enclosed,
}

/// Soft tissue and inner air that hang together with the outer air only through gaps of bone become cavities.
fn close_cavities(all: &mut [Compartment], division: &Division) {
    let size = division.size;
    let is_bone = |voxel: usize| all[voxel] == Compartment::Bone;
    let to_bone = nearest_marked(size, division.spacing, is_bone);
    let is_wide = |voxel: usize| to_bone[voxel].distance() > 0.5 * division.bone_gap;
    let is_outside = |voxel: usize| all[voxel] == Compartment::OuterAir;
    let outside: Vec<usize> = (0..all.len()).filter(|&voxel| is_outside(voxel)).collect();
    if outside.is_empty() {
        // A part of a head without a skin: nothing tells what is enclosed.
        return;
    }
    let open = flood(size, outside.into_iter(), |voxel| is_outside(voxel) || is_wide(voxel));
    let mark = |voxel: usize| match (open[voxel], is_wide(voxel)) {
        (true, _) => Some(Side::Open),
        (false, true) => Some(Side::Enclosed),
        (false, false) => None,
    };
    let mut sides: Vec<Option<Side>> = (0..all.len()).map(mark).collect();
    spread(size, &mut sides, |voxel| !is_bone(voxel));
    for (compartment, side) in all.iter_mut().zip(sides) {
        if *compartment != Compartment::Bone && side != Some(Side::Open) {
            *compartment = Compartment::Cavity;
        }
    }
}

/// Inner air beside bone, and single voxels between the two, become lining.
fn close_linings(all: &mut [Compartment], size: Size) {
    let touches = |all: &[Compartment], voxel: usize, wanted: &dyn Fn(Compartment) -> bool| {
        around(voxel, size).any(|near| wanted(all[near]))
    };
    for between in [Compartment::Tissue, Compartment::InnerAir] {
        let is_lining = |all: &[Compartment], voxel: usize| {
            all[voxel] == between
                && touches(all, voxel, &Compartment::is_bony)
                && touches(all, voxel, &|near| near == Compartment::InnerAir)
        };
        let lining: Vec<usize> = (0..all.len()).filter(|&voxel| is_lining(all, voxel)).collect();
        lining.into_iter().for_each(|voxel| all[voxel] = Compartment::Lining);
    }
}

/// A voxel and those that share a face, an edge or a corner with it.
fn around(voxel: usize, size: Size) -> impl Iterator<Item = usize> {
    let index = place(voxel, size);
    let span = |axis: usize| {
        let last = (index[axis] + 1).min(size[axis] - 1);
        index[axis].saturating_sub(1)..=last
    };
    let [xs, ys, zs] = [span(0), span(1), span(2)];
    zs.flat_map(move |z| {
        let xs = xs.clone();
        ys.clone().flat_map(move |y| xs.clone().map(move |x| (z * size[1] + y) * size[0] + x))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: f32 = -1000.0;
    const FLESH: f32 = 50.0;
    const BONE: f32 = 900.0;

    /// Along one row of 1 mm voxels through a head of 41 mm: what lies at a place by a function of the place.
    fn head(at: impl Fn([f64; 3]) -> f32) -> (Vec<f32>, Division) {
        let size = [41, 41, 41];
        let values =
            (0..41 * 41 * 41).map(|n| at(place(n, size).map(|x| x as f64 - 20.0))).collect();
        let division = Division {
            size,
            spacing: [1.0; 3],
            skin: -300.0,
            bone: 200.0,
            airway_opening: 8.0,
            bone_gap: 4.0,
        };
        (values, division)
    }

    fn at(all: &[Compartment], [x, y, z]: [usize; 3]) -> Compartment {
        all[(z * 41 + y) * 41 + x]
    }

    #[test]
    fn a_brain_is_enclosed_though_a_narrow_hole_leads_to_it() {
        let radius = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        for (hole, brain) in [(1.2, Compartment::Cavity), (4.5, Compartment::Tissue)] {
            let (values, division) = head(|p| match radius(p) {
                r if r > 18.0 => AIR,
                r if (9.0..13.0).contains(&r) && !(p[2] > 0.0 && p[0].hypot(p[1]) < hole) => BONE,
                _ => FLESH,
            });
            let all = compartments(&values, &division);
            assert_eq!(at(&all, [20, 20, 20]), brain, "{hole}");
            assert_eq!(at(&all, [20, 5, 20]), Compartment::Tissue);
            assert_eq!(at(&all, [20, 9, 20]), Compartment::Bone);
            assert_eq!(at(&all, [0, 0, 0]), Compartment::OuterAir);
        }
    }

    #[test]
    fn a_throat_that_the_image_cuts_and_a_narrow_mouth_are_airways_and_a_groove_is_not() {
        let (values, division) = head(|[x, y, z]| {
            let in_throat = x.hypot(y) < 3.5 && z < 5.0;
            let in_mouth = (z - 2.0).abs() < 2.5 && x.abs() < 6.0 && y < 0.0;
            let in_groove = z > 8.0 && x.abs() < 2.5 && y < -12.0;
            match x.hypot(y) > 16.0 || in_throat || in_mouth || in_groove {
                true => AIR,
                false => FLESH,
            }
        });
        let all = compartments(&values, &division);
        assert_eq!(at(&all, [20, 20, 0]), Compartment::InnerAir, "throat at the border");
        assert_eq!(at(&all, [20, 12, 22]), Compartment::InnerAir, "mouth");
        assert_eq!(at(&all, [20, 7, 32]), Compartment::OuterAir, "groove of 4 mm");
        assert_eq!(at(&all, [20, 1, 20]), Compartment::OuterAir);
    }

    #[test]
    fn the_sheet_between_bone_and_inner_air_is_no_tissue() {
        // A jaw beside the mouth, with one voxel of partial volume between them.
        let (values, division) = head(|[x, y, z]| match x.hypot(y).max(z.abs()) {
            r if r > 17.0 => AIR,
            _ if z.abs() > 8.0 || y.abs() > 8.0 => FLESH,
            _ if x < -1.5 => BONE,
            _ if x < -0.5 => FLESH,
            _ if x < 5.5 => AIR,
            _ => FLESH,
        });
        let all = compartments(&values, &division);
        assert_eq!(at(&all, [19, 20, 20]), Compartment::Lining);
        assert_eq!(at(&all, [20, 20, 20]), Compartment::Lining);
        assert_eq!(at(&all, [22, 20, 20]), Compartment::InnerAir);
        assert_eq!(at(&all, [27, 20, 20]), Compartment::Tissue, "the other wall of the mouth");
    }

    #[test]
    fn what_is_not_connected_to_the_head_is_air() {
        let (values, division) = head(|[x, y, z]| {
            let table = y > 17.0;
            match x.hypot(y).hypot(z) < 14.0 || table {
                true => FLESH,
                false => AIR,
            }
        });
        let all = compartments(&values, &division);
        assert_eq!(at(&all, [20, 39, 20]), Compartment::OuterAir);
        assert_eq!(at(&all, [20, 20, 20]), Compartment::Tissue);
    }
}
