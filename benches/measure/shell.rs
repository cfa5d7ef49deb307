//! The face-like shells of the shared data and their standard load, as their README states it.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use mechanics::boundary::NodeSelection;
use mechanics::format::{Mesh, ReadLimits, read};
use mechanics::material::LinearElastic;
use mechanics::mesh::refinement::refine;
use mechanics::mesh::{Vector, VolumeMesh};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Case, CaseSegment, Plan, RegionNames};

pub const SEGMENTS: [&str; 2] = ["maxilla", "mandible"];

/// The shell of that size, with every edge halved for a `+` at the end of its name; or none, said aloud,
/// where the data is not here.
pub fn load(size: &str) -> Option<Arc<VolumeMesh>> {
    if let Some(coarse) = size.strip_suffix('+') {
        return load(coarse).map(|mesh| Arc::new(refine(&mesh)));
    }
    let root = std::env::var_os("FACIES_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"),
        PathBuf::from,
    );
    let path = root.join(format!("data/shell/{size}.vtu"));
    let Ok(bytes) = std::fs::read(&path) else {
        println!("skipped: {} is not here", path.display());
        return None;
    };
    let read = read(&bytes, &ReadLimits::default()).expect("the shells are valid");
    let Mesh::Volume(mesh) = read.mesh else { panic!("a shell is a volume mesh") };
    Some(Arc::new(mesh))
}

/// Two segments turn by 3 degrees and move by 8 mm; the inside and the rim behind are held.
pub fn standard_load(mesh: &Arc<VolumeMesh>, materials: Materials) -> (Case, Plan) {
    let label = |value| NodeSelection::Label { array: "tag".to_owned(), value };
    let names = BTreeMap::from([(1, "stiff".to_owned())]);
    let segment = |name: &str, value| CaseSegment { name: name.to_owned(), nodes: label(value) };
    let case = Case {
        volume: mesh.clone(),
        regions: Some(RegionNames { array: "band".to_owned(), names }),
        skin: Some(label(5)),
        segments: vec![segment(SEGMENTS[0], 2), segment(SEGMENTS[1], 3)],
        fixed: vec![label(1), label(4)],
        materials,
        ..Case::default()
    };
    let turn = 3.0_f64.to_radians();
    let moved = |name: &str, axis: Vector, pivot: Vector, along: Vector| PlannedSegment {
        name: name.to_owned(),
        movement: RigidMovement::about_pivot(axis * turn, pivot, along.normalize() * 8.0),
    };
    let (up, down) = (Vector::new(0.0, 7.0, -4.0), Vector::new(0.0, -7.0, 4.0));
    let segments = vec![
        moved(SEGMENTS[0], Vector::x(), Vector::new(0.0, 50.0, -10.0), up),
        moved(SEGMENTS[1], Vector::z(), Vector::new(0.0, 40.0, -50.0), down),
    ];
    (case, Plan { segments, ..Plan::default() })
}

/// By the name of the region: `*`, and `stiff` for the bands.
pub type Materials = BTreeMap<String, LinearElastic>;

/// Those that the README of the shells calls (a) to (d), and (e).
pub fn materials(name: &str) -> Materials {
    match name {
        "a" => homogeneous(0.46),
        "b" => {
            let (soft, stiff) = (elastic(3.0, 0.46), elastic(790.0, 0.43));
            BTreeMap::from([("*".to_owned(), soft), ("stiff".to_owned(), stiff)])
        }
        "c" => homogeneous(0.49),
        "d" => homogeneous(0.499),
        "e" => homogeneous(0.4999),
        other => panic!("no material {other:?}: a, b, c, d or e"),
    }
}

/// 15 kPa everywhere.
pub fn homogeneous(nu: f64) -> Materials {
    BTreeMap::from([("*".to_owned(), elastic(15.0, nu))])
}

fn elastic(young_modulus: f64, nu: f64) -> LinearElastic {
    LinearElastic::new(young_modulus, nu, 1.0).expect("within the ranges")
}
