//! Tissue that is in no mesh: parts that do not hang together with the body, and what is thinner than cells.

use crate::domain::LeftOut;
use crate::mesh::{Vector, Warning};
use crate::meshing::MeshingReport;

/// Pieces of a scan of less than this share of what is kept are the table and tubes that its report tells of.
const LARGE_OBJECT: f64 = 0.1;
/// Smaller pieces are noise, in ml.
const LEAST: f64 = 1.0;
/// Less than this share of a mesh is what cells are too coarse for.
const SHARE: f64 = 0.01;
/// Less tissue in no cell than this share is what cells are too coarse for; nodes of cells of 6 mm count a ball to 1 %.
const MOST_LOST: f64 = 0.025;
/// Less of the bone than this share, meshed as tissue, is what cells are too coarse for.
const MOST_FILLED: f64 = 0.03;
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

/// Tissue thinner than cells, which the mesh lacks, and bone thinner than cells, which is tissue in it.
pub(super) fn thinner_than_cells(report: &MeshingReport, bone: f64) -> Vec<Warning> {
    let ml = |mm3: f64| mm3 / MM3_IN_ML;
    let (lost, filled) = (ml(report.volume_lost), ml(report.bone_filled));
    let remedy = "more tetrahedra, or `size.fine` there, resolve it";
    let place = report.sheets_lost.first().map_or(String::new(), |sheet| {
        let [x, y, z] = sheet.centre.into();
        format!(", most of it around ({x:.0}, {y:.0}, {z:.0}) mm")
    });
    let detail = format!(
        "about {lost:.0} ml of tissue thinner than cells is missing from the mesh{place}; {:.0} ml are meshed, with cubes of {:.1} mm at \
         the finest; {remedy}",
        ml(report.volume),
        report.finest
    );
    let sheet = (lost > MOST_LOST * ml(report.volume) && lost > LEAST)
        .then(|| Warning::new("thin-tissue-lost", detail).with("volume_ml", lost));
    let [x, y, z] = report.bone_filled_centre.into();
    let detail = format!(
        "about {filled:.1} ml of bone thinner than cells is meshed as tissue, around ({x:.0}, {y:.0}, {z:.0}) mm in the mean; {remedy}"
    );
    let bone = (report.bone_filled > MOST_FILLED * bone && filled > LEAST)
        .then(|| Warning::new("thin-bone-lost", detail).with("volume_ml", filled));
    sheet.into_iter().chain(bone).collect()
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
