//! Newton's method at finite strain on a hard block, as the table of docs/finite-strain.md:
//! `cargo bench --bench finite_strain [-- CELLS …]`.
//!
//! 100 x 100 x 20 mm of neo-Hookean tissue of 15 kPa, cut into CELLS x CELLS x CELLS/5 cubes of six tetrahedra. Its bottom is
//! held; a patch of 30 x 30 mm is moved by s (25, 0, 10) mm and turned by 15 s degrees. Block B leaves a ring of 25 mm
//! around the patch free, block A does not. Time is that of one call, from mesh in memory to displacement in memory, the
//! median of three; `RAYON_NUM_THREADS` sets the threads.

mod measure;

use std::time::Instant;

use measure::median;
use mechanics::boundary::Hold;
use mechanics::material::hyperelastic::{Law, NeoHookean};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::finite_strain::{Elements, FibreField, FiniteStrain};
use mechanics::model::problem::LoadCase;
use mechanics::progress::Unobserved;
use mechanics::solver::Tolerance;
use nalgebra::Rotation3;

const REPEATS: usize = 3;

struct Plan {
    elements: Elements,
    block: char,
    poisson_ratio: f64,
    share: f64,
}

fn main() {
    let asked: Vec<usize> = std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![20, 30, 45] } else { asked };
    println!(
        "| elements | block | tetrahedra | nu | s | wall s | steps | inner iterations | hierarchies | indefinite steps | \
         least det F | energy mN mm | mean movement of the top mm |"
    );
    println!("|{}", " --- |".repeat(13));
    for cells in sizes {
        for elements in [Elements::PLAIN, Elements::STABLE] {
            for (block, poisson_ratio, share) in [
                ('B', 0.46, 0.5),
                ('B', 0.46, 1.0),
                ('B', 0.49, 1.0),
                ('B', 0.4999, 1.0),
                ('A', 0.46, 1.0),
                ('A', 0.49, 1.0),
            ] {
                row(cells, &Plan { elements, block, poisson_ratio, share });
            }
        }
    }
}

fn row(cells: usize, plan: &Plan) {
    let mesh = block(Vector::new(100.0, 100.0, 20.0), [cells, cells, cells / 5], CellShape::Tet4);
    let holds = holds(&mesh, plan);
    let mu = 7.5 / (1.0 + plan.poisson_ratio);
    let lambda = 2.0 * mu * plan.poisson_ratio / (1.0 - 2.0 * plan.poisson_ratio);
    let one = vec![0; mesh.cells.len()];
    let problem = FiniteStrain {
        mesh: &mesh,
        laws: &[Law::NeoHookean(NeoHookean { lambda, mu })],
        law_of_cell: &one,
        pressure_of_cell: &one,
        fibres: FibreField::default(),
        elements: plan.elements,
        holds: &holds,
        tolerance: Tolerance { relative_residual: 1e-6, memory_mb: 16e3 },
    };
    let held = holds.iter().map(|hold| *hold.values()).collect();
    let case = LoadCase { held, forces: vec![Vector::zeros(); mesh.nodes.len()] };
    let solve = || {
        let begun = Instant::now();
        (problem.solve(&case, &Unobserved), begun.elapsed().as_secs_f64())
    };
    let (found, first) = solve();
    let Plan { elements, block, poisson_ratio, share } = plan;
    let element = if elements.stabilised { "stabilised" } else { "plain" };
    let head =
        format!("| {element} | {block} | {} | {poisson_ratio} | {share} |", mesh.cells.len());
    match found {
        Ok(found) => {
            let walls: Vec<f64> = (1..REPEATS).map(|_| solve().1).chain([first]).collect();
            let top = mesh.nodes.iter().zip(&found.displacement).filter(|(x, _)| x.z > 19.999);
            let moved: Vec<f64> = top.map(|(_, u)| u.norm()).collect();
            let Some(newton) = found.solver.newton else { return };
            println!(
                "{head} {:.2} | {} | {} | {} | {} | {:.3} | {:.1} | {:.4} |",
                median(walls),
                found.solver.iterations,
                newton.inner_iterations,
                newton.hierarchies,
                newton.indefinite_steps,
                newton.least_det_f,
                newton.energy,
                moved.iter().sum::<f64>() / moved.len() as f64,
            );
        }
        Err(error) => println!("{head} {first:.2} | {error} |{}", " |".repeat(6)),
    }
}

fn holds(mesh: &VolumeMesh, plan: &Plan) -> Vec<Hold> {
    let turn = Rotation3::from_axis_angle(&Vector::y_axis(), (15.0 * plan.share).to_radians());
    let pivot = Vector::new(50.0, 50.0, 0.0);
    let bottom = (0..).zip(&mesh.nodes).filter(|(_, x)| x.z.abs() < 1e-9);
    let hold = |(node, x): (u32, &Vector)| {
        let outside = [x.x, x.y].map(|v| (35.0 - v).max(v - 65.0).max(0.0));
        let distance = outside[0].hypot(outside[1]);
        let moved = turn * (x - pivot) + pivot - x + Vector::new(25.0, 0.0, 10.0) * plan.share;
        match distance == 0.0 {
            true => Some(Hold::at(node, moved)),
            false => {
                (plan.block == 'A' || distance > 25.0).then(|| Hold::at(node, Vector::zeros()))
            }
        }
    };
    bottom.filter_map(hold).collect()
}
