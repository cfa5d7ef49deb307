//! A checked scene: nothing optional, nothing left to refuse.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::case::{Case, ElementChoice, Plan, Settings};
use super::check::Check;
use super::problem::SceneErrors;
use super::skin::Skin;
use crate::boundary::{Conditions, NodeClass, tearing};
use crate::material::LinearElastic;
use crate::mesh::{CellShape, Vector, VolumeMesh, Warning};
use crate::model::assembly::Tissue;
use crate::model::stiffness::Dilatation;
use crate::plan::PlannedSegment;

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

    /// The number of the segment of that name.
    pub fn segment(&self, name: &str) -> Option<usize> {
        self.segments.iter().position(|segment| segment.name == name)
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
            NodeClass::Joined(segment) => {
                format!("joined:{}", self.segments[segment as usize].name)
            }
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
        let locking = cells.filter(|((shape, _), region)| locks(*shape, **region)).count();
        let largest = self.materials.iter().map(LinearElastic::poisson_ratio).fold(0.0, f64::max);
        let detail = format!(
            "{locking} plain cells have a Poisson ratio above {LOCKING}: they lock, and the skin moves too little"
        );
        let warning = Warning::new("locking", detail).with("cells", locking as f64);
        (locking > 0).then(|| warning.with("largest_poisson_ratio", largest))
    }
}
