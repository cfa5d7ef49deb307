//! Thickness-preserving warp: tissue moves with the nearest bone. Ulusoy et al. 2010 call it the conventional method
//! (docs/methods.md#thickness-warp, docs/verification.md#v36).
//!
//! b = the point of the bone under the tissue that is nearest to x, T = the movement of the bone there
//! u(x) = T(x) - x, so that |T(x) - T(b)| = |x - b|: every point keeps its distance to its bone.
//!
//! Bone is where faces of the tissue are held altogether: joined to a segment, fixed, or prescribed. A
//! prescribed face has no rotation of its own: x takes the displacement of b, and keeps the vector to it. Of a
//! face between two bones each has what is nearest to its corners: the part between them, the middles of the edges beside them and the
//! middle of the face. Held nodes move as they are held.
//!
//! Between bones that move apart the warp jumps. A point as near to several bones takes the mean of their movements, however space is
//! turned, shifted or numbered. With a blend radius r, each bone at a distance d up to
//! r above that of the nearest one, d_0, takes part with the weight (1 - (d - d_0) / r)^2; thickness is
//! then kept only where one bone is in reach.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::problem::{Equilibrium, ModelError};
use crate::boundary::{Conditions, Constraint, NodeClass};
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{ClosestPoint, SurfaceSearch, TriangleSurface, Vector, VolumeMesh, Warning};
use crate::solver::SolveReport;

/// Parameters of a warp.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThicknessWarp {
    /// In mm; 0 follows the nearest bone alone.
    pub blend_radius: f64,
}

/// Distances to bones that differ by less than this share are the same.
const AS_NEAR: f64 = 1e-9;

/// A jump across an edge above this many mm is reported.
const TOLD: f64 = 1e-6;

/// Tissue and the bones that it lies on.
pub struct Warped<'a> {
    pub mesh: &'a VolumeMesh,
    pub conditions: &'a Conditions,
    /// The displacement in mm that the movement of a segment gives a point.
    pub movement: &'a (dyn Fn(u32, &Vector) -> Vector + Sync),
    /// Asked for, and met by what has no residual.
    pub wanted_residual: f64,
}

/// A rigid body of bone.
struct Bone {
    mover: Mover,
    /// Its points are those of [`Bones`].
    surface: TriangleSurface,
    search: SurfaceSearch,
}

/// What the tissue lies on.
struct Bones {
    all: Vec<Bone>,
    /// The displacement in mm of the nodes that are held, and after them of the points in faces between two bones.
    held: Vec<Option<Vector>>,
}

/// The surfaces of bones while they are gathered.
struct BoneFaces<'a> {
    warped: &'a Warped<'a>,
    /// The nodes of the mesh, and points in faces between two bones.
    points: Vec<Vector>,
    held: Vec<Option<Vector>>,
    triangles: BTreeMap<Mover, Vec<[u32; 3]>>,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Mover {
    Segment(u32),
    /// Each node as it is held.
    Nodes,
    Nothing,
}

/// Where a node goes, and the bone that is nearest to it.
struct Followed {
    displacement: Vector,
    bone: usize,
}

