//! Check of the skin: not held, not facing the bone, without the rims where tissue was cut.
//!
//! Displacements of such places are part of every statistic of the skin, and mean nothing there.

use rayon::prelude::*;

use super::Scene;
use crate::boundary::NodeClass;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::surface_edges::edges;
use crate::mesh::{TriangleSurface, Vector, Warning};

/// Shares of the skin above which it is reported: a few nodes are held where a scan ends.
const MOST_HELD: f64 = 0.1;
const MOST_INWARDS: f64 = 0.1;
/// The same of a named region, which is small and may end where the skin does.
const MOST_HELD_OF_REGION: f64 = 0.5;

const SKIN_HELD: &str = "skin-held";

/// The cosine between two faces that meet in a sharp edge: more than 60 degrees apart.
const SHARP: f64 = 0.5;

/// The cosine between the normal of a face and the way to what holds the tissue, above which it faces that.
const FACING: f64 = 0.5;

/// Faces whose direction is taken, evenly chosen.
const MEASURED_FACES: usize = 250;

/// Warnings of a skin that is no skin.
pub(super) fn suspect_skin(scene: &Scene, is_stated: bool) -> Vec<Warning> {
    let unnamed = (!is_stated).then(|| unnamed_skin(&scene.skin.surface));
    let warnings = [unnamed, held_skin(scene), held_regions(scene), inward_skin(scene)];
    warnings.into_iter().flatten().collect()
}

/// Skin nodes that do not move freely.
fn held_skin(scene: &Scene) -> Option<Warning> {
    let classes = |&node: &u32| scene.conditions.classes[node as usize];
    let nodes = scene.skin.nodes();
    let count = |wanted: &dyn Fn(NodeClass) -> bool| {
        nodes.iter().map(classes).filter(|&class| wanted(class)).count()
    };
    let held = count(&|class| class != NodeClass::Free);
    let share = held as f64 / nodes.len().max(1) as f64;
    let detail = format!(
        "{held} of {} skin nodes are held: what is held by bone is no skin, and a skin that is held does not show what \
         bone does to it",
        nodes.len()
    );
    let warning = Warning::new(SKIN_HELD, detail)
        .with("nodes", held as f64)
        .with("share", share)
        .with("joined", count(&|class| matches!(class, NodeClass::Joined(_))) as f64)
        .with("fixed", count(&|class| class == NodeClass::Fixed) as f64)
        .with("sliding", count(&|class| class == NodeClass::Sliding) as f64)
        .with("prescribed", count(&|class| class == NodeClass::Prescribed) as f64);
    (share > MOST_HELD).then_some(warning)
}

/// Named regions of the skin that are held for the most part, and move as what holds them does.
fn held_regions(scene: &Scene) -> Option<Warning> {
    let nodes = scene.skin.nodes();
    let is_held = |point: &&u32| {
        scene.conditions.classes[nodes[**point as usize] as usize] != NodeClass::Free
    };
    let counted = scene.skin.regions.iter().map(|(name, points)| {
        let held = points.iter().filter(is_held).count();
        (name, held, points.len())
    });
    let found: Vec<(&String, usize, usize)> =
        counted.filter(|(_, held, all)| *held as f64 > MOST_HELD_OF_REGION * *all as f64).collect();
    let shown: Vec<String> =
        found.iter().map(|(name, held, all)| format!("{held} of {all} of {name:?}")).collect();
    let detail = format!(
        "nodes of named regions of the skin are held, {}: these regions move as what holds them does, and show nothing of what bone \
         does to them",
        shown.join(", ")
    );
    let held: usize = found.iter().map(|(_, held, _)| held).sum();
    let warning = || Warning::new(SKIN_HELD, detail).with("nodes", held as f64);
    (!found.is_empty()).then(|| warning().with("regions", found.len() as f64))
}

