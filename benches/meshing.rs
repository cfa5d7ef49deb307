//! The mesher alone: cells, time by stage, dihedral angles and memory, on the CT of the shared data and on surfaces.
//!
//! `cargo bench --bench meshing [-- NAME … --scan FILE --surfaces SKIN BONE --vtu FOLDER]` prints one row for each kind of
//! cells (`NAME`: uniform-4, uniform-2.8, graded-8, graded-16, target, graded-target; all without one), then the processor seconds of
//! each stage. `--surfaces` meshes what lies between two surfaces instead of the scan; `--vtu` writes each mesh with its boundaries as
//! node sets; `--parted` moves the copies of nodes apart, for programs that take no two nodes at one place.
//! `RAYON_NUM_THREADS` sets the threads. Without the data it says so and ends.

#[path = "measure/process.rs"]
#[allow(dead_code, reason = "each bench uses the parts it needs")]
mod process;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

use mechanics::domain::{Boundary, Domain, ImageDomain, ImageOptions, SurfaceDomain};
use mechanics::format::vtk::vtu;
use mechanics::format::{Mesh, ReadLimits, VolumeOutput, read};
use mechanics::mesh::{Frame, TriangleSurface};
use mechanics::meshing::{Angles, MeshingSettings, SizeField, TissueMesh, mesh};
use mechanics::progress::{Phase, Progress};
use process::{cpu_seconds, peak_mb, reset_peak};

const NAMES: [&str; 6] =
    ["uniform-4", "uniform-2.8", "graded-8", "graded-16", "target", "graded-target"];
/// In the order in which the mesher tells of them.
const STAGES: [&str; 8] =
    ["octree", "lattice", "cuts", "warp", "stencils", "pieces", "climbing", "check"];

const HEAD: &str = "| cells | tetrahedra | processor s | wall s | smallest, 0.1 %, 1 %, largest angle | \
    before nodes are moved | volume cm³ | peak MB |\n| --- | --- | --- | --- | --- | --- | --- | --- |";

struct Arguments {
    names: Vec<String>,
    scan: Option<PathBuf>,
    /// Skin and bone.
    surfaces: Option<[PathBuf; 2]>,
    vtu: Option<PathBuf>,
    parted: bool,
}

fn main() {
    let arguments = arguments();
    let begin = cpu_seconds();
    let Some(domain) = domain(&arguments) else { return };
    println!("domain: {:.2} processor s\n\n{HEAD}", cpu_seconds() - begin);
    let mut stages = Vec::new();
    for name in &arguments.names {
        stages.push((name, row(name, domain.as_ref(), &arguments)));
    }
    println!("\n| processor s of | {} |\n| {} |", STAGES.join(" | "), ["---"; 9].join(" | "));
    for (name, seconds) in stages {
        let seconds: Vec<String> = seconds.iter().map(|s| format!("{s:.2}")).collect();
        println!("| {name} | {} |", seconds.join(" | "));
    }
}

fn arguments() -> Arguments {
    let mut found =
        Arguments { names: Vec::new(), scan: None, surfaces: None, vtu: None, parted: false };
    let mut given = std::env::args().skip(1);
    let file = |given: &mut dyn Iterator<Item = String>| {
        PathBuf::from(given.next().expect("the argument needs a value"))
    };
    while let Some(argument) = given.next() {
        match argument.as_str() {
            "--bench" => {} // cargo says so to every bench
            "--scan" => found.scan = Some(file(&mut given)),
            "--surfaces" => found.surfaces = Some([file(&mut given), file(&mut given)]),
            "--vtu" => found.vtu = Some(file(&mut given)),
            "--parted" => found.parted = true,
            name => found.names.push(name.to_owned()),
        }
    }
    if found.names.is_empty() {
        found.names = NAMES.map(str::to_owned).to_vec();
    }
    found
}

