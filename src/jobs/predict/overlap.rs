//! Overlap of surfaces under a plan: a warning, since the model does not prevent it.

use crate::jobs::result::pictures::upright;
use crate::jobs::result::tissue::encode_bones;
use crate::schema::predict::planned::{BoneContactDocument, CollisionDocument, OverlapDocument};
use mechanics::chart::{GapsOfBone, GapsPicture, PngError};
use mechanics::format::WriteError;
use mechanics::mesh::{SurfaceSearch, TriangleSurface, Vector, Warning};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{Bone, Case, Prediction, Scene};
use mechanics::progress::StopQuery;
use mechanics::validation::contact_map::{contact_regions, gaps};
use mechanics::validation::penetration::{Side, overlap, probes, reach};

/// Additional depth under a plan for a warning, in mm: surfaces of one scan already touch.
const NOTICEABLE: f64 = 0.1;

/// The distance of contact, in mm: the accuracy of teeth in scans.
const CONTACT: f64 = 0.3;

/// The largest gap of interest between bones, in mm.
const FARTHEST_GAP: f64 = 5.0;

/// A bone as scanned, and its planned movement.
struct PlannedBone<'a> {
    name: &'a str,
    surface: &'a TriangleSurface,
    /// Points all over it, as scanned.
    probes: Vec<Vector>,
    search: SurfaceSearch,
    movement: RigidMovement,
}

/// The depth of penetration, in mm.
#[derive(Clone, Copy)]
struct Depth {
    before: f64,
    after: f64,
}

/// The bones that overlap, of those that the plan moves relative to each other; after a stop pairs are left out.
pub fn collisions(case: &Case, scene: &Scene, stop: &StopQuery) -> Vec<Collision> {
    let bones = planned_bones(case, scene);
    let pairs = moved_pairs(&bones).take_while(|_| !stop.is_asked());
    pairs.filter_map(|(bone, other)| bone.collision(other)).collect()
}

/// Contact of bones that the plan moves relative to each other; pairs without contact are omitted, and after a stop pairs are left out.
pub fn contacts(case: &Case, scene: &Scene, stop: &StopQuery) -> Vec<BoneContactDocument> {
    let bones = planned_bones(case, scene);
    let pairs = moved_pairs(&bones).take_while(|_| !stop.is_asked());
    pairs.filter_map(|(bone, other)| bone.contact(other)).collect()
}

/// `bones.vtp`, with the gaps between bones.
pub fn bones_file(
    case: &Case,
    scene: &Scene,
    field_data: &[(String, String)],
) -> Result<Vec<u8>, WriteError> {
    encode_bones(case, scene, planned_gaps(case, scene).as_deref(), field_data)
}

/// `gaps.svg`: bones that the plan moves relative to each other and that come near, before and as planned. `None` if there are
/// none.
pub fn gaps_picture(case: &Case, scene: &Scene) -> Result<Option<String>, PngError> {
    let bones = planned_bones(case, scene);
    let stages = bones.iter().map(|bone| {
        let against: Vec<&PlannedBone> =
            bones.iter().filter(|other| other.movement != bone.movement).collect();
        let rest = bone.nearest(&against, &|_| RigidMovement::default());
        let planned =
            bone.nearest(&against, &|other| bone.movement.then(&other.movement.inverse()));
        (rest, bone.moved_by(&bone.movement), planned)
    });
    let stages: Vec<(Vec<f64>, Vec<Vector>, Vec<f64>)> = stages.collect();
    let is_near = |gaps: &[f64]| gaps.iter().any(|gap| *gap < FARTHEST_GAP);
    let shown = bones
        .iter()
        .zip(&stages)
        .filter(|(_, (rest, _, planned))| is_near(rest) || is_near(planned));
    let shown: Vec<GapsOfBone> = shown
        .map(|(bone, (rest, moved, planned))| GapsOfBone {
            name: bone.name,
            triangles: &bone.surface.triangles,
            stages: [(&bone.surface.points, rest), (moved, planned)],
        })
        .collect();
    if shown.is_empty() {
        return Ok(None);
    }
    let moving = scene.segments.iter().filter(|segment| segment.movement != Default::default());
    let names: Vec<&str> = moving.map(|segment| segment.name.as_str()).collect();
    let picture = GapsPicture {
        title: "How bones meet",
        subtitle: &format!("moved: {}", names.join(", ")),
        bones: &shown,
        face_direction: upright(case.frame, &scene.skin.surface),
        frame: case.frame.name(),
    };
    picture.to_svg().map(Some)
}

