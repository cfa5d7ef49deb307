//! Sliding walls: the bone that carries each, contradictions between two, and fixed walls beside a bone that moves.
//!
//! A wall that a segment carries holds n . u = n . ((R - I) x + t) at each of its nodes x and leaves what is along
//! it free. Small strain keeps n; a model that knows large rotations takes R n.

use std::collections::{BTreeMap, BTreeSet};

use super::case::{Settings, Sliding, SlidingNormal};
use super::check::Check;
use super::error_code::SceneErrorCode;
use super::scene::Scene;
use super::stated::StatedHold;
use crate::boundary::sliding::{Beside, SAME_DIRECTION, SAME_WALL};
use crate::boundary::{HeldNodes, NodeSelection, WallNode, sliding};
use crate::mesh::ignored::listed;
use crate::mesh::{Vector, Warning};
use crate::plan::{PlannedSegment, RigidMovement};

/// Above this turn of a segment, in degrees, small strain is told to keep the normals of its walls.
const NORMAL_TURNED_DEG: f64 = 5.0;

/// Above this turn the second order is not known: across a wall it is that of the normal that turns.
const NORMAL_TURNED_AT_SECOND_ORDER_DEG: f64 = 0.1;

/// A bone that goes across a wall by less than this, in mm, slides along it.
const ACROSS_MM: f64 = 1e-6;

/// The code of the warning of turned normals.
const NORMAL_TURNED: &str = "sliding-normal-turned";

/// A set of sliding nodes as the case states it.
struct Wall {
    /// Its place in the case.
    index: usize,
    carrier: Option<u32>,
    /// With the normals of each node.
    nodes: Vec<(u32, Vec<Vector>)>,
}

