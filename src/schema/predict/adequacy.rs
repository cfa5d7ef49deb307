//! Choice of the cheapest adequate model.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::{Accepted, Adequate, Considered, MeanErrors};

/// The choice of the method `auto`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AdequacyDocument {
    /// The accepted mean error over the skin, in mm.
    pub accepted_mm: f64,
    /// The same over parts of the skin.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub accepted_regions_mm: BTreeMap<String, f64>,
    /// Whether the estimate of the model that was taken is within it, and there are no `objections`.
    pub met: bool,
    /// Codes of warnings that no estimate of an error contains, and with which no answer is adequate: cells that are inside out, skin
    /// that passes through itself by more than is accepted, contact that leaves parts in each other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objections: Vec<String>,
    /// The chosen model: `linear`, `second_order` or `finite_strain`, or one of these with its estimated mesh error
    /// added: `corrected`, `second_order_corrected`, `finite_strain_corrected`.
    pub taken: String,
    /// Mean errors over the skin, estimated with the linear solution, in mm: of the mesh, and of linearity.
    /// Absent if unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mesh_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub linearity_mm: Option<f64>,
    /// Error of the second-order solution, if it was tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub third_order_mm: Option<f64>,
    /// Mesh error at finite strain, if that was tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub mesh_at_rest_mm: Option<f64>,
    /// From the cheapest to the most expensive.
    pub rungs: Vec<RungDocument>,
}

/// A model that was considered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RungDocument {
    pub name: String,
    /// Its expected mean error over the skin, in mm; absent if unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error_mm: Option<f64>,
    /// The same over the parts of the skin with an accepted error.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub regions_mm: BTreeMap<String, f64>,
    /// Expected and actual time, in s, including its error estimates. A corrected solution is an
    /// existing one, and takes no time.
    pub expected_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub spent_s: Option<f64>,
    /// Why it was not tried or not possible, or why the search ended here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub passed_over: Option<String>,
}

impl AdequacyDocument {
    pub fn new(accepted: &Accepted, adequate: &Adequate) -> Self {
        AdequacyDocument {
            accepted_mm: accepted.skin_mm,
            accepted_regions_mm: accepted.regions_mm.clone(),
            met: adequate.is_met,
            objections: adequate.objections.iter().map(|own| own.warning.code.to_owned()).collect(),
            taken: adequate.rung.name().to_owned(),
            mesh_mm: over_skin(&adequate.errors.mesh),
            linearity_mm: over_skin(&adequate.errors.linearity),
            third_order_mm: over_skin(&adequate.errors.third_order),
            mesh_at_rest_mm: over_skin(&adequate.errors.mesh_at_rest),
            rungs: adequate.considered.iter().map(RungDocument::from).collect(),
        }
    }

    /// In words.
    pub fn why(&self) -> String {
        let taken = self.rungs.iter().find(|rung| rung.name == self.taken);
        let Some(error) = taken.and_then(|rung| rung.error_mm) else {
            return format!(
                "`{}` is used; its error is unknown, so it may not be within the accepted {} mm",
                self.taken, self.accepted_mm
            );
        };
        let of_regions = taken.map(|rung| &rung.regions_mm).into_iter().flatten();
        let mut over = of_regions.filter(|(name, error)| {
            self.accepted_regions_mm.get(*name).is_some_and(|accepted| *error > accepted)
        });
        let is_accepted = error <= self.accepted_mm && over.next().is_none();
        let (taken, wanted) = (&self.taken, self.accepted_mm);
        let told =
            format!("`{taken}`, expected mean error {error:.3} mm over the skin that moves:");
        let objections = self.objections.join(", ");
        match (objections.is_empty(), is_accepted) {
            (true, true) => format!("{told} the cheapest model within {wanted} mm"),
            (true, false) => format!(
                "{told} no model reaches the accepted errors ({wanted} mm); this is the cheapest within 25 % of the best"
            ),
            (false, _) => format!(
                "{told} it may not be within {wanted} mm, because no error estimate includes {objections}"
            ),
        }
    }
}

fn over_skin(errors: &Option<MeanErrors>) -> Option<f64> {
    errors.as_ref().map(|errors| errors.skin_mm)
}

impl From<&Considered> for RungDocument {
    fn from(considered: &Considered) -> Self {
        RungDocument {
            name: considered.rung.name().to_owned(),
            error_mm: over_skin(&considered.error),
            regions_mm: considered
                .error
                .as_ref()
                .map_or_else(BTreeMap::new, |error| error.regions_mm.clone()),
            expected_s: considered.expected_s,
            spent_s: considered.spent_s,
            passed_over: considered.passed_over.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(objections: &[&str], error_mm: f64, of_region_mm: f64) -> String {
        let rung = RungDocument {
            name: "linear".to_owned(),
            error_mm: Some(error_mm),
            regions_mm: [("lips".to_owned(), of_region_mm)].into(),
            expected_s: 1.0,
            spent_s: Some(1.0),
            passed_over: None,
        };
        let document = AdequacyDocument {
            accepted_mm: 0.1,
            accepted_regions_mm: [("lips".to_owned(), 0.2)].into(),
            met: false,
            objections: objections.iter().map(|code| (*code).to_owned()).collect(),
            taken: "linear".to_owned(),
            mesh_mm: None,
            linearity_mm: None,
            third_order_mm: None,
            mesh_at_rest_mm: None,
            rungs: vec![rung],
        };
        document.why()
    }

    #[test]
    fn an_accepted_error_that_is_not_met_is_no_error_that_falls_short() {
        assert!(chosen(&[], 0.05, 0.1).contains("the cheapest model within 0.1 mm"));
        let inverted = chosen(&["cells-inverted"], 0.05, 0.1);
        assert!(inverted.ends_with("0.1 mm, because no error estimate includes cells-inverted"));
        for short in [chosen(&[], 0.15, 0.1), chosen(&[], 0.05, 0.3)] {
            assert!(short.contains("no model reaches the accepted errors (0.1 mm)"), "{short}");
        }
    }
}
