//! Columns of internal loads: one unit of growth of a region or of the pull of a muscle, with all segments at rest.

use super::response_error::ResponseError;
use super::superposition::InnerLoad;
use crate::mesh::Vector;
use crate::mesh::ignored::listed;
use crate::model::fem::inner_stress::InnerStress;
use crate::model::problem::{LoadCase, ModelError};
use crate::prediction::Scene;

/// The columns of some regions that grow and of some muscles; refuses those that a scene does not have.
pub fn inner_loads(
    scene: &Scene,
    growth: &[String],
    muscles: &[String],
) -> Result<Vec<InnerLoad>, ResponseError> {
    let growing = growth.iter().cloned().map(InnerLoad::Growth);
    let pulling = muscles.iter().cloned().map(InnerLoad::Muscle);
    let all: Vec<InnerLoad> = growing.chain(pulling).collect();
    all.iter().try_for_each(|load| known(scene, load))?;
    Ok(all)
}

fn known(scene: &Scene, load: &InnerLoad) -> Result<(), ResponseError> {
    match load {
        InnerLoad::Growth(name) if name != "*" && !scene.regions.contains(name) => {
            let known = listed(scene.regions.iter());
            Err(ResponseError::UnknownRegion { name: name.clone(), known })
        }
        InnerLoad::Muscle(name) if scene.muscles.iter().all(|own| own.name != *name) => {
            let known = listed(scene.muscles.iter().map(|own| &own.name));
            Err(ResponseError::UnknownMuscle { name: name.clone(), known })
        }
        InnerLoad::Muscle(name)
            if scene.muscles.iter().any(|own| own.name == *name && own.stiffens) =>
        {
            Err(ResponseError::Stiffens { name: name.clone() })
        }
        InnerLoad::Growth(_) | InnerLoad::Muscle(_) => Ok(()),
    }
}

/// One unit of it.
fn unit(scene: &Scene, load: &InnerLoad) -> InnerStress {
    let cells = scene.mesh.cells.len();
    match load {
        InnerLoad::Growth(region) => scene.grown(region, 1.0).unwrap_or_default(),
        InnerLoad::Muscle(name) => {
            let muscle = scene.muscles.iter().find(|own| own.name == *name);
            muscle.map(|own| own.pulling(cells, 1.0)).unwrap_or_default()
        }
    }
}

/// What a unit does where everything is held in its place.
pub(super) fn load_case(scene: &Scene, load: &InnerLoad) -> Result<LoadCase, ResponseError> {
    known(scene, load)?;
    let inner = unit(scene, load);
    let nodes = scene.edge_nodes().map_or(scene.mesh.nodes.len(), |edges| edges.node_count());
    let mut forces = vec![Vector::zeros(); nodes];
    scene.add_inner_forces(&inner, &mut forces).map_err(ModelError::from)?;
    let held = vec![Vector::zeros(); scene.conditions.constraints.len()];
    let grown = inner.grown_volumes(&scene.mesh).map_err(ModelError::from)?;
    Ok(LoadCase { held, forces, grown })
}
