//! The two faces of the shared data: the jaw moves, the skull stays.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use mechanics::boundary::NodeSelection;
use mechanics::format::{Mesh, ReadLimits, read};
use mechanics::material::LinearElastic;
use mechanics::mesh::{Vector, VolumeMesh};
use mechanics::prediction::{Case, CaseSegment};

/// A face of hexahedra and wedges, and the sets of its bones.
pub struct Face {
    pub name: &'static str,
    pub jaw: &'static str,
    pub skull: &'static str,
    pub forward: Vector,
}

pub fn faces() -> [Face; 2] {
    [
        Face {
            name: "subject",
            jaw: "jaw_attached",
            skull: "skull_fixed_orig",
            forward: -Vector::x(),
        },
        Face {
            name: "template",
            jaw: "mandible_fixed",
            skull: "skull_nose_fixed",
            forward: Vector::y(),
        },
    ]
}

impl Face {
    /// The case of its mesh, or of the same nodes in other cells.
    pub fn case(&self, mesh: VolumeMesh, poisson_ratio: f64) -> Case {
        let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
        let material = LinearElastic::new(15.0, poisson_ratio, 1.0).expect("within the ranges");
        Case {
            volume: Arc::new(mesh),
            segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set(self.jaw) }],
            fixed: vec![set(self.skull)],
            materials: BTreeMap::from([("*".to_owned(), material)]),
            ..Case::default()
        }
    }

    /// Its mesh; says so where it is not here.
    pub fn load(&self) -> Option<VolumeMesh> {
        let root = std::env::var_os("FACIES_SHARED").map_or_else(
            || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"),
            PathBuf::from,
        );
        let path = root.join(format!("data/face/{}_face.vtu", self.name));
        let Ok(bytes) = std::fs::read(&path) else {
            println!("skipped: {} is not here", path.display());
            return None;
        };
        match read(&bytes, &ReadLimits::default()).expect("the faces are valid").mesh {
            Mesh::Volume(mesh) => Some(mesh),
            _ => panic!("a face is a volume mesh"),
        }
    }
}
