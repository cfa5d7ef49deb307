//! Checked input of a prediction: no option open and no error left.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::case::Settings;
use super::element_choice::ElementChoice;
use super::imaged_tissue::ImagedTissue;
use super::method::Method;
use super::muscle_field::{MuscleField, MuscleTissue};
use super::no_rest::no_rest;
use super::skin::Skin;
use super::stated::StatedCondition;
use crate::boundary::contact::BoneSurface;
use crate::boundary::{Conditions, ConnectedPart, NodeClass};
use crate::material::LinearElastic;
use crate::material::hyperelastic::{Fibres, Law};
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{CellShape, Vector, VolumeMesh, Warning};
use crate::model::fem::assembly::Tissue;
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::fem::discretisation_error::DistributedLoads;
use crate::model::fem::displacement::Problem;
use crate::model::fem::edge_nodes::EdgeNodes;
use crate::model::fem::finite_strain::{
    Elements, FibreField, FinerProblem, FiniteStrain, MeshError,
};
use crate::model::fem::inner_stress::InnerStress;
use crate::model::fem::linear_system::LinearSystem;
use crate::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use crate::model::fem::mass_tensor_nonlinear::MassTensors;
use crate::model::fem::membrane::Membrane;
use crate::model::fem::{mass_tensor, quadratic};
use crate::model::mass_spring::POISSON_RATIO;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::model::thickness_warp::Warped;
use crate::model::{mass_spring, spline};
use crate::plan::PlannedSegment;
use crate::progress::Progress;
use crate::solver::Tolerance;

/// Element of a tetrahedron.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Tetrahedron {
    Plain,
    Stabilised,
    Quadratic,
}

