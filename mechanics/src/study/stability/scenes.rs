//! Small scenes whose parameters a probe varies: a layer of 12 mm on bone, and a swelling thick sphere.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::boundary::NodeSelection;
use crate::material::LinearElastic;
use crate::mesh::refinement::refine;
use crate::mesh::sample::{ThickSphere, block, thick_sphere_octant};
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::plan::{PlannedSegment, RigidMovement};
use crate::prediction::{
    Case, CaseSegment, ElementChoice, Plan, Prescribed, RegionNames, Settings, Sliding,
    SlidingNormal,
};

/// Soft tissue where nothing else is asked: kPa and Poisson's ratio, g/cm³.
pub const YOUNG_MODULUS: f64 = 15.0;
pub const POISSON_RATIO: f64 = 0.43;

/// The edge of a cell of the layer in mm.
pub const CELL: f64 = 4.0;
const WIDTH: f64 = 48.0;
/// The layers of cells: where each begins and the last ends, in mm.
pub const LEVELS: [f64; 4] = [0.0, 4.0, 8.0, 12.0];

/// Half the width of the patch that a segment holds.
const PATCH: f64 = 8.0;

/// Hexahedra for elements that are made for them, tetrahedra for everything else.
pub fn shape_for(settings: &Settings) -> CellShape {
    match settings.element {
        ElementChoice::MeanDilatation => CellShape::Hex8,
        ElementChoice::Auto
        | ElementChoice::Plain
        | ElementChoice::Stabilised
        | ElementChoice::Quadratic => CellShape::Tet4,
    }
}

pub fn set(name: &str) -> NodeSelection {
    NodeSelection::NodeSet(name.to_owned())
}

/// One material everywhere; the ranges of the constants above are right.
pub fn tissue(material: LinearElastic) -> BTreeMap<String, LinearElastic> {
    BTreeMap::from([("*".to_owned(), material)])
}

/// A layer of 48 x 48 mm between these levels. Sets: `patch`, 16 x 16 mm in the middle of the bottom, `far`,
/// the bottom beyond a free ring of this width in mm, `base`, the whole bottom, and `skin`. Cell array
/// `layer`.
pub fn layer(levels: &[f64], ring: f64, shape: CellShape) -> VolumeMesh {
    let across = (WIDTH / CELL) as usize;
    let layers = levels.len() - 1;
    let mut mesh = block(Vector::new(WIDTH, WIDTH, layers as f64), [across, across, layers], shape);
    let middle = |cell: usize| {
        let corners = mesh.corners(cell);
        let count = corners.len() as f64;
        (corners.map(|x| x.z).sum::<f64>() / count).floor() as i64
    };
    let labels = (0..mesh.cells.len()).map(middle).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    for node in &mut mesh.nodes {
        *node = Vector::new(node.x - WIDTH / 2.0, node.y - WIDTH / 2.0, levels[node.z as usize]);
    }
    let (base, skin) = (mesh.node_sets["z_min"].clone(), mesh.node_sets["z_max"].clone());
    let far = |node: &u32, half: f64| {
        let x = mesh.nodes[*node as usize];
        x.x.abs().max(x.y.abs()) > half
    };
    let (patch, beyond) = (PATCH + 0.1, PATCH + ring - 0.1);
    let sets = [
        ("patch", base.iter().filter(|node| !far(node, patch)).copied().collect()),
        ("far", base.iter().filter(|node| far(node, beyond)).copied().collect()),
        ("base", base),
        ("skin", skin),
    ];
    for (name, nodes) in sets {
        mesh.node_sets.insert(name.to_owned(), nodes);
    }
    mesh
}

/// The patch belongs to segment `jaw`; what is `far` is fixed.
pub fn on_bone(mesh: VolumeMesh, materials: BTreeMap<String, LinearElastic>) -> Case {
    Case {
        volume: Arc::new(mesh),
        materials,
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("patch") }],
        fixed: vec![set("far")],
        skin: Some(set("skin")),
        ..Case::default()
    }
}

/// The same with one of its layers a region of its own.
pub fn with_region(mut case: Case, layer: i64, name: &str) -> Case {
    let names = BTreeMap::from([(layer, name.to_owned())]);
    case.regions = Some(RegionNames { array: "layer".to_owned(), names });
    case
}

/// The case with every edge of its mesh halved.
pub fn halved(mut case: Case) -> Case {
    case.volume = Arc::new(refine(&case.volume));
    case
}

/// Segment `jaw` moved.
pub fn jaw(movement: RigidMovement) -> Plan {
    Plan { segments: vec![PlannedSegment { name: "jaw".to_owned(), movement }], ..Plan::default() }
}

/// A translation in mm.
pub fn shift(by: Vector) -> RigidMovement {
    RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), by)
}

fn octant(shape: CellShape) -> VolumeMesh {
    let sphere =
        ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 3, cells_along: 8 };
    thick_sphere_octant(sphere, shape)
}

/// The octant of the same sphere around a ball on which it slides; segment `jaw` is its face at x = 0.
pub fn around_ball(material: LinearElastic, shape: CellShape) -> Case {
    let mut mesh = octant(shape);
    let jaw = mesh.node_sets["x_min"].clone();
    let wall = mesh.node_sets["inner"].iter().filter(|node| jaw.binary_search(node).is_err());
    let wall = wall.copied().collect();
    mesh.node_sets.insert("wall".to_owned(), wall);
    Case {
        volume: Arc::new(mesh),
        materials: tissue(material),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") }],
        sliding: vec![Sliding {
            nodes: set("wall"),
            normal: SlidingNormal::Surface,
            segment: None,
        }],
        skin: Some(set("outer")),
        ..Case::default()
    }
}

/// The thick sphere of docs/verification.md#v7, radii 60 and 72 mm: an octant between planes of symmetry, its inner
/// wall pushed outwards by `by` mm.
pub fn swelling(by: f64, material: LinearElastic, shape: CellShape) -> (Case, Plan) {
    let mut mesh = octant(shape);
    let outwards = mesh.nodes.iter().map(|x| x.normalize() * by).collect();
    mesh.node_vectors.insert("outwards".to_owned(), outwards);
    let plane = |name: &str, axis: usize| {
        let mut displacement = [None; 3];
        displacement[axis] = Some(0.0);
        Prescribed::Uniform { nodes: set(name), displacement }
    };
    let inner = Prescribed::FromArray { nodes: set("inner"), array: "outwards".to_owned() };
    let prescribed = vec![inner, plane("x_min", 0), plane("y_min", 1), plane("z_min", 2)];
    let case = Case {
        volume: Arc::new(mesh),
        materials: tissue(material),
        skin: Some(set("outer")),
        ..Case::default()
    };
    (case, Plan { prescribed, ..Plan::default() })
}
