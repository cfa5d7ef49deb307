//! Pictures of a job: its boundary conditions and the displacement of its skin.

use crate::schema::compare::result::StatDocument;
use mechanics::anatomy::Anatomy;
use mechanics::chart::{
    ClassKind, ClassesPicture, DisplacementPicture, FaceDirection, NodeClasses, PngError,
    SlicesPicture, front_of,
};
use mechanics::mesh::{Frame, TriangleSurface, Vector, bounds_of};
use mechanics::prediction::{NodeClass, Scene};

/// Every class of a scene with its number of nodes, segments first; classes without a node are omitted,
/// but not segments, because an empty one is a mistake to be seen.
fn classes_of(scene: &Scene) -> Vec<(NodeClass, NodeClasses)> {
    let segments = (0..scene.segments.len() as u32).map(NodeClass::Joined);
    let others = [NodeClass::Prescribed, NodeClass::Fixed, NodeClass::Sliding, NodeClass::Free];
    segments
        .chain(others)
        .map(|class| {
            let kind = match class {
                NodeClass::Joined(segment) => {
                    ClassKind::Joined(scene.segments[segment as usize].name.clone())
                }
                NodeClass::Prescribed => ClassKind::Prescribed,
                NodeClass::Fixed => ClassKind::Fixed,
                NodeClass::Sliding => ClassKind::Sliding,
                NodeClass::Free => ClassKind::Free,
            };
            let count = scene.conditions.classes.iter().filter(|&&other| other == class).count();
            (class, NodeClasses { kind, count })
        })
        .filter(|(class, nodes)| nodes.count > 0 || matches!(class, NodeClass::Joined(_)))
        .collect()
}

/// `classes.svg`: the boundary of the volume mesh coloured by node class.
pub fn classes_picture(scene: &Scene, frame: Frame, title: &str) -> Result<String, PngError> {
    let boundary = scene.mesh.surface_of(&scene.boundary);
    let (order, classes): (Vec<NodeClass>, Vec<NodeClasses>) =
        classes_of(scene).into_iter().unzip();
    let nodes = boundary.node_ids.iter().flatten();
    let class_of: Vec<usize> = nodes
        .map(|&node| {
            let class = scene.conditions.classes[node as usize];
            order.iter().position(|other| *other == class).unwrap_or(order.len())
        })
        .collect();
    ClassesPicture {
        title,
        points: &boundary.points,
        triangles: &boundary.triangles,
        class_of: &class_of,
        classes: &classes,
        face_direction: face_direction(frame, &scene.skin.surface),
        frame: frame.name(),
    }
    .to_svg()
}

/// `displacement.svg`: the skin before, after, and coloured by displacement, from 0 to a range in mm.
pub fn displacement_picture(
    scene: &Scene,
    moved: &TriangleSurface,
    (frame, range_mm): (Frame, f64),
    statistics: &StatDocument,
) -> Result<String, PngError> {
    let before = &scene.skin.surface;
    let moving = scene.segments.iter().filter(|segment| segment.movement != Default::default());
    let names: Vec<&str> = moving.map(|segment| segment.name.as_str()).collect();
    let subtitle = match names.as_slice() {
        [] => "no segment moves".to_owned(),
        names => format!("moved: {}", names.join(", ")),
    };
    let numbers = format!(
        "|u| over {} skin nodes: mean {:.3} mm, median {:.3} mm, p95 {:.3} mm, largest {:.3} mm",
        statistics.count, statistics.mean, statistics.median, statistics.p95, statistics.max
    );
    DisplacementPicture {
        title: "Predicted skin",
        subtitle: &subtitle,
        triangles: &before.triangles,
        before: &before.points,
        after: &moved.points,
        face_direction: face_direction(frame, before),
        frame: frame.name(),
        range_mm,
        statistics: &numbers,
    }
    .to_svg()
}

/// `slices.svg`: three planes through a mesh, its cells coloured by size and by their smallest angle.
pub fn slices_picture(anatomy: &Anatomy, frame: Frame) -> Result<String, PngError> {
    let report = &anatomy.meshing;
    let mesh = &anatomy.volume;
    let cells: Vec<[u32; 4]> =
        mesh.cells.iter().filter_map(|(_, nodes)| nodes.try_into().ok()).collect();
    let [low, high] = bounds_of(&mesh.nodes).unwrap_or_default();
    let subtitle = format!(
        "{} tetrahedra, {} nodes; smallest dihedral angle {:.1}°, 0.1 % below {:.1}°, largest {:.1}°",
        report.tetrahedra,
        report.nodes,
        report.angles.smallest,
        report.angles.thousandth,
        report.angles.largest
    );
    SlicesPicture {
        title: "Mesh of the soft tissue",
        subtitle: &subtitle,
        points: &mesh.nodes,
        tetrahedra: &cells,
        middle: (low + high) / 2.0,
        face_direction: if frame == Frame::Ras {
            FaceDirection::ras()
        } else {
            FaceDirection::lps()
        },
        frame: frame.name(),
    }
    .to_svg()
}

/// The view direction of a face; without a known frame its front is found from its skin.
pub fn face_direction(frame: Frame, skin: &TriangleSurface) -> FaceDirection {
    upright(frame, skin).facing(&skin.points, &skin.triangles)
}

/// The same for a head, which is upright in its frame, whatever its skin.
pub fn upright(frame: Frame, skin: &TriangleSurface) -> FaceDirection {
    match frame {
        Frame::Lps => FaceDirection::lps(),
        Frame::Ras => FaceDirection::ras(),
        Frame::Unspecified => {
            let up = Vector::z();
            FaceDirection { front: front_of(&skin.points, &skin.triangles, up), up }
        }
    }
}
