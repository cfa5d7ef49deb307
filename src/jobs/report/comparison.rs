//! The report of a comparison: signed distances on the skin, their statistics, and how the surfaces were registered.

use mechanics::chart::{PngError, ViewOutline, ViewRow, ViewValues, ViewsPicture};
use mechanics::mesh::{Frame, TriangleSurface, Vector};

use super::content::{Block, Figure, Report, Section, Table};
use super::tables::{mm, provenance, report, texts};
use super::warnings::warnings;
use super::words::{Words, filled, words};
use crate::jobs::result::pictures::face_direction;
use crate::schema::Language;
use crate::schema::compare::result::{ComparisonDocument, DistanceDocument};
use crate::schema::predict::result::ResultDocument;

/// The default end of the colour scale of signed distances, in mm.
pub const SIGNED_RANGE_MM: f64 = 2.0;

/// Two surfaces and their distance.
pub struct ComparisonFacts<'a> {
    pub surface: &'a TriangleSurface,
    /// The registered actual surface.
    pub actual: &'a TriangleSurface,
    /// At each of its points in mm, positive outside the actual surface.
    pub signed_distance: &'a [f64],
    /// The end of the colour scale in the spec.
    pub range_mm: Option<f64>,
    pub frame: Frame,
    pub comparison: &'a ComparisonDocument,
    pub result: &'a ResultDocument,
}

pub fn comparison_report(facts: &ComparisonFacts, language: Language) -> Result<Report, PngError> {
    let own = words(language);
    let comparison = facts.comparison;
    let table = Block::Table(distance_table(comparison, own));
    let mut sections = vec![
        views(facts, own)?,
        Section::new(own.distance_mm, vec![table]),
        registration(comparison, own),
    ];
    sections.extend(landmarks(comparison, own));
    let sure = vec![Block::Paragraph(own.not_clinical.to_owned())];
    sections.push(Section::new(own.how_sure, sure));
    let mut told = warnings(&facts.result.warnings, own);
    told.on_new_page = true;
    sections.push(told);
    sections.push(provenance(facts.result, own));
    let subtitle = format!("{} · {}", own.made, facts.result.provenance.created);
    Ok(report(language, own.comparison, subtitle, sections))
}

fn views(facts: &ComparisonFacts, words: &Words) -> Result<Section, PngError> {
    let range_mm = facts.range_mm.unwrap_or(SIGNED_RANGE_MM);
    let values = ViewValues {
        values: facts.signed_distance,
        range_mm,
        is_signed: true,
        name: words.distance_mm,
    };
    let points = &facts.surface.points;
    let actual = ViewOutline { points: &facts.actual.points, triangles: &facts.actual.triangles };
    let outline_of = Some(actual);
    let rows = [ViewRow { name: words.prediction, points, values: Some(values), outline_of }];
    let picture = ViewsPicture {
        triangles: &facts.surface.triangles,
        rows: &rows,
        face_direction: face_direction(facts.frame, facts.surface),
        columns: words.columns,
    };
    let caption = filled(words.outside, &[format!("{range_mm}")]);
    let figure = Figure::new(picture.to_drawing()?, words.comparison, caption);
    Ok(Section::new(words.comparison, vec![Block::Figure(figure)]))
}

/// Both directions, the common part, and each region.
pub fn distance_table(comparison: &ComparisonDocument, words: &Words) -> Table {
    let row = |name: &str, own: &DistanceDocument| {
        let lengths = [own.mean, own.rms, own.median, own.p95, own.max].map(mm);
        let shares = [own.share_below_1_mm, own.share_below_2_mm];
        let shares = shares.map(|share| format!("{:.1} %", 100.0 * share.max(0.0)));
        [vec![name.to_owned()], lengths.to_vec(), shares.to_vec()].concat()
    };
    let mut rows = vec![
        row(words.to_actual, &comparison.to_actual),
        row(words.to_prediction, &comparison.to_prediction),
        row(words.both, &comparison.both),
    ];
    rows.extend(comparison.regions.iter().map(|(name, own)| row(name, &own.both)));
    let [below_1, below_2] = ["1", "2"].map(|mm| filled(words.below, &[mm.to_owned()]));
    let mut columns = texts([words.distance_mm, words.mean, "rms", words.median, "p95", words.max]);
    columns.extend([below_1, below_2]);
    Table { columns, rows, least: 3 }
}

fn registration(comparison: &ComparisonDocument, words: &Words) -> Section {
    let alignment = &comparison.alignment;
    let shift = Vector::from(alignment.displacement_mm).norm();
    let turned = filled(words.turned, &[format!("{:.2}", alignment.rotation_deg), mm(shift)]);
    let rms = alignment.rms_mm.map_or_else(String::new, |rms| format!(", rms {} mm", mm(rms)));
    let coverage = &comparison.coverage;
    let shares = [coverage.of_prediction, coverage.of_actual];
    let covered = filled(words.covered, &shares.map(|share| format!("{:.0}", 100.0 * share)));
    let sentence = format!("{turned} ({}{rms}). {covered}", alignment.method);
    Section::new(words.registration, vec![Block::Paragraph(sentence)])
}

fn landmarks(comparison: &ComparisonDocument, words: &Words) -> Option<Section> {
    let errors = &comparison.landmark_errors;
    let rows = errors.iter().map(|(name, own)| vec![name.clone(), mm(own.distance_mm)]).collect();
    let columns = texts([words.landmark, words.distance_mm]);
    let table = Table::new(columns, rows);
    (!errors.is_empty()).then(|| Section::new(words.landmarks, vec![Block::Table(table)]))
}
