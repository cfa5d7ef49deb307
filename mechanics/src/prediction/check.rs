//! The checks that turn a stated case and plan into a scene: tissue, skin, loads, support.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::case::{Case, Load, Plan, RegionNames, Settings};
use super::element_choice::ElementChoice;
use super::error_code::SceneErrorCode;
use super::method::Method;
use super::problem::Problems;
use super::scene::Scene;
use super::skin::{self, Skin};
use super::stated::StatedCondition;
use crate::boundary::support::loose_parts;
use crate::boundary::{Conditions, Constraint, NodeSelection};
use crate::material::LinearElastic;
use crate::mesh::duplicate_cells::duplicate_cells;
use crate::mesh::ignored::missing_region;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{ArrayUse, CellShape, Vector, Warning};
use crate::model::fem::edge_nodes::EdgeNodes;
use crate::model::fem::loads::{FaceLoad, add_face_load, add_gravity};
use crate::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use crate::progress::StopQuery;

/// Regions and the tissues of an image are numbered together with 16 bits.
const MOST_REGIONS: usize = 1 << 15;

/// The state of one check: what is asked, and what was found wrong so far.
pub(super) struct Check<'a> {
    pub(super) case: &'a Case,
    pub(super) boundary: &'a [BoundaryFace],
    pub(super) boundary_nodes: Vec<u32>,
    pub(super) is_in_cell: Vec<bool>,
    /// As `Selector` keeps them.
    pub(super) distances: BTreeMap<String, Vec<f64>>,
    pub(super) problems: Problems,
    pub(super) warnings: Vec<Warning>,
    /// The conditions so far.
    pub(super) stated: Vec<StatedCondition>,
    /// What is found after a stop is not whole.
    pub(super) stop: &'a StopQuery<'a>,
}

impl<'a> Check<'a> {
    pub(super) fn new(
        case: &'a Case,
        boundary: &'a [BoundaryFace],
        stop: &'a StopQuery<'a>,
    ) -> Self {
        let mut boundary_nodes: Vec<u32> =
            boundary.iter().flat_map(|face| face.nodes()).copied().collect();
        boundary_nodes.sort_unstable();
        boundary_nodes.dedup();
        let (problems, warnings, stated) = (Problems::default(), Vec::new(), Vec::new());
        let (is_in_cell, distances) = (case.volume.is_in_cell(), BTreeMap::new());
        Check {
            case,
            boundary,
            boundary_nodes,
            is_in_cell,
            distances,
            problems,
            warnings,
            stated,
            stop,
        }
    }

    pub(super) fn regions(&mut self) -> (Vec<String>, Vec<u16>) {
        let cells = self.case.volume.cells.len();
        let Some(stated) = &self.case.regions else {
            return (vec!["tissue".to_owned()], vec![0; cells]);
        };
        let Some(labels) = self.case.volume.cell_labels.get(&stated.array) else {
            let detail = self.case.volume.missing_array(ArrayUse::CellLabels, &stated.array);
            self.problems.add("/case/regions/array", SceneErrorCode::UnknownArray, detail);
            return (vec!["tissue".to_owned()], vec![0; cells]);
        };
        let mut values = labels.clone();
        values.sort_unstable();
        values.dedup();
        for value in stated.names.keys().filter(|value| values.binary_search(value).is_err()) {
            let detail = format!("no cell has the value {value} in array {:?}", stated.array);
            self.problems.add(
                format!("/case/regions/names/{value}"),
                SceneErrorCode::UnknownRegion,
                detail,
            );
        }
        let (names, region_of_value) = name_regions(stated, &values);
        if names.len() > MOST_REGIONS {
            let detail =
                format!("{} regions; at most {MOST_REGIONS} are distinguished", names.len());
            self.problems.add("/case/regions/array", SceneErrorCode::TooManyRegions, detail);
            return (vec!["tissue".to_owned()], vec![0; cells]);
        }
        let place = |label: &i64| {
            values.binary_search(label).expect("values are the labels without repeats")
        };
        (names, labels.iter().map(|label| region_of_value[place(label)]).collect())
    }

