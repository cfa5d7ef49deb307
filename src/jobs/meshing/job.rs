//! The job of a meshing: the scan or the surfaces segmented and meshed, the files written.

use std::sync::Arc;

use super::body::Body;
use super::case::{bone_file, case_of};
use super::check::{MadeAnatomy, check_anatomy};
use super::cuts::{CUT_PATHS_FILE, CUT_PATHS_MEDIA_TYPE, cut_paths, cut_paths_csv};
use super::doubt::with_doubts;
use super::input::{MeshingInput, PreparedMeshing};
use super::skin_scan::SKIN_SCAN_FILE;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput, MadeMesh};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::pictures::slices_picture;
use crate::jobs::result::provenance::{Origin, encode_result, mesh_summary};
use crate::jobs::result::warnings::{warning_documents, warnings_after};
use crate::jobs::source::StoredShape;
use crate::schema::WarningDocument;
use crate::schema::meshing::labels::LabelsDocument;
use crate::schema::meshing::result::MeshingResultDocument;
use crate::schema::meshing::skin_scan::FittedScanDocument;
use crate::schema::meshing::thresholds::HounsfieldThresholdsDocument;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::keep::MadeName;
use crate::schema::predict::result::{FileDocument, ResultDocument};
use mechanics::anatomy::Anatomy;
use mechanics::anatomy::skin_scan::FittedScan;
use mechanics::domain::ImageOptions;
use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput};
use mechanics::mesh::quality::quality;
use mechanics::mesh::{Frame, Warning};
use mechanics::progress::{Phase, Progress};

/// The picture of slices through the mesh.
pub const SLICES_FILE: &str = "slices.svg";

/// Meshes a scan or the space between surfaces, and writes its files.
pub fn meshing_job(
    input: &MeshingInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, input.spec.budget.wall_s);

    // 1. The document, and the scan or the surfaces.
    let prepared = input.prepare(place.sources, place.limits)?;
    clock.check()?;

    // 2. The bone, parted.
    let doubted = |error| with_doubts(error, &prepared);
    let mut body = prepared.part(&clock).map_err(doubted)?;
    let skin = body.skin.take();
    clock.check()?;

    // 3. The mesh.
    let anatomy = prepared.mesh(body, &clock).map_err(doubted)?;
    clock.check()?;

    // 4. The case, and what holds it.
    let labels = input.spec.labels.as_ref();
    let regions = labels.map(LabelsDocument::regions).unwrap_or_default();
    let volume = OutputName::VolumeVtu.file_name();
    let case = case_of(&anatomy, volume, prepared.frame, &regions);
    let mut found = MeshingResultDocument::new(&anatomy, case);
    let (cuts, near) = cut_paths(&prepared.rules, &anatomy);
    found.cuts = cuts;
    found.thresholds_hu = prepared.thresholds_hu();
    found.skin_scan = skin.as_ref().map(FittedScanDocument::from);
    if let Some(waiting) = &input.case {
        found.case = waiting.document.complete(found.case);
        let told = prepared.told(&anatomy);
        found.check = check_anatomy(
            &found.case,
            &MadeAnatomy { anatomy: &anatomy, frame: prepared.frame, told },
            place,
            &clock,
        )?;
    }
    clock.check()?;

    // 5. Files.
    clock.phase(Phase::Write);
    let made = MeshingOutput { prepared: &prepared, anatomy: &anatomy, found, near, skin };
    let (result, files) = made.publish(input, place, &clock)?;
    let told = result.warnings.clone();
    Ok(JobOutput { result, files, meshes: meshes_of(anatomy, prepared.frame, told) })
}

/// The meshes of the case: the volume and the segments.
fn meshes_of(anatomy: Anatomy, frame: Frame, told: Vec<WarningDocument>) -> Vec<MadeMesh> {
    let volume = StoredShape::Volume(Arc::new(anatomy.volume));
    let bones = anatomy.bone.segments.into_iter().zip(anatomy.bones);
    let bones = bones.map(|(segment, surface)| MadeMesh {
        what: MadeName::Bone,
        name: Some(segment.name),
        shape: StoredShape::Surface(Arc::new(surface)),
        frame,
        told: Vec::new(),
    });
    let volume = MadeMesh { what: MadeName::Volume, name: None, shape: volume, frame, told };
    std::iter::once(volume).chain(bones).collect()
}

