//! What a plan pushes into what: warned of, since nothing in the model stops it.

use crate::mesh::{SurfaceSearch, TriangleSurface, Warning};
use crate::plan::RigidMovement;
use crate::prediction::{Case, Prediction, Scene};
use crate::validation::penetration::{Side, reach};

/// A plan has to push this much deeper than the scan had it, in mm: surfaces of one scan touch.
const NOTICEABLE: f64 = 0.1;

/// A bone before and after its segment has moved.
struct MovedBone<'a> {
    name: &'a str,
    movement: RigidMovement,
    before: &'a TriangleSurface,
    after: TriangleSurface,
}

/// A warning for each pair of bones that a plan pushes into each other, and for each bone that it
/// pushes through the predicted skin.
pub fn overlaps(case: &Case, scene: &Scene, prediction: &Prediction) -> Vec<Warning> {
    let bones = moved_bones(case, scene);
    let mut warnings = Vec::new();
    for (number, bone) in bones.iter().enumerate() {
        for other in bones[number + 1..].iter().filter(|other| other.movement != bone.movement) {
            let detail = format!(
                "the plan pushes bones {:?} and {:?} into each other",
                bone.name, other.name
            );
            let there = depths(bone, (other.before, &other.after), Side::Inside);
            let back = depths(other, (bone.before, &bone.after), Side::Inside);
            let deepest =
                there.zip(back).map(|(there, back)| (there.0.max(back.0), there.1.max(back.1)));
            warnings.extend(deeper("bones-overlap", detail, deepest));
        }
    }
    let skin = (&scene.skin.surface, &scene.skin.moved(&prediction.displacement));
    for bone in &bones {
        let detail = format!("bone {:?} comes through the predicted skin", bone.name);
        warnings.extend(deeper("bone-through-skin", detail, depths(bone, skin, Side::Outside)));
    }
    warnings
}

fn moved_bones<'a>(case: &'a Case, scene: &Scene) -> Vec<MovedBone<'a>> {
    let movement = |name: &str| {
        let segment = scene.segments.iter().find(|segment| segment.name == name);
        segment.map_or_else(RigidMovement::default, |segment| segment.movement)
    };
    let surfaces =
        case.bones.iter().filter_map(|bone| Some((bone, case.surfaces.get(&bone.surface)?)));
    surfaces
        .map(|(bone, before)| {
            let movement = movement(&bone.name);
            let mut after = (**before).clone();
            after.points.iter_mut().for_each(|point| *point = movement.apply(point));
            MovedBone { name: &bone.name, movement, before, after }
        })
        .collect()
}

/// How far a bone reaches to a side of a surface, before and after.
fn depths(
    bone: &MovedBone,
    surface: (&TriangleSurface, &TriangleSurface),
    side: Side,
) -> Option<(f64, f64)> {
    let (before, after) =
        (SurfaceSearch::new(surface.0).ok()?, SurfaceSearch::new(surface.1).ok()?);
    Some((reach(bone.before, side, &before), reach(&bone.after, side, &after)))
}

fn deeper(code: &'static str, detail: String, depths: Option<(f64, f64)>) -> Option<Warning> {
    let (before, after) = depths?;
    let warning =
        Warning::new(code, detail).with("depth_mm", after).with("depth_before_mm", before);
    (after > before + NOTICEABLE).then_some(warning)
}
