//! Reference solution of a study, as its documents state it.

use super::documents::{Documents, Scenes, spec_at};
use crate::jobs::compare::{ComparedMeshes, Pair, surface_of};
use crate::jobs::failure::JobError;
use crate::jobs::fetch::found as found_mesh;
use crate::jobs::predict::Prepared;
use crate::jobs::source::StoredMesh;
use crate::schema::compare::document::{CompareToDocument, MeshReference};
use crate::schema::methods::ElementName;
use crate::schema::study::truth::{TruthDocument, TruthMethodName, TruthMetric};
use crate::schema::{ErrorCode, Faults, Pointer, Problem, Triple};
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::prediction::ElementChoice;
use mechanics::registration::thin_plate_spline::require_thickness;
use mechanics::study::scenes::usual_truth_element;
use mechanics::study::{MOST_CELLS, Scan, ScanMetric, Strain, StudyScene, Truth, cells_at};
use mechanics::validation::LandmarkPair;

impl Documents<'_> {
    /// The reference of the spec, if stated.
    pub(super) fn truth(&self, scene: &mut StudyScene, faults: &mut Faults) {
        let at = spec_at().key("truth");
        match &self.spec.truth {
            Some(TruthDocument { refine: Some(times), element, method, .. }) => {
                let strain = method.map_or(Strain::Small, TruthMethodName::strain);
                let usual = match strain {
                    Strain::Small => usual_truth_element(&scene.case),
                    Strain::Finite => strain.method().properties().usual_element,
                };
                let element = element.map_or(usual, ElementName::choice);
                check_element((element, strain), scene, &at.key("element"), faults);
                check_cells(*times, scene, &at.key("refine"), faults);
                scene.truth = Truth::Refined { times: *times, element, strain };
            }
            Some(TruthDocument { closed_form: true, .. })
                if !matches!(scene.truth, Truth::ClosedForm(_)) =>
            {
                let detail = format!("scene {} has no closed form", scene.name);
                faults.add(&at.key("closed_form"), ErrorCode::NoClosedForm, detail);
            }
            _ => {}
        }
    }
}

/// The least thickness of landmarks of a spline, as a share of their length: if they are thinner, the millimetre by which one is
/// misplaced is several on skin off their plane.
const LEAST_THICKNESS: f64 = 0.05;

/// Skin counts that some result moves by more than this, in mm, by default: more than the registration error
/// of bone that was not operated on.
const USUAL_MOVED_MM: f64 = 0.5;

impl Documents<'_> {
    /// A stored reference: the skin of a job, or a scan.
    pub(super) fn stored_truth(
        &self,
        scene: &mut StudyScene,
        first: &Prepared,
        found: &mut Scenes,
    ) -> Result<(), JobError> {
        let Some(truth) = &self.spec.truth else { return Ok(()) };
        let at = spec_at().key("truth");
        if let Some(job) = &truth.job {
            let at = at.key("job");
            let skin = found_mesh(self.sources.predicted_skin(job), job, &at)?;
            found.contents.insert(job.clone(), skin.sha256.clone());
            found.inputs.push(skin.to_input("truth"));
            let displacement = known_displacement(&skin, first, &at)?;
            let strain = self.truth_method.map(TruthMethodName::strain);
            scene.truth = Truth::Known { displacement, strain };
        }
        if let Some(mesh) = &truth.mesh {
            let scan = self.scan(truth, mesh, first, found);
            // A truth names its mesh where a comparison names what is actual.
            let [from, to] = [at.key("actual").key("mesh"), at.key("mesh")];
            scene.truth = Truth::Scan(Box::new(scan.map_err(|error| match error {
                JobError::Refused(problem) => {
                    JobError::Refused(problem.moved(from.as_str(), to.as_str()))
                }
                other => other,
            })?));
        }
        Ok(())
    }

    fn scan(
        &self,
        truth: &TruthDocument,
        mesh: &str,
        first: &Prepared,
        found: &mut Scenes,
    ) -> Result<Scan, JobError> {
        let at = spec_at().key("truth");
        let actual = MeshReference { mesh: mesh.to_owned() };
        let spec =
            CompareToDocument { align: truth.align.clone(), ..CompareToDocument::of(actual) };
        let meshes = ComparedMeshes::fetch(&spec, self.sources, &at)?;
        let frame = first.case.frame.known();
        meshes.check_frames(frame, &at)?;
        let rest = &first.scene.skin;
        let pair = Pair {
            prediction: &rest.surface,
            prediction_frame: frame,
            displacement: None,
            skin_regions: &rest.regions,
            meshes: &meshes,
            at: at.clone(),
        };
        let alignment = pair.alignment(&truth.align)?;
        let surface = surface_of(&meshes.actual, &at.key("actual").key("mesh"))?;
        found.inputs.extend(meshes.to_inputs());
        for id in spec.mesh_ids() {
            found.contents.extend(meshes.content_of(&spec, &id).map(|content| (id, content)));
        }
        found.warnings.extend(meshes.actual.warnings.iter().cloned());
        let moved_by_more_than = truth.moved_by_more_than_mm.unwrap_or(USUAL_MOVED_MM);
        let metric = metric(truth, first, &surface, &at)?;
        Ok(Scan { surface, alignment, moved_by_more_than, noise: truth.noise_mm, metric })
    }
}