/// Mesh, materials and conditions, ready to be solved.
#[derive(Clone)]
pub struct Scene {
    pub mesh: Arc<VolumeMesh>,
    /// The faces that belong to one cell only.
    pub boundary: Vec<BoundaryFace>,
    pub skin: Skin,
    /// Region names, and for each cell its entry.
    pub regions: Vec<String>,
    pub region_of_cell: Vec<u16>,
    /// For each region, then what an image and muscles add.
    pub materials: Vec<LinearElastic>,
    /// For each cell its entry in `materials`, and its kind of tissue, within which pressures are shared (`pressure_kind`).
    pub material_of_cell: Vec<u16>,
    pub pressure_of_cell: Vec<u16>,
    /// What an image shows of each cell, where materials are taken from one.
    pub imaged: Option<ImagedTissue>,
    /// For each cell the direction of its fibres, of length 1 or zero where it has none; empty where no
    /// region has fibres.
    pub fibres: Vec<Vector>,
    pub membrane: Option<Membrane>,
    /// What cells are taken as; that of the settings where the method leaves a choice.
    pub element: ElementChoice,
    pub conditions: Conditions,
    /// The conditions as case and plan state them.
    pub stated: Vec<StatedCondition>,
    /// Connected parts with their constraints.
    pub parts: Vec<ConnectedPart>,
    /// Segments by the number in `NodeClass::Joined`, with the movement each makes.
    pub segments: Vec<PlannedSegment>,
    /// Those whose surfaces tissue in contact may not pass.
    pub bones: Vec<BoneSurface>,
    /// For each node, in mN; quadratic elements have those of edge nodes after them.
    pub forces: Vec<Vector>,
    /// What of these acts between nodes too.
    pub distributed: DistributedLoads,
    /// Displacements near which a solution at finite strain is sought first.
    pub near: Option<Vec<Vector>>,
    /// Those of the case, whether they pull or not.
    pub muscles: Vec<MuscleField>,
    /// What they make of the tissue, where some have their own.
    pub muscle_tissue: Option<MuscleTissue>,
    pub landmarks: BTreeMap<String, Vector>,
    /// Whether a plan may carry the whole tissue away as one.
    pub allow_unfixed: bool,
    pub settings: Settings,
    /// Warnings before anything is solved: overlaps, tearing, locking.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// The tissue as the finite elements see it.
    pub fn tissue(&self) -> Tissue<'_> {
        Tissue {
            mesh: &self.mesh,
            materials: &self.materials,
            material_of_cell: &self.material_of_cell,
            pressure_of_cell: &self.pressure_of_cell,
            fibres: &self.fibres,
            membrane: self.membrane.as_ref(),
            dilatation: match self.element {
                ElementChoice::Plain | ElementChoice::Quadratic => |_| Dilatation::Pointwise,
                ElementChoice::Auto | ElementChoice::MeanDilatation | ElementChoice::Stabilised => {
                    |shape| match shape {
                        CellShape::Tet4 => Dilatation::Pointwise,
                        CellShape::Hex8 | CellShape::Wedge6 => Dilatation::Mean,
                    }
                }
            },
        }
    }

    /// What tetrahedra are taken as.
    pub(super) fn tetrahedron(&self) -> Tetrahedron {
        match self.element {
            ElementChoice::Plain | ElementChoice::MeanDilatation => Tetrahedron::Plain,
            ElementChoice::Auto | ElementChoice::Stabilised => Tetrahedron::Stabilised,
            ElementChoice::Quadratic => Tetrahedron::Quadratic,
        }
    }

    fn has_tetrahedra(&self) -> bool {
        self.mesh.cells.iter().any(|(shape, _)| shape == CellShape::Tet4)
    }

    /// Whether some tissue has fibres that only pull, of which no second order is known.
    pub fn has_pulling_fibres(&self) -> bool {
        self.materials.iter().any(LinearElastic::has_pulling_fibres)
    }

    /// Whether displacement is linear along every edge.
    pub(super) fn is_first_order(&self) -> bool {
        self.tetrahedron() != Tetrahedron::Quadratic
    }

    /// The middles of edges, where the element has nodes there.
    pub fn edge_nodes(&self) -> Option<EdgeNodes> {
        (self.tetrahedron() == Tetrahedron::Quadratic).then(|| EdgeNodes::new(&self.mesh))
    }

    /// Prescribed displacements, forces and grown volumes of the plan.
    pub fn load_case(&self) -> LoadCase {
        let held =
            self.conditions.constraints.iter().map(|constraint| *constraint.values()).collect();
        // A cell without volume is refused where its matrix is made.
        let grown = self.distributed.inner.grown_volumes(&self.mesh).unwrap_or_default();
        LoadCase { held, forces: self.forces.clone(), grown }
    }

    /// Whether nothing is held away from its place and nothing acts, but what is so small that its square is 0.
    pub(super) fn is_at_rest(&self) -> bool {
        let moves = |vector: &Vector| vector.norm_squared() > 0.0;
        let constraints = &self.conditions.constraints;
        !constraints.iter().any(|constraint| moves(constraint.values()))
            && !self.forces.iter().any(moves)
            && self.distributed.inner.is_zero()
    }

    /// Solves the scene by the method of its settings.
    pub fn solve(&self, progress: &dyn Progress) -> Result<Equilibrium, ModelError> {
        match &self.settings.method {
            // A mass-tensor is the block of two nodes of a plain tetrahedron.
            Method::FemLinear
            | Method::MassTensorTransverse(MassTensorSettings { iterations: Iterations::Fast }) => {
                self.solve_linear(progress)
            }
            Method::FemNonlinear => Ok(self.solve_at_finite_strain(false, progress)?.0),
            Method::MassSpring(settings) => {
                mass_spring::solve(&self.problem(), settings, &self.load_case(), progress)
            }
            Method::MassTensor(settings) | Method::MassTensorTransverse(settings) => {
                let own = self.problem();
                self.with_states(mass_tensor::solve(&own, settings, &self.load_case(), progress)?)
            }
            Method::MassTensorNonlinear => {
                let found = self.mass_tensors().solve(&self.load_case(), progress);
                found.map_err(|error| self.no_rest(error))
            }
            Method::VolumeSpline(spline) => spline::solve(&self.problem(), spline, progress),
            Method::ThicknessWarp(warp) => {
                let movement = |segment: u32, x: &Vector| {
                    self.segments[segment as usize].movement.displacement(x)
                };
                let (mesh, conditions) = (&*self.mesh, &self.conditions);
                let wanted_residual = self.settings.relative_residual;
                Warped { mesh, conditions, movement: &movement, wanted_residual }.solve(warp)
            }
        }
    }

    /// Each material follows its law at finite strain, the neo-Hookean one where none is stated. On request with what the mesh
    /// leaves out.
    pub(super) fn solve_at_finite_strain(
        &self,
        with_error: bool,
        progress: &dyn Progress,
    ) -> Result<(Equilibrium, Option<MeshError>), ModelError> {
        let found = self.at_finite_strain(|problem, finer| {
            problem.solve_and(&self.load_case(), with_error.then_some(finer), progress)
        });
        found.map_err(|error| self.no_rest(error))
    }

    /// What the mesh leaves out of an answer of the nonlinear mass-tensor.
    pub(super) fn mesh_error_of_mass_tensors(
        &self,
        displacement: &[Vector],
        progress: &dyn Progress,
    ) -> Result<MeshError, ModelError> {
        self.at_finite_strain(|problem, finer| {
            problem.mesh_error_at(displacement, &self.load_case(), finer, progress)
        })
    }

    /// Why no rest was found, with what passes through what.
    fn no_rest(&self, error: ModelError) -> ModelError {
        no_rest(error, &self.mesh, &self.conditions, |class| self.class_name(class))
    }

    /// The problem of finite strain, and what a finer mesh would see of it, for what is done with them.
    pub(super) fn at_finite_strain<T>(
        &self,
        done: impl FnOnce(&FiniteStrain, &FinerProblem) -> T,
    ) -> T {
        let own_laws = self.settings.method.properties().laws;
        let (laws, fibres): (Vec<Law>, Vec<Option<Fibres>>) =
            self.materials.iter().map(|material| own_laws.of(material)).unzip();
        let Settings { relative_residual, memory_mb, .. } = self.settings;
        let elements = Elements {
            stabilised: self.tetrahedron() == Tetrahedron::Stabilised,
            mean_dilatation: !matches!(
                self.element,
                ElementChoice::Plain | ElementChoice::Quadratic
            ),
            quadratic: self.tetrahedron() == Tetrahedron::Quadratic,
        };
        let problem = FiniteStrain {
            mesh: &self.mesh,
            nodes: &self.mesh.nodes,
            laws: &laws,
            law_of_cell: &self.material_of_cell,
            pressure_of_cell: &self.pressure_of_cell,
            elements,
            fibres: FibreField { of_law: &fibres, of_cell: &self.fibres },
            membrane: self.membrane.as_ref(),
            inner: Arc::new(self.distributed.inner.clone()),
            constraints: &self.conditions.constraints,
            tolerance: Tolerance { relative_residual, memory_mb },
            with_states: self.settings.states,
            advance: self.settings.advance,
            near: self.near.as_deref(),
        };
        let (tissue, boundary) = (self.tissue(), &self.boundary);
        // What grows and pulls is in the cells already.
        let loads = DistributedLoads { inner: InnerStress::default(), ..self.distributed.clone() };
        done(&problem, &FinerProblem { tissue, laws: &laws, boundary, loads: &loads })
    }

    fn mass_tensors(&self) -> MassTensors<'_> {
        let Settings { relative_residual, memory_mb, .. } = self.settings;
        MassTensors {
            mesh: &self.mesh,
            materials: &self.materials,
            material_of_cell: &self.material_of_cell,
            constraints: &self.conditions.constraints,
            tolerance: Tolerance { relative_residual, memory_mb },
        }
    }

    /// Tissue, holds and loads as models see them.
    pub(super) fn problem(&self) -> Problem<'_> {
        let Settings { relative_residual, memory_mb, .. } = self.settings;
        Problem {
            tissue: self.tissue(),
            constraints: &self.conditions.constraints,
            forces: &self.forces,
            tolerance: Tolerance { relative_residual, memory_mb },
        }
    }

    /// Solves for each of several load cases with linear finite elements, those of this scene; the tissue is
    /// assembled once.
    pub fn solve_cases(
        &self,
        cases: &[LoadCase],
        progress: &dyn Progress,
    ) -> Result<Vec<Equilibrium>, ModelError> {
        match self.assemble(progress)? {
            Some(system) => {
                let solved = system.solve(cases, progress)?;
                Ok(solved.into_iter().map(|solved| solved.equilibrium).collect())
            }
            None => quadratic::solve_cases(&self.problem(), cases, progress),
        }
    }

    /// The linear finite elements of this scene, assembled; none where they are quadratic.
    pub fn assemble(
        &self,
        progress: &dyn Progress,
    ) -> Result<Option<LinearSystem<'_>>, ModelError> {
        let problem = self.problem();
        match self.tetrahedron() {
            Tetrahedron::Quadratic => Ok(None),
            Tetrahedron::Stabilised if self.has_tetrahedra() => {
                LinearSystem::mixed(&problem, progress).map(Some)
            }
            Tetrahedron::Stabilised | Tetrahedron::Plain => {
                LinearSystem::plain(&problem, progress).map(Some)
            }
        }
    }

    /// The elements in use, e.g. `hex8 mean dilatation`; none where there are none.
    pub fn elements(&self) -> Vec<String> {
        match &self.settings.method {
            Method::MassSpring(_) | Method::ThicknessWarp(_) => return Vec::new(),
            Method::VolumeSpline(spline) => return vec![spline.element()],
            Method::FemLinear
            | Method::FemNonlinear
            | Method::MassTensor(_)
            | Method::MassTensorTransverse(_)
            | Method::MassTensorNonlinear => {}
        }
        let dilatation = self.tissue().dilatation;
        let shares = self.materials.iter().any(|tissue| self.shares_volume(tissue));
        [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6]
            .into_iter()
            .filter(|shape| self.mesh.cells.iter().any(|(other, _)| other == *shape))
            .map(|shape| match (shape, self.tetrahedron(), dilatation(shape)) {
                (CellShape::Tet4, Tetrahedron::Stabilised, _) if shares => {
                    "tet4 stabilised".to_owned()
                }
                (CellShape::Tet4, Tetrahedron::Quadratic, _) => "tet10 quadratic".to_owned(),
                (_, _, Dilatation::Mean) if shares => format!("{} mean dilatation", shape.name()),
                (_, _, Dilatation::Pointwise | Dilatation::Mean) => {
                    format!("{} plain", shape.name())
                }
            })
            .chain(
                self.membrane
                    .as_ref()
                    .map(|own| own.name(self.tetrahedron() == Tetrahedron::Quadratic).to_owned()),
            )
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

    /// Springs have the Poisson ratio that they have.
    pub(super) fn built_in_poisson_ratio(&self) -> Option<Warning> {
        let Method::MassSpring(_) = self.settings.method else { return None };
        let stated = self.regions.iter().zip(&self.materials);
        let others: Vec<String> = stated
            .filter(|(_, material)| material.poisson_ratio() != POISSON_RATIO)
            .map(|(region, material)| format!("{region} {}", material.poisson_ratio()))
            .collect();
        let instead = match others.is_empty() {
            true => String::new(),
            false => format!(", and not that of the materials: {}", others.join(", ")),
        };
        let detail = format!("springs have a Poisson ratio of 1/4 on average{instead}");
        let warning = Warning::new("built-in-poisson-ratio", detail);
        Some(warning.with("poisson_ratio", POISSON_RATIO))
    }
}
