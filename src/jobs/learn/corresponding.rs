//! Correspondence of cases that are learned from with each other, and of a measured mesh with the skin of its case.

use crate::jobs::failure::JobError;
use crate::jobs::predict::Prepared;
use crate::jobs::source::{StoredMesh, StoredShape};
use crate::schema::learn::mechanics::MechanicsDocument;
use crate::schema::{ErrorCode, Matrix4x4, Pointer, Problem};
use mechanics::learning::measures::carried_by;
use mechanics::mesh::Vector;
use mechanics::prediction::Scene;
use mechanics::registration::RigidTransform;
use mechanics::validation::corresponding_points;

/// Cases have the same cells, frame, skin, bone and method.
pub fn corresponds(first: &Prepared, other: &Prepared, at: &Pointer) -> Result<(), JobError> {
    let [one, two] = [first, other].map(|own| &own.scene);
    let conflict =
        |code, detail: String| Err(Problem::at(&at.key("prediction"), code, detail).into());
    let [a, b] = [one, two].map(|own| (own.mesh.nodes.len(), own.mesh.cells.len()));
    if a != b || one.mesh.cells != two.mesh.cells {
        let detail = format!(
            "its mesh has {} nodes and {} cells, that of the first case {} and {}, and cells have to be the same: nodes do not correspond",
            b.0, b.1, a.0, a.1
        );
        return conflict(ErrorCode::NotCorresponding, detail);
    }
    if one.skin.nodes() != two.skin.nodes() {
        let [a, b] = [one, two].map(|own| own.skin.nodes().len());
        let detail = format!(
            "its skin has {b} nodes and that of the first case {a}, and they have to be the same"
        );
        return conflict(ErrorCode::NotCorresponding, detail);
    }
    if let Some(detail) = other_bone(one, two) {
        return conflict(ErrorCode::NotCorresponding, detail);
    }
    if first.case.frame != other.case.frame {
        let detail = format!(
            "its frame is {:?} and that of the first case {:?}",
            other.case.frame, first.case.frame
        );
        return conflict(ErrorCode::FrameConflict, detail);
    }
    let [a, b] = [one, two].map(|own| own.settings.method.kind().name());
    if a != b {
        let detail = format!(
            "it was predicted by {b} and the first case by {a}: what they miss is not the same"
        );
        return conflict(ErrorCode::MethodMismatch, detail);
    }
    Ok(())
}

/// Predictions are of the same element, contact and membrane, and corrected alike.
pub fn predicted_alike(
    first: &MechanicsDocument,
    other: &MechanicsDocument,
    at: &Pointer,
) -> Result<(), JobError> {
    let Some([what, own, of_first]) = other.conflict(first) else { return Ok(()) };
    let detail = format!(
        "`{what}` of its prediction is {own}, and of that of the first case {of_first}: what they miss is not the same; predict all cases alike"
    );
    Err(Problem::at(&at.key("prediction"), ErrorCode::MethodMismatch, detail).into())
}

/// In what the segments of a case, in their order, differ from those of the first.
fn other_bone(first: &Scene, other: &Scene) -> Option<String> {
    let [a, b] = [first, other].map(|own| own.segments.len());
    if a != b {
        return Some(format!(
            "its case has {b} segments and that of the first case {a}, and they have to be the same"
        ));
    }
    let differing = (0..a).find_map(|number| {
        let [one, two] =
            [first, other].map(|own| (own.segments[number].name.as_str(), carried_by(own, number)));
        (one != two).then_some((one, two))
    });
    let ((name, nodes), (own_name, own)) = differing?;
    let common = own.iter().filter(|node| nodes.binary_search(node).is_ok()).count();
    Some(format!(
        "its segment {own_name:?} carries {} nodes, {common} of which are among the {} of segment {name:?} of the first case, and they have to be the same under the same name, in the same order: bone does not correspond",
        own.len(),
        nodes.len()
    ))
}

/// Where the points of the skin are after the operation, in the frame of the case.
pub fn measured(
    actual: &StoredMesh,
    matrix: Option<Matrix4x4>,
    prepared: &Prepared,
    at: &Pointer,
) -> Result<Vec<Vector>, JobError> {
    let mut after = places(&actual.shape, &prepared.scene, at)?;
    if let Some(Matrix4x4(matrix)) = matrix {
        let transform = RigidTransform::from_matrix4(&matrix);
        after.iter_mut().for_each(|point| *point = transform.apply(point));
    }
    if let Some(frame) = actual.frame.filter(|frame| *frame != prepared.case.frame) {
        let detail = format!(
            "the mesh is in {frame:?}, and the case in {:?}: distances between them mean nothing",
            prepared.case.frame
        );
        return Err(Problem::at(at, ErrorCode::FrameConflict, detail).into());
    }
    Ok(after)
}

/// Where the skin is in a mesh after the operation: a volume with the cells of the case's, or a surface whose node numbers or
/// triangles tell which points correspond.
fn places(shape: &StoredShape, scene: &Scene, at: &Pointer) -> Result<Vec<Vector>, JobError> {
    let skin = &scene.skin.surface;
    let conform = "conform one mesh to the scans before and after the operation";
    let refused = |detail: String| Problem::at(at, ErrorCode::NotCorresponding, detail).into();
    match shape {
        StoredShape::Volume(volume) => {
            let [(own, cells), (other, other_cells)] =
                [&*scene.mesh, &**volume].map(|mesh| (mesh.nodes.len(), mesh.cells.len()));
            if own == other && volume.cells == scene.mesh.cells {
                let nodes = scene.skin.nodes().iter();
                return Ok(nodes.map(|&node| volume.nodes[node as usize]).collect());
            }
            Err(refused(format!(
                "it has {other} nodes and {other_cells} cells, the mesh of the case {own} and {cells}, and they are not the same cells of the same nodes: nodes do not correspond; {conform}"
            )))
        }
        StoredShape::Surface(surface) => match corresponding_points(skin, surface) {
            Some(pairs) => Ok(pairs.iter().map(|&place| surface.points[place]).collect()),
            None => Err(refused(format!(
                "it has {} points and the skin of the case {}, and neither their node ids nor their triangles tell which correspond; {conform}, or keep the array `node_id` of `skin.vtp`",
                surface.points.len(),
                skin.points.len()
            ))),
        },
        StoredShape::Image(_) => Err(refused(format!("it is an image and no mesh; {conform}"))),
    }
}
