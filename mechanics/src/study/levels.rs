//! The meshes of a scene: level 0, and each further one with every edge halved once more.

use std::sync::Arc;

use super::answer::Refusal;
use super::variant::{Materials, StudyScene, Truth};
use crate::mesh::VolumeMesh;
use crate::mesh::refinement::refine;
use crate::prediction::{Case, Plan};

/// Finer meshes are refused: their matrices would not fit the memory of one machine.
pub const MOST_CELLS: f64 = 8e6;

/// The cells of a mesh whose edges are halved so many times.
pub fn cells_at(cells: usize, level: u32) -> f64 {
    cells as f64 * 8f64.powf(f64::from(level))
}

/// The meshes of a scene by level, as far as they are made.
pub(super) struct Levels<'a> {
    scene: &'a StudyScene,
    made: Vec<Arc<VolumeMesh>>,
}

impl<'a> Levels<'a> {
    pub(super) fn of(scene: &'a StudyScene) -> Self {
        Levels { scene, made: vec![scene.case.volume.clone()] }
    }

    /// The case of the scene on the mesh of a level, of these materials.
    pub(super) fn case(&mut self, level: u32, materials: &Materials) -> Result<Case, Refusal> {
        let volume = self.mesh(level)?;
        let mut case =
            Case { volume, materials: materials.by_region.clone(), ..self.scene.case.clone() };
        case.fibres.extend(materials.fibres.clone());
        for window in case.hounsfield.iter_mut().flat_map(|image| &mut image.tissues) {
            window.material =
                materials.tissues.get(&window.name).copied().unwrap_or(window.material);
        }
        Ok(case)
    }

    /// A plan as it is of these materials, on the mesh of any level.
    pub(super) fn plan(&self, plan: &Plan, materials: &Materials) -> Plan {
        materials.plan(plan).at_nodes_of(&self.scene.case)
    }

    fn mesh(&mut self, level: u32) -> Result<Arc<VolumeMesh>, Refusal> {
        let cells = cells_at(self.scene.case.volume.cells.len(), level);
        if cells > MOST_CELLS {
            let detail = format!(
                "level {level} has {cells:.2e} cells, at most {MOST_CELLS:.0e} are allowed"
            );
            return Err(Refusal::new("budget-exceeded", detail));
        }
        while self.made.len() <= level as usize {
            let mut finer = refine(&self.made[self.made.len() - 1]);
            if let Truth::ClosedForm(formula) = &self.scene.truth {
                (formula.walls)(&mut finer);
            }
            self.made.push(Arc::new(finer));
        }
        Ok(self.made[level as usize].clone())
    }
}
