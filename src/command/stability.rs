//! `facies study --stability`: where methods fail, as a picture for people and tables for programs.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use super::claim::Claim;
use super::failure::CommandError;
use crate::jobs::study::words::variant_in_words;
use mechanics::chart::{Mark, StabilityAxis, StabilityMap};
use mechanics::study::stability::{Answer, AxisMap, Bounds, Finding, Map, Verdict, axes, map};
use mechanics::study::{Stopwatch, Variant};

/// What one probe may take, in s.
const PROBE_S: f64 = 30.0;

/// Maps these variants, writes `stability.svg`, `stability.json` and `stability.csv` into the folder and prints
/// a line for each axis and variant. An answer that is silently wrong is an error.
pub fn run(out: &Path, variants: &[Variant]) -> Result<(), CommandError> {
    let claim = Claim::of(out, &["stability.svg", "stability.json", "stability.csv"])?;
    let clock = Clock::start();
    let bounds = Bounds { stopwatch: &clock, seconds: PROBE_S };
    let found = map(variants, &axes::every(), &bounds, &|title| eprintln!("{title} …"));
    print(&found);
    claim.put("stability.svg", picture(&found))?;
    claim.put("stability.json", format!("{:#}\n", document(&found)))?;
    claim.put("stability.csv", table(&found))?;
    for name in ["stability.svg", "stability.json", "stability.csv"] {
        println!("wrote      {}", out.join(name).display());
    }
    match found.count(Verdict::Wrong) {
        0 => Ok(()),
        probes => Err(CommandError::SilentlyWrong { probes }),
    }
}

/// Since it was started.
pub(super) struct Clock(Instant);

impl Clock {
    pub fn start() -> Self {
        Clock(Instant::now())
    }
}

impl Stopwatch for Clock {
    fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    fn reset_peak(&self) {}

    fn peak_mb(&self) -> Option<f64> {
        None
    }
}

fn print(found: &Map) {
    for axis in &found.axes {
        println!("{} ({})", axis.title, axis.unit);
        for (variant, findings) in found.variants.iter().zip(&axis.findings) {
            let words = findings.iter().zip(&axis.values).filter_map(|(finding, (_, value))| {
                Some(format!("{value} {}", finding.as_ref()?.verdict.name()))
            });
            println!("  {variant:<28} {}", words.collect::<Vec<_>>().join(", "));
        }
    }
}

/// The map as one SVG document.
pub fn picture(found: &Map) -> String {
    let mark = |finding: &Finding| match finding.verdict {
        Verdict::Good => Mark::Good,
        Verdict::Cautious => Mark::Cautious,
        Verdict::Warned => Mark::Warned,
        Verdict::Refused => Mark::Refused,
        Verdict::Failed => Mark::Failed,
        Verdict::Wrong => Mark::Wrong,
    };
    let axis = |axis: &AxisMap| StabilityAxis {
        title: axis.title.to_owned(),
        unit: axis.unit.to_owned(),
        bound: format!("right to {} mm", axis.bound_mm),
        values: axis.values.iter().map(|(_, words)| words.clone()).collect(),
        marks: axis
            .findings
            .iter()
            .map(|row| row.iter().map(|finding| finding.as_ref().map(mark)).collect())
            .collect(),
    };
    let axes: Vec<StabilityAxis> = found.axes.iter().map(axis).collect();
    let rows: Vec<String> = found.variants.iter().map(|label| variant_in_words(label)).collect();
    StabilityMap {
        title: "Where methods fail, and whether they say so",
        subtitle: "Each panel turns one thing up from harmless to hopeless, left to right. Right: the skin's \
            error (95 % of its area) is within the stated bound of a closed form, a symmetry or a far better \
            method. A method without a cell there does not know what is turned up.",
        rows: &rows,
        axes: &axes,
    }
    .to_svg()
}

