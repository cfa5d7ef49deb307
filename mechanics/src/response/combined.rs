//! Skin of one plan as a single load case: the result of a response without its columns.

use super::ResponseError;
use super::build::{ColumnRequest, chosen, held_values, segment_of};
use super::inner_loads::load_case;
use super::superposition::{Amounts, COLUMNS_PER_SEGMENT, coefficients};
use crate::mesh::Vector;
use crate::model::problem::LoadCase;
use crate::prediction::Scene;
use crate::progress::Progress;

/// The displacement of each skin node in mm, for one movement of each segment that is asked for, and for amounts of what acts
/// inside: that of [`Columns::apply_all`](super::Columns::apply_all).
pub fn solved_skin(
    scene: &Scene,
    asked: &ColumnRequest,
    amounts: &Amounts,
    progress: &dyn Progress,
) -> Result<Vec<Vector>, ResponseError> {
    let (nodes, constraints) = (scene.mesh.nodes.len(), scene.conditions.constraints.len());
    let zeros = |count: usize| vec![Vector::zeros(); count];
    let mut case =
        LoadCase { held: zeros(constraints), forces: zeros(nodes), ..LoadCase::default() };
    for (number, movement) in chosen(scene, asked.segments)?.into_iter().zip(amounts.movements) {
        let centre = segment_of(scene, number)?.centre;
        let factors = coefficients(movement, &centre);
        for unit in (0..COLUMNS_PER_SEGMENT).filter(|&unit| factors[unit] != 0.0) {
            let held = held_values(scene, number, &centre, unit);
            add(&mut case.held, &held, factors[unit]);
        }
    }
    for (load, &amount) in asked.inner.iter().zip(amounts.inner) {
        let own = load_case(scene, load)?;
        case.forces.resize(own.forces.len(), Vector::zeros());
        add(&mut case.forces, &own.forces, amount);
        case.grown.resize(case.grown.len().max(own.grown.len()), 0.0);
        case.grown.iter_mut().zip(&own.grown).for_each(|(sum, grown)| *sum += grown * amount);
    }
    let solved = scene.solve_cases(&[case], progress)?;
    let displacement = solved.iter().flat_map(|solved| {
        scene.skin.nodes().iter().map(|&node| solved.displacement[node as usize])
    });
    Ok(displacement.collect())
}

fn add(sums: &mut [Vector], values: &[Vector], factor: f64) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value * factor);
}
