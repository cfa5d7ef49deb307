//! A checked scene: nothing optional, nothing left to refuse.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::case::{Case, ElementChoice, Load, Plan, Prescribed, Settings, SlidingNormal};
use super::problem::{Problems, SceneErrors};
use super::skin::{self, Skin};
use crate::boundary::conditions::combine;
use crate::boundary::support::loose_parts;
use crate::boundary::{Conditions, HeldNodes, NodeClass, NodeSelection, Selector, sliding, tearing};
use crate::material::LinearElastic;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{CellShape, Vector, VolumeMesh, Warning};
use crate::model::assembly::Tissue;
use crate::model::load::{FaceLoad, add_face_load, add_gravity};
use crate::model::stiffness::Dilatation;
use crate::plan::{PlannedSegment, RigidMovement};

/// Poisson's ratio above which elements without mean dilatation are known to lock (VERIFICATION V.4, V.29).
const LOCKING: f64 = 0.45;

/// Mesh, materials and conditions, ready to be solved.
pub struct Scene {
    pub mesh: Arc<VolumeMesh>,
    pub skin: Skin,
    /// Region names, and for each cell its entry.
    pub regions: Vec<String>,
    pub region_of_cell: Vec<u16>,
    /// For each region.
    pub materials: Vec<LinearElastic>,
    pub element: ElementChoice,
    pub conditions: Conditions,
    /// Segments by the number in `NodeClass::Joined`, with the movement each makes.
    pub segments: Vec<PlannedSegment>,
    /// For each node, in mN.
    pub forces: Vec<Vector>,
    pub landmarks: BTreeMap<String, Vector>,
    pub settings: Settings,
    /// What a reader must know before anything is solved: overlaps, tearing, locking.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// Checks a case and a plan together; says everything that is wrong, not the first thing only.
    pub fn new(case: &Case, plan: &Plan, settings: &Settings) -> Result<Scene, SceneErrors> {
        let boundary = case.volume.boundary_faces();
        let mut check = Check::new(case, &boundary);

        // 1. Tissue.
        let (regions, region_of_cell) = check.regions();
        let materials = check.materials(&regions);

        // 2. What every node is held to.
        let (segments, held) = check.held_nodes(plan, settings.sliding);
        let conditions = check.conditions(&held);

        // 3. The skin and what acts on the tissue.
        let skin = check.skin(&conditions);
        let mut scene = Scene {
            mesh: case.volume.clone(),
            skin,
            regions,
            region_of_cell,
            materials,
            element: settings.element,
            conditions,
            segments,
            forces: vec![Vector::zeros(); case.volume.nodes.len()],
            landmarks: case.landmarks.clone(),
            settings: settings.clone(),
            warnings: Vec::new(),
        };
        check.problems.give_up_if_any()?;
        check.add_loads(plan, &mut scene);

        // 4. What cannot be solved, and what a reader must know.
        check.support(&scene);
        check.problems.give_up_if_any()?;
        scene.warnings = scene.conditions.warnings.clone();
        scene.warnings.extend(check.warnings);
        scene.warnings.extend(tearing::tearing(&scene.mesh, &scene.conditions.holds));
        scene.warnings.extend(scene.locking());
        Ok(scene)
    }