impl Warped<'_> {
    /// The displacement of every node.
    pub fn solve(&self, warp: &ThicknessWarp) -> Result<Equilibrium, ModelError> {
        let bones = self.bones();
        if bones.all.is_empty() {
            return Err(ModelError::NoBone);
        }
        let is_in_cell = self.mesh.is_in_cell();
        let follow = |node: usize| match is_in_cell[node] {
            true => self.follow(&bones, node, warp.blend_radius),
            false => Followed { displacement: Vector::zeros(), bone: 0 },
        };
        let followed: Vec<Followed> =
            (0..self.mesh.nodes.len()).into_par_iter().map(follow).collect();
        let warnings = [self.ignored(), self.off_bone(&bones), self.jumps(&followed)];
        Ok(Equilibrium {
            displacement: followed.into_iter().map(|followed| followed.displacement).collect(),
            reactions: vec![Vector::zeros(); self.conditions.constraints.len()],
            solver: SolveReport::without_equations(
                "a warp solves no equations",
                0,
                self.wanted_residual,
            ),
            warnings: warnings.into_iter().flatten().collect(),
            states: Default::default(),
        })
    }

    /// For each node its prescribed displacement, if it is fully constrained.
    fn fully_constrained(&self) -> Vec<Option<Vector>> {
        let mut held = vec![None; self.mesh.nodes.len()];
        for constraint in
            self.conditions.constraints.iter().filter(|constraint| constraint.count() == 3)
        {
            held[constraint.node as usize] = Some(constraint.axes() * constraint.values());
        }
        held
    }

    fn mover(&self, node: u32) -> Mover {
        match self.conditions.classes[node as usize] {
            NodeClass::Joined(segment) => Mover::Segment(segment),
            NodeClass::Fixed => Mover::Nothing,
            NodeClass::Prescribed | NodeClass::Sliding | NodeClass::Free => Mover::Nodes,
        }
    }

    /// The boundary faces all of whose corners are held, by what moves them.
    fn bones(&self) -> Bones {
        let (points, held) = (self.mesh.nodes.clone(), self.fully_constrained());
        let mut faces = BoneFaces { warped: self, points, held, triangles: BTreeMap::new() };
        for face in self.mesh.boundary_faces() {
            if face.nodes().iter().all(|&node| faces.held[node as usize].is_some()) {
                faces.add(&face);
            }
        }
        let BoneFaces { points, held, triangles, .. } = faces;
        let bone = |(mover, triangles)| {
            let surface = TriangleSurface { points: points.clone(), triangles, node_ids: None };
            let search = SurfaceSearch::new(&surface).ok()?;
            Some(Bone { mover, surface, search })
        };
        Bones { all: triangles.into_iter().filter_map(bone).collect(), held }
    }

    fn follow(&self, bones: &Bones, node: usize, radius: f64) -> Followed {
        let Bones { all, held } = bones;
        let x = self.mesh.nodes[node];
        let mut in_reach = Vec::with_capacity(all.len());
        let mut nearest = f64::INFINITY;
        for (number, candidate) in all.iter().enumerate() {
            let limit = nearest * (1.0 + AS_NEAR) + radius;
            let Some(closest) = candidate.search.closest_within(&x, limit) else { continue };
            nearest = nearest.min(closest.distance);
            in_reach.push((number, closest));
        }
        let as_near = AS_NEAR * nearest;
        let is_nearest =
            |(_, closest): &&(usize, ClosestPoint)| closest.distance - nearest <= as_near;
        let bone = in_reach.iter().find(is_nearest).map_or(0, |(number, _)| *number);
        if let Some(displacement) = held[node] {
            return Followed { displacement, bone };
        }
        let (mut sum, mut weights) = (Vector::zeros(), 0.0);
        for (number, closest) in in_reach {
            let weight = match closest.distance - nearest {
                farther if farther <= as_near => 1.0,
                farther if farther < radius => (1.0 - farther / radius).powi(2),
                _ => continue,
            };
            let displacement = match all[number].mover {
                Mover::Segment(segment) => (self.movement)(segment, &x),
                Mover::Nothing => Vector::zeros(),
                Mover::Nodes => {
                    let corners = all[number].surface.triangles[closest.triangle];
                    let of = |point: u32| held[point as usize].unwrap_or_default();
                    corners
                        .iter()
                        .zip(closest.barycentric)
                        .fold(Vector::zeros(), |sum, (&corner, part)| sum + of(corner) * part)
                }
            };
            sum += displacement * weight;
            weights += weight;
        }
        Followed { displacement: sum / weights, bone }
    }

    /// Statements of a case that a warp ignores.
    fn ignored(&self) -> Option<Warning> {
        let partly = |class: NodeClass| {
            let of_class = |constraint: &&Constraint| {
                self.conditions.classes[constraint.node as usize] == class
            };
            let constraints =
                self.conditions.constraints.iter().filter(|constraint| constraint.count() < 3);
            constraints.filter(of_class).count() as f64
        };
        let (sliding, prescribed) = (partly(NodeClass::Sliding), partly(NodeClass::Prescribed));
        let detail = "a warp knows bone that moves and nothing else: materials, sliding nodes and nodes \
             prescribed in some directions only are ignored";
        let warning = Warning::new("conditions-ignored", detail).with("sliding_nodes", sliding);
        Some(warning.with("partly_prescribed_nodes", prescribed))
    }

    /// Held nodes that bound no bone face: they move alone.
    fn off_bone(&self, bones: &Bones) -> Option<Warning> {
        let mut alone: Vec<bool> = bones.held.iter().map(Option::is_some).collect();
        let corners = bones.all.iter().flat_map(|bone| bone.surface.triangles.iter().flatten());
        corners.for_each(|&corner| alone[corner as usize] = false);
        let count = alone[..self.mesh.nodes.len()].iter().filter(|alone| **alone).count();
        let detail = format!(
            "{count} moved or fixed nodes bound no face whose nodes are all moved or fixed: the tissue around does not follow them"
        );
        (count > 0).then(|| Warning::new("held-off-bone", detail).with("nodes", count as f64))
    }

    /// Edges whose ends follow different bones.
    fn jumps(&self, followed: &[Followed]) -> Option<Warning> {
        let (mut largest, mut worst, mut torn) = (0.0, (0, 0), Vec::new());
        for (shape, nodes) in self.mesh.cells.iter() {
            for edge in shape.edges() {
                let [a, b] = edge.map(|local| nodes[local]);
                let [u, v] = [a, b].map(|node| &followed[node as usize]);
                if u.bone == v.bone {
                    continue;
                }
                let jump = (u.displacement - v.displacement).norm();
                let length = (self.mesh.nodes[a as usize] - self.mesh.nodes[b as usize]).norm();
                if jump > largest {
                    (largest, worst) = (jump, (a.min(b), a.max(b)));
                }
                if jump > length {
                    torn.push((a.min(b), a.max(b)));
                }
            }
        }
        torn.sort_unstable();
        torn.dedup();
        let detail = format!(
            "neighbours that follow different bones part by up to {largest:.3} mm, between nodes {} and {}; \
             {} edges by more than their length",
            worst.0,
            worst.1,
            torn.len()
        );
        let warning = Warning::new("warp-jumps", detail).with("largest_mm", largest);
        (largest > TOLD).then(|| warning.with("torn_edges", torn.len() as f64))
    }
}