/// The metric from results to a scan, which has the required points or landmarks.
fn metric(
    truth: &TruthDocument,
    first: &Prepared,
    scan: &TriangleSurface,
    at: &Pointer,
) -> Result<ScanMetric, JobError> {
    let refused = |at: Pointer, code: ErrorCode, detail: String| Problem::at(&at, code, detail);
    match truth.metric {
        TruthMetric::Both => Ok(ScanMetric::BothWays),
        TruthMetric::NodeWise => {
            let skin = &first.scene.skin;
            let (own, other) = (skin.surface.points.len(), scan.points.len());
            let numbers = scan.node_ids.as_deref();
            if own == other && numbers.is_none_or(|numbers| numbers == skin.nodes()) {
                return Ok(ScanMetric::NodeWise);
            }
            let detail = format!(
                "the scan has {other} points and the skin of the case {own}; they have to be the same"
            );
            Err(refused(at.key("metric"), ErrorCode::NotCorresponding, detail).into())
        }
        TruthMetric::TpsCp => {
            let pair = |(name, actual): (&String, &Triple)| {
                let missing = || {
                    let detail = format!("the case has no landmark {name:?}");
                    refused(at.key("landmarks_mm").key(name), ErrorCode::UnknownField, detail)
                };
                let prediction = first.scene.landmarks.get(name).copied().ok_or_else(missing)?;
                Ok(LandmarkPair { prediction, actual: (*actual).into() })
            };
            let pairs: Result<Vec<LandmarkPair>, Problem> =
                truth.landmarks_mm.iter().map(pair).collect();
            let pairs = pairs?;
            let (of_case, of_scan): (Vec<Vector>, Vec<Vector>) =
                pairs.iter().map(|pair| (pair.prediction, pair.actual)).unzip();
            for (whose, points) in [("case", of_case), ("scan", of_scan)] {
                require_thickness(&points, LEAST_THICKNESS).map_err(|error| {
                    let count = points.len();
                    let detail = format!(
                        "the {count} landmarks of the {whose} do not determine a thin-plate spline off their plane: {error}; \
                         {LEAST_THICKNESS} of the length is the least thickness"
                    );
                    refused(at.key("landmarks_mm"), ErrorCode::AlignmentFailed, detail)
                })?;
            }
            Ok(ScanMetric::Landmarks(pairs))
        }
    }
}

/// Checks the reference now: it is solved only after all rows.
fn check_element(
    (element, strain): (ElementChoice, Strain),
    scene: &StudyScene,
    at: &Pointer,
    faults: &mut Faults,
) {
    let method = strain.method().properties();
    if !method.elements.contains(&element) {
        let detail = format!("{} has no element `{}`", method.title, element.name());
        faults.add(at, ErrorCode::MethodNotAvailable, detail);
        return;
    }
    let mut cells = scene.case.volume.cells.iter();
    let shapes = element.shapes();
    if let Some((shape, _)) = cells.find(|(shape, _)| !shapes.contains(shape)) {
        let detail = format!(
            "scene {} has {} cells, which cannot be {}: `auto` supports every cell",
            scene.name,
            shape.name(),
            element.name()
        );
        faults.add(at, ErrorCode::MethodNotAvailable, detail);
    }
}

fn check_cells(times: u32, scene: &StudyScene, at: &Pointer, faults: &mut Faults) {
    let cells = cells_at(scene.case.volume.cells.len(), times);
    if cells > MOST_CELLS {
        let detail = format!(
            "the truth of scene {} has {cells:.2e} cells, at most {MOST_CELLS:.0e} are allowed",
            scene.name
        );
        faults.add(at, ErrorCode::OutOfRange, detail);
    }
}

/// The displacement of each skin node to its position in a predicted skin.
pub(super) fn known_displacement(
    skin: &StoredMesh,
    prepared: &Prepared,
    at: &Pointer,
) -> Result<Vec<Vector>, JobError> {
    let Some(predicted) = skin.surface_in_mm() else {
        return Err(Problem::at(
            at,
            ErrorCode::WrongMesh,
            "the result of that job is not a surface",
        )
        .into());
    };
    let rest = &prepared.scene.skin;
    let numbers = predicted.node_ids.as_deref().unwrap_or_default();
    if numbers != rest.nodes() || predicted.points.len() != rest.surface.points.len() {
        let detail = format!(
            "the skin of that job has {} nodes, that of the case {}; the numbers have to be the same",
            predicted.points.len(),
            rest.nodes().len()
        );
        return Err(Problem::at(at, ErrorCode::NotCorresponding, detail).into());
    }
    let pairs = predicted.points.iter().zip(&rest.surface.points);
    Ok(pairs.map(|(moved, rest)| moved - rest).collect())
}