    /// The tissue as the finite elements see it.
    pub fn tissue(&self) -> Tissue<'_> {
        Tissue {
            mesh: &self.mesh,
            materials: &self.materials,
            material_of_cell: &self.region_of_cell,
            dilatation: match self.element {
                ElementChoice::Plain => |_| Dilatation::Pointwise,
                ElementChoice::Auto | ElementChoice::MeanDilatation => |shape| match shape {
                    CellShape::Tet4 => Dilatation::Pointwise,
                    CellShape::Hex8 | CellShape::Wedge6 => Dilatation::Mean,
                },
            },
        }
    }

    /// The elements in use, e.g. `hex8 mean dilatation`.
    pub fn elements(&self) -> Vec<String> {
        let dilatation = self.tissue().dilatation;
        [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6]
            .into_iter()
            .filter(|shape| self.mesh.cells.iter().any(|(other, _)| other == *shape))
            .map(|shape| match dilatation(shape) {
                Dilatation::Pointwise => format!("{} plain", shape.name()),
                Dilatation::Mean => format!("{} mean dilatation", shape.name()),
            })
            .collect()
    }

    /// How many nodes each class has, by the name of the segment or of the class.
    pub fn class_counts(&self) -> BTreeMap<String, usize> {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for class in &self.conditions.classes {
            *counts.entry(self.class_name(*class)).or_default() += 1;
        }
        counts
    }

    /// `joined:SEGMENT`, or the plain name of the class.
    pub fn class_name(&self, class: NodeClass) -> String {
        match class {
            NodeClass::Joined(segment) => format!("joined:{}", self.segments[segment as usize].name),
            other => other.name().to_owned(),
        }
    }

    fn locking(&self) -> Option<Warning> {
        let dilatation = self.tissue().dilatation;
        let cells = self.mesh.cells.iter().zip(&self.region_of_cell);
        let locks = |shape: CellShape, region: u16| {
            let nu = self.materials[region as usize].poisson_ratio();
            nu > LOCKING && dilatation(shape) == Dilatation::Pointwise
        };
        let locking = cells.clone().filter(|((shape, _), region)| locks(*shape, **region)).count();
        let largest = self.materials.iter().map(LinearElastic::poisson_ratio).fold(0.0, f64::max);
        let detail = format!(
            "{locking} plain cells have a Poisson ratio above {LOCKING}: they lock, and the skin moves too little"
        );
        let warning = Warning::new("locking", detail).with("cells", locking as f64);
        (locking > 0).then(|| warning.with("largest_poisson_ratio", largest))
    }
}

/// The state of one check: what is asked, and what was found wrong so far.
struct Check<'a> {
    case: &'a Case,
    boundary: &'a [BoundaryFace],
    boundary_nodes: Vec<u32>,
    problems: Problems,
    warnings: Vec<Warning>,
}

impl<'a> Check<'a> {
    fn new(case: &'a Case, boundary: &'a [BoundaryFace]) -> Self {
        let mut boundary_nodes: Vec<u32> = boundary.iter().flat_map(|face| face.nodes()).copied().collect();
        boundary_nodes.sort_unstable();
        boundary_nodes.dedup();
        let problems = Problems::default();
        Check { case, boundary, boundary_nodes, problems, warnings: Vec::new() }
    }

    fn select(&mut self, selection: &NodeSelection, pointer: &str) -> Vec<u32> {
        let selector = Selector {
            mesh: &self.case.volume,
            surfaces: &self.case.surfaces,
            boundary_nodes: &self.boundary_nodes,
        };
        let selected = selector.select(selection);
        selected.unwrap_or_else(|error| {
            self.problems.selection(pointer, &error);
            Vec::new()
        })
    }

    fn regions(&mut self) -> (Vec<String>, Vec<u16>) {
        let cells = self.case.volume.cells.len();
        let Some(stated) = &self.case.regions else {
            return (vec!["tissue".to_owned()], vec![0; cells]);
        };
        let Some(labels) = self.case.volume.cell_labels.get(&stated.array) else {
            let known = self.case.volume.cell_labels.keys().cloned().collect::<Vec<_>>().join(", ");
            let detail = format!("the mesh has no integer cell array {:?}; it has: {known}", stated.array);
            self.problems.add("/case/regions/array", "unknown-array", detail);
            return (vec!["tissue".to_owned()], vec![0; cells]);
        };
        let mut values = labels.clone();
        values.sort_unstable();
        values.dedup();
        for value in stated.names.keys().filter(|value| values.binary_search(value).is_err()) {
            let detail = format!("no cell has the value {value} in array {:?}", stated.array);
            self.problems.add(format!("/case/regions/names/{value}"), "unknown-region", detail);
        }
        let mut names: Vec<String> = Vec::new();
        let region_of_value: Vec<u16> = values
            .iter()
            .map(|value| {
                let name = stated.names.get(value).cloned().unwrap_or_else(|| value.to_string());
                let known = names.iter().position(|other| *other == name);
                known.unwrap_or_else(|| {
                    names.push(name);
                    names.len() - 1
                }) as u16
            })
            .collect();
        let place = |label: &i64| values.binary_search(label).expect("values are the labels without repeats");
        (names, labels.iter().map(|label| region_of_value[place(label)]).collect())
    }

    fn materials(&mut self, regions: &[String]) -> Vec<LinearElastic> {
        let stated = &self.case.materials;
        for name in stated.keys().filter(|name| *name != "*" && !regions.contains(name)) {
            let detail = format!("no region is called {name:?}; there are: {}", regions.join(", "));
            self.problems.add(format!("/case/materials/{name}"), "unknown-region", detail);
        }
        let mut materials = Vec::new();
        for region in regions {
            match stated.get(region).or_else(|| stated.get("*")) {
                Some(material) => materials.push(*material),
                None => {
                    let detail = format!("region {region:?} has no material, and there is none for \"*\"");
                    self.problems.add("/case/materials", "missing-material", detail);
                }
            }
        }
        materials
    }