/// For each point of each bone that has a surface, as planned, the signed distance from the nearest bone that the plan
/// moves against it, in mm, negative inside; [`FARTHEST_GAP`] if none is as near. `None` if no bone moves relative to
/// another.
fn planned_gaps(case: &Case, scene: &Scene) -> Option<Vec<f64>> {
    let bones = planned_bones(case, scene);
    let mut all = Vec::new();
    let mut has_pair = false;
    for bone in case.bones.iter().filter(|bone| case.surfaces.contains_key(&bone.surface)) {
        let Some(own) = bones.iter().find(|own| own.name == bone.name) else {
            all.extend(vec![FARTHEST_GAP; case.surfaces[&bone.surface].points.len()]);
            continue;
        };
        let against: Vec<&PlannedBone> =
            bones.iter().filter(|other| other.movement != own.movement).collect();
        has_pair = has_pair || !against.is_empty();
        all.extend(own.nearest(&against, &|other| own.movement.then(&other.movement.inverse())));
    }
    has_pair.then_some(all)
}

/// A warning for each bone that penetrates the predicted skin under the plan.
pub fn through_skin(case: &Case, scene: &Scene, prediction: &Prediction) -> Vec<Warning> {
    let bones = planned_bones(case, scene);
    let skin = &scene.skin;
    let moved = SurfaceSearch::new(&skin.moved(&prediction.displacement));
    let (Ok(before), Ok(after)) = (SurfaceSearch::new(&skin.surface), moved) else {
        return Vec::new();
    };
    let warning = |bone: &PlannedBone| {
        let detail = format!("bone {:?} comes through the predicted skin", bone.name);
        bone.through(&before, &after).warning("bone-through-skin", detail)
    };
    bones.iter().filter_map(warning).collect()
}

/// Two bones that overlap after the plan.
pub struct Collision {
    bones: [String; 2],
    depth: Depth,
    /// Both as planned.
    placed: [TriangleSurface; 2],
}

impl Collision {
    /// The warning if they are deeper than in the scan.
    pub fn warning(&self) -> Option<Warning> {
        let [one, other] = &self.bones;
        let detail = format!("the plan pushes bones {one:?} and {other:?} into each other");
        self.depth.warning("bones-overlap", detail)
    }

    pub fn document(&self) -> CollisionDocument {
        CollisionDocument {
            bones: self.bones.clone(),
            depth_mm: self.depth.after,
            depth_before_mm: self.depth.before,
            overlap: overlap(&self.placed[0], &self.placed[1]).as_ref().map(OverlapDocument::from),
        }
    }
}

/// The bones of the case; one without area is omitted.
fn planned_bones<'a>(case: &'a Case, scene: &Scene) -> Vec<PlannedBone<'a>> {
    let planned = |bone: &'a Bone| {
        let surface = case.surfaces.get(&bone.surface)?;
        let search = SurfaceSearch::new(surface).ok()?;
        let segment = scene.segment(&bone.name).map(|number| &scene.segments[number]);
        let movement = segment.map_or_else(RigidMovement::default, |segment| segment.movement);
        Some(PlannedBone { name: &bone.name, surface, probes: probes(surface), search, movement })
    };
    case.bones.iter().filter_map(planned).collect()
}

/// All pairs of bones that the plan moves relative to each other.
fn moved_pairs<'b, 'a>(
    bones: &'b [PlannedBone<'a>],
) -> impl Iterator<Item = (&'b PlannedBone<'a>, &'b PlannedBone<'a>)> {
    bones.iter().enumerate().flat_map(move |(number, bone)| {
        let others = bones[number + 1..].iter();
        others.filter(|other| other.movement != bone.movement).map(move |other| (bone, other))
    })
}

