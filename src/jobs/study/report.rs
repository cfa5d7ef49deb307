//! Report of a study as a document for clients.

use std::collections::BTreeMap;

use super::documents::StatedHashes;
use crate::jobs::failure::JobError;
use crate::jobs::result::provenance::first_null;
use crate::schema::WarningDocument;
use crate::schema::predict::result::{EngineDocument, NOT_A_DEVICE};
use crate::schema::study::cell_sizes::CellSizesDocument;
use crate::schema::study::document::StudyDocument;
use crate::schema::study::report::{
    ConvergenceDocument, ErrorsDocument, NumbersDocument, ReportDocument, RowDocument,
    RowErrorDocument, RowStatus, RowVerdict, RulesDocument, SignedRankDocument, SkippedDocument,
    StudySceneDocument, TruthErrorDocument, VariantComparisonDocument, VerdictDocument,
};
use mechanics::study::cell_sizes::cell_sizes;
use mechanics::study::convergence::{Series, series};
use mechanics::study::pairwise::{Pairwise, compare_variants, many_comparisons};
use mechanics::study::{
    Errors, NOT_RUN, Outcome, Report, Row, SceneReport, Skipped, Solved, Variant, pareto,
};

/// The origin of a report.
pub struct ReportOrigin {
    pub job: Option<String>,
    pub spec_hash: String,
    pub rows_key: String,
    /// Of each case its hashes as stated, by the name of its scene.
    pub stated: BTreeMap<String, StatedHashes>,
    /// The series of each scene in one, by its name.
    pub series: BTreeMap<String, String>,
    /// RFC 3339, UTC.
    pub created: String,
}

/// The report, not judged yet.
pub fn report_document(
    report: &Report,
    spec: &StudyDocument,
    variants: &[Variant],
    origin: ReportOrigin,
) -> ReportDocument {
    let comparisons = compare_variants(&report.rows);
    let mut rows: Vec<RowDocument> = report.rows.iter().map(row_document).collect();
    for scene in &report.scenes {
        mark_front(&mut rows, &scene.name);
    }
    ReportDocument {
        schema: 1,
        job: origin.job,
        spec_hash: origin.spec_hash,
        rows_key: origin.rows_key,
        rows_of: None,
        engine: EngineDocument::this(),
        created: origin.created,
        verdict: VerdictDocument::default(),
        rules: rules(spec, variants),
        scenes: report.scenes.iter().map(|scene| scene_document(scene, &origin.stated)).collect(),
        rows,
        skipped: report.skipped.iter().map(skipped_document).collect(),
        comparisons: comparisons.iter().map(comparison_document).collect(),
        comparisons_note: many_comparisons(&comparisons),
        constant_maps: Vec::new(),
        convergence: series(report).iter().map(convergence_document).collect(),
        cell_sizes: cell_sizes(report, &origin.series)
            .iter()
            .map(CellSizesDocument::from)
            .collect(),
        statement: NOT_A_DEVICE.to_owned(),
    }
}

/// The rows of an earlier report under the rules of this study, not judged yet.
pub fn kept_report(
    earlier: &ReportDocument,
    spec: &StudyDocument,
    variants: &[Variant],
    origin: ReportOrigin,
) -> ReportDocument {
    ReportDocument {
        job: origin.job,
        spec_hash: origin.spec_hash,
        rows_key: origin.rows_key,
        rows_of: Some(earlier.source()),
        created: origin.created,
        rules: rules(spec, variants),
        ..earlier.clone()
    }
}

fn rules(spec: &StudyDocument, variants: &[Variant]) -> RulesDocument {
    RulesDocument {
        thresholds: spec.thresholds.clone(),
        tolerances: spec.tolerances,
        expected_failures: expected_failures(spec, variants),
    }
}

/// The bytes of `report.json`; a number that is not finite is refused, since JSON would say null.
pub fn encode_report(report: &ReportDocument) -> Result<Vec<u8>, JobError> {
    let value = serde_json::to_value(report)
        .map_err(|error| JobError::NotFinite { what: error.to_string() })?;
    if let Some(what) = first_null(&value, String::new()) {
        return Err(JobError::NotFinite { what });
    }
    Ok(format!("{value:#}\n").into_bytes())
}

