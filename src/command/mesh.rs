//! `facies mesh`: from a scan, a label map or surfaces to a volume mesh with its node sets and the case that it is made for.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::claim::Claim;
use super::documents::{CASE_FILE, CaseFile, document, read};
use super::failure::CommandError;
use super::files::{FileSource, FrameArgument, ScaleArguments, UnitArgument};
use super::screen::{print_files, print_warnings, run_with_progress};
use super::selection::{BoneArgument, bone};
use super::watch::Watch;
use crate::jobs::JobError;
use crate::jobs::{JobContext, JobInput, JobOutput, MadeMesh, MeshingInput, StoredMesh};
use crate::schema::case::document::LengthUnit;
use crate::schema::meshing::labels::LabelsDocument;
use crate::schema::meshing::result::{FoundSegmentDocument, MeshingResultDocument};
use crate::schema::meshing::surfaces::SurfacesDocument;
use crate::schema::predict::result::FileDocument;
use crate::schema::wire::canonical;
use crate::schema::{
    CaseDocument, ErrorCode, Faults, Limits, MeshingDocument, PlanDocument, Pointer,
    PredictDocument, WarningDocument,
};
use mechanics::mesh::Frame;

const SCAN: &str = "What is meshed";
const RESULT: &str = "Result";

const NO_SCAN: &str =
    "give what is to be meshed: --scan FILE, --labels FILE, or --skin FILE and --bone FILE";
const NO_CLASSES: &str =
    "--labels needs what its labels are: `labels.classes` in the file of --mesh-spec";
const NO_LABELS: &str = "`labels` of --mesh-spec says what the labels of a label map are: give its file as --labels FILE";
const NO_SKIN_SCAN: &str = "`skin_scan` of --mesh-spec says how a surface scan goes onto the CT: give its file as --skin-scan FILE";
const NO_SKIN: &str = "--bone needs the skin around it: --skin FILE";
const SKIN_OF_SCAN: &str = "--skin has no meaning with --scan or --labels: the skin is found in the scan, and is the node set `skin` of the \
                            mesh; with --bone it is the file of the skin";
const UNITS_OF_SCAN: &str =
    "--units has no meaning with --scan or --labels: an image says its own spacing, in mm";
const TWO_KINDS_OF_BONE: &str =
    "give --bone once as a FILE of all bone, or every time as NAME=FILE for a segment";

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    scan: ScanArguments,
    /// The surface of the skin, around --bone
    #[arg(long, value_name = "FILE", requires = "bone", help_heading = SCAN)]
    skin: Option<String>,
    /// The unit of length of the surfaces; default mm
    #[arg(long, help_heading = SCAN)]
    units: Option<UnitArgument>,
    /// The frame of an image that states none, as NRRD with the space 3D-right-handed; default unspecified
    #[arg(long, requires = "image", help_heading = SCAN)]
    frame: Option<FrameArgument>,
    /// A plan whose osteotomy cuts the bone; without one all bone is fixed
    #[arg(long, value_name = "FILE", help_heading = SCAN)]
    plan: Option<PathBuf>,
    /// The folder for the mesh, its picture and `case.json`
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = RESULT)]
    out: PathBuf,
    #[command(flatten)]
    scale: ScaleArguments,
}

/// What is said beside a scan or the bone of surfaces.
pub struct ScanContext<'a> {
    pub skin: Option<&'a str>,
    /// Its osteotomy cuts the bone.
    pub plan: Option<&'a Path>,
    /// Of surfaces.
    pub units: Option<UnitArgument>,
    /// Of an image that states none.
    pub frame: Option<FrameArgument>,
    pub scale: ScaleArguments,
}

