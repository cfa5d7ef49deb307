//! Input of a meshing: its document with the scan, the label map or the surfaces, checked and converted.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::body::{Body, ScannedHead, Surfaces};
use super::skin_scan::SkinScan;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::{fetch, no_surface};
use crate::jobs::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::case::meshed::MeshedCaseDocument;
use crate::schema::meshing::labels::LabelsDocument;
use crate::schema::meshing::surfaces::SurfacesDocument;
use crate::schema::{ErrorCode, Faults, Limits, MeshingDocument, Pointer, Problem, hashes};
use mechanics::anatomy::AnatomyRules;
use mechanics::image::ImageVolume;
use mechanics::mesh::{Frame, TriangleSurface, Vector};

/// A meshing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshingInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: MeshingDocument,
    /// The stored case that waits for the mesh, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<WaitingCase>,
}

/// A stored case that waits for its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaitingCase {
    pub id: String,
    pub document: MeshedCaseDocument,
}

/// A meshing with valid documents.
pub struct PreparedMeshing {
    /// The scan or the surfaces, each with its role.
    pub meshes: Vec<(String, StoredMesh)>,
    pub body: Body,
    pub rules: AnatomyRules,
    pub spec_hash: String,
    /// That of the mesh.
    pub frame: Frame,
}

/// The meshes of a document, and their frame.
struct Fetched {
    meshes: Vec<(String, StoredMesh)>,
    body: Body,
    frame: Frame,
}

impl MeshingInput {
    /// Fetches the scan or the surfaces and converts the document; pointers start at `/spec`.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
    ) -> Result<PreparedMeshing, JobError> {
        let MeshingDocument { scan, labels, surfaces, .. } = &self.spec;
        let Fetched { meshes, body, frame } = match (scan, labels, surfaces) {
            (Some(scan), None, None) => self.fetch_scan(scan, sources)?,
            (None, Some(labels), None) => fetch_labels(labels, sources)?,
            (None, None, Some(surfaces)) => self.fetch_surfaces(surfaces, sources)?,
            _ => {
                let detail = "exactly one of `scan`, `labels` and `surfaces` has to be given";
                return Err(Problem::at(&place(), ErrorCode::OneOf, detail).into());
            }
        };
        let mut faults = Faults::default();
        let rules = self.spec.to_rules((body.image(), frame), limits, &mut faults);
        faults.into_result()?;
        let content = |id: &str| {
            let ids = self.spec.clone().mesh_ids();
            let number = ids.iter().position(|other| other == id)?;
            Some(meshes[number].1.identity.clone())
        };
        let spec_hash = hashes::meshing_hash(&self.spec, &content, self.case_id());
        Ok(PreparedMeshing { meshes, body, rules, spec_hash, frame })
    }

    fn case_id(&self) -> Option<&str> {
        self.case.as_ref().map(|case| case.id.as_str())
    }

    fn fetch_scan(&self, id: &str, sources: &dyn MeshSource) -> Result<Fetched, JobError> {
        let (scan, image, frame) = fetch_image(id, &place().key("scan"), sources)?;
        let mut meshes = vec![("scan".to_owned(), scan)];
        let stated = self.spec.frame.map(Frame::from).unwrap_or(frame);
        let skin = self.spec.skin_scan.as_ref();
        let skin = skin.map(|skin| SkinScan::fetch(skin, stated, sources)).transpose()?;
        let skin = skin.map(|(stored, skin)| {
            meshes.push(("skin scan".to_owned(), stored));
            skin
        });
        Ok(Fetched { meshes, body: Body::Scan(ScannedHead { image, skin }), frame })
    }

    fn fetch_surfaces(
        &self,
        document: &SurfacesDocument,
        sources: &dyn MeshSource,
    ) -> Result<Fetched, JobError> {
        let at = place().key("surfaces");
        let places =
            std::iter::once((at.key("skin"), &document.skin)).chain(document.bones_at(&at));
        let places: Vec<(Pointer, &String)> = places.collect();
        let fetched = places.iter().map(|(at, id)| fetch(sources, id, at));
        let fetched: Vec<StoredMesh> = fetched.collect::<Result<_, _>>()?;
        let stated = self.spec.frame.map(Frame::from).and_then(Frame::known);
        let marked = one_frame(&places, &fetched)?;
        if let (None, Some(Frame::Ras)) = (stated, marked) {
            check_marked(&places, &fetched)?;
        }
        // The frame of those without a mark.
        let unmarked = stated.or(marked).unwrap_or_default();
        let in_lps = places.iter().zip(&fetched).map(|((at, _), mesh)| {
            let surface = mesh.surface_in_mm().ok_or_else(|| no_surface(at))?;
            Ok(surface_in_lps(surface, mesh.frame.and_then(Frame::known).unwrap_or(unmarked)))
        });
        let mut surfaces = in_lps.collect::<Result<Vec<_>, JobError>>()?.into_iter();
        let skin = surfaces.next().unwrap_or_default();
        let bones = surfaces.collect();
        let body = Body::Surfaces(Surfaces { skin, bones, document: document.clone() });
        let roles = std::iter::once("skin".to_owned()).chain(roles_of_bones(document));
        Ok(Fetched { meshes: roles.zip(fetched).collect(), body, frame: lps_if_known(unmarked) })
    }
}