    pub(super) fn materials(&mut self, regions: &[String]) -> Vec<LinearElastic> {
        let stated = &self.case.materials;
        let known: HashSet<&String> = regions.iter().collect();
        for name in stated.keys().filter(|name| *name != "*" && !known.contains(name)) {
            let detail = missing_region(name, regions.iter());
            self.problems.add(
                format!("/case/materials/{name}"),
                SceneErrorCode::UnknownRegion,
                detail,
            );
        }
        let mut materials = Vec::new();
        for region in regions {
            match stated.get(region).or_else(|| stated.get("*")) {
                Some(material) => materials.push(*material),
                None => {
                    let detail =
                        format!("region {region:?} has no material, and there is none for \"*\"");
                    self.problems.add("/case/materials", SceneErrorCode::MissingMaterial, detail);
                }
            }
        }
        materials
    }

    pub(super) fn skin(&mut self, conditions: &Conditions) -> Skin {
        let faces = match &self.case.skin {
            Some(selection) => {
                let nodes = self.select(selection, "/case/skin");
                self.faces_within(&nodes)
            }
            None => skin::default_faces(self.boundary, &conditions.classes, &mut self.warnings),
        };
        if self.boundary.is_empty() {
            let detail = format!("the mesh has no boundary face{}", self.doubled());
            self.problems.add("/case/volume", SceneErrorCode::MeshDegenerate, detail);
        } else if faces.is_empty() && self.case.skin.is_some() {
            let no_face = "no boundary face has all of its nodes in the selection";
            let detail = format!("{no_face}{}", self.doubled());
            self.problems.add("/case/skin", SceneErrorCode::EmptySelection, detail);
        }
        let surface = self.case.volume.surface_of(&faces);
        let skin_nodes = surface.node_ids.clone().unwrap_or_default();
        let (mut regions, mut off) = (BTreeMap::new(), BTreeMap::new());
        for (name, selection) in &self.case.skin_regions {
            let pointer = format!("/case/skin_regions/{name}");
            let nodes = self.select(selection, &pointer);
            let point_of =
                |node: &u32| skin_nodes.binary_search(node).ok().map(|point| point as u32);
            let points: Vec<u32> = nodes.iter().filter_map(point_of).collect();
            if points.is_empty() && !nodes.is_empty() {
                let detail = "no node of the selection is on the skin".to_owned();
                self.problems.add(pointer, SceneErrorCode::EmptySelection, detail);
            }
            if points.len() < nodes.len() {
                off.insert(name.clone(), nodes.len() - points.len());
            }
            regions.insert(name.clone(), points);
        }
        Skin { surface, regions, off }
    }

    /// Cells that stand twice, in words: a face between two cells is not on the boundary.
    fn doubled(&self) -> String {
        let doubled = duplicate_cells(&self.case.volume);
        doubled.map_or_else(String::new, |found| format!(": {}", found.detail))
    }

    /// The element that the method uses. Refuses one that it does not have or that some cell of the mesh
    /// cannot be.
    pub(super) fn element(&mut self, settings: &Settings) -> ElementChoice {
        let (asked, method) = (settings.element, settings.method.properties());
        self.shapes(method.cells, "/case/volume", &format!("{} is", method.title));
        if asked == ElementChoice::Auto {
            return method.usual_element;
        }
        if !method.elements.contains(&asked) {
            let known: Vec<String> =
                method.elements.iter().map(|known| format!("`{}`", known.name())).collect();
            let detail = match known.is_empty() {
                true => {
                    format!(
                        "{} has no choice of elements: `auto` is what it is made of",
                        method.title
                    )
                }
                false => format!(
                    "{} has no element `{}`: there are {}",
                    method.title,
                    asked.name(),
                    known.join(", ")
                ),
            };
            self.problems.add("/spec/element", SceneErrorCode::MethodNotAvailable, detail);
            return method.usual_element;
        }
        self.shapes(asked.shapes(), "/spec/element", &format!("{} elements are", asked.name()));
        asked
    }