impl PreparedMeshing {
    /// The thresholds of the scan.
    fn thresholds_hu(&self) -> Option<HounsfieldThresholdsDocument> {
        let ImageOptions { skin_threshold: skin, bone_threshold: bone, .. } = self.rules.image;
        self.body.image().map(|_| HounsfieldThresholdsDocument { skin, bone })
    }

    /// The warnings on the scan or the surfaces, and on the mesh.
    fn told(&self, anatomy: &Anatomy) -> Vec<WarningDocument> {
        let of_meshes = self.meshes.iter().flat_map(|(_, mesh)| &mesh.warnings);
        let unmarked = self.unmarked_image();
        warning_documents(of_meshes.chain(&unmarked).chain(&anatomy.warnings))
    }

    /// An image whose axes may be any of the patient's.
    fn unmarked_image(&self) -> Option<Warning> {
        let is_image = matches!(self.body, Body::Scan(_) | Body::Labels(_));
        let detail = "the image does not state which axes of the patient its own are: the mesh and the plan are in those of the file, and if \
                      the plan was made in others, what moves is turned or mirrored; state them (`--frame LPS` on the command line, \
                      `frame` of the upload)";
        let warning = || Warning::new("image-place-doubtful", detail);
        (is_image && self.frame == Frame::Unspecified).then(warning)
    }
}

/// Result of a meshing, before it is written.
struct MeshingOutput<'a> {
    prepared: &'a PreparedMeshing,
    anatomy: &'a Anatomy,
    found: MeshingResultDocument,
    /// Cuts too near to structures at risk.
    near: Vec<Warning>,
    /// The surface scan, registered with the CT.
    skin: Option<FittedScan>,
}

impl MeshingOutput<'_> {
    fn publish(
        self,
        input: &MeshingInput,
        place: &JobContext,
        clock: &Observed,
    ) -> Result<(ResultDocument, Vec<FileDocument>), JobError> {
        let MeshingOutput { prepared, anatomy, found, near, skin } = self;
        let frame = prepared.frame;
        let origin = Origin {
            spec_hash: prepared.spec_hash.clone(),
            inputs: prepared.meshes.iter().map(|(role, mesh)| mesh.to_input(role)).collect(),
            frame,
            queue_s: input.queue_s,
        };
        let mut folder = ResultFolder::open(place)?;
        let volume = vtu::write(&VolumeOutput::plain(&anatomy.volume, frame))?;
        folder.add(OutputName::VolumeVtu, &volume)?;
        for (number, bone) in anatomy.bones.iter().enumerate() {
            let bytes = vtp::write(&SurfaceOutput::plain(bone, frame))?;
            folder.add_file(&bone_file(number), OutputName::BonesVtp.media_type(), &bytes)?;
        }
        if let Some(skin) = &skin {
            let bytes = vtp::write(&SurfaceOutput::plain(&skin.surface, frame))?;
            folder.add_file(SKIN_SCAN_FILE, OutputName::BonesVtp.media_type(), &bytes)?;
        }
        let picture = slices_picture(anatomy, frame)?;
        folder.add_file(SLICES_FILE, OutputName::ClassesSvg.media_type(), picture.as_bytes())?;
        if !found.cuts.is_empty() {
            let table = cut_paths_csv(&found.cuts, frame);
            folder.add_file(CUT_PATHS_FILE, CUT_PATHS_MEDIA_TYPE, table.as_bytes())?;
        }
        let warnings = warnings_after(&prepared.told(anatomy), near.iter());
        let mut provenance = origin.provenance(clock);
        provenance.mesh = Some(mesh_summary(&anatomy.volume, &quality(&anatomy.volume)));
        let rest = ResultDocument::new(input.job.clone(), &folder.files, provenance, warnings);
        let result = ResultDocument { meshing: Some(found), ..rest };
        folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
        Ok((result, folder.files))
    }
}
