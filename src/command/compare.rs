//! `facies compare`: distances between a predicted and an actual surface.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::claim::Claim;
use super::documents::read;
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments, UnitArgument, relative};
use super::screen::{print_files, print_warnings, run_with_progress};
use crate::jobs::{CompareInput, JobContext, JobInput};
use crate::schema::compare::document::{
    AlignDocument, AlignMethod, CompareDocument, CompareKind, MeshReference, NodeWise,
    PlaceDocument, SurfaceReference,
};
use crate::schema::predict::result::ResultDocument;
use crate::schema::wire::strict;
use crate::schema::{CornerPair, Limits, Matrix4x4, Sphere};

/// Groups of the arguments in the help.
const WHAT: &str = "What is compared";
const ALIGNED: &str = "Whether it is aligned";
const MEASURED: &str = "How it is measured";

#[derive(Debug, Args)]
pub struct Arguments {
    /// The predicted surface, or a volume mesh whose boundary it is
    #[arg(long, help_heading = WHAT, value_name = "FILE", required_unless_present = "spec")]
    prediction: Option<PathBuf>,
    /// The actual surface
    #[arg(long, help_heading = WHAT, value_name = "FILE", required_unless_present = "spec")]
    actual: Option<PathBuf>,
    /// The JSON body of the REST job, with paths relative to its folder in place of ids: regions, landmarks, histograms and
    /// all ways of aligning. `--prediction` and `--actual` override its own
    #[arg(
        long, help_heading = WHAT, value_name = "FILE",
        conflicts_with_all = ["align", "mask_sphere_mm", "mask_box_mm", "align_fixed", "align_moving", "matrix4x4", "samples_per_mm2", "node_wise", "range_mm"]
    )]
    spec: Option<PathBuf>,
    /// The folder for the result
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
    /// Also skin.ply and skin.glb in colours of the signed distance, which end at minus and plus so many mm
    #[arg(long, value_name = "MM", help_heading = "Result")]
    range_mm: Option<f64>,
    /// Whether the actual surface is moved rigidly onto the prediction first
    #[arg(long, help_heading = ALIGNED, default_value = "none")]
    align: AlignArgument,
    /// With `surfaces`: bone that lies as the prediction does
    #[arg(long, help_heading = ALIGNED, value_name = "FILE")]
    align_fixed: Option<PathBuf>,
    /// With `surfaces`: the same bone as it lies beside the actual surface
    #[arg(long, help_heading = ALIGNED, value_name = "FILE")]
    align_moving: Option<PathBuf>,
    /// With `matrix`: the movement of the actual surface, row by row in mm; 16 numbers with commas, or with spaces in quotes
    #[arg(
        long, help_heading = ALIGNED,
        value_name = "M11,M12,..,M44",
        value_parser = row,
        allow_hyphen_values = true
    )]
    matrix4x4: Option<Row>,
    /// Only this sphere decides the alignment: x,y,z,r
    #[arg(
        long, help_heading = ALIGNED,
        value_name = "X,Y,Z,R",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true
    )]
    mask_sphere_mm: Vec<f64>,
    /// Only this box decides the alignment: x0,y0,z0,x1,y1,z1
    #[arg(
        long, help_heading = ALIGNED,
        value_name = "X0,..,Z1",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true,
        conflicts_with = "mask_sphere_mm"
    )]
    mask_box_mm: Vec<f64>,
    /// Points for each mm2 of surface
    #[arg(long, help_heading = MEASURED, default_value_t = 1.0)]
    samples_per_mm2: f64,
    /// Whether points of the same number are compared
    #[arg(long, help_heading = MEASURED, default_value = "auto")]
    node_wise: NodeWiseArgument,
    /// The unit of length of both meshes
    #[arg(long, help_heading = WHAT, default_value = "mm")]
    units: UnitArgument,
    #[command(flatten)]
    scale: ScaleArguments,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AlignArgument {
    None,
    Matrix,
    Icp,
    Surfaces,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum NodeWiseArgument {
    Auto,
    On,
    Off,
}

/// Compares, writes the result and prints a table.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let limits = Limits::default();
    let sources = FileSource::new(&PathBuf::new(), arguments.units.unit(), arguments.scale);
    let spec = arguments.document()?;
    let input = JobInput::Compare(CompareInput { job: None, queue_s: None, spec });
    let place = JobContext { sources: &sources, limits: &limits, out: &arguments.out };
    let _claim = Claim::of(&arguments.out, &[])?;
    let done = run_with_progress(&input, &place)?;
    print_result(&done.result);
    print_files(&done.files, &arguments.out);
    Ok(())
}

impl Arguments {
    fn document(&self) -> Result<CompareDocument, CommandError> {
        match &self.spec {
            Some(path) => self.document_in(path),
            None => self.document_of_arguments(),
        }
    }

