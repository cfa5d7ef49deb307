//! The report of a prediction: the plan in a surgeon's terms, the face before and after, numbers with their errors.

use std::collections::BTreeMap;

use mechanics::chart::{PngError, ViewOutline, ViewRow, ViewValues, ViewsPicture};
use mechanics::mesh::{Frame, TriangleSurface, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{NodeClass, Scene};

use super::comparison::distance_table;
use super::content::{Block, Figure, Report, Section, Table};
use super::directions::{directions, motion};
use super::form::ReportForm;
use super::load_steps::load_steps;
use super::method::{how_sure, method};
use super::room::clipped;
use super::tables::{mm, number_or_dash, provenance, report, signed, texts};
use super::warnings::warnings;
use super::words::{Words, filled, words};
use crate::jobs::failure::JobError;
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::pictures::face_direction;
use crate::schema::predict::output::OutputName;
use crate::schema::predict::planned::MeasureDocument;
use crate::schema::predict::result::{DisplacementDocument, ResultDocument};
use crate::schema::{CaseDocument, Language, PlanDocument};

/// The most letters of the name of a case under the title.
const LONGEST_NAME: usize = 120;

/// The most loads and muscles of a plan named in its sentence.
const MOST_BESIDE: usize = 18;
const LONGEST_PART: usize = 40;

/// Input and result of a prediction.
pub struct PredictionFacts<'a> {
    pub case: &'a CaseDocument,
    pub plan: &'a PlanDocument,
    pub scene: &'a Scene,
    pub frame: Frame,
    pub after: &'a TriangleSurface,
    /// The end of the colour scale, in mm.
    pub range_mm: f64,
    pub result: &'a ResultDocument,
}

pub fn prediction_report(facts: &PredictionFacts, language: Language) -> Result<Report, PngError> {
    let own = words(language);
    let result = facts.result;
    let mut sections = vec![plan(facts, own), views(facts, own)?];
    let mut numbers = regions(result, own);
    numbers.on_new_page = true;
    sections.push(numbers);
    sections.extend(landmarks(facts, own));
    sections.extend(measures(&result.cephalometry, own));
    let compared = result.comparison.as_ref();
    let compared = compared.map(|comparison| distance_table(comparison, own));
    sections.extend(compared.map(|table| Section::new(own.comparison, vec![Block::Table(table)])));
    sections.extend(load_steps(&result.load_steps, own));
    sections.push(how_sure(result, own));
    sections.push(warnings(&result.warnings, own));
    sections.push(method(result, facts.plan, own));
    sections.push(provenance(result, own));
    let title = if result.optimisation.is_some() { own.found_plan } else { own.prediction };
    let case = clipped(facts.case.name.as_deref().unwrap_or("–"), LONGEST_NAME);
    let subtitle = format!("{}: {case} · {}", own.case, result.provenance.created);
    Ok(report(language, title, subtitle, sections))
}

/// Those of the files of a result that are reports, in English.
pub fn write_reports(
    files: &[OutputName],
    facts: &PredictionFacts,
    folder: &mut ResultFolder,
) -> Result<(), JobError> {
    for &name in files {
        if let Some(form) = ReportForm::of(name) {
            let report = prediction_report(facts, Language::default())?;
            folder.add(name, &report.written(form))?;
        }
    }
    Ok(())
}

fn plan(facts: &PredictionFacts, words: &Words) -> Section {
    let is_stated = facts.frame != Frame::Unspecified;
    let segments = facts.scene.segments.iter().enumerate();
    let moving = segments.filter(|(_, own)| own.movement != RigidMovement::default());
    let rows: Vec<Vec<String>> =
        moving.map(|(index, segment)| movement(facts, index, segment, words)).collect();
    let beside = beside_bone(facts.plan, words);
    let mut blocks = Vec::new();
    if rows.is_empty() {
        blocks.push(Block::Paragraph(words.nothing_moves.to_owned()));
    } else {
        let mut columns = vec![words.segment.to_owned()];
        columns.extend(texts(if is_stated { words.movements } else { words.axes }));
        blocks.push(Block::Table(Table::new(columns, rows)));
        let told = if is_stated { words.of_centre } else { words.about_axes };
        blocks.push(Block::Paragraph(told.to_owned()));
    }
    blocks.extend(beside.map(Block::Paragraph));
    Section::new(words.plan, blocks)
}

