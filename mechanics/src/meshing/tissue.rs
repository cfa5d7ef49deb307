//! Meshing of a body: the path from the sign of its function to tetrahedra.

use super::boundary_set::BoundarySet;
use super::check::check;
use super::climb::Climb;
use super::cuts::Cuts;
use super::draft::Draft;
use super::error::MeshingError;
use super::gaps::{self, Gap};
use super::grid::Grid;
use super::lattice::Lattice;
use super::lost::{Cells, Lost};
use super::octree::Leaves;
use super::pieces::Piece;
use super::pinches::Pinched;
use super::refine::Refinement;
use super::report::{Angles, MeshingReport};
use super::rims::clear_inner;
use super::settings::MeshingSettings;
use super::size::SizeField;
use super::warp::Warp;
use super::watch::Watch;
use super::{
    apart, creases, edge_copies, fitting, pieces, pinches, regions, stencils, target,
    touching_voids,
};
use crate::domain::{Boundary, Domain};
use crate::mesh::{CellShape, VolumeMesh};
use crate::progress::{Phase, Progress};

/// Stages that progress tells of.
const STAGES: usize = 8;
/// A piece that is less than this share of all tissue is refused.
const LEAST_KEPT: f64 = 1.0 / 3.0;
/// Less than one in so many of the cells that were asked for is refused.
const FEWEST_OF_TARGET: usize = 4;

/// Soft tissue as it comes out of a mesher.
#[derive(Clone, Debug, PartialEq)]
pub struct TissueMesh {
    /// Tetrahedra of positive volume; no sets, and no labels but those of regions, where there are several.
    pub volume: VolumeMesh,
    /// For each node the boundaries of the body that it lies on.
    pub boundaries: Vec<BoundarySet>,
    pub report: MeshingReport,
}

impl TissueMesh {
    /// The nodes on a boundary, ascending.
    pub fn nodes_on(&self, boundary: Boundary) -> Vec<u32> {
        let on = self.boundaries.iter().enumerate().filter(|(_, set)| set.contains(boundary));
        on.map(|(node, _)| node as u32).collect()
    }
}

/// Counts of the stages before cells are improved.
#[derive(Default)]
struct Counts {
    leaves: usize,
    snapped: usize,
    undone: usize,
    pinched: Pinched,
    gaps: Vec<Gap>,
}

/// Meshes a body. The same body and settings give the same mesh, bit by bit, on any number of threads.
pub fn mesh(
    domain: &dyn Domain,
    settings: &MeshingSettings,
    progress: &dyn Progress,
) -> Result<TissueMesh, MeshingError> {
    progress.phase(Phase::Mesh);
    settings.check()?;
    let mut watch = Watch::new(progress, STAGES);
    watch.stage()?;
    let (low, high) = domain.bounds();
    let size = target::size_field(domain, settings, &watch)?.bounded((high - low).max());
    let (leaves, mut draft, counts) = fill_lattice(domain, settings, &size, &mut watch)?;
    watch.stage()?;
    let edges_cut = edge_copies::part(&mut draft);
    let dropped = (!settings.keep_pieces).then(|| pieces::drop_small(&mut draft));
    let dropped = dropped.unwrap_or_default();
    refuse_remnant(&draft, &dropped.pieces)?;
    refuse_too_few(&draft, settings, size.finest)?;
    let voids_touching = if settings.part_copies { touching_voids::part(&mut draft) } else { 0 };
    watch.stage()?;
    let raw_angles = Angles::of(&draft);
    let mut climb = Climb::new(&mut draft, domain);
    let creased = creases::snap_creases(&mut climb, &watch)?;
    climb.climb(settings.sweeps, &watch)?;
    climb.settle(&watch)?;
    let regions = regions::part(&mut climb, &watch)?;
    let fitted = fitting::fit(&mut climb, &watch)?;
    let crossings = if settings.part_copies { apart::part(&mut climb, &watch)? } else { 0 };
    watch.stage()?;
    let faces = check(&draft, !settings.keep_pieces)?;
    clear_inner(&mut draft, &faces);
    let cells = Cells { draft: &draft, faces: &faces, dropped: &dropped.cells };
    let lost = settings.find_gaps.then(|| Lost::find(&leaves, &cells, domain, &watch));
    let lost = lost.transpose()?.unwrap_or_default();
    let volume: f64 = draft.tetrahedra.iter().map(|tet| draft.volume(tet)).sum();
    let report = MeshingReport {
        nodes: draft.nodes.len(),
        tetrahedra: draft.tetrahedra.len(),
        boundary_triangles: faces.len(),
        volume,
        raw_angles,
        angles: Angles::of(&draft),
        finest: size.finest,
        leaves: counts.leaves,
        snapped: counts.snapped,
        undone: counts.undone,
        copies: counts.pinched.copies,
        stepped_back: counts.pinched.stepped_back,
        edges_cut,
        creased,
        fitted,
        dropped: dropped.pieces,
        gaps_closed: counts.gaps,
        crossings,
        voids_touching,
        volume_lost: lost.volume,
        pieces_lost: lost.pieces,
    };
    watch.end();
    Ok(finished(draft, &regions, report))
}

