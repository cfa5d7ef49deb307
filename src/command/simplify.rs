//! `facies simplify`: a surface with fewer triangles, for viewers and meshers, and how far it is from the one that was given.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde_json::{Value, json};

use super::documents::{is_same, write};
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments, UnitArgument};
use crate::jobs::{JobError, MeshSource};
use mechanics::format::vtk::vtp;
use mechanics::format::{SurfaceOutput, WriteError, stl};
use mechanics::mesh::surface_edges::count_edges;
use mechanics::mesh::{Frame, SurfaceSearch, TriangleSurface, Vector};
use mechanics::progress::Unobserved;
use mechanics::simplification::{SimplificationSettings, simplify};
use mechanics::validation::comparison::{Comparison, ComparisonSettings, NodeWise, compare};

/// Bins of the histogram, as shares of the bound.
const BINS: usize = 10;

#[derive(Debug, Args)]
pub struct Arguments {
    /// The surface: STL, PLY, OBJ, VTP or any other that is read
    surface: PathBuf,
    /// The file of the simplified surface, STL or VTP by its ending, in mm
    #[arg(long, visible_alias = "output", value_name = "FILE")]
    out: PathBuf,
    /// How far apart the two surfaces may be at most
    #[arg(long, value_name = "MM", default_value_t = 0.3)]
    max_deviation_mm: f64,
    /// Ends at so many triangles; without it when no edge can go
    #[arg(long, value_name = "COUNT")]
    triangles: Option<usize>,
    /// Edges are no longer than tissue is thick: from the surface to this one, such as bone under skin
    #[arg(long, value_name = "FILE")]
    thickness_to: Option<PathBuf>,
    /// The longest edge, of the thickness
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, requires = "thickness_to")]
    edge_per_thickness: f64,
    /// Edges up to this length are allowed however thin the tissue is
    #[arg(long, value_name = "MM", default_value_t = 2.0, requires = "thickness_to")]
    least_edge_mm: f64,
    /// No new edge is longer than this
    #[arg(long, value_name = "MM", default_value_t = 20.0)]
    longest_edge_mm: f64,
    /// A file of what was found, as JSON
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// The unit of length of the surfaces
    #[arg(long, default_value = "mm")]
    units: UnitArgument,
    #[command(flatten)]
    scale: ScaleArguments,
}

/// Simplifies, measures, writes.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let Arguments { surface, out, max_deviation_mm, triangles, report, .. } = arguments;
    check(arguments)?;
    let (given, frame) = arguments.read(surface)?;
    let bone = arguments.thickness_to.as_ref().map(|path| arguments.read(path)).transpose()?;
    let bone = bone.map(|(bone, _)| SurfaceSearch::new(&bone).map_err(|error| refused(&error)));
    let bone = bone.transpose()?;
    let longest = |point: &Vector| arguments.longest(bone.as_ref(), point);
    let started = Instant::now();
    let settings = SimplificationSettings {
        deviation: *max_deviation_mm,
        triangles: *triangles,
        longest: &longest,
    };
    let simple = simplify(&given, &settings, &Unobserved).map_err(|error| refused(&error))?;
    let seconds = started.elapsed().as_secs_f64();
    let measured = measured(&simple, &given, *max_deviation_mm)?;
    let told = told([&given, &simple], &measured, (seconds, *max_deviation_mm));
    write(out, encoded(&simple, frame, out)?)?;
    if let Some(path) = report {
        write(path, format!("{told:#}\n"))?;
    }
    print(&told);
    println!("wrote      {}", out.display());
    Ok(())
}

fn refused(error: &dyn std::error::Error) -> CommandError {
    CommandError::Usage(error.to_string())
}

fn check(arguments: &Arguments) -> Result<(), CommandError> {
    for (name, value) in [
        ("--edge-per-thickness", arguments.edge_per_thickness),
        ("--least-edge-mm", arguments.least_edge_mm),
        ("--longest-edge-mm", arguments.longest_edge_mm),
    ] {
        if !(value > 0.0 && value <= 1000.0) {
            let detail = format!("{name} is {value}; more than 0 and at most 1000 are possible");
            return Err(CommandError::Usage(detail));
        }
    }
    ending(&arguments.out)?;
    refuse_inputs(arguments)
}

/// Refuses to write into what is read, and two files into one.
fn refuse_inputs(arguments: &Arguments) -> Result<(), CommandError> {
    let Arguments { surface, out, thickness_to, report, .. } = arguments;
    let read = std::iter::once(surface).chain(thickness_to);
    let written = || std::iter::once(out).chain(report);
    if let Some(file) = read.flat_map(|read| written().filter(move |own| is_same(read, own))).next()
    {
        let detail =
            format!("{} is read, and would be replaced: give another file", file.display());
        return Err(CommandError::Usage(detail));
    }
    match report {
        Some(report) if report == out || is_same(report, out) => Err(CommandError::Usage(format!(
            "--out and --report are both {}: give two files",
            out.display()
        ))),
        _ => Ok(()),
    }
}

