//! The slab of docs/verification.md#v29: 60 x 30 x 12 mm of tissue, half of a scene that mirrors at y = 0. Its base carries
//! a patch that moves and a frame that stays; what lies between is free, and the top is skin.
//!
//! Level 0 has cells of 6 mm, each cut into six tetrahedra (or left whole, in `slab_hex`).

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{materials, nodes_where, rotated, shift};
use crate::boundary::NodeSelection;
use crate::mesh::sample::block;
use crate::mesh::{CellShape, TriangleSurface, Vector, VolumeMesh};
use crate::prediction::{Bone, Case, CaseSegment, ElementChoice, Plan, Sliding, SlidingNormal};
use crate::study::variant::{Strain, StudyScene, Truth};

/// In mm; x is centred.
const SIZE: [f64; 3] = [60.0, 30.0, 12.0];
const CELL: f64 = 6.0;
/// Half widths of the patch and of the opening of the frame, in mm.
const PATCH: f64 = 12.0;
const OPENING: f64 = 24.0;
/// Places are multiples of the cell.
const ROUNDING: f64 = 1e-9;

/// The frame is three sets: a cell in its inner corner has nodes on two sides, and the edge between them is not part of
/// the frame.
const FRAME: [&str; 3] = ["frame_left", "frame_right", "frame_back"];

/// Of tetrahedra; the truth is quadratic ones of 1.5 mm.
pub fn slab() -> StudyScene {
    slab_of(
        CellShape::Tet4,
        Truth::Refined { times: 2, element: ElementChoice::Quadratic, strain: Strain::Small },
    )
}

/// Of tetrahedra, moved as far as jaws are moved; the truth is stabilised ones of 1.5 mm at finite strain.
pub fn slab_far() -> StudyScene {
    let strain = Strain::Finite;
    let truth = Truth::Refined { times: 2, element: ElementChoice::Stabilised, strain };
    let near = slab_of(CellShape::Tet4, truth);
    let materials = near.materials.iter().take(1).cloned().collect();
    let along = Vector::new(4.0, 0.0, 8.0);
    let mut plans: Vec<(String, Plan)> =
        [10.0, 15.0, 25.0].map(|length| shift("patch", length, along)).into();
    plans.push(rotated("patch", 20.0, Vector::y(), Vector::zeros()));
    StudyScene { name: "slab_far".to_owned(), plans, materials, ..near }
}

/// Of hexahedra; the truth is mean-dilatation ones of 0.75 mm.
pub fn slab_hex() -> StudyScene {
    let truth =
        Truth::Refined { times: 3, element: ElementChoice::MeanDilatation, strain: Strain::Small };
    StudyScene { name: "slab_hex".to_owned(), ..slab_of(CellShape::Hex8, truth) }
}

/// Of wedges; the truth is mean-dilatation ones of 0.75 mm.
pub fn slab_wedge() -> StudyScene {
    let truth =
        Truth::Refined { times: 3, element: ElementChoice::MeanDilatation, strain: Strain::Small };
    StudyScene { name: "slab_wedge".to_owned(), ..slab_of(CellShape::Wedge6, truth) }
}

fn slab_of(shape: CellShape, truth: Truth) -> StudyScene {
    let mesh = mesh(shape);
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let surfaces: BTreeMap<String, Arc<TriangleSurface>> =
        [("patch", vec!["patch"]), ("frame", FRAME.to_vec())]
            .into_iter()
            .map(|(bone, sets)| (bone.to_owned(), Arc::new(bone_surface(&mesh, &sets))))
            .collect();
    let bone = |name: &String| Bone { name: name.clone(), surface: name.clone() };
    let tissues = [
        materials("nu 0.46", &[("*", 15.0, 0.46)]),
        materials("nu 0.3", &[("*", 15.0, 0.3)]),
        materials("nu 0.49", &[("*", 15.0, 0.49)]),
    ];
    let case = Case {
        bones: surfaces.keys().map(bone).collect(),
        surfaces,
        skin: Some(set("z_max")),
        skin_regions: BTreeMap::from([("over the patch".to_owned(), set("over_patch"))]),
        segments: vec![CaseSegment { name: "patch".to_owned(), nodes: set("patch") }],
        fixed: FRAME.map(set).to_vec(),
        sliding: vec![Sliding {
            nodes: set("y_min"),
            normal: SlidingNormal::Direction(Vector::y()),
            segment: None,
        }],
        materials: tissues[0].by_region.clone(),
        volume: Arc::new(mesh),
        ..Case::default()
    };
    StudyScene { name: "slab".to_owned(), case, plans: plans(), materials: tissues.into(), truth }
}

/// The movement of docs/verification.md#v29 first, (4, 0, 8) mm; then lengths along it, and turns about y, which mirror too.
fn plans() -> Vec<(String, Plan)> {
    let along = Vector::new(4.0, 0.0, 8.0);
    let (_, whole) = shift("patch", along.norm(), along);
    let mut plans = vec![("patch 4,0,8 mm".to_owned(), whole)];
    plans.extend([1.0, 2.0, 4.0, 8.0].map(|length| shift("patch", length, along)));
    plans.extend(
        [2.0, 5.0, 10.0].map(|angle| rotated("patch", angle, Vector::y(), Vector::zeros())),
    );
    plans
}

fn mesh(shape: CellShape) -> VolumeMesh {
    let cells = SIZE.map(|size| (size / CELL) as usize);
    let mut mesh = block(Vector::from(SIZE), cells, shape);
    mesh.nodes.iter_mut().for_each(|x| x.x -= 0.5 * SIZE[0]);
    let over = |x: &Vector| x.x.abs() < PATCH + ROUNDING && x.y < PATCH + ROUNDING;
    let base = |x: &Vector| x.z < ROUNDING;
    let top = SIZE[2] - ROUNDING;
    let beyond = OPENING - ROUNDING;
    let sets = [
        ("patch", nodes_where(&mesh, |x| base(x) && over(x))),
        ("over_patch", nodes_where(&mesh, |x| x.z > top && over(x))),
        (FRAME[0], nodes_where(&mesh, |x| base(x) && x.x < -beyond)),
        (FRAME[1], nodes_where(&mesh, |x| base(x) && x.x > beyond)),
        (FRAME[2], nodes_where(&mesh, |x| base(x) && x.y > beyond)),
    ];
    mesh.node_sets.extend(sets.map(|(name, nodes)| (name.to_owned(), nodes)));
    mesh
}

/// The faces whose nodes are all in one of the sets, seen from the tissue.
fn bone_surface(mesh: &VolumeMesh, sets: &[&str]) -> TriangleSurface {
    let within = |nodes: &[u32]| {
        sets.iter()
            .filter_map(|set| mesh.node_set(set))
            .any(|set| nodes.iter().all(|node| set.binary_search(node).is_ok()))
    };
    let mut faces = mesh.boundary_faces();
    faces.retain(|face| within(face.nodes()));
    let mut surface = mesh.surface_of(&faces);
    surface.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    surface
}