/// The map as JSON.
fn document(found: &Map) -> Value {
    let axes = found.axes.iter().map(|axis| {
        let rows = found.variants.iter().zip(&axis.findings);
        let probes: Vec<Value> = rows
            .flat_map(|(variant, findings)| {
                findings.iter().zip(&axis.values).filter_map(move |(finding, (value, _))| {
                    Some(probe(variant, *value, finding.as_ref()?))
                })
            })
            .collect();
        json!({
            "name": axis.name,
            "title": axis.title,
            "unit": axis.unit,
            "scene": axis.scene,
            "reference": axis.reference,
            "bound_mm": axis.bound_mm,
            "probes": probes,
        })
    });
    let count = |verdict: Verdict| found.count(verdict);
    json!({
        "variants": found.variants,
        "counts": {
            "good": count(Verdict::Good),
            "cautious": count(Verdict::Cautious),
            "warned": count(Verdict::Warned),
            "refused": count(Verdict::Refused),
            "failed": count(Verdict::Failed),
            "wrong": count(Verdict::Wrong),
        },
        "axes": axes.collect::<Vec<_>>(),
    })
}

fn probe(variant: &str, value: f64, finding: &Finding) -> Value {
    let answer = finding.answer.as_ref().map(|answer| {
        let warnings = answer.warnings.iter().map(|warning| {
            let numbers: serde_json::Map<String, Value> = warning
                .numbers
                .iter()
                .map(|(name, value)| ((*name).to_owned(), json!(value)))
                .collect();
            json!({ "code": warning.code, "detail": warning.detail, "numbers": numbers })
        });
        json!({
            "error_p95_mm": answer.error_mm,
            "smallest_det_f": answer.smallest_det_f,
            "inverted_share": answer.inverted_share,
            "largest_rotation_deg": answer.largest_rotation.to_degrees(),
            "warnings": warnings.collect::<Vec<_>>(),
        })
    });
    let refusal = finding.refusal.as_ref().map(|refusal| {
        json!({ "pointer": refusal.pointer, "code": refusal.code, "detail": refusal.detail })
    });
    json!({
        "variant": variant,
        "value": value,
        "verdict": finding.verdict.name(),
        "answer": answer,
        "refusal": refusal,
    })
}

/// The map as CSV, one line for each probe.
fn table(found: &Map) -> String {
    let mut lines = vec![
        "axis,variant,value,verdict,error_p95_mm,smallest_det_f,inverted_share,largest_rotation_deg,codes,pointer"
            .to_owned(),
    ];
    for axis in &found.axes {
        for (variant, findings) in found.variants.iter().zip(&axis.findings) {
            for (finding, (value, _)) in findings.iter().zip(&axis.values) {
                let Some(finding) = finding else { continue };
                let [codes, pointer] = words(finding);
                let numbers = finding.answer.as_ref().map_or(",,,".to_owned(), numbers);
                lines.push(format!(
                    "{},{variant},{value},{},{numbers},{codes},{pointer}",
                    axis.name,
                    finding.verdict.name()
                ));
            }
        }
    }
    lines.join("\n") + "\n"
}

fn numbers(answer: &Answer) -> String {
    let error = answer.error_mm.map(|error| error.to_string()).unwrap_or_default();
    format!(
        "{error},{},{},{}",
        answer.smallest_det_f,
        answer.inverted_share,
        answer.largest_rotation.to_degrees()
    )
}

/// The codes of warnings or of the error, and the place of a refusal.
fn words(finding: &Finding) -> [String; 2] {
    let warnings = finding.answer.iter().flat_map(|answer| &answer.warnings);
    let codes: Vec<&str> = warnings.map(|warning| warning.code).collect();
    match &finding.refusal {
        Some(refusal) => [refusal.code.clone(), refusal.pointer.clone()],
        None => [codes.join(" "), String::new()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One probe of one method, with this verdict.
    fn map_of(verdict: Verdict) -> Map {
        let finding = Finding { verdict, answer: None, refusal: None };
        let axis = AxisMap {
            name: "rotation",
            title: "Rotation",
            unit: "deg",
            scene: "a layer",
            reference: "a closed form",
            bound_mm: 0.5,
            values: vec![(1.0, "1".to_owned())],
            findings: vec![vec![Some(finding)]],
        };
        Map { variants: vec!["hex8".to_owned()], axes: vec![axis] }
    }

    #[test]
    fn the_picture_names_the_place_of_an_answer_that_is_silently_wrong() {
        assert!(picture(&map_of(Verdict::Wrong)).contains("SILENTLY WRONG at 1"));
        for verdict in [Verdict::Good, Verdict::Cautious, Verdict::Warned, Verdict::Refused] {
            let shown = picture(&map_of(verdict));
            assert!(!shown.contains("SILENTLY WRONG at"), "{}", verdict.name());
        }
        assert!(!picture(&map_of(Verdict::Failed)).contains("SILENTLY WRONG at"));
    }
}
