//! Bone between surfaces, divided into segments, and the repairs of these surfaces.
//!
//! Cuts part the depth of bone on a grid ([`BoneDepths`]) as they part the values of a scan: where bones touch, the way through
//! the deeper bone wins. Clipping triangles instead would need surfaces without open edges, which those of real heads have.

use super::{AnatomyError, PartedBone, parted};
use crate::domain::{Assessment, BoneDepths, Hollow, Overlap, SurfaceDomain, SurfaceName};
use crate::mesh::{TriangleSurface, Warning};
use crate::osteotomy::Osteotomy;
use crate::osteotomy::bone_image::BoneImage;
use crate::osteotomy::labelling::label_given;

/// Volumes that differ by more, as a share, are reported: a doubled surface has twice the volume of its body.
const SAME_VOLUME: f64 = 0.02;
/// Bone is reported that lies outside the skin with more of it, as a share, and farther, in mm.
const OUTSIDE: f64 = 0.03;
const OFF_SKIN_MM: f64 = 2.0;
/// Smaller hollows of a bone are not told, in ml.
const LEAST_HOLLOW: f64 = 0.1;
/// More of the inside than this is told to be uncertain.
const CERTAIN: f64 = 1e-3;

/// Parts all bone of a body between surfaces as an osteotomy says.
pub fn part_by_cuts(
    domain: &SurfaceDomain,
    osteotomy: &Osteotomy,
) -> Result<PartedBone, AnatomyError> {
    let depths = domain.bone_depths();
    let parted = parted(&BoneImage { image: &depths.image, threshold: 0.0 }, osteotomy)?;
    Ok(PartedBone { wall_voxels: f64::INFINITY, ..parted })
}

/// Takes each bone of a body between surfaces as the segment of its number.
pub fn take_as_segments(
    domain: &SurfaceDomain,
    bones: &[&TriangleSurface],
    segments: &Osteotomy,
) -> Result<PartedBone, AnatomyError> {
    let BoneDepths { image, deepest, solids } = domain.bone_depths();
    let bone = BoneImage { image: &image, threshold: 0.0 };
    let labelled = label_given(&bone, segments, |voxel| Some(usize::from(deepest[voxel])))?;
    let surfaces = bones.iter().map(|&bone| bone.clone()).collect();
    let (given, wall_voxels) = (solids, f64::INFINITY);
    Ok(PartedBone { labelled, surfaces, given, teeth: None, wall_voxels })
}

/// Bones of which a part lies outside the skin.
pub fn outside(domain: &SurfaceDomain) -> Vec<Warning> {
    let numbered = domain.containments().iter().enumerate();
    let far = numbered.filter(|(_, by)| by.outside > OUTSIDE && by.farthest > OFF_SKIN_MM);
    far.map(|(number, by)| {
        let (name, percent) = (SurfaceName::Bone(number), 100.0 * by.outside);
        let [x, y, z] = by.centre.into();
        let detail = format!(
            "{name}: {percent:.0} % of it lies outside the skin, around ({x:.0}, {y:.0}, {z:.0}) mm and up to {:.1} mm from \
             it, and holds no tissue there: are both in the same frame?",
            by.farthest
        );
        let warning = Warning::new("bone-outside-skin", detail);
        warning.with("outside", by.outside).with("farthest_mm", by.farthest)
    })
    .collect()
}

/// Bones that lie in one another.
pub fn overlapping(domain: &SurfaceDomain) -> Vec<Warning> {
    let warning = |overlap: &Overlap| {
        let [one, other] = overlap.bones.map(SurfaceName::Bone);
        let volume_ml = overlap.volume / 1000.0;
        let [x, y, z] = overlap.centre.into();
        let detail = format!(
            "{one} and {other} overlap: {volume_ml:.1} ml around ({x:.0}, {y:.0}, {z:.0}) mm lie in both, and belong to the one that \
             lies within the other, else to that in which they lie deeper"
        );
        Warning::new("surfaces-overlap", detail).with("volume_ml", volume_ml)
    };
    domain.overlaps().iter().map(warning).collect()
}

