//! Landmarks and parts of the face on the skin of a mesh.

use std::collections::BTreeMap;

use crate::landmarks::profile::ProfilePoint;
use crate::landmarks::{FaceAxes, MidPlane, Profile, skin_regions};
use crate::mesh::{Frame, Vector, VolumeMesh, Warning};

/// What was found of a face.
#[derive(Default)]
pub(super) struct Face {
    pub landmarks: BTreeMap<String, Vector>,
    pub regions: BTreeMap<String, Vec<u32>>,
    pub warning: Option<Warning>,
}

/// The face on the skin of a mesh; without a known frame or a profile that is one of a face, nothing and why.
pub(super) fn face(mesh: &VolumeMesh, skin: &[u32], frame: Frame) -> Face {
    match found(mesh, skin, frame) {
        Ok(face) => face,
        Err(why) => {
            let detail = format!("no landmarks and no parts of the skin: {why}");
            Face { warning: Some(Warning::new("no-landmarks", detail)), ..Face::default() }
        }
    }
}

fn found(mesh: &VolumeMesh, skin: &[u32], frame: Frame) -> Result<Face, String> {
    let axes = FaceAxes::of(frame).ok_or("the frame of the scan is not known")?;
    let on_skin = |node: &u32| skin.binary_search(node).is_ok();
    let faces: Vec<_> =
        mesh.boundary_faces().into_iter().filter(|face| face.nodes().iter().all(on_skin)).collect();
    let surface = mesh.surface_of(&faces);
    let plane = MidPlane::of(&surface, axes).ok_or("the skin has no front")?;
    let at = Profile::of(&surface, &plane).landmarks().map_err(|error| error.to_string())?;
    let named = [
        ("pogonion", at.pogonion),
        ("sublabiale", at.sublabiale),
        ("subnasale", at.subnasale),
        ("pronasale", at.pronasale),
    ];
    let landmarks = named.map(|(name, point)| (name.to_owned(), place(&plane, point)));
    Ok(Face {
        landmarks: landmarks.into(),
        regions: skin_regions(&mesh.nodes, skin, &plane, &at),
        warning: None,
    })
}

/// A point of the mid-plane in the coordinates of the scan.
fn place(plane: &MidPlane, point: ProfilePoint) -> Vector {
    let axes = plane.axes;
    axes.lateral() * plane.offset + axes.up * point.height + axes.anterior * point.advance
}
