//! The layered half head of the demo, coarser: bone under four layers of tissue with a band of muscle around the mouth,
//! a free gap between the jaws and lips on the skin.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{materials, rotated, shift};
use crate::boundary::NodeSelection;
use crate::mesh::half_head::{LAYERS, half_head as made};
use crate::mesh::{Frame, Vector, VolumeMesh};
use crate::prediction::{Bone, Case, CaseSegment, ElementChoice, Plan, RegionNames};
use crate::study::variant::{Strain, StudyScene, Truth};

/// 15 552 tetrahedra.
const FINENESS: usize = 3;

/// Muscle of 300 kPa in tissue of 50 kPa: the optimum of Zachow et al., Linear elastic tissue model, 2006, section 3.
/// The truth is quadratic tetrahedra of half the size.
pub fn half_head() -> StudyScene {
    let head = made(FINENESS);
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let plans = plans(&head.mesh);
    let segment = |name: &str| CaseSegment { name: name.to_owned(), nodes: set(name) };
    let bone = |name: &&'static str| Bone { name: (*name).to_owned(), surface: (*name).to_owned() };
    let part = |name: &str| (name.to_owned(), set(name));
    let names = (0..).zip(LAYERS).map(|(label, layer)| (label, layer.to_owned())).collect();
    let tissue =
        materials("muscle 300 kPa in 50 kPa", &[("*", 50.0, 0.455), ("muscle", 300.0, 0.44)]);
    let case = Case {
        frame: Frame::Lps,
        bones: head.bones.keys().map(bone).collect(),
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        skin: Some(set("skin")),
        skin_regions: BTreeMap::from(["nose", "lips", "chin"].map(part)),
        segments: vec![segment("maxilla"), segment("mandible")],
        fixed: vec![set("skull"), set("rim")],
        materials: tissue.by_region.clone(),
        surfaces: head
            .bones
            .into_iter()
            .map(|(name, surface)| (name.to_owned(), Arc::new(surface)))
            .collect(),
        volume: Arc::new(head.mesh),
        ..Case::default()
    };
    StudyScene {
        name: "half_head".to_owned(),
        case,
        plans,
        materials: vec![tissue],
        truth: Truth::Refined {
            times: 1,
            element: ElementChoice::Quadratic,
            strain: Strain::Small,
        },
    }
}

/// The same head with the mandible moved as far as jaws are moved; the truth is stabilised tetrahedra of half the size at finite
/// strain.
pub fn half_head_far() -> StudyScene {
    let near = half_head();
    let forward = -Vector::y();
    let pivot = middle(&near.case.volume, "mandible");
    let mut plans: Vec<(String, Plan)> =
        [10.0, 15.0, 25.0].map(|length| shift("mandible", length, forward)).into();
    plans.push(rotated("mandible", 20.0, Vector::x(), pivot));
    let (element, strain) = (ElementChoice::Stabilised, Strain::Finite);
    let truth = Truth::Refined { times: 1, element, strain };
    StudyScene { name: "half_head_far".to_owned(), plans, truth, ..near }
}

/// The mandible forward and turned up about the axis across its middle, the maxilla forward, and the jaws against each
/// other.
fn plans(mesh: &VolumeMesh) -> Vec<(String, Plan)> {
    let forward = -Vector::y();
    let pivot = middle(mesh, "mandible");
    let mut plans: Vec<(String, Plan)> =
        [1.0, 2.0, 4.0, 8.0].map(|length| shift("mandible", length, forward)).into();
    plans.extend([2.0, 5.0, 10.0].map(|angle| rotated("mandible", angle, Vector::x(), pivot)));
    let (name, mut maxilla) = shift("maxilla", 4.0, forward);
    plans.push((name, maxilla.clone()));
    let (_, mandible) = shift("mandible", 4.0, -forward);
    maxilla.segments.extend(mandible.segments);
    plans.push(("maxilla 4 mm, mandible -4 mm".to_owned(), maxilla));
    plans
}

/// The mean place of the nodes of a set.
fn middle(mesh: &VolumeMesh, set: &str) -> Vector {
    let nodes = mesh.node_set(set).unwrap_or_default();
    let sum: Vector = nodes.iter().map(|&node| mesh.nodes[node as usize]).sum();
    sum / nodes.len().max(1) as f64
}
