//! The job of a conformation: the template conformed to the patient, its cells repaired, its files written.

use std::sync::Arc;

use super::input::{ConformInput, PreparedConformation};
use super::tissue::{MappedMuscles, MuscleSurface, TissueMaps, case_of};
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput, MadeMesh};
use crate::jobs::predict::check_made;
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result, mesh_summary};
use crate::jobs::result::warnings::warning_documents;
use crate::jobs::source::{StoredMesh, StoredShape};
use crate::schema::conform::document::ConformDocument;
use crate::schema::conform::result::{CellsDocument, ConformationDocument, LeftDocument};
use crate::schema::predict::check::CheckDocument;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::keep::MadeName;
use crate::schema::predict::result::ResultDocument;
use crate::schema::repair::RepairResultDocument;
use crate::schema::{CaseDocument, ErrorCode, Pointer, Problem};
use mechanics::conformation::{
    Conformation, ConformationError, Covering, DoubtfulLandmark, FEWEST_CHECKED, LATTICES, Patient,
    SheetName, Template, carried, conform_on, finest_spacing,
};
use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput};
use mechanics::mesh::quality::{QualityReport, quality};
use mechanics::mesh::{SurfaceSearch, TriangleSurface, VolumeMesh, Warning};
use mechanics::progress::{Phase, Progress};
use mechanics::repair::{Bounds, RepairReport, repair};

/// Time a conformation may take, in seconds.
const WALL_S: f64 = 600.0;

/// Conforms a template to a patient.
pub fn conform_job(
    input: &ConformInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, WALL_S);

    // 1. Documents and meshes.
    let prepared = clock.prepared(|stop| input.prepare(place.sources, place.limits, stop))?;
    clock.check()?;

    // 2. The template onto the patient, its cells repaired.
    let mut found = prepared.conformed_whole(&input.spec, &clock)?;
    let is_whole = found.after.inverted == 0;
    clock.check()?;

    // 3. Its muscles and fibres, and the case.
    let mut brought = prepared.brought(&mut found, &input.spec, (place, &clock))?;
    let surfaces = std::mem::take(&mut brought.muscles.surfaces);
    clock.check()?;

    // 4. Files.
    clock.phase(Phase::Write);
    let origin = Origin {
        spec_hash: prepared.spec_hash.clone(),
        inputs: prepared.meshes.iter().map(|(role, mesh)| mesh.to_input(role)).collect(),
        frame: prepared.frame,
        queue_s: input.queue_s,
    };
    let mut folder = ResultFolder::open(place)?;
    let volume = vtu::write(&VolumeOutput::plain(&found.mesh, prepared.frame))?;
    folder.add(OutputName::VolumeVtu, &volume)?;
    for MuscleSurface { file, surface, .. } in &surfaces {
        let bytes = vtp::write(&SurfaceOutput::plain(surface, prepared.frame))?;
        folder.add_file(file, OutputName::BonesVtp.media_type(), &bytes)?;
    }
    let told = prepared.meshes.iter().flat_map(|(_, mesh)| &mesh.warnings);
    let warnings = found.after.warnings().into_iter().chain(brought.refused.clone());
    let warnings =
        warnings.chain(found.poor_fit()).chain(found.covered_skin()).chain(found.coarse());
    let warnings = warnings.chain(found.conformation.doubtful.iter().map(in_doubt));
    let warnings = warnings.chain(prepared.unchecked_landmarks());
    let warnings: Vec<Warning> = warnings.collect();
    let warnings = warning_documents(told.chain(&warnings));
    let mut provenance = origin.provenance(&clock);
    provenance.mesh = Some(mesh_summary(&found.mesh, &found.after));
    let rest = ResultDocument::new(input.job.clone(), &folder.files, provenance, warnings.clone());
    let conformation = Some(found.document(brought, &prepared));
    let result = ResultDocument { conformation, ..rest };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    let shape = StoredShape::Volume(Arc::new(found.mesh));
    let what = MadeName::Volume;
    let volume = MadeMesh { what, name: None, shape, frame: prepared.frame, told: warnings };
    // A mesh with inverted cells is refused as an upload; it is a file of the result.
    let muscles = surfaces.into_iter().map(|own| own.made(prepared.frame));
    let meshes = std::iter::once(volume).chain(muscles).filter(|_| is_whole).collect();
    Ok(JobOutput { result, files: folder.files, meshes })
}