    fn held_nodes(&mut self, plan: &Plan, sliding: bool) -> (Vec<PlannedSegment>, HeldNodes) {
        let mut held = HeldNodes::default();
        let segments = self.segments(plan, &mut held);
        for (index, selection) in self.case.fixed.iter().enumerate() {
            held.fixed.extend(self.select(selection, &format!("/case/fixed/{index}")));
        }
        if sliding {
            self.sliding(&mut held);
        }
        self.prescribed(plan, &mut held);
        (segments, held)
    }

    /// The segments of the case with their movements, then those that the plan names after node sets.
    fn segments(&mut self, plan: &Plan, held: &mut HeldNodes) -> Vec<PlannedSegment> {
        let mut segments: Vec<PlannedSegment> = Vec::new();
        for (index, segment) in self.case.segments.iter().enumerate() {
            if segments.iter().any(|other| other.name == segment.name) {
                let detail = format!("segment {:?} is defined twice", segment.name);
                self.problems.add(format!("/case/segments/{index}/name"), "duplicate-segment", detail);
            }
            let planned = plan.segments.iter().find(|planned| planned.name == segment.name);
            let movement = planned.map_or_else(RigidMovement::default, |planned| planned.movement);
            let nodes = self.select(&segment.nodes, &format!("/case/segments/{index}/nodes"));
            held.joined.push((nodes, movement));
            segments.push(PlannedSegment { name: segment.name.clone(), movement });
        }
        for (index, planned) in plan.segments.iter().enumerate() {
            let pointer = format!("/plan/segments/{index}/name");
            if plan.segments[..index].iter().any(|other| other.name == planned.name) {
                let detail = format!("segment {:?} is named twice", planned.name);
                self.problems.add(pointer, "duplicate-segment", detail);
            } else if !segments.iter().any(|segment| segment.name == planned.name) {
                match self.case.volume.node_set(&planned.name) {
                    Some(nodes) if !nodes.is_empty() => {
                        held.joined.push((nodes.to_vec(), planned.movement));
                        segments.push(planned.clone());
                    }
                    _ => {
                        let known: Vec<&str> = segments.iter().map(|segment| segment.name.as_str()).collect();
                        let detail = format!(
                            "the case has neither a segment nor a node set {:?}; its segments: {}",
                            planned.name,
                            known.join(", ")
                        );
                        self.problems.add(pointer, "unknown-segment", detail);
                    }
                }
            }
        }
        segments
    }

    fn sliding(&mut self, held: &mut HeldNodes) {
        for (index, entry) in self.case.sliding.iter().enumerate() {
            let nodes = self.select(&entry.nodes, &format!("/case/sliding/{index}/nodes"));
            let normals = match entry.normal {
                SlidingNormal::Surface => sliding::wall_normals(&self.case.volume, self.boundary, &nodes),
                SlidingNormal::Direction(direction) => {
                    let unit: Vec<Vector> = direction.try_normalize(1e-12).into_iter().collect();
                    nodes.iter().map(|&node| (node, unit.clone())).collect()
                }
            };
            if let Some((node, _)) = normals.iter().find(|(_, normals)| normals.is_empty()) {
                let detail = format!("node {node} has no normal to be held across");
                self.problems.add(format!("/case/sliding/{index}/normal"), "sliding-normal-zero", detail);
            }
            held.sliding.extend(normals);
        }
    }

    fn prescribed(&mut self, plan: &Plan, held: &mut HeldNodes) {
        for (index, entry) in plan.prescribed.iter().enumerate() {
            let pointer = format!("/plan/prescribed/{index}");
            match entry {
                Prescribed::Uniform { nodes, displacement } => {
                    let nodes = self.select(nodes, &format!("{pointer}/nodes"));
                    held.prescribed.extend(nodes.iter().map(|&node| (node, *displacement)));
                }
                Prescribed::FromArray { nodes, array } => {
                    let nodes = self.select(nodes, &format!("{pointer}/nodes"));
                    let Some(values) = self.case.volume.node_vectors.get(array) else {
                        let detail = format!("the mesh has no point array {array:?} with 3 components");
                        self.problems.add(format!("{pointer}/array"), "unknown-array", detail);
                        continue;
                    };
                    let value = |node: u32| values[node as usize];
                    let whole = |node: u32| [value(node).x, value(node).y, value(node).z].map(Some);
                    held.prescribed.extend(nodes.iter().map(|&node| (node, whole(node))));
                }
            }
        }
    }

