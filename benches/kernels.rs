//! Kernels of the solver beside what the machine can do.
//!
//! `cargo bench --bench kernels [-- SIZE …]` prints, for one thread and two: the triad bandwidth and the
//! plain f64 product (`measure/yardstick.rs`), the solver's own product and multigrid cycle with one and
//! with eight right-hand sides, assembly, setup, and the whole solution of material (a), each with the
//! bandwidth it reaches where the bytes it must move are known. Without the data it says so and ends.

mod measure;

use measure::yardstick::{PlainBlocks, triad_gb_per_s};
use measure::{on_threads, process, seconds, shell};
use mechanics::boundary::NodeClass;
use mechanics::model::dofs::{DofMap, partly_constrained};
use mechanics::model::fem::displacement::Problem;
use mechanics::prediction::{ElementChoice, Scene, Settings};
use mechanics::progress::Unobserved;
use mechanics::solver::multigrid::Multigrid;
use mechanics::solver::{System, Tolerance};

const THREADS: [usize; 2] = [1, 2];

fn main() {
    let given: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let sizes = if given.is_empty() { vec!["300k".to_owned()] } else { given };
    println!("Last level of cache: {}.\n", process::last_level_cache());
    println!("| shell | kernel | threads | ms | MB | GB/s | share of triad | products |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let triad = THREADS.map(triad_gb_per_s);
    for (threads, triad) in THREADS.into_iter().zip(triad) {
        println!("| | triad | {threads} | | | {triad:.1} | 1.00 | |");
    }
    for size in sizes {
        let Some(mesh) = shell::load(&size) else { return };
        let (case, plan) = shell::standard_load(&mesh, shell::homogeneous(0.46));
        let settings = Settings { element: ElementChoice::Plain, ..Settings::default() };
        let scene = Scene::new(&case, &plan, &settings).expect("the standard load is valid");
        let table = Table::new(&size, &scene, triad);
        table.assembly(&scene);
        let bytes = table.iterations(&system(&scene));
        table.whole(&scene, bytes);
    }
}

/// The equations of a scene whose nodes are held in all directions or in none.
fn system(scene: &Scene) -> System {
    let held: Vec<bool> =
        scene.conditions.classes.iter().map(|class| *class != NodeClass::Free).collect();
    let dof_map = DofMap::new(&scene.mesh, &held);
    let matrix = scene.tissue().assemble(&dof_map, &Unobserved);
    let matrix = matrix.expect("no cell is inverted").expect("nobody stops it");
    let mut positions = scene.mesh.nodes.clone();
    for (node, &row) in dof_map.ordering.place.iter().enumerate() {
        positions[row as usize] = scene.mesh.nodes[node];
    }
    let partly_constrained = partly_constrained(&scene.conditions.constraints, &dof_map);
    System { ordering: dof_map.ordering, matrix, partly_constrained, positions }
}

struct Table<'a> {
    size: &'a str,
    /// GB/s on one thread and on two.
    triad: [f64; 2],
    /// Seconds of the plain product on one thread.
    product: f64,
}

impl<'a> Table<'a> {
    fn new(size: &'a str, scene: &Scene, triad: [f64; 2]) -> Self {
        let is_free = |node: usize| scene.conditions.classes[node] == NodeClass::Free;
        let plain = PlainBlocks::new(&scene.mesh, is_free);
        let table = Table { size, triad, product: plain.seconds(1) };
        table.row("plain f64 product", 1, table.product, plain.bytes());
        table.row("plain f64 product", 2, plain.seconds(2), plain.bytes());
        table
    }

    /// `bytes` is NaN where they are not counted.
    fn row(&self, kernel: &str, threads: usize, seconds: f64, bytes: f64) {
        let speed = bytes / seconds / 1e9;
        let shown = |value: f64, digits: usize| match value.is_nan() {
            true => String::new(),
            false => format!("{value:.digits$}"),
        };
        println!(
            "| {} | {kernel} | {threads} | {:.2} | {} | {} | {} | {:.1} |",
            self.size,
            seconds * 1e3,
            shown(bytes / 1e6, 0),
            shown(speed, 1),
            shown(speed / self.triad[threads - 1], 2),
            seconds / self.product
        );
    }

    fn assembly(&self, scene: &Scene) {
        let held: Vec<bool> =
            scene.conditions.classes.iter().map(|class| *class != NodeClass::Free).collect();
        let dof_map = DofMap::new(&scene.mesh, &held);
        let tissue = scene.tissue();
        for threads in THREADS {
            let number = || drop(DofMap::new(&scene.mesh, &held));
            let fill = || drop(tissue.assemble(&dof_map, &Unobserved));
            self.row(
                "numbering and pattern",
                threads,
                on_threads(threads, || seconds(5, number)),
                f64::NAN,
            );
            self.row("assembly", threads, on_threads(threads, || seconds(5, fill)), f64::NAN);
        }
    }

    /// Answers the bytes that one iteration must move.
    fn iterations(&self, system: &System) -> f64 {
        let setup = |threads| {
            on_threads(threads, || seconds(3, || drop(Multigrid::new(system, &Unobserved))))
        };
        THREADS.into_iter().for_each(|n| self.row("multigrid setup", n, setup(n), f64::NAN));
        let Ok(multigrid) = Multigrid::new(system, &Unobserved) else { return f64::NAN };
        let bytes_of_iteration = self.sweeps::<1>(system, &multigrid);
        self.sweeps::<8>(system, &multigrid);
        bytes_of_iteration
    }

    /// A product reads the half matrix once; a cycle reads its own in f32 twice at every level.
    fn sweeps<const N: usize>(&self, system: &System, multigrid: &Multigrid) -> f64 {
        let free = system.ordering.free;
        let x = vec![[[1.0; N]; 3]; free];
        let mut product = x.clone();
        let mut workspace = multigrid.workspace::<N>();
        let blocks: usize = (0..free).map(|row| system.matrix.lower_row(row).count()).sum();
        let vector = (free * 24 * N) as f64;
        let product_bytes = (76 * blocks + 72 * free) as f64 + 2.0 * vector;
        let cycle_bytes = 2.0 * multigrid.megabytes() * 1e6 + 3.0 * vector;
        for threads in THREADS {
            let multiply = || system.multiply(&x, &mut product);
            let taken = on_threads(threads, || seconds(20, multiply));
            self.row(&format!("half f64 product, {N} at once"), threads, taken, product_bytes);
            let cycle = || {
                let _ = multigrid.apply(&x, &mut workspace);
            };
            let taken = on_threads(threads, || seconds(20, cycle));
            self.row(&format!("multigrid cycle, {N} at once"), threads, taken, cycle_bytes);
        }
        product_bytes + cycle_bytes
    }

    /// Mesh and conditions in memory to displacement in memory; the bytes are those of its iterations.
    fn whole(&self, scene: &Scene, bytes_of_iteration: f64) {
        let (relative_residual, memory_mb) =
            (scene.settings.relative_residual, scene.settings.memory_mb);
        let problem = Problem {
            tissue: scene.tissue(),
            constraints: &scene.conditions.constraints,
            forces: &scene.forces,
            tolerance: Tolerance { relative_residual, memory_mb },
        };
        for threads in THREADS {
            let mut iterations = 0;
            let taken = on_threads(threads, || {
                seconds(5, || {
                    let equilibrium =
                        problem.solve(&Unobserved).expect("the standard load converges");
                    iterations = equilibrium.solver.iterations;
                })
            });
            let name = format!("whole solution, {iterations} iterations");
            self.row(&name, threads, taken, iterations as f64 * bytes_of_iteration);
        }
    }
}
