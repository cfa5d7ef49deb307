//! Overlap of surfaces under a plan: warned of, since nothing in the model stops it.

use mechanics::mesh::{SurfaceSearch, TriangleSurface, Vector, Warning};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{Bone, Case, Prediction, Scene};
use mechanics::validation::penetration::{Side, reach};

/// A plan has to push this much deeper than the scan had it, in mm: surfaces of one scan touch.
const NOTICEABLE: f64 = 0.1;

/// A bone where it was scanned, and how the plan moves it.
struct PlannedBone<'a> {
    name: &'a str,
    surface: &'a TriangleSurface,
    search: SurfaceSearch,
    movement: RigidMovement,
}

/// How deep something reaches into or out of something else, in mm.
#[derive(Clone, Copy)]
struct Depth {
    before: f64,
    after: f64,
}

/// A warning for each pair of bones that a plan pushes into each other, and for each bone that it
/// pushes through the predicted skin.
pub fn overlaps(case: &Case, scene: &Scene, prediction: &Prediction) -> Vec<Warning> {
    let bones = planned_bones(case, scene);
    if bones.is_empty() {
        return Vec::new();
    }
    let mut warnings = Vec::new();
    for (number, bone) in bones.iter().enumerate() {
        for other in bones[number + 1..].iter().filter(|other| other.movement != bone.movement) {
            let detail = format!(
                "the plan pushes bones {:?} and {:?} into each other",
                bone.name, other.name
            );
            let (there, back) = (bone.reach_into(other), other.reach_into(bone));
            let deepest =
                Depth { before: there.before.max(back.before), after: there.after.max(back.after) };
            warnings.extend(deepest.warning("bones-overlap", detail));
        }
    }
    let skin = &scene.skin;
    let moved = SurfaceSearch::new(&skin.moved(&prediction.displacement));
    if let (Ok(before), Ok(after)) = (SurfaceSearch::new(&skin.surface), moved) {
        for bone in &bones {
            let detail = format!("bone {:?} comes through the predicted skin", bone.name);
            let depth = bone.through(&before, &after);
            warnings.extend(depth.warning("bone-through-skin", detail));
        }
    }
    warnings
}

/// The bones of the case; one without any area touches nothing and is left out.
fn planned_bones<'a>(case: &'a Case, scene: &Scene) -> Vec<PlannedBone<'a>> {
    let planned = |bone: &'a Bone| {
        let surface = case.surfaces.get(&bone.surface)?;
        let search = SurfaceSearch::new(surface).ok()?;
        let segment = scene.segment(&bone.name).map(|number| &scene.segments[number]);
        let movement = segment.map_or_else(RigidMovement::default, |segment| segment.movement);
        Some(PlannedBone { name: &bone.name, surface, search, movement })
    };
    case.bones.iter().filter_map(planned).collect()
}

impl PlannedBone<'_> {
    /// How deep this bone reaches into another one. Only the movement of one against the other counts,
    /// so the other stays where its search was prepared.
    fn reach_into(&self, other: &PlannedBone) -> Depth {
        let relative = self.movement.then(&other.movement.inverse());
        let after = self.moved_by(&relative);
        Depth {
            before: reach(&self.surface.points, Side::Inside, &other.search),
            after: reach(&after, Side::Inside, &other.search),
        }
    }

    /// How far this bone reaches out of the skin.
    fn through(&self, before: &SurfaceSearch, after: &SurfaceSearch) -> Depth {
        Depth {
            before: reach(&self.surface.points, Side::Outside, before),
            after: reach(&self.moved_by(&self.movement), Side::Outside, after),
        }
    }

    fn moved_by(&self, movement: &RigidMovement) -> Vec<Vector> {
        self.surface.points.iter().map(|point| movement.apply(point)).collect()
    }
}

impl Depth {
    fn warning(self, code: &'static str, detail: String) -> Option<Warning> {
        let warning = Warning::new(code, detail)
            .with("depth_mm", self.after)
            .with("depth_before_mm", self.before);
        (self.after > self.before + NOTICEABLE).then_some(warning)
    }
}