impl Check<'_> {
    /// The nodes that slide, with what carries their walls.
    pub(super) fn walls(
        &mut self,
        segments: &[PlannedSegment],
        settings: &Settings,
        held: &mut HeldNodes,
    ) {
        let entries = self.case.sliding.iter().enumerate();
        let carriers: Vec<Option<u32>> =
            entries.map(|(index, entry)| self.carrier(index, entry)).collect();
        if !settings.contact.holds_sliding() {
            return;
        }
        let mut on_bone = vec![false; self.case.volume.nodes.len()];
        let of_segments = held.joined.iter().flat_map(|(nodes, _)| nodes);
        held.fixed.iter().chain(of_segments).for_each(|&node| on_bone[node as usize] = true);
        let skin = self.case.skin.as_ref().map(|skin| self.selected(skin));
        let mut on_skin = vec![false; self.case.volume.nodes.len()];
        let skin = skin.and_then(Result::ok).unwrap_or_default();
        skin.into_iter().for_each(|node| on_skin[node as usize] = true);
        let walls = self.with_normals(&carriers, &Beside { on_bone, on_skin });
        self.two_carriers(&walls, segments);
        self.two_bones(&walls, segments, held);
        self.warn_of_walls_at_moving_bone(&walls, segments, held);
        let keeps_normals = settings.method.properties().is_small_strain;
        for Wall { index, carrier, nodes } in walls {
            let turn = carrier.filter(|_| !keeps_normals);
            let turn = turn.map(|segment| *segments[segment as usize].movement.rotation());
            let (numbers, across): (Vec<u32>, Vec<Vec<Vector>>) = nodes
                .into_iter()
                .map(|(node, normals)| match &turn {
                    Some(rotation) => (node, normals.iter().map(|n| rotation * n).collect()),
                    None => (node, normals),
                })
                .unzip();
            let walls = numbers.iter().zip(&across);
            held.sliding.extend(walls.map(|(&node, across)| WallNode {
                node,
                across: across.clone(),
                carrier,
            }));
            let pointer = format!("/case/sliding/{index}");
            self.state(pointer, carrier, numbers, StatedHold::Walls(across));
        }
    }

    /// The number of the segment that an entry names.
    fn carrier(&mut self, index: usize, entry: &Sliding) -> Option<u32> {
        let name = entry.segment.as_deref()?;
        let segments = &self.case.segments;
        let place = segments.iter().position(|segment| segment.name == name);
        if place.is_none() {
            let is_fixed = name == "fixed" || self.case.fixed.iter().any(|set| selects(set, name));
            let detail = match is_fixed {
                true => format!(
                    "{name:?} is fixed and no segment: a wall on it stays, which is what a set without \
                     `segment` says"
                ),
                false => {
                    let known = listed(segments.iter().map(|other| &other.name));
                    format!("no segment of the case is called {name:?}; its segments: {known}")
                }
            };
            let pointer = format!("/case/sliding/{index}/segment");
            self.problems.add(pointer, SceneErrorCode::UnknownSegment, detail);
        }
        place.map(|place| place as u32)
    }

    /// The walls of all sets. Sets with the normals of their faces and the same carrier are one surface: it makes no difference
    /// whether a wall is stated in one piece or in several.
    fn with_normals(&mut self, carriers: &[Option<u32>], beside: &Beside) -> Vec<Wall> {
        let entries = self.case.sliding.iter().enumerate().zip(carriers);
        let mut walls: Vec<Wall> = entries
            .map(|((index, entry), &carrier)| {
                let nodes = self.select(&entry.nodes, &format!("/case/sliding/{index}/nodes"));
                let nodes = match entry.normal {
                    SlidingNormal::Surface => {
                        sliding::wall_normals(&self.case.volume, self.boundary, &nodes, beside)
                    }
                    SlidingNormal::Direction(direction) => {
                        let unit: Vec<Vector> =
                            direction.try_normalize(1e-12).into_iter().collect();
                        nodes.into_iter().map(|node| (node, unit.clone())).collect()
                    }
                };
                Wall { index, carrier, nodes }
            })
            .collect();
        let is_surface =
            |wall: &Wall| matches!(self.case.sliding[wall.index].normal, SlidingNormal::Surface);
        for carrier in carriers.iter().collect::<BTreeSet<_>>() {
            let own = |wall: &&Wall| wall.carrier == *carrier && is_surface(wall);
            if walls.iter().filter(own).count() < 2 {
                continue;
            }
            let nodes = walls.iter().filter(own).flat_map(|wall| &wall.nodes);
            let nodes: BTreeSet<u32> = nodes.map(|(node, _)| *node).collect();
            let nodes: Vec<u32> = nodes.into_iter().collect();
            let whole = sliding::wall_normals(&self.case.volume, self.boundary, &nodes, beside);
            let whole: BTreeMap<u32, Vec<Vector>> = whole.into_iter().collect();
            for (node, normals) in
                walls.iter_mut().filter(|wall| own(&&**wall)).flat_map(|wall| &mut wall.nodes)
            {
                *normals = of_whole(normals, &whole[node]);
            }
        }
        walls.iter().for_each(|wall| self.refuse_without_normal(wall));
        walls.sort_by_key(is_surface);
        let stated = walls.iter().filter(|wall| !is_surface(wall)).count();
        self.join_near_directions(&mut walls, stated);
        walls.sort_by_key(|wall| wall.index);
        walls
    }

    /// Gives walls of a node that are less than 5 degrees from a direction stated before for the same carrier that direction, since two would
    /// leave the node free along their line only; warns of those up to 45 degrees apart. The first so many walls are stated; surfaces meet as
    /// their faces do.
    fn join_near_directions(&mut self, walls: &mut [Wall], stated: usize) {
        let mut known: BTreeMap<(u32, Option<u32>), Vec<Vector>> = BTreeMap::new();
        let (mut both, mut nearest): (BTreeSet<u32>, f64) = (BTreeSet::new(), 0.0);
        for (place, Wall { carrier, nodes, .. }) in walls.iter_mut().enumerate() {
            for (node, normals) in nodes {
                let others = known.entry((*node, *carrier)).or_default();
                for normal in normals.iter_mut() {
                    let cosines = others.iter().map(|other| (normal.dot(other), *other));
                    let Some((cosine, other)) =
                        cosines.max_by(|(one, _), (other, _)| one.abs().total_cmp(&other.abs()))
                    else {
                        continue;
                    };
                    if cosine.abs() > SAME_DIRECTION {
                        *normal = other * cosine.signum();
                    } else if cosine.abs() > SAME_WALL {
                        both.insert(*node);
                        nearest = nearest.max(cosine.abs());
                    }
                }
                if place < stated {
                    others.extend(normals.iter());
                }
            }
        }
        let Some(first) = both.first() else { return };
        let degrees = nearest.acos().to_degrees();
        let detail = format!(
            "{} nodes, the first is node {first}, slide on walls of two sets that are {degrees:.0} to 45 degrees apart and \
             are held across both, free along one line only: where these are one curved wall, let both sets have \
             \"normal\": \"surface\", or give each node to one of them",
            both.len()
        );
        let warning = Warning::new("walls-nearly-parallel", detail);
        self.warnings.push(warning.with("nodes", both.len() as f64).with("apart_deg", degrees));
    }

    /// Refuses nodes of a wall without a normal.
    fn refuse_without_normal(&mut self, Wall { index, nodes: normals, .. }: &Wall) {
        if let Some((node, _)) = normals.iter().find(|(_, normals)| normals.is_empty()) {
            let detail = format!("node {node} has no normal for its sliding condition");
            let pointer = format!("/case/sliding/{index}/normal");
            self.problems.add(pointer, SceneErrorCode::SlidingNormalZero, detail);
        }
    }

    /// Refuses nodes that two walls of nearly one direction hold while different things carry these.
    fn two_carriers(&mut self, walls: &[Wall], segments: &[PlannedSegment]) {
        for (place, later) in walls.iter().enumerate() {
            for earlier in walls[..place].iter().filter(|other| other.carrier != later.carrier) {
                let normals: BTreeMap<u32, &Vec<Vector>> =
                    earlier.nodes.iter().map(|(node, normals)| (*node, normals)).collect();
                let is_same = |(node, own): &&(u32, Vec<Vector>)| {
                    let others = normals.get(node).into_iter().flat_map(|others| others.iter());
                    others
                        .into_iter()
                        .any(|other| own.iter().any(|n| n.dot(other).abs() > SAME_WALL))
                };
                let both: Vec<u32> =
                    later.nodes.iter().filter(is_same).map(|(node, _)| *node).collect();
                let Some(first) = both.first() else { continue };
                let [one, other] = [earlier, later].map(|wall| carried_by(wall.carrier, segments));
                let detail = format!(
                    "{} nodes, the first is node {first}, slide on a wall {one} and, less than 45 degrees apart, \
                     on one {other}: one wall cannot follow both",
                    both.len()
                );
                let pointer = format!("/case/sliding/{}", later.index);
                self.problems.add(pointer, SceneErrorCode::SlidingConflict, detail);
            }
        }
    }

    /// Refuses a wall that one segment carries and that has nodes of another one.
    fn two_bones(&mut self, walls: &[Wall], segments: &[PlannedSegment], held: &HeldNodes) {
        for wall in walls {
            let Some(carrier) = wall.carrier else { continue };
            let own: BTreeSet<u32> = held.joined[carrier as usize].0.iter().copied().collect();
            for (other, (nodes, _)) in held.joined.iter().enumerate() {
                if other == carrier as usize {
                    continue;
                }
                let others: BTreeSet<u32> = nodes.iter().copied().collect();
                let is_shared = |node: &u32| others.contains(node) && !own.contains(node);
                let shared: Vec<u32> =
                    wall.nodes.iter().map(|(node, _)| *node).filter(is_shared).collect();
                let Some(first) = shared.first() else { continue };
                let detail = format!(
                    "the wall {} has {} nodes of segment {:?}, the first is node {first}: leave them out, or give \
                     them a set of their own",
                    carried_by(wall.carrier, segments),
                    shared.len(),
                    segments[other].name
                );
                let pointer = format!("/case/sliding/{}", wall.index);
                self.problems.add(pointer, SceneErrorCode::SlidingConflict, detail);
            }
        }
    }

    /// Warns of walls that stay while a bone moves across them that their nodes touch: nodes of it, or on one face of a
    /// cell with one. Where no segment moves yet, each may.
    fn warn_of_walls_at_moving_bone(
        &mut self,
        walls: &[Wall],
        segments: &[PlannedSegment],
        held: &HeldNodes,
    ) {
        let resting = walls.iter().filter(|wall| wall.carrier.is_none());
        let mut resting_walls: BTreeMap<u32, Vec<Vector>> = BTreeMap::new();
        for (node, normals) in resting.flat_map(|wall| &wall.nodes) {
            resting_walls.entry(*node).or_default().extend(normals);
        }
        if resting_walls.is_empty() || segments.is_empty() {
            return;
        }
        let carried: BTreeSet<(u32, u32)> = walls
            .iter()
            .filter_map(|wall| wall.carrier.map(|carrier| (wall, carrier)))
            .flat_map(|(wall, carrier)| wall.nodes.iter().map(move |(node, _)| (carrier, *node)))
            .collect();
        let still = RigidMovement::default();
        let any_moves = segments.iter().any(|segment| segment.movement != still);
        let crosses = |(bone, node): &(u32, u32)| {
            let place = &self.case.volume.nodes[*node as usize];
            let moved = segments[*bone as usize].movement.displacement(place);
            let mut normals = resting_walls[node].iter();
            !any_moves || normals.any(|normal| normal.dot(&moved).abs() > ACROSS_MM)
        };
        let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
        let touching = self.touching(&resting_walls, held);
        for (bone, _) in touching.difference(&carried).filter(|pair| crosses(pair)) {
            *counts.entry(*bone).or_default() += 1;
        }
        for (bone, count) in counts {
            let moves = if any_moves { "moves across their wall" } else { "may move" };
            let detail = format!(
                "{count} sliding nodes touch segment {:?}, which {moves}, and their wall stays: name the segment in \
                 the `segment` of their set where it carries the wall",
                segments[bone as usize].name
            );
            let warning = Warning::new("sliding-beside-segment", detail);
            self.warnings.push(warning.with("nodes", count as f64));
        }
    }

    /// Bones and nodes of walls that are on a face of a cell together.
    fn touching(
        &self,
        walls: &BTreeMap<u32, Vec<Vector>>,
        held: &HeldNodes,
    ) -> BTreeSet<(u32, u32)> {
        let nodes = self.case.volume.nodes.len();
        let (mut on_wall, mut bone_of) = (vec![false; nodes], vec![None; nodes]);
        walls.keys().for_each(|&node| on_wall[node as usize] = true);
        for (number, (members, _)) in (0_u32..).zip(&held.joined) {
            members.iter().for_each(|&node| bone_of[node as usize] = Some(number));
        }
        let mut touching = BTreeSet::new();
        for (shape, nodes) in self.case.volume.cells.iter() {
            for face in shape.faces() {
                let corners = || face.iter().map(|&local| nodes[local]);
                for node in corners().filter(|&node| on_wall[node as usize]) {
                    let bones = corners().filter_map(|other| bone_of[other as usize]);
                    touching.extend(bones.map(|bone| (bone, node)));
                }
            }
        }
        touching
    }
}

