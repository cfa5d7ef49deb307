//! The job of a study: rows one after the other, the report in every form, its charts and its outcome.

mod batch;
mod chart;
pub mod files;
pub mod report;
mod scenes;
pub mod stopwatch;
mod truth;
pub mod verdict;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::{Deserialize, Serialize};

use super::clock::{Observed, now_rfc3339};
use super::failure::JobError;
use super::source::MeshSource;
use super::work::{JobOutput, Workplace};
use crate::jobs::predict::check::warning_documents;
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::schema::hashes;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::{InputDocument, ResultDocument};
use crate::schema::study::document::StudyKind;
use crate::schema::study::report::ReportDocument;
use crate::schema::wire::canonical;
use crate::schema::{CaseDocument, ErrorCode, Faults, Limits, Pointer, Problem, StudyDocument};
use batch::Parts;
use chart::chart;
use files::{
    CHART_SVG, CSV_MEDIA_TYPE, JSON_MEDIA_TYPE, JUNIT_MEDIA_TYPE, REPORT_CSV, REPORT_JSON,
    REPORT_JUNIT, SVG_MEDIA_TYPE, csv, junit,
};
use mechanics::mesh::{Frame, Warning};
use mechanics::progress::{Phase, Progress};
use mechanics::study::{Stopwatch, Study, StudyError, StudyScene, run};
use report::{ReportOrigin, encode_report, report_document};
use scenes::Documents;
use stopwatch::MachineStopwatch;
use verdict::{Baseline, judge};

/// What a study may take in all: its budget once for rows, once for truths, and a minute for the rest, in s.
fn whole_budget(rows_s: f64) -> f64 {
    2.0 * rows_s + 60.0
}

/// A study: its cases and its baseline in full beside the spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    /// By their ids in the spec.
    pub cases: BTreeMap<String, CaseDocument>,
    /// The report of the study that the spec names as baseline.
    pub baseline: Option<Box<ReportDocument>>,
    pub spec: StudyDocument,
}

/// A study whose documents are sound.
pub struct PreparedStudy {
    pub study: Study,
    pub spec_hash: String,
    inputs: Vec<InputDocument>,
    warnings: Vec<Warning>,
}

impl StudyInput {
    /// Makes the scenes, fetches the meshes and checks the documents. Pointers start at `/case` and `/spec`.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
    ) -> Result<PreparedStudy, JobError> {
        let mut faults = Faults::default();
        self.spec.check(limits, &mut faults);
        faults.into_result()?;
        let documents = Documents { spec: &self.spec, cases: &self.cases, sources, limits };
        let mut faults = Faults::default();
        let Parts { scenes, variants, pairs } = match self.spec.kind {
            StudyKind::Study => {
                let variants = documents.variants(&mut faults);
                let scenes = documents.scenes(&mut faults)?;
                Parts { scenes, variants, pairs: BTreeSet::new() }
            }
            StudyKind::Batch => documents.items(&mut faults)?,
        };
        faults.into_result()?;
        let study = Study {
            scenes: scenes.scenes,
            variants,
            pairs,
            levels: self.spec.levels.clone(),
            repeats: self.spec.repeats as usize,
            budget_s: self.spec.budget.wall_s,
            row_s: self.spec.budget.row_s,
        };
        let (rows, most) = (most_rows(&study), limits.study_rows as usize);
        if rows > most {
            let detail = format!("the study has {rows} rows, at most {most} are allowed");
            return Err(
                Problem::at(&Pointer::root().key("spec"), ErrorCode::TooMany, detail).into()
            );
        }
        let content = |id: &str| scenes.contents.get(id).cloned();
        let cases: Vec<&CaseDocument> =
            self.spec.case_ids().into_iter().filter_map(|id| self.cases.get(id)).collect();
        let baseline = self.baseline.as_ref().map(canonical::to_value);
        let spec_hash = hashes::study_hash(&cases, &self.spec, baseline.as_ref(), &content);
        Ok(PreparedStudy { study, spec_hash, inputs: scenes.inputs, warnings: scenes.warnings })
    }

    /// The ids of all meshes that its cases read.
    pub fn mesh_ids(&self) -> Vec<String> {
        let mut ids: Vec<String> = self.cases.values().flat_map(CaseDocument::mesh_ids).collect();
        for plan in self.spec.clone().plan_documents_mut() {
            for (_, id) in plan.surface_references_mut() {
                let is_bone = |case: &CaseDocument| case.bones.iter().any(|bone| bone.name == *id);
                if !self.cases.values().any(is_bone) {
                    ids.push(id.clone());
                }
            }
        }
        ids.sort_unstable();
        ids.dedup();
        ids
    }
}

