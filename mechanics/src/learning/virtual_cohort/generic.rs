//! The generic face of a virtual patient: under six modes of shape, with its muscles, its mucosa sliding on the teeth.

use std::sync::Arc;

use super::face::FaceModes;
use crate::boundary::NodeSelection;
use crate::draws::Draws;
use crate::mesh::generic_face::{FaceMuscle, FaceSettings, LAYERS, Lips, generic_face};
use crate::mesh::{CellShape, Frame, VolumeMesh};
use crate::prediction::{
    Case, CaseSegment, Muscle, MuscleCourse, RegionNames, Sliding, SlidingNormal,
};

/// Mucosa on teeth and gums, and the segment that carries these.
pub const VESTIBULES: [(&str, &str); 2] =
    [("upper_vestibule", "maxilla"), ("lower_vestibule", "mandible")];

/// Parts of the skin.
pub const PARTS: [&str; 4] = ["nose", "lips", "chin", "cheeks"];

/// The muscle around the mouth.
pub const AROUND_MOUTH: &str = "orbicularis_oris";

/// A face of hexahedra, with its lips closed.
pub fn shaped(fineness: usize, draws: &mut Draws) -> (VolumeMesh, Vec<FaceMuscle>) {
    let settings = FaceSettings { lips: Lips::Closed, fineness, shape: CellShape::Hex8 };
    let mut face = generic_face(settings);
    let shape = FaceModes::drawn(draws);
    let lines = face.muscles.iter_mut().flat_map(|muscle| &mut muscle.lines).flatten();
    let points = face.mesh.nodes.iter_mut().chain(lines);
    points.for_each(|point| *point = shape.at(point));
    (face.mesh, face.muscles)
}

/// The face as a case without materials, whose muscles have no tissue of their own.
pub fn face_case(volume: Arc<VolumeMesh>, muscles: &[FaceMuscle]) -> Case {
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let names = (0..).zip(LAYERS).map(|(label, layer)| (label, layer.to_owned())).collect();
    let segment = |(_, name): (&str, &str)| CaseSegment { name: name.to_owned(), nodes: set(name) };
    let slides = |(vestibule, name): (&str, &str)| Sliding {
        nodes: set(vestibule),
        normal: SlidingNormal::Surface,
        segment: Some(name.to_owned()),
    };
    let muscle = |own: &FaceMuscle| Muscle {
        name: own.name.clone(),
        course: MuscleCourse::Lines { lines: own.lines.clone(), within: own.within },
        tissue: None,
        stiffening: None,
    };
    Case {
        frame: Frame::Lps,
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        skin: Some(set("skin")),
        skin_regions: PARTS.map(|name| (name.to_owned(), set(name))).into(),
        segments: VESTIBULES.map(segment).to_vec(),
        fixed: vec![set("skull"), set("rim")],
        sliding: VESTIBULES.map(slides).to_vec(),
        muscles: muscles.iter().map(muscle).collect(),
        volume,
        ..Case::default()
    }
}