impl BoneFaces<'_> {
    /// A face whose nodes are all held.
    fn add(&mut self, face: &BoundaryFace) {
        let nodes = face.nodes();
        let mover = self.warped.mover(nodes[0]);
        if nodes.iter().all(|&node| self.warped.mover(node) == mover) {
            let triangles = face.triangles(&self.warped.mesh.nodes);
            self.triangles.entry(mover).or_default().extend(triangles);
            return;
        }
        let count = nodes.len();
        let middle = self.middle_of(nodes);
        let of_edges: Vec<u32> =
            (0..count).map(|i| self.middle_of(&[nodes[i], nodes[(i + 1) % count]])).collect();
        for (i, &node) in nodes.iter().enumerate() {
            let own = self.triangles.entry(self.warped.mover(node)).or_default();
            own.push([node, of_edges[i], middle]);
            own.push([node, middle, of_edges[(i + count - 1) % count]]);
        }
    }

    /// A point that lies and moves as the mean of nodes that are held.
    fn middle_of(&mut self, nodes: &[u32]) -> u32 {
        let share = 1.0 / nodes.len() as f64;
        let position = nodes.iter().map(|&node| self.points[node as usize]).sum::<Vector>() * share;
        let moved =
            nodes.iter().filter_map(|&node| self.held[node as usize]).sum::<Vector>() * share;
        self.points.push(position);
        self.held.push(Some(moved));
        self.points.len() as u32 - 1
    }
}
