//! Reasons against refining a mesh, before anything is solved.

use crate::jobs::failure::JobError;
use crate::schema::predict::refine::RefineDocument;
use crate::schema::{ErrorCode, Faults, Pointer};
use mechanics::mesh::bisection::Bisection;
use mechanics::prediction::Scene;

/// Refuses cells that cannot be refined, and limits for unknown parts of the skin.
pub fn check_refinable(refine: &RefineDocument, scene: &Scene) -> Result<(), JobError> {
    let mut faults = Faults::default();
    let at = Pointer::from_text("/spec/refine");
    if let Err(shape) = Bisection::new(scene.mesh.clone()) {
        faults.add(&at, ErrorCode::MethodNotAvailable, shape.to_string());
    }
    for name in refine.regions.keys().filter(|&name| !scene.skin.regions.contains_key(name)) {
        let known: Vec<&str> = scene.skin.regions.keys().map(String::as_str).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        let detail = format!("{name:?} is not one of the named parts of the skin: {known}");
        faults.add(&at.key("regions").key(name), ErrorCode::UnknownRegion, detail);
    }
    Ok(faults.into_result()?)
}
