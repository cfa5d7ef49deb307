//! Paths of cuts through the segmented bone, and their clearance from structures at risk.

use crate::schema::Triple;
use crate::schema::meshing::cuts::{ClearanceDocument, CutPathDocument};
use mechanics::anatomy::{Anatomy, AnatomyRules, Closing};
use mechanics::format::csv::cell;
use mechanics::mesh::{Frame, Vector, Warning};
use mechanics::osteotomy::Osteotomy;
use mechanics::osteotomy::clearance::{Clearance, clearance};
use mechanics::osteotomy::cut_face::{CutFace, cut_faces};

/// The table of the paths.
pub const CUT_PATHS_FILE: &str = "cut-paths.csv";
pub const CUT_PATHS_MEDIA_TYPE: &str = "text/csv; charset=utf-8";

/// The cuts of a new mesh, and a warning for each structure with too little clearance.
pub fn cut_paths(rules: &AnatomyRules, anatomy: &Anatomy) -> (Vec<CutPathDocument>, Vec<Warning>) {
    let mut warnings = Vec::new();
    let osteotomy = &rules.osteotomy;
    let [x, y, z] = anatomy.bone.labels.placement().steps;
    let voxel = x.dot(&y.cross(&z)).abs().cbrt();
    let mut bones = anatomy.bones.clone();
    if let Some(Closing { segment, movement }) = rules.closing {
        // Cuts are where the scan has the jaw, before it was closed.
        let back = movement.inverse();
        bones[segment].points.iter_mut().for_each(|point| *point = back.apply(point));
    }
    // Along an end of the bone nothing is sawn, though its surface reaches as far.
    let mut faces = cut_faces(osteotomy, &bones, voxel);
    faces.retain(|face| anatomy.bone.is_parted_by(osteotomy, face.cut));
    let documents = faces.iter().map(|face| path(osteotomy, face, &mut warnings)).collect();
    (documents, warnings)
}

fn path(osteotomy: &Osteotomy, face: &CutFace, warnings: &mut Vec<Warning>) -> CutPathDocument {
    let cut = &osteotomy.cuts()[face.cut];
    let segment = osteotomy.segments()[face.segment].name.clone();
    let mut clearances = Vec::new();
    for risk in osteotomy.risks() {
        let Some(Clearance { distance, at, is_crossed }) = clearance(risk, cut, face) else {
            continue;
        };
        if distance < risk.clearance {
            let words = if is_crossed { "goes through" } else { "comes too near to" };
            let [x, y, z]: [f64; 3] = at.into();
            let detail = format!(
                "cut `{}` of segment `{segment}` {words} {:?}: {distance:.2} mm at ({x:.1}, {y:.1}, {z:.1}) mm, {} mm are needed",
                cut.name, risk.name, risk.clearance
            );
            let warning = Warning::new("cut-near-risk", detail).with("distance_mm", distance);
            warnings.push(warning.with("clearance_mm", risk.clearance));
        }
        clearances.push(ClearanceDocument {
            risk: risk.name.clone(),
            distance_mm: distance,
            clearance_mm: risk.clearance,
            at_mm: at.into(),
        });
    }
    let points = |path: &Vec<Vector>| path.iter().map(|&p| p.into()).collect();
    CutPathDocument {
        cut: cut.name.clone(),
        segment,
        normal: cut.plane().normal().into(),
        area_mm2: face.area,
        paths_mm: face.paths.iter().map(points).collect(),
        clearances,
    }
}

/// The paths as comma-separated values: a row for each point, numbers in full, to be read back bit for bit.
pub fn cut_paths_csv(cuts: &[CutPathDocument], frame: Frame) -> String {
    let mut text =
        "frame,cut,segment,path,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z\r\n".to_owned();
    for cut in cuts {
        let [nx, ny, nz] = cut.normal.0;
        let names = [frame.to_string(), cell(&cut.cut), cell(&cut.segment)].join(",");
        for (number, path) in (1..).zip(&cut.paths_mm) {
            for Triple([x, y, z]) in path {
                text += &format!("{names},{number},{x},{y},{z},{nx},{ny},{nz}\r\n");
            }
        }
    }
    text
}