/// Bones with hollows, which hold no tissue.
pub fn hollow(domain: &SurfaceDomain) -> Vec<Warning> {
    let ml = |mm3: f64| mm3 / 1000.0;
    let what = match domain.is_solid() {
        true => "are bone of it",
        false => "hold no tissue, and are neither meshed nor part of its volume",
    };
    let warning = |(number, hollows): (usize, &[Hollow])| {
        let all = ml(hollows.iter().map(|hollow| hollow.volume).sum());
        let largest = hollows.first().filter(|_| all >= LEAST_HOLLOW)?;
        let [x, y, z] = largest.centre.into();
        let (name, count, most) = (SurfaceName::Bone(number), hollows.len(), ml(largest.volume));
        let detail = format!(
            "{name}: {count} hollows of {all:.1} ml that it encloses on all sides {what}; the largest has {most:.1} ml around \
             ({x:.0}, {y:.0}, {z:.0}) mm"
        );
        let warning = Warning::new("bone-hollow", detail).with("volume_ml", all);
        Some(warning.with("hollows", count as f64))
    };
    domain.hollows().enumerate().filter_map(warning).collect()
}

/// What was mended of the surfaces of a body, and what of them could not be: a warning for each that is not whole.
pub fn mended(domain: &SurfaceDomain) -> Vec<Warning> {
    let bones = (0..domain.assessments().len()).map(SurfaceName::Bone);
    let names = std::iter::once(SurfaceName::Skin).chain(bones);
    names.zip(domain.assessments()).filter_map(|(name, found)| warning(name, found)).collect()
}

fn warning(name: SurfaceName, found: &Assessment) -> Option<Warning> {
    let findings = findings(found);
    if findings.is_empty() {
        return None;
    }
    let warning = Warning::new("surface-mended", format!("{name}: {}", findings.join(", ")));
    let mending = &found.mending;
    Some(
        warning
            .with("degenerate", mending.degenerate as f64)
            .with("duplicates", mending.duplicates as f64)
            .with("turned", mending.turned as f64)
            .with("second_sheets", mending.second_sheets as f64)
            .with("lids", mending.lids as f64)
            .with("open_edges", found.open_edges as f64)
            .with("winding_number", found.level)
            .with("uncertain", found.uncertain),
    )
}

fn findings(found: &Assessment) -> Vec<String> {
    let mending = &found.mending;
    let counts = [
        (mending.degenerate, "triangles without an area left out"),
        (mending.duplicates, "triangles left out that stood there before"),
        (mending.turned, "triangles turned to the side of those around them"),
        (mending.second_sheets, "triangles of a second sheet close beside the first left out"),
        (mending.lids, "holes closed by lids as curved as what is around them"),
        (found.open_edges, "open edges closed by the winding number"),
    ];
    let counts = counts.into_iter().filter(|(count, _)| *count > 0);
    let mut findings: Vec<String> = counts.map(|(count, what)| format!("{count} {what}")).collect();
    let ml = |mm3: f64| mm3 / 1000.0;
    if mending.was_inverted {
        findings.push("all of it was inside out".to_owned());
    }
    if found.level < 1.0 {
        findings.push(format!("the winding number inside is {:.2}, not 1", found.level));
    }
    if found.uncertain > CERTAIN {
        findings.push(format!("{:.1} % of the inside is uncertain", 100.0 * found.uncertain));
    }
    if (found.volume_of_triangles / found.volume - 1.0).abs() > SAME_VOLUME {
        let (triangles, body) = (ml(found.volume_of_triangles), ml(found.volume));
        findings.push(format!("its triangles enclose {triangles:.1} ml, the body {body:.1} ml"));
    }
    findings
}