    /// Refuses a mesh with cells of other shapes.
    fn shapes(&mut self, shapes: &[CellShape], pointer: &str, who: &str) {
        let mut cells = self.case.volume.cells.iter();
        if let Some((shape, _)) = cells.find(|(shape, _)| !shapes.contains(shape)) {
            let known: Vec<&str> = shapes.iter().map(|shape| shape.name()).collect();
            let detail = format!(
                "{who} made of {} only, and the mesh has {} cells: `fem_linear` with the element \
                 `auto` serves every shape",
                known.join(", "),
                shape.name()
            );
            self.problems.add(pointer, SceneErrorCode::MethodNotAvailable, detail);
        }
    }

    /// Refuses what a method would have to ignore in silence.
    pub(super) fn method(&mut self, settings: &Settings, plan: &Plan) {
        let method = settings.method.properties();
        let is_quadratic = settings.element == ElementChoice::Quadratic;
        let is_node_by_node = matches!(
            settings.method,
            Method::MassTensorTransverse(MassTensorSettings {
                iterations: Iterations::Stationary(_)
            })
        );
        let knows_contact = method.knows_contact && !is_quadratic && !is_node_by_node;
        if settings.contact.is_unilateral() && !knows_contact {
            let who = match is_quadratic {
                true => "quadratic elements know",
                false => &format!("{} knows", method.title),
            };
            let detail = format!(
                "{who} no contact that opens and closes: `fem_linear` and `fem_nonlinear` do, with any element but `quadratic`"
            );
            self.problems.add("/spec/contact", SceneErrorCode::MethodNotAvailable, detail);
        }
        if !method.knows_loads && !plan.loads.is_empty() {
            let detail = format!("{} follows bone and knows no forces", method.name);
            self.problems.add("/plan/loads", SceneErrorCode::MethodNotAvailable, detail);
        }
        let inner = [
            ("growth", "tissue that grows", !plan.grows()),
            ("activations", "muscles that pull", plan.activations.is_empty()),
        ];
        for (member, what, _) in inner.into_iter().filter(|(_, _, is_empty)| !is_empty) {
            if !method.knows_inner_stress {
                let detail = format!(
                    "{} knows no {what}: `fem_linear`, `fem_nonlinear`, `mtm` and `mtm_ti` do",
                    method.title
                );
                let at = format!("/plan/{member}");
                self.problems.add(at, SceneErrorCode::MethodNotAvailable, detail);
            }
        }
    }

    /// Loads, growth and muscles that pull.
    pub(super) fn add_loads_growth_and_muscles(&mut self, plan: &Plan, scene: &mut Scene) {
        self.add_loads(plan, scene);
        self.add_inner_stress(plan, scene);
    }

    fn add_loads(&mut self, plan: &Plan, scene: &mut Scene) {
        if plan.loads.is_empty() {
            return;
        }
        let mut forces = std::mem::take(&mut scene.forces);
        let edges = scene.edge_nodes();
        if let Some(edges) = &edges {
            forces.resize(edges.node_count(), Vector::zeros());
        }
        let edges = edges.as_ref();
        for (index, load) in plan.loads.iter().enumerate() {
            let pointer = format!("/plan/loads/{index}");
            let (faces, load) = match load {
                Load::Force { nodes, force } => {
                    let nodes = self.select(nodes, &format!("{pointer}/nodes"));
                    nodes.iter().for_each(|&node| forces[node as usize] += force);
                    let constraints = &scene.conditions.constraints;
                    self.warnings.extend(self.point_force(&nodes, constraints, &pointer));
                    self.warnings.extend(load_on_constrained(&nodes, constraints, &pointer));
                    continue;
                }
                Load::Traction { faces, traction } => (faces, FaceLoad::Traction(*traction)),
                Load::Pressure { faces, pressure } => (faces, FaceLoad::Pressure(*pressure)),
                Load::Gravity { acceleration } => {
                    scene.distributed.acceleration += acceleration;
                    let tissue = scene.tissue();
                    let added = match edges {
                        Some(edges) => edges.add_gravity(&tissue, *acceleration, &mut forces),
                        None => add_gravity(&tissue, *acceleration, &mut forces),
                    };
                    if let Err(error) = added {
                        self.problems.add(
                            "/case/volume",
                            SceneErrorCode::MeshInvertedElements,
                            error.to_string(),
                        );
                    }
                    continue;
                }
            };
            let faces = self.loaded_faces(faces, &pointer);
            let nodes: Vec<u32> = faces.iter().flat_map(BoundaryFace::nodes).copied().collect();
            self.warnings.extend(load_on_constrained(
                &nodes,
                &scene.conditions.constraints,
                &pointer,
            ));
            self.face_load(&faces, load, edges, &mut forces);
            scene.distributed.faces.push((faces, load));
        }
        scene.forces = forces;
    }

