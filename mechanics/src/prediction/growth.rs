//! Growth of a plan: tissue by region that gains volume or loses it, as an eigenstrain.
//!
//! Tissue that nothing holds keeps its shape: each length becomes (1 + volume_change)^(1/3) of what it was.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use super::case::{Growth, Plan};
use super::check::Check;
use super::error_code::SceneErrorCode;
use super::method::MethodKind;
use super::scene::{Scene, Tetrahedron};
use crate::mesh::Vector;
use crate::mesh::ignored::{listed, missing_region};
use crate::model::fem::inner_stress::{InnerStress, StressedTissue};
use crate::model::problem::{InvertedCell, LoadCase};

/// Shares of its volume that tissue may gain or lose: from half of it to twice of it.
pub const VOLUME_CHANGE: RangeInclusive<f64> = -0.5..=1.0;

/// eps_g: by how much each length changes, as a share of it.
pub fn linear_strain(volume_change: f64) -> f64 {
    (1.0 + volume_change).cbrt() - 1.0
}

/// Why `*` among names that grow means no cell, where each region has growth of its own.
pub fn nothing_left<'a>(
    growing: impl IntoIterator<Item = &'a str>,
    regions: &[String],
) -> Option<String> {
    let growing: BTreeSet<&str> = growing.into_iter().collect();
    let is_stated = |region: &String| growing.contains(region.as_str());
    (growing.contains("*") && regions.iter().all(is_stated)).then(|| {
        let known = listed(regions.iter());
        format!("every region has growth of its own, and no cell is left to `*`: omit it; there are: {known}")
    })
}

impl Scene {
    /// Adds what growth and muscles exert on nodes, in mN; nothing at finite strain, where cells have them.
    pub fn add_inner_forces(
        &self,
        inner: &InnerStress,
        forces: &mut [Vector],
    ) -> Result<(), InvertedCell> {
        if self.settings.method.kind() == MethodKind::FemNonlinear {
            return Ok(());
        }
        self.add_linear_inner_forces(inner, forces)
    }

    /// The load case of linear elements, whatever the method.
    pub(super) fn linear_load_case(&self) -> Result<LoadCase, InvertedCell> {
        let mut load_case = self.load_case();
        if self.settings.method.kind() == MethodKind::FemNonlinear {
            self.add_linear_inner_forces(&self.distributed.inner, &mut load_case.forces)?;
        }
        Ok(load_case)
    }

    fn add_linear_inner_forces(
        &self,
        inner: &InnerStress,
        forces: &mut [Vector],
    ) -> Result<(), InvertedCell> {
        let (edges, tissue) = (self.edge_nodes(), self.tissue());
        let has_pressures = self.tetrahedron() == Tetrahedron::Stabilised;
        let acted = StressedTissue { tissue: &tissue, has_pressures, edges: edges.as_ref() };
        inner.add_forces(&acted, forces)
    }

    /// The growth of a region by the linear strain `strain`; nothing where there is no such region. `*` stands for all.
    pub fn grown(&self, region: &str, strain: f64) -> Option<InnerStress> {
        let mut inner = InnerStress::default();
        let number = self.regions.iter().position(|name| name == region);
        if number.is_none() && region != "*" {
            return None;
        }
        let cells = self.region_of_cell.iter().enumerate();
        let grows = |own: u16| number.is_none_or(|number| number == usize::from(own));
        let cells = cells.filter(|(_, own)| grows(**own)).map(|(cell, _)| cell);
        inner.grow(self.mesh.cells.len(), cells, strain);
        Some(inner)
    }
}

impl Check<'_> {
    /// Adds what growth and active muscles of a plan do to a scene.
    pub(super) fn add_inner_stress(&mut self, plan: &Plan, scene: &mut Scene) {
        if plan.growth.is_empty() && plan.activations.is_empty() {
            return;
        }
        let mut inner = InnerStress::default();
        self.grow(plan, scene, &mut inner);
        self.activate(plan, scene, &mut inner);
        let mut forces = std::mem::take(&mut scene.forces);
        if let Some(edges) = scene.edge_nodes() {
            forces.resize(edges.node_count(), Vector::zeros());
        }
        if let Err(error) = scene.add_inner_forces(&inner, &mut forces) {
            let code = SceneErrorCode::MeshInvertedElements;
            self.problems.add("/case/volume", code, error.to_string());
        }
        scene.forces = forces;
        scene.distributed.inner = inner;
    }

    fn grow(&mut self, plan: &Plan, scene: &Scene, inner: &mut InnerStress) {
        let stated: BTreeSet<&str> = plan.growth.iter().map(|own| own.region.as_str()).collect();
        let mut seen = BTreeSet::new();
        for (index, growth) in plan.growth.iter().enumerate() {
            let pointer = format!("/plan/growth/{index}");
            let Growth { region, volume_change } = growth;
            if !seen.insert(region) {
                let detail = format!("region {region:?} grows twice");
                let at = format!("{pointer}/region");
                self.problems.add(at, SceneErrorCode::PlanConflict, detail);
            }
            self.volume_change(&pointer, *volume_change);
            let names = scene.regions.iter();
            let is_meant = |name: &str| match region.as_str() {
                "*" => !stated.contains(name),
                own => own == name,
            };
            let meant: Vec<bool> = names.map(|name| is_meant(name)).collect();
            if !meant.contains(&true) {
                let unknown = || missing_region(region, scene.regions.iter());
                let nothing_left = nothing_left(stated.iter().copied(), &scene.regions);
                let nothing_left = nothing_left.filter(|_| region == "*");
                let detail = nothing_left.unwrap_or_else(unknown);
                let at = format!("{pointer}/region");
                self.problems.add(at, SceneErrorCode::UnknownRegion, detail);
            }
            let cells = scene.region_of_cell.iter().enumerate();
            let cells = cells.filter(|(_, own)| meant[usize::from(**own)]).map(|(cell, _)| cell);
            inner.grow(scene.mesh.cells.len(), cells, linear_strain(*volume_change));
        }
    }

    fn volume_change(&mut self, pointer: &str, volume_change: f64) {
        if !VOLUME_CHANGE.contains(&volume_change) {
            let (least, most) = (VOLUME_CHANGE.start(), VOLUME_CHANGE.end());
            let detail = format!(
                "the volume changes by {volume_change} of itself, which is outside {least} to {most}"
            );
            let at = format!("{pointer}/volume_change");
            self.problems.add(at, SceneErrorCode::PlanOutOfRange, detail);
        }
    }
}
