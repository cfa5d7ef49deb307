//! Indicators of a goal: with their signs they are what the mesh leaves out of it.

use super::edges::Edges;
use super::{DistributedLoads, Estimate, Goal};
use crate::boundary::Hold;
use crate::material::LinearElastic;
use crate::mesh::sample::block;
use crate::mesh::{CellShape, Vector};
use crate::model::fem::assembly::Tissue;
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::fem::displacement::Problem;
use crate::model::fem::linear_system::LinearSystem;
use crate::model::problem::LoadCase;
use crate::progress::Unobserved;
use crate::solver::Tolerance;

/// A block of two kinds of tissue on a bottom of which one half moves; the goal is a mean over its top.
#[test]
fn changes_with_their_signs_are_what_the_mesh_leaves_out_of_the_goal() {
    let mesh = block(Vector::new(30.0, 20.0, 10.0), [5, 3, 3], CellShape::Tet4);
    let materials = [15.0, 60.0].map(|e| LinearElastic::new(e, 0.45, 1.0).unwrap());
    let is_stiff = |cell: usize| u16::from(mesh.corners(cell).sum::<Vector>().x > 60.0);
    let material_of_cell: Vec<u16> = (0..mesh.cells.len()).map(is_stiff).collect();
    let tissue = Tissue::isotropic(&mesh, &materials, &material_of_cell, |_| Dilatation::Pointwise);
    let moved =
        |node: u32| Vector::new(0.0, 1.0, 2.0) * f64::from(mesh.nodes[node as usize].x < 12.0);
    let bottom = mesh.node_sets["z_min"].iter();
    let holds: Vec<Hold> = bottom.map(|&node| Hold::at(node, moved(node))).collect();
    let boundary = mesh.boundary_faces();
    let triangles: Vec<[u32; 3]> = {
        let top = &mesh.node_sets["z_max"];
        let faces = boundary.iter().filter_map(|face| <[u32; 3]>::try_from(face.nodes()).ok());
        faces.filter(|face| face.iter().all(|node| top.contains(node))).collect()
    };
    let weights: Vec<Vector> =
        mesh.nodes.iter().map(|x| Vector::new(0.3, x.x * 0.1, 1.0)).collect();
    let goal = Goal { triangles: &triangles, weights: &weights };
    let tolerance = Tolerance { relative_residual: 1e-12, memory_mb: 1e3 };
    let problem = Problem { tissue, holds: &holds, forces: &[], tolerance };
    for system in
        [LinearSystem::plain(&problem, &Unobserved), LinearSystem::mixed(&problem, &Unobserved)]
    {
        let system = system.unwrap();
        let held = holds.iter().map(|hold| *hold.values()).collect();
        let case = LoadCase { held, ..LoadCase::default() };
        let solved = system.solve(&[case], &Unobserved).unwrap().remove(0);
        let loads = DistributedLoads::default();
        let estimate = Estimate {
            tissue: problem.tissue,
            system: &system,
            boundary: &boundary,
            loads: &loads,
        };

        // J(b) and J(e).
        let edges = Edges::new(&mesh, &system.numbering);
        let cells = estimate.cells(estimate.answered(&solved));
        let two_level = estimate.two_level(&cells);
        let mut equations = two_level.equations(&edges).unwrap();
        let steps = two_level.steps(&edges, &mut equations).unwrap();
        let (residual, _) = two_level.at_corners().unwrap();
        let e = system.solve_for(&[residual], 1e-12, &Unobserved).unwrap().remove(0).displacement;
        let mut of_edges = vec![Vector::zeros(); edges.count()];
        goal.add_to(&mesh, &edges, &mut of_edges);
        let sum = |a: &[Vector], b: &[Vector]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let left_out = sum(&goal.of_nodes(&mesh), &e) + sum(&of_edges, &steps);

        let changes = estimate.changes(&solved, &goal, &edges, 1e-12, &Unobserved).unwrap();
        let of_cells = changes.of_cells.iter().sum::<f64>();
        let told = changes.of_edges.iter().sum::<f64>() + of_cells;
        assert!((told / left_out - 1.0).abs() < 1e-6, "{told} {left_out}");
        // What the stabilisation takes counts.
        let has_pressures = system.pressures.is_some();
        assert_eq!(
            of_cells.abs() > 1e-3 * left_out.abs(),
            has_pressures,
            "{of_cells} of {left_out}"
        );

        // Shares have no sign, and none is lost.
        let indicators = estimate.indicators(&solved, &goal, &Unobserved).unwrap();
        let all = changes.of_edges.iter().chain(&changes.of_cells).map(|own| own.abs());
        assert!((indicators.iter().sum::<f64>() / all.sum::<f64>() - 1.0).abs() < 0.05);
    }
}