/// How many rows a study has, with those that turn out to be the truth itself.
fn most_rows(study: &Study) -> usize {
    let of_scene = |(place, scene): (usize, &StudyScene)| {
        scene.plans.len() * scene.materials.len() * study.variants_of(place).count()
    };
    let on_a_mesh: usize = study.scenes.iter().enumerate().map(of_scene).sum();
    on_a_mesh * study.levels.len()
}

/// Measures rows and tells which one is solved, but nothing of the iterations inside: they begin anew with every
/// row.
struct Rows<'a> {
    clock: &'a Observed<'a>,
    stopwatch: MachineStopwatch,
    begun: AtomicUsize,
    most: usize,
}

impl Stopwatch for Rows<'_> {
    fn seconds(&self) -> f64 {
        self.stopwatch.seconds()
    }

    /// A study does so where a row begins.
    fn forget_peak(&self) {
        self.clock.step(self.begun.fetch_add(1, Ordering::Relaxed), self.most);
        self.stopwatch.forget_peak();
    }

    fn peak_mb(&self) -> Option<f64> {
        self.stopwatch.peak_mb()
    }
}

impl Progress for Rows<'_> {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        self.clock.is_cancelled()
    }
}

/// Runs a study and writes its report.
pub fn study_job(
    input: &StudyInput,
    place: &Workplace,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, whole_budget(input.spec.budget.wall_s));

    // 1. Documents and meshes, checked together.
    let prepared = input.prepare(place.sources, place.limits)?;
    clock.check()?;

    // 2. Rows and truths.
    clock.phase(Phase::Solve);
    let rows = Rows {
        clock: &clock,
        stopwatch: MachineStopwatch::start(),
        begun: AtomicUsize::new(0),
        most: most_rows(&prepared.study),
    };
    let found = run(&prepared.study, &rows, &rows);
    let found = found.map_err(|error| match error {
        StudyError::Cancelled => clock.stopped(),
        other => JobError::Study(other),
    })?;

    // 3. The outcome.
    clock.phase(Phase::Compare);
    let origin = ReportOrigin {
        job: input.job.clone(),
        spec_hash: prepared.spec_hash.clone(),
        created: now_rfc3339(),
    };
    let mut report = report_document(&found, &input.spec, &prepared.study.variants, origin);
    judge(&mut report, &input.to_baseline());

    // 4. Files.
    clock.phase(Phase::Write);
    let mut folder = ResultFolder::open(place.out)?;
    write_report(&report, &mut folder)?;
    let origin = Origin {
        spec_hash: prepared.spec_hash,
        inputs: prepared.inputs,
        frame: Frame::Unspecified,
        queue_s: input.queue_s,
    };
    let result = ResultDocument {
        job: input.job.clone(),
        files: folder.files.clone(),
        statistics: None,
        comparison: None,
        optimisation: None,
        study: Some(report.summary()),
        numerical_error_mm: None,
        reaction_mn: BTreeMap::new(),
        provenance: origin.provenance(&clock),
        warnings: warning_documents(prepared.warnings.iter()),
    };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files })
}

impl StudyInput {
    fn to_baseline(&self) -> Baseline<'_> {
        match (&self.baseline, &self.spec.baseline) {
            (Some(report), _) => Baseline::Report(report),
            (None, Some(job)) => Baseline::Missing(format!("the baseline {job} has no report")),
            (None, None) => Baseline::NotAsked,
        }
    }
}

/// The report in every form, a chart over all scenes, and one for each where there are several.
fn write_report(report: &ReportDocument, folder: &mut ResultFolder) -> Result<(), JobError> {
    folder.add_file(REPORT_JSON, JSON_MEDIA_TYPE, &encode_report(report)?)?;
    folder.add_file(REPORT_CSV, CSV_MEDIA_TYPE, csv(report).as_bytes())?;
    folder.add_file(REPORT_JUNIT, JUNIT_MEDIA_TYPE, junit(report).as_bytes())?;
    folder.add_file(CHART_SVG, SVG_MEDIA_TYPE, chart(report, None).as_bytes())?;
    if report.scenes.len() > 1 {
        for (index, scene) in report.scenes.iter().enumerate() {
            let file = format!("chart-{}-{}.svg", index + 1, file_name(&scene.name));
            let svg = chart(report, Some(&scene.name));
            folder.add_file(&file, SVG_MEDIA_TYPE, svg.as_bytes())?;
        }
    }
    Ok(())
}

/// A name as part of a file name: letters and digits, all else a dash.
fn file_name(name: &str) -> String {
    let plain = |letter: char| match letter.is_ascii_alphanumeric() || letter == '_' {
        true => letter,
        false => '-',
    };
    name.chars().take(40).map(plain).collect()
}
