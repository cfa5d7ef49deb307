//! Regions of tissue: nodes go to where two regions meet, and each cell is of the region at its middle.
//!
//! Where the ends of an edge lie in different regions, the end that is nearer to where these meet is moved there, so that no edge
//! passes from one to the other, as far as cells stay good. The surface between two regions consists of faces of cells: no
//! cell is in both, and the mesh is conforming.

use super::climb::Climb;
use super::draft::Draft;
use super::error::MeshingError;
use super::watch::Watch;
use crate::domain::Domain;
use crate::mesh::{CellShape, Vector};

/// How often nodes are moved: first the ends of edges that pass from one region to another, then what cells still share.
const ROUNDS: [Nodes; 5] = [Nodes::Ends, Nodes::Ends, Nodes::Ends, Nodes::Shared, Nodes::Shared];
/// Angles stay above 17 degrees, or do not get worse.
const FAIR: f64 = 0.3;
/// An end this near to where regions meet lies on it, in parts of the edge.
const ON: f64 = 0.02;
/// An end farther away than this part of the edge stays.
const FAR: f64 = 0.6;

/// Which nodes are moved.
#[derive(Clone, Copy)]
enum Nodes {
    /// Of edges between two regions.
    Ends,
    /// Of cells of two regions.
    Shared,
}

/// The region of each cell; empty where tissue is of one kind.
pub(super) fn part(climb: &mut Climb, watch: &Watch) -> Result<Vec<u8>, MeshingError> {
    if climb.domain.regions() < 2 {
        return Ok(Vec::new());
    }
    for round in ROUNDS {
        let pairs = match round {
            Nodes::Ends => ends(climb, watch)?,
            Nodes::Shared => shared(climb.draft, &of_cells(climb, watch)?),
        };
        let nodes = (0..pairs.len() as u32).filter(|&node| pairs[node as usize].is_some());
        let nodes: Vec<u32> = nodes.collect();
        climb.sweep(&nodes, watch, |climb, node| {
            let pair = pairs[node as usize]?;
            climb.star(node).at_interface(pair, FAIR)
        })?;
    }
    of_cells(climb, watch)
}

/// For each node that is the nearer end of an edge between two regions these two.
fn ends(climb: &Climb, watch: &Watch) -> Result<Vec<Option<[u8; 2]>>, MeshingError> {
    let (draft, domain) = (&*climb.draft, climb.domain);
    let regions = watch.map(&draft.nodes, |at| domain.region(at))?;
    let found = watch.gather(&draft.tetrahedra, |cells, list| {
        let edges = cells
            .iter()
            .flat_map(|tet| CellShape::Tet4.edges().iter().map(|ends| ends.map(|end| tet[end])));
        list.extend(edges.filter_map(|edge| nearer_end(draft, domain, &regions, edge)));
    })?;
    let mut pairs = vec![None; draft.nodes.len()];
    for (node, pair) in found {
        pairs[node as usize].get_or_insert(pair);
    }
    Ok(pairs)
}

/// The end of an edge that is to be moved, and the regions of both.
fn nearer_end(
    draft: &Draft,
    domain: &dyn Domain,
    regions: &[u8],
    edge: [u32; 2],
) -> Option<(u32, [u8; 2])> {
    let [one, other] = edge.map(|node| regions[node as usize]);
    let pair = [one.min(other), one.max(other)];
    if one == other {
        return None;
    }
    let places = edge.map(|node| draft.nodes[node as usize]);
    let length = (places[1] - places[0]).norm();
    let off = places.map(|at| (domain.interface(&at, pair) - at).norm() / length);
    if off[0].min(off[1]) <= ON {
        return None;
    }
    let mut ends = [(off[0], edge[0]), (off[1], edge[1])];
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_free =
        |&&(off, node): &&(f64, u32)| off < FAR && draft.boundaries[node as usize].is_empty();
    ends.iter().find(is_free).map(|&(_, node)| (node, pair))
}

fn of_cells(climb: &Climb, watch: &Watch) -> Result<Vec<u8>, MeshingError> {
    let draft = &*climb.draft;
    let region = |tet: &[u32; 4]| {
        let sum: Vector = draft.corners(tet).iter().sum();
        climb.domain.region(&(sum / 4.0))
    };
    watch.map(&draft.tetrahedra, region)
}

/// For each node within tissue the two regions of its cells, if it has two.
fn shared(draft: &Draft, regions: &[u8]) -> Vec<Option<[u8; 2]>> {
    /// What the cells of a node have in common.
    #[derive(Clone, Copy)]
    enum Seen {
        None,
        One(u8),
        Two([u8; 2]),
        More,
    }
    let mut seen = vec![Seen::None; draft.nodes.len()];
    for (tet, &region) in draft.tetrahedra.iter().zip(regions) {
        for &node in tet {
            let seen = &mut seen[node as usize];
            *seen = match *seen {
                Seen::None => Seen::One(region),
                Seen::One(one) if one != region => Seen::Two([one, region]),
                Seen::Two(pair) if !pair.contains(&region) => Seen::More,
                Seen::One(_) | Seen::Two(_) | Seen::More => *seen,
            };
        }
    }
    let each = seen.into_iter().zip(&draft.boundaries);
    each.map(|(seen, on)| match seen {
        Seen::Two(pair) if on.is_empty() => Some(pair),
        Seen::None | Seen::One(_) | Seen::Two(_) | Seen::More => None,
    })
    .collect()
}
