//! Regions of tissue: nodes go to where two regions meet, and each cell is of the region at its middle.
//!
//! Where the ends of an edge lie in different regions, the end that is nearer to where these meet is moved there, so that no edge
//! passes from one to the other, as far as cells stay good. The surface between two regions consists of faces of cells: no
//! cell is in both, and the mesh is conforming.

use super::climb::Climb;
use super::draft::{Draft, FACES};
use super::error::MeshingError;
use super::watch::Watch;
use crate::domain::Domain;
use crate::mesh::{CellShape, Vector};

/// How often nodes are moved: first the ends of edges that pass from one region to another, then what cells still share, then
/// so that faces between regions enclose what their chords cut off.
const ROUNDS: [Nodes; 6] =
    [Nodes::Ends, Nodes::Ends, Nodes::Ends, Nodes::Shared, Nodes::Shared, Nodes::Chords];
/// The mean of a quadratic function that is zero at the corners of a triangle over its value in the middle.
const MEAN: f64 = 0.75;
/// Faces farther from where regions meet are no chords, in parts of their size.
const CHORD: f64 = 0.12;
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
    /// Of faces between two regions.
    Chords,
}

/// The region of each cell; empty where tissue is of one kind.
pub(super) fn part(climb: &mut Climb, watch: &Watch) -> Result<Vec<u8>, MeshingError> {
    if climb.domain.regions() < 2 {
        return Ok(Vec::new());
    }
    for round in ROUNDS {
        let wanted = match round {
            Nodes::Ends => ends(climb, watch)?,
            Nodes::Shared => {
                let regions = of_cells(climb, watch)?;
                projected(climb, &shared(climb.draft, &regions), watch)?
            }
            Nodes::Chords => {
                let regions = of_cells(climb, watch)?;
                chord_corrected(climb, &regions, watch)?
            }
        };
        let nodes = (0..wanted.len() as u32).filter(|&node| wanted[node as usize].is_some());
        let nodes: Vec<u32> = nodes.collect();
        climb.sweep(&nodes, watch, |climb, node| {
            let place = wanted[node as usize]?;
            climb.star(node).towards(&place, FAIR)
        })?;
    }
    of_cells(climb, watch)
}

/// For each node that is the nearer end of an edge between two regions the nearest place where these meet on such an edge.
fn ends(climb: &Climb, watch: &Watch) -> Result<Vec<Option<Vector>>, MeshingError> {
    let (draft, domain) = (&*climb.draft, climb.domain);
    let regions = watch.map(&draft.nodes, |at| domain.region(at))?;
    let found = watch.gather(&draft.tetrahedra, |cells, list| {
        let edges = cells
            .iter()
            .flat_map(|tet| CellShape::Tet4.edges().iter().map(|ends| ends.map(|end| tet[end])));
        list.extend(edges.filter_map(|edge| nearer_end(draft, domain, &regions, edge)));
    })?;
    let mut wanted: Vec<Option<Vector>> = vec![None; draft.nodes.len()];
    for (node, place) in found {
        let here = draft.nodes[node as usize];
        let wanted = &mut wanted[node as usize];
        let is_nearer = |known: &Vector| (place - here).norm() < (known - here).norm();
        if wanted.as_ref().is_none_or(is_nearer) {
            *wanted = Some(place);
        }
    }
    Ok(wanted)
}

/// The end of an edge that is to be moved, and the place on the edge where the regions of both meet.
fn nearer_end(
    draft: &Draft,
    domain: &dyn Domain,
    regions: &[u8],
    edge: [u32; 2],
) -> Option<(u32, Vector)> {
    let between = edge.map(|node| regions[node as usize]);
    if between[0] == between[1] {
        return None;
    }
    let places = edge.map(|node| draft.nodes[node as usize]);
    let meeting = domain.meeting(&places, between);
    let length = (places[1] - places[0]).norm();
    let off = places.map(|at| (meeting - at).norm() / length);
    if off[0].min(off[1]) <= ON {
        return None;
    }
    let mut ends = [(off[0], edge[0]), (off[1], edge[1])];
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_free =
        |&&(off, node): &&(f64, u32)| off < FAR && draft.boundaries[node as usize].is_empty();
    ends.iter().find(is_free).map(|&(_, node)| (node, meeting))
}