/// A scan or the bone of surfaces, and how they are meshed.
#[derive(Debug, Args)]
pub struct ScanArguments {
    /// A CT in Hounsfield units, to be meshed first
    #[arg(long, value_name = "FILE", groups = ["meshed", "image"], help_heading = SCAN)]
    scan: Option<PathBuf>,
    /// With --scan: a surface scan of the face, which is the skin where it covers that of the CT; landmarks that both have go into
    /// `skin_scan.landmarks` of --mesh-spec
    #[arg(long, value_name = "FILE", requires = "scan", help_heading = SCAN)]
    skin_scan: Option<PathBuf>,
    /// A label map, to be meshed first; `labels.classes` of --mesh-spec says what its labels are
    #[arg(long, value_name = "FILE", conflicts_with = "scan", requires = "mesh_spec", groups = ["meshed", "image"], help_heading = SCAN)]
    labels: Option<PathBuf>,
    /// The surface of all bone, to be meshed first with the skin around it; NAME=FILE, which may be given several
    /// times, for bones that are segments already
    #[arg(long, value_name = "FILE|NAME=FILE", conflicts_with_all = ["scan", "labels"], group = "meshed", help_heading = SCAN)]
    bone: Vec<String>,
    /// The JSON body of the REST job, without the files that other options give (`scan`, `surfaces`, `labels.image`,
    /// `skin_scan.mesh`); `frame` and `osteotomy` may stand there or in --plan
    #[arg(long, value_name = "FILE", requires = "meshed", help_heading = SCAN)]
    mesh_spec: Option<PathBuf>,
    /// About how many tetrahedra; default 300000
    #[arg(long, value_name = "COUNT", requires = "meshed", help_heading = SCAN)]
    tetrahedra: Option<u64>,
}

/// A scan that was meshed: its case, and the meshes that this names, in memory.
pub struct Meshed {
    pub file: CaseFile,
    pub meshes: BTreeMap<String, StoredMesh>,
    /// What there is to say of the scan and the mesh, which every job on the mesh says too.
    pub warnings: Vec<WarningDocument>,
    found: MeshingResultDocument,
    total_s: f64,
    files: Vec<FileDocument>,
}

impl Meshed {
    /// Tells what came out; `out` is where it lies.
    pub fn print(&self, out: &Path) {
        print_result(&self.found, self.total_s);
        print_files(&self.files, out);
    }
}

/// Meshes, writes the files, and tells what is in them.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let Arguments { scan, skin, units, frame, plan, out, scale } = arguments;
    let (skin, plan) = (skin.as_deref(), plan.as_deref());
    let (units, frame, scale) = (*units, *frame, *scale);
    let claim = Claim::of(out, &[CASE_FILE])?;
    let meshed = scan.mesh(&ScanContext { skin, plan, units, frame, scale }, out)?;
    claim.put(CASE_FILE, format!("{:#}\n", canonical::to_value(&meshed.file)))?;
    meshed.print(out);
    print_warnings(&meshed.warnings);
    println!("wrote      {}", out.join(CASE_FILE).display());
    Ok(())
}

impl ScanArguments {
    pub fn is_given(&self) -> bool {
        self.is_image() || !self.bone.is_empty()
    }

    /// A scan or a label map.
    pub fn is_image(&self) -> bool {
        self.scan.is_some() || self.labels.is_some()
    }

    /// Meshes the scan, or what lies between skin and bone, into a folder: the case with the plan without its cuts. Paths of meshes
    /// lead from the folder.
    pub fn mesh(&self, beside: &ScanContext, out: &Path) -> Result<Meshed, CommandError> {
        self.refuse_beside_image(beside)?;
        let plan = beside.plan.map(read::<PlanDocument>).transpose()?;
        let (spec, plan) = self.spec(beside.skin, plan)?;
        let limits = Limits::default();
        let units = beside.units.unwrap_or_default().unit();
        let sources = FileSource::new(Path::new(""), units, beside.scale).beside(&[CASE_FILE]);
        let sources = sources.in_frame(beside.frame.map(FrameArgument::frame));
        let place = JobContext { sources: &sources, limits: &limits, out };
        let input = MeshingInput { job: None, queue_s: None, spec, case: None };
        let _watch = Watch::start(&input.spec.budget);
        let done = run_with_progress(&JobInput::Meshing(input), &place)?;
        let Some(found) = done.result.meshing.clone() else {
            return Err(CommandError::Usage(NO_SCAN.to_owned()));
        };
        let case = found.case.clone();
        let meshes = in_memory(&case, &done);
        let file = CaseFile { case, plan, spec: PredictDocument::default() };
        let JobOutput { result, files, .. } = done;
        let total_s = result.provenance.timing.total_s;
        Ok(Meshed { file, meshes, warnings: result.warnings, found, total_s, files })
    }

