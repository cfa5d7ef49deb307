//! `facies compare`: distances between a predicted and an actual surface.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments, UnitArgument};
use super::screen::{print_files, print_warnings, work_in_sight};
use crate::jobs::{CompareInput, JobInput, Workplace};
use crate::schema::compare::document::{
    AlignDocument, AlignMethod, CompareDocument, CompareKind, MeshReference, NodeWise,
    PlaceDocument, SurfaceReference,
};
use crate::schema::predict::result::ResultDocument;
use crate::schema::{CornerPair, Limits, Sphere};

/// Groups of the arguments in the help.
const WHAT: &str = "What is compared";
const ALIGNED: &str = "Whether it is aligned";
const MEASURED: &str = "How it is measured";

#[derive(Debug, Args)]
pub struct Arguments {
    /// The predicted surface, or a volume mesh whose boundary it is
    #[arg(long, help_heading = WHAT, value_name = "FILE")]
    prediction: PathBuf,
    /// The actual surface
    #[arg(long, help_heading = WHAT, value_name = "FILE")]
    actual: PathBuf,
    /// The folder for the result
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
    /// Whether the actual surface is moved rigidly onto the prediction first
    #[arg(long, help_heading = ALIGNED, default_value = "none")]
    align: AlignArgument,
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
    Icp,
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
    let place = Workplace { sources: &sources, limits: &limits, out: &arguments.out };
    let done = work_in_sight(&input, &place)?;
    print_result(&done.result);
    print_files(&done.files, &arguments.out);
    Ok(())
}

impl Arguments {
    fn document(&self) -> Result<CompareDocument, CommandError> {
        let text = |path: &PathBuf| path.to_string_lossy().into_owned();
        Ok(CompareDocument {
            kind: CompareKind::Compare,
            prediction: SurfaceReference { job: None, mesh: Some(text(&self.prediction)) },
            actual: MeshReference { mesh: text(&self.actual) },
            align: AlignDocument {
                method: match self.align {
                    AlignArgument::None => AlignMethod::None,
                    AlignArgument::Icp => AlignMethod::Icp,
                },
                landmarks: Default::default(),
                mask: self.mask()?,
                report_unaligned: true,
            },
            regions: Default::default(),
            samples_per_mm2: self.samples_per_mm2,
            node_wise: match self.node_wise {
                NodeWiseArgument::Auto => NodeWise::Auto,
                NodeWiseArgument::On => NodeWise::On,
                NodeWiseArgument::Off => NodeWise::Off,
            },
            tags: Vec::new(),
        })
    }

    fn mask(&self) -> Result<Option<PlaceDocument>, CommandError> {
        let sphere = numbers(&self.mask_sphere_mm, "--mask-sphere-mm")?.map(Sphere);
        let corners = numbers(&self.mask_box_mm, "--mask-box-mm")?.map(CornerPair);
        let given = sphere.is_some() || corners.is_some();
        Ok(given.then_some(PlaceDocument { sphere_mm: sphere, box_mm: corners }))
    }
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
            100.0 * row.share_below_1_mm
        );
    }
    if let Some(node_wise) = &comparison.node_wise {
        let nodes = &node_wise.nodes;
        println!(
            "node by node   {:>7.3} {:>6.3} {:>6.3} {:>7.3} {:>6.3} {:>6.3}",
            nodes.mean, nodes.sd, nodes.rms, nodes.median, nodes.p95, nodes.max
        );
    }
    print_warnings(&result.warnings);
}
