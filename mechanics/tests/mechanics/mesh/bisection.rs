//! Local refinement by bisection: conforming, of bounded shape, the same on any number of threads, and true to sets.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::mesh::bisection::{Bisection, Carrier, HALVES_EVERY_EDGE};
use mechanics::mesh::half_head::half_head;
use mechanics::mesh::quality::DihedralAngles;
use mechanics::mesh::sample::{ThickSphere, block, thick_sphere_octant};
use mechanics::mesh::{CellShape, Vector, VolumeMesh};

fn meshes() -> Vec<VolumeMesh> {
    let sphere =
        ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 2, cells_along: 3 };
    vec![
        block(Vector::new(3.0, 2.0, 1.0), [3, 2, 2], CellShape::Tet4),
        thick_sphere_octant(sphere, CellShape::Tet4),
        half_head(1).mesh,
    ]
}

fn begin(mesh: &VolumeMesh) -> Bisection {
    Bisection::new(Arc::new(mesh.clone())).unwrap()
}

fn refined(bisection: &Bisection) -> VolumeMesh {
    Carrier::new(bisection).mesh()
}

/// Refines cells that a generator of Lehmer's kind picks, one in seven.
fn refine_at_random(bisection: &mut Bisection, passes: usize) {
    let mut seed = 12_345_u64;
    for pass in 0..passes {
        let picked = |_: &usize| {
            seed = seed * 48_271 % 2_147_483_647;
            seed.is_multiple_of(7)
        };
        let cells: Vec<usize> = (0..bisection.cell_count()).filter(picked).collect();
        bisection.refine(&cells, 1 + (pass % 3) as u8);
    }
}

fn volumes(mesh: &VolumeMesh) -> Vec<f64> {
    let volume = |cell: usize| {
        let p: Vec<Vector> = mesh.corners(cell).collect();
        (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0])) / 6.0
    };
    (0..mesh.cells.len()).map(volume).collect()
}

fn area(mesh: &VolumeMesh) -> f64 {
    mesh.surface_of(&mesh.boundary_faces()).area()
}

#[test]
fn cells_that_are_halved_share_whole_faces_and_fill_the_same_body() {
    for mesh in meshes() {
        let mut bisection = begin(&mesh);
        refine_at_random(&mut bisection, 4);
        let fine = refined(&bisection);
        assert!(fine.cells.len() > 3 * mesh.cells.len());
        assert_eq!(fine.nodes[..mesh.nodes.len()], mesh.nodes[..]);
        let [before, after] = [&mesh, &fine].map(volumes);
        assert!(after.iter().all(|&volume| volume > 0.0));
        let [before, after] = [before, after].map(|all| all.iter().sum::<f64>());
        // Rounding only: every face is flat. A face that no neighbour shares would count as boundary.
        assert!((after - before).abs() < 1e-12 * before);
        assert!((area(&fine) - area(&mesh)).abs() < 1e-12 * area(&mesh));
    }
}

#[test]
fn shapes_stay_what_they_were_however_often_cells_are_halved() {
    for mesh in meshes() {
        let mut bisection = begin(&mesh);
        // Always those at one node and, in turn, others: 45 generations deep.
        for _ in 0..15 {
            let fine = refined(&bisection);
            let at_node: Vec<usize> =
                (0..fine.cells.len()).filter(|&cell| fine.cells.nodes(cell).contains(&0)).collect();
            bisection.refine(&at_node, HALVES_EVERY_EDGE);
        }
        refine_at_random(&mut bisection, 3);
        let angle = |mesh: &VolumeMesh| DihedralAngles::of(mesh).unwrap().smallest;
        let (before, after) = (angle(&mesh), angle(&refined(&bisection)));
        assert!(after > 0.3 * before, "{} {}", before.to_degrees(), after.to_degrees());
    }
}

#[test]
fn three_halvings_of_every_cell_halve_every_edge() {
    let mesh = block(Vector::new(2.0, 2.0, 2.0), [2; 3], CellShape::Tet4);
    let mut bisection = begin(&mesh);
    let all: Vec<usize> = (0..mesh.cells.len()).collect();
    bisection.refine(&all, HALVES_EVERY_EDGE);
    assert_eq!(bisection.cell_count(), 8 * mesh.cells.len());
    let longest = |mesh: &VolumeMesh| {
        let cells = mesh.cells.iter();
        let ends = cells.flat_map(|(shape, n)| shape.edges().iter().map(|&[a, b]| [n[a], n[b]]));
        ends.map(|[a, b]| (mesh.nodes[a as usize] - mesh.nodes[b as usize]).norm())
            .fold(0.0, f64::max)
    };
    // Rounding only.
    assert!(longest(&refined(&bisection)) < 0.5 * longest(&mesh) + 1e-12);
}