    /// Refuses what says of surfaces what an image says itself.
    fn refuse_beside_image(&self, beside: &ScanContext) -> Result<(), CommandError> {
        let why = match (beside.skin.is_some(), beside.units.is_some()) {
            _ if !self.is_image() => return Ok(()),
            (true, _) => SKIN_OF_SCAN,
            // The unit is that of the surface scan.
            (false, true) if self.skin_scan.is_some() => return Ok(()),
            (false, true) => UNITS_OF_SCAN,
            (false, false) => return Ok(()),
        };
        Err(CommandError::Usage(why.to_owned()))
    }

    /// The file of --mesh-spec, whose `skin_scan` and `labels` need not name the files that other options give.
    fn read_spec(&self, path: &Path) -> Result<MeshingDocument, CommandError> {
        let mut value = read::<Value>(path)?;
        for (whole, member) in [("skin_scan", "mesh"), ("labels", "image")] {
            if let Some(whole) = value.get_mut(whole).and_then(Value::as_object_mut) {
                whole.entry(member).or_insert_with(|| "".into());
            }
        }
        document(value, path)
    }

    /// The document of the meshing, and the plan without its cuts.
    fn spec(
        &self,
        skin: Option<&str>,
        mut plan: Option<PlanDocument>,
    ) -> Result<(MeshingDocument, Option<PlanDocument>), CommandError> {
        let mut spec = match &self.mesh_spec {
            Some(path) => self.read_spec(path)?,
            None => MeshingDocument::default(),
        };
        spec.scan = self.scan.as_ref().map(|scan| scan.to_string_lossy().into_owned());
        match (&self.skin_scan, &mut spec.skin_scan) {
            (Some(file), skin) => {
                let file = file.to_string_lossy().into_owned();
                skin.get_or_insert_default().mesh = file;
            }
            (None, Some(_)) => return Err(CommandError::Usage(NO_SKIN_SCAN.to_owned())),
            (None, None) => {}
        }
        match (&self.labels, &mut spec.labels) {
            (Some(file), Some(labels)) => labels.image = file.to_string_lossy().into_owned(),
            (Some(_), None) => return Err(CommandError::Usage(NO_CLASSES.to_owned())),
            (None, Some(_)) => return Err(CommandError::Usage(NO_LABELS.to_owned())),
            (None, None) => {}
        }
        if !self.bone.is_empty() {
            spec.surfaces = Some(surfaces(skin, &self.bone)?);
        }
        if let Some(tetrahedra) = self.tetrahedra {
            spec.size.tetrahedra = Some(tetrahedra);
        }
        if let Some(plan) = &mut plan {
            spec.frame = stated_once("frame", plan.frame, spec.frame)?;
            plan.frame = spec.frame;
            spec.osteotomy = stated_once("osteotomy", plan.osteotomy.take(), spec.osteotomy)?;
        }
        if let Some(plan) = &plan {
            check_segments(plan, &spec)?;
        }
        Ok((spec, plan))
    }
}

/// A member of the plan or of the file of --mesh-spec, or of both if they agree.
fn stated_once<T: PartialEq>(
    member: &str,
    plan: Option<T>,
    spec: Option<T>,
) -> Result<Option<T>, CommandError> {
    match (plan, spec) {
        (Some(plan), Some(spec)) if plan != spec => Err(CommandError::Usage(format!(
            "`{member}` of --mesh-spec differs from that of --plan: state it in one of them"
        ))),
        (plan, spec) => Ok(plan.or(spec)),
    }
}