fn place() -> Pointer {
    Pointer::root().key("spec")
}

fn fetch_labels(document: &LabelsDocument, sources: &dyn MeshSource) -> Result<Fetched, JobError> {
    let at = place().key("labels");
    let (labels, image, frame) = fetch_image(&document.image, &at.key("image"), sources)?;
    let mut faults = Faults::default();
    let body = document.to_body(&image, &at, &mut faults);
    faults.into_result()?;
    let body = body
        .map(Box::new)
        .map(Body::Labels)
        .ok_or_else(|| Problem::at(&at, ErrorCode::WrongMesh, "this label map cannot be meshed"))?;
    Ok(Fetched { meshes: vec![("labels".to_owned(), labels)], body, frame })
}

/// An image, converted to LPS if its orientation is known, and its frame then.
fn fetch_image(
    id: &str,
    at: &Pointer,
    sources: &dyn MeshSource,
) -> Result<(StoredMesh, Arc<ImageVolume>, Frame), JobError> {
    let stored = sources.mesh(id).map_err(|error| match error {
        SourceError::Unknown { .. } => {
            let detail = format!("there is no image {id:?}");
            Problem::at(at, ErrorCode::UnknownMesh, detail).into()
        }
        SourceError::Refused { code, detail, .. } => Problem::at(at, code, detail).into(),
        other @ SourceError::Unreadable { .. } => JobError::Source(other),
    })?;
    let StoredShape::Image(image) = &stored.shape else {
        let detail = "this is a mesh, and the image of a scan is needed";
        return Err(Problem::at(at, ErrorCode::WrongMesh, detail).into());
    };
    let frame = stored.frame.unwrap_or_default();
    let image = image_in_lps(image, frame);
    Ok((stored, image, lps_if_known(frame)))
}

fn roles_of_bones(document: &SurfacesDocument) -> impl Iterator<Item = String> {
    let whole = document.bone.iter().map(|_| "bone".to_owned());
    whole.chain(document.bones.iter().map(|bone| format!("bone {}", bone.name.trim())))
}

/// The frame mark of the files of surfaces; two that differ are refused.
fn one_frame(
    places: &[(Pointer, &String)],
    fetched: &[StoredMesh],
) -> Result<Option<Frame>, JobError> {
    let marked = places.iter().zip(fetched);
    let mut marked = marked.filter_map(|((at, _), mesh)| Some((at, mesh.frame?.known()?)));
    let Some((_, first)) = marked.next() else { return Ok(None) };
    match marked.find(|(_, frame)| *frame != first) {
        None => Ok(Some(first)),
        Some((at, frame)) => {
            let detail = format!("this surface is marked {frame}, one before it {first}");
            Err(Problem::at(at, ErrorCode::FrameConflict, detail).into())
        }
    }
}

/// Refuses a surface without a mark beside those in RAS, whose frame is LPS by default: it may be in either.
fn check_marked(places: &[(Pointer, &String)], fetched: &[StoredMesh]) -> Result<(), JobError> {
    let mut unmarked =
        places.iter().zip(fetched).filter(|(_, mesh)| mesh.frame.and_then(Frame::known).is_none());
    unmarked.next().map_or(Ok(()), |((at, _), _)| {
        let detail = "this surface states no frame, another one is marked RAS: state `frame` of the document, which is then that of \
                      surfaces without a mark";
        Err(Problem::at(at, ErrorCode::FrameConflict, detail).into())
    })
}

/// 3D Slicer reads a file of a volume mesh as LPS, so that everything is converted to it if possible.
fn lps_if_known(frame: Frame) -> Frame {
    match frame {
        Frame::Ras | Frame::Lps => Frame::Lps,
        Frame::Unspecified => Frame::Unspecified,
    }
}

fn image_in_lps(image: &Arc<ImageVolume>, frame: Frame) -> Arc<ImageVolume> {
    match frame {
        Frame::Ras => Arc::new(image.turned(Frame::Ras, Frame::Lps)),
        Frame::Lps | Frame::Unspecified => image.clone(),
    }
}

fn surface_in_lps(surface: Arc<TriangleSurface>, frame: Frame) -> Arc<TriangleSurface> {
    match frame {
        Frame::Ras => {
            let mut turned = (*surface).clone();
            turned.points.iter_mut().for_each(|x| *x = Vector::new(-x.x, -x.y, x.z));
            Arc::new(turned)
        }
        Frame::Lps | Frame::Unspecified => surface,
    }
}
