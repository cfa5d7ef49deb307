//! Measured speed and accuracy of each method, read from the table of the built-in study.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::predict::time_band::TimeBandDocument;

/// The `report.csv` of the study of docs/speed-and-accuracy.md.
const TABLE: &str = include_str!("measured.csv");

/// One variant of a method on one scene and mesh level: medians over the plans and materials of the study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeasuredDocument {
    pub scene: String,
    /// The variant.
    pub label: String,
    /// The number of halvings of each edge.
    pub level: u32,
    pub unknowns: u64,
    /// From mesh in memory to displacement in memory, on one thread.
    pub wall_s: f64,
    /// The 95th percentile of the error, by area of the skin.
    pub p95_mm: f64,
    /// Rows in the medians.
    pub rows: u64,
}

/// A row of the table with numbers.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    scene: String,
    method: String,
    label: String,
    level: u32,
    unknowns: u64,
    wall_s: f64,
    p95_mm: f64,
}

fn rows() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| parse(TABLE).unwrap_or_default())
}

/// The expected range of the solution time for a number of unknowns, in s: from the best row of the table with
/// time in proportion to the unknowns, to the worst with time in proportion to their power 4/3, as that of iterations
/// whose number grows with the nodes across the mesh. Factors of 1/2 and 2 allow for other machines.
pub fn time_band(method: &str, unknowns: u64) -> Option<TimeBandDocument> {
    let rows = rows().iter().filter(|row| row.method == method && row.unknowns > 0);
    let mut band: Option<TimeBandDocument> = None;
    for row in rows {
        let ratio = unknowns as f64 / row.unknowns as f64;
        let (low, high) =
            (0.5 * row.wall_s * ratio, 2.0 * row.wall_s * ratio.max(ratio.powf(4.0 / 3.0)));
        band = Some(match band {
            None => TimeBandDocument { low, high },
            Some(band) => TimeBandDocument { low: band.low.min(low), high: band.high.max(high) },
        });
    }
    band
}

/// The rows of a method, in the order of the table.
pub fn measured(method: &str) -> Vec<MeasuredDocument> {
    let rows = rows();
    let mut places: Vec<(&Row, Vec<&Row>)> = Vec::new();
    for row in rows.iter().filter(|row| row.method == method) {
        let same = |first: &Row| {
            (&first.scene, &first.label, first.level) == (&row.scene, &row.label, row.level)
        };
        match places.iter_mut().find(|(first, _)| same(first)) {
            Some((_, all)) => all.push(row),
            None => places.push((row, vec![row])),
        }
    }
    let document = |(first, all): (&Row, Vec<&Row>)| MeasuredDocument {
        scene: first.scene.clone(),
        label: first.label.clone(),
        level: first.level,
        unknowns: first.unknowns,
        wall_s: median(all.iter().map(|row| row.wall_s).collect()),
        p95_mm: median(all.iter().map(|row| row.p95_mm).collect()),
        rows: all.len() as u64,
    };
    places.into_iter().map(document).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or_default()
}

/// The rows with numbers, or the malformed line.
fn parse(table: &str) -> Result<Vec<Row>, String> {
    let mut lines = table.lines();
    let head = cells(lines.next().unwrap_or_default());
    let column = |name: &str| {
        head.iter().position(|cell| cell == name).ok_or_else(|| format!("no column {name}"))
    };
    let places = ["scene", "method", "label", "level", "unknowns", "wall_s", "p95_mm", "status"];
    let places = places.map(column);
    let mut at = [0; 8];
    for (at, place) in at.iter_mut().zip(places) {
        *at = place?;
    }
    let mut rows = Vec::new();
    for line in lines.filter(|line| !line.is_empty()) {
        let cells = cells(line);
        let text = |number: usize| {
            cells.get(at[number]).cloned().ok_or_else(|| format!("a cell is missing: {line}"))
        };
        if text(7)? != "solved" {
            continue;
        }
        let number =
            |place: usize| text(place)?.parse::<f64>().map_err(|error| format!("{error}: {line}"));
        rows.push(Row {
            scene: text(0)?,
            method: text(1)?,
            label: text(2)?,
            level: number(3)? as u32,
            unknowns: number(4)? as u64,
            wall_s: number(5)?,
            p95_mm: number(6)?,
        });
    }
    Ok(rows)
}

/// The cells of a line (RFC 4180); no cell of the table has a line break.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    let mut letters = line.trim_end_matches('\r').chars().peekable();
    while let Some(letter) = letters.next() {
        let cell = cells.last_mut().expect("there is always one");
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                cell.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            letter => cell.push(letter),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::methods::{MeasuredMethod, available_methods};

    #[test]
    fn every_measured_row_is_of_an_available_method_and_served_with_it() {
        let rows = parse(TABLE).unwrap();
        assert!(rows.iter().all(|row| row.wall_s > 0.0 && row.p95_mm >= 0.0));
        let methods = available_methods().methods;
        let known: Vec<&str> = methods.iter().map(|method| method.method.name.name()).collect();
        for row in &rows {
            assert!(known.contains(&row.method.as_str()), "{} is no method", row.method);
        }
        let served = methods.iter().flat_map(|method| &method.measured);
        assert_eq!(served.map(|place| place.rows).sum::<u64>(), rows.len() as u64);
    }

    #[test]
    fn a_method_without_measurements_is_served_and_says_so() {
        let mut methods = available_methods().methods;
        assert!(
            methods
                .iter()
                .all(|method| method.measured.is_empty() == method.not_measured.is_some())
        );
        let served =
            serde_json::to_value(MeasuredMethod::with(methods.remove(0).method, Vec::new()));
        let served = served.unwrap();
        assert_eq!(served["measured"], serde_json::json!([]));
        assert!(served["not_measured"].as_str().unwrap().contains("no row"), "{served}");
        assert_eq!(time_band("fem_ogden", 1000), None);
    }

    /// The times of docs/performance.md, which the table knows nothing of: half a million unknowns in 1.9 to 4.3 s.
    #[test]
    fn the_band_of_times_holds_a_mesh_a_hundred_times_larger_than_those_of_the_table() {
        let band = time_band("fem_linear", 504_483).unwrap();
        assert!(band.low < 1.9 && 4.3 < band.high, "{band:?}");
        assert!(band.low > 0.1 && band.high < 100.0, "{band:?}");
        assert_eq!(time_band("fem_ogden", 1000), None);
    }

    #[test]
    fn quoted_cells_and_broken_tables_are_read_as_what_they_are() {
        assert_eq!(cells("a,\"b, \"\"c\"\"\",,d\r"), ["a", "b, \"c\"", "", "d"]);
        assert!(parse("scene,label\n").is_err());
        let head = "scene,method,label,level,unknowns,wall_s,p95_mm,status";
        assert!(parse(&format!("{head}\na,b,c,x,1,1,1,solved")).is_err());
        assert_eq!(parse(&format!("{head}\na,b,c,0,,,,failed")), Ok(Vec::new()));
    }
}
