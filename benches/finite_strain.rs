//! Newton's method at finite strain on a hard block, as the table of docs/finite-strain.md:
//! `cargo bench --bench finite_strain [-- CELLS … --vtu FOLDER --finest CELLS]`. `--vtu` writes the mesh and the displacement of plain
//! tetrahedra on block B at a Poisson ratio of 0.46, for peers to be held against (`benches/peers/finite_strain/run`). `--finest` prints how
//! far each element is from stabilised tetrahedra on that mesh at half the movement and a Poisson ratio of 0.49.
//!
//! 100 x 100 x 20 mm of neo-Hookean tissue of 15 kPa, cut into CELLS x CELLS x CELLS/5 cubes of six tetrahedra. Its bottom is
//! held; a patch of 30 x 30 mm is moved by s (25, 0, 10) mm and turned by 15 s degrees. Block B leaves a ring of 25 mm
//! around the patch free, block A does not. Times are those of one call, from mesh in memory to displacement in memory,
//! medians of three; `RAYON_NUM_THREADS` sets the threads.

mod measure;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use measure::median;
use measure::process::cpu_seconds;
use mechanics::boundary::Constraint;
use mechanics::format::vtk::vtu;
use mechanics::format::{ArrayValues, NamedValues, VolumeOutput};
use mechanics::material::hyperelastic::{Law, NeoHookean};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Frame, Vector, VolumeMesh};
use mechanics::model::fem::finite_strain::{Advance, Elements, FibreField, FiniteStrain};
use mechanics::model::problem::{Equilibrium, LoadCase, ModelError};
use mechanics::progress::Unobserved;
use mechanics::solver::Tolerance;
use nalgebra::Rotation3;

const REPEATS: usize = 3;

#[derive(Clone, Copy)]
struct Plan {
    elements: Elements,
    block: char,
    poisson_ratio: f64,
    share: f64,
}

fn main() {
    let Arguments { sizes, compared, finest } = arguments();
    if let Some(finest) = finest {
        return errors(&sizes, finest);
    }
    println!(
        "| elements | block | tetrahedra | nu | s | wall s | processor s | steps | inner iterations | hierarchies | \
         indefinite steps | least det F | energy mN mm | mean movement of the top mm |"
    );
    println!("|{}", " --- |".repeat(14));
    for cells in sizes {
        match &compared {
            Some(folder) => compare(cells, folder),
            None => plans().for_each(|plan| row(cells, &plan)),
        }
    }
}

#[derive(Default)]
struct Arguments {
    sizes: Vec<usize>,
    compared: Option<PathBuf>,
    finest: Option<usize>,
}

fn arguments() -> Arguments {
    let mut found = Arguments::default();
    let number = |text: &str| text.parse().expect("a number of cells along a side");
    let mut given = std::env::args().skip(1);
    while let Some(argument) = given.next() {
        match argument.as_str() {
            "--bench" => {} // cargo says so to every bench
            "--vtu" => {
                found.compared = Some(given.next().expect("--vtu needs a folder").into());
            }
            "--finest" => {
                found.finest = Some(number(&given.next().expect("--finest needs a number")));
            }
            size => found.sizes.push(number(size)),
        }
    }
    if found.sizes.is_empty() {
        found.sizes = match (&found.compared, found.finest) {
            (None, None) => vec![20, 30, 45],
            (None, Some(_)) => vec![20, 40],
            (Some(_), _) => vec![20, 30],
        };
    }
    found
}

fn plans() -> impl Iterator<Item = Plan> {
    let blocks = [
        ('B', 0.46, 0.5),
        ('B', 0.46, 1.0),
        ('B', 0.49, 1.0),
        ('B', 0.4999, 1.0),
        ('A', 0.46, 1.0),
        ('A', 0.49, 1.0),
    ];
    [Elements::PLAIN, Elements::STABLE].into_iter().flat_map(move |elements| {
        blocks.map(|(block, poisson_ratio, share)| Plan { elements, block, poisson_ratio, share })
    })
}

/// The rows that peers are held against; the displacement of plain tetrahedra is written.
fn compare(cells: usize, folder: &Path) {
    let plan = Plan { elements: Elements::PLAIN, block: 'B', poisson_ratio: 0.46, share: 1.0 };
    row(cells, &Plan { elements: Elements::STABLE, ..plan });
    row(cells, &Plan { poisson_ratio: 0.49, ..plan });
    row(cells, &plan);
    let mesh = cut(cells);
    let (found, ..) = solve(&mesh, &plan);
    let displacement = found.expect("plain tetrahedra come to rest on block B").displacement;
    let arrays =
        vec![NamedValues { name: "displacement_mm", values: ArrayValues::Vectors(&displacement) }];
    let output = VolumeOutput { point_arrays: arrays, ..VolumeOutput::plain(&mesh, Frame::Lps) };
    let bytes = vtu::write(&output).expect("a mesh of ours");
    std::fs::write(folder.join(format!("{cells}.vtu")), bytes).expect("a folder to write to");
}