/// Marks the Pareto-optimal rows among those of the same plan, material and kind of reference of a scene.
fn mark_front(rows: &mut [RowDocument], scene: &str) {
    let truth_contact = |row: &RowDocument| row.numbers.as_ref().is_some_and(|n| n.truth_contact);
    let mut groups: Vec<(String, String, bool)> = Vec::new();
    for row in rows.iter().filter(|row| row.scene == scene) {
        let group = (row.plan.clone(), row.material.clone(), truth_contact(row));
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    for (plan, material, contact) in groups {
        let is_own = |row: &RowDocument| {
            (&*row.scene, &row.plan, &row.material) == (scene, &plan, &material)
                && truth_contact(row) == contact
        };
        let own = rows.iter().enumerate().filter(|(_, row)| is_own(row));
        let (places, points): (Vec<usize>, Vec<[f64; 2]>) = own
            .filter_map(|(place, row)| {
                row.numbers.as_ref().map(|numbers| (place, [numbers.wall_s, numbers.p95_mm]))
            })
            .unzip();
        for point in pareto::front(&points) {
            rows[places[point]].on_front = true;
        }
    }
}

fn scene_document(
    scene: &SceneReport,
    stated: &BTreeMap<String, StatedHashes>,
) -> StudySceneDocument {
    let stated = stated.get(&scene.name);
    StudySceneDocument {
        name: scene.name.clone(),
        nodes: scene.nodes as u64,
        cells: scene.cells as u64,
        cell_mm: Some(scene.cell_size).filter(|size| size.is_finite()),
        skin_nodes: scene.skin_nodes as u64,
        plans: stated.map(|stated| stated.plans.clone()).unwrap_or_default(),
        case: stated.map(|stated| stated.case.clone()),
        truth: scene.truth.clone(),
        truth_error_mm: scene.truth_error_mm.map(|[mean, p95]| TruthErrorDocument { mean, p95 }),
        unmoved_mm: scene.unmoved_mm,
        noise_mm: scene.noise_mm,
        warnings: scene.warnings.iter().map(WarningDocument::from).collect(),
        truth_s: scene.truth_s,
    }
}

fn skipped_document(skipped: &Skipped) -> SkippedDocument {
    SkippedDocument {
        scene: skipped.scene.clone(),
        method: skipped.method.clone(),
        label: skipped.label.clone(),
        reason: skipped.reason.clone(),
        rows: skipped.rows as u64,
    }
}

fn row_document(row: &Row) -> RowDocument {
    let (status, numbers, error, warnings) = match &row.outcome {
        Outcome::Solved(solved) => {
            (RowStatus::Solved, Some(numbers(solved)), None, solved.warnings.clone())
        }
        Outcome::Failed { code, detail } => {
            let error = RowErrorDocument { kind: code.clone(), detail: detail.clone() };
            let status = if code == NOT_RUN { RowStatus::NotRun } else { RowStatus::Failed };
            (status, None, Some(error), Vec::new())
        }
    };
    RowDocument {
        scene: row.scene.clone(),
        plan: row.plan.clone(),
        method: row.method.clone(),
        label: row.label.clone(),
        element: row.element.clone(),
        material: row.material.clone(),
        level: row.level,
        status,
        numbers,
        error,
        warnings,
        on_front: false,
        verdict: RowVerdict::NotRun,
        reasons: Vec::new(),
    }
}

fn numbers(solved: &Solved) -> NumbersDocument {
    NumbersDocument {
        unknowns: solved.unknowns as u64,
        iterations: solved.iterations as u64,
        wall_s: solved.wall_s,
        repeats: solved.repeats as u64,
        peak_mb: solved.peak_mb,
        mean_mm: solved.error.mean,
        p95_mm: solved.error.p95,
        max_mm: solved.error.max,
        closest_point_mm: errors(&solved.closest_point),
        regions_mm: solved.regions.iter().map(|(name, of)| (name.clone(), errors(of))).collect(),
        skin_mean_mm: solved.skin_mean_mm,
        numerical_error_mm: solved.numerical_error.as_ref().map(errors),
        linearity_error_mm: solved.linearity_error.as_ref().map(errors),
        effectivity: solved.effectivity,
        chosen: solved.chosen.clone(),
        smallest_det_f: solved.smallest_det_f.is_finite().then_some(solved.smallest_det_f),
        truth_error_mm: solved.truth_error.map(|[mean, p95]| TruthErrorDocument { mean, p95 }),
        truth_contact: solved.truth_contact,
        covered_share: solved.covered_share,
    }
}

fn errors(errors: &Errors) -> ErrorsDocument {
    ErrorsDocument { mean: errors.mean, p95: errors.p95, max: errors.max }
}

fn comparison_document(pair: &Pairwise) -> VariantComparisonDocument {
    let test = pair.test.as_ref().ok().map(|(test, pratt)| SignedRankDocument {
        differing: test.differing as u64,
        w_positive: test.positive,
        w_negative: test.negative,
        p_two_sided: test.two_sided_p,
        p_two_sided_pratt: *pratt,
        exact: test.exact,
        smallest_p: test.smallest_p,
        rank_biserial: test.effect,
    });
    VariantComparisonDocument {
        first: pair.first.clone(),
        second: pair.second.clone(),
        measure: pair.measure.name().to_owned(),
        scenes: pair.scenes as u64,
        rows: pair.rows as u64,
        unsolved: pair.unsolved as u64,
        other_truths: pair.other_truths as u64,
        median_difference_mm: pair.median_difference_mm,
        test,
        sentence: pair.sentence(),
    }
}

fn convergence_document(of: &Series) -> ConvergenceDocument {
    ConvergenceDocument {
        scene: of.scene.clone(),
        plan: of.plan.clone(),
        material: of.material.clone(),
        label: of.label.clone(),
        levels: of.levels.clone(),
        skin_mean_mm: of.skin_mean_mm.clone(),
        last_change: of.last_change,
        order: of.order,
        limit_mm: of.limit_mm,
    }
}

/// The labels of the variants that may fail, and those of the spec.
fn expected_failures(spec: &StudyDocument, variants: &[Variant]) -> Vec<String> {
    let own = variants.iter().filter(|variant| variant.may_fail).map(|variant| &variant.label);
    own.chain(&spec.expected_failures).cloned().collect()
}