/// A plan that moves what the meshing will not find is refused before anything is meshed.
fn check_segments(plan: &PlanDocument, spec: &MeshingDocument) -> Result<(), CommandError> {
    let cut = spec.osteotomy.iter().flat_map(|osteotomy| &osteotomy.segments);
    let given = spec.surfaces.iter().flat_map(|surfaces| &surfaces.bones);
    let labelled = spec.labels.iter().flat_map(LabelsDocument::segments);
    let named = cut.map(|segment| segment.name.trim()).chain(given.map(|bone| bone.name.trim()));
    let known: Vec<&str> = named.chain(labelled).collect();
    let at = Pointer::root().key("plan").key("segments");
    let mut faults = Faults::default();
    for (number, segment) in plan.segments.iter().enumerate() {
        if !known.contains(&segment.name.trim()) {
            let there = match known.is_empty() {
                true => "no segments, because the plan has no `osteotomy` that cuts them and no bones are given".to_owned(),
                false => known.join(", "),
            };
            let detail = format!("there is no segment {:?}; there are: {there}", segment.name);
            faults.add(&at.index(number).key("name"), ErrorCode::UnknownSegment, detail);
        }
    }
    Ok(faults.into_result().map_err(JobError::from)?)
}

fn surfaces(skin: Option<&str>, bones: &[String]) -> Result<SurfacesDocument, CommandError> {
    let usage = |detail: &str| CommandError::Usage(detail.to_owned());
    let skin = skin.ok_or_else(|| usage(NO_SKIN))?.to_owned();
    let mut surfaces = SurfacesDocument { skin, ..SurfacesDocument::default() };
    for text in bones {
        match bone(text) {
            BoneArgument::Segment(bone) => surfaces.bones.push(bone),
            BoneArgument::All(file) if surfaces.bone.is_none() => surfaces.bone = Some(file),
            BoneArgument::All(_) => return Err(usage(TWO_KINDS_OF_BONE)),
        }
    }
    match surfaces.bone.is_some() && !surfaces.bones.is_empty() {
        true => Err(usage(TWO_KINDS_OF_BONE)),
        false => Ok(surfaces),
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
            of_points: Default::default(),
            frame: (made.frame != Frame::Unspecified).then_some(made.frame),
            units: Some(LengthUnit::Mm),
            warnings: Vec::new(),
            told: made.told.clone(),
            sha256: file.sha256.clone(),
            identity: file.sha256.clone(),
        };
        Some((id.clone(), mesh))
    };
    done.meshes.iter().filter_map(stored).collect()
}

/// Bone on the sides of a segment's cuts that is not connected with it; nothing where there is none, as without cuts.
fn hangs_apart(segment: &FoundSegmentDocument) -> String {
    let left = segment.left_ml;
    if left < 0.05 {
        String::new()
    } else {
        format!("; {left:.1} ml of bone on its side of the cuts is not connected to it")
    }
}

fn print_result(result: &MeshingResultDocument, total_s: f64) {
    let angles = &result.dihedral_angles_deg;
    println!(
        "mesh       {} tetrahedra, {} nodes, {:.1} ml in {total_s:.2} s; finest cubes {:.2} mm",
        result.tetrahedra, result.nodes, result.volume_ml, result.finest_mm
    );
    println!(
        "angles     dihedral: smallest {:.1}, 0.1 % below {:.1}, largest {:.1} degrees",
        angles.smallest, angles.thousandth, angles.largest
    );
    for segment in &result.segments {
        let [x, y, z] = segment.centre_mm.0;
        println!(
            "segment    {} {:.1} ml around ({x:.0}, {y:.0}, {z:.0}) mm{}",
            segment.name,
            segment.volume_ml,
            hangs_apart(segment)
        );
    }
    for cut in &result.cuts {
        let (paths, area) = (cut.paths_mm.len(), cut.area_mm2);
        println!("cut        {} of {}: {area:.0} mm2 of bone, {paths} paths", cut.cut, cut.segment);
        for clearance in &cut.clearances {
            println!("           {:.2} mm from {}", clearance.distance_mm, clearance.risk);
        }
    }
    if let Some(skin) = &result.skin_scan {
        println!(
            "skin scan  {:.2} mm (mean), {:.2} (95 %) from the skin of the CT, {:.1} % beyond 3 mm, over {:.0} of its {:.0} cm2",
            skin.mean_mm,
            skin.p95_mm,
            100.0 * skin.share_above_3_mm,
            skin.compared_cm2,
            skin.area_cm2
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
