//! The table that the demo ends with.

use serde_json::Value;

use mechanics::validation::statistics::Statistics;

/// Columns of a terminal.
const WIDTH: usize = 80;

/// The manifests of the two predictions and of their comparison.
pub struct Report<'a> {
    pub coarse: &'a Value,
    pub fine: &'a Value,
    pub comparison: &'a Value,
    /// Of the face that smiles.
    pub smile: &'a Value,
    /// In mm, at the nodes that both predictions have.
    pub node_wise: Vec<f64>,
    /// Of the three jobs, as the client waited for it.
    pub upload_s: [f64; 3],
}

/// Phases that take time, as provenance names them.
const PHASES: [(&str, &str); 8] = [
    ("validate", "validate_s"),
    ("mesh", "mesh_s"),
    ("assemble", "assemble_s"),
    ("solve", "solve_s"),
    ("estimate", "estimate_s"),
    ("surface", "surface_s"),
    ("compare", "compare_s"),
    ("write", "write_s"),
];

impl Report<'_> {
    /// Lines of at most 80 columns; lengths in mm, times in s.
    pub fn table(&self) -> String {
        let mut lines = Vec::new();
        self.displacement(&mut lines);
        self.smile(&mut lines);
        self.accuracy(&mut lines);
        self.effort(&mut lines);
        self.settings(&mut lines);
        lines.join("\n") + "\n"
    }

    fn displacement(&self, lines: &mut Vec<String>) {
        let row = |name: &str, stat: &Value| {
            let numbers = ["count", "mean", "median", "p95", "max"];
            let [count, mean, median, p95, max] = numbers.map(|number| &stat[number]);
            format!(
                "  {name:<28}{:>8}{}{}{}{}",
                count.as_u64().unwrap_or(0),
                length(mean),
                length(median),
                length(p95),
                length(max)
            )
        };
        let statistics = &self.coarse["statistics"];
        lines.push(
            "skin displacement, mm            nodes     mean   median      p95      max".into(),
        );
        lines.push(row("whole skin", &statistics["skin"]["nodes"]));
        for (name, region) in statistics["regions"].as_object().into_iter().flatten() {
            lines.push(row(name, &region["nodes"]));
        }
        lines.push("landmarks, mm                        left     back       up".into());
        let middle = ["pronasale", "subnasale", "labrale_superius", "labrale_inferius", "pogonion"];
        lines.extend(middle.map(|name| landmark(statistics, name)));
    }

    fn smile(&self, lines: &mut Vec<String>) {
        lines.push(String::new());
        lines.push("face that smiles, landmarks, mm      left     back       up".into());
        let mouth = ["cheilion_left", "cheilion_right", "labrale_superius", "pogonion"];
        lines.extend(mouth.map(|name| landmark(&self.smile["statistics"], name)));
    }

    fn accuracy(&self, lines: &mut Vec<String>) {
        lines.push(String::new());
        lines.push("against every edge halved, mm     mean   median      p95      max".into());
        let both = &self.comparison["comparison"]["both"];
        let numbers = ["mean", "median", "p95", "max"].map(|number| length(&both[number]));
        lines.push(format!("  {:<28}{}", "surfaces, both ways", numbers.concat()));
        if let Ok(s) = Statistics::plain(&self.node_wise) {
            let numbers = [s.mean, s.median, s.p95, s.max].map(|number| format!("{number:>9.3}"));
            lines.push(format!("  {:<28}{}", "same node", numbers.concat()));
        }
    }

    fn effort(&self, lines: &mut Vec<String>) {
        let manifests = [self.coarse, self.fine, self.comparison];
        let row = |name: &str, cell: &dyn Fn(&Value) -> String| {
            let cells = manifests.map(|manifest| format!("{:>14}", cell(&manifest["provenance"])));
            format!("  {name:<28}{}", cells.concat())
        };
        lines.push(String::new());
        let heads = ["half head", "edges halved", "comparison"].map(|head| format!("{head:>14}"));
        lines.push(format!("{:<30}{}", "effort", heads.concat()));
        lines.push(row("cells", &|p| count(&p["mesh"]["cells"])));
        lines.push(row("unknowns", &|p| count(&p["solver"]["unknowns"])));
        let uploads = self.upload_s.map(|time| format!("{time:>14.2}"));
        lines.push(format!("  {:<28}{}", "upload and check, s", uploads.concat()));
        for (phase, member) in PHASES {
            lines.push(row(&format!("{phase}, s"), &|p| seconds(&p["timing"][member])));
        }
        lines.push(row("job in all, s", &|p| seconds(&p["timing"]["total_s"])));
        lines.push(row("peak memory of process, MB", &|p| {
            p["peak_rss_mb"]
                .as_f64()
                .map_or_else(|| "-".into(), |megabytes| format!("{megabytes:.0}"))
        }));
    }

    fn settings(&self, lines: &mut Vec<String>) {
        lines.push(String::new());
        for (name, manifest) in [("half head", self.coarse), ("edges halved", self.fine)] {
            let provenance = &manifest["provenance"];
            let solver = &provenance["solver"];
            let word = |value: &Value| value.as_str().unwrap_or("-").to_owned();
            lines.push(format!(
                "{name}: {}, {}",
                word(&provenance["method"]),
                solver["elements"]
                    .as_array()
                    .into_iter()
                    .flatten()
                    .map(word)
                    .collect::<Vec<_>>()
                    .join(", "),
            ));
            lines.push(format!(
                "  solved by {} ({})",
                word(&solver["name"]),
                word(&solver["preconditioner"]),
            ));
            let power =
                |value: &Value| value.as_f64().map_or_else(|| "-".into(), |v| format!("{v:.1e}"));
            lines.push(format!(
                "  relative residual {} ({} asked for), iterations {}, threads {}",
                power(&solver["relative_residual"]),
                power(&solver["wanted_residual"]),
                count(&solver["iterations"]),
                count(&provenance["threads"]),
            ));
            for warning in manifest["warnings"].as_array().into_iter().flatten() {
                let (code, detail) = (word(&warning["code"]), word(&warning["detail"]));
                lines.extend(wrapped(format!("  warning {code}:"), &detail));
            }
        }
    }
}

/// A row: how far a landmark of the skin moves along each axis.
fn landmark(statistics: &Value, name: &str) -> String {
    let moved = &statistics["landmarks"][name];
    // Rounding noise has a sign, zero has none.
    let component = |axis: usize| match moved[axis].as_f64() {
        Some(value) if value.abs() < 5e-4 => format!("{:>9.3}", 0.0),
        Some(value) => format!("{value:>9.3}"),
        None => format!("{:>9}", "-"),
    };
    format!("  {name:<30}{}", [0, 1, 2].map(component).concat())
}

/// A beginning and a sentence after it, in lines that fit a terminal; the second and later ones are set in.
fn wrapped(beginning: String, sentence: &str) -> Vec<String> {
    let mut lines = vec![beginning];
    for word in sentence.split(' ') {
        let last = lines.len() - 1;
        match lines[last].chars().count() + 1 + word.chars().count() <= WIDTH {
            true => lines[last] += &format!(" {word}"),
            false => lines.push(format!("    {word}")),
        }
    }
    lines
}

fn length(value: &Value) -> String {
    value.as_f64().map_or_else(|| format!("{:>9}", "-"), |length| format!("{length:>9.3}"))
}

fn seconds(value: &Value) -> String {
    value.as_f64().map_or_else(|| "-".into(), |seconds| format!("{seconds:.2}"))
}

fn count(value: &Value) -> String {
    value.as_u64().map_or_else(|| "-".into(), |count| count.to_string())
}