/// How far the top of meshes is from that of the finest one, of which all their nodes are nodes.
fn errors(sizes: &[usize], finest: usize) {
    let plan = |elements| Plan { elements, block: 'C', poisson_ratio: 0.49, share: 0.5 };
    let rest = |cells: usize, elements: Elements| {
        let mesh = cut(cells);
        let found = solve(&mesh, &plan(elements)).0.expect("half the movement comes to rest");
        let top = mesh.nodes.iter().zip(found.displacement).filter(|(x, _)| x.z > 19.999);
        let place = |x: &Vector| [x.x, x.y].map(|v| (v * 1e6).round() as i64);
        top.map(|(x, u)| (place(x), u)).collect::<BTreeMap<_, _>>()
    };
    let known = rest(finest, Elements::STABLE);
    println!("| tetrahedra | plain, mm | stabilised, mm | ratio |\n| --- | --- | --- | --- |");
    for &cells in sizes {
        let [plain, stabilised] = [Elements::PLAIN, Elements::STABLE].map(|elements| {
            let top = rest(cells, elements);
            let off = top.iter().map(|(place, u)| (u - known[place]).norm());
            off.sum::<f64>() / top.len() as f64
        });
        let count = 6 * cells * cells * (cells / 5);
        println!("| {count} | {plain:.4} | {stabilised:.4} | {:.1} |", plain / stabilised);
    }
}

fn cut(cells: usize) -> VolumeMesh {
    block(Vector::new(100.0, 100.0, 20.0), [cells, cells, cells / 5], CellShape::Tet4)
}

/// The answer, its wall and its processor seconds.
fn solve(mesh: &VolumeMesh, plan: &Plan) -> (Result<Equilibrium, ModelError>, f64, f64) {
    let holds = holds(mesh, plan);
    let mu = 7.5 / (1.0 + plan.poisson_ratio);
    let lambda = 2.0 * mu * plan.poisson_ratio / (1.0 - 2.0 * plan.poisson_ratio);
    let one = vec![0; mesh.cells.len()];
    let problem = FiniteStrain {
        mesh,
        nodes: &mesh.nodes,
        laws: &[Law::NeoHookean(NeoHookean { lambda, mu })],
        law_of_cell: &one,
        pressure_of_cell: &one,
        fibres: FibreField::default(),
        membrane: None,
        inner: std::sync::Arc::default(),
        elements: plan.elements,
        constraints: &holds,
        tolerance: Tolerance { relative_residual: 1e-6, memory_mb: 16e3 },
        with_states: false,
        advance: Advance::default(),
        near: None,
    };
    let held = holds.iter().map(|hold| *hold.values()).collect();
    let case =
        LoadCase { held, forces: vec![Vector::zeros(); mesh.nodes.len()], ..LoadCase::default() };
    let (begun, used) = (Instant::now(), cpu_seconds());
    let found = problem.solve(&case, &Unobserved);
    (found, begun.elapsed().as_secs_f64(), cpu_seconds() - used)
}

fn row(cells: usize, plan: &Plan) {
    let mesh = cut(cells);
    let (found, wall, processor) = solve(&mesh, plan);
    let Plan { elements, block, poisson_ratio, share } = plan;
    let element = if elements.stabilised { "stabilised" } else { "plain" };
    let head =
        format!("| {element} | {block} | {} | {poisson_ratio} | {share} |", mesh.cells.len());
    match found {
        Ok(found) => {
            let again = (1..REPEATS).map(|_| solve(&mesh, plan)).map(|(_, wall, cpu)| (wall, cpu));
            let (walls, processors) = again.chain([(wall, processor)]).unzip();
            let top = mesh.nodes.iter().zip(&found.displacement).filter(|(x, _)| x.z > 19.999);
            let moved: Vec<f64> = top.map(|(_, u)| u.norm()).collect();
            let Some(newton) = found.solver.newton else { return };
            println!(
                "{head} {:.2} | {:.2} | {} | {} | {} | {} | {:.3} | {:.1} | {:.4} |",
                median(walls),
                median(processors),
                found.solver.iterations,
                newton.inner_iterations,
                newton.hierarchies,
                newton.indefinite_steps,
                newton.least_det_f,
                newton.energy,
                moved.iter().sum::<f64>() / moved.len() as f64,
            );
        }
        Err(error) => println!("{head} {wall:.2} | {processor:.2} | {error} |{}", " |".repeat(6)),
    }
}

fn holds(mesh: &VolumeMesh, plan: &Plan) -> Vec<Constraint> {
    let turn = Rotation3::from_axis_angle(&Vector::y_axis(), (15.0 * plan.share).to_radians());
    let pivot = Vector::new(50.0, 50.0, 0.0);
    // Of C the same nodes are held on meshes of 5 mm and finer.
    let ring = match plan.block {
        'A' => 0.0,
        'B' => 25.0,
        _ => 29.0,
    };
    let bottom = (0..).zip(&mesh.nodes).filter(|(_, x)| x.z.abs() < 1e-9);
    let hold = |(node, x): (u32, &Vector)| {
        let outside = [x.x, x.y].map(|v| (35.0 - v).max(v - 65.0).max(0.0));
        let distance = outside[0].hypot(outside[1]);
        let moved = turn * (x - pivot) + pivot - x + Vector::new(25.0, 0.0, 10.0) * plan.share;
        match distance == 0.0 {
            true => Some(Constraint::at(node, moved)),
            false => (distance > ring).then(|| Constraint::at(node, Vector::zeros())),
        }
    };
    bottom.filter_map(hold).collect()
}
