//! A checked scene on a mesh that was refined where an estimate asked for it.
//!
//! Everything is carried on from the scene, and nothing is asked of the case again: cells keep the material, the fibre and
//! the tissue of an image of the cell that they are cut from, so that a finer mesh is a better answer to the same question. New
//! nodes belong to the conditions to which their face of the boundary belongs (`mesh::bisection::Carrier`): those of a segment go
//! where it takes them, prescribed values and normals of walls are the means of both ends. Forces at nodes stay at the nodes
//! that have them; tractions, pressures and gravity act on the finer faces and cells.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::imaged_tissue::ImagedTissue;
use super::muscle_field::MuscleField;
use super::scene::Scene;
use super::skin::Skin;
use super::stated::{StatedCondition, StatedHold};
use crate::boundary::conditions::combine;
use crate::boundary::{
    ConditionError, Conditions, Constraint, HeldNodes, WallNode, connected_parts,
};
use crate::mesh::bisection::{Bisection, Carrier};
use crate::mesh::connectivity::Faces;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::discretisation_error::DistributedLoads;
use crate::model::fem::inner_stress::{CellStress, InnerStress};
use crate::model::fem::loads::{add_face_load, add_gravity};
use crate::model::fem::membrane::Membrane;
use crate::model::problem::InvertedCell;

/// Normals of the two ends of an edge with a smaller cosine are those of two walls.
const SAME_WALL: f64 = 0.7;

/// Forces below this share of the largest are rounding.
const ROUNDING: f64 = 1e-9;

/// Why a scene has none on a finer mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotRefined {
    #[error(transparent)]
    Conditions(#[from] ConditionError),
    #[error(transparent)]
    Inverted(#[from] InvertedCell),
    #[error("loads between the nodes of quadratic tetrahedra are not carried on to a finer mesh")]
    Quadratic,
}

impl Scene {
    /// The same scene on a finer mesh, which began with the mesh of this one. Skin, classes and loads are those of this
    /// scene, and its nodes keep their numbers.
    pub fn on(&self, bisection: &Bisection) -> Result<Scene, NotRefined> {
        if !self.is_first_order() && self.distributed != DistributedLoads::default() {
            return Err(NotRefined::Quadratic);
        }
        let carrier = Carrier::new(bisection);
        let mesh = Arc::new(carrier.mesh());
        let faces = Faces::new(&mesh);
        let boundary = mesh.boundary_of(&faces);
        let finer = FinerScene { scene: self, carrier: &carrier, mesh: &mesh, boundary: &boundary };

        // 1. What holds the nodes.
        let stated = finer.stated();
        let mut conditions = combine(&mesh.nodes, &finer.held(&stated))?;
        conditions.warnings.clone_from(&self.conditions.warnings);

        // 2. The skin, and what hangs together.
        let skin = finer.skin();
        let parts = connected_parts(&mesh, &faces.parts(), &conditions, skin.nodes());

        // 3. Tissue and loads.
        let mut scene = Scene {
            skin,
            conditions,
            stated,
            parts,
            regions: self.regions.clone(),
            region_of_cell: carrier.of_cells(&self.region_of_cell),
            materials: self.materials.clone(),
            material_of_cell: carrier.of_cells(&self.material_of_cell),
            pressure_of_cell: carrier.of_cells(&self.pressure_of_cell),
            imaged: self.imaged.as_ref().map(|imaged| finer.imaged(imaged)),
            fibres: carrier.of_cells_if_any(&self.fibres),
            membrane: self.membrane.as_ref().map(|membrane| finer.membrane(membrane)),
            element: self.element,
            segments: self.segments.clone(),
            bones: self.bones.clone(),
            forces: finer.forces_at_nodes()?,
            distributed: finer.distributed(),
            near: None,
            muscles: finer.muscles(),
            muscle_tissue: self.muscle_tissue,
            landmarks: self.landmarks.clone(),
            allow_unfixed: self.allow_unfixed,
            settings: self.settings.clone(),
            warnings: self.warnings.clone(),
            boundary: boundary.clone(),
            mesh: mesh.clone(),
        };
        let consistent = consistent(&scene)?;
        scene.forces.iter_mut().zip(consistent).for_each(|(force, own)| *force += own);
        Ok(scene)
    }
}

impl Scene {
    /// Nodes at which a force acts that no load between nodes stands for.
    pub(super) fn nodes_with_forces(&self) -> Result<Vec<u32>, InvertedCell> {
        let between = consistent(self)?;
        let largest = self.forces.iter().map(Vector::norm).fold(0.0, f64::max);
        let acts = |all: &Vector, between: &Vector| (all - between).norm() > ROUNDING * largest;
        let pairs = (0_u32..).zip(self.forces.iter().zip(&between));
        Ok(pairs.filter(|(_, (all, between))| acts(all, between)).map(|(node, _)| node).collect())
    }
}

/// The forces that stand for loads which act between nodes too, in mN.
fn consistent(scene: &Scene) -> Result<Vec<Vector>, InvertedCell> {
    let mut forces = vec![Vector::zeros(); scene.mesh.nodes.len()];
    let DistributedLoads { faces, acceleration, inner } = &scene.distributed;
    for (faces, load) in faces {
        add_face_load(&scene.mesh, faces, *load, &mut forces);
    }
    if *acceleration != Vector::zeros() {
        add_gravity(&scene.tissue(), *acceleration, &mut forces)?;
    }
    scene.add_inner_forces(inner, &mut forces)?;
    Ok(forces)
}

/// A scene, and the finer mesh.
struct FinerScene<'a> {
    scene: &'a Scene,
    carrier: &'a Carrier<'a>,
    mesh: &'a VolumeMesh,
    boundary: &'a [BoundaryFace],
}

