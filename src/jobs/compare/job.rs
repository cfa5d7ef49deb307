//! The job of a comparison.

use std::sync::Arc;

use super::input::CompareInput;
use super::meshes::ComparedMeshes;
use super::picture::{DISTANCE_MEDIA_TYPE, DISTANCE_PICTURE, distance_picture};
use super::surfaces::{ComparisonFindings, Pair};
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::no_surface;
use crate::jobs::output::{JobContext, JobOutput};
use crate::jobs::report::{ComparisonFacts, Report, comparison_report};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::jobs::result::warnings::warning_documents;
use crate::jobs::source::{MeshSource, StoredMesh};
use crate::schema::predict::document::OutputName;
use crate::schema::predict::output::PictureName;
use crate::schema::predict::result::ResultDocument;
use crate::schema::{Faults, Language, Limits, Matrix4x4, Pointer};
use mechanics::chart::colour::{Rgb, signed};
use mechanics::format::vtk::vtp;
use mechanics::format::{ArrayValues, ColourScale, NamedValues, SurfaceOutput, glb, ply};
use mechanics::mesh::{Frame, TriangleSurface, Vector};
use mechanics::progress::{Phase, Progress, Unobserved};

/// Time a comparison may take, in seconds; a prediction that compares has its own budget.
const WALL_S: f64 = 600.0;

/// A comparison as a separate job.
pub fn compare_job(
    input: &CompareInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, WALL_S);

    // 1. Documents, surfaces and distances.
    let Measured { surface, frame, prediction, meshes, compared } =
        input.measure(place.sources, place.limits, &clock)?;

    // 2. Files.
    clock.phase(Phase::Write);
    let origin = Origin {
        spec_hash: input.spec_hash(&prediction.identity, &meshes),
        inputs: [vec![prediction.to_input("prediction")], meshes.to_inputs()].concat(),
        frame: frame.unwrap_or_default(),
        queue_s: input.queue_s,
    };
    let mut folder = ResultFolder::open(place)?;
    let shown = (origin.frame, input.spec.range_mm);
    write_maps(&mut folder, &surface, &compared, shown)?;
    let distances = &compared.signed_distance;
    let picture = distance_picture(&surface, distances, shown, &compared.document)?;
    folder.add_file(DISTANCE_PICTURE, DISTANCE_MEDIA_TYPE, picture.as_bytes())?;
    let warnings =
        prediction.warnings.iter().chain(&meshes.actual.warnings).chain(&compared.warnings);
    let provenance = origin.provenance(&clock);
    let result = ResultDocument {
        comparison: Some(compared.document.clone()),
        pictures: input.job.as_ref().map_or_else(Vec::new, |_| PictureName::REPORTS.to_vec()),
        ..ResultDocument::new(
            input.job.clone(),
            &folder.files,
            provenance,
            warning_documents(warnings),
        )
    };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files, meshes: Vec::new() })
}

/// A surface that was compared with another.
struct Measured {
    surface: Arc<TriangleSurface>,
    frame: Option<Frame>,
    prediction: StoredMesh,
    meshes: ComparedMeshes,
    compared: ComparisonFindings,
}

impl CompareInput {
    fn measure(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
        clock: &Observed,
    ) -> Result<Measured, JobError> {
        let mut faults = Faults::default();
        self.spec.check(limits, &mut faults);
        faults.into_result()?;
        let at = Pointer::root().key("spec");
        let prediction = self.fetch_prediction(sources, &at.key("prediction"))?;
        let spec = self.spec.to_compare_to();
        let meshes = ComparedMeshes::fetch(&spec, sources, &at)?;
        clock.check()?;
        clock.phase(Phase::Compare);
        let wrong = || no_surface(&at.key("prediction"));
        let surface = prediction.surface_in_mm().ok_or_else(wrong)?;
        let frame = prediction.frame;
        let pair = Pair {
            prediction: &surface,
            prediction_frame: frame,
            displacement: prediction.of_points.displacement.as_deref(),
            skin_regions: &prediction.of_points.sets,
            meshes: &meshes,
            at,
        };
        let compared = pair.compare(&spec, clock)?;
        Ok(Measured { surface, frame, prediction, meshes, compared })
    }

    /// The report of a finished comparison: its surfaces are measured again, its numbers are those of its result.
    pub fn report(
        &self,
        result: &ResultDocument,
        language: Language,
        sources: &dyn MeshSource,
        limits: &Limits,
    ) -> Result<Report, JobError> {
        let clock = Observed::start(&Unobserved, WALL_S);
        let Measured { surface, frame, compared, meshes, .. } =
            self.measure(sources, limits, &clock)?;
        let wrong = || no_surface(&Pointer::root().key("spec").key("actual"));
        let actual = meshes.actual.surface_in_mm().ok_or_else(wrong)?;
        let actual = registered(&actual, &compared.document.alignment.matrix4x4);
        let facts = ComparisonFacts {
            surface: &surface,
            actual: &actual,
            signed_distance: &compared.signed_distance,
            range_mm: self.spec.range_mm,
            frame: frame.unwrap_or_default(),
            comparison: result.comparison.as_ref().unwrap_or(&compared.document),
            result,
        };
        Ok(comparison_report(&facts, language)?)
    }
}

/// `skin.vtp`: the prediction with its distances at each point; with a range `skin.ply` and `skin.glb` too, in its colours.
fn write_maps(
    folder: &mut ResultFolder,
    surface: &TriangleSurface,
    compared: &ComparisonFindings,
    (frame, range_mm): (Frame, Option<f64>),
) -> Result<(), JobError> {
    let mut output = SurfaceOutput::plain(surface, frame);
    let arrays = [
        ("signed_distance_mm", Some(&compared.signed_distance)),
        ("node_error_mm", compared.node_errors.as_ref()),
        ("landmark_error_mm", compared.landmark_map.as_ref()),
    ];
    let known = arrays.into_iter().filter_map(|(name, values)| Some((name, values?)));
    output.point_arrays = known
        .map(|(name, values)| NamedValues { name, values: ArrayValues::Reals(values) })
        .collect();
    folder.add(OutputName::SkinVtp, &vtp::write(&output)?)?;
    let Some(range) = range_mm else { return Ok(()) };
    let colour = |distance: &f64| signed(0.5 + 0.5 * distance / range);
    let colours: Vec<Rgb> = compared.signed_distance.iter().map(colour).collect();
    output.colours = Some(&colours);
    let array = "signed_distance_mm";
    output.colour_scale = Some(ColourScale { array, low: -range, high: range });
    folder.add(OutputName::SkinPly, &ply::write(&output)?)?;
    folder.add(OutputName::SkinGlb, &glb::write(&output)?)
}

/// A surface moved by x' = R x + t.
fn registered(surface: &TriangleSurface, Matrix4x4(rows): &Matrix4x4) -> TriangleSurface {
    let moved = |point: &Vector| {
        Vector::from([0, 4, 8].map(|row| {
            rows[row] * point.x + rows[row + 1] * point.y + rows[row + 2] * point.z + rows[row + 3]
        }))
    };
    TriangleSurface { points: surface.points.iter().map(moved).collect(), ..surface.clone() }
}