impl PlannedBone<'_> {
    /// The gap of each of its points to the other bone, which stays where its search was prepared.
    fn gaps_to(&self, other: &PlannedBone, relative: &RigidMovement) -> Vec<f64> {
        let against = TriangleSurface { points: self.moved_by(relative), ..self.surface.clone() };
        gaps(&against, &other.search, FARTHEST_GAP)
    }

    /// The least gap of each of its points to several others, [`FARTHEST_GAP`] if none is as near.
    fn nearest(
        &self,
        others: &[&PlannedBone],
        relative: &dyn Fn(&PlannedBone) -> RigidMovement,
    ) -> Vec<f64> {
        let mut nearest = vec![FARTHEST_GAP; self.surface.points.len()];
        for other in others {
            let found = self.gaps_to(other, &relative(other));
            nearest.iter_mut().zip(found).for_each(|(least, gap)| *least = least.min(gap));
        }
        nearest
    }

    fn collision(&self, other: &PlannedBone) -> Option<Collision> {
        let (there, back) = (self.reach_into(other), other.reach_into(self));
        let depth =
            Depth { before: there.before.max(back.before), after: there.after.max(back.after) };
        if depth.after <= 0.0 {
            return None;
        }
        let placed = |bone: &PlannedBone| TriangleSurface {
            points: bone.moved_by(&bone.movement),
            ..bone.surface.clone()
        };
        let bones = [self.name.to_owned(), other.name.to_owned()];
        Some(Collision { bones, depth, placed: [placed(self), placed(other)] })
    }

    fn contact(&self, other: &PlannedBone) -> Option<BoneContactDocument> {
        let before = contact_regions(self.surface, &other.search, CONTACT);
        // The other stays where its search was prepared, and what is found goes with it to where it is planned.
        let relative = self.movement.then(&other.movement.inverse());
        let points = self.moved_by(&relative);
        let against = TriangleSurface { points, ..self.surface.clone() };
        let mut planned = contact_regions(&against, &other.search, CONTACT);
        for region in &mut planned {
            region.middle = other.movement.apply(&region.middle);
        }
        if before.is_empty() && planned.is_empty() {
            return None;
        }
        Some(BoneContactDocument {
            bones: [self.name.to_owned(), other.name.to_owned()],
            within_mm: CONTACT,
            before: before.as_slice().into(),
            planned: planned.as_slice().into(),
        })
    }

    /// The depth of this bone in another one. Only the relative movement counts,
    /// so the other stays where its search was prepared.
    fn reach_into(&self, other: &PlannedBone) -> Depth {
        let relative = self.movement.then(&other.movement.inverse());
        Depth {
            before: reach(&self.probes, Side::Inside, &other.search),
            after: reach(&moved(&self.probes, &relative), Side::Inside, &other.search),
        }
    }

    /// The distance beyond the skin of what of this bone is behind it before.
    fn through(&self, before: &SurfaceSearch, after: &SurfaceSearch) -> Depth {
        let is_behind = |point: &&Vector| {
            reach(std::slice::from_ref(*point), Side::Outside, before) <= NOTICEABLE
        };
        let probes: Vec<Vector> = self.probes.iter().filter(is_behind).copied().collect();
        Depth {
            before: reach(&probes, Side::Outside, before),
            after: reach(&moved(&probes, &self.movement), Side::Outside, after),
        }
    }

    fn moved_by(&self, movement: &RigidMovement) -> Vec<Vector> {
        moved(&self.surface.points, movement)
    }
}

fn moved(points: &[Vector], movement: &RigidMovement) -> Vec<Vector> {
    points.iter().map(|point| movement.apply(point)).collect()
}

impl Depth {
    fn warning(self, code: &'static str, detail: String) -> Option<Warning> {
        let warning = Warning::new(code, detail)
            .with("depth_mm", self.after)
            .with("depth_before_mm", self.before);
        (self.after > self.before + NOTICEABLE).then_some(warning)
    }
}
