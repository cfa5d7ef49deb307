//! Construction of a checked scene from a stated case and plan.

use super::case::{Bone, Case, Plan, Settings};
use super::check::Check;
use super::cut;
use super::far_segment::far_segments;
use super::fibres::Tissues;
use super::hounsfield::TissueOfCells;
use super::muscle_field::{MuscleField, MuscleTissue};
use super::pressure_kind::{part_cells_of_bone, pressure_kinds};
use super::problem::{NoScene, SceneErrors};
use super::scene::Scene;
use super::skin_check::suspect_skin;
use super::stiff_layer;
use super::suspect_constants::{moduli_apart, no_soft_tissue, suspect_constants};
use super::walls;
use crate::boundary::contact::BoneSurface;
use crate::boundary::{connected_parts, tearing};
use crate::mesh::conformity::cells_do_not_match;
use crate::mesh::connectivity::Faces;
use crate::mesh::{Vector, Warning};
use crate::model::fem::discretisation_error::DistributedLoads;
use crate::plan::PlannedSegment;
use crate::plan::doubt::{NOTHING_MOVES, nothing_moves};
use crate::progress::StopQuery;

/// Materials and fibres of cells.
struct InCells {
    tissue: TissueOfCells,
    fibres: Vec<Vector>,
    muscles: Vec<MuscleField>,
    muscle_tissue: Option<MuscleTissue>,
}

impl Check<'_> {
    /// Fails with all problems, or after a stop.
    fn fail_or_go_on(&mut self) -> Result<(), SceneErrors> {
        self.problems.fail_on_problems()?;
        self.go_on()
    }

    /// Fails after a stop, with nothing to tell.
    fn go_on(&self) -> Result<(), SceneErrors> {
        if self.stop.is_asked() { Err(SceneErrors(Vec::new())) } else { Ok(()) }
    }

    /// The tissue of cells in regions with these names: their materials and fibres, what an image shows of them, and muscles.
    fn in_cells(
        &mut self,
        (regions, region_of_cell): (&[String], &[u16]),
        settings: &Settings,
        plan: &Plan,
    ) -> InCells {
        let mut materials = self.materials(regions);
        let tissues = Tissues { regions, region_of_cell, materials: &mut materials };
        let mut fibres = self.fibres(tissues, &settings.method);
        let mut tissue = self.tissue_of_cells(region_of_cell, materials);
        let (of_cells, made) = ((regions, region_of_cell), (&mut tissue, &mut fibres));
        let (muscles, muscle_tissue) =
            self.muscles_of_cells(of_cells, made, (&settings.method, plan));
        tissue.pressure_of_cell =
            pressure_kinds(&tissue.pressure_of_cell, region_of_cell, &muscles);
        InCells { tissue, fibres, muscles, muscle_tissue }
    }
}

impl Scene {
    /// The warning that a plan displaces nothing, where it does not and the scene does not say so already.
    pub fn nothing_moves(&self) -> Option<Warning> {
        let is_told = self.warnings.iter().any(|warning| warning.code == NOTHING_MOVES);
        (self.is_at_rest() && !is_told).then(nothing_moves)
    }

    /// Checks a case and a plan together; says everything that is wrong, not the first thing only.
    pub fn new(case: &Case, plan: &Plan, settings: &Settings) -> Result<Scene, SceneErrors> {
        Scene::built(case, plan, settings, &StopQuery::never())
    }

    /// The same where it may be stopped: then there is no scene, whatever was found before.
    pub fn unless_stopped(
        case: &Case,
        plan: &Plan,
        settings: &Settings,
        stop: &StopQuery,
    ) -> Result<Scene, NoScene> {
        let built = Scene::built(case, plan, settings, stop);
        if stop.is_asked() {
            return Err(NoScene::Stopped);
        }
        Ok(built?)
    }