/// Where the two regions of a node meet near it.
fn projected(
    climb: &Climb,
    shared: &[Option<[u8; 2]>],
    watch: &Watch,
) -> Result<Vec<Option<Vector>>, MeshingError> {
    let nodes: Vec<u32> = (0..shared.len() as u32).collect();
    watch.map(&nodes, |&node| {
        let here = climb.draft.nodes[node as usize];
        shared[node as usize].map(|between| climb.domain.interface(&here, between))
    })
}

/// For each node of faces between regions the place at which these faces, as chords of the curved interface, enclose
/// the right volume.
fn chord_corrected(
    climb: &Climb,
    regions: &[u8],
    watch: &Watch,
) -> Result<Vec<Option<Vector>>, MeshingError> {
    let (draft, domain) = (&*climb.draft, climb.domain);
    let faces = faces_between(draft, regions);
    let ways = watch.map(&faces, |(face, between)| {
        let [a, b, c] = face.map(|node| draft.nodes[node as usize]);
        let (middle, area) = ((a + b + c) / 3.0, (b - a).cross(&(c - a)).norm());
        let way = (domain.interface(&middle, *between) - middle) * MEAN;
        let is_chord = way.norm() < CHORD * area.sqrt();
        (if is_chord { way * area } else { Vector::zeros() }, area)
    })?;
    let mut sums = vec![(Vector::zeros(), 0.0); draft.nodes.len()];
    for ((face, _), (way, area)) in faces.iter().zip(ways) {
        for &node in face {
            let sum = &mut sums[node as usize];
            *sum = (sum.0 + way, sum.1 + area);
        }
    }
    let shared = shared(draft, regions);
    let place = |(node, (way, area)): (usize, (Vector, f64))| {
        (shared[node].is_some() && area > 0.0).then(|| draft.nodes[node] + way / area)
    };
    Ok(sums.into_iter().enumerate().map(place).collect())
}

/// The faces between cells of two regions.
fn faces_between(draft: &Draft, regions: &[u8]) -> Vec<([u32; 3], [u8; 2])> {
    let mut faces: Vec<([u32; 3], u8)> = Vec::with_capacity(4 * draft.tetrahedra.len());
    for (tet, &region) in draft.tetrahedra.iter().zip(regions) {
        faces.extend(FACES.map(|face| {
            let mut nodes = face.map(|corner| tet[corner]);
            nodes.sort_unstable();
            (nodes, region)
        }));
    }
    faces.sort_unstable();
    let pairs = faces.windows(2).filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1);
    pairs.map(|pair| (pair[0].0, [pair[0].1, pair[1].1])).collect()
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
    enum RegionsAround {
        None,
        One(u8),
        Two([u8; 2]),
        More,
    }
    let mut seen = vec![RegionsAround::None; draft.nodes.len()];
    for (tet, &region) in draft.tetrahedra.iter().zip(regions) {
        for &node in tet {
            let seen = &mut seen[node as usize];
            *seen = match *seen {
                RegionsAround::None => RegionsAround::One(region),
                RegionsAround::One(one) if one != region => RegionsAround::Two([one, region]),
                RegionsAround::Two(pair) if !pair.contains(&region) => RegionsAround::More,
                RegionsAround::One(_) | RegionsAround::Two(_) | RegionsAround::More => *seen,
            };
        }
    }
    let each = seen.into_iter().zip(&draft.boundaries);
    each.map(|(seen, on)| match seen {
        RegionsAround::Two(pair) if on.is_empty() => Some(pair),
        RegionsAround::None
        | RegionsAround::One(_)
        | RegionsAround::Two(_)
        | RegionsAround::More => None,
    })
    .collect()
}