    fn face_load(
        &self,
        faces: &[BoundaryFace],
        load: FaceLoad,
        edges: Option<&EdgeNodes>,
        forces: &mut [Vector],
    ) {
        match edges {
            Some(edges) => edges.add_face_load(&self.case.volume, faces, load, forces),
            None => add_face_load(&self.case.volume, faces, load, forces),
        }
    }

    fn loaded_faces(&mut self, selection: &NodeSelection, pointer: &str) -> Vec<BoundaryFace> {
        let nodes = self.select(selection, &format!("{pointer}/faces"));
        let faces = self.faces_within(&nodes);
        if faces.is_empty() && !nodes.is_empty() {
            let detail = "no boundary face has all of its nodes in the selection".to_owned();
            self.problems.add(format!("{pointer}/faces"), SceneErrorCode::EmptySelection, detail);
        }
        faces
    }

    pub(super) fn support(&mut self, scene: &Scene, part_of_cell: &[u32]) {
        let loose = loose_parts(&scene.mesh, part_of_cell, &scene.conditions.constraints);
        for part in &loose {
            let detail = format!(
                "the part of {} nodes that contains node {} can move freely in {} of the 6 rigid ways: \
                 it may {}; nothing holds it there ({} such parts)",
                part.nodes,
                part.first_node,
                part.freedom.count(),
                part.freedom,
                loose.len()
            );
            self.problems.add("/case", SceneErrorCode::Underconstrained, detail);
        }
    }
}

/// The warning of a load on constrained nodes only, which moves nothing.
fn load_on_constrained(
    nodes: &[u32],
    constraints: &[Constraint],
    pointer: &str,
) -> Option<Warning> {
    let held: BTreeSet<u32> = constraints
        .iter()
        .filter(|constraint| constraint.count() == 3)
        .map(|constraint| constraint.node)
        .collect();
    let all = !nodes.is_empty() && nodes.iter().all(|node| held.contains(node));
    let detail =
        format!("the load at {pointer} acts on fixed or moved nodes only: it moves nothing");
    all.then(|| Warning::new("load-on-held", detail).with("nodes", nodes.len() as f64))
}

/// Region names in the order of the values, and the region of each value: values that share a name
/// share a region, and a value without a name is called by its number. More than [`MOST_REGIONS`] are
/// counted and have no numbers.
fn name_regions(stated: &RegionNames, values: &[i64]) -> (Vec<String>, Vec<u16>) {
    let mut names: Vec<String> = Vec::new();
    let mut number_of: HashMap<String, usize> = HashMap::new();
    let mut region_of_value = Vec::new();
    for value in values {
        let name = stated.names.get(value).cloned().unwrap_or_else(|| value.to_string());
        let number = *number_of.entry(name).or_insert_with_key(|name| {
            names.push(name.clone());
            names.len() - 1
        });
        region_of_value.extend(u16::try_from(number));
    }
    (names, region_of_value)
}