/// Skin that faces what holds the tissue: the inner side of lips and cheeks.
fn inward_skin(scene: &Scene) -> Option<Warning> {
    let surface = &scene.skin.surface;
    let place = |node: u32| scene.mesh.nodes[node as usize];
    let held: Vec<Vector> = scene
        .conditions
        .constraints
        .iter()
        .filter(|constraint| constraint.count() == 3)
        .map(|constraint| place(constraint.node))
        .collect();
    if held.is_empty() {
        return None;
    }
    let held = ByHeight::of(&held);
    let step = surface.triangles.len().div_ceil(MEASURED_FACES).max(1);
    let measured: Vec<usize> = (0..surface.triangles.len()).step_by(step).collect();
    let areas: Vec<[f64; 2]> = measured
        .par_iter()
        .map(|&triangle| {
            let normal = surface.area_vector(triangle);
            let middle = surface.middle(triangle);
            let way = held.step_to_closest(&middle);
            let faces_it = way.dot(&normal) > FACING * way.norm() * normal.norm();
            [normal.norm(), if faces_it { normal.norm() } else { 0.0 }]
        })
        .collect();
    let [whole, inwards] =
        areas.iter().fold([0.0; 2], |sum, area| [sum[0] + area[0], sum[1] + area[1]]);
    let share = inwards / whole.max(f64::MIN_POSITIVE);
    let detail = format!(
        "{:.0} % of the skin faces what holds the tissue: the inner side of lips and cheeks is no skin",
        100.0 * share
    );
    let warning = Warning::new("skin-inwards", detail).with("share", share);
    (share > MOST_INWARDS).then(|| warning.with("faces_measured", measured.len() as f64))
}

/// Places in ascending order of z: the closest to another is found among those about as high.
struct ByHeight {
    places: Vec<Numbered>,
}

/// A place and its number in the order in which places were given.
struct Numbered {
    place: Vector,
    number: usize,
}

/// The closest place so far.
struct Closest {
    /// In mm².
    squared: f64,
    number: usize,
    way: Vector,
}

impl ByHeight {
    fn of(places: &[Vector]) -> Self {
        let numbered = places.iter().enumerate();
        let mut places: Vec<Numbered> =
            numbered.map(|(number, &place)| Numbered { place, number }).collect();
        places.sort_by(|a, b| a.place.z.total_cmp(&b.place.z));
        ByHeight { places }
    }

    /// The way to the closest place, of several that are as close to the first.
    fn step_to_closest(&self, from: &Vector) -> Vector {
        let middle = self.places.partition_point(|other| other.place.z < from.z);
        let (below, above) = self.places.split_at(middle);
        let none = Closest { squared: f64::INFINITY, number: usize::MAX, way: Vector::zeros() };
        let closest = none.or_of(above.iter(), from);
        closest.or_of(below.iter().rev(), from).way
    }
}

impl Closest {
    /// This one, or a closer one of places that are ever higher or ever lower.
    fn or_of<'a>(mut self, places: impl Iterator<Item = &'a Numbered>, from: &Vector) -> Self {
        for &Numbered { place, number } in places {
            let way = place - from;
            if way.z * way.z > self.squared {
                break;
            }
            let squared = way.norm_squared();
            if squared < self.squared || (squared == self.squared && number < self.number) {
                self = Closest { squared, number, way };
            }
        }
        self
    }
}

/// Without a stated skin every free face counts; sharp edges separate faces to the front from rims where tissue was
/// cut.
fn unnamed_skin(surface: &TriangleSurface) -> Warning {
    let mut parts = DisjointSets::new(surface.triangles.len());
    let sides = surface.sorted_sides();
    for edge in edges(&sides) {
        let [one, other] = edge else { continue };
        let [a, b] = [one, other].map(|side| surface.area_vector(side.triangle as usize));
        if a.dot(&b) > SHARP * a.norm() * b.norm() {
            parts.join(one.triangle, other.triangle);
        }
    }
    let mut areas = vec![0.0; surface.triangles.len()];
    for triangle in 0..surface.triangles.len() {
        areas[parts.root(triangle as u32) as usize] += surface.area_vector(triangle).norm();
    }
    let whole: f64 = areas.iter().sum();
    let largest = areas.iter().copied().fold(0.0, f64::max);
    let count = areas.iter().filter(|area| **area > 0.0).count();
    let detail = format!(
        "no skin is named, so that it is every free face, {:.0} mm2: cut rims and the inner sides of lips and cheeks \
         count; edges sharper than 60 degrees divide it into {count} parts",
        whole
    );
    Warning::new("skin-unnamed", detail)
        .with("area_mm2", whole)
        .with("parts", count as f64)
        .with("share_of_largest", largest / whole.max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_the_closest_of_many_places_is_the_one_that_a_look_at_each_finds() {
        let place = |number: usize| {
            let [x, y, z] = [7, 11, 13].map(|prime| (number * prime % 17) as f64);
            Vector::new(x, y, z)
        };
        let places: Vec<Vector> = (0..200).map(place).collect();
        let sorted = ByHeight::of(&places);
        for from in (0..100).map(|number| place(number * 3 + 1) * 0.5 + Vector::new(0.0, 4.0, 2.0))
        {
            let ways = places.iter().map(|place| place - from);
            let closest = ways.min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
            assert_eq!(Some(sorted.step_to_closest(&from)), closest);
        }
    }
}