/// Refuses the largest piece of tissue that holds together nowhere, as in an image of noise.
fn refuse_remnant(draft: &Draft, dropped: &[Piece]) -> Result<(), MeshingError> {
    let ml = |mm3: f64| mm3 / 1000.0;
    let kept = ml(draft.tetrahedra.iter().map(|tet| draft.volume(tet)).sum());
    let all = kept + ml(dropped.iter().map(|piece| piece.volume).sum());
    match kept < LEAST_KEPT * all {
        true => Err(MeshingError::Scattered { pieces: dropped.len() + 1, all, kept }),
        false => Ok(()),
    }
}

/// Refuses a small part of the cells that were asked for, which is what is left where cells are larger than tissue is thick.
fn refuse_too_few(
    draft: &Draft,
    settings: &MeshingSettings,
    finest: f64,
) -> Result<(), MeshingError> {
    let (made, target) = (draft.tetrahedra.len(), settings.target.unwrap_or(0));
    match made < target / FEWEST_OF_TARGET {
        true => Err(MeshingError::TooFew { made, target, finest }),
        false => Ok(()),
    }
}

/// Fills the body with the cells of a warped lattice.
fn fill_lattice(
    domain: &dyn Domain,
    settings: &MeshingSettings,
    size: &SizeField,
    watch: &mut Watch,
) -> Result<(Leaves, Draft, Counts), MeshingError> {
    let (low, high) = domain.bounds();
    let grid = Grid::new(&low, &high, size)?;
    let refinement = Refinement { domain, size, most: settings.most_tetrahedra, keeps_thin: true };
    let leaves: Leaves = refinement.leaves(grid, watch)?;
    watch.stage()?;
    let lattice = Lattice::new(&leaves, domain, watch)?;
    if lattice.tetrahedra.is_empty() {
        return Err(MeshingError::Empty { low, high, size: size.finest });
    }
    let gaps = match settings.find_gaps {
        true => gaps::find(&lattice, &leaves, domain, watch)?,
        false => Vec::new(),
    };
    watch.stage()?;
    let cuts = Cuts::new(&lattice, domain, watch)?;
    watch.stage()?;
    let mut warp = Warp::new(&lattice, cuts, domain);
    let (fans, pinched) = pinches::part(&mut warp);
    watch.stage()?;
    let draft = stencils::fill(&warp, &fans, watch)?;
    let counts = Counts {
        leaves: leaves.list.len(),
        snapped: warp.snapped,
        undone: warp.undone,
        pinched,
        gaps,
    };
    if draft.tetrahedra.is_empty() {
        return Err(MeshingError::Empty { low, high, size: size.finest });
    }
    Ok((leaves, draft, counts))
}

/// The array of cells that says their regions, where tissue is of several.
pub const REGIONS: &str = "region";

fn finished(draft: Draft, regions: &[u8], report: MeshingReport) -> TissueMesh {
    let mut volume = VolumeMesh { nodes: draft.nodes, ..VolumeMesh::default() };
    for tet in &draft.tetrahedra {
        volume.cells.push(CellShape::Tet4, tet);
    }
    if !regions.is_empty() {
        let labels = regions.iter().map(|&region| i64::from(region)).collect();
        volume.cell_labels.insert(REGIONS.to_owned(), labels);
    }
    TissueMesh { volume, boundaries: draft.boundaries, report }
}