/// A template on a patient.
struct Conformed {
    mesh: VolumeMesh,
    conformation: Conformation,
    before: QualityReport,
    after: QualityReport,
    repaired: RepairReport,
    /// After the repair, in mm.
    skin_distances: Vec<f64>,
    bone_distances: Vec<f64>,
    coarser_than: Option<Coarser>,
}

/// Fewer lattices than there could be, because so many cells stay invalid on all of them.
struct Coarser {
    lattices: i32,
    invalid: usize,
}

impl PreparedConformation {
    /// The warning of landmarks that are too few to be checked by each other.
    fn unchecked_landmarks(&self) -> Option<Warning> {
        let count = self.landmarks.len();
        let detail = format!(
            "{count} landmarks are too few to tell a wrong one: the template follows each of them, right or wrong; with {FEWEST_CHECKED} or more \
             one that lies elsewhere than the others say is told"
        );
        let warning = Warning::new("landmarks-unchecked", detail).with("landmarks", count as f64);
        (1..FEWEST_CHECKED).contains(&count).then_some(warning)
    }

    /// On the finest lattices on which all cells are valid after their repair; on the finest ones where there are none.
    fn conformed_whole(
        &self,
        spec: &ConformDocument,
        clock: &Observed,
    ) -> Result<Conformed, JobError> {
        let finest = self.conformed(spec, LATTICES, clock)?;
        let invalid = finest.after.inverted;
        if invalid == 0 {
            return Ok(finest);
        }
        for lattices in (FEWEST_LATTICES..LATTICES).rev() {
            let coarser = self.conformed(spec, lattices, clock)?;
            if coarser.after.inverted == 0 {
                let coarser_than = Some(Coarser { lattices, invalid });
                return Ok(Conformed { coarser_than, ..coarser });
            }
        }
        Ok(finest)
    }

    fn conformed(
        &self,
        spec: &ConformDocument,
        lattices: i32,
        clock: &Observed,
    ) -> Result<Conformed, JobError> {
        let template =
            Template { mesh: &self.template, skin: &self.skin_nodes, bone: &self.bone_nodes };
        let patient = Patient {
            skin: self.skin.as_deref(),
            bone: self.bone.as_deref(),
            landmarks: &self.landmarks,
        };
        let conformation = conform_on(lattices, &template, &patient, spec.start.into(), clock)
            .map_err(|error| refused(&error, clock))?;
        let mut mesh = carried(&self.template, &conformation.deformation);
        let before = quality(&mesh);
        let bounds = Bounds::of(&mesh, spec.repair.boundary_mm, spec.repair.inner_mm);
        let bounds = bounds.along(&mesh, &[&self.skin_nodes, &self.bone_nodes]);
        let repaired = repair(&mut mesh, &bounds, clock);
        let after = quality(&mesh);
        let skin_distances = distances(self.skin.as_deref(), &mesh, &self.skin_nodes)?;
        let bone_distances = distances(self.bone.as_deref(), &mesh, &self.bone_nodes)?;
        Ok(Conformed {
            mesh,
            conformation,
            before,
            after,
            repaired,
            skin_distances,
            bone_distances,
            coarser_than: None,
        })
    }
}

/// The case of a template on a patient, and its check.
struct ConformedCase {
    case: CaseDocument,
    muscles: MappedMuscles,
    check: Option<CheckDocument>,
    refused: Option<Warning>,
}

impl PreparedConformation {
    fn brought(
        &self,
        found: &mut Conformed,
        spec: &ConformDocument,
        (place, clock): (&JobContext, &Observed),
    ) -> Result<ConformedCase, JobError> {
        let volume = OutputName::VolumeVtu.file_name();
        let conformation = &found.conformation;
        let mut case = case_of(spec, volume, self.frame.into());
        case.landmarks.retain(|name, _| !conformation.leaves_out(name));
        let maps = TissueMaps::new(self, conformation, spec.muscles_by, place.limits);
        let muscles = maps.bring(&mut case, &mut found.mesh);
        let shape = StoredShape::Volume(Arc::new(found.mesh.clone()));
        let volume = (volume.to_owned(), StoredMesh::made(shape, self.frame));
        let surfaces =
            muscles.surfaces.iter().map(|own| (own.file.clone(), own.stored(self.frame)));
        let made = surfaces.chain([volume]).collect();
        let (check, refused) = match check_made(&case, made, place, clock) {
            Ok(_) if found.after.inverted > 0 => (None, Some(with_inverted_cells(&found.after))),
            Ok(check) => (check, None),
            Err(JobError::Refused(problem)) => (None, Some(refused_case(&problem))),
            Err(error) => return Err(error),
        };
        Ok(ConformedCase { case, muscles, check, refused })
    }
}