/// The normals of a whole surface at a node that are those of walls of a part of it; all where the part has no face of one.
fn of_whole(part: &[Vector], whole: &[Vector]) -> Vec<Vector> {
    let is_of_part = |normal: &&Vector| part.iter().any(|own| own.dot(normal) > SAME_WALL);
    let found: Vec<Vector> = whole.iter().filter(is_of_part).copied().collect();
    if found.is_empty() { whole.to_vec() } else { found }
}

/// Whether a selection is made of, or takes in, a node set of that name.
fn selects(selection: &NodeSelection, name: &str) -> bool {
    match selection {
        NodeSelection::NodeSet(set) => {
            let plain = |text: &str| text.strip_prefix("set_").unwrap_or(text).to_owned();
            plain(set) == plain(name)
        }
        NodeSelection::Any(parts) => parts.iter().any(|part| selects(part, name)),
        NodeSelection::Label { .. }
        | NodeSelection::NearSurface { .. }
        | NodeSelection::Nodes(_) => false,
    }
}

/// In the words of a sentence about a wall.
fn carried_by(carrier: Option<u32>, segments: &[PlannedSegment]) -> String {
    match carrier {
        Some(segment) => format!("that segment {:?} carries", segments[segment as usize].name),
        None => "that stays".to_owned(),
    }
}

