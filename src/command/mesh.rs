//! `facies mesh`: from a scan to a volume mesh with its node sets and the case that it is made for.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;

use super::documents::{CaseFile, read, read_spec_without, write};
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments};
use super::screen::{print_files, print_warnings, work_in_sight};
use super::watch::Watch;
use crate::jobs::{JobInput, JobOutput, MadeMesh, MeshingInput, StoredMesh, Workplace};
use crate::schema::case::document::LengthUnit;
use crate::schema::meshing::result::MeshingResultDocument;
use crate::schema::wire::canonical;
use crate::schema::{CaseDocument, Limits, MeshingDocument, PlanDocument, PredictDocument};
use mechanics::mesh::Frame;

const SCAN: &str = "What is meshed";
const RESULT: &str = "Result";

const NO_SCAN: &str = "give the scan that is to be meshed: --scan FILE";

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    scan: ScanArguments,
    /// A plan whose osteotomy cuts the bone; without one all bone is fixed
    #[arg(long, value_name = "FILE", help_heading = SCAN)]
    plan: Option<PathBuf>,
    /// The folder for the mesh, its picture and `case.json`
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = RESULT)]
    out: PathBuf,
}

/// A scan, and how it is meshed.
#[derive(Debug, Args)]
pub struct ScanArguments {
    /// A CT in Hounsfield units, to be meshed first
    #[arg(long, value_name = "FILE", help_heading = SCAN)]
    scan: Option<PathBuf>,
    /// A meshing document, as it is posted but for `scan` and `osteotomy`
    #[arg(long, value_name = "FILE", requires = "scan", help_heading = SCAN)]
    mesh_spec: Option<PathBuf>,
    /// About how many tetrahedra; default 300000
    #[arg(long, value_name = "COUNT", requires = "scan", help_heading = SCAN)]
    tetrahedra: Option<u64>,
}

/// A scan that was meshed: its case, and the meshes that this names, in memory.
pub struct Meshed {
    pub file: CaseFile,
    pub meshes: BTreeMap<String, StoredMesh>,
}

/// Meshes, writes the files, and tells what is in them.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let Meshed { file, .. } = arguments.scan.mesh(arguments.plan.as_deref(), &arguments.out)?;
    let path = arguments.out.join("case.json");
    write(&path, format!("{:#}\n", canonical::to_value(&file)))?;
    println!("wrote      {}", path.display());
    Ok(())
}

impl ScanArguments {
    pub fn is_given(&self) -> bool {
        self.scan.is_some()
    }

    /// Meshes the scan into a folder and tells what came out: the case with the plan without its cuts. Paths of meshes
    /// lead from the folder.
    pub fn mesh(&self, plan: Option<&Path>, out: &Path) -> Result<Meshed, CommandError> {
        let plan = plan.map(read::<PlanDocument>).transpose()?;
        let (spec, plan) = self.spec(plan)?;
        let limits = Limits::default();
        let sources = FileSource::new(Path::new(""), LengthUnit::Mm, ScaleArguments::default());
        let place = Workplace { sources: &sources, limits: &limits, out };
        let input = MeshingInput { job: None, queue_s: None, spec, case: None };
        let _watch = Watch::start(&input.spec.budget);
        let done = work_in_sight(&JobInput::Meshing(input), &place)?;
        let Some(result) = &done.result.meshing else {
            return Err(CommandError::Usage(NO_SCAN.to_owned()));
        };
        print_result(result, done.result.provenance.timing.total_s);
        print_warnings(&done.result.warnings);
        print_files(&done.files, out);
        let case = result.case.clone();
        let meshes = in_memory(&case, &done);
        Ok(Meshed { file: CaseFile { case, plan, spec: PredictDocument::default() }, meshes })
    }

    /// The document of the meshing, and the plan without its cuts.
    fn spec(
        &self,
        mut plan: Option<PlanDocument>,
    ) -> Result<(MeshingDocument, Option<PlanDocument>), CommandError> {
        let scan = self.scan.as_deref().ok_or_else(|| CommandError::Usage(NO_SCAN.to_owned()))?;
        let mut spec = match &self.mesh_spec {
            Some(path) => read_spec_without(path, "scan")?,
            None => MeshingDocument::default(),
        };
        spec.scan = scan.to_string_lossy().into_owned();
        if let Some(tetrahedra) = self.tetrahedra {
            spec.size.tetrahedra = Some(tetrahedra);
        }
        if let Some(plan) = &mut plan {
            spec.frame = plan.frame;
            spec.osteotomy = plan.osteotomy.take();
        }
        Ok((spec, plan))
    }
}

/// The meshes that a case names, as its files would be read.
fn in_memory(case: &CaseDocument, done: &JobOutput) -> BTreeMap<String, StoredMesh> {
    let stored = |made: &MadeMesh| {
        let bone = case.bones.iter().find(|bone| made.name.as_ref() == Some(&bone.name));
        let id = bone.map_or(&case.volume, |bone| &bone.mesh);
        let file = done.files.iter().find(|file| file.name == *id)?;
        let mesh = StoredMesh {
            shape: made.shape.clone(),
            frame: (made.frame != Frame::Unspecified).then_some(made.frame),
            units: Some(LengthUnit::Mm),
            warnings: Vec::new(),
            sha256: file.sha256.clone(),
        };
        Some((id.clone(), mesh))
    };
    done.meshes.iter().filter_map(stored).collect()
}

fn print_result(result: &MeshingResultDocument, total_s: f64) {
    let angles = &result.dihedral_angles_deg;
    println!(
        "mesh       {} tetrahedra, {} nodes, {:.1} ml in {total_s:.2} s; finest cubes {:.2} mm",
        result.tetrahedra, result.nodes, result.volume_ml, result.finest_mm
    );
    println!(
        "angles     smallest {:.1}, a thousandth below {:.1}, largest {:.1} degrees",
        angles.smallest, angles.thousandth, angles.largest
    );
    for segment in &result.segments {
        let [x, y, z] = segment.centre_mm.0;
        println!(
            "segment    {} {:.1} ml around ({x:.0}, {y:.0}, {z:.0}) mm; {:.1} ml on its sides hang apart",
            segment.name, segment.volume_ml, segment.left_ml
        );
    }
    for (name, nodes) in &result.node_sets {
        println!("node set   {name} {nodes} nodes");
    }
    if let Some(gap) = result.gaps_closed.first() {
        let [x, y, z] = gap.centre_mm.0;
        println!(
            "gaps       {} thinner than a cell are closed, the largest around ({x:.0}, {y:.0}, {z:.0}) mm",
            result.gaps_closed.len()
        );
    }
}