impl FinerScene<'_> {
    /// The conditions with the new nodes that belong to them.
    fn stated(&self) -> Vec<StatedCondition> {
        let carried = |stated: &StatedCondition| {
            let nodes = self.carrier.nodes(&stated.nodes);
            let constraints = match &stated.constraints {
                StatedHold::Walls(across) => StatedHold::Walls(self.walls(stated, across, &nodes)),
                same @ (StatedHold::Components(_) | StatedHold::Joined | StatedHold::Fixed) => {
                    same.clone()
                }
            };
            StatedCondition { nodes, constraints, ..stated.clone() }
        };
        self.scene.stated.iter().map(carried).collect()
    }

    /// The normals of the walls of each node.
    fn walls(
        &self,
        stated: &StatedCondition,
        across: &[Vec<Vector>],
        nodes: &[u32],
    ) -> Vec<Vec<Vector>> {
        let mut of_node: BTreeMap<u32, Vec<Vector>> =
            stated.nodes.iter().copied().zip(across.iter().cloned()).collect();
        let first_new = self.scene.mesh.nodes.len() as u32;
        let is_new = |node: &&u32| **node >= first_new;
        for &node in nodes.iter().filter(is_new) {
            let ends = self.carrier.parents()[(node - first_new) as usize];
            let [a, b] = ends.map(|end| of_node.get(&end).map_or(&[][..], Vec::as_slice));
            let between = between_walls(a, b);
            of_node.insert(node, between);
        }
        nodes.iter().map(|node| of_node.get(node).cloned().unwrap_or_default()).collect()
    }

    /// What the conditions hold, as case and plan would state it of the finer mesh.
    fn held(&self, stated: &[StatedCondition]) -> HeldNodes {
        let movement = |segment: &crate::plan::PlannedSegment| (Vec::new(), segment.movement);
        let mut held = HeldNodes {
            joined: self.scene.segments.iter().map(movement).collect(),
            ..HeldNodes::default()
        };
        let prescribed = self.prescribed();
        for StatedCondition { segment, nodes, constraints, .. } in stated {
            match constraints {
                StatedHold::Components(components) => {
                    let value = |&node: &u32| {
                        let place = prescribed[node as usize];
                        (node, std::array::from_fn(|k| components[k].then_some(place[k])))
                    };
                    held.prescribed.extend(nodes.iter().map(value));
                }
                StatedHold::Joined => {
                    let joined = segment.and_then(|number| held.joined.get_mut(number as usize));
                    joined.into_iter().for_each(|(joined, _)| joined.extend(nodes));
                }
                StatedHold::Fixed => held.fixed.extend(nodes),
                StatedHold::Walls(across) => {
                    held.sliding.extend(nodes.iter().zip(across).map(|(&node, across)| WallNode {
                        node,
                        across: across.clone(),
                        carrier: *segment,
                    }));
                }
            }
        }
        held
    }

    /// For each node what is prescribed there, and between such nodes the mean; what else is held stands beside it.
    fn prescribed(&self) -> Vec<Vector> {
        let Conditions { constraints, .. } = &self.scene.conditions;
        let mut values = vec![Vector::zeros(); self.scene.mesh.nodes.len()];
        let displaced = |constraint: &Constraint| constraint.axes() * constraint.values();
        constraints
            .iter()
            .for_each(|constraint| values[constraint.node as usize] = displaced(constraint));
        self.carrier.vectors(&values)
    }

    /// Finer boundary faces that are part of some of the first boundary, with their numbers among these.
    fn parts_of(&self, chosen: &BTreeMap<usize, usize>) -> Vec<(BoundaryFace, usize)> {
        let part = |face: &BoundaryFace| Some((*face, *chosen.get(&self.carrier.face(face)?)?));
        self.boundary.iter().filter_map(part).collect()
    }

    /// The places of faces under the numbers of the first boundary.
    fn numbered<'b>(&self, faces: impl Iterator<Item = &'b [u32]>) -> BTreeMap<usize, usize> {
        faces.enumerate().filter_map(|(place, f)| Some((self.carrier.face_of(f)?, place))).collect()
    }

    fn skin(&self) -> Skin {
        let Skin { surface, regions, off } = &self.scene.skin;
        let nodes = self.scene.skin.nodes();
        let corners = |points: &[u32; 3]| points.map(|point| nodes[point as usize]);
        let triangles: Vec<[u32; 3]> = surface.triangles.iter().map(corners).collect();
        let chosen = self.numbered(triangles.iter().map(|t| &t[..]));
        let faces: Vec<BoundaryFace> = self.parts_of(&chosen).into_iter().map(|(f, _)| f).collect();
        let surface = self.mesh.surface_of(&faces);
        let finer = surface.node_ids.clone().unwrap_or_default();
        let carried = |points: &Vec<u32>| {
            let set: Vec<u32> = points.iter().map(|&point| nodes[point as usize]).collect();
            let of_region = self.carrier.nodes(&set).into_iter();
            let point = |node: u32| finer.binary_search(&node).ok().map(|point| point as u32);
            of_region.filter_map(point).collect()
        };
        let regions =
            regions.iter().map(|(name, points)| (name.clone(), carried(points))).collect();
        Skin { surface, regions, off: off.clone() }
    }

    fn membrane(&self, membrane: &Membrane) -> Membrane {
        let chosen = self.numbered(membrane.triangles.iter().map(|t| &t[..]));
        let mut finer =
            Membrane { sheet: membrane.sheet, triangles: Vec::new(), lines: Vec::new() };
        for (face, place) in self.parts_of(&chosen) {
            finer.triangles.extend(face.triangles(&self.mesh.nodes));
            finer.lines.extend(membrane.lines.get(place));
        }
        finer
    }

    fn imaged(&self, imaged: &ImagedTissue) -> ImagedTissue {
        ImagedTissue {
            mean: self.carrier.of_cells(&imaged.mean),
            tissue_of_cell: self.carrier.of_cells(&imaged.tissue_of_cell),
            ..imaged.clone()
        }
    }

    fn distributed(&self) -> DistributedLoads {
        let DistributedLoads { faces, acceleration, inner } = &self.scene.distributed;
        let finer = |faces: &Vec<BoundaryFace>| {
            let chosen = self.numbered(faces.iter().map(BoundaryFace::nodes));
            self.parts_of(&chosen).into_iter().map(|(face, _)| face).collect()
        };
        let faces = faces.iter().map(|(faces, load)| (finer(faces), *load)).collect();
        let inner = InnerStress {
            growth: self.carrier.of_cells_if_any(&inner.growth),
            active: self.carrier.of_cells_if_any(&inner.active),
        };
        DistributedLoads { faces, acceleration: *acceleration, inner }
    }

    fn muscles(&self) -> Vec<MuscleField> {
        let first: Vec<u32> = (0..self.scene.mesh.cells.len() as u32).collect();
        let roots = self.carrier.of_cells(&first);
        let finer = |muscle: &MuscleField| {
            let of_root: BTreeMap<u32, CellStress> =
                muscle.cells.iter().map(|own| (own.cell, *own)).collect();
            let of_cell = |(cell, root): (u32, &u32)| {
                of_root.get(root).map(|own| CellStress { cell, ..*own })
            };
            let cells = (0..).zip(&roots).filter_map(of_cell).collect();
            MuscleField { cells, ..muscle.clone() }
        };
        self.scene.muscles.iter().map(finer).collect()
    }

    /// The forces that act at nodes alone, in mN; none at new ones.
    fn forces_at_nodes(&self) -> Result<Vec<Vector>, InvertedCell> {
        let between = consistent(self.scene)?;
        // Those of quadratic elements go on with edge nodes, on which no force acts alone.
        let own = self.scene.forces.iter().zip(between).map(|(all, between)| all - between);
        let mut forces: Vec<Vector> = own.collect();
        forces.resize(self.mesh.nodes.len(), Vector::zeros());
        Ok(forces)
    }
}

/// The normals of walls that both ends of an edge have, each the mean of both.
fn between_walls(a: &[Vector], b: &[Vector]) -> Vec<Vector> {
    let common = |normal: &Vector| {
        let nearest = b.iter().max_by(|x, y| x.dot(normal).total_cmp(&y.dot(normal)))?;
        (nearest.dot(normal) > SAME_WALL).then(|| (normal + nearest).normalize())
    };
    a.iter().filter_map(common).collect()
}
