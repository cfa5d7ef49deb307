//! Point correspondence of two surfaces, where files state it.

use std::collections::BTreeMap;

use crate::mesh::TriangleSurface;

/// For each point of `prediction` its point of `actual`: by the node numbers of both where both have
/// them and they are the same set without repeats, else one by one where the triangles are the same.
pub fn corresponding_points(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
) -> Option<Vec<usize>> {
    by_node_ids(prediction, actual).or_else(|| by_triangles(prediction, actual))
}

fn by_node_ids(prediction: &TriangleSurface, actual: &TriangleSurface) -> Option<Vec<usize>> {
    let (ours, theirs) = (prediction.node_ids.as_ref()?, actual.node_ids.as_ref()?);
    if ours.len() != theirs.len() || ours.len() != prediction.points.len() {
        return None;
    }
    let place: BTreeMap<u32, usize> =
        theirs.iter().enumerate().map(|(place, &node)| (node, place)).collect();
    let pairs: Vec<usize> = ours.iter().filter_map(|node| place.get(node).copied()).collect();
    let is_one_to_one = place.len() == theirs.len() && pairs.len() == ours.len() && {
        let mut sorted = pairs.clone();
        sorted.sort_unstable();
        sorted.iter().enumerate().all(|(rank, &place)| rank == place)
    };
    is_one_to_one.then_some(pairs)
}

fn by_triangles(prediction: &TriangleSurface, actual: &TriangleSurface) -> Option<Vec<usize>> {
    let agrees =
        prediction.points.len() == actual.points.len() && prediction.triangles == actual.triangles;
    agrees.then(|| (0..prediction.points.len()).collect())
}