    fn conditions(&mut self, held: &HeldNodes) -> Conditions {
        combine(&self.case.volume.nodes, held).unwrap_or_else(|error| {
            self.problems.add("/plan", "plan-conflict", error.to_string());
            let classes = vec![NodeClass::Free; self.case.volume.nodes.len()];
            Conditions { classes, holds: Vec::new(), warnings: Vec::new() }
        })
    }

    fn skin(&mut self, conditions: &Conditions) -> Skin {
        let faces = match &self.case.skin {
            Some(selection) => {
                let nodes = self.select(selection, "/case/skin");
                self.faces_within(&nodes)
            }
            None => skin::default_faces(self.boundary, &conditions.classes, &mut self.warnings),
        };
        if faces.is_empty() && self.case.skin.is_some() {
            let detail = "no boundary face has all of its nodes in the selection".to_owned();
            self.problems.add("/case/skin", "empty-selection", detail);
        }
        let surface = self.case.volume.surface_of(&faces);
        let skin_nodes = surface.node_ids.clone().unwrap_or_default();
        let mut regions = BTreeMap::new();
        for (name, selection) in &self.case.skin_regions {
            let pointer = format!("/case/skin_regions/{name}");
            let nodes = self.select(selection, &pointer);
            let point_of = |node: &u32| skin_nodes.binary_search(node).ok().map(|point| point as u32);
            let points: Vec<u32> = nodes.iter().filter_map(point_of).collect();
            if points.is_empty() && !nodes.is_empty() {
                let detail = "no node of the selection is on the skin".to_owned();
                self.problems.add(pointer, "empty-selection", detail);
            }
            regions.insert(name.clone(), points);
        }
        Skin { surface, regions }
    }

    /// The boundary faces all of whose nodes are listed.
    fn faces_within(&self, nodes: &[u32]) -> Vec<BoundaryFace> {
        let listed = |node: &u32| nodes.binary_search(node).is_ok();
        self.boundary.iter().filter(|face| face.nodes().iter().all(listed)).copied().collect()
    }

    fn add_loads(&mut self, plan: &Plan, scene: &mut Scene) {
        let mut forces = std::mem::take(&mut scene.forces);
        for (index, load) in plan.loads.iter().enumerate() {
            let pointer = format!("/plan/loads/{index}");
            match load {
                Load::Force { nodes, force } => {
                    for node in self.select(nodes, &format!("{pointer}/nodes")) {
                        forces[node as usize] += force;
                    }
                }
                Load::Traction { faces, traction } => {
                    self.face_load(faces, FaceLoad::Traction(*traction), &pointer, &mut forces);
                }
                Load::Pressure { faces, pressure } => {
                    self.face_load(faces, FaceLoad::Pressure(*pressure), &pointer, &mut forces);
                }
                Load::Gravity { acceleration } => {
                    if let Err(error) = add_gravity(&scene.tissue(), *acceleration, &mut forces) {
                        self.problems.add("/case/volume", "mesh-inverted-elements", error.to_string());
                    }
                }
            }
        }
        scene.forces = forces;
    }

    fn face_load(&mut self, selection: &NodeSelection, load: FaceLoad, pointer: &str, forces: &mut [Vector]) {
        let nodes = self.select(selection, &format!("{pointer}/faces"));
        let faces = self.faces_within(&nodes);
        if faces.is_empty() && !nodes.is_empty() {
            let detail = "no boundary face has all of its nodes in the selection".to_owned();
            self.problems.add(format!("{pointer}/faces"), "empty-selection", detail);
        }
        add_face_load(&self.case.volume, &faces, load, forces);
    }

    fn support(&mut self, scene: &Scene) {
        let loose = loose_parts(&scene.mesh, &scene.conditions.holds);
        for part in &loose {
            let detail = format!(
                "the part of {} nodes that contains node {} can move freely in {} of the 6 rigid ways: \
                 nothing holds it there ({} such parts)",
                part.nodes,
                part.first_node,
                part.free_movements,
                loose.len()
            );
            self.problems.add("/case", "underconstrained", detail);
        }
    }
}
