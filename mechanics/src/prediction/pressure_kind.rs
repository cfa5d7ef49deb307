//! Tissue that shares its pressures: stabilised tetrahedra have one pressure for each node and kind of tissue.
//!
//! Pressure is continuous where stiffness, growth, fibres and active stress are. It jumps where they do, and an element that shares it
//! there fails the patch test: half of a column that pulls, nu .49, was shortened by three times what it is. Growth, uniform fibres
//! and muscles may be stated by region, so that cells of two regions share none, whatever their constants; nor do a cell that is
//! mostly inside a muscle with a surface and one that is mostly outside. The pull of a muscle around polylines fades smoothly, and
//! parts nothing. Cells all of whose nodes belong to one body, as those of bone that is part of the mesh, share none with tissue: they
//! keep their volume, and a pressure that has to suit them as well lets a confined column shrink by a sixth. All this depends on the
//! case and on what it holds alone: a response and each prediction of its plans have the same pressures.

use std::collections::BTreeMap;

use super::muscle_field::MuscleField;
use crate::boundary::{Constraint, midpoint};
use crate::mesh::VolumeMesh;

/// A cell with as large a share of a muscle, or a larger one, belongs to it.
const INSIDE: f64 = 0.5;

/// For each cell its kind of tissue, numbered as they come. `stuff` is the entry of each in the list of materials.
pub(super) fn pressure_kinds(
    stuff: &[u16],
    region_of_cell: &[u16],
    muscles: &[MuscleField],
) -> Vec<u16> {
    let mut inside: Vec<Vec<u16>> = vec![Vec::new(); stuff.len()];
    for (number, muscle) in (0..).zip(muscles).filter(|(_, muscle)| !muscle.has_lines) {
        for own in muscle.cells.iter().filter(|own| own.stress.trace() >= INSIDE) {
            inside[own.cell as usize].push(number);
        }
    }
    let mut known: BTreeMap<(u16, u16, Vec<u16>), u16> = BTreeMap::new();
    let cells = stuff.iter().zip(region_of_cell).zip(inside);
    let kind = |((&stuff, &region), inside)| {
        let next = u16::try_from(known.len()).unwrap_or(u16::MAX);
        *known.entry((stuff, region, inside)).or_insert(next)
    };
    cells.map(kind).collect()
}

/// Parts the cells all of whose nodes belong to one body from the rest of their kinds of tissue.
pub(super) fn part_cells_of_bone(kinds: &mut [u16], mesh: &VolumeMesh, constraints: &[Constraint]) {
    let own = kinds.iter().max().map_or(0, |last| last.saturating_add(1));
    let cells = midpoint::cells_of_bodies(mesh, constraints);
    for (kind, _) in kinds.iter_mut().zip(cells).filter(|(_, is_bone)| *is_bone) {
        *kind = own;
    }
}