    /// After a stop what is built is not whole, or is nothing without an error.
    fn built(
        case: &Case,
        plan: &Plan,
        settings: &Settings,
        stop: &StopQuery,
    ) -> Result<Scene, SceneErrors> {
        let faces = Faces::new(&case.volume);
        let boundary = case.volume.boundary_of(&faces);
        let mut check = Check::new(case, &boundary, stop);

        // 1. Tissue.
        let (regions, region_of_cell) = check.regions();
        let InCells { mut tissue, fibres, muscles, muscle_tissue } =
            check.in_cells((&regions, &region_of_cell), settings, plan);
        let element = check.element(settings);
        check.go_on()?;

        // 2. What every node is held to.
        let sound = check.problems.count();
        let (segments, held) = check.held_nodes(plan, settings);
        let conditions = check.conditions(&held, (plan, &segments));
        let is_sound = check.problems.count() == sound;
        part_cells_of_bone(&mut tissue.pressure_of_cell, &case.volume, &conditions.constraints);
        check.plan_size(plan, &segments, &held);
        check.go_on()?;

        // 3. The skin and what acts on the tissue.
        let skin = check.skin(&conditions);
        let part_of_cell = faces.parts();
        let parts = connected_parts(&case.volume, &part_of_cell, &conditions, skin.nodes());
        if is_sound {
            check.unconstrained(plan, &segments, &parts);
        }
        let membrane = check.membrane(&skin, settings);
        let mut scene = Scene {
            mesh: case.volume.clone(),
            boundary: boundary.clone(),
            skin,
            regions,
            region_of_cell,
            materials: tissue.materials,
            material_of_cell: tissue.material_of_cell,
            pressure_of_cell: tissue.pressure_of_cell,
            imaged: tissue.imaged,
            fibres,
            membrane,
            element,
            warnings: conditions.warnings.clone(),
            conditions,
            bones: bones(case, &segments),
            stated: std::mem::take(&mut check.stated),
            parts,
            segments,
            forces: vec![Vector::zeros(); case.volume.nodes.len()],
            distributed: DistributedLoads::default(),
            near: None,
            muscles,
            muscle_tissue,
            landmarks: case.landmarks.clone(),
            allow_unfixed: case.allow_unfixed,
            settings: settings.clone(),
        };
        check.method(settings, plan);
        check.fail_or_go_on()?;
        check.add_loads_growth_and_muscles(plan, &mut scene);

        // 4. What cannot be solved, and what a reader must know.
        check.support(&scene, &part_of_cell);
        check.fail_or_go_on()?;
        scene.warnings.extend(check.warnings.into_iter().chain(far_segments(case, &held)));
        scene.warnings.extend(suspect_skin(&scene, case.skin.is_some()));
        scene.warnings.extend(cut::duplicate_nodes(&scene.mesh, &check.boundary_nodes));
        scene.warnings.extend(scene.doubts(case, plan, stop));
        Ok(scene)
    }

    /// What in a scene without mistakes is rarely meant.
    fn doubts(&self, case: &Case, plan: &Plan, stop: &StopQuery) -> Vec<Warning> {
        let mut warnings: Vec<Warning> = Vec::new();
        let name = |class| self.class_name(class);
        warnings.extend(cells_do_not_match(&self.mesh, &self.boundary));
        if stop.is_asked() {
            return warnings;
        }
        warnings.extend(tearing::tearing(&self.mesh, &self.conditions, name));
        warnings.extend(walls::warn_of_rotated_walls(self));
        warnings.extend(states_rest(plan, self));
        warnings.extend(suspect_constants(self, plan));
        warnings.extend(moduli_apart(case, self));
        warnings.extend(no_soft_tissue(case, self));
        warnings.extend(self.locking());
        warnings.extend(stiff_layer::thin_stiff_layers(self));
        warnings.extend(self.built_in_poisson_ratio());
        warnings
    }
}

/// The bones of a case that have a surface, with the movements of their segments.
fn bones(case: &Case, segments: &[PlannedSegment]) -> Vec<BoneSurface> {
    let of_bone = |(place, bone): (usize, &Bone)| {
        let segment = segments.iter().find(|segment| segment.name == bone.name);
        Some(BoneSurface {
            name: bone.name.clone(),
            place,
            is_carried: segment.is_some(),
            surface: case.surfaces.get(&bone.surface)?.clone(),
            movement: segment.map(|segment| segment.movement).unwrap_or_default(),
        })
    };
    case.bones.iter().enumerate().filter_map(of_bone).collect()
}

/// The warning of a plan that says something and moves nothing. An empty one is a case without a plan.
fn states_rest(plan: &Plan, scene: &Scene) -> Option<Warning> {
    let moves = !(plan.segments.is_empty() && plan.prescribed.is_empty());
    let says = moves || plan.states_loads();
    (says && scene.is_at_rest()).then(nothing_moves)
}