fn refused_case(problem: &Problem) -> Warning {
    made_case_refused(&problem.detail)
}

/// The warning of a mesh with invalid cells, which is refused when it is read.
fn with_inverted_cells(after: &QualityReport) -> Warning {
    let why = format!(
        "{} of {} cells are inverted at some point, and no repair within its bounds corrected them; look at the distances of \
         skin and bone, state landmarks, omit a bone surface that is open or not that of the template's nodes, or let \
         nodes move farther with `repair`",
        after.inverted, after.cells
    );
    made_case_refused(&why).with("cells", after.inverted as f64)
}

fn made_case_refused(why: &str) -> Warning {
    Warning::new("made-case-refused", format!("the case of the mesh is refused: {why}"))
}

/// From nodes to a surface, if there is one, in mm.
fn distances(
    surface: Option<&TriangleSurface>,
    mesh: &VolumeMesh,
    nodes: &[u32],
) -> Result<Vec<f64>, JobError> {
    let Some(surface) = surface else { return Ok(Vec::new()) };
    let search =
        SurfaceSearch::new(surface).map_err(|error| JobError::Alignment(error.to_string()))?;
    let distance = |&node: &u32| search.closest(&mesh.nodes[node as usize]).distance;
    Ok(nodes.iter().map(distance).collect())
}

impl Conformed {
    fn document(
        &self,
        brought: ConformedCase,
        prepared: &PreparedConformation,
    ) -> ConformationDocument {
        let names = prepared.landmarks.iter().map(|landmark| landmark.name.clone());
        let [partners, points] = self.conformation.partners;
        ConformationDocument {
            skin: LeftDocument::of(&self.skin_distances),
            bone: LeftDocument::of(&self.bone_distances),
            share_with_partner: (points > 0).then(|| partners as f64 / points as f64),
            landmarks_mm: names.zip(self.conformation.landmark_distances.iter().copied()).collect(),
            before_repair: CellsDocument::from(&self.before),
            after_repair: CellsDocument::from(&self.after),
            repair: RepairResultDocument::from(&self.repaired),
            muscles: brought.muscles.told,
            case: brought.case,
            check: brought.check,
        }
    }

    /// The warning of a template that follows the patient less closely than it might.
    fn coarse(&self) -> Option<Warning> {
        let Coarser { lattices, invalid } = self.coarser_than.as_ref()?;
        let (used, left_out) = (finest_spacing(*lattices), finest_spacing(LATTICES));
        let detail = format!(
            "{invalid} cells stay invalid where the template is deformed by control points {left_out} mm apart: it is deformed by points \
             {used} mm apart, all its cells are valid, and details below that size are not followed"
        );
        let warning = Warning::new("conformation-coarse", detail).with("spacing_mm", used);
        Some(warning.with("cells", *invalid as f64))
    }

    /// The warning of what covers the patient's skin.
    fn covered_skin(&self) -> Option<Warning> {
        let Covering { area_mm2, middle } = self.conformation.covering;
        let detail = format!(
            "{area_mm2:.0} mm2 of the patient's skin, around ({:.0}, {:.0}, {:.0}) mm, cover skin with air between, as a dressing or a \
             tube does: the template is fitted to what lies behind",
            middle.x, middle.y, middle.z
        );
        let warning = Warning::new("skin-covered", detail).with("area_mm2", area_mm2);
        let place = [("x_mm", middle.x), ("y_mm", middle.y), ("z_mm", middle.z)];
        let warning = place.into_iter().fold(warning, |told, (name, at)| told.with(name, at));
        (area_mm2 > 0.0).then_some(warning)
    }

