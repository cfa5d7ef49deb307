//! Tissue that is in no mesh: parts that do not hang together with the body, and what is thinner than cells.

use crate::domain::LeftOut;
use crate::mesh::{Vector, Warning};
use crate::meshing::{Gap, LostPiece, MeshingReport};

/// Pieces of a scan of less than this share of what is kept are the table and tubes that its report tells of.
const LARGE_OBJECT: f64 = 0.1;
/// Smaller pieces are noise, in ml.
const LEAST: f64 = 1.0;
/// Less than this share of a mesh is what cells are too coarse for.
const SHARE: f64 = 0.01;
/// Less tissue in no cell than this share is what cells are too coarse for; nodes of cells of 6 mm count a ball to 1 %.
const MOST_LOST: f64 = 0.025;
/// Of tissue in one piece, in ml; whole heads have pieces of 1.5 ml.
const LEAST_PIECE: f64 = 2.0;
/// Shorter gaps in the skin are folds, as behind ears (15 to 17 mm in the CT of docs/meshing.md), in mm.
const SMALL_GAP: f64 = 20.0;
/// So many places are named.
const TOLD: usize = 3;
const MM3_IN_ML: f64 = 1000.0;

/// The largest of some pieces, and all of them. Volumes in ml.
struct Pieces {
    count: usize,
    all: f64,
    largest: f64,
    centre: Vector,
    kept: f64,
}

/// What of a scan lies apart from its body, unless its report tells of it and it is small.
pub fn left_out_of_scan(left: &LeftOut, told: &[Warning]) -> Option<Warning> {
    let is_told = told.iter().any(|warning| warning.code == "objects-beside-head");
    let least = if is_told { LARGE_OBJECT * left.kept } else { LEAST };
    let LeftOut { pieces: count, all, largest, centre, kept } = *left;
    let pieces = Pieces { count, all, largest, centre, kept };
    (largest > least).then(|| pieces.warning("tissue and bone of the scan"))
}

/// Pieces that the mesher left out.
pub(super) fn left_out_of_mesh(report: &MeshingReport) -> Option<Warning> {
    let ml = |mm3: f64| mm3 / MM3_IN_ML;
    let first = report.dropped.first()?;
    let pieces = Pieces {
        count: report.dropped.len(),
        all: ml(report.dropped_volume()),
        largest: ml(first.volume),
        centre: first.centre,
        kept: ml(report.volume),
    };
    (pieces.all > SHARE * pieces.kept).then(|| pieces.warning("tissue"))
}

/// Tissue thinner than cells, which the mesh lacks.
pub(super) fn thinner_than_cells(report: &MeshingReport) -> Option<Warning> {
    let ml = |mm3: f64| mm3 / MM3_IN_ML;
    let lost = ml(report.volume_lost);
    let of =
        |piece: &LostPiece| format!("{:.1} ml around ({}) mm", ml(piece.volume), place(&piece.at));
    let places: Vec<String> = report.pieces_lost.iter().take(TOLD).map(of).collect();
    let largest = ml(report.pieces_lost.first().map_or(0.0, |piece| piece.volume));
    let detail = format!(
        "{:.1} ml of tissue thinner than cells is missing from the mesh, in one piece {}; {:.0} ml are meshed, with cubes of {:.1} mm at \
         the finest; more tetrahedra, or `size.fine` there, resolve it",
        lost,
        places.join(", "),
        ml(report.volume),
        report.finest
    );
    let is_told = largest > LEAST_PIECE || lost > MOST_LOST * ml(report.volume) && lost > LEAST;
    let warning = || Warning::new("thin-tissue-lost", detail).with("volume_ml", lost);
    is_told.then(|| warning().with("largest_ml", largest))
}

/// Air between tissue and tissue that reaches the outer air, as between lips, and is tissue in the mesh.
pub(super) fn gaps_closed(report: &MeshingReport) -> Option<Warning> {
    let gaps = report.gaps_closed.iter().filter(|gap| gap.at_skin);
    let gaps: Vec<&Gap> = gaps.filter(|gap| (gap.high - gap.low).amax() > SMALL_GAP).collect();
    let of = |gap: &&Gap| {
        format!("{:.0} mm long around ({})", (gap.high - gap.low).amax(), place(&gap.centre))
    };
    let largest: Vec<String> = gaps.iter().take(TOLD).map(of).collect();
    let detail = format!(
        "{} gaps of the skin thinner than cells are tissue in the mesh: {} mm. What is on both sides of one moves together there, as closed \
         lips do; more tetrahedra, or `size.fine` there, keep it open",
        gaps.len(),
        largest.join(", ")
    );
    let warning = || Warning::new("gaps-closed", detail).with("gaps", gaps.len() as f64);
    (!gaps.is_empty()).then(warning)
}

/// A boundary without coincident nodes that touches or crosses itself all the same.
pub(super) fn touching_itself(report: &MeshingReport) -> Option<Warning> {
    let MeshingReport { crossings, voids_touching, .. } = report;
    let detail = format!(
        "no nodes coincide, but {crossings} pairs of triangles of the boundary cross, and it touches itself at {voids_touching} nodes: \
         programs that fill a boundary with cells may refuse it"
    );
    let warning = || {
        let warning = Warning::new("boundary-touches-itself", detail);
        warning.with("crossings", *crossings as f64).with("nodes", *voids_touching as f64)
    };
    (*crossings > 0 || *voids_touching > 0).then(warning)
}

fn place(at: &Vector) -> String {
    format!("{:.0}, {:.0}, {:.0}", at.x, at.y, at.z)
}

impl Pieces {
    fn warning(&self, what: &str) -> Warning {
        let Pieces { count, all, largest, centre, kept } = self;
        let [x, y, z] = (*centre).into();
        let detail = format!(
            "{all:.1} ml of {what} in {count} pieces hang together with the rest nowhere and are left out, the largest with \
             {largest:.1} ml around ({x:.0}, {y:.0}, {z:.0}) mm; {kept:.1} ml are kept"
        );
        let warning = Warning::new("tissue-left-out", detail);
        let share = all / (all + kept);
        warning.with("volume_ml", *all).with("largest_ml", *largest).with("share", share)
    }
}
