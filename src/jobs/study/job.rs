//! The job of a study: rows one after the other, the report in every form, its charts and its outcome.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::cell_sizes::{CELL_SIZES_CSV, cell_size_groups, cell_sizes_chart, cell_sizes_csv};
use super::chart::{chart, estimates_chart};
use super::constants::constants_chart;
use super::files::{
    CHART_SVG, CSV_MEDIA_TYPE, ESTIMATES_SVG, JSON_MEDIA_TYPE, JUNIT_MEDIA_TYPE, REPORT_CSV,
    REPORT_JSON, REPORT_JUNIT, SVG_MEDIA_TYPE, csv, junit,
};
use super::input::StudyInput;
use super::prepare::{PreparedStudy, most_rows, truth_meshes};
use super::report::{ReportOrigin, encode_report, kept_report, report_document};
use super::stopwatch::MachineStopwatch;
use super::verdict::judge;
use crate::jobs::clock::{Observed, now_rfc3339};
use crate::jobs::failure::JobError;
use crate::jobs::output::{JobContext, JobOutput};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::jobs::result::warnings::warning_documents;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::output::PictureName;
use crate::schema::predict::result::ResultDocument;
use crate::schema::study::constants::ConstantMapDocument;
use crate::schema::study::report::ReportDocument;
use mechanics::mesh::Frame;
use mechanics::progress::{Phase, Progress};
use mechanics::study::constant_map::constant_maps;
use mechanics::study::sweep::axes;
use mechanics::study::{Stopwatch, StudyError, run};

/// The total time limit of a study: its budget once for rows, once for references, and a minute for the rest, in s.
fn whole_budget(rows_s: f64) -> f64 {
    2.0 * rows_s + 60.0
}

/// Measures rows and reports which one is solved, but not the iterations inside: they restart with every
/// row.
struct Rows<'a> {
    clock: &'a Observed<'a>,
    stopwatch: MachineStopwatch,
    begun: AtomicUsize,
    /// Rows, and meshes of reference solutions.
    most: usize,
}

impl Stopwatch for Rows<'_> {
    fn seconds(&self) -> f64 {
        self.stopwatch.seconds()
    }

    /// A study does so when a row begins.
    fn reset_peak(&self) {
        self.begin();
        self.stopwatch.reset_peak();
    }

    fn peak_mb(&self) -> Option<f64> {
        self.stopwatch.peak_mb()
    }
}

impl Rows<'_> {
    fn begin(&self) {
        self.clock.step(self.begun.fetch_add(1, Ordering::Relaxed), self.most);
    }
}

impl Progress for Rows<'_> {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    /// A reference does so when it is solved on a mesh, after all rows of its scene.
    fn step(&self, _done: usize, _of: usize) {
        self.begin();
    }

    fn is_cancelled(&self) -> bool {
        self.clock.is_cancelled()
    }
}

/// Runs a study and writes its report.
pub fn study_job(
    input: &StudyInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, whole_budget(input.spec.budget.wall_s)).of_study();

    // 1. Documents and meshes, checked together.
    let prepared = clock.prepared(|stop| input.prepare(place.sources, place.limits, stop))?;
    clock.check()?;

    // 2. Rows and truths, unless an earlier study has them.
    let mut report = rows_of(input, &prepared, &clock)?;

    // 3. The outcome.
    clock.phase(Phase::Compare);
    judge(&mut report, &input.to_baseline());

    // 4. Files.
    clock.phase(Phase::Write);
    let mut folder = ResultFolder::open(place)?;
    write_report(&report, &mut folder)?;
    let origin = Origin {
        spec_hash: prepared.spec_hash,
        inputs: prepared.inputs,
        frame: Frame::Unspecified,
        queue_s: input.queue_s,
    };
    let mut warnings = warning_documents(prepared.warnings.iter());
    warnings.extend(report.scenes.iter().flat_map(|scene| scene.warnings.iter().cloned()));
    warnings.extend(report.constant_maps.iter().flat_map(|map| map.warnings.iter().cloned()));
    let provenance = origin.provenance(&clock);
    let result = ResultDocument {
        study: Some(report.summary()),
        pictures: input.job.as_ref().map_or_else(Vec::new, |_| PictureName::REPORTS.to_vec()),
        ..ResultDocument::new(input.job.clone(), &folder.files, provenance, warnings)
    };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files, meshes: Vec::new() })
}