    /// The warning of a template part of which lies far from the surface that it was fitted to, because the surface lacks that part or
    /// lies elsewhere.
    fn poor_fit(&self) -> Option<Warning> {
        let surfaces = [
            ("skin", "skin_p95_mm", &self.skin_distances, [SKIN_P95_MM, SKIN_LARGEST_MM]),
            ("bone", "bone_p95_mm", &self.bone_distances, [BONE_P95_MM, f64::INFINITY]),
        ];
        let (mut told, mut warning) = (Vec::new(), Warning::new("template-apart", ""));
        for (name, number, distances, [p95, largest]) in surfaces {
            let Some(LeftDocument { p95_mm, max_mm, .. }) = LeftDocument::of(distances) else {
                continue;
            };
            if p95_mm > p95 || max_mm > largest {
                told.push(format!("the template lies {p95_mm:.1} mm (95 %) and {max_mm:.1} mm (largest) from the {name}"));
                warning = warning.with(number, p95_mm);
            }
        }
        let [partners, points] = self.conformation.partners;
        if points > 0 {
            warning = warning.with("share_with_partner", partners as f64 / points as f64);
        }
        warning.detail = format!(
            "{}: the surface lacks what the template has there, or lies in another frame; nodes there follow nothing, and a prediction on \
             them means little",
            told.join(", and ")
        );
        (!told.is_empty()).then_some(warning)
    }
}

/// The warning of a landmark far from where the others and the surfaces put it.
fn in_doubt(landmark: &DoubtfulLandmark) -> Warning {
    let DoubtfulLandmark { name, distance, median, is_left_out } = landmark;
    let ending = match is_left_out {
        true => "it is left out",
        false => "it is used: correct it if it was picked wrongly",
    };
    let detail = format!(
        "the landmark {name:?} lies {distance:.1} mm from where the other landmarks and the surfaces put it, {median:.1} mm is their \
         median: {ending}"
    );
    let warning = Warning::new("landmark-doubtful", detail).with("distance_mm", *distance);
    warning.with("median_mm", *median).with("left_out", f64::from(u8::from(*is_left_out)))
}

/// On fewer lattices than this, control points 16 mm apart, a template follows no face.
const FEWEST_LATTICES: i32 = 3;

/// Beyond these distances in mm a template does not lie on the skin or the bone that it was fitted to: on the CT of a head the 95 % and the
/// largest distance from its skin are .4 and 3 mm. Sets of nodes on bone seldom cover what a surface of bone has.
const SKIN_P95_MM: f64 = 2.0;
const SKIN_LARGEST_MM: f64 = 10.0;
const BONE_P95_MM: f64 = 10.0;

/// With its place in the spec.
fn refused(error: &ConformationError, clock: &Observed) -> JobError {
    let at = Pointer::root().key("spec");
    let of_sheet = |sheet: &SheetName| match sheet {
        SheetName::Skin => "skin",
        SheetName::Bone => "bone",
    };
    let place = match error {
        ConformationError::Cancelled { .. } => return clock.stopped(),
        ConformationError::NothingToFit | ConformationError::Scale { .. } => at.key("patient"),
        ConformationError::NoSheet { sheet: SheetName::Skin, .. } => at.key("template").key("skin"),
        ConformationError::NoSheet { sheet: SheetName::Bone, .. } => {
            at.key("template").key("segments")
        }
        ConformationError::Surface { sheet, .. } => at.key("patient").key(of_sheet(sheet)),
        ConformationError::FewPartners { .. }
        | ConformationError::NoSuchFace { .. }
        | ConformationError::Stretched { .. } => at.key("patient").key("skin"),
        ConformationError::Landmarks(_)
        | ConformationError::Spline(_)
        | ConformationError::SameLandmark { .. }
        | ConformationError::FewLandmarks { .. }
        | ConformationError::Mirrored { .. }
        | ConformationError::SidesUndecided { .. }
        | ConformationError::FarFromTemplate { .. }
        | ConformationError::Exchanged { .. }
        | ConformationError::Misplaced { .. }
        | ConformationError::Permuted { .. }
        | ConformationError::Unlike { .. } => at.key("landmarks"),
    };
    Problem::at(&place, ErrorCode::AlignmentFailed, error.to_string()).into()
}
