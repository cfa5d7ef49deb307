//! Where iterations have a hard time: nearly incompressible tissue, stiffness that jumps by a million,
//! slivers, and meshes and materials at random. Whatever is answered agrees with a factorisation; whatever
//! is not ends with the history of its residuals.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::progress::Unobserved;
use mechanics::solver::{SolverError, System, Tolerance, cholesky, conjugate_gradient, ordering};

use crate::scenes::{SHAPES, material};
use crate::solver::solvers::{forces, largest, largest_difference, system_of};

const TOLERANCE: Tolerance = Tolerance { relative_residual: 1e-10, memory_mb: 1000.0 };

/// Numbers between 0 and 1 that are the same on every run (Knuth's MMIX generator).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn cube(shape: CellShape) -> VolumeMesh {
    block(Vector::new(14.0, 12.0, 10.0), [7, 6, 5], shape)
}

/// Iterations, after a check against a factorisation; `None` where the iterations said that they failed.
fn checked(system: &System, what: &str) -> Option<usize> {
    let right = [forces(system, 3)];
    let iterated = match conjugate_gradient::solve(system, &right, &TOLERANCE, &Unobserved) {
        Ok(mut solutions) => solutions.remove(0),
        Err(SolverError::NotConverged { history, residual, .. }) => {
            assert!(!history.is_empty() && residual > 1e-10, "{what}: {residual:.1e}");
            return None;
        }
        Err(other) => panic!("{what}: {other}"),
    };
    let order = ordering::minimum_degree(system);
    let factorised = cholesky::solve(system, &order, &right, &TOLERANCE, &Unobserved).unwrap();
    let difference = largest_difference(&iterated.unknowns, &factorised[0].unknowns);
    let relative = difference / largest(&factorised[0].unknowns);
    // A residual of 1e-10 leaves an error of that times the condition number at most.
    assert!(relative < 1e-4, "{what}: {relative:.1e} from the factorisation");
    Some(iterated.report.iterations)
}

#[test]
fn nearly_incompressible_tissue_is_solved() {
    for shape in SHAPES {
        let mesh = cube(shape);
        let system =
            system_of(&mesh, "z_min", &[material(15.0, 0.4999)], &vec![0; mesh.cells.len()]);
        let iterations = checked(&system, shape.name());
        assert!(iterations.is_some_and(|iterations| iterations < 1000), "{iterations:?}");
    }
}

#[test]
fn stiffness_that_jumps_by_a_million_is_solved() {
    for shape in SHAPES {
        let mesh = cube(shape);
        let materials = [material(0.001, 0.46), material(1000.0, 0.43)];
        // Stiff plates across soft tissue, and every seventh cell for itself.
        let kind = |cell: usize| {
            let middle = mesh.corners(cell).sum::<Vector>() / mesh.corners(cell).count() as f64;
            u16::from((middle.x / 4.0) as usize % 2 == 1 || cell.is_multiple_of(7))
        };
        let of_cell: Vec<u16> = (0..mesh.cells.len()).map(kind).collect();
        let system = system_of(&mesh, "z_min", &materials, &of_cell);
        let iterations = checked(&system, shape.name());
        assert!(iterations.is_some_and(|iterations| iterations < 2000), "{iterations:?}");
    }
}

#[test]
fn slivers_of_a_tenth_of_a_degree_are_solved() {
    let mut mesh = cube(CellShape::Tet4);
    // Every third inner node goes to within a thousandth of the plane of a face across from it.
    let boundary: std::collections::BTreeSet<u32> =
        mesh.boundary_faces().iter().flat_map(|face| face.nodes().to_vec()).collect();
    let mut flattened = 0;
    for cell in (0..mesh.cells.len()).step_by(3) {
        let nodes = mesh.cells.nodes(cell).to_vec();
        let Some(apex) = (0..4).find(|&k| !boundary.contains(&nodes[k])) else { continue };
        let others: Vec<Vector> =
            (0..4).filter(|&k| k != apex).map(|k| mesh.nodes[nodes[k] as usize]).collect();
        let foot = (others[0] + others[1] + others[2]) / 3.0;
        let before = mesh.nodes[nodes[apex] as usize];
        mesh.nodes[nodes[apex] as usize] = foot + (before - foot) * 1e-3;
        if smallest_volume(&mesh) > 0.0 {
            flattened += 1;
        } else {
            mesh.nodes[nodes[apex] as usize] = before;
        }
    }
    assert!(flattened > 10, "{flattened} nodes were moved");
    let system = system_of(&mesh, "z_min", &[material(15.0, 0.46)], &vec![0; mesh.cells.len()]);
    let iterations = checked(&system, "slivers");
    assert!(iterations.is_some_and(|iterations| iterations < 2000), "{iterations:?}");
}

fn smallest_volume(mesh: &VolumeMesh) -> f64 {
    let volume = |cell: usize| {
        let corner: Vec<Vector> = mesh.corners(cell).collect();
        (corner[1] - corner[0]).cross(&(corner[2] - corner[0])).dot(&(corner[3] - corner[0])) / 6.0
    };
    (0..mesh.cells.len()).map(volume).fold(f64::INFINITY, f64::min)
}

#[test]
fn random_meshes_of_random_materials_are_solved_or_say_that_they_are_not() {
    let mut solved = 0;
    for seed in 0..10 {
        let mut random = Random(seed);
        let mut mesh = cube(CellShape::Tet4);
        let before = mesh.nodes.clone();
        for node in &mut mesh.nodes {
            *node += Vector::from_fn(|_, _| 1.2 * (random.next() - 0.5));
        }
        // Where that turned a cell inside out its nodes go back.
        for cell in 0..mesh.cells.len() {
            let nodes = mesh.cells.nodes(cell).to_vec();
            let corner: Vec<Vector> = mesh.corners(cell).collect();
            let six = (corner[1] - corner[0])
                .cross(&(corner[2] - corner[0]))
                .dot(&(corner[3] - corner[0]));
            if six < 1e-3 {
                nodes.iter().for_each(|&node| mesh.nodes[node as usize] = before[node as usize]);
            }
        }
        if smallest_volume(&mesh) <= 0.0 {
            continue;
        }
        let materials: Vec<_> = (0..20)
            .map(|_| material(10.0_f64.powf(6.0 * random.next() - 3.0), 0.499 * random.next()))
            .collect();
        let of_cell: Vec<u16> =
            (0..mesh.cells.len()).map(|_| (20.0 * random.next()) as u16).collect();
        let system = system_of(&mesh, "x_max", &materials, &of_cell);
        solved += usize::from(checked(&system, &format!("seed {seed}")).is_some());
    }
    assert!(solved >= 5, "{solved} of 10 were solved");
}