/// The report before its outcome: rows of an earlier one with the same key, else solved.
fn rows_of(
    input: &StudyInput,
    prepared: &PreparedStudy,
    clock: &Observed,
) -> Result<ReportDocument, JobError> {
    let (spec, variants) = (&input.spec, prepared.study.variants.as_slice());
    let origin = || ReportOrigin {
        job: input.job.clone(),
        spec_hash: prepared.spec_hash.clone(),
        rows_key: prepared.rows_key.clone(),
        stated: prepared.stated.clone(),
        series: prepared.series.clone(),
        created: now_rfc3339(),
    };
    if let Some(earlier) = input.rows_of(&prepared.rows_key) {
        return Ok(kept_report(earlier, spec, variants, origin()));
    }
    clock.phase(Phase::Solve);
    let rows = Rows {
        clock,
        stopwatch: MachineStopwatch::start(),
        begun: AtomicUsize::new(0),
        most: most_rows(&prepared.study) + truth_meshes(&prepared.study),
    };
    let found = run(&prepared.study, &rows, &rows).map_err(|error| match error {
        StudyError::Cancelled => clock.stopped(),
        other => JobError::Study(other),
    })?;
    let swept = spec.sweep.iter().map(|(region, of)| (region.clone(), of.to_values())).collect();
    let maps = constant_maps(&found, &prepared.study, &axes(&swept));
    let constant_maps = maps.iter().filter_map(ConstantMapDocument::new).collect();
    Ok(ReportDocument { constant_maps, ..report_document(&found, spec, variants, origin()) })
}

/// The report in every form, a chart over all scenes, one for each of several, one for each map of
/// swept constants, and table and charts of cell sizes.
fn write_report(report: &ReportDocument, folder: &mut ResultFolder) -> Result<(), JobError> {
    folder.add_file(REPORT_JSON, JSON_MEDIA_TYPE, &encode_report(report)?)?;
    folder.add_file(REPORT_CSV, CSV_MEDIA_TYPE, csv(report).as_bytes())?;
    folder.add_file(REPORT_JUNIT, JUNIT_MEDIA_TYPE, junit(report).as_bytes())?;
    folder.add_file(CHART_SVG, SVG_MEDIA_TYPE, chart(report, None).as_bytes())?;
    if let Some(chart) = estimates_chart(report) {
        folder.add_file(ESTIMATES_SVG, SVG_MEDIA_TYPE, chart.as_bytes())?;
    }
    if report.scenes.len() > 1 {
        for (index, scene) in report.scenes.iter().enumerate() {
            let file = format!("chart-{}-{}.svg", index + 1, file_name(&scene.name));
            let svg = chart(report, Some(&scene.name));
            folder.add_file(&file, SVG_MEDIA_TYPE, svg.as_bytes())?;
        }
    }
    for (index, map) in report.constant_maps.iter().enumerate() {
        let file = format!("constants-{}-{}.svg", index + 1, file_name(&map.label));
        let svg = constants_chart(report, map)?;
        folder.add_file(&file, SVG_MEDIA_TYPE, svg.as_bytes())?;
    }
    if !report.cell_sizes.is_empty() {
        let table = cell_sizes_csv(report);
        folder.add_file(CELL_SIZES_CSV, CSV_MEDIA_TYPE, table.as_bytes())?;
    }
    for (index, group) in cell_size_groups(report).into_iter().enumerate() {
        let file = format!("cell-sizes-{}-{}.svg", index + 1, file_name(group[0]));
        let svg = cell_sizes_chart(report, group);
        folder.add_file(&file, SVG_MEDIA_TYPE, svg.as_bytes())?;
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