#[test]
fn the_same_cells_give_the_same_mesh_on_one_thread_and_on_two() {
    let mesh = half_head(1).mesh;
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut bisection = begin(&mesh);
            refine_at_random(&mut bisection, 3);
            refined(&bisection)
        })
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn a_new_node_is_of_a_set_where_its_face_is() {
    // Two walls one cell apart, and of the top a comb of nodes whose edges bound no face of the set.
    let mut mesh = block(Vector::new(4.0, 4.0, 1.0), [4, 4, 1], CellShape::Tet4);
    let (bottom, top) = (mesh.node_sets["z_min"].clone(), mesh.node_sets["z_max"].clone());
    let mut walls = [bottom, top.clone()].concat();
    walls.sort_unstable();
    let at = |x: f64| move |node: &u32, mesh: &VolumeMesh| mesh.nodes[*node as usize].x == x;
    let line: Vec<u32> = top.iter().copied().filter(|node| at(2.0)(node, &mesh)).collect();
    let half: Vec<u32> = top.iter().copied().filter(|&n| mesh.nodes[n as usize].x <= 2.0).collect();
    mesh.node_sets.extend([("walls".to_owned(), walls), ("line".into(), line.clone())]);
    mesh.node_sets.insert("half".into(), half);
    let labels = mesh.nodes.iter().map(|x| if x.z == 0.0 { 3 } else { 5 }).collect();
    mesh.node_labels = BTreeMap::from([("wall".to_owned(), labels)]);
    let mut bisection = begin(&mesh);
    let all: Vec<usize> = (0..mesh.cells.len()).collect();
    bisection.refine(&all, HALVES_EVERY_EDGE);
    let fine = refined(&bisection);
    let nodes_where = |holds: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        (0_u32..).zip(&fine.nodes).filter(|(_, x)| holds(x)).map(|(node, _)| node).collect()
    };
    let outside = |x: &Vector| x.x == 0.0 || x.x == 4.0 || x.y == 0.0 || x.y == 4.0;
    let on_a_wall = |x: &Vector| x.z == 0.0 || x.z == 1.0;
    let walls = &fine.node_sets["walls"];
    assert!(
        walls
            .iter()
            .all(|&n| on_a_wall(&fine.nodes[n as usize]) || outside(&fine.nodes[n as usize]))
    );
    assert!(nodes_where(&on_a_wall).iter().all(|node| walls.binary_search(node).is_ok()));
    assert_eq!(fine.node_sets["line"], line);
    assert_eq!(fine.node_sets["half"], nodes_where(&|x| x.z == 1.0 && x.x <= 2.0));
    let expected = |x: &Vector| {
        if x.z == 0.0 {
            3
        } else if x.z == 1.0 {
            5
        } else {
            2
        }
    };
    let expected: Vec<i64> = fine.nodes.iter().map(expected).collect();
    assert_eq!(fine.node_labels["wall"], expected);
}

#[test]
fn cells_inherit_and_vectors_of_nodes_are_linear() {
    let mut mesh = block(Vector::new(2.0, 1.0, 1.0), [2, 1, 1], CellShape::Tet4);
    let count = mesh.cells.len();
    mesh.cell_labels.insert("region".into(), (0..count as i64).collect());
    mesh.cell_sets.insert("last".into(), vec![count as u32 - 1]);
    mesh.node_vectors.insert("u".into(), mesh.nodes.clone());
    let mut bisection = begin(&mesh);
    refine_at_random(&mut bisection, 5);
    let fine = refined(&bisection);
    assert_eq!(fine.node_vectors["u"], fine.nodes);
    let (labels, volumes) = (&fine.cell_labels["region"], volumes(&fine));
    for (cell, whole) in self::volumes(&mesh).into_iter().enumerate() {
        let own = labels.iter().zip(&volumes).filter(|(label, _)| **label == cell as i64);
        // Rounding only.
        assert!((own.map(|(_, volume)| volume).sum::<f64>() - whole).abs() < 1e-12);
    }
    let last = (0_u32..).zip(labels).filter(|(_, label)| **label == count as i64 - 1);
    assert_eq!(fine.cell_sets["last"], last.map(|(cell, _)| cell).collect::<Vec<_>>());
}

#[test]
fn hexahedra_are_refused_with_their_number() {
    let mesh = block(Vector::new(1.0, 1.0, 1.0), [2; 3], CellShape::Hex8);
    let refused = Bisection::new(Arc::new(mesh)).unwrap_err();
    assert_eq!((refused.cells, refused.all), (8, 8));
    assert!(refused.to_string().contains("8 of 8 cells are hexahedra or wedges"), "{refused}");
}
