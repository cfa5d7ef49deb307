//! Reasons against refining a mesh, before anything is solved.

use crate::jobs::failure::JobError;
use crate::schema::predict::refine::RefineDocument;
use crate::schema::{ErrorCode, Faults, Pointer};
use mechanics::mesh::bisection::Bisection;
use mechanics::mesh::ignored::listed;
use mechanics::prediction::{LANDMARK_FAR, Scene};

/// Refuses cells that cannot be refined, and limits for parts of the skin and landmarks that are not there.
pub fn check_refinable(refine: &RefineDocument, scene: &Scene) -> Result<(), JobError> {
    let mut faults = Faults::default();
    let at = Pointer::from_text("/spec/refine");
    if let Err(shape) = Bisection::new(scene.mesh.clone()) {
        faults.add(&at, ErrorCode::MethodNotAvailable, shape.to_string());
    }
    for name in refine.regions.keys().filter(|&name| !scene.skin.regions.contains_key(name)) {
        let known = listed(scene.skin.regions.keys());
        let detail = format!("{name:?} is not one of the named parts of the skin: {known}");
        faults.add(&at.key("regions").key(name), ErrorCode::UnknownRegion, detail);
    }
    for name in refine.landmarks.keys() {
        let place = at.key("landmarks").key(name);
        match scene.distance_to_skin(name) {
            None => {
                let known = listed(scene.landmarks.keys());
                let detail = format!("{name:?} is not one of the landmarks of the case: {known}");
                faults.add(&place, ErrorCode::UnknownLandmark, detail);
            }
            Some(distance) if distance > LANDMARK_FAR => {
                let detail = format!(
                    "{name:?} lies {distance:.1} mm from the skin, and errors are limited at landmarks within {LANDMARK_FAR} mm of it"
                );
                faults.add(&place, ErrorCode::OutOfRange, detail);
            }
            Some(_) => {}
        }
    }
    Ok(faults.into_result()?)
}