/// Warnings of walls that rotate with their segments, whose normals small strain keeps fixed.
pub(super) fn warn_of_rotated_walls(scene: &Scene) -> Vec<Warning> {
    if !scene.settings.method.properties().is_small_strain {
        return Vec::new();
    }
    let segments = (0_u32..).zip(&scene.segments);
    segments
        .filter_map(|(number, segment)| {
            let nodes = scene.conditions.carried_by(number);
            let warning = normal_turned(&segment.name, &segment.movement, 1)?;
            (nodes > 0).then(|| warning.with("nodes", nodes as f64))
        })
        .collect()
}

/// The first segment that carries a wall and turns by more than the second order bears.
pub(super) fn rotation_beyond_second_order(scene: &Scene) -> Option<String> {
    let mut segments = (0_u32..).zip(&scene.segments);
    let turns = |segment: &PlannedSegment| is_normal_turned(&segment.movement);
    let carries = |number: u32| scene.conditions.carried_by(number) > 0;
    let turned = segments.find(|(number, segment)| turns(segment) && carries(*number))?;
    Some(turned.1.name.clone())
}

/// Whether the normals of walls carried by a segment turn by more than the second order, and so what linearity leaves out, is known for.
pub fn is_normal_turned(movement: &RigidMovement) -> bool {
    movement.angle().to_degrees() > NORMAL_TURNED_AT_SECOND_ORDER_DEG
}

/// The warning of a segment that carries a wall and turns by more than an answer of first or second order bears.
pub fn normal_turned(name: &str, movement: &RigidMovement, order: u8) -> Option<Warning> {
    let limit_deg = if order > 1 { NORMAL_TURNED_AT_SECOND_ORDER_DEG } else { NORMAL_TURNED_DEG };
    let degrees = movement.angle().to_degrees();
    let detail = format!(
        "segment {name:?} carries a wall and turns by {degrees:.1} degrees, and small strain holds its nodes across \
         the wall as it lay before"
    );
    let warning = Warning::new(NORMAL_TURNED, detail).with("rotation_deg", degrees);
    (degrees > limit_deg).then_some(warning)
}
