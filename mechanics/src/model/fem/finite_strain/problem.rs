//! A problem of finite strain: tissue, its laws and elements, and what holds it.

use std::num::NonZeroU32;
use std::sync::Arc;

use super::elements::Elements;
use super::fibres::FibreField;
use crate::boundary::Constraint;
use crate::material::hyperelastic::Law;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::inner_stress::InnerStress;
use crate::model::fem::membrane::Membrane;
use crate::solver::Tolerance;

/// Hyperelastic tissue, and what holds it.
#[derive(Clone)]
pub struct FiniteStrain<'a> {
    pub mesh: &'a VolumeMesh,
    /// Positions of all nodes at rest in mm, those of the mesh first. `solve` adds those of edges where elements have them.
    pub nodes: &'a [Vector],
    pub laws: &'a [Law],
    /// For each cell its entry in `laws`.
    pub law_of_cell: &'a [u16],
    /// For each cell its kind of tissue, within which cells share the pressure at a node.
    pub pressure_of_cell: &'a [u16],
    pub elements: Elements,
    pub fibres: FibreField<'a>,
    /// The skin, where it is one.
    pub membrane: Option<&'a Membrane>,
    /// Growth and active stress of cells (`super::inner`).
    pub inner: Arc<InnerStress>,
    pub constraints: &'a [Constraint],
    pub tolerance: Tolerance,
    /// Whether stress and strain of the cells are wanted.
    pub with_states: bool,
    pub advance: Advance,
    /// Displacements by node, in mm, near which the solution is sought first where it is sought at once and without contact.
    pub near: Option<&'a [Vector]>,
}

/// How what moves, acts, grows and pulls is advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Advance {
    /// At once.
    AtOnce,
    /// At once, and in parts where that finds no rest, which may take five times as many steps.
    #[default]
    AtOnceOrInParts,
    /// In so many equal load steps, all of it in proportion. Each is at rest before the next one, and is made as the whole is
    /// otherwise.
    InSteps(NonZeroU32),
}