    /// The document in a file, whose paths lead from its folder.
    fn document_in(&self, path: &Path) -> Result<CompareDocument, CommandError> {
        let mut value: Value = read(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let given = [("prediction", &self.prediction), ("actual", &self.actual)];
        for (name, file) in given {
            let (Some(members), Some(file)) = (value.as_object_mut(), file) else { continue };
            members.insert(name.to_owned(), json!({ "mesh": relative(file, folder) }));
        }
        let refused = |problem| CommandError::Document { path: path.to_owned(), problem };
        let mut spec: CompareDocument = strict::from_value(value).map_err(refused)?;
        for (_, id) in spec.mesh_references_mut() {
            *id = folder.join(&*id).to_string_lossy().into_owned();
        }
        Ok(spec)
    }

    fn document_of_arguments(&self) -> Result<CompareDocument, CommandError> {
        let text = |path: &PathBuf| path.to_string_lossy().into_owned();
        let mesh =
            |path: &Option<PathBuf>| path.as_ref().map(|path| MeshReference { mesh: text(path) });
        Ok(CompareDocument {
            kind: CompareKind::Compare,
            prediction: SurfaceReference { job: None, mesh: self.prediction.as_ref().map(text) },
            actual: MeshReference { mesh: self.actual.as_ref().map(text).unwrap_or_default() },
            align: AlignDocument {
                method: match self.align {
                    AlignArgument::None => AlignMethod::None,
                    AlignArgument::Matrix => AlignMethod::Matrix,
                    AlignArgument::Icp => AlignMethod::Icp,
                    AlignArgument::Surfaces => AlignMethod::Surfaces,
                },
                matrix4x4: self.matrix()?,
                landmarks: Default::default(),
                fixed: mesh(&self.align_fixed),
                moving: mesh(&self.align_moving),
                start: None,
                mask: self.mask()?,
                report_unaligned: true,
            },
            regions: Default::default(),
            landmarks: Default::default(),
            histogram_edges_mm: Vec::new(),
            acquisition: None,
            range_mm: self.range_mm,
            samples_per_mm2: self.samples_per_mm2,
            node_wise: match self.node_wise {
                NodeWiseArgument::Auto => NodeWise::Auto,
                NodeWiseArgument::On => NodeWise::On,
                NodeWiseArgument::Off => NodeWise::Off,
            },
            tags: Vec::new(),
        })
    }

    fn matrix(&self) -> Result<Option<Matrix4x4>, CommandError> {
        let given = self.matrix4x4.as_ref().map_or(&[][..], |Row(numbers)| numbers);
        Ok(numbers(given, "--matrix4x4")?.map(Matrix4x4))
    }

    fn mask(&self) -> Result<Option<PlaceDocument>, CommandError> {
        let sphere = numbers(&self.mask_sphere_mm, "--mask-sphere-mm")?.map(Sphere);
        let corners = numbers(&self.mask_box_mm, "--mask-box-mm")?.map(CornerPair);
        let given = sphere.is_some() || corners.is_some();
        Ok(given.then_some(PlaceDocument { sphere_mm: sphere, box_mm: corners }))
    }
}

/// Numbers in one argument.
#[derive(Clone, Debug)]
struct Row(Vec<f64>);

/// Numbers parted by commas, spaces or both.
fn row(text: &str) -> Result<Row, String> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let number = |word: &str| word.parse().map_err(|_| format!("{word:?} is no number"));
    words.map(number).collect::<Result<_, _>>().map(Row)
}

/// Exactly as many numbers as wanted, or none at all.
fn numbers<const N: usize>(given: &[f64], name: &str) -> Result<Option<[f64; N]>, CommandError> {
    if given.is_empty() {
        return Ok(None);
    }
    let row = <[f64; N]>::try_from(given).map_err(|_| {
        CommandError::Usage(format!("{name} takes {N} numbers, here are {}", given.len()))
    })?;
    Ok(Some(row))
}

fn print_result(result: &ResultDocument) {
    let Some(comparison) = &result.comparison else {
        return;
    };
    println!("distance in mm    mean     sd    rms  median    p95    max  below 1 mm");
    let rows = [
        ("to actual", &comparison.to_actual),
        ("to prediction", &comparison.to_prediction),
        ("both", &comparison.both),
    ];
    for (name, row) in rows {
        println!(
            "{name:<14} {:>7.3} {:>6.3} {:>6.3} {:>7.3} {:>6.3} {:>6.3}  {:>6.1} %",
            row.mean,
            row.sd,
            row.rms,
            row.median,
            row.p95,
            row.max,
            // No minus before nothing.
            100.0 * row.share_below_1_mm.max(0.0) + 0.0
        );
    }
    if let Some(node_wise) = &comparison.node_wise {
        let nodes = &node_wise.nodes;
        println!(
            "node by node   {:>7.3} {:>6.3} {:>6.3} {:>7.3} {:>6.3} {:>6.3}",
            nodes.mean, nodes.sd, nodes.rms, nodes.median, nodes.p95, nodes.max
        );
    }
    if let Some(warped) = &comparison.tps_cp {
        let nodes = &warped.nodes;
        println!(
            "spline, point  {:>7.3} {:>6.3} {:>6.3} {:>7.3} {:>6.3} {:>6.3}",
            nodes.mean, nodes.sd, nodes.rms, nodes.median, nodes.p95, nodes.max
        );
    }
    for (name, region) in &comparison.regions {
        let both = &region.both;
        println!(
            "{name:<14} {:>7.3} {:>6.3} {:>6.3} {:>7.3} {:>6.3} {:>6.3}  {:>6.1} %",
            both.mean,
            both.sd,
            both.rms,
            both.median,
            both.p95,
            both.max,
            100.0 * both.share_below_1_mm
        );
    }
    for (name, error) in &comparison.landmark_errors {
        println!("landmark {name:<20} {:>7.3} mm", error.distance_mm);
    }
    if let Some(share) = comparison.alignment.share_above_1_mm {
        let rms = comparison.alignment.rms_mm.unwrap_or_default();
        println!("aligned to {rms:.3} mm rms, {:.1} % of it above 1 mm", 100.0 * share);
    }
    print_warnings(&result.warnings);
}

#[cfg(test)]
mod tests {
    use super::row;

    #[test]
    fn numbers_of_a_row_are_parted_by_commas_or_spaces() {
        for text in ["1,-0.5,2e-3", "1 -0.5 2e-3", " 1, -0.5,\t2e-3\n"] {
            assert_eq!(row(text).unwrap().0, [1.0, -0.5, 2e-3], "{text:?}");
        }
        assert_eq!(row("1,x").unwrap_err(), "\"x\" is no number");
    }
}
