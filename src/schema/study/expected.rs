//! Expected cost of a study, reported on acceptance.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::methods::time_band;
use crate::schema::predict::time_band::TimeBandDocument;
use mechanics::prediction::NEWTON_MAY_TAKE;
use mechanics::study::{Strain, Study, StudyScene, TruthCost, truth_cost};

/// The cost of the reference solution of one scene on finer meshes; not part of any row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TruthCostDocument {
    pub scene: String,
    /// The finest mesh, and one or two before it to estimate its error.
    pub meshes: u64,
    /// Its method: `fem_linear`, or `fem_nonlinear` at finite strain.
    #[serde(default = "linear")]
    pub method: String,
    /// Of the finest.
    pub cells: u64,
    /// Of the finest.
    pub unknowns: u64,
    /// On each mesh, for all plans and materials, with and without contact like the rows.
    pub solves: u64,
    /// Of all solves on one thread, in s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub time_s: Option<TimeBandDocument>,
}

fn linear() -> String {
    Strain::Small.method().kind().name().to_owned()
}

/// The computed reference solutions of scenes.
pub fn truth_costs(study: &Study) -> Vec<TruthCostDocument> {
    let cost = |(place, scene): (usize, &StudyScene)| {
        Some(document(&scene.name, &truth_cost(scene, study.variants_of(place))?))
    };
    study.scenes.iter().enumerate().filter_map(cost).collect()
}

fn document(scene: &str, cost: &TruthCost) -> TruthCostDocument {
    let finest = cost.meshes.last();
    let of_finest = |value: Option<f64>| value.unwrap_or_default() as u64;
    TruthCostDocument {
        scene: scene.to_owned(),
        meshes: cost.meshes.len() as u64,
        method: cost.strain.method().kind().name().to_owned(),
        cells: of_finest(finest.map(|mesh| mesh.cells)),
        unknowns: of_finest(finest.map(|mesh| mesh.unknowns)),
        solves: finest.map_or(0, |mesh| mesh.solves as u64),
        time_s: time_s(cost),
    }
}

fn time_s(cost: &TruthCost) -> Option<TimeBandDocument> {
    let mut all = TimeBandDocument { low: 0.0, high: 0.0 };
    for mesh in &cost.meshes {
        let band = of_one(cost.strain, mesh.unknowns as u64)?;
        all.low += band.low * mesh.solves as f64;
        all.high += band.high * mesh.solves as f64;
    }
    Some(all)
}

/// Of one solve. If Newton's method was not measured, the linear solves that it may take.
fn of_one(strain: Strain, unknowns: u64) -> Option<TimeBandDocument> {
    let method = strain.method().kind().name();
    time_band(method, unknowns).or_else(|| {
        let linear = time_band(&linear(), unknowns)?;
        let [low, high] = NEWTON_MAY_TAKE;
        Some(TimeBandDocument { low: low * linear.low, high: high * linear.high })
    })
}

impl TruthCostDocument {
    /// In one line.
    pub fn sentence(&self) -> String {
        let TruthCostDocument { scene, meshes, method, cells, unknowns, solves, time_s } = self;
        let time = time_s.map_or_else(String::new, |time| {
            format!(": {:.0} to {:.0} s on one thread", time.low, time.high)
        });
        let times = if *solves == 1 { "once".to_owned() } else { format!("{solves} times") };
        format!(
            "the truth of {scene} is solved by `{method}` on {meshes} meshes, {times} on each, the finest with {cells} cells and {unknowns} unknowns{time}"
        )
    }
}
