//! The meshes that a comparison needs beside the prediction.

use crate::jobs::failure::JobError;
use crate::jobs::fetch::{fetch, no_surface};
use crate::jobs::source::{MeshSource, StoredMesh};
use crate::schema::ErrorCode;
use crate::schema::compare::document::{CompareToDocument, MeshReference};
use crate::schema::predict::result::InputDocument;
use crate::schema::{Pointer, Problem};
use mechanics::mesh::{Frame, TriangleSurface};

/// The actual surface, and those of its alignment.
pub struct ComparedMeshes {
    pub actual: StoredMesh,
    pub fixed: Option<StoredMesh>,
    pub moving: Option<StoredMesh>,
}

impl ComparedMeshes {
    /// The meshes of a spec at `at`.
    pub fn fetch(
        spec: &CompareToDocument,
        sources: &dyn MeshSource,
        at: &Pointer,
    ) -> Result<Self, JobError> {
        let align = at.key("align");
        let named = |mesh: &Option<MeshReference>, at: Pointer| {
            mesh.as_ref().map(|mesh| fetch(sources, &mesh.mesh, &at.key("mesh"))).transpose()
        };
        Ok(ComparedMeshes {
            actual: fetch(sources, &spec.actual.mesh, &at.key("actual").key("mesh"))?,
            fixed: named(&spec.align.fixed, align.key("fixed"))?,
            moving: named(&spec.align.moving, align.key("moving"))?,
        })
    }

    /// What a mesh is, by its id in the spec.
    pub fn content_of(&self, spec: &CompareToDocument, id: &str) -> Option<String> {
        let is = |mesh: &Option<MeshReference>| mesh.as_ref().is_some_and(|mesh| mesh.mesh == id);
        let found = match spec.actual.mesh == id {
            true => Some(&self.actual),
            false if is(&spec.align.fixed) => self.fixed.as_ref(),
            false if is(&spec.align.moving) => self.moving.as_ref(),
            false => None,
        };
        found.map(|mesh| mesh.identity.clone())
    }

    /// Their names in provenance.
    pub fn to_inputs(&self) -> Vec<InputDocument> {
        let named = [("actual", Some(&self.actual))];
        let deciding = [("fixed", self.fixed.as_ref()), ("moving", self.moving.as_ref())];
        let all = named.into_iter().chain(deciding);
        all.filter_map(|(role, mesh)| Some(mesh?.to_input(role))).collect()
    }

    /// Surfaces in different frames cannot be compared: `fixed` is registered with the prediction, `moving` with the actual one.
    pub fn check_frames(&self, prediction: Option<Frame>, at: &Pointer) -> Result<(), JobError> {
        let fixed = self.fixed.as_ref().and_then(|mesh| mesh.frame);
        let moving = self.moving.as_ref().and_then(|mesh| mesh.frame);
        let (actual, align) = (self.actual.frame, at.key("align"));
        let prediction = Marked { what: "prediction", frame: prediction };
        let marked_actual = Marked { what: "actual", frame: actual };
        prediction.agrees(&marked_actual, &at.key("actual").key("mesh"))?;
        let fixed = Marked { what: "fixed", frame: fixed };
        prediction.agrees(&fixed, &align.key("fixed").key("mesh"))?;
        let moving = Marked { what: "moving", frame: moving };
        marked_actual.agrees(&moving, &align.key("moving").key("mesh"))
    }
}

/// A surface and its frame mark.
struct Marked {
    what: &'static str,
    frame: Option<Frame>,
}

impl Marked {
    fn agrees(&self, other: &Marked, at: &Pointer) -> Result<(), JobError> {
        match (self.frame, other.frame) {
            (Some(own), Some(theirs)) if own != theirs => {
                let detail =
                    format!("the {} is in frame {own}, the {} in {theirs}", self.what, other.what);
                Err(Problem::at(at, ErrorCode::FrameConflict, detail).into())
            }
            _ => Ok(()),
        }
    }
}

/// The surface of a mesh in mm, at a place of the documents.
pub fn surface_of(mesh: &StoredMesh, at: &Pointer) -> Result<TriangleSurface, JobError> {
    let surface = mesh.surface_in_mm().ok_or_else(|| no_surface(at))?;
    Ok((*surface).clone())
}
