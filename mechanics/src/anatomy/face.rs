//! Landmarks and parts of the face on the skin of a mesh.

use std::collections::BTreeMap;

use super::given_landmarks::GivenLandmarks;
use crate::landmarks::profile::ProfilePoint;
use crate::landmarks::{FaceAxes, MidPlane, Profile, ProfileLandmarks, skin_regions};
use crate::mesh::{Frame, Vector, VolumeMesh, Warning};

/// What was found of a face.
#[derive(Default)]
pub(super) struct Face {
    pub landmarks: BTreeMap<String, Vector>,
    pub regions: BTreeMap<String, Vec<u32>>,
    pub warnings: Vec<Warning>,
}

/// The face on the skin of a mesh by the landmarks that are given, or by those of its profile; without a known frame or a
/// profile that is one of a face, nothing and why.
pub(super) fn face(
    mesh: &VolumeMesh,
    skin: &[u32],
    frame: Frame,
    given: Option<&GivenLandmarks>,
) -> Face {
    let found = match (FaceAxes::of(frame), given) {
        (None, _) => Err("the frame of the scan is not known".to_owned()),
        (Some(axes), Some(given)) => Ok(with(given, mesh, skin, axes)),
        (Some(axes), None) => found(mesh, skin, axes),
    };
    found.unwrap_or_else(|why| {
        let detail = format!("no landmarks and no parts of the skin: {why}");
        Face { warnings: vec![Warning::new("no-landmarks", detail)], ..Face::default() }
    })
}

/// The parts of the face that given landmarks bound; those far from the skin are reported.
fn with(given: &GivenLandmarks, mesh: &VolumeMesh, skin: &[u32], axes: FaceAxes) -> Face {
    let (plane, at) = given.on_mid_plane(axes);
    Face {
        landmarks: given.named().map(|(name, at)| (name.to_owned(), at)).collect(),
        regions: skin_regions(&mesh.nodes, skin, &plane, &at),
        warnings: given.far_from(mesh, skin),
    }
}

fn found(mesh: &VolumeMesh, skin: &[u32], axes: FaceAxes) -> Result<Face, String> {
    let on_skin = |node: &u32| skin.binary_search(node).is_ok();
    let faces: Vec<_> =
        mesh.boundary_faces().into_iter().filter(|face| face.nodes().iter().all(on_skin)).collect();
    let surface = mesh.surface_of(&faces);
    let plane = MidPlane::of(&surface, axes).ok_or("the skin has no front")?;
    let at = Profile::of(&surface, &plane).landmarks().map_err(|error| error.to_string())?;
    let ProfileLandmarks { pogonion, sublabiale, subnasale, pronasale, shallow_fold } = at;
    let named = [("pogonion", pogonion), ("sublabiale", sublabiale), ("subnasale", subnasale)];
    let named = named.into_iter().chain(pronasale.map(|tip| ("pronasale", tip)));
    Ok(Face {
        landmarks: named.map(|(name, point)| (name.to_owned(), place(&plane, point))).collect(),
        regions: skin_regions(&mesh.nodes, skin, &plane, &at),
        warnings: shallow_fold
            .map(|depth| shallow(depth, &place(&plane, sublabiale)))
            .into_iter()
            .collect(),
    })
}

/// A border of chin and lips that is not certain.
fn shallow(depth_mm: f64, sublabiale: &Vector) -> Warning {
    let [x, y, z] = (*sublabiale).into();
    let found = match depth_mm > 0.0 {
        true => format!("is {depth_mm:.1} mm deep"),
        false => "is not there, and its place is guessed from stomion and chin".to_owned(),
    };
    let detail = format!(
        "the fold between chin and lower lip {found}: `skin_chin` and `skin_lips` meet at ({x:.0}, {y:.0}, {z:.0}) mm; state `landmarks` if \
         that is not the border"
    );
    Warning::new("fold-shallow", detail).with("depth_mm", depth_mm)
}

/// A point of the mid-plane in the coordinates of the scan.
fn place(plane: &MidPlane, point: ProfilePoint) -> Vector {
    let axes = plane.axes;
    axes.lateral() * plane.offset + axes.up * point.height + axes.anterior * point.advance
}
