//! Loads: forces at nodes, tractions and pressures on faces, gravity.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::movement::MovementContext;
use crate::schema::Triple;
use crate::schema::case::selection::SelectionDocument;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::prediction::Load;

/// Largest component of a force in mN, a traction or pressure in kPa, an acceleration in m/s².
const LARGEST_LOAD: f64 = 1e9;
/// 1 m/s² in mm/ms².
const MM_PER_MS2: f64 = 1e-3;

/// Exactly one of `force_millinewton` with `nodes`, `traction_kpa` with `faces`, `pressure_kpa` with `faces`,
/// or `gravity_m_per_s2`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadDocument {
    /// The force at each of the nodes in mN; its former name `force_mn` is read too.
    #[serde(default, alias = "force_mn", skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub force_millinewton: Option<Triple>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub nodes: Option<SelectionDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub traction_kpa: Option<Triple>,
    /// Positive into the body; at finite strain (`fem_nonlinear`) on its faces as they lie in the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub pressure_kpa: Option<f64>,
    /// Boundary faces all of whose nodes are selected.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub faces: Option<SelectionDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub gravity_m_per_s2: Option<Triple>,
}

/// The loads in the frame of the case.
pub fn to_loads(
    documents: &[LoadDocument],
    at: &Pointer,
    context: &MovementContext,
    faults: &mut Faults,
) -> Vec<Load> {
    faults.check_length(at, documents.len(), context.limits.list_entries as usize);
    let documents = documents.iter().enumerate();
    documents
        .filter_map(|(index, document)| document.to_load(&at.index(index), context, faults))
        .collect()
}

impl LoadDocument {
    fn to_load(
        &self,
        at: &Pointer,
        context: &MovementContext,
        faults: &mut Faults,
    ) -> Option<Load> {
        let forms = [
            self.force_millinewton.is_some(),
            self.traction_kpa.is_some(),
            self.pressure_kpa.is_some(),
            self.gravity_m_per_s2.is_some(),
        ];
        let given = forms.into_iter().filter(|&form| form).count();
        let names = "`force_millinewton`, `traction_kpa`, `pressure_kpa`, `gravity_m_per_s2`";
        if !faults.check_one_of(at, given, names) {
            return None;
        }
        self.check_sizes(at, faults);
        let on_faces = self.traction_kpa.is_some() || self.pressure_kpa.is_some();
        let wanted = [
            ("nodes", self.force_millinewton.is_some(), &self.nodes),
            ("faces", on_faces, &self.faces),
        ];
        let mut selection = None;
        for (name, needed, document) in wanted {
            match (needed, document) {
                (true, Some(document)) => {
                    selection = document.to_selection(&at.key(name), context.limits, faults);
                }
                (true, None) => {
                    faults.add(
                        &at.key(name),
                        ErrorCode::MissingField,
                        format!("missing field `{name}`"),
                    );
                }
                (false, Some(_)) => {
                    let detail = format!("`{name}` does not belong to this load");
                    faults.add(&at.key(name), ErrorCode::UnknownField, detail);
                }
                (false, None) => {}
            }
        }
        if let Some(gravity) = self.gravity_m_per_s2 {
            let acceleration = context.vector(gravity) * MM_PER_MS2;
            return Some(Load::Gravity { acceleration });
        }
        let selected = selection?;
        if let Some(force) = self.force_millinewton {
            let force = context.vector(force);
            return Some(Load::Force { nodes: selected, force });
        }
        Some(match self.traction_kpa {
            Some(traction) => {
                Load::Traction { faces: selected, traction: context.vector(traction) }
            }
            None => Load::Pressure { faces: selected, pressure: self.pressure_kpa? },
        })
    }

    fn check_sizes(&self, at: &Pointer, faults: &mut Faults) {
        let vectors = [
            ("force_millinewton", self.force_millinewton),
            ("traction_kpa", self.traction_kpa),
            ("gravity_m_per_s2", self.gravity_m_per_s2),
        ];
        for (name, vector) in vectors {
            for (axis, value) in vector.unwrap_or_default().0.into_iter().enumerate() {
                let place = at.key(name).index(axis);
                faults.check_range(&place, value, -LARGEST_LOAD..=LARGEST_LOAD, "");
            }
        }
        if let Some(pressure) = self.pressure_kpa {
            let place = at.key("pressure_kpa");
            faults.check_range(&place, pressure, -LARGEST_LOAD..=LARGEST_LOAD, "kPa");
        }
    }
}
