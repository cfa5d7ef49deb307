//! The case of a mesh from a scan.

use crate::schema::CaseDocument;
use crate::schema::case::document::{
    BoneDocument, LengthUnit, NormalDocument, RegionsDocument, SegmentDocument, SlidingDocument,
};
use crate::schema::case::selection::SelectionDocument;
use mechanics::anatomy::Anatomy;
use mechanics::mesh::Frame;
use mechanics::meshing::REGIONS;
use mechanics::osteotomy::classes::sliding_set;
use mechanics::osteotomy::labelling::FoundSegment;

/// The file of the surface of a segment, by its number.
pub fn bone_file(segment: usize) -> String {
    format!("bone-{}.vtp", segment + 1)
}

/// The case of a volume mesh: its segments, fixed nodes and skin, all by node sets, and the names of its regions.
pub fn case_of(anatomy: &Anatomy, volume: &str, frame: Frame, regions: &[&str]) -> CaseDocument {
    let mut case = CaseDocument::of_volume(volume, LengthUnit::Mm);
    case.frame = frame.into();
    let has = |name: &str| anatomy.volume.node_sets.get(name).is_some_and(|set| !set.is_empty());
    let segments = anatomy.bone.segments.iter().filter(|segment| has(&segment.name));
    case.segments = segments
        .map(|segment| SegmentDocument {
            name: segment.name.clone(),
            nodes: SelectionDocument::node_set(&segment.name),
        })
        .collect();
    if has("fixed") {
        case.fixed = vec![SelectionDocument::node_set("fixed")];
    }
    let slides = anatomy.bone.segments.iter().filter(|segment| has(&sliding_set(&segment.name)));
    case.sliding = slides
        .map(|segment| SlidingDocument {
            nodes: SelectionDocument::node_set(&sliding_set(&segment.name)),
            normal: NormalDocument::default(),
            segment: Some(segment.name.clone()),
        })
        .collect();
    case.skin = has("skin").then(|| SelectionDocument::node_set("skin"));
    let part = |name: &String| (name.clone(), SelectionDocument::node_set(&format!("skin_{name}")));
    case.skin_regions = anatomy.skin_regions.iter().map(part).collect();
    let landmarks = anatomy.landmarks.iter();
    case.landmarks = landmarks.map(|(name, &place)| (name.clone(), place.into())).collect();
    let bone = |(number, segment): (usize, &FoundSegment)| BoneDocument {
        name: segment.name.clone(),
        mesh: bone_file(number),
    };
    case.regions = anatomy.volume.cell_labels.contains_key(REGIONS).then(|| RegionsDocument {
        array: REGIONS.to_owned(),
        names: (0..)
            .zip(regions)
            .map(|(n, name)| (i32::to_string(&n), (*name).to_owned()))
            .collect(),
    });
    case.bones = anatomy.bone.segments.iter().enumerate().map(bone).collect();
    case
}