/// The ending of a file that can be written.
fn ending(out: &Path) -> Result<&str, CommandError> {
    match out.extension().and_then(|ending| ending.to_str()) {
        Some(ending @ ("stl" | "vtp")) => Ok(ending),
        _ => {
            let detail = format!("{} ends neither in .stl nor in .vtp", out.display());
            Err(CommandError::Usage(detail))
        }
    }
}

impl Arguments {
    fn read(&self, path: &Path) -> Result<(TriangleSurface, Frame), CommandError> {
        let sources = FileSource::new(Path::new(""), self.units.unit(), self.scale);
        let stored = sources.mesh(&path.to_string_lossy()).map_err(JobError::Source)?;
        let surface = stored.surface_in_mm().ok_or_else(|| {
            CommandError::Usage(format!("{} is an image, and a surface is needed", path.display()))
        })?;
        Ok(((*surface).clone(), stored.frame.unwrap_or_default()))
    }

    /// The longest edge allowed at a place.
    fn longest(&self, bone: Option<&SurfaceSearch>, point: &Vector) -> f64 {
        let Some(bone) = bone else { return self.longest_edge_mm };
        let thickness = bone.closest(point).distance;
        (self.edge_per_thickness * thickness).max(self.least_edge_mm).min(self.longest_edge_mm)
    }
}

/// From the simplified surface to the given one and back.
fn measured(
    simple: &TriangleSurface,
    given: &TriangleSurface,
    deviation: f64,
) -> Result<Comparison, CommandError> {
    let edges = (1..=BINS).map(|bin| deviation * bin as f64 / BINS as f64);
    let settings = ComparisonSettings {
        report_unaligned: false,
        node_wise: NodeWise::Off,
        histogram_edges: edges.collect(),
        ..ComparisonSettings::default()
    };
    compare(simple, given, &settings, &Unobserved).map_err(|error| refused(&error))
}

fn told(
    [given, simple]: [&TriangleSurface; 2],
    measured: &Comparison,
    (seconds, deviation): (f64, f64),
) -> Value {
    let of = |surface: &TriangleSurface| {
        let edges = count_edges(&surface.sorted_sides());
        json!({
            "triangles": surface.triangles.len(),
            "points": surface.points.len(),
            "open_edges": edges.open,
            "nonmanifold_edges": edges.nonmanifold,
        })
    };
    let [there, back, both] = [
        &measured.distances.to_actual,
        &measured.distances.to_prediction,
        &measured.distances.both,
    ];
    let distances = |of: &mechanics::validation::distance::DistanceStatistics| json!({"mean": of.unsigned.mean, "p50": of.unsigned.median, "p95": of.unsigned.p95, "max": of.hausdorff});
    let histogram = measured.histograms.as_ref().map(|both| {
        let shares = std::iter::once(both.unsigned.below).chain(both.unsigned.shares.clone());
        json!({"edges_mm": (1..=BINS).map(|bin| deviation * bin as f64 / BINS as f64).collect::<Vec<f64>>(),
            "shares": shares.collect::<Vec<f64>>(), "above": both.unsigned.above})
    });
    json!({
        "given": of(given), "simplified": of(simple), "seconds": seconds, "max_deviation_mm": deviation,
        "to_given_mm": distances(there), "from_given_mm": distances(back), "both_mm": distances(both),
        "histogram": histogram,
    })
}

fn print(told: &Value) {
    let number = |place: &str| told.pointer(place).and_then(Value::as_f64).unwrap_or(f64::NAN);
    println!(
        "triangles  {} of {} in {:.1} s; {} open edges, {} before",
        number("/simplified/triangles"),
        number("/given/triangles"),
        number("/seconds"),
        number("/simplified/open_edges"),
        number("/given/open_edges"),
    );
    for (name, way) in [("to given", "to_given_mm"), ("from given", "from_given_mm")] {
        let at = |key: &str| number(&format!("/{way}/{key}"));
        println!(
            "{name:<10} {:.3} mm (median), {:.3} (95 %), {:.3} (largest)",
            at("p50"),
            at("p95"),
            at("max")
        );
    }
    for bin in 0..BINS {
        let share = 100.0 * number(&format!("/histogram/shares/{bin}"));
        let edge = number(&format!("/histogram/edges_mm/{bin}"));
        println!("up to      {edge:.3} mm {share:5.1} %");
    }
}

fn encoded(surface: &TriangleSurface, frame: Frame, out: &Path) -> Result<Vec<u8>, CommandError> {
    let output = SurfaceOutput::plain(surface, frame);
    let bytes: Result<Vec<u8>, WriteError> = match ending(out)? {
        "stl" => stl::write(&output),
        _ => vtp::write(&output),
    };
    bytes.map_err(|error| refused(&error))
}