/// A moving segment, its six movements in words.
fn movement(
    facts: &PredictionFacts,
    index: usize,
    segment: &PlannedSegment,
    words: &Words,
) -> Vec<String> {
    let centre = centre(facts.scene, index as u32);
    let motion = motion(&segment.movement, &centre, facts.frame);
    let mut row = vec![segment.name.clone()];
    for (way, (&value, ways)) in motion.iter().zip(&words.ways).enumerate() {
        let unit = if way < 3 { "" } else { "°" };
        let number = format!("{:.1}{unit}", value.abs());
        row.push(match facts.frame {
            _ if value.abs() < 0.05 => "–".to_owned(),
            Frame::Unspecified => format!("{value:+.1}{unit}"),
            Frame::Lps | Frame::Ras => format!("{number} {}", ways[usize::from(value < 0.0)]),
        });
    }
    row
}

/// The mean of the nodes of a segment; the mean of all if it has none.
fn centre(scene: &Scene, segment: u32) -> Vector {
    let nodes = scene.mesh.nodes.iter().zip(&scene.conditions.classes);
    let held = nodes.filter(|(_, class)| **class == NodeClass::Joined(segment));
    let (sum, count) =
        held.fold((Vector::zeros(), 0.0), |(sum, count), (node, _)| (sum + node, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// Parts of a plan that move no bone.
fn beside_bone(plan: &PlanDocument, words: &Words) -> Option<String> {
    let plain = |name: &str| match name {
        "*" => words.all_tissue.to_owned(),
        named => clipped(&named.replace('_', " "), LONGEST_PART),
    };
    let grows = plan.growth.iter().map(|own| {
        let percent = format!("{:+}", rounded(100.0 * own.volume_change));
        filled(words.growth, &[plain(&own.region), percent])
    });
    let pulls = plan.activations.iter().filter(|own| own.stress_kpa > 0.0).map(|own| {
        filled(words.activation, &[plain(&own.muscle), rounded(own.stress_kpa).to_string()])
    });
    let mut told: Vec<String> = grows.chain(pulls).collect();
    if told.len() > MOST_BESIDE {
        let left = told.len() - MOST_BESIDE;
        told.truncate(MOST_BESIDE);
        told.push(filled(words.more, &[left.to_string()]));
    }
    let counts = [(words.loads, plan.loads.len()), (words.prescribed, plan.prescribed.len())];
    let counts = counts.iter().filter(|(_, count)| *count > 0);
    told.extend(counts.map(|(sentence, count)| filled(sentence, &[count.to_string()])));
    (!told.is_empty()).then(|| format!("{}: {}.", words.beside_bone, told.join(", ")))
}

/// To two decimals.
fn rounded(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

fn views(facts: &PredictionFacts, words: &Words) -> Result<Section, PngError> {
    let before = &facts.scene.skin.surface;
    let pairs = before.points.iter().zip(&facts.after.points);
    let moved: Vec<f64> = pairs.map(|(before, after)| (after - before).norm()).collect();
    let triangles = &*before.triangles;
    let row = |name, points, outline: Option<_>| {
        let outline_of = outline.map(|points| ViewOutline { points, triangles });
        ViewRow { name, points, values: None, outline_of }
    };
    let range_mm = facts.range_mm;
    let values = ViewValues { values: &moved, range_mm, is_signed: false, name: words.moved_mm };
    let [before_points, after_points] = [before, facts.after].map(|surface| &*surface.points);
    let rows = [
        row(words.before, before_points, None),
        row(words.after, after_points, Some(before_points)),
        ViewRow { values: Some(values), ..row(words.moved, after_points, None) },
    ];
    let picture = ViewsPicture {
        triangles: &before.triangles,
        rows: &rows,
        face_direction: face_direction(facts.frame, before),
        columns: words.columns,
    };
    let caption = filled(words.outline, &[format!("{range_mm}")]);
    let figure = Figure::new(picture.to_drawing()?, words.views, caption);
    Ok(Section::new(words.views, vec![Block::Figure(figure)]))
}

fn regions(result: &ResultDocument, words: &Words) -> Section {
    let (mesh, model) = (&result.numerical_error_mm, &result.nonlinearity_mm);
    let row = |name: &str, own: &DisplacementDocument, errors: [Option<f64>; 2]| {
        let numbers = [own.area.mean, own.area.median, own.area.p95, own.area.max];
        let errors = errors.map(number_or_dash);
        [vec![name.to_owned()], numbers.map(mm).to_vec(), errors.to_vec()].concat()
    };
    let mut rows = Vec::new();
    if let Some(statistics) = &result.statistics {
        let whole = [mesh.as_ref().map(|own| own.mean), model.as_ref().map(|own| own.skin.mean)];
        rows.push(row(words.whole_skin, &statistics.skin, whole));
        rows.extend(statistics.regions.iter().map(|(name, own)| {
            let of_mesh = mesh.as_ref().and_then(|all| all.regions.get(name)).map(|own| own.mean);
            let of_model = model.as_ref().and_then(|all| all.regions.get(name)).map(|own| own.mean);
            row(name, own, [of_mesh, of_model])
        }));
    }
    let columns = ["", words.mean, words.median, "p95", words.max, words.of_mesh, words.of_model];
    let table = Table::new(texts(columns), rows);
    Section::new(words.displacement, vec![Block::Table(table)])
}

fn landmarks(facts: &PredictionFacts, words: &Words) -> Option<Section> {
    let result = facts.result;
    let moved = &result.statistics.as_ref()?.landmarks;
    let empty = BTreeMap::new();
    let mesh = result.numerical_error_mm.as_ref().map_or(&empty, |own| &own.landmarks);
    let model = result.nonlinearity_mm.as_ref().map_or(&empty, |own| &own.landmarks);
    let rows: Vec<Vec<String>> = moved
        .iter()
        .map(|(name, &triple)| {
            let vector = Vector::from(triple);
            let along = directions(&vector, facts.frame).map(signed);
            let errors = [mesh, model].map(|errors| number_or_dash(errors.get(name).copied()));
            let length = vec![mm(vector.norm())];
            [vec![name.clone()], along.to_vec(), length, errors.to_vec()].concat()
        })
        .collect();
    let along = match facts.frame {
        Frame::Unspecified => ["y", "z", "x"],
        Frame::Lps | Frame::Ras => words.directions,
    };
    let [forward, up, left] = along;
    let columns = [words.landmark, forward, up, left, words.length, words.of_mesh, words.of_model];
    let table = Table::new(texts(columns), rows);
    (!moved.is_empty()).then(|| Section::new(words.landmarks, vec![Block::Table(table)]))
}

fn measures(measures: &[MeasureDocument], words: &Words) -> Option<Section> {
    let rows: Vec<Vec<String>> = measures
        .iter()
        .map(|own| {
            let after = own.planned.or(own.predicted);
            let change = after.map(|after| after - own.before);
            let unit = match own.unit.as_str() {
                "deg" => "°",
                "1" => "",
                other => other,
            };
            let name = format!("{} {unit}", own.name.replace('_', " ").to_uppercase());
            let change = change.map_or_else(|| "–".to_owned(), signed);
            vec![name, mm(own.before), number_or_dash(after), change]
        })
        .collect();
    let columns = [words.measure, words.before, words.planned, words.change];
    let table = Table::new(texts(columns), rows);
    (!measures.is_empty()).then(|| Section::new(words.head, vec![Block::Table(table)]))
}