fn settings(name: &str) -> MeshingSettings {
    let (size, target) = match name {
        "uniform-4" => (SizeField::uniform(4.0), None),
        "uniform-2.8" => (SizeField::uniform(2.8), None),
        "graded-8" => (SizeField::graded(2.0, 8.0), None),
        "graded-16" => (SizeField::graded(2.0, 16.0), None),
        "target" => (SizeField::uniform(1.0), Some(300_000)),
        // As a job has it that names no size.
        "graded-target" => (SizeField::graded(1.0, 4.0), Some(300_000)),
        other => panic!("no cells {other:?}: {}", NAMES.join(", ")),
    };
    MeshingSettings { size, target, ..MeshingSettings::default() }
}

fn domain(arguments: &Arguments) -> Option<Box<dyn Domain>> {
    if let Some([skin, bone]) = &arguments.surfaces {
        let [skin, bone] = [surface(skin), surface(bone)];
        let domain = SurfaceDomain::new(&skin, &[&bone], &[]).expect("surfaces that bound a body");
        return Some(Box::new(domain));
    }
    let shared = std::env::var_os("FACIES_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"),
        PathBuf::from,
    );
    let scan = arguments.scan.clone();
    let scan = scan.unwrap_or_else(|| shared.join("data/head_ct/headsq_quarter_hu.nrrd"));
    let Ok(bytes) = std::fs::read(&scan) else {
        println!("skipped: {} is not here", scan.display());
        return None;
    };
    let scan = read(&bytes, &ReadLimits::default()).expect("a scan");
    let Mesh::Image(image) = scan.mesh else { panic!("a scan is an image") };
    let domain = ImageDomain::new(&image, &ImageOptions::default()).expect("a head");
    Some(Box::new(domain))
}

fn surface(file: &Path) -> TriangleSurface {
    let bytes = std::fs::read(file).expect("a file that can be read");
    let Mesh::Surface(surface) = read(&bytes, &ReadLimits::default()).expect("a surface").mesh
    else {
        panic!("{} holds no surface", file.display())
    };
    surface
}

/// Prints the row of a mesh; returns the processor seconds of its stages.
fn row(name: &str, domain: &dyn Domain, arguments: &Arguments) -> Vec<f64> {
    let settings = MeshingSettings { part_copies: arguments.parted, ..settings(name) };
    reset_peak();
    let stages = Stages::default();
    let (begin, wall) = (cpu_seconds(), Instant::now());
    let tissue = mesh(domain, &settings, &stages).expect("a mesh");
    let (cpu, wall) = (cpu_seconds() - begin, wall.elapsed().as_secs_f64());
    let peak = peak_mb();
    let report = &tissue.report;
    println!(
        "| {name} | {} | {cpu:.2} | {wall:.2} | {} | {:.1} | {:.1} | {peak:.0} |",
        report.tetrahedra,
        angles(&report.angles),
        report.raw_angles.smallest,
        report.volume / 1e3,
    );
    if let Some(folder) = &arguments.vtu {
        write(tissue, &folder.join(format!("{name}.vtu")));
    }
    stages.seconds()
}

fn angles(angles: &Angles) -> String {
    let Angles { smallest, thousandth, hundredth, largest, .. } = angles;
    format!("{smallest:.1}, {thousandth:.1}, {hundredth:.1}, {largest:.0}")
}

fn write(tissue: TissueMesh, file: &Path) {
    let sets = [
        ("skin", Boundary::Skin),
        ("airway", Boundary::Airway),
        ("bone", Boundary::Bone),
        ("cut", Boundary::Cut),
    ];
    let sets = sets.map(|(name, on)| (name.to_owned(), tissue.nodes_on(on)));
    let mut volume = tissue.volume;
    volume.node_sets.extend(sets);
    let bytes = vtu::write(&VolumeOutput::plain(&volume, Frame::Lps)).expect("a mesh of ours");
    std::fs::write(file, bytes).expect("a folder that can be written to");
}

/// The processor seconds at which each stage began, and the end.
#[derive(Default)]
struct Stages(Mutex<Vec<f64>>);

impl Stages {
    fn seconds(self) -> Vec<f64> {
        let begun = self.0.into_inner().expect("no thread has panicked");
        begun.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }
}

impl Progress for Stages {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn step(&self, _done: usize, _of: usize) {
        self.0.lock().expect("no thread has panicked").push(cpu_seconds());
    }

    fn is_cancelled(&self) -> bool {
        false
    }
}
